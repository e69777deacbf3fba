"""Expansion in time against exact laws, itself at other truncations, and the solver."""

import math

import numpy as np
import pytest
from problems import DecayingCirculation, asymmetric_start

import fpsolve as fp
from fpsolve._kernels import ladder
from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.paths import EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.spectral.evolution import quadrature
from fpsolve.spectral.evolution.evolution import spectral_solve
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.exponential import ForwardOperator
from fpsolve.spectral.evolution.null_vector import (
    Unknowns,
    forward_matrix,
    stationary,
    truncation_limits,
)
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.steady import spectral_steady_state

MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
BELT = fp.LayDownModel(fp.QuadraticPotential(), 1.5, fp.MovingBelt(0.2))
NARROW = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.7), 1.3)
# Wide enough for few coefficients, without any symmetry.
START = GaussianLaw((0.5, -0.3), ((0.7, 0.1), (0.1, 0.6)), 0.8, 1.0)
SLIM = GaussianLaw((0.3, -0.2), ((0.7, 0.05), (0.05, 0.35)), 0.8, 1.0)
CASES = {"fixed": (MODEL, START), "belt": (BELT, START), "anisotropic": (NARROW, SLIM)}
STOPS = (0.0, 0.5, 1.0, 2.0)


@pytest.fixture(scope="module")
def solutions():
    """One solution of every case, to 1e-8."""
    return {name: spectral_solve(*case, STOPS) for name, case in CASES.items()}


def ladder_limits(degree, harmonics):
    return np.full(degree + 1, harmonics)


@pytest.fixture
def scattered():
    """An expansion with every coefficient different, under limits with a slope."""
    rng = np.random.default_rng(3)
    h = Expansion.empty(np.array([5, 5, 4, 4, 2, 1, 1]))
    h.values[...] = rng.standard_normal(h.values.shape)
    h.values[-1], h.values[:, -1], h.values[:, :, -2:] = 0, 0, 0
    # p is real: without harmonic, even j are real and odd j imaginary.
    h.values[:, ::2, 1], h.values[:, 1::2, 0] = 0, 0
    h.clear_outside()
    return h


def test_the_operator_is_the_forward_equation(scattered):
    # L* h from derivatives of the values on a grid: centred differences of order six
    # with steps 1e-2, hence 1e-9 or so.
    model = fp.LayDownModel(fp.QuadraticPotential(1.2, 0.7), 1.1, fp.MovingBelt(0.3))
    s1, s2 = 1.2, 0.7
    larger = scattered.within(np.full(8, 6))
    image = ForwardOperator(model)(larger)
    point, step = np.array([0.4, -0.3, 1.0]), 1e-2
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}

    def value(h, xi1, xi2, alpha):
        slab = quadrature.slabs(h, np.array([xi1 / s1]), np.array([xi2 / s2]), 1, alpha)
        return float(next(slab)[1][0, 0, 0])

    def slope(axis):
        unit = np.eye(3)[axis] * step
        return (
            sum(
                w
                * (
                    value(larger, *(point + n * unit))
                    - value(larger, *(point - n * unit))
                )
                for n, w in weights.items()
            )
            / step
        )

    unit = np.array([0.0, 0.0, step])
    around = {1: 3 / 2, 2: -3 / 20, 3: 1 / 90}
    middle = value(larger, *point)
    bend = sum(
        w * (value(larger, *(point + n * unit)) + value(larger, *(point - n * unit))
             - 2 * middle)
        for n, w in around.items()
    ) / step**2  # fmt: skip
    xi1, xi2, alpha = point
    across = -xi1 / s1**2 * math.sin(alpha) + xi2 / s2**2 * math.cos(alpha)
    expected = (
        -math.cos(alpha) * slope(0) - math.sin(alpha) * slope(1) + across * slope(2)
        + model.diffusivity * bend - 0.3 * (slope(0) - xi1 / s1**2 * middle)
    )  # fmt: skip
    # minus v ∂₁ p: the belt moves p by γ' = −v e₁, so p_S h is carried towards +e₁.
    assert value(image, *point) == pytest.approx(expected, rel=1e-6)


