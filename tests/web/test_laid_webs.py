"""Webs that are laid: mean, variation, conservation, and the same for any workers."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from multiprocessing import get_context

import numba
import numpy as np
import pytest
from scipy.special import j1
from straight_fibres import POISSON_LINES

import fpsolve as fp

QUADRATIC = fp.QuadraticPotential()
BELT = fp.MovingBelt(0.1)
BASIC = fp.LayDownModel(QUADRATIC, 1.0, BELT)
SMOOTH = fp.SmoothLayDownModel(QUADRATIC, 1.0, 1.0, BELT)
ROTATING = fp.LayDownModel(QUADRATIC, 1.0, fp.RotatingNozzle(0.1, 2.0, 0.5))
OSCILLATING = fp.SmoothLayDownModel(
    QUADRATIC, 1.0, 1.0, fp.OscillatingNozzle(-0.2, 2.0, 0.5)
)
OWN = fp.LayDownModel(
    fp.CallablePotential(lambda x, y: (x**2 + y**2) / 2, lambda x, y: (x, y)), 1.0, BELT
)
MODELS = {
    "basic": BASIC, "smooth": SMOOTH, "rotating": ROTATING, "oscillating": OSCILLATING
}  # fmt: skip
SMALL = {"width": 3.0, "length": 2.0, "spacing": 0.25, "pixel": 0.25, "seed": 11}


@cache
def small(name):
    return fp.lay_web(MODELS[name], **SMALL)


@cache
def large(name):
    return fp.lay_web(
        MODELS[name], width=20.0, length=20.0, spacing=0.1, pixel=0.1, seed=7
    )


def same(web, other):
    for name in ("length_density", "orientation_11", "orientation_12"):
        np.testing.assert_array_equal(getattr(web, name), getattr(other, name))
    assert web.laid_length == other.laid_length
    assert web.outside_length == other.outside_length


@pytest.mark.parametrize("name", MODELS)
def test_the_mean_length_density_is_that_of_the_belt(name):
    web = large(name)
    mean = web.mean_length_density()
    speed = abs(MODELS[name].curve.speed)
    assert web.expected_density == pytest.approx(1 / (speed * 0.1), rel=1e-15)
    # Three standard errors; and those are small enough to see a slip of a per cent.
    assert abs(mean - web.expected_density) < 3 * mean.standard_error
    assert mean.standard_error < 0.01 * mean


@pytest.mark.parametrize("name", ["basic", "smooth"])
def test_small_zones_vary_as_those_of_random_lines(name):
    # Zones of a tenth of the radius of the fibre, to which it is straight; the fibre is
    # isotropic but for E cos α = -v = -0.1, a change of the constant of order v².
    web = fp.lay_web(
        MODELS[name], width=20.0, length=20.0, spacing=0.05, pixel=0.05, ds=0.025,
        seed=8,
    )  # fmt: skip
    variation = web.coefficient_of_variation(0.05)
    expected = np.sqrt(POISSON_LINES * 0.1 * 0.05 / 0.05)
    assert variation.standard_error < 0.01 * expected
    # And 1 % for what is no straight line at this size.
    assert abs(variation - expected) < 3 * variation.standard_error + 0.01 * expected


def test_the_variation_grows_as_the_root_of_the_spacing():
    # At zones where no other length counts but d, which is below the throwing range.
    found = [
        fp.lay_web(BASIC, width=12.8, length=12.8, spacing=d, pixel=0.4, seed=5)
        .coefficient_of_variation(0.4)
        for d in (0.05, 0.1, 0.2, 0.4)
    ]  # fmt: skip
    for fine, coarse in pairwise(found):
        ratio = coarse / fine
        error = ratio * np.hypot(
            coarse.standard_error / coarse, fine.standard_error / fine
        )
        assert error < 0.1
        assert abs(ratio - np.sqrt(2)) < 3 * error


@pytest.mark.parametrize("name", MODELS)
def test_length_is_conserved(name):
    web = small(name)
    inside = web.length_density.sum() * web.pixel**2
    # The counts agree exactly, or there is no web; here sums of doubles do.
    assert inside + web.outside_length == pytest.approx(web.laid_length, rel=1e-13)
    assert 0 < inside < web.laid_length


@pytest.mark.parametrize("name", MODELS)
def test_the_tensor_has_the_trace_one_and_is_nowhere_where_no_fibre_is(name):
    web = fp.lay_web(MODELS[name], **SMALL | {"spacing": 3.0, "pixel": 0.0625})
    tensor, empty = web.orientation, web.length_density == 0
    assert tensor.shape == (48, 32, 2, 2)
    assert empty.any()
    np.testing.assert_array_equal(np.isnan(tensor).all(axis=(2, 3)), empty)
    full = tensor[~empty]
    np.testing.assert_allclose(np.trace(full, axis1=1, axis2=2), 1.0, rtol=1e-15)
    # A mean of unit vectors: no eigenvalue is below zero, but for rounded counts of
    # pixels that a fibre only touches.
    assert (np.linalg.eigvalsh(full) > -1e-6).all()
    mean = web.mean_orientation
    weights = web.length_density[~empty] / web.length_density.sum()
    np.testing.assert_allclose(
        mean, np.einsum("n,nij->ij", weights, full), rtol=0, atol=1e-13
    )


def test_no_more_fibre_lies_along_the_belt_than_a_stationary_density_has():
    # E cos 2α of the stationary density on the belt, by expansion.
    web = large("basic")
    grid = fp.PhaseSpaceGrid(7.0, (48, 48, 48))
    p = fp.spectral_steady_state(BASIC).density(grid)
    cosine = np.cos(grid.alpha) ** 2
    expected = (p * cosine).sum() / p.sum()
    # Forty thousand pixels with about 400 throwing areas: a per cent.
    assert web.mean_orientation[0, 0] == pytest.approx(expected, abs=0.01)
    assert web.mean_orientation[0, 1] == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("name", ["basic", "oscillating"])
def test_a_web_is_the_same_for_any_number_of_threads_and_workers(name, monkeypatch):
    monkeypatch.setattr("fpsolve.web.laying._STEPS_PER_THREAD", 1)
    monkeypatch.setattr("fpsolve.web.laying._PER_WORKER", 64)
    monkeypatch.setattr("fpsolve.web.laying._ELSEWHERE", 101)
    options = SMALL | {"spacing": 0.05}
    webs = []
    for n_threads in (1, numba.config.NUMBA_NUM_THREADS):
        before = numba.get_num_threads()
        numba.set_num_threads(n_threads)
        try:
            webs.append(fp.lay_web(MODELS[name], **options))
        finally:
            numba.set_num_threads(before)
    with ThreadPoolExecutor(1) as executor:
        webs.append(fp.lay_web(MODELS[name], client=executor, **options))
    for web in webs[1:]:
        same(webs[0], web)


@pytest.mark.processes
@pytest.mark.parametrize(
    "name", ["basic", pytest.param("oscillating", marks=pytest.mark.nightly)]
)
def test_a_web_of_spawned_processes_is_the_one_laid_here(name, monkeypatch):
    monkeypatch.setattr("fpsolve.web.laying._ELSEWHERE", 50)
    options = SMALL | {"spacing": 0.1}
    here = fp.lay_web(MODELS[name], **options)
    assert here.positions.size > 100
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        same(here, fp.lay_web(MODELS[name], client=executor, **options))


def test_a_fibre_does_not_depend_on_those_beside_it():
    few = fp.lay_web(BASIC, **SMALL, positions=[1.0, 2.0])
    more = fp.lay_web(BASIC, **SMALL, positions=[1.0, 2.0, 2.5])
    np.testing.assert_array_equal(few.curve(1), more.curve(1))
    assert not np.array_equal(few.length_density, more.length_density)


@pytest.mark.parametrize("name", MODELS)
def test_the_curves_of_all_fibres_are_the_web(name):
    web = fp.lay_web(MODELS[name], **SMALL, positions=[0.5, 1.5, 2.5])
    edges = [np.arange(n + 1) * web.pixel for n in web.length_density.shape]
    laid = np.zeros_like(web.length_density)
    for fibre in range(web.positions.size):
        curve = web.curve(fibre)
        # Sixty-four points on every piece stand for its length.
        shares = (np.arange(64) + 0.5) / 64
        points = curve[:-1, None] + shares[:, None] * np.diff(curve, axis=0)[:, None]
        along, across = points.reshape(-1, 2).T
        laid += np.histogram2d(across, along, edges)[0] * (web.ds / 64)
    # Where an edge cuts a piece, half a point is missed: ds/128, some hundred times in
    # a pixel, with random signs.
    atol = 10 * web.ds / 128 / web.pixel**2
    np.testing.assert_allclose(laid / web.pixel**2, web.length_density, atol=4 * atol)


def test_pieces_of_a_basic_fibre_are_as_long_as_a_step():
    steps = np.diff(small("rotating").curve(3), axis=0)
    # Positions of a dozen units are rounded at both ends.
    np.testing.assert_allclose(np.hypot(*steps.T), small("rotating").ds, atol=1e-13)


def test_a_nozzle_in_phase_is_laid_as_one_with_the_phase_of_the_curve():
    turned = fp.LayDownModel(QUADRATIC, 1.0, fp.RotatingNozzle(0.1, 2.0, 0.5, 0.7))
    given = {"positions": [1.0, 2.0], **SMALL}
    in_phase = fp.lay_web(turned, **given, phases="in phase")
    # Margins differ, and with them where a fibre begins: the fibres are compared.
    added = fp.lay_web(ROTATING, **given, phases=[0.7, 0.7])
    n = min(len(web.curve(0)) for web in (in_phase, added))
    first, second = (web.curve(0)[:n] for web in (in_phase, added))
    # The noise is that of the same path, at the same steps; a fibre that contracts
    # forgets rounding, but grows it at first.
    np.testing.assert_allclose(first - first[0], second - second[0], rtol=0, atol=1e-6)


@pytest.mark.parametrize("phases", ["in phase", "independent"])
def test_nozzles_that_rotate_in_phase_lay_strips(phases):
    speed, radius, turns = 0.1, 2.0, 0.05
    model = fp.LayDownModel(
        QUADRATIC, 1.0, fp.RotatingNozzle(speed, radius, angular_speed=turns)
    )
    period = 2 * np.pi * speed / turns
    web = fp.lay_web(
        model, width=period, length=2 * period, spacing=0.1, pixel=period / 64, seed=2,
        phases=phases,
    )  # fmt: skip
    found = web.strips(direction="cross", period=period)
    # MATH 7: 2 |J₁(ωr/v)| |φ(ω/v)| with the Gaussian characteristic function; the law
    # of ξ under so slow a nozzle (ωr = 0.1) differs from it at the order v² = 0.01.
    expected = 2 * j1(turns * radius / speed) * np.exp(-((turns / speed) ** 2) / 2)
    if phases == "in phase":
        assert found.amplitude.standard_error < 0.05
        error = 3 * found.amplitude.standard_error + 0.01
        assert abs(found.amplitude - expected) < error
        assert error < 0.1 * expected
    else:
        # An amplitude is positive; without strips it is of the size of its noise, and
        # such a web forgets too slowly for four stretches, from which errors come.
        assert found.amplitude < 0.15
        assert found.amplitude.standard_error != 0


def test_a_potential_of_the_users_own_lays_fibres_like_the_compiled_one():
    options = {**SMALL, "width": 8.0, "length": 8.0, "spacing": 0.5, "ds": 0.125}
    own, compiled = (fp.lay_web(model, **options) for model in (OWN, BASIC))
    means = [web.mean_length_density() for web in (own, compiled)]
    # Starts are drawn in different ways: the webs agree in law only.
    error = np.hypot(*(mean.standard_error for mean in means))
    assert abs(means[0] - means[1]) < 3 * error
    assert error < 0.1 * means[0]


def test_random_positions_are_poisson():
    numbers = [
        fp.lay_web(
            BASIC, width=4.0, length=0.5, spacing=0.5, pixel=0.5, seed=seed,
            positions="random",
        )
        for seed in range(12)
    ]  # fmt: skip
    counts = np.array([web.positions.size for web in numbers])
    spans = np.array([-np.subtract(*web.plan.margins.reach[1]) for web in numbers])
    expected = (4.0 + spans) / 0.5
    # A Poisson number has its mean as variance: five standard errors of twelve.
    assert abs((counts - expected).mean()) < 5 * np.sqrt(expected.mean() / 12)
    assert counts.std() > 0


def test_a_periodic_web_holds_all_fibre_across_the_belt():
    web = fp.lay_web(BASIC, **SMALL, periodic=True)
    assert web.positions.size == 12
    # What leaves on one side comes back on the other: outside is only what lies before
    # and behind the window along the belt.
    lost = web.outside_length / web.laid_length
    travelled = -np.subtract(*web.plan.margins.reach[0]) + 2.0
    assert web.inside_length == pytest.approx(12 * 2.0 / 0.1, rel=0.2)
    assert lost == pytest.approx(1 - 2.0 / travelled, abs=0.2)


def test_a_process_lays_its_web_in_metres_and_grams():
    process = fp.Process(
        sigma1=5e-3, sigma2=5e-3, noise=15.0, speed_ratio=0.1, spinning_speed=20.0
    )
    web = fp.lay_web(
        process, width=0.06, length=0.06, spacing=5e-4, pixel=5e-4, titer=1.5e-4, seed=1
    )
    # 1.5 dtex at 2000 positions per metre, laid ten times as long as the belt.
    assert web.base_weight == pytest.approx(3.0, rel=1e-12)
    assert web.mass_density.mean() == pytest.approx(3.0, rel=0.03)
    assert web.unit == "m"
    # The same web in throwing ranges, bit for bit but for the units.
    model = fp.lay_web(
        process.model, width=12.0, length=12.0, spacing=0.1, pixel=0.1, seed=1,
        ds=web.plan.ensemble.schedule.ds,
    )  # fmt: skip
    mean = web.length_density.mean() * 5e-3
    assert mean == pytest.approx(model.length_density.mean(), rel=0.03)
    assert web.laid_length == pytest.approx(model.laid_length * 5e-3, rel=1e-3)


def test_what_the_margins_leave_out_is_said_and_little():
    web = large("basic")
    assert 0 < web.margin_error < 1e-3
    # The rule 2/A² + A²σ² of the relaxation against the spectral gap 0.369 of A = 1.
    gap = 0.36856156
    assert np.exp(-gap * web.burn_in) < web.burn_in_error < 1e-4


def test_a_step_has_three_digits_and_not_those_of_a_quadrature():
    # Its last digit, which the threads of BLAS decide, would make another web.
    from fpsolve.web.lengths import lengths_of

    for model in MODELS.values():
        for length in (lengths_of(model).step, lengths_of(model).relaxation):
            assert length == float(f"{length:.3g}")
    assert small("basic").ds == 0.1


@pytest.mark.parametrize("noise", [1.0, 2.0, 6.0])
def test_the_relaxation_length_is_that_of_the_spectral_gap(noise):
    from fpsolve.web.lengths import lengths_of

    model = fp.LayDownModel(QUADRATIC, noise, BELT)
    gap = fp.spectrum(model, 1, tolerance=1e-2).gap
    # An interpolation of both limits, too long between them: 1.24 times at A = 2. The
    # gap is known to a per cent.
    assert 0.97 < lengths_of(model).relaxation * gap < 1.26


def test_pilots_follow_the_period_that_a_curve_of_the_users_own_names():
    from fpsolve.web.lengths import lengths_of

    nozzle = fp.OscillatingNozzle(0.1, 1.0, 0.05)

    class Swinging(fp.Curve):
        kind, speed, period, autonomous, fixed = "own", 0.1, nozzle.period, False, False
        formula = latex = "own"

        def displacement(self, s0, s1):
            return nozzle.displacement(s0, s1)

        def position(self, s):
            return nozzle.position(s)

        def velocity(self, s):
            return nozzle.velocity(s)

    own, known = (
        lengths_of(fp.LayDownModel(QUADRATIC, 1.0, curve))
        for curve in (Swinging(), nozzle)
    )
    assert own == known
    assert own.period == pytest.approx(2 * np.pi / 0.05)
