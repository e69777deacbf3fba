"""Smooth fibres with much noise: the same drift, and F times the diffusion."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import hyp1f1

import fpsolve as fp
from fpsolve import initial
from fpsolve.model.persistence import Persistence
from fpsolve.reduced.hydrodynamic import InitialLayer

QUADRATIC = fp.QuadraticPotential(1.2, 0.7)
MODEL = fp.SmoothLayDownModel(QUADRATIC, 0.5, 2.0, fp.MovingBelt(0.1))
# a = A²R/2 = 1: F = ₁F₁(1; 2; 1) = e − 1.
FACTOR = math.e - 1
PLANE = fp.PlaneGrid((8.0, 5.0), (64, 48))
SPACE = fp.PhaseSpaceGrid(PLANE.half_width, (*PLANE.shape, 16))


def directed(grid, concentration=3.0):
    return initial.gaussian(grid, (0.4, -0.2), 0.4, 0.6, concentration)


@pytest.mark.parametrize("bending", [1e-8, 0.5, 1.0, 29.9, 30.1, 1e4])
def test_the_factor_is_a_kummer_function_on_both_sides_of_stirlings_series(bending):
    found = Persistence(2.0, bending / 2).factor
    # Terms of size 30 ln 30 cancel in front of the series: a few hundred roundings.
    assert found == pytest.approx(float(hyp1f1(1, bending + 1, bending)), rel=1e-13)


@pytest.mark.parametrize("relaxation_length", [0.0, 1e-9, 0.3, 4.0])
def test_persistence_is_the_integral_of_the_correlation_of_the_tangent(
    relaxation_length,
):
    persistence = Persistence(1.5, relaxation_length)

    def correlation(s):
        if not relaxation_length:
            return math.exp(-(1.5**2) / 2 * s)
        late = relaxation_length * -math.expm1(-s / relaxation_length)
        return math.exp(-(1.5**2) / 2 * (s - late))

    for s in (0.0, 0.7, 3.0):
        # The tolerance of quad; s − R(1 − e^{−s/R}) loses no digits at these s.
        rest = quad(correlation, s, math.inf, epsabs=1e-13, epsrel=1e-12)[0]
        assert persistence.beyond(s) == pytest.approx(rest, rel=1e-10), s
        assert math.exp(-persistence.turned(s)) == pytest.approx(correlation(s))
    # One function of the same argument, twice, by two formulas of the power.
    assert persistence.length == pytest.approx(persistence.beyond(0.0), rel=1e-14)


def test_early_the_variance_of_the_angle_keeps_its_digits():
    # A²s²/(2R) − …: stationary curvature times s, to the first term's relative s/3R.
    persistence = Persistence(1.0, 2.0)
    for s in (1e-9, 1e-6):
        assert persistence.turned(s) == pytest.approx(s**2 / 8, rel=s / 5)
    # The series and the formula meet at s = R/10, up to what the formula cancels.
    below, above = (persistence.turned(0.2 * (1 + sign * 1e-12)) for sign in (-1, 1))
    assert below == pytest.approx(above, rel=1e-11)


def test_free_smooth_paths_diffuse_with_the_diffusivity_of_the_limit():
    # Four diffusivities times s, beyond what the start leaves, e^{−16} at s = 20 here;
    # κ starts from its Gaussian. The law of a free step is exact in α, and in ξ to ds².
    model = fp.SmoothLayDownModel(fp.FreePotential(), 0.8, 1.5)
    start = np.zeros((40_000, 2)), np.zeros(40_000)
    paths = fp.sample_paths(
        model, 40_000, 60.0, 0.1, seed=3, initial=start, save_at=(20.0, 60.0),
    )  # fmt: skip
    squares = (paths.xi[1] ** 2).sum(axis=1) - (paths.xi[0] ** 2).sum(axis=1)
    limit = fp.HydrodynamicLimit(fp.SmoothLayDownModel(QUADRATIC, 0.8, 1.5))
    error = squares.std() / math.sqrt(squares.size)
    expected = 4 * limit.diffusivity * 40.0
    assert abs(squares.mean() - expected) < 4 * error
    # A test that can tell it from the diffusivity of the basic model.
    assert abs(squares.mean() - expected / FACTOR) > 20 * error


def test_for_a_short_relaxation_the_limit_is_that_of_the_basic_model():
    limit = fp.HydrodynamicLimit(fp.SmoothLayDownModel(QUADRATIC, 1e-12, 2.0))
    basic = fp.HydrodynamicLimit(fp.LayDownModel(QUADRATIC, 2.0))
    xi = np.array([0.3, -1.1]), np.array([0.2, 0.5])
    # F = 1 + a + …, a = 2e-12.
    assert limit.diffusivity == pytest.approx(basic.diffusivity, rel=1e-11)
    np.testing.assert_allclose(limit.equilibrium(*xi), basic.equilibrium(*xi), 1e-11)


@pytest.mark.parametrize(
    "potential",
    [QUADRATIC, fp.LinearPotential(2.0), fp.PowerPotential(3.0)],
)
def test_the_stationary_density_has_no_flux_and_unit_mass(potential):
    limit = fp.HydrodynamicLimit(
        fp.SmoothLayDownModel(potential, 0.5, 2.0, fp.MovingBelt(0.1))
    )
    assert limit.diffusivity == pytest.approx(FACTOR / 4, rel=1e-14)
    x, y, h = np.array([0.3, 1.2, -0.8]), np.array([-0.4, 0.2, 0.5]), 1e-4
    density = limit.equilibrium
    slopes = (
        (density(x + h, y) - density(x - h, y)) / (2 * h),
        (density(x, y + h) - density(x, y - h)) / (2 * h),
    )
    for drift, slope in zip(limit.drift(x, y), slopes, strict=True):
        # Central differences: h² times a third derivative of size one, and rounding.
        flux = drift * density(x, y) - limit.diffusivity * slope
        np.testing.assert_allclose(flux, 0.0, atol=2e-8)
    plane = fp.PlaneGrid((30.0, 25.0), (600, 500))
    # The kink of the linear potential costs the midpoint rule h² of its value there.
    mass = density(*plane.mesh()).sum() * plane.cell_area
    assert mass == pytest.approx(1.0, abs=1e-3)


def test_drift_is_that_of_the_basic_model():
    basic = fp.HydrodynamicLimit(MODEL.white_noise_limit)
    xi = np.array([0.3, 1.2, -0.8]), np.array([-0.4, 0.2, 0.5])
    found = fp.HydrodynamicLimit(MODEL).drift(*xi)
    np.testing.assert_allclose(found, basic.drift(*xi), rtol=1e-14, atol=1e-16)


def test_solve_sample_and_spectrum_agree_with_the_ornstein_uhlenbeck_law():
    limit = fp.HydrodynamicLimit(MODEL)
    exact = fp.OrnsteinUhlenbeckLimit(MODEL, (0.4, -0.2), 0.4)
    np.testing.assert_allclose(
        exact.stationary_variance, FACTOR * np.array([1.44, 0.49])
    )
    np.testing.assert_allclose(exact.rates, 0.25 / np.array([1.44, 0.49]), rtol=1e-14)
    start = exact.density(*PLANE.mesh(), 0.0)
    solution = limit.solve(
        start, (0.0, 2.0), 0.1, grid=PLANE, method="sdirk2", extrapolate=True
    )
    # Second order in cells of a fifth of the narrower deviation.
    away = np.abs(solution.final - exact.density(*PLANE.mesh(), 2.0)).sum()
    assert away * PLANE.cell_area < 0.02
    assert solution.variance_xi1[-1] == pytest.approx(
        exact.covariance(2.0)[0, 0], rel=5e-3
    )
    for method, options in (("exact", {}), ("heun", {"ds": 0.05})):
        paths = limit.sample(
            20_000, 2.0, seed=1, initial=(0.4, -0.2), method=method, **options
        )
        point = fp.OrnsteinUhlenbeckLimit(MODEL, (0.4, -0.2), 1e-12)
        mean, error = paths.mean()
        assert (np.abs(mean[0] - point.mean(2.0)) < 4 * error[0]).all()
        spread, error = paths.covariance()
        away = np.abs(spread[0] - point.covariance(2.0)).diagonal()
        assert (away < 4 * error[0].diagonal()).all()
    spectrum = limit.spectrum(PLANE, 3)
    expected = exact.eigenvalues(3)
    # Four errors of the halved grid: the difference of two is no bound.
    assert (np.abs(spectrum.eigenvalues - expected) <= 4 * spectrum.errors).all()
    assert limit.gap() == pytest.approx(0.25 / 1.44, rel=1e-14)


def test_on_a_belt_the_reconstruction_holds_the_mean_direction():
    limit = fp.HydrodynamicLimit(MODEL)
    steady = limit.steady_state(SPACE)
    p = limit.reconstruct(steady.density, SPACE)
    direction = (p * np.cos(SPACE.alpha)).sum() * SPACE.cell_volume
    # E cos α = −v exactly; differences of order two in the cell.
    assert direction == pytest.approx(-0.1, abs=1e-3)
    at_rest = fp.HydrodynamicLimit(fp.SmoothLayDownModel(QUADRATIC, 0.5, 2.0))
    p = at_rest.reconstruct(at_rest.steady_state(SPACE).density, SPACE)
    # p₁ of a multiple of e^{−B/F} is rounding.
    assert np.ptp(p, axis=2).max() < 1e-16


def test_without_potential_the_layer_has_the_exact_mean_for_all_s():
    # E(ξ_s − ξ_0) = ∫₀^s e^{−ψ(u)} du E τ for B = 0.
    grid = fp.PhaseSpaceGrid(5.0, (40, 40, 16))
    p0 = directed(grid)
    layer = InitialLayer(p0, grid, 2.0, 0.5)
    xi1 = grid.plane()[0]
    direction = (p0 * np.cos(grid.alpha)).sum() * grid.cell_volume
    start = (layer.density_at_start * xi1).sum() * grid.cell_area
    slow = (layer.corrected_start * xi1).sum() * grid.cell_area
    for s in (0.0, 0.3, 2.0):
        held = (layer.density(s) * xi1[:, :, None]).sum() * grid.cell_volume
        travelled = quad(
            lambda u: math.exp(-2 * (u + 0.5 * math.expm1(-2 * u))), 0.0, s
        )[0]
        assert slow + held - start == pytest.approx(travelled * direction, abs=1e-12)


def test_solutions_and_paths_of_smooth_limits_are_kept_and_repeated(tmp_path):
    limit = fp.HydrodynamicLimit(MODEL)
    start = directed(SPACE).sum(axis=2) * SPACE.spacing[2]
    solution = limit.solve(start, (0.0, 0.5), 0.25, grid=PLANE)
    paths = limit.sample(50, 1.0, seed=1, initial=(0.0, 0.0))
    for result, name in ((solution, "solution.nc"), (paths, "paths.nc")):
        file = result.save(tmp_path / name)
        assert fp.compare(file, fp.rerun(file)).equal
        assert "εF∇𝒫" in fp.report(file, tmp_path / "page.html").read_text("utf-8")
    assert fp.load(tmp_path / "solution.nc").limit.model == MODEL


def test_where_a_curvature_spreads_the_fibre_without_end_the_limit_is_refused():
    # e^{−B} = (1 + r²)^{−3/2} is integrable, its root is not.
    heavy = fp.IsotropicPotential(
        lambda r: 1.5 * np.log1p(r * r), lambda r: 3 * r / (1 + r * r)
    )
    assert fp.HydrodynamicLimit(fp.SmoothLayDownModel(heavy, 0.1, 2.0))
    with pytest.raises(ValueError, match=r"`relaxation_length` must be small enough "):
        fp.HydrodynamicLimit(fp.SmoothLayDownModel(heavy, 8.0, 2.0))
    with pytest.raises(ValueError, match=r"below K/A² = 0\.5, got 0\.6 with A = 2"):
        fp.HydrodynamicLimit(
            fp.SmoothLayDownModel(fp.LinearPotential(2.0), 1.0, 2.0, fp.MovingBelt(0.6))
        )
