"""Richardson extrapolation in ds, and the error estimates it attaches."""

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import DecayingCirculation

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.evolution.richardson import largest_nearby
from fpsolve.grids.diagnostics import l1_distance, mass, moments, relative_entropy
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (20, 20, 16))
P0 = initial.gaussian(GRID, (1.5, 0.0), 0.5, np.pi / 2, 2.0)
EXACT = DecayingCirculation(
    QuadraticPotential(), 1.0, PhaseSpaceGrid(6.0, (48, 48, 32))
)


@pytest.mark.parametrize("balanced", [False, True])
def test_extrapolation_beats_both_runs_and_is_of_order_four(balanced):
    scheme = drift_kick(
        EXACT.model, EXACT.grid, balanced=balanced, interpolation_order=16
    )
    estimates, fine_errors = [], []

    def error_of(n_steps):
        arguments = (scheme, EXACT.initial(), (0.0, 1.0))
        solution = solve(*arguments, 1.0 / n_steps, extrapolate=True, record_every=32)
        fine = solve(*arguments, 0.5 / n_steps, record_every=32)
        estimates.append(solution.errors["density_l1"][0])
        exact = EXACT.density(1.0)
        fine_errors.append(l1_distance(fine.final, exact, EXACT.grid))
        return l1_distance(solution.final, exact, EXACT.grid)

    convergence = measure_order(error_of, first=2)
    # Palindromes have even powers of ds only; 1.8e-6 and 3.1e-7 measured.
    assert_order(convergence, 4, 5e-6)
    # The finer run is the better one of the two.
    assert (convergence.errors < 0.2 * np.array(fine_errors)).all()
    # The estimate is that of the finer run, so it bounds the extrapolated error and
    # meets the finer run's own to the next order in ds.
    assert (convergence.errors < np.array(estimates)).all()
    assert estimates == pytest.approx(fine_errors, rel=0.15)


def test_semi_lagrangian_is_improved_by_extrapolation_too():
    scheme = semi_lagrangian(
        DecayingCirculation(QuadraticPotential(), 2.0, EXACT.grid).model,
        EXACT.grid, interpolation_order=6,
    )  # fmt: skip
    problem = DecayingCirculation(QuadraticPotential(), 2.0, EXACT.grid)
    arguments = (scheme, problem.initial(), (0.0, 1.0))
    solution = solve(*arguments, 0.25, extrapolate=True)
    fine = solve(*arguments, 0.125)
    exact = problem.density(1.0)
    error = l1_distance(solution.final, exact, problem.grid)
    # A quarter only: interpolation errors grow as ds shrinks and remain.
    assert error < 0.5 * l1_distance(fine.final, exact, problem.grid)
    assert error < solution.errors["density_l1"][0]


def test_error_estimates_bound_the_true_error_of_every_series():
    # E ξ, E τ and H of the exact solution from its own densities on the grid.
    scheme = drift_kick(EXACT.model, EXACT.grid, interpolation_order=16)
    solution = solve(scheme, EXACT.initial(), (0.0, 1.0), 0.125, extrapolate=True)
    reference = EXACT.model.equilibrium(*EXACT.grid.plane())
    for step, s in enumerate(solution.s):
        exact = EXACT.density(s)
        truth = {
            "relative_entropy": relative_entropy(exact, EXACT.grid, reference),
            "mass": mass(exact, EXACT.grid),
            **moments(exact, EXACT.grid),
        }
        for name, value in truth.items():
            error = abs(solution.series[name][step] - value)
            # Rounding and interpolation where the estimate is zero by symmetry.
            assert error <= solution.errors[name][step] + 1e-9, (name, s)


def test_extrapolated_solutions_carry_an_estimate_for_everything():
    solution = solve(
        semi_lagrangian(MODEL, GRID), P0, (0.0, 0.5), 0.125, extrapolate=True,
        save_at=(0.25, 0.5),
    )  # fmt: skip
    assert set(solution.errors) == {*solution.series, "density_l1"}
    assert solution.errors["density_l1"].shape == (2,)
    assert all(
        solution.errors[name].shape == values.shape
        for name, values in solution.series.items()
    )
    assert solution.ds == 0.125
    # 4 steps of ds and 8 of ds/2.
    assert solution.provenance["n_steps"] == 12


# The finest has errors a hundred times below those that are estimated.
SHORT = {"ds": 1 / 128, "boundary_tolerance": 1.0}


@pytest.mark.parametrize(("noise", "ds"), [(4.0, 0.25), (4.0, 0.5), (8.0, 0.25)])
def test_estimates_cover_where_differences_change_sign_and_steps_are_long(noise, ds):
    # Richardson alone was 11 times too small for E ξ1 at A² ds = 4, where its error
    # passes through zero, and 8 times for H at A² ds = 16.
    grid = PhaseSpaceGrid(5.0, (20, 20, 16))
    p0 = initial.gaussian(grid, (1.0, 0.3), 0.6, 1.0, 2.0)
    scheme = drift_kick(LayDownModel(QuadraticPotential(), noise), grid)
    exact = solve(scheme, p0, (0.0, 1.0), **SHORT)
    run = {"ds": ds, "extrapolate": True, "boundary_tolerance": 1.0}
    if noise**2 * ds > 5:
        told = rf"A² ds = {noise**2 * ds:g} \(at most 5\).*take ds below"
        with pytest.warns(UserWarning, match=told):
            found = solve(scheme, p0, (0.0, 1.0), **run)
    else:
        found = solve(scheme, p0, (0.0, 1.0), **run)
    error = l1_distance(found.final, exact.final, grid)
    assert error < found.errors["density_l1"][-1]
    for name in ("mean_xi1", "mean_xi2", "mean_cos_alpha", "relative_entropy"):
        for place, s in enumerate(found.s[1:], start=1):
            true = exact.series[name][round(s * 128)]
            assert abs(found.series[name][place] - true) < found.errors[name][place]


def test_a_nozzle_that_turns_by_radians_in_a_step_is_told():
    model = LayDownModel(QuadraticPotential(), 1.0, RotatingNozzle(0.0, 0.1, 16.0))
    with pytest.warns(UserWarning, match=r"turns by 4 \(at most 3\).*below 0\.188"):
        solve(
            drift_kick(model, GRID), P0, (0.0, 0.5), 0.25, extrapolate=True,
            boundary_tolerance=1.0,
        )  # fmt: skip


def test_the_largest_nearby_is_that_of_a_window_and_of_the_neighbours():
    s, values = (
        np.array([0.0, 1.0, 2.0, 3.0, 10.0]),
        np.array([1.0, 5.0, 2.0, 3.0, 0.5]),
    )
    assert largest_nearby(s, values, 0.1).tolist() == [5.0, 5.0, 5.0, 3.0, 3.0]
    assert largest_nearby(s, values, 2.0).tolist() == [5.0, 5.0, 5.0, 5.0, 3.0]
    assert largest_nearby(s[:1], values[:1], 1.0).tolist() == [1.0]
