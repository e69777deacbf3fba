"""∂ₛ𝒫 = ∇·(ε∇ + ε∇B − v e₁)𝒫: what is exact on every grid."""

import math

import numpy as np
import pytest

from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit
from fpsolve.reduced.hydrodynamic.scharfetter_gummel import bernoulli, generator

EPS = np.finfo(float).eps
BELT = MovingBelt(0.1)
MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, BELT)
EXACT = OrnsteinUhlenbeckLimit(MODEL, (1.0, -0.5), [[0.5, 0.2], [0.2, 0.4]])
GRID = PlaneGrid((5.0, 4.0), (40, 32))
MODELS = {
    "quadratic": MODEL,
    "linear": LayDownModel(LinearPotential(2.0), 1.5, BELT),
    "quartic": LayDownModel(PowerPotential(4.0), 1.0, MovingBelt(-0.3)),
    "double well": LayDownModel(
        CallablePotential(
            lambda x, y: x**4 / 4 - x**2 + y**2,
            lambda x, y: (x**3 - 2 * x + 0 * y, 2 * y + 0 * x),
        ),
        1.0,
        BELT,
    ),
}


@pytest.fixture(params=MODELS.values(), ids=MODELS.keys())
def limit(request):
    return HydrodynamicLimit(request.param)


def narrow(xi1, xi2):
    return np.exp(-8 * ((xi1 - 0.7) ** 2 + (xi2 + 0.4) ** 2))


def l1(p, q, grid):
    return float(np.abs(p - q).sum()) * grid.cell_area


def test_the_bernoulli_function_is_accurate_for_every_argument():
    x = np.array([-800.0, -30.0, -1.0, -1e-5, -1e-9, 0.0, 1e-9, 1e-5, 1.0, 30.0])
    exact = [float(-t) if t < -100 else t / math.expm1(t) if t else 1.0 for t in x]
    np.testing.assert_allclose(bernoulli(x), exact, rtol=4 * EPS)
    # The relation that detailed balance rests on, down to where eˣ underflows.
    x = np.linspace(0.0, 700.0, 50)
    forward, back = bernoulli(x), bernoulli(-x) * np.exp(-x)
    np.testing.assert_allclose(forward, back, rtol=4 * EPS)
    assert bernoulli(np.array([1e4])) == 0.0


def test_the_generator_keeps_mass_has_positive_rates_and_balances_in_detail(limit):
    matrix = limit.generator(GRID)
    dense = matrix.toarray()
    rates = np.abs(dense.diagonal())
    # Columns are sums of four rates of either sign.
    assert np.all(np.abs(dense.sum(axis=0)) <= 8 * EPS * rates)
    assert (dense - np.diag(dense.diagonal())).min() >= 0
    mass = limit.equilibrium(*GRID.mesh()).ravel()
    flow = dense * mass
    # exp(−Φ) is exact to EPS Φ, and Φ goes up to 200 here.
    assert np.all(np.abs(flow - flow.T) <= 1e3 * EPS * np.abs(flow))


def test_the_fluxes_are_exact_where_the_potential_is_linear():
    # Φ = a ξ1: constants flow with the drift, εa/h out of each side of a cell.
    n, h, a, epsilon = 5, 0.3, 1.7, 0.25
    phi = np.repeat(a * h * np.arange(n)[:, None], 2, axis=1)
    net = (generator(phi, (h, 1.0), epsilon) @ np.ones(2 * n)).reshape(n, 2)
    expected = np.zeros((n, 2))
    expected[0], expected[-1] = epsilon * a / h, -epsilon * a / h
    np.testing.assert_allclose(net, expected, atol=1e-14)


def test_the_steady_state_is_the_gibbs_density_at_the_centres(limit):
    steady = limit.steady_state(GRID, boundary_tolerance=0.1)
    gibbs = limit.equilibrium(*GRID.mesh())
    gibbs /= gibbs.sum() * GRID.cell_area
    # exp(−Φ) is exact to EPS Φ.
    np.testing.assert_allclose(steady.density, gibbs, rtol=1e3 * EPS)
    assert steady.density.sum() * GRID.cell_area == pytest.approx(1.0, abs=4 * EPS)
    # Rates are about ε/h² = 20, times the mass of one.
    assert steady.residual < 100 * EPS * 20


