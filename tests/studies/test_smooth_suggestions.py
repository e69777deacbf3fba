"""Suggested grids of smooth fibres hold the density that runs and iterations find."""

import copy
import math
import pickle

import numpy as np
import pytest

import fpsolve as fp

UNIT = fp.QuadraticPotential()


def model(relaxation_length, noise, speed=0.0):
    curve = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.SmoothLayDownModel(UNIT, relaxation_length, noise, curve)


# R and A as where the density is that of the limit, wider, and far from it.
CASES = [(1e-3, 1.0, 0.0), (0.1, 3.0, 0.0), (1.0, 2.0, 0.0), (0.3, 1.5, 0.2)]


@pytest.mark.parametrize(("relaxation_length", "noise", "speed"), CASES)
def test_a_run_on_the_suggested_grid_keeps_its_mass_inside(
    relaxation_length, noise, speed
):
    smooth = model(relaxation_length, noise, speed)
    grid = fp.suggest_grid(smooth, 0.3)
    start = fp.initial.with_curvature(
        fp.initial.gaussian(grid.phase_space, (0.0, 0.0), 1.0),
        grid,
        smooth.curvature_variance,
    )
    run = fp.solve(fp.smooth_drift_kick(smooth, grid), start, (0.0, 4.0), 0.25)
    # Far below the 1e-3 at which a run stops. The box leaves 5e-5 outside, and its
    # outermost cells hold a few times that; six deviations of κ leave 2e-9 of a
    # Gaussian, and 4e-5 at R = 1, where the force, growing with ‖ξ‖, makes it wider.
    assert run.boundary_mass.max() < 5e-4
    assert run.kappa_boundary_mass.max() < 1e-4


def test_the_box_is_wider_than_that_of_the_limit_where_the_fibre_strays_farther():
    short, long = (fp.suggest_grid(model(R, 2.0)) for R in (1e-3, 1.0))
    basic = fp.suggest_grid(model(1.0, 2.0).white_noise_limit)
    assert min(short.half_widths) >= 0.9 * min(basic.half_widths)
    # Var ξ₁ is 3 here, and the tail falls like exp(−c r^{3/2}).
    assert min(long.half_widths) > math.sqrt(2) * min(basic.half_widths)


@pytest.mark.parametrize(("relaxation_length", "noise", "speed"), CASES)
def test_curvatures_reach_six_deviations_and_their_gaussian_is_resolved(
    relaxation_length, noise, speed
):
    smooth = model(relaxation_length, noise, speed)
    grid = fp.suggest_grid(smooth, 0.3)
    paths = fp.sample_paths(smooth, 4000, 20.0, 0.1, seed=2)
    spread = np.sqrt((paths.kappa[-1] ** 2).mean())
    # Four thousand squares of a nearly Gaussian curvature: 1.1 per cent, four of them;
    # the start may have a larger force than the end.
    assert 0.95 * 6 * spread < grid.kappa_half_width < 1.3 * 6 * spread
    deviation = math.sqrt(smooth.curvature_variance)
    assert grid.spacing[3] <= 0.6 * deviation


def test_on_a_belt_the_box_is_longer_along_it():
    grid = fp.suggest_grid(model(0.3, 1.5, 0.4), 0.1)
    assert grid.half_widths[0] > grid.half_widths[1]


def test_the_grid_says_why_and_is_a_grid():
    grid = fp.suggest_grid(model(0.1, 3.0), 0.3)
    assert isinstance(grid, fp.SmoothPhaseSpaceGrid)
    assert f"|κ| < {grid.kappa_half_width:.3g} are 6 times" in grid.reason
    assert "lie outside" in grid.reason
    for again in (pickle.loads(pickle.dumps(grid)), copy.copy(grid)):
        assert (again, again.reason) == (grid, grid.reason)


def test_smooth_models_without_a_density_are_refused():
    with pytest.raises(ValueError, match="`noise` must be positive for a density of t"):
        fp.suggest_grid(model(0.1, 0.0))
    free = fp.SmoothLayDownModel(fp.FreePotential(), 0.1, 1.0)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.suggest_grid(free)