def test_transport_keeps_the_norm_and_diffusion_takes_its_share(scattered):
    # Re⟨h, L*h⟩ = −(A²/2)‖∂_α h‖² for v = 0, in every truncation.
    model = fp.LayDownModel(fp.QuadraticPotential(1.2, 0.7), 1.1)
    weight = np.where(np.arange(scattered.values.shape[2]) < 2, 1.0, 2.0)
    image = ForwardOperator(model)(scattered)
    change = float((scattered.values * image.values * weight).sum())
    lost = (np.arange(scattered.harmonics + 1) ** 2 * scattered.energies()).sum()
    assert change == pytest.approx(-model.diffusivity * lost, rel=1e-13)


def test_the_compiled_operator_equals_its_source_and_the_sparse_matrix():
    limits = truncation_limits(7)
    index = Unknowns(limits)
    rng = np.random.default_rng(1)
    vector = rng.standard_normal(index.i.size)
    h = Expansion.empty(limits)
    h.values[index.i, index.j, 2 * index.k] = vector
    image = ForwardOperator(BELT)(h).values
    source = np.zeros_like(image)
    numbers = ForwardOperator(BELT).numbers
    ladder.apply_ladder.py_func(
        h.values, limits, numbers, (1.0, 0.0, 0.0), source, 0.0, np.zeros_like(image)
    )
    # Rounding of sums of ten terms of size 100.
    np.testing.assert_allclose(image, source, rtol=0, atol=1e-12)
    product = forward_matrix(BELT, index) @ vector
    found = image[index.i, index.j, 2 * index.k]
    np.testing.assert_allclose(found, product, rtol=0, atol=1e-12)
    energies = np.empty((h.degree + 1, h.harmonics + 1))
    ladder.shell_energies.py_func(h.values, limits, energies)
    np.testing.assert_allclose(h.energies(), energies, rtol=1e-13)


@pytest.mark.parametrize("noise", [0.5, 1.0, 6.0])
def test_the_decaying_circulation_is_reproduced(noise):
    # MATH statement 1, an exact solution; a box of half width 10 cuts off p_S/√p_S
    # at e^{−25} and its spacing resolves e^{−2B}.
    grid = fp.PhaseSpaceGrid(10.0, (80, 80, 8))
    problem = DecayingCirculation(fp.QuadraticPotential(), noise, grid)
    stops = np.array([0.0, 0.3, 1.0])
    found = spectral_solve(problem.model, (grid, problem.initial()), stops)
    for s in stops:
        exact = problem.density(s)
        # The density itself is not in the error estimates; measured 2e-11.
        assert np.abs(found.density(s, grid) - exact).max() < 1e-9
    # H of the exact density, on angles enough for the harmonics 0.63^n of ln h.
    fine = fp.PhaseSpaceGrid(10.0, (80, 80, 64))
    wide = DecayingCirculation(fp.QuadraticPotential(), noise, fine)
    reference = problem.model.equilibrium(*grid.plane())
    entropies = [
        fp.diagnostics.relative_entropy(wide.density(s), fine, reference) for s in stops
    ]
    np.testing.assert_allclose(found.relative_entropy, entropies, rtol=0, atol=1e-8)


def test_the_mean_of_g_decays_like_its_eigenvalue(solutions):
    # G = e^{−B}(ξ₁ sin α − ξ₂ cos α), L G = −(A²/2) G, from any start.
    # Sums of a smooth function: on these cells their error is rounding.
    grid = fp.PhaseSpaceGrid(7.0, (40, 40, 24))
    xi1, xi2, alpha = grid.mesh()
    g = np.exp(-(xi1**2 + xi2**2) / 2) * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))
    found = solutions["fixed"]
    means = [np.sum(g * found.density(s, grid)) * grid.cell_volume for s in STOPS]
    exact = means[0] * np.exp(-0.5 * np.array(STOPS))
    np.testing.assert_allclose(means, exact, rtol=0, atol=1e-8)


def test_the_entropy_of_the_readme_example():
    # Measured once with a tolerance of 1e-10 and twice the degrees.
    start = GaussianLaw((1.5, 0.0), 0.25, math.pi / 2, 4.0)
    found = spectral_solve(MODEL, start, (1.0, 2.0), tolerance=1e-6)
    expected = np.array([1.847602352, 1.102146962])
    assert np.abs(found.relative_entropy - expected).max() < 1e-6
    assert found.errors["relative_entropy"].max() <= 1e-6


