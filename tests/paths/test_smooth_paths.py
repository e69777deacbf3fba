"""Paths of the smooth model: the same path every time, exact laws, what is kept."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import FpsolveError, GridMismatchError, NonFinitePathError
from fpsolve.paths import GaussianLaw, batch
from fpsolve.paths.ensemble import START_BLOCK
from fpsolve.results.kinds import from_xarray

BELT = fp.MovingBelt(0.2)
SMOOTH = fp.SmoothLayDownModel(fp.QuadraticPotential(1.0, 0.7), 0.4, 1.2, BELT)
POTENTIALS = [
    fp.QuadraticPotential(1.0, 0.7),
    fp.LinearPotential(1.3),
    fp.PowerPotential(4.0, 1.1),
    fp.PowerPotential(2.5),
    fp.FreePotential(),
]
# Between the points at which potentials are checked.
RADIUS = 2.2
CURVES = [fp.FixedBelt(), BELT, fp.RotatingNozzle(0.1, 0.8, 1.3, 0.2)]


def slow(potential):
    """The same potential as a user's own functions."""
    return fp.CallablePotential(potential.value, potential.gradient)


@pytest.fixture
def small_batches(monkeypatch):
    """Batches of two start blocks, so that a test needs few paths for several."""
    monkeypatch.setattr(batch, "BATCH", 2 * START_BLOCK)


@pytest.mark.parametrize("potential", [*POTENTIALS, slow(POTENTIALS[0])])
def test_path_k_is_the_same_among_any_number_of_paths(potential):
    model = fp.SmoothLayDownModel(potential, 0.4, 0.8, CURVES[2])
    few, many = (
        fp.sample_paths(model, n, 1.5, 0.1, seed=5, save_at=(0.0, 0.7, 1.5))
        for n in (37, 200)
    )
    assert np.array_equal(few.states, many.states[:, :, :37])


@pytest.mark.parametrize("potential", POTENTIALS)
def test_compiled_potentials_and_the_user_s_own_give_the_same_paths(potential):
    ends = [
        fp.sample_paths(
            fp.SmoothLayDownModel(one, 0.4, 0.8, BELT), 100, 2.0, 0.1, seed=5
        )
        for one in (potential, slow(potential))
    ]
    # The same formulas in another order of operations; rounding grows by how sensitive
    # a path is, by no more than 1e4 over s = 2.
    np.testing.assert_allclose(ends[0].states, ends[1].states, rtol=0, atol=1e-11)


def test_paths_are_bitwise_equal_over_threads_batches_and_workers(
    on_threads, small_batches
):
    def sample(client=None):
        grid = fp.PhaseSpaceGrid(4.0, (8, 8, 8))
        return fp.sample_paths(
            SMOOTH, 20_000, 0.5, 0.1, seed=9, save_at=(0.3, 0.5), histogram=grid,
            client=client,
        )  # fmt: skip

    one, two = on_threads(1, sample), on_threads(2, sample)
    with ThreadPoolExecutor(1) as executor:
        elsewhere = sample(executor)
    for other in (two, elsewhere):
        for name in ("states", "sums", "counts", "outside", "start", "end"):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name


@pytest.mark.parametrize("curve", CURVES)
def test_a_continued_run_and_a_replay_equal_an_uninterrupted_run_bitwise(curve):
    model = fp.SmoothLayDownModel(fp.PowerPotential(4.0), 0.4, 0.8, curve)
    # 0.7 and 0.1 are not exact in binary, and 7 steps are no multiple of four.
    first = fp.sample_paths(model, 50, 0.7, 0.1, seed=3)
    second = first.continued(2.0, save_at=(1.1, 2.0))
    whole = fp.sample_paths(model, 50, 2.0, 0.1, seed=3, save_at=(0.7, 1.1, 2.0))
    assert np.array_equal(first.states[0], whole.states[0])
    assert np.array_equal(second.states, whole.states[1:])
    again = second.replay(11)
    assert np.array_equal(again.xi[-1], whole.xi[-1, 11])
    assert again.kappa[-1] == whole.kappa[-1, 11]


def test_paths_that_were_not_kept_have_the_same_moments_and_can_be_replayed():
    arguments = {"n_paths": 300, "s_end": 1.0, "ds": 0.1, "seed": 3}
    kept = fp.sample_paths(SMOOTH, **arguments)
    gone = fp.sample_paths(SMOOTH, **arguments, keep=False)
    assert np.array_equal(kept.sums, gone.sums)
    assert gone.replay(7).kappa[-1] == kept.kappa[0, 7]


def test_moments_of_the_curvature_are_those_of_the_paths():
    paths = fp.sample_paths(SMOOTH, 500, 1.0, 0.1, seed=3)
    moments, kappa = paths.moments(), paths.kappa[0]
    expected = {"mean_kappa": kappa, "mean_kappa2": kappa**2}
    for name, values in expected.items():
        value, error = moments[name]
        assert value[0] == pytest.approx(values.mean(), rel=1e-12)
        spread = values.std() / math.sqrt(len(values) - 1)
        assert error[0] == pytest.approx(spread, rel=1e-10)


