"""Numbers of the caller's own, recorded at every step of a run."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ObservationError
from fpsolve.evolution.series import SERIES

MODEL = fp.LayDownModel(fp.QuadraticPotential(), noise=1.0)
GRID = fp.PhaseSpaceGrid(5.0, (12, 12, 8))
P0 = fp.initial.gaussian(GRID, (1.0, 0.0), variance=1.0)
FREELY = {
    "boundary_tolerance": 1.0,
    "entropy_tolerance": np.inf,
    "circulation_tolerance": np.inf,
}


def mean_xi1(p, grid):
    return (p * grid.xi1[:, None, None]).sum() / p.sum()


def mass(p, grid):
    return p.sum() * grid.cell_volume


def run(observe=None, **options):
    scheme = fp.drift_kick(MODEL, GRID)
    return fp.solve(scheme, P0, (0.0, 1.0), 0.25, observe=observe, **FREELY, **options)


def test_an_observed_number_is_that_of_the_density_at_every_record():
    found = run({"first": mean_xi1, "total": mass}, save_at=(0.0, 0.5, 1.0))
    assert found.first.shape == found.s.shape
    for s in found.saved_s:
        at = list(found.s).index(s)
        assert found.first[at] == mean_xi1(found.density(s), GRID)
    # The sum of another order of adding: rounding of a few hundred cells.
    assert np.abs(found.first - found.mean_xi1).max() < 1e-13
    assert np.abs(found.total - found.mass).max() < 1e-13


def test_what_is_observed_changes_no_bit_of_the_run():
    alone, watched = run(), run({"first": mean_xi1})
    assert np.array_equal(alone.final, watched.final)
    for name in alone.series:
        assert np.array_equal(alone.series[name], watched.series[name], equal_nan=True)


def test_an_observed_number_is_extrapolated_like_the_same_one_of_ours():
    found = run({"first": mean_xi1}, extrapolate=True)
    assert np.abs(found.first - found.mean_xi1).max() < 1e-13
    assert np.abs(found.errors["first"] - found.errors["mean_xi1"]).max() < 1e-13


def test_it_is_saved_loaded_compared_and_asked_for_when_it_is_run_again(tmp_path):
    found = run({"first": mean_xi1})
    path = found.save(tmp_path / "run.nc")
    loaded = fp.load(path)
    assert np.array_equal(loaded.first, found.first)
    assert fp.compare(path, found).equal
    with pytest.raises(fp.NotRepeatableError, match=r"`observe` was your own code \(f"):
        fp.rerun(path)
    again = fp.rerun(path, observe={"first": mean_xi1})
    assert fp.compare(again, found).equal


def test_a_checkpoint_belongs_to_what_was_observed(tmp_path):
    folder = tmp_path / "run"
    found = run({"first": mean_xi1}, checkpoint=fp.Checkpoint(folder, every=1))
    again = run({"first": mean_xi1}, checkpoint=folder)
    assert np.array_equal(again.first, found.first)
    with pytest.raises(fp.CheckpointMismatchError, match=r"`observe\.first` "):
        run({"first": mass}, checkpoint=folder)
    with pytest.raises(ValueError, match="`observe` must not hold functions of your"):
        fp.resume(folder)


def test_functions_that_cannot_be_told_apart_are_not_kept(tmp_path):
    with (
        open(__file__) as file,
        pytest.raises(ValueError, match=r"`observe\['own'\]` must be told from others"),
    ):
        run({"own": lambda p, grid: file.fileno()}, checkpoint=tmp_path / "run")


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda p, grid: p.nothing, "has no attribute 'nothing'"),
        (lambda p, grid: p, "no number"),
        (lambda p, grid: "much", "no number"),
        (lambda p, grid: np.nan, "it gives nan"),
        (lambda p, grid: p.fill(0.0), "read-only"),
    ],
)
def test_a_function_that_fails_leaves_what_was_recorded(function, said):
    calls = []

    def later(p, grid):
        calls.append(1)
        return 0.0 if len(calls) < 3 else function(p, grid)

    with pytest.raises(
        ObservationError, match=r"`observe\['own'\]` must give"
    ) as caught:
        run({"own": later})
    assert said in str(caught.value)
    assert caught.value.s == 0.5
    assert list(caught.value.solution.s) == [0.0, 0.25]
    assert caught.value.solution.status == "failed"


@pytest.mark.parametrize(
    "name", ["mass", "density", "final", "grid", "save", "x_error", "_x", "a b", "", 3]
)
def test_a_name_that_is_taken_or_none_is_refused(name):
    with pytest.raises(ValueError, match="`observe` must have names that are free"):
        run({name: mass})


def test_what_is_no_mapping_of_functions_is_refused():
    with pytest.raises(TypeError, match="`observe` must be a mapping of names"):
        run([mass])
    with pytest.raises(TypeError, match=r"`observe\['own'\]` must be callable as f\(p"):
        run({"own": 3})


def test_a_series_is_declared_once():
    # A row of the table is a series of every solution, in words and in numbers.
    found = run()
    # A smooth fibre has those of its curvature besides.
    curved = {"mean_kappa", "mean_kappa2", "kappa_boundary_mass"}
    always = set(SERIES) - {"theta"} - curved
    assert set(found.series) == always
    labels = found.to_xarray()
    for name in always - {"s"}:
        assert labels[name].attrs["long_name"] == SERIES[name].words
