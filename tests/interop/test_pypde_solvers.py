"""Our schemes as solvers of py-pde: the same runs, steps, checks, refusals."""

import math

import numpy as np
import pde
import pytest
from problems import asymmetric_start

from fpsolve import diagnostics
from fpsolve.density.recorder import Recorder
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.density.tolerances import Tolerances, check_finite, check_record
from fpsolve.errors import (
    DomainTooSmallError,
    MassDriftError,
    NegativeDensityError,
    NonFiniteDensityError,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import FokkerPlanckPDE, to_pde_field
from fpsolve.model.curves import RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

GRID = PhaseSpaceGrid(5.0, (16, 16, 16))
NOZZLE = LayDownModel(QuadraticPotential(), 1.0, RotatingNozzle(0.1, 0.3, 0.8))
SOLVERS = {"semi-lagrangian": semi_lagrangian, "drift-kick": drift_kick}
both_solvers = pytest.mark.parametrize("name", SOLVERS)


@pytest.fixture
def p0(model):
    return asymmetric_start(GRID, model.potential)


@pytest.fixture
def field(p0):
    return to_pde_field(p0, GRID)


def visitor(seen, interrupts):
    """A tracker that notes when it was called and what it saw."""
    return pde.trackers.CallbackTracker(
        lambda state, t: seen.append((t, state.data.copy())), interrupts
    )


class TestSchemesAsSolvers:
    def test_they_are_registered_under_their_names(self):
        names = {*SOLVERS, "scharfetter-gummel"}
        assert names <= pde.solvers.registered_solvers().keys()

    @both_solvers
    @pytest.mark.parametrize("curved", [False, True], ids=["fixed belt", "nozzle"])
    def test_the_run_equals_ours_bit_by_bit(self, name, curved, model, p0, field):
        model = NOZZLE if curved else model
        seen = []
        # Times that are sums of halves are exact, and so are the steps in between.
        final = FokkerPlanckPDE(model).solve(
            field, 1.0, dt=0.125, solver=name, tracker=visitor(seen, 0.25)
        )
        ours = solve(
            SOLVERS[name](model, GRID), p0, (0.0, 1.0), 0.125, record_every=2,
            save_at=[0.25, 0.5, 0.75, 1.0],
        )  # fmt: skip
        np.testing.assert_array_equal(final.data, ours.final)
        assert [t for t, _ in seen] == [0.0, 0.25, 0.5, 0.75, 1.0]
        for (_, theirs), density in zip(seen[1:], ours.densities, strict=True):
            np.testing.assert_array_equal(theirs, density)

    @both_solvers
    def test_a_run_may_begin_anywhere(self, name, p0, field):
        final = FokkerPlanckPDE(NOZZLE).solve(
            field, (0.5, 1.0), dt=0.125, solver=name, tracker=None
        )
        ours = solve(SOLVERS[name](NOZZLE, GRID), p0, (0.5, 1.0), 0.125, record_every=4)
        np.testing.assert_array_equal(final.data, ours.final)

    @both_solvers
    def test_options_reach_the_scheme(self, name, model, p0, field):
        options = {
            "semi-lagrangian": {"splitting": "lie", "interpolation_order": 6},
            "drift-kick": {"positive": True, "interpolation_order": 4},
        }[name]
        equation = FokkerPlanckPDE(model)
        final = equation.solve(
            field, 0.5, dt=0.125, solver=name, tracker=None, **options
        )
        scheme = SOLVERS[name](model, GRID, **options)
        ours = solve(scheme, p0, (0.0, 0.5), 0.125, record_every=4)
        np.testing.assert_array_equal(final.data, ours.final)
        info = equation.diagnostics["solver"]
        assert info["options"] == scheme.options
        assert info["order"] == scheme.order
        assert info["steps"] == 4

    def test_theta_and_the_mass_correction_are_reported(self, model, field):
        equation = FokkerPlanckPDE(model)
        equation.solve(field, 0.25, dt=0.125, solver="semi-lagrangian", tracker=None)
        info = equation.diagnostics["solver"]
        assert 0.0 <= info["theta"] <= 1.0
        assert 0.0 < abs(info["mass_correction"]) < 0.02

    def test_trackers_between_steps_see_the_nearest_step_and_change_nothing(
        self, model, field
    ):
        equation, seen = FokkerPlanckPDE(model), []
        options = {"t_range": 1.0, "dt": 0.125, "solver": "semi-lagrangian"}
        alone = equation.solve(field, tracker=None, **options)
        watched = equation.solve(field, tracker=visitor(seen, 0.3), **options)
        np.testing.assert_array_equal(watched.data, alone.data)
        # 0.3, 0.6 and 0.9 to the nearest multiples of 1/8.
        assert [t for t, _ in seen] == [0.0, 0.25, 0.625, 0.875]

    def test_with_drift_kick_they_decide_where_half_steps_merge(self, model, field):
        # Between two visits neighbouring half translations merge into one, which is
        # interpolated once instead of twice: runs differ by an interpolation error,
        # here 16 cells of order eight. `solve` does the same between two records.
        equation = FokkerPlanckPDE(model)
        options = {"t_range": 1.0, "dt": 0.125, "solver": "drift-kick"}
        alone = equation.solve(field, tracker=None, **options)
        watched = equation.solve(field, tracker=visitor([], 0.3), **options)
        difference = diagnostics.l1_distance(watched.data, alone.data, GRID)
        assert 0.0 < difference < 1e-2

    def test_a_span_of_no_whole_number_of_steps_ends_at_the_nearest(self, model, field):
        equation = FokkerPlanckPDE(model)
        equation.solve(field, 0.7, dt=0.125, solver="drift-kick", tracker=None)
        assert equation.diagnostics["controller"]["t_final"] == 0.75

    @both_solvers
    def test_a_tracker_may_change_the_density(self, name, model, p0, field):
        def halve(state, t):
            if t == 0.25:
                state.data *= 0.5

        final = FokkerPlanckPDE(model).solve(
            field, 0.5, dt=0.125, solver=name,
            tracker=pde.trackers.CallbackTracker(halve, 0.25),
        )  # fmt: skip
        first = solve(SOLVERS[name](model, GRID), p0, (0, 0.25), 0.125, record_every=2)
        second = solve(
            SOLVERS[name](model, GRID), 0.5 * first.final, (0.25, 0.5), 0.125,
            record_every=2,
        )  # fmt: skip
        np.testing.assert_array_equal(final.data, second.final)

    @both_solvers
    def test_other_equations_are_refused(self, name):
        grid = PlaneGrid(2.0, (4, 4))
        field = to_pde_field(np.ones(grid.shape), grid)
        message = rf'FokkerPlanckPDE for solver="{name}", got DiffusionPDE; write Fokk'
        with pytest.raises(TypeError, match=message):
            pde.DiffusionPDE().solve(field, 1.0, dt=0.1, solver=name)

    @both_solvers
    def test_the_plane_is_refused(self, name, model):
        grid = PlaneGrid(2.0, (4, 4))
        field = to_pde_field(np.ones(grid.shape), grid)
        with pytest.raises(ValueError, match=r"PhaseSpaceGrid .*got those of a Pl"):
            FokkerPlanckPDE(model).solve(field, 1.0, dt=0.1, solver=name, tracker=None)

    @both_solvers
    def test_the_step_has_no_default(self, name, model, field):
        with pytest.raises(ValueError, match=r"`dt` must be given .*suggest_step prop"):
            FokkerPlanckPDE(model).solve(field, 1.0, solver=name, tracker=None)

    def test_the_step_is_positive(self, model, field):
        with pytest.raises(ValueError, match=r"`dt` must be positive and finite, got "):
            FokkerPlanckPDE(model).solve(
                field, 1.0, dt=math.nan, solver="drift-kick", tracker=None
            )

    def test_unknown_options_are_refused(self, model, field):
        with pytest.raises(TypeError, match="unexpected keyword argument 'speed'"):
            FokkerPlanckPDE(model).solve(
                field, 1.0, dt=0.1, solver="drift-kick", tracker=None, speed=1
            )

    def test_a_start_that_is_no_density_is_refused(self, model, field):
        field.data[...] = -1.0
        with pytest.raises(ValueError, match=r"`p0` must have positive mass"):
            FokkerPlanckPDE(model).solve(
                field, 1.0, dt=0.1, solver="drift-kick", tracker=None
            )


class TestChecks:
    """What `solve` would have raised."""

    SCHEME = drift_kick(LayDownModel(QuadraticPotential(), 1.0), GRID)
    TOLERANCES = Tolerances(1e-10, 1e-3, 0.2)

    def check(self, p, mass=None, correction=0.0):
        check_finite(p, 1.5)
        state = self.SCHEME.start(p)
        state.correction = correction
        values = Recorder(self.SCHEME.model, GRID).record(p, 1.5)
        mass = values["mass"] if mass is None else mass
        check_record(values, mass, self.SCHEME, state, self.TOLERANCES)

    def test_a_density_passes(self, p0):
        self.check(p0)

    def test_values_that_are_not_finite(self, p0):
        p0[1, 2, 3] = np.nan
        with pytest.raises(NonFiniteDensityError) as caught:
            self.check(p0)
        assert (caught.value.s, caught.value.index) == (1.5, (1, 2, 3))

    def test_mass_that_drifts(self, p0):
        with pytest.raises(MassDriftError) as caught:
            self.check(p0, mass=2.0 * diagnostics.mass(p0, GRID))
        assert caught.value.drift == pytest.approx(-0.5)

    def test_negative_mass(self, p0):
        p0[8, 8] -= 4.0 * p0.max()
        p0[7, 7] += 5.0 * p0.max()
        with pytest.raises(NegativeDensityError) as caught:
            self.check(p0)
        assert caught.value.negative_mass > 0.2

    def test_mass_at_the_boundary(self, p0):
        with pytest.raises(DomainTooSmallError) as caught:
            self.check(p0 + p0.max())
        assert caught.value.half_width == GRID.half_width

    def test_a_correction_too_large(self, p0):
        with pytest.raises(MassDriftError, match=r"drift 0.5 exceeds tolerance 0.02"):
            self.check(p0, correction=0.5)

    def test_a_box_too_small_stops_the_run_of_py_pde(self, model):
        grid = PhaseSpaceGrid(1.5, (8, 8, 8))
        field = to_pde_field(asymmetric_start(grid, model.potential), grid)
        equation = FokkerPlanckPDE(model)
        options = {"t_range": 0.5, "dt": 0.125, "solver": "drift-kick", "tracker": None}
        with pytest.raises(DomainTooSmallError, match=r"box of half width 1.5"):
            equation.solve(field, **options)
        equation.solve(field, boundary_tolerance=1.0, **options)
