"""Stationary densities and gaps of smooth fibres by expansion."""

import pickle

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError

UNIT = fp.QuadraticPotential(1.0, 1.0)


def smooth(length, noise, sigma=1.0):
    return fp.SmoothLayDownModel(fp.QuadraticPotential(sigma, sigma), length, noise)


@pytest.mark.parametrize("length", [0.03, 0.3, 1.0])
@pytest.mark.parametrize("noise", [2.0, 4.0])
def test_the_squared_curvature_is_that_of_a_free_fibre_and_of_the_force(length, noise):
    found = fp.spectral_steady_state(smooth(length, noise, 0.7), tolerance=1e-6)
    exact = noise**2 / (2 * length) + 1 / 0.7**2
    error = abs(found.moments["mean_kappa2"] - exact)
    assert error <= found.errors["mean_kappa2"]
    # Tolerance of the call, relative.
    assert error <= 1e-6 * exact


def test_position_and_curvature_are_correlated_exactly_on_a_grid():
    """E (ξ·τ⊥)κ = -1, as dE(ξ·τ)/ds = 1 + E κ ξ·τ⊥ = 0; E ‖ξ‖² as in the moments."""
    found = fp.spectral_steady_state(smooth(0.5, 2.0), tolerance=1e-5)
    grid = fp.SmoothPhaseSpaceGrid(8.0, 13.0, (32, 32, 24, 36))
    p = found.density(grid)
    xi1, xi2, alpha, kappa = grid.mesh()
    across = xi2 * np.cos(alpha) - xi1 * np.sin(alpha)
    # Exponential tails: 1e-4 of the mass beyond the box.
    assert grid.cell_volume * (p * across * kappa).sum() == pytest.approx(-1, abs=1e-3)
    variance = grid.cell_volume * (p * xi1**2).sum()
    assert variance == pytest.approx(found.moments["variance_xi1"], abs=2e-3)
    assert found.density_error(grid) < 1e-2


@pytest.mark.parametrize(
    ("length", "noise"), [(0.1, 0.8), (0.3, 1.0), (1.0, 2.0), (1.0, 4.0), (2.0, 3.0)]
)
def test_the_errors_of_moments_cover_what_finer_truncations_change(length, noise):
    fine = fp.spectral_steady_state(smooth(length, noise), tolerance=1e-6)
    for tolerance in (1e-2, 1e-3, 1e-4):
        rough = fp.spectral_steady_state(smooth(length, noise), tolerance=tolerance)
        for name in ("variance_xi1", "mean_kappa2"):
            error = abs(rough.moments[name] - fine.moments[name])
            assert error <= rough.errors[name] + fine.errors[name]


# Slope of Var ξ1 in R at R = 0: ⟨q|ξ|²/2⟩ for the first order q of the density, by a
# Hermite-Fourier solution of L† q = 1 - X² (MATH §12), to all digits given.
SLOPES = {1.0: 1.20768669, 2.0: 2.24053166, 5.0: 12.5399574}


@pytest.mark.parametrize("noise", SLOPES)
def test_the_variance_grows_from_that_of_the_limit_as_first_order_theory_says(noise):
    lengths = np.array([4e-3, 2e-3, 1e-3])
    models = [smooth(length, noise) for length in lengths]
    found = [fp.spectral_steady_state(one, tolerance=1e-7) for one in models]
    slopes = (np.array([one.moments["variance_xi1"] for one in found]) - 1) / lengths
    errors = np.abs(slopes - SLOPES[noise])
    # The remainder is of first order in R: it halves with R to the next order.
    ratios = errors[:-1] / errors[1:]
    np.testing.assert_allclose(ratios, 2.0, rtol=0.1)


def test_moments_agree_with_sampled_paths():
    model = smooth(0.3, 2.0)
    found = fp.spectral_steady_state(model).moments
    start = ((0.0, 0.0), 0.0, 0.0)
    paths = fp.sample_paths(model, 20_000, 20.0, 0.05, seed=5, initial=start)
    for name, values in (
        ("variance_xi1", paths.xi[-1, :, 0] ** 2),
        ("mean_kappa2", paths.kappa[-1] ** 2),
    ):
        standard_error = values.std() / np.sqrt(values.size)
        # Weak error of the step 0.05 is below one standard error.
        assert abs(values.mean() - found[name]) < 4 * standard_error


