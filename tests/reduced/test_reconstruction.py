"""p ≈ 𝒫/2π + ε p₁: the factor of p₁, its exact properties, and its order in ε."""

import math

import numpy as np
import pytest
from orders import assert_order, measure_order

import fpsolve as fp
from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, PowerPotential, QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit
from fpsolve.reduced.hydrodynamic.reconstruction import balanced_gradient

GRID = PhaseSpaceGrid((6.0, 5.0), (48, 40, 8))
PLANE = PlaneGrid.of(GRID)


@pytest.mark.parametrize("potential", [QuadraticPotential(), LinearPotential(2.0)])
def test_on_a_belt_at_rest_the_equilibrium_has_no_first_order_term(potential):
    limit = HydrodynamicLimit(LayDownModel(potential, 2.0))
    density = limit.equilibrium(*PLANE.mesh())
    p = limit.reconstruct(density, GRID)
    flat = np.broadcast_to(density[:, :, None] / (2 * math.pi), GRID.shape)
    # Differences of equal numbers, relative to the cell: e^{B} is exact to EPS B.
    np.testing.assert_allclose(p, flat, rtol=1e-12)


@pytest.mark.parametrize("order", [0, 1])
def test_the_integral_over_the_angle_is_the_plane_density(order):
    limit = HydrodynamicLimit(LayDownModel(PowerPotential(3.0), 2.0, MovingBelt(0.1)))
    density = PLANE.evaluate(lambda x, y: np.exp(-((x - 1) ** 2) - (y - 0.5) ** 2))
    p = limit.reconstruct(density, GRID, order=order)
    marginal = p.sum(axis=2) * GRID.spacing[2]
    # Sums of eight terms, of which those of p₁ cancel.
    np.testing.assert_allclose(marginal, density, atol=1e-12 * np.abs(p).max())


def test_the_mean_direction_is_against_the_belt():
    # ∫ cos α p = −ε(∂₁ + ∂₁B)𝒫_S = −v 𝒫_S, exactly in the limit.
    limit = HydrodynamicLimit(LayDownModel(QuadraticPotential(), 2.0, MovingBelt(0.1)))
    p = limit.reconstruct(limit.steady_state(GRID).density, GRID)
    along = (p * np.cos(GRID.alpha)).sum() * GRID.cell_volume
    across = (p * np.sin(GRID.alpha)).sum() * GRID.cell_volume
    # The balanced difference is sinh(w h)/h for w = v/ε, here 0.4 with h = 0.25: a
    # relative error of (w h)²/6.
    assert along == pytest.approx(-0.1, rel=2 * (0.4 * 0.25) ** 2 / 6)
    assert abs(across) < 1e-12


def test_the_gradient_is_of_order_two_at_every_halving():
    potential = PowerPotential(3.0)
    model = LayDownModel(QuadraticPotential(), 2.0)
    exact = OrnsteinUhlenbeckLimit(model, (0.3, 0.2), [[0.6, 0.1], [0.1, 0.4]])
    precision = np.linalg.inv(exact.covariance_at_start)

    def error(n):
        plane = PlaneGrid(3.0, (n, n))
        xi1, xi2 = np.broadcast_arrays(*plane.mesh())
        p = exact.density(xi1, xi2)
        away = np.stack([xi1 - 0.3, xi2 - 0.2], axis=-1) @ precision
        slopes = potential.gradient(xi1, xi2)
        found = balanced_gradient(p, plane, potential)
        return max(
            np.abs(found[i] - p * (slopes[i] - away[..., i])).max() for i in (0, 1)
        )

    # Interior and walls alike. Ceiling: twice what was measured.
    assert_order(measure_order(error, 40, 2), 2, 8e-3)


def test_a_plane_of_two_cells_has_one_difference():
    plane = PlaneGrid(1.0, (2, 2))
    found = balanced_gradient(
        np.array([[1.0, 2.0], [4.0, 8.0]]), plane, LinearPotential()
    )
    # Both centres are equally far from the origin, so B drops out.
    np.testing.assert_allclose(found[0], [[3.0, 6.0], [3.0, 6.0]])
    np.testing.assert_allclose(found[1], [[1.0, 1.0], [4.0, 4.0]])


def test_the_stationary_density_of_the_full_equation_confirms_factor_and_order():
    # v = ε, so that 𝒫_S does not depend on ε: without p₁ the joint density is wrong
    # by O(ε), with it by O(ε²). The reference is the spectral expansion.
    grid = PhaseSpaceGrid(6.0, (96, 96, 16))

    def error(doublings, order):
        noise = 2.0 * 2 ** (doublings / 2)
        epsilon = noise**-2
        model = LayDownModel(QuadraticPotential(), noise, MovingBelt(epsilon))
        limit = HydrodynamicLimit(model)
        reference = fp.spectral_steady_state(model, tolerance=1e-9).density(grid)
        density = limit.equilibrium(*grid.plane())
        p = limit.reconstruct(density, grid, order=order)
        return np.abs(p - reference).sum() * grid.cell_volume

    for order in (0, 1):
        errors = np.array([error(doublings, order) for doublings in (0, 1, 2)])
        observed = np.log2(errors[:-1] / errors[1:])
        # The next term is ε = 1/4 at the coarsest; the gradient of the grid leaves
        # (h/2)² ε/6 = 1e-5 here. A wrong factor or sign gives order one.
        assert np.all(np.abs(observed - (order + 1)) < 0.3), (order, errors)


def test_a_steep_start_gives_a_negative_density_that_is_not_clipped():
    limit = HydrodynamicLimit(LayDownModel(QuadraticPotential(), 1.0))
    density = PLANE.evaluate(lambda x, y: np.exp(-2 * ((x - 2) ** 2 + y**2)))
    assert limit.reconstruct(density, GRID).min() < 0


def test_a_steep_potential_does_not_overflow():
    grid = PhaseSpaceGrid(8.0, (16, 16, 8))
    limit = HydrodynamicLimit(LayDownModel(PowerPotential(4.0), 1.0))
    density = limit.equilibrium(*grid.plane())
    assert np.isfinite(limit.reconstruct(density, grid)).all()


def test_what_cannot_be_reconstructed_is_refused():
    limit = HydrodynamicLimit(LayDownModel(QuadraticPotential(), 1.0))
    with pytest.raises(ValueError, match="`order` must be 0 or 1, got 2"):
        limit.reconstruct(np.ones(PLANE.shape), GRID, order=2)
    with pytest.raises(GridMismatchError, match=r"`P` must have the shape \(48, 40\)"):
        limit.reconstruct(np.ones((40, 48)), GRID)
    for fill in (limit.reconstruct, limit.initial_layer):
        with pytest.raises(TypeError, match="`grid` must be a PhaseSpaceGrid"):
            fill(np.ones(PLANE.shape), PLANE)
