"""A run that is stopped anywhere goes on to the same bits."""

import os
import signal
import tracemalloc

import numpy as np
import pytest
from checkpoint_runs import (
    GRID,
    MODEL,
    P0,
    RUN,
    SCHEMES,
    Killed,
    assert_same_bits,
    killing_at,
    left_at,
    plain_arguments,
    run,
)

import fpsolve as fp
from fpsolve._support import durable
from fpsolve.density.checkpoints.status import status_of
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.errors import CheckpointError, MassDriftError, RunInterrupted


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(unsynced):
    """No test here cuts the power."""


@pytest.mark.parametrize("extrapolate", [False, True])
@pytest.mark.parametrize("name", SCHEMES)
def test_a_run_killed_at_any_record_ends_with_the_same_bits(
    tmp_path, name, extrapolate
):
    options = {"scheme": SCHEMES[name], "extrapolate": extrapolate}
    whole = run(**options)
    for step in range(0, whole.provenance["n_steps"] + 1, 7 if extrapolate else 3):
        folder = left_at(step, tmp_path / str(step), **options)
        assert step - status_of(folder).n_done <= 2
        assert_same_bits(run(folder, **options), whole)


@pytest.mark.parametrize("extrapolate", [False, True])
def test_a_run_killed_in_the_midst_of_any_write_ends_with_the_same_bits(
    tmp_path, monkeypatch, extrapolate
):
    whole = run(extrapolate=extrapolate)
    n_syncs = 0

    def sync(handle):
        nonlocal n_syncs
        n_syncs += 1
        if n_syncs == limit:
            raise Killed

    monkeypatch.setattr(durable.os, "fsync", sync)
    # Every third, beginning with those that make the folder.
    for limit in range(1, 10**6, 3):
        n_syncs = 0
        folder = tmp_path / str(limit)
        try:
            run(folder, extrapolate=extrapolate)
        except Killed:
            n_syncs, limit = 0, 0
            assert_same_bits(run(folder, extrapolate=extrapolate), whole)
            continue
        break
    # Of each of four or twelve checkpoints: output, snapshot, and their folders.
    assert n_syncs > 30


def test_a_run_can_be_killed_again_and_again(tmp_path):
    for step in (1, 3, 3, 6, 8):
        left_at(step, tmp_path / "run")
    assert_same_bits(run(tmp_path / "run"), run())


@pytest.mark.parametrize(("record_every", "n_done"), [(3, 3), (8, 2)])
def test_records_further_apart_than_the_interval_are_where_checkpoints_are(
    tmp_path, record_every, n_done
):
    # A density is saved, and therefore recorded, after two steps.
    folder = left_at(6, tmp_path / "run", every=1, record_every=record_every)
    assert status_of(folder).n_done == n_done
    whole = run(record_every=record_every)
    assert_same_bits(run(folder, record_every=record_every), whole)


def test_a_checkpoint_changes_no_bit_of_a_run(tmp_path):
    assert_same_bits(run(tmp_path / "run", every=1), run())


def test_the_interval_counts_steps_or_seconds(tmp_path):
    assert status_of(left_at(5, tmp_path / "steps", every=4)).n_done == 4
    assert status_of(left_at(5, tmp_path / "short", every="0.000001s")).n_done == 4
    assert status_of(left_at(5, tmp_path / "long", every="2h")).n_done == 0


def test_a_folder_is_enough_to_go_on(tmp_path):
    reference = np.broadcast_to(MODEL.equilibrium(*GRID.plane()), GRID.shape[:2]) * 2
    options = {"extrapolate": True, "reference": reference, "record_every": 2}
    folder = left_at(9, tmp_path / "run", **options)
    assert_same_bits(fp.resume(folder), run(**options))


def test_a_finished_run_gives_its_result_without_a_step(tmp_path):
    whole = run(tmp_path / "run")
    assert status_of(tmp_path / "run").finished
    calls = []
    again = fp.resume(tmp_path / "run", progress=lambda *call: calls.append(call))
    assert calls == [(8, 8, 1.0)]
    assert_same_bits(again, whole)


def test_the_status_tells_steps_of_both_passes(tmp_path):
    folder = left_at(15, tmp_path / "run", extrapolate=True)
    assert str(status_of(folder)) == "s = 0.375, after 14 of 24 steps"


