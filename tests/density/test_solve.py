"""The run: what it records, saves and tells."""

import numba
import numpy as np
import pytest
from problems import DecayingCirculation

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.evolution.schedule import make_schedule
from fpsolve.grids.diagnostics import (
    l1_distance,
    mass,
    moments,
    negative_mass,
    relative_entropy,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential, QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (20, 20, 16))
P0 = initial.gaussian(GRID, (1.5, 0.0), 0.5, np.pi / 2, 2.0)
SCHEMES = [drift_kick, semi_lagrangian]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_series_have_one_entry_per_step_and_repeat_the_diagnostics(scheme):
    solution = solve(scheme(MODEL, GRID), P0, (0.0, 1.0), 0.125, save_at=(0.0, 0.5, 1))
    np.testing.assert_allclose(solution.s, np.arange(9) / 8, rtol=0, atol=1e-15)
    assert all(series.shape == (9,) for series in solution.series.values())
    reference = MODEL.equilibrium(*GRID.plane())
    for s, p in zip(solution.saved_s, solution.densities, strict=True):
        step = round(s * 8)
        # The same sums in another order: rounding.
        assert solution.mass[step] == pytest.approx(mass(p, GRID), rel=1e-14)
        assert solution.relative_entropy[step] == pytest.approx(
            relative_entropy(p, GRID, reference), rel=1e-13
        )
        assert solution.minimum[step] == p.min()
        assert solution.negative_mass[step] == pytest.approx(
            negative_mass(p, GRID), rel=1e-12
        )
        for name, value in moments(p, GRID).items():
            assert solution.series[name][step] == pytest.approx(value, abs=1e-14)
    assert solution.status == "finished"
    assert solution.provenance["n_steps"] == 8


def test_the_start_is_saved_as_it_was_given():
    solution = solve(drift_kick(MODEL, GRID), P0, (0.0, 0.5), 0.125, save_at=[0.0])
    assert np.array_equal(solution.density(0.0), P0)
    balanced = drift_kick(MODEL, GRID, balanced=True)
    saved = solve(balanced, P0, (0.0, 0.5), 0.125, save_at=[0.0]).density(0.0)
    # e^{−B} (e^{B} p0): two roundings.
    np.testing.assert_allclose(saved, P0, rtol=4e-16)


def test_the_density_is_kept_at_the_end_unless_said_otherwise():
    scheme = drift_kick(MODEL, GRID)
    assert solve(scheme, P0, (0.0, 0.5), 0.125).saved_s == [0.5]
    assert solve(scheme, P0, (0.0, 0.5), 0.125, save_at=()).saved_s.size == 0


def test_stops_may_come_as_an_array_in_any_order_and_twice():
    stops = np.array([0.5, 0.25, 0.5])
    solution = solve(drift_kick(MODEL, GRID), P0, (0.0, 0.5), 0.125, save_at=stops)
    assert solution.saved_s.tolist() == [0.25, 0.5]


def test_initial_density_is_left_untouched():
    before = P0.copy()
    for scheme in SCHEMES:
        solve(scheme(MODEL, GRID), P0, (0.0, 0.5), 0.125)
    assert np.array_equal(P0, before)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_two_spans_in_a_row_are_one_span(scheme):
    scheme = scheme(MODEL, GRID)
    whole = solve(scheme, P0, (0.0, 1.0), 0.125, save_at=(0.5, 1.0))
    second = solve(scheme, whole.density(0.5), (0.5, 1.0), 0.125)
    # The h-form divides by e^{−B} and multiplies again: rounding of four steps.
    assert l1_distance(second.final, whole.final, GRID) <= 1e-14


