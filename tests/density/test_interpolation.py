"""Order in Δξ and Δα of every interpolation, at every halving."""

import numpy as np
import pytest
from kernel_cases import at_rest
from orders import assert_order, measure_order
from problems import FreeStreaming, FrozenRotation

from fpsolve._kernels.characteristics import Displacement, interpolate_at_feet
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.stencils import flux_weights, lagrange_weights
from fpsolve.density.schemes.translation import Translation
from fpsolve.density.solve import solve
from fpsolve.grids.diagnostics import l1_distance
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import (
    EllipticNozzle,
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
    TabulatedCurve,
)
from fpsolve.model.potentials import QuadraticPotential

STOPS = np.linspace(0.0, 2.0, 21)
CURVES = [
    FixedBelt(),
    MovingBelt(0.3),
    RotatingNozzle(0.1, 0.5, 1.0),
    OscillatingNozzle(0.1, 0.5, 1.0, 0.3),
    EllipticNozzle(0.1, 0.5, 0.3, 1.0),
    TabulatedCurve(STOPS, -0.1 * STOPS, 0.3 * np.sin(STOPS)),
]
# Order: cells of the coarsest grid, ceiling of the error on the finest, four times as
# fine (measured 1.2e-5, 1.3e-7 and 5.4e-10). Higher orders are asymptotic later.
TRANSLATIONS = {4: (40, 5e-5), 6: (40, 8e-7), 8: (48, 3e-9)}


@pytest.mark.parametrize("positive", [False, True])
@pytest.mark.parametrize("order", TRANSLATIONS)
def test_a_translation_is_of_the_order_of_its_stencil(order, positive):
    # One shift of a Gaussian by about 1.2 along both axes and by a whole number of
    # cells and a half, the fraction with the largest error: another fraction on every
    # grid would hide the order. Where the interpolant is negative `positive` clamps,
    # but that is in the tails.
    first, ceiling = TRANSLATIONS[order]

    def error_of(n):
        problem = FreeStreaming(PhaseSpaceGrid(6.0, (n, n, 4)))
        ds = half_cell_step(problem.grid)
        translate = Translation(problem.model, problem.grid, order, positive)
        out = np.empty(problem.grid.shape)
        translate(problem.initial(), 0.0, ds, out)
        return l1_distance(out, problem.density(ds), problem.grid)

    assert_order(measure_order(error_of, first), order, ceiling)


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: type(curve).__name__)
def test_a_translation_follows_every_reference_curve_exactly(curve):
    # Order 16 on a Gaussian of 2.8 cells; a first-order treatment of γ′ would show as
    # |γ″| ds²/2 = 0.1.
    problem = FreeStreaming(PhaseSpaceGrid(8.0, (64, 64, 16)), curve=curve)
    translate = Translation(problem.model, problem.grid, 16)
    middle, end = np.empty((2, *problem.grid.shape))
    translate(problem.initial(), 0.0, 0.7, middle)
    translate(middle, 0.7, 0.6, end)
    # 2.6e-7 measured.
    assert l1_distance(end, problem.density(1.3), problem.grid) < 1e-6


def feet_anywhere(n):
    """Shape and sizes of a box, its cells, and a random foot for each of them."""
    shape = (n, n + 2, n + 4)
    sizes = np.array(shape).reshape(3, 1, 1, 1)
    cells = np.indices(shape).astype(float)
    shifts = np.random.default_rng(5).uniform(-0.5, 0.5, (3, *shape))
    return shape, sizes, cells, cells + shifts * sizes


@pytest.mark.parametrize(("n_points", "ceiling"), [(4, 5e-5), (6, 3e-7)])
def test_values_at_feet_are_of_the_order_of_their_stencil(n_points, ceiling):
    # A smooth periodic function at random feet, in all three directions at once.
    def error_of(n):
        shape, sizes, cells, feet = feet_anywhere(n)

        def function(places):
            x, y, z = 2 * np.pi * places / sizes
            return np.sin(x) * np.cos(y) + np.sin(z + x)

        out, ones = np.empty(shape), np.ones((1, 1, 1))
        interpolate_at_feet(
            function(cells), feet, ones, at_rest(shape), n_points, False, ones[:0], out
        )
        return np.abs(out - function(feet)).mean()

    assert_order(measure_order(error_of, first=16), n_points, ceiling)


@pytest.mark.parametrize("n_points", [4, 6])
def test_what_moving_the_feet_changes_is_a_derivative_of_second_order(n_points):
    # |δ·∇h − (δ·∇B) h| of a smooth periodic function, with δ the same part of the box
    # on every grid.
    def error_of(n):
        shape, sizes, cells, feet = feet_anywhere(n)
        ones, line, plane = np.ones(shape[2]), np.zeros(shape[2]), np.ones(shape[:2])
        move1, move2, turn = 0.3 * n, -0.2 * (n + 2), 0.1 * (n + 4)
        displacement = Displacement(
            move1 * ones, move2 * ones, plane, plane, line, ones, turn, 0.4 * ones, line
        )
        x, y, z = 2 * np.pi * cells / sizes
        h = np.sin(x) * np.cos(y) + np.sin(z + x)
        changes, out = np.empty(shape), np.empty(shape)
        growth = np.full(shape, 2.0)
        interpolate_at_feet(
            h, feet, growth, displacement, n_points, False, changes, out
        )
        x, y, z = 2 * np.pi * feet / sizes
        along = 0.3 * (np.cos(x) * np.cos(y) + np.cos(z + x))
        along += 0.2 * np.sin(x) * np.sin(y) + 0.1 * np.cos(z + x)
        value = np.sin(x) * np.cos(y) + np.sin(z + x)
        expected = 2.0 * np.abs(2 * np.pi * along - 0.4 * value)
        return np.abs(changes - expected).mean()

    # 4.5e-3 with either stencil.
    assert_order(measure_order(error_of, first=16), 2, 1e-2)