def test_times_add_up_over_stops(tmp_path):
    folder = left_at(5, tmp_path / "run")
    first = fp.resume(folder)
    assert first.provenance["n_steps"] == 8
    assert first.provenance["wall_seconds"] > 0


def test_ctrl_c_leaves_a_checkpoint_at_the_last_record(tmp_path):
    def stop(n_done, n_total, s):
        if n_done >= 5:
            raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as caught:
        run(tmp_path / "run", every=100, progress=stop)
    assert status_of(tmp_path / "run").n_done == 5
    message = f"stopped by the user; `fpsolve resume {tmp_path / 'run'}` goes on"
    assert caught.value.solution.message == message
    assert len(caught.value.solution.s) == 6
    assert_same_bits(run(tmp_path / "run"), run())


class Pressed(drift_kick):
    """Ctrl-C comes in the midst of the fourth step, as often as told."""

    def __init__(self, times):
        super().__init__(MODEL, GRID)
        self.times = times

    def advance(self, state, s, ds, n_steps=1):
        if s == 0.375:
            for _ in range(self.times):
                os.kill(os.getpid(), signal.SIGINT)
        super().advance(state, s, ds, n_steps)


def test_ctrl_c_waits_for_the_next_record_unless_it_is_pressed_twice(tmp_path):
    before = signal.getsignal(signal.SIGINT)
    for times, n_done in ((1, 4), (2, 2)):
        folder, scheme = tmp_path / str(times), Pressed(times)
        with pytest.raises(RunInterrupted):
            run(folder, scheme=scheme)
        assert status_of(folder).n_done == n_done
        scheme.times = 0
        assert_same_bits(run(folder, scheme=scheme), run())
    assert signal.getsignal(signal.SIGINT) is before


def test_a_run_that_fails_leaves_its_last_checkpoint_and_what_it_recorded(tmp_path):
    class Drifting(drift_kick):
        def advance(self, state, s, ds, n_steps=1):
            super().advance(state, s, ds, n_steps)
            if s >= 0.5:
                state.values *= 1.001

    scheme = Drifting(MODEL, GRID)
    for _ in range(2):
        with pytest.raises(MassDriftError) as caught:
            run(tmp_path / "run", scheme=scheme)
        partial = caught.value.solution
        assert partial.status == "failed"
        assert len(partial.s) == 6
        assert partial.saved_s.tolist() == [0.0, 0.25]
        assert np.isfinite(np.asarray(partial.densities)).all()
        assert status_of(tmp_path / "run").n_done == 4


def test_one_run_at_a_time_writes_to_a_folder(tmp_path):
    caught = []

    def second(n_done, n_total, s):
        if not caught:
            with pytest.raises(CheckpointError, match="another run is writing") as one:
                run(tmp_path / "run")
            caught.append(one)

    run(tmp_path / "run", progress=second)
    assert caught
    # The lock is gone with the run.
    run(tmp_path / "run")


def test_saved_densities_do_not_stay_in_memory(tmp_path):
    grid = fp.PhaseSpaceGrid(6.0, (24, 24, 16))
    p0 = fp.initial.gaussian(grid, (0.5, 0.0), 0.8, 0.0, 1.0)
    scheme = drift_kick(MODEL, grid)
    save_at = np.arange(41) / 16
    peaks = {}
    for name, checkpoint in (
        # What is made on first use is not counted.
        ("first", tmp_path / "first"),
        ("folder", tmp_path / "run"),
        ("memory", None),
    ):
        tracemalloc.start()
        solve(scheme, p0, (0.0, 2.5), 1 / 16, save_at=save_at, checkpoint=checkpoint)
        peaks[name] = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    # 41 densities; a few are alive while one is written.
    assert peaks["memory"] - peaks["folder"] > 30 * grid.nbytes


def test_the_memory_estimate_counts_saved_densities_only_where_they_stay(tmp_path):
    limit = 70 * 2**20
    many = {"ds": 1 / 1024, "save_at": np.arange(1025) / 1024}
    with pytest.raises(fp.errors.MemoryLimitError):
        run(memory_limit=limit, **many)
    with pytest.raises(Killed):
        run(tmp_path / "run", memory_limit=limit, progress=killing_at(2), **many)