def test_the_entropy_falls_by_the_dissipation(solutions):
    # dH/ds = −(A²/2)∫p(∂_α ln p/p_S)², the derivative in α by Fourier series, that in
    # s by differences of order four over h = 0.02: 1e-7 of truncation.
    h = 0.02
    around = np.array([0.5 - 2 * h, 0.5 - h, 0.5, 0.5 + h, 0.5 + 2 * h])
    found = spectral_solve(MODEL, START, around, tolerance=1e-10)
    slope = np.array([1, -8, 0, 8, -1]) @ found.relative_entropy / (12 * h)
    grid = fp.PhaseSpaceGrid(7.5, (60, 60, 48))
    p = found.density(0.5, grid)
    waves = np.fft.rfft(p, axis=2) * 1j * np.arange(25)
    derivative = np.fft.irfft(waves, 48, axis=2)
    # p is above 1e-10 of its maximum where the integrand counts.
    inside = p > 1e-12 * p.max()
    integrand = np.divide(derivative**2, p, out=np.zeros_like(p), where=inside)
    lost = 0.5 * integrand.sum() * grid.cell_volume
    assert slope == pytest.approx(-lost, rel=1e-6)


@pytest.mark.parametrize("name", CASES)
def test_mass_is_one_and_the_start_is_exact(name, solutions):
    model, law = CASES[name]
    found = solutions[name]
    assert np.abs(found.mass - 1).max() < 1e-10
    assert found.mean_xi1[0] == pytest.approx(law.mean[0], abs=1e-14)
    assert found.mean_xi2[0] == pytest.approx(law.mean[1], abs=1e-14)
    assert found.variance_xi1[0] == pytest.approx(law.variance[0][0], abs=1e-13)
    assert found.variance_xi2[0] == pytest.approx(law.variance[1][1], abs=1e-13)
    assert found.covariance[0] == pytest.approx(law.variance[0][1], abs=1e-13)
    # I₁(1)/I₀(1), and the closed form of H against quadrature of the series.
    assert found.mean_cos_alpha[0] == pytest.approx(0.4463899659 * math.cos(0.8))
    assert found.mean_sin_alpha[0] == pytest.approx(0.4463899659 * math.sin(0.8))
    series = GaussianStart(law, model.potential).expansion(90, 24)
    entropy, _ = quadrature.relative_entropy(series, 1e-9)
    assert found.relative_entropy[0] == pytest.approx(entropy, abs=1e-8)


@pytest.mark.parametrize("name", CASES)
def test_errors_of_a_loose_run_are_within_its_estimate(name, solutions):
    loose = spectral_solve(*CASES[name], STOPS, tolerance=1e-4)
    for series, errors in loose.errors.items():
        away = np.abs(loose.series[series] - solutions[name].series[series])
        assert errors.max() <= 1e-4
        # The estimate, and what the reference itself may be wrong by.
        assert np.all(away <= errors + 2e-8), series


@pytest.mark.parametrize("name", CASES)
def test_moments_agree_with_the_grid_solver_within_its_error(name, solutions):
    model, law = CASES[name]
    grid = fp.PhaseSpaceGrid((6.0, 6.0), (48, 48, 24))
    if name == "anisotropic":
        grid = fp.PhaseSpaceGrid((6.0, 4.2), (48, 48, 24))
    p0 = fp.initial.gaussian(grid, law.mean, law.variance, law.angle, law.concentration)
    scheme = fp.drift_kick(model, grid, interpolation_order=12)
    run = fp.solve(scheme, p0, (0.0, 2.0), 0.125, extrapolate=True)
    steps = np.searchsorted(run.s, STOPS)
    for series in ("relative_entropy", *MOMENTS):
        away = np.abs(run.series[series][steps] - solutions[name].series[series])
        # The estimate is that of one run at ds/2 and covers the rest of the error of
        # the extrapolation; 3e-6 for box and interpolation.
        assert np.all(away <= run.errors[series][steps] + 3e-6), series


def test_a_density_on_a_grid_gives_what_its_law_gives(solutions):
    grid = fp.PhaseSpaceGrid(7.0, (56, 56, 32))
    p0 = fp.initial.gaussian(grid, START.mean, START.variance, START.angle, 1.0)
    found = spectral_solve(MODEL, (grid, p0), STOPS, tolerance=1e-7)
    for name, values in found.series.items():
        np.testing.assert_allclose(
            values, solutions["fixed"].series[name], rtol=0, atol=2e-7, err_msg=name
        )


