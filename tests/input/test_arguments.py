"""Arguments that cannot work are refused before a run, with a remedy."""

import re

import numpy as np
import pytest

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.errors import GridMismatchError
from fpsolve.evolution.schedule import make_schedule
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (20, 20, 16))
P0 = initial.gaussian(GRID, (1.5, 0.0), 0.5, np.pi / 2, 2.0)

SPAN = "`s_span` must be (start, end) with start < end, got "
ARGUMENTS = [
    ({"ds": 0.0}, "`ds` must be positive, got 0."),
    ({"ds": -0.1}, "`ds` must be positive, got -0.1."),
    ({"ds": np.nan}, "`ds` must be positive, got nan."),
    ({"ds": np.inf}, "`ds` must be positive, got inf."),
    ({"ds": 0.3}, "divide the span 1 into whole steps, got 0.3; use ds = 0.25."),
    ({"ds": 3.0}, "divide the span 1 into whole steps, got 3; use ds = 1."),
    ({"s_span": (1.0, 0.0)}, SPAN + "(1, 0)."),
    ({"s_span": (0.0, 0.0)}, SPAN + "(0, 0)."),
    ({"s_span": (0.0, np.nan)}, SPAN + "(0, nan)."),
    ({"s_span": (0.0, np.inf)}, SPAN + "(0, inf)."),
    ({"save_at": (0.3,)}, "multiples of ds = 0.125 from 0, got 0.3; the nearest is"),
    ({"save_at": (2.0,)}, "`save_at` must lie in the span [0, 1], got 2."),
    ({"save_at": (-0.125,)}, "`save_at` must lie in the span [0, 1], got -0.125."),
    ({"save_at": (np.nan,)}, "`save_at` must hold finite numbers, got nan."),
    ({"record_every": 0}, "`record_every` must be at least 1, got 0."),
    ({"mass_tolerance": 0.0}, "`mass_tolerance` must be positive, got 0."),
    ({"mass_tolerance": np.nan}, "`mass_tolerance` must be positive, got nan."),
    ({"negative_tolerance": 0.0}, "`negative_tolerance` must be positive, got 0."),
    ({"boundary_tolerance": np.nan}, "`boundary_tolerance` must be positive, got nan."),
]


@pytest.mark.parametrize(("changes", "message"), ARGUMENTS)
def test_arguments_that_cannot_work_are_named_with_a_remedy(changes, message):
    arguments = {"s_span": (0.0, 1.0), "ds": 0.125, **changes}
    with pytest.raises(ValueError, match=re.escape(message)):
        solve(drift_kick(MODEL, GRID), P0, **arguments)


def test_record_every_is_an_integer():
    with pytest.raises(TypeError, match=r"`record_every` must be an integer, got 1\.5"):
        solve(drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125, record_every=1.5)


def test_the_step_named_in_the_message_works():
    with pytest.raises(ValueError, match=r"use ds = 0\.142857142857\.") as caught:
        make_schedule((0.0, 1.0), 0.15)
    proposed = float(str(caught.value).split("ds = ")[1].rstrip("."))
    assert make_schedule((0.0, 1.0), proposed).n_steps == 7


def test_steps_that_fit_up_to_rounding_fit():
    # 0.1 is not a binary fraction; three of them are not 0.3 exactly.
    schedule = make_schedule((0.0, 0.3), 0.1, save_at=(0.1 + 0.2,))
    assert schedule.n_steps == 3
    assert schedule.saves == (3,)


def with_value(value):
    p0 = P0.copy()
    p0[3, 4, 5] = value
    return p0


DENSITIES = {
    "another shape": (
        np.ones((4, 4, 4)),
        GridMismatchError,
        "`p0` must have the shape (20, 20, 16) of the grid, got (4, 4, 4).",
    ),
    "integers": (
        np.ones(GRID.shape, dtype=np.int64),
        TypeError,
        "`p0` must hold floating-point numbers, got int64",
    ),
    "no mass": (
        np.zeros(GRID.shape), ValueError, "`p0` must have positive mass, got 0.",
    ),
    "negative mass": (-P0, ValueError, "`p0` must have positive mass, got -"),
    "NaN": (
        with_value(np.nan),
        ValueError,
        "`p0` must be finite, got nan at index (3, 4, 5).",
    ),
    "infinity": (
        with_value(np.inf),
        ValueError,
        "`p0` must be finite, got inf at index (3, 4, 5).",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("p0", "error", "message"), DENSITIES.values(), ids=DENSITIES)
def test_initial_densities_that_are_none_are_refused(p0, error, message):
    with pytest.raises(error, match=re.escape(message)):
        solve(drift_kick(MODEL, GRID), p0, (0.0, 1.0), 0.125)


def test_a_start_far_above_the_equilibrium_is_refused_by_the_balanced_form():
    sharp = initial.gaussian(GRID, (4.0, 4.0), 0.5)
    with pytest.raises(ValueError, match=r"`p0` must fall off like exp\(-B\)"):
        solve(drift_kick(MODEL, GRID, balanced=True), sharp, (0.0, 1.0), 0.125)


EVEN = "`interpolation_order` must be an even integer from 2 to 16, got "
DIFFUSIONS = "must be one of 'backward_euler', 'crank_nicolson', got 'be'."
OPTIONS = [
    (semi_lagrangian, {"form": "q"}, "`form` must be one of 'h', 'p', got 'q'."),
    (semi_lagrangian, {"splitting": "s"}, "must be one of 'lie', 'strang', got 's'."),
    (semi_lagrangian, {"diffusion": "be"}, DIFFUSIONS),
    (semi_lagrangian, {"interpolation_order": 5}, "must be 4 or 6, got 5"),
    (semi_lagrangian, {"perturbation": 1.0}, "must lie between 0 and 1, got 1"),
    (semi_lagrangian, {"perturbation": np.nan}, "must lie between 0 and 1, got nan"),
    (drift_kick, {"interpolation_order": 7}, EVEN + "7"),
    (drift_kick, {"interpolation_order": 18}, EVEN + "18"),
    (drift_kick, {"interpolation_order": 0}, EVEN + "0"),
]


@pytest.mark.parametrize(("scheme", "options", "message"), OPTIONS)
def test_options_that_do_not_exist_are_refused(scheme, options, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        scheme(MODEL, GRID, **options)


def test_drift_kick_needs_an_even_number_of_angles():
    grid = PhaseSpaceGrid(6.0, (8, 8, 9))
    with pytest.raises(ValueError, match=r"even number of angles, got 9; use 10\."):
        drift_kick(MODEL, grid)