@pytest.mark.parametrize("keep", [True, False])
def test_paths_come_back_from_a_file_and_are_repeated_bitwise(tmp_path, keep):
    start = np.zeros((40, 2)), np.linspace(0, 9, 40), np.linspace(-1, 1, 40)
    paths = fp.sample_paths(
        SMOOTH, 40, 1.0, 0.1, seed=3, initial=start, keep=keep, save_at=(0.5, 1.0)
    )
    read = fp.load(paths.save(tmp_path / "paths.nc"))
    assert read.model == SMOOTH
    again = fp.rerun(read)
    for other in (read, again):
        for name in ("states", "sums", "start", "end"):
            assert np.array_equal(getattr(paths, name), getattr(other, name)), name
    assert fp.compare(paths, again).equal


def test_a_file_of_a_user_s_own_potential_still_holds_the_curvature(tmp_path):
    model = fp.SmoothLayDownModel(slow(POTENTIALS[0]), 0.4, 1.2)
    for keep in (True, False):
        paths = fp.sample_paths(model, 5, 0.3, 0.1, seed=3, keep=keep)
        with pytest.warns(UserWarning, match="the model could not be read back"):
            read = fp.load(paths.save(tmp_path / f"{keep}.nc"))
        assert read.model is None
        for name in ("states", "sums", "start", "end"):
            assert np.array_equal(getattr(paths, name), getattr(read, name)), name


def test_sums_that_are_not_those_of_the_model_are_refused():
    dataset = fp.sample_paths(SMOOTH, 5, 0.3, 0.1, seed=3).to_xarray()
    with pytest.raises(ValueError, match="`moment_sums` must be 22 as in `model`, got"):
        from_xarray(dataset.isel(sum=slice(19)))


# Starts


def test_the_curvature_starts_from_its_stationary_law_unless_it_is_given():
    paths = fp.sample_paths(SMOOTH, 20_000, 0.1, 0.1, seed=3, save_at=(0.0,))
    value, error = paths.moments()["mean_kappa2"]
    assert abs(value[0] - SMOOTH.curvature_variance) < 4 * error[0]
    given = fp.sample_paths(
        SMOOTH, 3, 0.1, 0.1, seed=3, save_at=(0.0,), initial=((0, 0), 1.0, 2.5)
    )
    assert np.array_equal(given.kappa[0], [2.5, 2.5, 2.5])
    pair = fp.sample_paths(
        SMOOTH, 3, 0.1, 0.1, seed=3, save_at=(0.0,), initial=((0, 0), 1.0)
    )
    assert len(set(pair.kappa[0])) == 3


def test_a_law_of_the_start_may_draw_the_curvature_itself():
    class Curled:
        def sample(self, rng, n):
            return *GaussianLaw().sample(rng, n), np.full(n, -3.0)

    paths = fp.sample_paths(
        SMOOTH, 5, 0.1, 0.1, seed=3, save_at=(0.0,), initial=Curled()
    )
    assert np.array_equal(paths.kappa[0], [-3.0] * 5)
    with pytest.raises(FpsolveError, match="and alpha for a model without"):
        fp.sample_paths(SMOOTH.white_noise_limit, 5, 0.1, 0.1, seed=3, initial=Curled())


@pytest.mark.parametrize(
    ("kappa", "message"),
    [
        (lambda n: np.zeros((n, 2)), r"one array of shape \(4096,\) for kappa"),
        (lambda n: np.full(n, np.nan), "finite points, got .* and kappa = nan"),
    ],
)
def test_a_law_that_draws_no_curvatures_is_refused(kappa, message):
    class Wrong:
        def sample(self, rng, n):
            return *GaussianLaw().sample(rng, n), kappa(n)

    with pytest.raises(FpsolveError, match=message):
        fp.sample_paths(SMOOTH, 5, 0.1, 0.1, seed=3, initial=Wrong())


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"method": "heun"}, ValueError, "`method` must be one of 'splitting', got"),
        ({"initial": ((0, 0),)}, TypeError, r"a pair \(xi, alpha\), or \(xi, alpha, k"),
        ({"initial": ((0, 0), 0, [1, 2])}, GridMismatchError, "initial kappa"),
        ({"initial": ((0, 0), 0, math.nan)}, ValueError, "nan in kappa of path 0"),
    ],
)
def test_wrong_arguments_are_named(change, error, message):
    with pytest.raises(error, match=message):
        fp.sample_paths(
            SMOOTH, **({"n_paths": 9, "s_end": 1, "ds": 0.1, "seed": 1} | change)
        )


def test_paths_of_the_basic_model_have_no_curvature():
    paths = fp.sample_paths(SMOOTH.white_noise_limit, 2, 0.1, 0.1, seed=1)
    with pytest.raises(ValueError, match="must be a SmoothLayDownModel for paths to h"):
        _ = paths.kappa
    assert paths.replay(0).kappa is None