def test_evolving_twice_is_evolving_once(solutions):
    # The density at s = 0.5, on a grid, as a new start.
    grid = fp.PhaseSpaceGrid(8.0, (64, 64, 32))
    middle = solutions["fixed"].density(0.5, grid)
    again = spectral_solve(MODEL, (grid, np.abs(middle)), (0.5, 1.5), tolerance=1e-6)
    for name, values in again.series.items():
        expected = solutions["fixed"].series[name][2:]
        np.testing.assert_allclose(values, expected, rtol=0, atol=2e-6, err_msg=name)


def test_without_symmetry_the_start_decays_to_equilibrium():
    grid = fp.PhaseSpaceGrid(9.0, (72, 72, 24))
    p0 = asymmetric_start(grid, MODEL.potential)
    found = spectral_solve(MODEL, (grid, p0), (0.0, 2.0, 30.0), tolerance=1e-6)
    assert found.relative_entropy[0] > 1e-3
    # Rate 0.37 of the slowest mode: H ~ e^{−0.75·30} = 2e-10 of its start.
    assert found.relative_entropy[2] < 1e-9
    assert found.variance_xi1[2] == pytest.approx(1.0, abs=1e-5)


def test_on_a_belt_the_steady_state_stays():
    grid = fp.PhaseSpaceGrid(10.0, (80, 80, 32))
    steady = spectral_steady_state(BELT)
    found = spectral_solve(BELT, (grid, steady.density(grid)), 1.0, tolerance=1e-7)
    for name in MOMENTS:
        assert found.series[name][0] == pytest.approx(steady.moments[name], abs=2e-7)
    assert (
        found.steady_state.moments
        == spectral_steady_state(BELT, tolerance=1e-7).moments
    )


# Noise, belt speed, throwing ranges.
BELTS = [(1.0, 0.1, (1.0, 1.0)), (3.0, 0.2, (1.0, 1.0)), (2.0, -0.3, (1.0, 0.6))]


@pytest.mark.parametrize(("noise", "speed", "sigma"), BELTS)
def test_the_stationary_mean_direction_is_minus_the_belt_speed(noise, speed, sigma):
    model = fp.LayDownModel(fp.QuadraticPotential(*sigma), noise, fp.MovingBelt(speed))
    found = spectral_steady_state(model)
    moments = found.moments
    # Statement 5, exact in every truncation: it follows from the first degree.
    assert moments["mean_cos_alpha"] == pytest.approx(-speed, abs=1e-12)
    assert moments["mean_sin_alpha"] == 0.0
    assert moments["mean_xi2"] == 0.0
    # The belt carries the fibre along +e₁ for v > 0, against the paper's sign.
    assert math.copysign(1, moments["mean_xi1"]) == math.copysign(1, speed)
    assert max(found.errors.values()) <= 1e-8
    assert found.residual < 1e-2


def test_the_stationary_shift_of_strong_noise_is_a_squared_v():
    # Statement 5: ⟨ξ₁⟩ = A²k/2 with I₁(k)/I₀(k) = v, up to 1/A² of itself.
    model = fp.LayDownModel(fp.QuadraticPotential(), 8.0, fp.MovingBelt(0.1))
    found = spectral_steady_state(model)
    assert found.moments["mean_xi1"] == pytest.approx(64 * 0.2010 / 2, rel=3 / 64)
    # The first coefficients are exact, but h = e^{6.4 ξ₁} has its largest beyond the
    # truncation: of the density nothing is known.
    grid = fp.PhaseSpaceGrid((13.0, 5.0), (40, 16, 8))
    assert found.density_error(grid) > 1
    with pytest.raises(ToleranceError, match="or use `steady_state`"):
        found.density(grid)


def stationary_density(model, degree, grid):
    expansion = stationary(model, truncation_limits(degree))
    return quadrature.density_on(expansion, grid, model.potential)


def test_the_density_states_an_error_that_covers():
    model = fp.LayDownModel(fp.QuadraticPotential(), 2.0, fp.MovingBelt(0.3))
    grid = fp.PhaseSpaceGrid(6.0, (24, 24, 16))
    coarse = spectral_steady_state(model, tolerance=1e-3)
    exact = stationary_density(model, 53, grid)
    error = fp.diagnostics.l1_distance(coarse.density(grid), exact, grid)
    assert coarse.truncation[0] == 31
    assert 1e-9 < error < coarse.density_error(grid)
    with pytest.raises(ToleranceError, match="tolerance 1e-10 not reached"):
        coarse.density(grid, tolerance=1e-10)