def test_the_density_that_the_grid_evolves_to_has_these_moments():
    model = smooth(0.3, 2.0)
    grid = fp.SmoothPhaseSpaceGrid(6.0, 14.0, (24, 24, 16, 24))
    found = fp.spectral_steady_state(model, tolerance=1e-4)
    p = found.density(grid, tolerance=0.05)
    assert p.min() > -1e-3 * p.max()
    # Mass beyond the box: exponential tails.
    assert grid.cell_volume * p.sum() == pytest.approx(1.0, abs=1e-3)


def test_little_noise_is_refused_where_no_truncation_that_fits_is_enough():
    with pytest.raises(ToleranceError, match="choose a larger noise or use `steady_"):
        fp.spectral_steady_state(smooth(1.0, 0.2), memory_limit=1e8)


def test_without_a_tolerance_what_is_reached_is_returned_with_its_error():
    """Memory ends before 1e-8 here; the errors say so, and cover."""
    model = smooth(0.3, 1.2)
    found = fp.spectral_steady_state(model, memory_limit=2e7)
    finer = fp.spectral_steady_state(model, memory_limit=8e7)
    assert 1e-8 < found.errors["variance_xi1"] < 1e-3
    for name, error in found.errors.items():
        assert abs(found.moments[name] - finer.moments[name]) <= error
    with pytest.raises(ToleranceError, match="tolerance 1e-08 not reached"):
        fp.spectral_steady_state(model, tolerance=1e-8, memory_limit=2e7)


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (smooth(0.5, 0.0), "`noise` must be positive"),
        (smooth(1.0, 30.0), "`noise` must be at most 20 for the spectrum"),
        (
            fp.SmoothLayDownModel(fp.LinearPotential(), 0.5, 1.0),
            "`potential` must be a QuadraticPotential for the spectrum of a smooth",
        ),
    ],
)
def test_models_without_a_basis_are_refused(model, message):
    for function in (fp.spectral_steady_state, fp.spectrum, fp.spectral_gap):
        with pytest.raises(ValueError, match=message):
            function(model)


def test_the_gap_tends_to_that_of_the_basic_model_as_first_order_theory_says():
    """dλ/dR = 0.0127984857 at A = 3, by perturbation (MATH §12)."""
    limit = fp.spectral_gap(smooth(1.0, 3.0).white_noise_limit)
    lengths = np.array([0.008, 0.004])
    gaps = [fp.spectral_gap(smooth(one, 3.0), tolerance=1e-8) for one in lengths]
    slopes = (limit - np.array(gaps)) / lengths
    # Extrapolated to R = 0: what is left is of second order, 6e-4 of it.
    assert 2 * slopes[1] - slopes[0] == pytest.approx(0.0127984857, rel=1e-3)


@pytest.mark.nightly
def test_the_gap_covers_a_finer_one_and_scales_with_the_throwing_range():
    model = smooth(0.1, 2.0)
    rough, fine = (fp.spectral_gap(model, tolerance=one) for one in (1e-3, 1e-8))
    assert abs(rough - fine) <= rough.error + fine.error
    assert str(fine.sector) == "M = ±1"
    scaled = fp.spectral_gap(smooth(0.2, 2.0 / 2**0.5, 2.0), tolerance=1e-8)
    # The same matrix over two, to rounding.
    assert 2 * scaled == pytest.approx(fine, rel=1e-12)
    again = pickle.loads(pickle.dumps(fine))
    assert (again, again.error) == (fine, fine.error)


def test_the_density_mode_decays_with_the_gap_under_the_solver_on_a_grid():
    found = fp.spectrum(smooth(0.2, 3.0), 1, tolerance=1e-6)
    grid = fp.SmoothPhaseSpaceGrid(6.5, 20.0, (32, 32, 24, 32))
    q = found.density_mode(0, grid).real
    # Orthogonal to the constants: the trapezoidal rule, tails beyond the box.
    assert abs(q.sum()) < 1e-4 * np.abs(q).sum()
    p = fp.spectral_steady_state(found.model, tolerance=1e-4).density(grid)
    q *= 0.1 * p.max() / np.abs(q).max()
    scheme = fp.smooth_drift_kick(found.model, grid)
    lenient = {"boundary_tolerance": 1.0, "negative_tolerance": 1.0, "save_at": [1.0]}
    plus, minus = (
        fp.solve(scheme, p + sign * q, (0.0, 1.0), 0.1, **lenient).densities[-1]
        for sign in (1, -1)
    )
    error = np.abs((plus - minus) / 2 - np.exp(-found.gap) * q).sum()
    # The scheme is of second order in ds and of high order on the grid: one per cent.
    assert error < 0.01 * np.abs(q).sum()