@pytest.mark.parametrize(("order", "ceiling"), [(4, 5e-5), (6, 8e-7)])
def test_the_characteristics_are_of_the_order_of_their_stencil(order, ceiling):
    # The same shift as above, through feet and their interpolation.
    def error_of(n):
        problem = FreeStreaming(PhaseSpaceGrid(6.0, (n, n, 4)))
        ds = half_cell_step(problem.grid)
        scheme = semi_lagrangian(problem.model, problem.grid, interpolation_order=order)
        solution = solve(scheme, problem.initial(), (0.0, ds), ds)
        return l1_distance(solution.final, problem.density(ds), problem.grid)

    assert_order(measure_order(error_of, first=40), order, ceiling)


def half_cell_step(grid):
    """A step near 1.7 that shifts by half a cell more than whole ones at 45°."""
    spacing = grid.spacing[0]
    return np.sqrt(2.0) * spacing * (np.floor(1.2 / spacing) + 0.5)


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize("n_alpha", [16, 32, 64])
def test_the_rotation_is_exact_up_to_the_modes_its_angles_hold(n_alpha, balanced):
    # Carrying modes 1 and 2 by the Möbius flow with a = tanh(|∇B| ds/2) = 0.37 leaves
    # coefficients a^m with a factor of order m (m² with the Jacobian); what is cut at
    # M = n_alpha/2 is the error. 0.024, 1.2e-5 and 5.5e-12 measured for densities.
    modes = n_alpha // 2
    assert rotation_error(n_alpha, balanced) < 2 * modes**2 * 0.37**modes


def rotation_error(n_alpha, balanced):
    problem = FrozenRotation(
        QuadraticPotential(1.0, 0.8),
        PhaseSpaceGrid(2.0, (6, 6, n_alpha)),
        lambda alpha: 1.0 + 0.5 * np.cos(alpha - 1.0) + 0.2 * np.sin(2 * alpha),
    )
    out = np.empty(problem.grid.shape)
    turn = RotationDiffusion(problem.model, problem.grid, balanced)
    turn(problem.initial(), 0.0, 0.25, out)
    exact = problem.observable(0.25) if balanced else problem.density(0.25)
    return np.abs(out - exact).max()


@pytest.mark.parametrize("order", range(2, 17, 2))
def test_lagrange_weights_sum_to_one_and_reproduce_polynomials(order):
    fractions = np.array([0.0, 0.1, 1 / 3, 0.5, 0.77, 1 - 1e-12])
    taps = np.arange(1 - order // 2, order // 2 + 1)
    weights = lagrange_weights(fractions, order)
    # Fixed to the last digit of the sum; numpy's own additions round.
    np.testing.assert_allclose(weights.sum(axis=0), 1.0, rtol=0, atol=4e-16)
    for degree in range(order):
        # In units of the largest node, where powers and weights stay of size one.
        scale = order / 2
        reproduced = (taps / scale) ** degree @ weights
        np.testing.assert_allclose(
            reproduced, (fractions / scale) ** degree, rtol=0, atol=4e-15
        )


@pytest.mark.parametrize("order", range(2, 17, 2))
def test_differences_of_fluxes_are_the_shift(order):
    # p_i − (F_{i+½} − F_{i−½}) has the taps of the shift: δ_{t0} − c_t + c_{t−1}.
    fractions = np.array([0.0, 0.3, 0.9])
    fluxes = flux_weights(fractions, order)
    here = (np.arange(1 - order // 2, order // 2 + 1) == 0)[:, None]
    empty = np.zeros((1, fractions.size))
    difference = np.vstack([fluxes, empty]) - np.vstack([empty, fluxes])
    np.testing.assert_allclose(
        here - difference, lagrange_weights(fractions, order), rtol=0, atol=1e-15
    )


def test_a_shift_by_whole_cells_moves_the_array():
    # Δξ = 1/2 and a step of 1: along the axes by two cells, exactly.
    grid = PhaseSpaceGrid(3.0, (12, 12, 4))
    problem = FreeStreaming(grid)
    translate = Translation(problem.model, grid, 8)
    p = np.random.default_rng(3).uniform(size=grid.shape)
    step = 2 * 0.5 * np.sqrt(2.0)
    out = np.empty_like(p)
    translate(p, 0.0, step, out)
    for k, (along1, along2) in enumerate([(2, 2), (-2, 2), (-2, -2), (2, -2)]):
        moved = np.roll(p[:, :, k], (along1, along2), axis=(0, 1))
        # cos(π/4) √2 is one to rounding, and so is the weight of the node.
        np.testing.assert_allclose(out[:, :, k], moved, rtol=0, atol=1e-14)


@pytest.mark.parametrize("order", [4, 6])
def test_interpolation_dominates_where_steps_are_small(order):
    # The same end reached in more steps is interpolated more often: the error of free
    # streaming grows with the number of steps, as the class says.
    problem = FreeStreaming(PhaseSpaceGrid(6.0, (40, 40, 16)))
    scheme = drift_kick(problem.model, problem.grid, interpolation_order=order)
    errors = [
        l1_distance(
            solve(scheme, problem.initial(), (0.0, 1.0), ds).final,
            problem.density(1.0),
            problem.grid,
        )
        for ds in (0.5, 0.125, 0.03125)
    ]
    assert errors[0] < errors[1] < errors[2]