@pytest.mark.parametrize("half_width", [3.5, 5.0])
def test_its_error_on_the_plane_covers_box_and_cells(limit, half_width):
    grid = PlaneGrid(half_width, (20, 20))
    steady = limit.steady_state(grid, boundary_tolerance=1.0)
    exact = limit.equilibrium(*grid.mesh())
    inside = np.abs(steady.density - exact).sum() * grid.cell_area
    fine = PlaneGrid(half_width, (200, 200))
    outside = 1 - limit.equilibrium(*fine.mesh()).sum() * fine.cell_area
    assert 0 < inside + outside <= steady.error + 100 * EPS
    assert f"L1 error {steady.error:.1g}" in repr(steady)


def test_the_stationary_vector_of_the_matrix_is_that_density(limit):
    # An independent way: the null vector of Q by a dense decomposition.
    grid = PlaneGrid((4.0, 3.0), (16, 12))
    _, _, right = np.linalg.svd(limit.generator(grid).toarray())
    found = np.abs(right[-1]) / np.abs(right[-1]).sum() / grid.cell_area
    steady = limit.steady_state(grid, boundary_tolerance=0.5).density.ravel()
    # The decomposition is exact to EPS relative to the largest entry.
    assert np.abs(found - steady).max() < 1e-11 * steady.max()


@pytest.mark.parametrize("method", ["sdirk2", "backward_euler"])
@pytest.mark.parametrize("half_width", [4.0, 8.0])
def test_the_gibbs_density_stays_in_every_cell(limit, method, half_width):
    grid = PlaneGrid(half_width, (40, 40))
    start = limit.steady_state(grid, boundary_tolerance=0.1).density
    arguments = {"grid": grid, "method": method, "boundary_tolerance": 0.1}
    end = limit.solve(start, (0.0, 20.0), 0.2, **arguments).densities[-1]
    # A hundred steps of an error of a few EPS Φ each, in cells where the density does
    # not underflow: relative to the cell, not to the maximum.
    held = start > 1e-290
    assert np.abs(end[held] / start[held] - 1.0).max() < 1e-11
    assert l1(end, start, grid) < 1e-13


@pytest.mark.parametrize("method", ["sdirk2", "backward_euler"])
def test_mass_is_kept_to_rounding_over_a_thousand_steps(limit, method):
    grid = PlaneGrid(5.0, (24, 24))
    solution = limit.solve(
        narrow,
        (0.0, 100.0),
        0.1,
        grid=grid,
        method=method,
        boundary_tolerance=0.2,
    )
    assert np.abs(solution.mass - 1.0).max() < 8 * EPS


@pytest.mark.parametrize("ds", [1e-3, 0.1, 20.0])
def test_backward_euler_keeps_densities_positive_and_the_entropy_falling(limit, ds):
    solution = limit.solve(
        narrow,
        (0.0, 40 * ds),
        ds,
        grid=PlaneGrid(4.0, (32, 32)),
        method="backward_euler",
        boundary_tolerance=0.2,
    )
    # Zero where 1e-308 is not enough: the corners of the quartic potential.
    assert solution.minimum.min() >= 0
    # At equilibrium entropies are sums of squares of rounding errors.
    assert np.diff(solution.relative_entropy).max() <= 1e-26
    assert solution.entropy_dissipation.min() >= 0


def test_entropy_falls_by_its_dissipation():
    solution = HydrodynamicLimit(MODEL).solve(
        EXACT.density, (0.0, 1.0), 0.01, grid=GRID, extrapolate=True, method="sdirk2"
    )
    entropy, rate = solution.relative_entropy, solution.entropy_dissipation
    # Simpson's rule over two steps of 0.01: an error of order 1e-10.
    loss = (rate[:-2:2] + 4 * rate[1::2] + rate[2::2]) * 0.01 / 3
    np.testing.assert_allclose(entropy[:-2:2] - entropy[2::2], loss, atol=1e-8)