def test_a_gradient_that_is_not_finite_names_the_path_and_the_place():
    # A thin ring of NaN.
    def gradient(xi1, xi2):
        distance = np.hypot(xi1, xi2)
        hole = (distance > RADIUS) & (distance < RADIUS + 0.2)
        return np.where(hole, np.nan, xi1), xi2

    hole = fp.CallablePotential(fp.QuadraticPotential().value, gradient)
    model = fp.SmoothLayDownModel(hole, 0.5, 1.0)
    with pytest.raises(NonFinitePathError, match="path 0"):
        fp.sample_paths(model, 1, 3.0, 0.1, seed=1, initial=((2.25, 0.0), 0.0, 0.0))


# Exact laws


@pytest.mark.parametrize(("length", "ds"), [(0.3, 1.0), (1e-3, 0.5), (50.0, 2.0)])
def test_without_potential_angle_and_curvature_are_exact_for_any_step(length, ds):
    model = fp.SmoothLayDownModel(fp.FreePotential(), length, 1.3)
    n = 20_000
    paths = fp.sample_paths(model, n, 3 * ds, ds, seed=8, save_at=(2 * ds, 3 * ds))
    turned, bent = np.diff(paths.alpha, axis=0)[0], np.diff(paths.kappa, axis=0)[0]
    faded = -math.expm1(-ds / length) * length / ds
    expected = {
        "alpha": (turned, 1.3**2 * ds * (1 - faded)),
        "kappa": (bent, (1.3 / length) ** 2 * ds * faded),
        "stationary": (paths.kappa[1], model.curvature_variance),
    }
    for values, variance in expected.values():
        # Squares of n normal numbers: a relative standard error of √(2/n).
        ratio = np.mean(values**2) / variance
        assert abs(ratio - 1) < 4 * math.sqrt(2 / n)


@pytest.mark.parametrize(
    ("potential", "speed"),
    [(fp.QuadraticPotential(), 0.0), (fp.QuadraticPotential(1.0, 0.6), 0.3)],
)
def test_the_stationary_state_on_a_belt_obeys_its_exact_identities(potential, speed):
    model = fp.SmoothLayDownModel(potential, 0.5, 1.2, fp.MovingBelt(speed))
    paths = fp.sample_paths(
        model, 20_000, 30.0, 0.05, seed=4, initial=GaussianLaw(variance=1.0)
    )
    alpha, kappa = paths.alpha[0], paths.kappa[0]
    stiffness = potential.sigma1**-2.0, potential.sigma2**-2.0
    across = paths.xi[0, :, 1] * np.cos(alpha) - paths.xi[0, :, 0] * np.sin(alpha)
    zeros = {
        "E cos α = -v": np.cos(alpha) + speed,
        # E κ² = K²R/2 + E cos²/σ1² + E sin²/σ2² - v²/σ1²
        "E κ²": kappa**2 - model.curvature_variance - stiffness[0] * np.cos(alpha) ** 2
        - stiffness[1] * np.sin(alpha) ** 2 + speed**2 * stiffness[0],
    }  # fmt: skip
    if speed == 0:
        zeros["E (ξ·τ⊥) κ = -1"] = across * kappa + 1
    for name, values in zeros.items():
        error = values.std() / math.sqrt(values.size)
        # The bias of the step, 0.05² times a few tenths.
        assert abs(values.mean()) < 4 * error + 1e-3, name


def test_the_law_is_not_that_of_the_basic_model_times_a_gaussian():
    # E ‖ξ‖² = 2 for p_S; for R = 1 and A = 1 the fibre strays farther.
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 1.0, 1.0)
    paths = fp.sample_paths(model, 5_000, 40.0, 0.1, seed=4)
    value, error = paths.moments()["mean_square"]
    assert value[0] - 2.0 > 20 * error[0]


def test_a_short_relaxation_length_is_the_basic_model():
    start = GaussianLaw((1.0, 0.2), 0.1, 0.4, 2.0)
    basic, smooth = (
        fp.sample_paths(
            model, 20_000, 2.0, 0.05, seed=seed, initial=start, keep=False
        ).moments()
        for seed, model in (
            (1, SMOOTH.white_noise_limit),
            (2, fp.SmoothLayDownModel(SMOOTH.potential, 1e-6, SMOOTH.noise, BELT)),
        )
    )
    for name in basic:
        difference = basic[name][0] - smooth[name][0]
        error = np.hypot(basic[name][1], smooth[name][1])
        # Biases of both are of order ds² = 0.0025 and far below the standard errors.
        assert abs(difference[0]) < 4 * error[0], name


def test_a_fibre_of_any_curvature_and_force_keeps_a_unit_tangent():
    model = fp.SmoothLayDownModel(fp.PowerPotential(60.0), 1e-3, 30.0)
    with pytest.warns(UserWarning, match="is long for this force"):
        paths = fp.sample_paths(
            model, 500, 20.0, 0.1, seed=1, initial=((1.4, 0.0), 0.0, 1e4)
        )
    # One Newton step a turn leaves rounding.
    length = np.hypot(paths.states[0, 2], paths.states[0, 3])
    assert np.abs(length - 1).max() < 1e-14
