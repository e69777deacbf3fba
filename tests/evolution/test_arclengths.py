"""One rule for arclengths: what `save_at` takes for a step, `density` finds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpsolve as fp
from fpsolve._support.checks import told_apart
from fpsolve.evolution.schedule import make_schedule, saved_index
from fpsolve.studies.agreement.steps import common_step

MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
GRID = fp.PhaseSpaceGrid(5.0, (8, 8, 8))


@given(
    start=st.floats(-1e3, 1e3),
    ds=st.floats(1e-5, 10.0),
    n_steps=st.integers(1, 10**6),
    share=st.floats(0.0, 1.0),
    off=st.floats(-0.6, 0.6) | st.floats(-2e-3, 2e-3) | st.floats(-1e-5, 1e-5),
    exact=st.booleans(),
)
def test_what_is_saved_is_found_and_what_is_not_a_step_is_refused(
    start, ds, n_steps, share, off, exact
):
    step = round(share * n_steps)
    s = start + (step + off) * ds
    span = start, start + n_steps * ds
    options = {"record_every": 10**7, "exact": exact}
    # Half a unit of the sixth digit of s, give or take the rounding of the arguments.
    if abs(off * ds) > min(6e-6 * max(1.0, abs(s)), 1.1e-3 * ds):
        with pytest.raises(ValueError, match="`save_at` must"):
            make_schedule(span, ds, [s], **options)
        return
    if abs(off * ds) > min(4e-6 * max(1.0, abs(s)), 0.9e-3 * ds):
        return
    schedule = make_schedule(span, ds, [s], **options)
    saved = np.array([schedule.s(one) for one in schedule.saves])
    assert saved_index(saved, s, schedule.ds) == 0
    # Never another step, nor a place between two.
    assert abs(saved[0] - s) <= 1.1e-3 * ds
    assert saved_index(saved, saved[0], schedule.ds) == 0


@given(value=st.floats(1e-3, 1e5), n=st.integers(2, 5))
def test_a_number_as_it_is_printed_is_found(value, n):
    # Six digits, as every message of this package shows it.
    saved = value * np.arange(n)
    for place, s in enumerate(saved):
        assert saved_index(saved, float(f"{s:g}"), value) == place


@given(
    saves=st.lists(st.integers(1, 400).map(lambda k: k / 40), min_size=1, max_size=3),
    longest=st.floats(0.01, 0.3),
)
def test_a_step_that_is_proposed_is_accepted(saves, longest):
    saves = np.unique(saves)
    ds = common_step(saves, longest)
    schedule = make_schedule((0.0, saves[-1]), ds, saves)
    assert len(schedule.saves) == len(saves)


def test_a_third_is_found_as_it_was_typed():
    third = 0.333333
    starts = fp.initial.gaussian(GRID, (0.0, 0.0), 1.0)
    tolerance = {"boundary_tolerance": 1.0}
    solution = fp.solve(
        fp.drift_kick(MODEL, GRID), starts, (0.0, 1.0), 1 / 3, save_at=(third,),
        **tolerance,
    )  # fmt: skip
    assert solution.saved_s[0] == 1 / 3
    assert solution.marginal("xi", third).shape == GRID.shape[:2]
    limit = fp.HydrodynamicLimit(MODEL).solve(
        starts.sum(axis=2), (0.0, 1.0), 1 / 3, grid=GRID, save_at=(third,), **tolerance
    )
    process = fp.EnergyProcess(fp.QuadraticPotential(), 1.0)
    energy = process.solve(
        0.1, (0.0, 1.0), 1 / 3, grid=process.grid(10), save_at=(third,)
    )
    for found in (solution, limit, energy):
        assert found.density(third) is not None
        with pytest.raises(ValueError, match=r"saved values 0\.333333, got 0\.334;"):
            found.density(0.334)
    # Paths keep the step they were given, to the last bit.
    paths = fp.sample_paths(MODEL, 3, 1.0, third, seed=1, save_at=(third, 1.0))
    assert paths.s[-1] == 3 * third
    assert paths.histogram(GRID, 1.0).counts.sum() == 3
    with pytest.raises(ValueError, match=r"use ds = 0\.333333333333"):
        fp.sample_paths(MODEL, 3, 1000.0, third, seed=1)


def test_what_is_not_a_step_is_told_from_the_nearest():
    with pytest.raises(ValueError, match=r"got 50\.00004; the nearest is 50\.$"):
        make_schedule((0.0, 100.0), 1e-4, [50.00004], record_every=10**6)
    with pytest.raises(ValueError, match=r"in the span \[0, 1\], got 1\.0000001\.$"):
        make_schedule((0.0, 1.0), 1e-7, [1.0000001], record_every=10**7)
    saved = np.array([0.5, 0.5000001])
    with pytest.raises(ValueError, match=r"0\.5, 0\.5000001, got 0\.50000005; "):
        saved_index(saved, 0.50000005)
    for missing in (np.nan, np.inf):
        with pytest.raises(ValueError, match=rf"0\.5, 0\.5000001, got {missing}; "):
            saved_index(saved, missing)


def test_digits_are_added_until_numbers_differ():
    assert told_apart(1.0, 1.0 + 2**-52) == ["1", "1.0000000000000002"]
    assert told_apart(0.25, 0.25, 2.0) == ["0.25", "0.25", "2"]
    assert told_apart() == []
