"""B = 0, the persistent random walk: moments in closed form."""

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import PersistentRandomWalk

from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential

# Nothing reaches the boundary, where the walk would come back on the other side: the
# mass beyond 8 from a Gaussian of variance 1/2 carried by 2 is e^{−36}, and the ripples
# of its interpolation on cells of 0.4 die out before.
GRID = PhaseSpaceGrid(8.0, (40, 40, 16))
WALKS = {noise: PersistentRandomWalk(noise, GRID, 0.5) for noise in (0.5, 1.0, 2.0)}
SCHEMES = {
    "drift-kick": (drift_kick, {}),
    "drift-kick balanced": (drift_kick, {"balanced": True}),
    "semi-Lagrangian": (semi_lagrangian, {"interpolation_order": 6}),
}


def walked(walk, name, n_steps, s_end=2.0, **options):
    scheme, scheme_options = SCHEMES[name]
    built = scheme(walk.model, walk.grid, **scheme_options)
    return solve(built, walk.initial(), (0.0, s_end), s_end / n_steps, **options)


def mean_square(solution):
    """E|ξ|²."""
    return (
        solution.variance_xi1 + solution.mean_xi1**2
        + solution.variance_xi2 + solution.mean_xi2**2
    )  # fmt: skip


@pytest.mark.parametrize("name", ["drift-kick", "drift-kick balanced"])
@pytest.mark.parametrize("noise", WALKS)
def test_the_mean_direction_decays_exactly(noise, name):
    # The shift leaves the angle alone and the diffusion is exact: rounding of 20 steps.
    walk = WALKS[noise]
    solution = walked(walk, name, 20)
    start = solution.mean_cos_alpha[0], solution.mean_sin_alpha[0]
    expected = walk.direction(solution.s[:, None], start)
    found = np.stack([solution.mean_cos_alpha, solution.mean_sin_alpha], axis=1)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("noise", WALKS)
def test_means_and_mean_squares_are_second_order_in_the_step(noise):
    # Lagrange weights shift moments below their order exactly, so that these errors
    # are those of the splitting alone: trapezoidal sums of e^{−Ds}.
    walk = WALKS[noise]

    def error_of(n_steps):
        solution = walked(walk, "drift-kick", n_steps)
        spread = mean_square(solution)
        return np.abs(spread - spread[0] - walk.mean_square(solution.s)).max()

    # 0.006 measured for A = 2 at ds = 1/8, less for the others.
    assert_order(measure_order(error_of, first=4), 2, 0.02)


@pytest.mark.parametrize("noise", WALKS)
def test_extrapolated_moments_are_exact_to_the_fourth_order(noise):
    walk = WALKS[noise]
    solution = walked(walk, "drift-kick", 16, extrapolate=True)
    start = solution.mean_cos_alpha[0], solution.mean_sin_alpha[0]
    mean = walk.mean(solution.s[:, None], start)
    found = np.stack([solution.mean_xi1, solution.mean_xi2], axis=1)
    spread = mean_square(solution)
    # (D ds)⁴/2880 of the trapezoidal sum is 2e-6 for A = 2, D ds = 1/4; E|ξ|² here
    # squares extrapolated means.
    np.testing.assert_allclose(found, mean, rtol=0, atol=1e-5)
    np.testing.assert_allclose(
        spread - spread[0], walk.mean_square(solution.s), rtol=0, atol=1e-5
    )


@pytest.mark.parametrize("name", SCHEMES)
def test_every_scheme_walks_the_closed_form(name):
    walk = WALKS[1.0]
    solution = walked(walk, name, 16)
    start = solution.mean_cos_alpha[0], solution.mean_sin_alpha[0]
    mean = walk.mean(solution.s[:, None], start)
    found = np.stack([solution.mean_xi1, solution.mean_xi2], axis=1)
    # Means: (D ds)²/12 of the splitting and of Crank-Nicolson, 3e-4 each.
    np.testing.assert_allclose(found, mean, rtol=0, atol=2e-3)
    spread = mean_square(solution)
    # Squares: D s ds²/3 where a whole shift stands between two half diffusions, 5e-3.
    np.testing.assert_allclose(
        spread - spread[0], walk.mean_square(solution.s), rtol=0, atol=6e-3
    )


def test_a_reference_curve_shifts_the_walk_and_nothing_else():
    # ξ = η − γ with the same η: the density is that on a fixed belt, moved by −γ.
    curve = RotatingNozzle(0.1, 0.4, 1.3)
    grid = PhaseSpaceGrid(10.0, (70, 70, 16))
    walk = PersistentRandomWalk(1.0, grid, 0.5)
    fixed = walked(walk, "drift-kick", 16)
    moving = LayDownModel(FreePotential(), 1.0, curve)
    solution = solve(drift_kick(moving, grid), walk.initial(), (0.0, 2.0), 0.125)
    for step, s in enumerate(solution.s):
        moved1, moved2 = curve.displacement(0.0, s)
        # Shifts are exact for every curve; first and second moments see no
        # interpolation but for its ripples that cross the boundary: 2e-12 here, 2e-6
        # on the grid above.
        for name, moved in (("mean_xi1", moved1), ("mean_xi2", moved2)):
            found = solution.series[name][step] - fixed.series[name][step]
            assert found == pytest.approx(-moved, abs=1e-11)
        for name in ("variance_xi1", "variance_xi2", "covariance"):
            found = solution.series[name][step]
            assert found == pytest.approx(fixed.series[name][step], abs=1e-11)
