"""What runs of one scheme have in common is looked up once and changes no number."""

import gc
import warnings
import weakref

import numpy as np
import pytest

from fpsolve import initial
from fpsolve._support.environment import environment
from fpsolve.density.schemes import drift_kick
from fpsolve.density.smooth.recorder import recorder_for
from fpsolve.density.solve import solve
from fpsolve.density.unresolved import waves
from fpsolve.evolution.richardson import tableau
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (12, 12, 8))
ANYTHING = {
    f"{name}_tolerance": np.inf
    for name in ("boundary", "negative", "entropy", "circulation")
}


def make_start(mean=1.5):
    return initial.gaussian(GRID, (mean, 0.0), 1.0, np.pi / 2, 1.0)


def run(scheme, p0, **options):
    options = {"extrapolate": 3, **ANYTHING, **options}
    return solve(scheme, p0, (0.0, 1.0), 0.5, **options)


def same_bits(one, other):
    pairs = [(one.series, other.series), (one.errors, other.errors)]
    return (
        np.array_equal(one.densities, other.densities)
        and np.array_equal(one.entropy_floor, other.entropy_floor)
        and all(a.keys() == b.keys() for a, b in pairs)
        and all(np.array_equal(a[name], b[name]) for a, b in pairs for name in a)
    )


def test_a_run_does_not_depend_on_the_runs_of_its_scheme_before():
    scheme = drift_kick(MODEL, GRID, translation="fourier")
    before, other = run(scheme, make_start()), run(scheme, 2.0 * make_start(0.5))
    for found, p0 in ((before, make_start()), (other, 2.0 * make_start(0.5))):
        alone = run(drift_kick(MODEL, GRID, translation="fourier"), p0)
        assert same_bits(found, alone)
        assert same_bits(run(scheme, p0), alone)
    # Starts and masses differ, and so must what is told of them.
    assert before.entropy_floor != other.entropy_floor
    assert before.circulation[0] != other.circulation[0]


def test_runs_of_one_scheme_share_no_records():
    scheme = drift_kick(MODEL, GRID)
    one, other = (recorder_for(scheme, None, ()) for _ in range(2))
    one.record_start(make_start(), 0.0, {})
    assert other.inverse is one.inverse
    assert len(one.numbers)
    assert not (other.numbers)
    assert not (other.start)
    assert not (other.first)
    assert other.lowest == np.inf != one.lowest


def test_another_model_in_a_scheme_has_its_own_equilibrium():
    scheme = drift_kick(MODEL, GRID)
    recorder_for(scheme, None, ())
    scheme.model = LayDownModel(QuadraticPotential(2.0), 1.0)
    found = recorder_for(scheme, None, ()).reference
    assert np.array_equal(found, scheme.model.equilibrium(*GRID.plane()))


def test_what_is_kept_of_a_scheme_goes_with_it():
    scheme = drift_kick(MODEL, GRID)
    kept = weakref.ref(recorder_for(scheme, None, ()).circulation)
    assert kept() is not None
    del scheme
    gc.collect()
    assert kept() is None


def test_a_warning_of_the_cells_comes_with_every_run():
    narrow = LayDownModel(QuadraticPotential(0.15), 1.0)
    scheme = drift_kick(narrow, PhaseSpaceGrid(6.0, (13, 13, 8)))
    for _ in range(2):
        with pytest.warns(UserWarning, match="must have cells that resolve p_S"):
            recorder_for(scheme, None, ())


def test_a_scheme_that_no_dictionary_can_hold_runs_as_any_other():
    class Unhashable(type(drift_kick(MODEL, GRID))):
        __hash__ = None

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = run(Unhashable(MODEL, GRID), make_start(), extrapolate=False)
    expected = run(drift_kick(MODEL, GRID), make_start(), extrapolate=False)
    assert np.array_equal(found.densities, expected.densities)


@pytest.mark.parametrize("shared", [waves(8), *tableau(3)])
def test_what_all_runs_share_cannot_be_written_to(shared):
    with pytest.raises(ValueError, match="read-only"):
        shared[...] = 0.0


def test_an_environment_may_be_changed_by_whom_it_was_given_to():
    first = environment()
    first["packages"]["numpy"] = "other"
    first["vector_instructions"].append("other")
    again = environment()
    assert again["packages"]["numpy"] == np.__version__
    assert "other" not in again["vector_instructions"]


def test_passes_of_a_run_are_made_in_one_environment():
    scheme = drift_kick(MODEL, GRID, translation="fourier")
    told = run(scheme, make_start()).provenance["environment"]
    plain = run(scheme, make_start(), extrapolate=False).provenance["environment"]
    assert told == plain
    assert told is not plain