def test_reflections_and_rotations_of_the_problem_are_those_of_the_solution():
    limit = HydrodynamicLimit(LayDownModel(PowerPotential(3.0), 1.5))
    grid = PlaneGrid(4.0, (24, 24))
    start = grid.evaluate(narrow)
    start /= start.sum() * grid.cell_area

    def evolve(p):
        return limit.solve(p, (0.0, 1.0), 0.1, grid=grid).densities[-1]

    end = evolve(start)
    for turn in (np.transpose, np.flipud, np.rot90):
        # The order of elimination differs: a few EPS of the maximum.
        np.testing.assert_allclose(
            evolve(np.ascontiguousarray(turn(start))),
            turn(end),
            atol=1e-13 * end.max(),
        )


def test_a_belt_in_the_other_direction_mirrors_the_solution():
    right, left = (
        HydrodynamicLimit(LayDownModel(LinearPotential(2.0), 1.5, MovingBelt(v)))
        for v in (0.3, -0.3)
    )
    grid = PlaneGrid((7.0, 6.0), (28, 24))
    start = grid.evaluate(narrow)
    arguments = {"grid": grid, "boundary_tolerance": 0.1}
    there = right.solve(start, (0.0, 2.0), 0.1, **arguments)
    back = left.solve(start[::-1].copy(), (0.0, 2.0), 0.1, **arguments)
    scale = there.densities.max()
    np.testing.assert_allclose(
        back.densities[0, ::-1], there.densities[0], atol=1e-13 * scale
    )


def test_the_equilibrium_of_the_quadratic_potential_is_the_shifted_gaussian():
    limit = HydrodynamicLimit(MODEL)
    xi1, xi2 = GRID.mesh()
    mean1 = 4.0 * 0.1
    expected = np.exp(-((xi1 - mean1) ** 2) / 2 - xi2**2 / 1.28) / (1.6 * math.pi)
    np.testing.assert_allclose(limit.equilibrium(xi1, xi2), expected, rtol=1e-13)


def test_equilibria_are_normalised_on_the_plane(limit):
    # Midpoint sums over a wide box: exact for smooth densities, of order two at the
    # kink of the linear one.
    grid = PlaneGrid(24.0, (480, 480))
    mass = limit.equilibrium(*grid.mesh()).sum() * grid.cell_area
    assert mass == pytest.approx(1.0, abs=1e-3)
    if not isinstance(limit.model.potential, LinearPotential):
        assert mass == pytest.approx(1.0, abs=1e-8)


def test_quadrature_and_closed_form_of_the_normalisation_agree():
    belt = MovingBelt(0.9)
    for own, wrapped in (
        (
            PowerPotential(1.0, 0.5),
            IsotropicPotential(lambda r: 2 * r, lambda r: 2.0 + 0 * r),
        ),
        (QuadraticPotential(), IsotropicPotential(lambda r: r**2 / 2, lambda r: r)),
    ):
        closed, numeric = (
            HydrodynamicLimit(LayDownModel(potential, 1.2, belt)).equilibrium(0.3, 0.1)
            for potential in (own, wrapped)
        )
        # The quadrature promises 1e-6 at a kink.
        assert numeric == pytest.approx(float(closed), rel=1e-6)


def test_a_narrow_density_far_from_the_origin_is_normalised_too():
    # Mean A²v = 80, exp(−Φ) up to exp(3200).
    model = LayDownModel(QuadraticPotential(), 10.0, MovingBelt(0.8))
    assert HydrodynamicLimit(model).equilibrium(80.0, 0.0) == pytest.approx(
        1 / (2 * math.pi), rel=1e-11
    )
    wrapped = IsotropicPotential(lambda r: r**2 / 2, lambda r: r)
    model = LayDownModel(wrapped, 10.0, MovingBelt(0.8))
    assert HydrodynamicLimit(model).equilibrium(80.0, 0.0) == pytest.approx(
        1 / (2 * math.pi), rel=1e-6
    )