@pytest.mark.parametrize(
    "options", [{}, {"balanced": True}, {"positive": True}], ids=repr
)
def test_records_in_between_cost_an_error_of_the_splitting_order_at_most(options):
    # Neighbouring half shifts merge between records: T½ T½ = T but for interpolation.
    problem = DecayingCirculation(
        QuadraticPotential(), 1.0, PhaseSpaceGrid(7.0, (40, 40, 24))
    )
    scheme = drift_kick(problem.model, problem.grid, interpolation_order=14, **options)
    every = solve(scheme, problem.initial(), (0.0, 1.0), 0.125)
    rarely = solve(scheme, problem.initial(), (0.0, 1.0), 0.125, record_every=8)
    error = l1_distance(every.final, problem.density(1.0), problem.grid)
    # Interpolation of order 14 on this grid: a thousandth of the error in ds.
    assert l1_distance(every.final, rarely.final, problem.grid) <= 1e-2 * error
    assert rarely.s.tolist() == [0.0, 1.0]
    assert every.provenance["n_steps"] == rarely.provenance["n_steps"] == 8


def test_records_include_every_stop_and_the_end():
    schedule = make_schedule((0.0, 1.0), 0.1, save_at=(0.5,), record_every=3)
    assert schedule.records == (0, 3, 5, 6, 9, 10)
    assert schedule.saves == (5,)
    fine = schedule.refined()
    assert [fine.s(step) for step in fine.records] == pytest.approx(
        [schedule.s(step) for step in schedule.records], abs=1e-15
    )


def test_semi_lagrangian_records_a_weight_within_zero_and_one():
    solution = solve(semi_lagrangian(MODEL, GRID), P0, (0.0, 2.0), 0.125)
    assert solution.theta.min() >= 0
    assert solution.theta.max() <= 1
    # The correction is the mass that was missing, and it was: cubic interpolation on
    # cells of 0.6 errs by 1e-4 to 1e-2.
    assert 1e-6 < np.abs(solution.mass_correction).max() < 2e-2


def test_a_potential_without_equilibrium_has_no_relative_entropy():
    model = LayDownModel(FreePotential(), 1.0)
    p0 = initial.gaussian(GRID, variance=0.5)
    solution = solve(drift_kick(model, GRID), p0, (0.0, 0.5), 0.125)
    assert np.isnan(solution.relative_entropy).all()
    assert np.isnan(solution.entropy_floor)


def test_entropy_can_be_relative_to_any_reference():
    reference = initial.gaussian(GRID, variance=2.0)
    solution = solve(
        drift_kick(MODEL, GRID), P0, (0.0, 0.25), 0.125, reference=reference
    )
    expected = relative_entropy(P0, GRID, reference)
    assert solution.relative_entropy[0] == pytest.approx(expected, rel=1e-13)


def test_progress_is_told_of_every_record_of_both_runs():
    calls = []
    solve(
        drift_kick(MODEL, GRID), P0, (0.0, 0.5), 0.125, extrapolate=True,
        progress=lambda *call: calls.append(call),
    )  # fmt: skip
    # Four steps of ds and eight of ds/2, recorded at the same s.
    assert [call[0] for call in calls] == [0, 1, 2, 3, 4, 4, 6, 8, 10, 12]
    assert {call[1] for call in calls} == {12}
    assert calls[-1][2] == pytest.approx(0.5)


def test_a_bar_is_shown_on_request_only(capsys):
    solve(drift_kick(MODEL, GRID), P0, (0.0, 0.25), 0.125)
    assert capsys.readouterr().err == ""
    solve(drift_kick(MODEL, GRID), P0, (0.0, 0.25), 0.125, progress=True)
    assert "2/2" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("shape", "expected"), [((32, 32, 8), 1), ((64, 64, 32), 1), ((64, 64, 64), 2)]
)
def test_a_run_uses_a_thread_for_every_2_to_17_cells(model, shape, expected):
    grid = PhaseSpaceGrid(6.0, shape)
    used = []

    class Watched(type(drift_kick(model, grid))):
        def advance(self, *arguments):
            used.append(numba.get_num_threads())
            super().advance(*arguments)

    before = numba.get_num_threads()
    for allowed in (2, 1):
        numba.set_num_threads(allowed)
        solve(Watched(model, grid), initial.gaussian(grid, variance=0.5), (0, 0.1), 0.1)
        assert numba.get_num_threads() == allowed
    numba.set_num_threads(before)
    assert used == [expected, 1]
