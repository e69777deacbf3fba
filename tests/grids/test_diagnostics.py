"""What is read off a density, against plain sums and closed forms."""

import math

import numpy as np
import pytest
from orders import assert_order, measure_order
from scipy.special import i0, i1

from fpsolve import initial
from fpsolve.grids.diagnostics import (
    boundary_mass,
    entropy_dissipation,
    entropy_floor,
    l1_distance,
    marginal,
    mass,
    moments,
    negative_mass,
    relative_entropy,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, QuadraticPotential

MEAN, COVARIANCE = (0.7, -0.4), np.array([[0.6, 0.2], [0.2, 0.4]])
ANGLE, CONCENTRATION = 0.9, 2.5
# Six standard deviations to every side, cells of half of one: the midpoint rule is
# then exact to rounding for a Gaussian (its error is e^{−2π²σ²/Δ²}).
FINE = PhaseSpaceGrid((6.0, 5.0), (48, 44, 32))


@pytest.fixture
def random_density(uneven_grid, rng):
    """Random values in (0, 1) on a grid of three different sizes."""
    return rng.uniform(0.01, 1.0, uneven_grid.shape)


@pytest.fixture(scope="module")
def gaussian_density():
    return initial.gaussian(FINE, MEAN, COVARIANCE, ANGLE, CONCENTRATION)


def test_mass_is_the_sum_times_the_volume_of_a_cell(random_density, uneven_grid):
    expected = math.fsum(random_density.ravel()) * uneven_grid.cell_volume
    assert mass(random_density, uneven_grid) == pytest.approx(expected, rel=1e-15)


def test_boundary_mass_is_the_share_of_the_outermost_cells(random_density, uneven_grid):
    p = random_density * np.where(random_density > 0.5, 1.0, -1.0)
    ring = np.zeros(uneven_grid.shape[:2], dtype=bool)
    ring[[0, -1], :] = ring[:, [0, -1]] = True
    # Of |p|: what is negative at the boundary is as wrong as what is positive.
    expected = np.abs(p)[ring].sum() / np.abs(p).sum()
    assert boundary_mass(p, uneven_grid) == pytest.approx(expected, rel=1e-14)


def test_negative_mass_is_the_integral_of_the_negative_part(uneven_grid, rng):
    p = rng.normal(size=uneven_grid.shape)
    expected = -math.fsum(p[p < 0]) * uneven_grid.cell_volume
    assert negative_mass(p, uneven_grid) == pytest.approx(expected, rel=1e-14)
    assert negative_mass(np.abs(p), uneven_grid) == 0.0


@pytest.mark.parametrize(
    ("which", "kept", "measure"),
    [("xi", (0, 1), 2), ("alpha", (2,), 0), ("xi1", (0,), 1), ("xi2", (1,), 3)],
)
def test_marginals_integrate_the_other_variables(
    random_density, uneven_grid, which, kept, measure
):
    d1, d2, d_alpha = uneven_grid.spacing
    measures = (d1 * d2, d2 * d_alpha, d_alpha, d1 * d_alpha)
    axes = tuple(axis for axis in range(3) if axis not in kept)
    expected = random_density.sum(axis=axes) * measures[measure]
    found = marginal(random_density, uneven_grid, which)
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_unknown_marginals_are_named(random_density, uneven_grid):
    with pytest.raises(ValueError, match=r"`which` must be one of 'xi', .* got 'beta'"):
        marginal(random_density, uneven_grid, "beta")


def test_moments_are_weighted_averages(random_density, uneven_grid):
    xi1, xi2, alpha = np.broadcast_arrays(*uneven_grid.mesh())
    weights = (random_density / random_density.sum()).ravel()
    covariance = np.cov(np.stack([xi1.ravel(), xi2.ravel()]), aweights=weights, ddof=0)
    expected = {
        "mean_xi1": np.average(xi1.ravel(), weights=weights),
        "mean_xi2": np.average(xi2.ravel(), weights=weights),
        "variance_xi1": covariance[0, 0],
        "variance_xi2": covariance[1, 1],
        "covariance": covariance[0, 1],
        "mean_cos_alpha": np.average(np.cos(alpha).ravel(), weights=weights),
        "mean_sin_alpha": np.average(np.sin(alpha).ravel(), weights=weights),
    }
    # Sums of 336 terms of size one.
    assert moments(random_density, uneven_grid) == pytest.approx(expected, abs=1e-14)


def test_moments_of_a_gaussian_are_its_parameters(gaussian_density):
    resultant = i1(CONCENTRATION) / i0(CONCENTRATION)
    expected = {
        "mean_xi1": MEAN[0],
        "mean_xi2": MEAN[1],
        "variance_xi1": COVARIANCE[0, 0],
        "variance_xi2": COVARIANCE[1, 1],
        "covariance": COVARIANCE[0, 1],
        "mean_cos_alpha": resultant * np.cos(ANGLE),
        "mean_sin_alpha": resultant * np.sin(ANGLE),
    }
    # e^{−2π²σ²/Δ²} with σ²/Δ² ≥ 5 is nothing; the cut tails are e^{−22}.
    assert moments(gaussian_density, FINE) == pytest.approx(expected, abs=1e-8)


def test_relative_entropy_is_the_sum_of_its_definition(
    random_density, uneven_grid, rng
):
    for shape in (uneven_grid.shape[:2], uneven_grid.shape):
        reference = rng.uniform(0.5, 1.5, shape)
        field = reference[:, :, None] if reference.ndim == 2 else reference
        terms = random_density * np.log(random_density / field)
        expected = terms.sum() * uneven_grid.cell_volume
        found = relative_entropy(random_density, uneven_grid, reference)
        assert found == pytest.approx(expected, rel=1e-13)


def test_relative_entropy_of_a_gaussian_has_a_closed_form(gaussian_density):
    # Kullback-Leibler divergence from N(m, C) × von Mises to N(0, 1) × uniform.
    mean = np.array(MEAN)
    plane = 0.5 * (
        np.trace(COVARIANCE) + mean @ mean - 2 - np.log(np.linalg.det(COVARIANCE))
    )
    resultant = i1(CONCENTRATION) / i0(CONCENTRATION)
    angle = CONCENTRATION * resultant - np.log(i0(CONCENTRATION))
    model = LayDownModel(QuadraticPotential(), 1.0)
    reference = model.equilibrium(*FINE.plane())
    # p_S is cut at 5: e^{−12.5}, weighted with p, which is smaller there; the sampled
    # density is normalised on the grid.
    found = relative_entropy(gaussian_density, FINE, reference)
    assert found == pytest.approx(plane + angle, abs=1e-8)


def test_relative_entropy_vanishes_at_the_reference_and_is_of_second_order(rng):
    grid = PhaseSpaceGrid(3.0, (6, 8, 10))
    reference = rng.uniform(0.5, 1.5, grid.shape)
    assert abs(relative_entropy(reference, grid, reference)) < 1e-16
    # H(r(1 + εf)|r) = ε²/2 ∫ r f² to the third order, with all its digits: no sum of
    # terms of size ε hides it.
    f = rng.normal(size=grid.shape)
    f -= (reference * f).sum() / reference.sum()
    for size in (1e-3, 1e-6, 1e-8):
        expected = size**2 / 2 * (reference * f**2).sum() * grid.cell_volume
        found = relative_entropy(reference * (1 + size * f), grid, reference)
        # Third order, and the rounding of 1 + εf: eps/ε per cell, averaged.
        assert found == pytest.approx(expected, rel=10 * size + 1e-7)


def test_cells_that_are_zero_or_negative_count_as_their_limit(uneven_grid):
    p = np.ones(uneven_grid.shape)
    p[0] = 0.0
    reference = np.ones(uneven_grid.shape)
    # ∫ p ln p = 0, and x ln x → 0.
    assert relative_entropy(p, uneven_grid, reference) == pytest.approx(0.0, abs=1e-12)
    p[0] = -1e-20
    assert relative_entropy(p, uneven_grid, reference) == pytest.approx(0.0, abs=1e-12)


def test_a_density_without_mass_has_no_entropy(uneven_grid):
    reference = np.ones(uneven_grid.shape)
    assert math.isnan(relative_entropy(-reference, uneven_grid, reference))


@pytest.mark.parametrize(
    "potential", [QuadraticPotential(), LinearPotential()], ids=repr
)
def test_the_floor_is_the_entropy_of_the_equilibrium_on_the_grid(potential):
    grid = PhaseSpaceGrid(5.0, (20, 22, 8))
    reference = LayDownModel(potential, 1.0).equilibrium(*grid.plane())
    restricted = initial.equilibrium(grid, potential)
    floor = entropy_floor(grid, reference)
    # Rounding of a sum of terms of size one.
    found = relative_entropy(restricted, grid, reference)
    assert found == pytest.approx(floor, abs=1e-14)
    # Nothing of the same mass on this grid has less.
    other = initial.gaussian(grid, variance=1.5)
    assert relative_entropy(other, grid, reference) > floor


def test_dissipation_of_a_von_mises_angle_has_a_closed_form(gaussian_density):
    # D ∫ p (∂_α ln p)² = D κ² E sin²(α − α₀) = D κ I₁(κ)/I₀(κ).
    resultant = i1(CONCENTRATION) / i0(CONCENTRATION)
    noise = 1.3
    expected = noise**2 / 2 * CONCENTRATION * resultant
    found = entropy_dissipation(gaussian_density, FINE, noise)
    # Order 8 with 32 angles: 1e-7 measured.
    assert found == pytest.approx(expected, rel=1e-6)


def test_dissipation_is_of_order_eight_in_the_angle():
    resultant = i1(CONCENTRATION) / i0(CONCENTRATION)

    def error_of(n_alpha):
        grid = PhaseSpaceGrid(6.0, (16, 16, n_alpha))
        p = initial.gaussian(grid, (0, 0), 1.0, ANGLE, CONCENTRATION)
        found = entropy_dissipation(p, grid, np.sqrt(2.0))
        return abs(found / (CONCENTRATION * resultant) - 1)

    assert_order(measure_order(error_of, first=24), 8, 1e-8)


def test_references_that_depend_on_the_angle_enter_the_dissipation():
    # p ∝ e^{κ cos(α − α₀)}, r ∝ e^{λ cos(α − α₀)}: ∂_α ln(p/r) has κ − λ for κ.
    grid = PhaseSpaceGrid(6.0, (16, 16, 64))
    p = initial.gaussian(grid, (0, 0), 1.0, ANGLE, 2.0)
    reference = initial.gaussian(grid, (0, 0), 1.5, ANGLE, 1.2)
    resultant = i1(2.0) / i0(2.0)
    expected = 0.5 * (2.0 - 1.2) ** 2 * resultant / 2.0
    found = entropy_dissipation(p, grid, 1.0, reference)
    # Order 8 at 64 angles.
    assert found == pytest.approx(expected, rel=1e-8)
    # One that does not depend on it drops out.
    uniform = initial.gaussian(grid, (0, 0), 1.5)
    plain = entropy_dissipation(p, grid, 1.0)
    assert entropy_dissipation(p, grid, 1.0, uniform) == pytest.approx(plain, rel=1e-10)


def test_dissipation_is_zero_without_noise_and_for_uniform_angles(gaussian_density):
    assert entropy_dissipation(gaussian_density, FINE, 0.0) == 0.0
    uniform = initial.gaussian(FINE, variance=0.8)
    # Differences of equal numbers.
    assert entropy_dissipation(uniform, FINE, 1.0) <= 1e-28


def test_distance_in_l1_is_the_integral_of_the_difference(uneven_grid, rng):
    p, q = rng.normal(size=(2, *uneven_grid.shape))
    expected = math.fsum(np.abs(p - q).ravel()) * uneven_grid.cell_volume
    assert l1_distance(p, q, uneven_grid) == pytest.approx(expected, rel=1e-14)