def test_the_steady_state_is_the_grid_solvers():
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
    grid = fp.PhaseSpaceGrid(6.0, (40, 40, 24))
    on_grid = fp.steady_state(model, grid, ds=0.1, extrapolate=True, tolerance=1e-7)
    found = spectral_steady_state(model)
    assert found.moments["mean_xi1"] == pytest.approx(0.129328405, abs=1e-8)
    for name, value in on_grid.moments().items():
        # The L1 error of the grid's density is 3e-5; variances are cut by the box and
        # feel the interpolation: 8e-4 measured for ξ₁.
        assert value == pytest.approx(found.moments[name], abs=2e-3), name
    assert on_grid.moments()["mean_xi1"] == pytest.approx(
        found.moments["mean_xi1"], abs=1e-5
    )
    distance = fp.diagnostics.l1_distance(found.density(grid), on_grid.density, grid)
    assert distance < 5e-4


def test_on_a_fixed_belt_the_steady_state_is_the_equilibrium():
    found = spectral_steady_state(NARROW)
    assert found.residual < 1e-14
    assert found.moments["variance_xi2"] == pytest.approx(0.49, abs=1e-14)
    grid = fp.PhaseSpaceGrid(4.0, (8, 8, 4))
    exact = np.broadcast_to(NARROW.equilibrium(*grid.plane())[:, :, None], grid.shape)
    np.testing.assert_allclose(found.density(grid), exact, rtol=1e-12)


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (fp.LayDownModel(fp.LinearPotential(), 1.0), "must be a QuadraticPotential"),
        (fp.LayDownModel(fp.FreePotential(), 1.0), "must be a QuadraticPotential"),
        (fp.LayDownModel(fp.QuadraticPotential(), 0.0), "`noise` must be positive"),
        (
            fp.LayDownModel(
                fp.QuadraticPotential(), 1.0, fp.RotatingNozzle(0.1, 1.0, 1.0)
            ),
            "`curve` must be a belt at rest or at constant speed",
        ),
    ],
)
def test_models_that_the_expansion_does_not_solve_are_refused(model, message):
    with pytest.raises(ValueError, match=message):
        spectral_solve(model, START, 1.0)
    with pytest.raises(ValueError, match=message):
        spectral_steady_state(model)


def test_what_is_not_a_model_is_refused():
    with pytest.raises(TypeError, match="`model` must be a LayDownModel"):
        spectral_solve("model", START, 1.0)


@pytest.mark.parametrize("variance", [2.0, (0.5, 2.5), ((1.5, 0.8), (0.8, 1.5))])
def test_a_start_that_is_too_wide_is_refused(variance):
    with pytest.raises(ValueError, match="`variance` must be below 2 σ² in every dir"):
        spectral_solve(MODEL, GaussianLaw((0.0, 0.0), variance), 1.0)


@pytest.mark.parametrize("p0", [PointLaw(), EquilibriumLaw(MODEL.potential), 1.0])
def test_other_kinds_of_start_are_refused(p0):
    with pytest.raises(TypeError, match="`p0` must be a GaussianLaw or a pair"):
        spectral_solve(MODEL, p0, 1.0)


@pytest.mark.parametrize(
    ("s", "message"),
    [
        ((1.0, 0.5), "increasing, got"),
        (-1.0, "non-negative and increasing"),
        (np.nan, "`s` must be finite"),
        ((), "`s` must be one number or a list"),
    ],
)
def test_arclengths_must_increase(s, message):
    with pytest.raises(ValueError, match=message):
        spectral_solve(MODEL, START, s)


def test_the_tolerance_must_be_positive():
    with pytest.raises(ValueError, match="`tolerance` must be positive"):
        spectral_solve(MODEL, START, 1.0, tolerance=0.0)
    with pytest.raises(ValueError, match="`tolerance` must be positive"):
        spectral_steady_state(BELT, tolerance=math.nan)