@pytest.mark.parametrize("extrapolate", [False, True])
def test_densities_on_the_disk_are_indexed_like_an_array(tmp_path, extrapolate):
    lazy = run(tmp_path / "run", extrapolate=extrapolate).densities
    array = run(extrapolate=extrapolate).densities
    assert (lazy.shape, lazy.dtype, len(lazy)) == (array.shape, array.dtype, 3)
    assert (lazy.ndim, lazy.size, lazy.nbytes) == (4, array.size, array.nbytes)
    chosen = np.array([True, False, True])
    for key in (
        0, -1, np.int64(1), slice(None), slice(None, None, 2), slice(3, 3), [0, 2],
        chosen, (1, 2), (slice(None), 3, 4, 5), ([2, 0], 1), Ellipsis, (Ellipsis, 0),
        None,
    ):  # fmt: skip
        assert np.asarray(lazy[key]).tobytes() == np.asarray(array[key]).tobytes()
        assert np.shape(lazy[key]) == array[key].shape
    for p, q in zip(lazy, array, strict=True):
        np.testing.assert_array_equal(p, q)
    np.testing.assert_array_equal(2.0 * lazy - array, array)
    with pytest.raises(IndexError):
        lazy[3]
    with pytest.raises(ValueError, match="`copy` must not be False"):
        np.asarray(lazy, copy=False)


def test_densities_on_the_disk_cross_process_boundaries(tmp_path):
    import pickle

    solution = run(tmp_path / "run", extrapolate=True)
    copy = pickle.loads(pickle.dumps(solution))
    assert_same_bits(copy, solution)


# What is stored does not depend on where, see test_io: every value once.
@pytest.mark.parametrize(("suffix", "extrapolate"), [(".nc", True), (".zarr", False)])
def test_a_result_on_the_disk_is_saved_like_one_in_memory(
    tmp_path, suffix, extrapolate
):
    lazy = run(tmp_path / "run", extrapolate=extrapolate)
    plain = run(extrapolate=extrapolate)
    first = fp.load(lazy.save(tmp_path / f"first{suffix}"))
    second = fp.load(plain.save(tmp_path / f"second{suffix}"))
    assert_same_bits(first, plain)
    assert_same_bits(second, plain)
    for name in lazy.to_xarray().variables:
        np.testing.assert_array_equal(
            first.to_xarray()[name].values, second.to_xarray()[name].values
        )


@pytest.mark.parametrize(("suffix", "save_at"), [(".nc", (0.0, 1.0)), (".zarr", None)])
def test_a_result_file_holds_what_repeats_the_run(tmp_path, suffix, save_at):
    reference = 2 * np.broadcast_to(MODEL.equilibrium(*GRID.plane()), GRID.shape[:2])
    options = {"reference": reference, "save_at": save_at}
    solution = run(**options, extrapolate=True)
    loaded = fp.load(solution.save(tmp_path / f"result{suffix}"))
    assert loaded.initial_density.tobytes() == P0.tobytes()
    again = solve(
        drift_kick(loaded.model, loaded.grid, **loaded.scheme["options"]),
        loaded.initial_density,
        **plain_arguments(loaded),
        reference=loaded.reference,
    )
    assert_same_bits(again, solution)


def test_the_initial_density_is_not_stored_twice(tmp_path):
    # In the plain form the density at s = 0 is p0, bit for bit.
    assert "initial_density" not in run().to_xarray()
    assert "initial_density" in run(save_at=(1.0,)).to_xarray()
    loaded = fp.load(run().save(tmp_path / "result.nc"))
    assert loaded.initial_density.tobytes() == P0.tobytes()


def test_a_result_does_not_change_with_the_array_it_began_from():
    p0 = P0.copy()
    solution = run(p0=p0)
    p0[:] = 0.0
    assert solution.initial_density.tobytes() == P0.tobytes()


def test_the_arguments_of_a_run_are_plain_numbers():
    assert plain_arguments(run()) == {
        "s_span": [0.0, 1.0],
        "ds": RUN["ds"],
        "save_at": [0.0, 0.25, 1.0],
        "record_every": 1,
        "extrapolate": False,
        "mass_tolerance": 1e-10,
        "boundary_tolerance": 1e-3,
        "negative_tolerance": 0.2,
        "entropy_tolerance": 0.1,
        "circulation_tolerance": 0.05,
    }
