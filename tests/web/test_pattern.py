"""The mean pattern of nozzles in phase: exact cases, small curvature, paths."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import jv

import fpsolve as fp

QUADRATIC = fp.QuadraticPotential()


def state_of(curve, noise=1.5, shape=(28, 28, 16), half_width=6.0, **options):
    model = fp.LayDownModel(QUADRATIC, noise, curve)
    grid = fp.PhaseSpaceGrid(half_width, shape)
    options = {"n_phases": 16, "error_tolerance": 0.1, **options}
    return fp.periodic_state(model, grid, **options)


@pytest.fixture(scope="module")
def rotating():
    """Far from small curvature: ωr = 0.8."""
    curve = fp.RotatingNozzle(0.5, 0.8, 1.0)
    return state_of(curve, n_phases=24, shape=(34, 34, 16), half_width=7.2)


@pytest.fixture(scope="module")
def at_rest():
    return state_of(fp.RotatingNozzle(0.02, 0.0, 2 * np.pi), n_phases=4)


def test_nozzles_at_rest_leave_strips_of_their_spacing_alone(at_rest):
    d = 3.0
    pattern = fp.mean_pattern(at_rest, spacing=d)
    m = np.arange(1, 4)
    # The ξ₂ marginal is Gaussian but for O(v²).
    expected = 2 * np.exp(-2 * (math.pi * m / d) ** 2)
    np.testing.assert_allclose(pattern.cross_amplitudes[:3], expected, atol=1e-3)
    # One period is 0.02 long: no wave that the cells resolve.
    assert pattern.machine_amplitudes.size == 0
    assert np.ptp(pattern.length_density, axis=1).max() < 1e-12
    # Of Gaussians the first strip holds all but e^{−6·2π²/d²} of the square.
    assert 0.999 < pattern.cross_shares[0] < 1.0


def test_the_mean_is_the_length_laid_per_area(rotating):
    pattern = fp.mean_pattern(rotating, spacing=2.5)
    assert pattern.mean == pytest.approx(1 / (0.5 * 2.5), rel=1e-15)
    assert pattern.length == pytest.approx(0.5 * 2 * math.pi, rel=1e-15)
    assert pattern.length_density.mean() == pytest.approx(pattern.mean, rel=1e-13)
    # Cross direction × machine direction, and a density up to its error.
    assert pattern.length_density.shape == (pattern.x2.size, pattern.x1.size)
    assert pattern.length_density.min() > -0.01 * pattern.mean


@pytest.mark.nightly
def test_small_curvature_gives_the_bessel_formula_and_the_lag_of_the_fibre():
    v, radius = 0.1, 1.0
    for turn, low, high in ((0.1, 0.0, 0.012), (0.2, 0.03, 0.06)):
        # From the model, in tenths of a second: states have the same pattern, below.
        model = fp.LayDownModel(QUADRATIC, 1.0, fp.RotatingNozzle(v, radius, turn))
        pattern = fp.mean_pattern(model, spacing=4.0)
        k = turn / v
        formula = 2 * abs(jv(1, k * radius)) * math.exp(-(k**2) / 2)
        # Below ωr = 0.1 good to 1 %, at 0.2 about 4 % low.
        missing = pattern.machine_amplitudes[0] / formula - 1
        assert low < missing < high


def test_the_waves_are_those_of_fibres_that_are_laid(rotating):
    pattern = fp.mean_pattern(rotating, spacing=2.5)
    curve, n_phases, n_paths = rotating.model.curve, 12, 6000
    ds = rotating.period / (8 * n_phases)
    first = 3 * 8 * n_phases
    saved = [(first + 8 * j) * ds for j in range(n_phases * 4)]
    paths = fp.sample_paths(
        rotating.model, n_paths, saved[-1], ds, seed=7, save_at=saved
    )
    gamma = np.stack(curve.position(paths.s), axis=-1)[:, None]
    eta = paths.xi + gamma
    k1, k2 = 2 * math.pi / pattern.length, 2 * math.pi / 2.5
    seen = 0
    for n, m in ((1, 0), (2, 0), (0, 1), (1, 1), (1, -1)):
        # Every path is one sample, with its phases on average over four periods.
        waves = np.exp(-1j * (n * k1 * eta[..., 0] + m * k2 * eta[..., 1])).mean(axis=0)
        spread = math.sqrt(waves.real.var() + waves.imag.var()) / math.sqrt(n_paths)
        middle1, middle2 = (size // 2 for size in pattern.coefficients.shape)
        expected = pattern.coefficients[middle1 + n, middle2 + m]
        # Four standard errors of both parts together; steps of 0.065 are off by less.
        assert abs(waves.mean() - expected) < 4 * spread + 1e-4, (n, m)
        assert pattern.amplitude(n, m)[0] == pytest.approx(2 * abs(expected))
        seen += abs(expected) > 5 * spread
    # Not all of them are zero within the noise.
    assert seen >= 3


def test_the_generator_has_the_same_pattern_without_a_grid(rotating):
    """Two methods that share neither a basis nor a step, within both errors."""
    state = fp.mean_pattern(rotating, spacing=2.5)
    model = fp.mean_pattern(rotating.model, spacing=2.5)
    assert model.length == state.length
    assert model.width == state.width
    for n, m in ((1, 0), (2, 0), (0, 1), (1, 1), (1, -1), (2, 1)):
        pairs = model.amplitude(n, m), state.amplitude(n, m)
        (value, error), (other, rest) = pairs
        assert abs(value - other) < error + rest, (n, m)
        # And each coefficient with its phase, which the amplitudes do not tell.
        here, there = (
            one.coefficients[
                one.coefficients.shape[0] // 2 + n, one.coefficients.shape[1] // 2 + m
            ]
            for one in (model, state)
        )
        assert 2 * abs(here - there) < error + rest, (n, m)
    assert model.errors.max() <= 5e-4


def test_an_oscillation_across_the_belt_leaves_no_bands_and_close_nozzles_no_strips():
    state = state_of(fp.OscillatingNozzle(0.5, 0.8, 1.0))
    close = fp.mean_pattern(state, spacing=0.4)
    # r₁ = 0: the nozzles lay as much everywhere along the belt, but for the lag of
    # ξ₁ behind cos α, which is of second order.
    assert close.machine_amplitudes[0] < 0.02
    assert close.cross_amplitudes.size == 0
    apart = fp.mean_pattern(state, spacing=4.0)
    # By the mirror symmetry c_{n,−m} = (−1)ⁿ c_{n,m}.
    c = apart.coefficients
    n = np.arange(c.shape[0]) - c.shape[0] // 2
    np.testing.assert_allclose(
        c[:, ::-1], ((-1.0) ** np.abs(n))[:, None] * c, atol=1e-5
    )
    # Odd waves along the belt come with waves across it only: rows of holes, staggered.
    value, error = apart.amplitude(1, 1)
    assert value > 3 * error
    assert apart.amplitude(1, 0)[0] < 1e-5


def test_phases_of_nozzles_move_their_patterns_along_the_belt(rotating):
    one = fp.mean_pattern(rotating, spacing=2.5)
    x1, x2 = np.linspace(0, 3, 7), np.linspace(-2, 2, 5)
    same = fp.mean_pattern(rotating, spacing=2.5, phases=[0.0, 0.0])
    assert same.width == 5.0
    np.testing.assert_allclose(
        same.relative_at(x1, x2), one.relative_at(x1, x2), atol=1e-12
    )
    ahead = fp.mean_pattern(rotating, spacing=2.5, phases=[math.pi / 2])
    # γ of a nozzle ahead by φ is γ(s + φ/ω) + v φ/ω e₁.
    moved = 0.5 * math.pi / 2
    np.testing.assert_allclose(
        ahead.relative_at(x1 + moved, x2), one.relative_at(x1, x2), atol=1e-12
    )
    later = replace(rotating.model.curve, phase=math.pi / 2)
    state = state_of(later, n_phases=24, shape=(34, 34, 16), half_width=7.2)
    of_another = fp.mean_pattern(state, spacing=2.5)
    np.testing.assert_allclose(
        of_another.relative_at(x1, x2), ahead.relative_at(x1, x2), atol=1e-3
    )
    # Opposite phases in turn: odd waves cancel where both nozzles reach alike.
    staggered = fp.mean_pattern(rotating, spacing=2.5, phases=[0.0, math.pi])
    assert staggered.machine_amplitudes[0] < 1e-12 < one.machine_amplitudes[0]
    assert staggered.machine_amplitudes[1] == pytest.approx(
        one.machine_amplitudes[1], rel=1e-12
    )


def test_independent_phases_leave_strips_along_the_belt_alone(rotating):
    found = fp.mean_pattern(rotating, spacing=2.5, phases="independent")
    in_phase = fp.mean_pattern(rotating, spacing=2.5)
    assert np.all(found.machine_amplitudes == 0)
    np.testing.assert_array_equal(found.cross_amplitudes, in_phase.cross_amplitudes)
    assert found.coefficient_of_variation()[0] < in_phase.coefficient_of_variation()[0]


def test_the_variation_of_zones_is_that_of_the_pattern(rotating):
    pattern = fp.mean_pattern(rotating, spacing=4.0)
    relative = pattern.length_density / pattern.mean
    value, error = pattern.coefficient_of_variation()
    # The points resolve every wave: Parseval.
    assert value == pytest.approx(relative.std(), rel=1e-10)
    assert 0 < error < value
    zone = 1.0
    fine1 = np.arange(240) * (pattern.length / 240)
    fine2 = np.arange(240) * (pattern.width / 240)
    offsets = (np.arange(12) + 0.5) / 12 - 0.5
    mean = sum(
        pattern.relative_at(fine1 + zone * a, fine2 + zone * b)
        for a in offsets for b in offsets
    ) / 144  # fmt: skip
    # The midpoint rule of 12 points along a zone is off by (k/12)²/24 of a wave.
    assert pattern.coefficient_of_variation(zone)[0] == pytest.approx(
        mean.std(), rel=0.01
    )
    assert pattern.coefficient_of_variation(50.0)[0] < 0.05 * value


@pytest.mark.parametrize("n_phases", [8, 16])
def test_the_errors_cover_what_a_coarser_state_gets_wrong(rotating, n_phases):
    coarse = state_of(
        rotating.model.curve, n_phases=n_phases, shape=(27, 27, 14), half_width=7.2
    )
    here, there = (fp.mean_pattern(one, spacing=4.0) for one in (coarse, rotating))
    for n, m in ((1, 0), (2, 0), (0, 1), (0, 2), (1, 1), (1, -1), (1, 2)):
        (value, error), (exact, rest) = here.amplitude(n, m), there.amplitude(n, m)
        assert abs(value - exact) < error + rest, (n, m)
    # Far below the error in L1, since waves are longer than what the cells miss.
    assert there.machine_errors[0] < 0.2 * rotating.error


def test_a_pattern_is_labelled(rotating):
    pattern = fp.mean_pattern(rotating, spacing=4.0)
    dataset = pattern.to_xarray()
    assert dataset["length_density"].dims == ("x2", "x1")
    np.testing.assert_array_equal(dataset["length_density"], pattern.length_density)
    assert dataset["mean"] == pattern.mean
    assert "MeanPattern(3.14159 × 4, largest wave along the belt" in repr(pattern)


def test_arguments_that_cannot_work_are_named(rotating, at_rest):
    def refused(message, kind=ValueError, state=rotating, spacing=1.0, **options):
        with pytest.raises(kind, match=message):
            fp.mean_pattern(state, spacing=spacing, **options)

    refused("it is what `periodic_state` returns", TypeError, state=3)
    refused("`spacing` must be positive", spacing=0.0)
    refused("`spacing` must be positive", spacing=math.nan)
    refused("`phases` must be 'in phase', 'independent' or an array", phases="alike")
    refused(r"`phases` must have the shape \(N,\), got \(0,\)", phases=[])
    refused("`phases` must be finite", phases=[0.0, math.nan])
    refused("`state` must know its model", state=replace(rotating, model=None))
    still = replace(rotating.model, curve=fp.RotatingNozzle(0.0, 1.0, 1.0))
    refused(
        "`state` must be on a belt that moves", state=replace(rotating, model=still)
    )
    pattern = fp.mean_pattern(rotating, spacing=1.0)
    for pair in ((0, 0), (99, 0), (0, 99)):
        with pytest.raises(ValueError, match="`n` and `m` must be at most"):
            pattern.amplitude(*pair)
    with pytest.raises(ValueError, match=r"`zone` must be non-negative.*got -1"):
        pattern.coefficient_of_variation(-1.0)
    with pytest.raises(ValueError, match="`x1` must be finite"):
        pattern.relative_at([math.inf], [0.0])
    # Closer than two cells no strip is resolved.
    narrow = fp.mean_pattern(at_rest, spacing=0.5)
    assert narrow.cross_amplitudes.size == 0
    assert np.isnan(narrow.cross_shares).all()