def test_a_density_that_its_grid_does_not_hold_is_refused():
    # Cut off by the box at e^{−8}; then with cells of the width of the density.
    small = fp.PhaseSpaceGrid(4.0, (32, 32, 16))
    p0 = fp.initial.equilibrium(small, MODEL.potential)
    with pytest.raises(ValueError, match="`p0` must be resolved by its grid"):
        spectral_solve(MODEL, (small, p0), 1.0)
    coarse = fp.PhaseSpaceGrid(8.0, (32, 32, 8))
    p0 = fp.initial.gaussian(coarse, (0.0, 0.0), 0.3)
    with pytest.raises(ValueError, match="otherwise refine `shape`"):
        spectral_solve(MODEL, (coarse, p0), 1.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda p: -p, "must be finite and have mass"),
        (lambda p: p * np.nan, "must be finite and have mass"),
        (lambda p: p - 0.5 * p.max(), "have mass|must not be negative"),
        (lambda p: np.where(p == p.max(), -p, p), "must not be negative"),
    ],
)
def test_what_is_not_a_density_is_refused(change, message):
    grid = fp.PhaseSpaceGrid(6.0, (32, 32, 8))
    p0 = change(fp.initial.gaussian(grid, (0.0, 0.0), 0.7))
    with pytest.raises(ValueError, match=message):
        DensityStart(grid, p0, MODEL.potential, 1e-8)
    with pytest.raises(fp.GridMismatchError, match="`p0` must have the shape"):
        DensityStart(grid, p0[1:], MODEL.potential, 1e-8)


def test_memory_that_does_not_suffice_is_told():
    with pytest.raises(MemoryLimitError, match="ask for fewer `s`"):
        spectral_solve(NARROW, SLIM, 1.0, memory_limit=10**6)
    with pytest.raises(MemoryLimitError, match="ask for fewer `s`"):
        spectral_solve(MODEL, START, 1.0, memory_limit=10**5)
    # A point-like start: just after it, and for a while, it needs too many degrees.
    needle = GaussianLaw((1.0, 0.0), 0.01, 0.0, 1.0)
    turning = fp.LayDownModel(fp.QuadraticPotential(), 2.0)
    limits = {"tolerance": 1e-3, "memory_limit": 25 * 10**6}
    with pytest.raises(ToleranceError, match="start from a wider density"):
        spectral_solve(turning, needle, (0.01,), **limits)
    with pytest.raises(ToleranceError, match="reached from s = 4 on; ask for later"):
        spectral_solve(turning, needle, (0.01, 4.0), **limits)
    slow = fp.LayDownModel(fp.QuadraticPotential(), 0.3, fp.MovingBelt(0.3))
    with pytest.raises(ToleranceError, match="raise `memory_limit` or `tolerance`"):
        spectral_steady_state(slow, memory_limit=3 * 10**7)


@pytest.mark.parametrize("noise", [1e5, 1e59])
def test_much_noise_is_refused_by_the_number_of_steps(noise):
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 1.3), noise)
    with pytest.raises(ToleranceError, match=r"work of .* or more.*earlier `s`"):
        spectral_solve(model, START, 0.3, tolerance=1e-3, work_limit=1e8)


def test_little_noise_ends_within_the_work():
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 1.3), 0.01)
    with pytest.raises(ToleranceError, match="where 1e\\+08 is allowed"):
        spectral_solve(model, START, 30.0, tolerance=1e-3, work_limit=1e8)


@pytest.mark.parametrize("noise", [1e15, 1e59])
def test_a_stationary_density_beyond_all_numbers_is_refused(noise):
    model = fp.LayDownModel(fp.QuadraticPotential(), noise, fp.MovingBelt(0.2))
    with pytest.raises(ToleranceError, match="coefficients grow beyond all numbers"):
        spectral_steady_state(model)


def test_only_what_was_asked_for_can_be_evaluated(solutions):
    found = solutions["fixed"]
    with pytest.raises(ValueError, match=r"`s` must be one of 0, 0\.5, 1, 2, got 0\.7"):
        found.density(0.7, fp.PhaseSpaceGrid(5.0, (8, 8, 8)))
    with pytest.raises(AttributeError, match="its series are mass, relative_entropy"):
        _ = found.entropy
    assert "mean_xi1" in dir(found)
    assert "at 4 places" in repr(found)
    assert "E ξ" in repr(spectral_steady_state(NARROW))
