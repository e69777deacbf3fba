"""Damage, full disks and other runs: what a checkpoint survives, and refuses."""

import errno
import json
import resource
import warnings
import zipfile

import numpy as np
import pytest
from checkpoint_runs import (
    GRID,
    MODEL,
    P0,
    SCHEMES,
    Killed,
    assert_same_bits,
    killing_at,
    left_at,
    run,
)

import fpsolve as fp
from fpsolve._support.provenance import versions
from fpsolve.density.checkpoints import Checkpoint, manifest, snapshots, start
from fpsolve.density.checkpoints.checkpoint import parse_interval
from fpsolve.density.checkpoints.folder import remove_folder
from fpsolve.density.checkpoints.identity import digest_of_run
from fpsolve.density.checkpoints.status import status_of
from fpsolve.density.checkpoints.store import PassStore
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.errors import CheckpointError, CheckpointMismatchError, FileFormatError


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(unsynced):
    """No test here cuts the power."""


def newest(folder, name="pass-1"):
    """The snapshot that was written last."""
    return max(folder.glob(f"{name}-?.npz"), key=lambda path: path.stat().st_mtime_ns)


def truncate(path, share=0.5):
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])


def flip(path, place):
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= 0xFF
    path.write_bytes(bytes(content))


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(b""),
        lambda path: path.write_bytes(b"PK\x03\x04 no more"),
        lambda path: truncate(path, 0.3),
        lambda path: truncate(path, 0.99),
        lambda path: flip(path, 0.5),
        lambda path: flip(path, 0.97),
    ],
    ids=["empty", "nonsense", "third", "nearly", "flipped", "flipped at the end"],
)
def test_a_damaged_snapshot_is_told_and_the_one_before_it_used(tmp_path, damage):
    folder = left_at(7, tmp_path / "run")
    assert status_of(folder).n_done == 6
    path = newest(folder)
    damage(path)
    begun = []
    with pytest.warns(UserWarning, match=f"`{path}` is damaged and not used: "):
        again = run(folder, progress=lambda n, *_: begun.append(n))
    assert begun[0] == 4
    assert_same_bits(again, run())


def test_every_flipped_byte_of_a_snapshot_is_noticed_or_harmless(tmp_path, rng):
    folder = left_at(5, tmp_path / "run")
    path, content = newest(folder), newest(folder).read_bytes()
    files = snapshots.SnapshotFiles(folder, "pass-1", manifest_digest(folder))
    intact = next(files.read())
    n_noticed = 0
    for place in rng.random(40):
        flip(path, place)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = list(files.read())
        n_noticed += len(found) == 1
        # The dates of members, for instance, are not protected, nor used.
        for one in found[:-1]:
            assert one.step == intact.step
            assert one.state["values"].tobytes() == intact.state["values"].tobytes()
            assert one.records.tobytes() == intact.records.tobytes()
        path.write_bytes(content)
    # Nine tenths of the file are the state.
    assert n_noticed > 30


def manifest_digest(folder):
    return digest_of_run(manifest.read_manifest(folder).run)


@pytest.mark.filterwarnings("ignore:checkpoint .* is damaged")
def test_without_a_good_snapshot_the_run_begins_anew(tmp_path):
    folder = left_at(7, tmp_path / "run")
    for path in folder.glob("pass-1-?.npz"):
        truncate(path)
    begun = []
    again = run(folder, progress=lambda n, *_: begun.append(n))
    assert begun[0] == 0
    assert_same_bits(again, run())


@pytest.mark.filterwarnings("ignore:checkpoint .* is damaged")
def test_a_damaged_second_pass_leaves_the_first(tmp_path):
    folder = left_at(16, tmp_path / "run", extrapolate=True)
    for path in folder.glob("pass-2-?.npz"):
        truncate(path)
    begun = []
    again = run(folder, extrapolate=True, progress=lambda n, *_: begun.append(n))
    assert begun[:2] == [8, 8]
    assert_same_bits(again, run(extrapolate=True))


@pytest.mark.parametrize("harm", [lambda p: p.unlink(), truncate], ids=["gone", "half"])
def test_missing_output_is_told_and_computed_again(tmp_path, harm):
    folder = left_at(7, tmp_path / "run", save_at=(0.25, 0.75, 1.0))
    harm(folder / "output.zarr" / "pass-1" / "density" / "1.0.0.0")
    begun = []
    with pytest.warns(UserWarning, match="output that belongs to it is missing"):
        again = run(
            folder, save_at=(0.25, 0.75, 1.0), progress=lambda n, *_: begun.append(n)
        )
    assert begun[0] == 4
    assert_same_bits(again, run(save_at=(0.25, 0.75, 1.0)))


def test_a_damaged_density_is_an_error_that_names_it(tmp_path):
    solution = run(tmp_path / "run")
    flip(tmp_path / "run" / "output.zarr" / "pass-1" / "density" / "1.0.0.0", 0.5)
    np.testing.assert_array_equal(solution.density(0.0), P0)
    with pytest.raises(FileFormatError, match=r"density`: density 1: .*checksum"):
        solution.density(0.25)


def test_a_damaged_start_is_refused(tmp_path):
    folder = left_at(5, tmp_path / "run")
    path = folder / "output.zarr" / "start" / "p0" / "c" / "0" / "0" / "0"
    content = path.read_bytes()
    truncate(path)
    with pytest.raises(FileFormatError, match=r"cannot read `.*start.p0`"):
        fp.resume(folder)
    path.write_bytes((2 * P0).tobytes())
    with pytest.raises(FileFormatError, match="it does not hold the start of the run"):
        fp.resume(folder)
    path.write_bytes(content)
    assert_same_bits(fp.resume(folder), run())


def test_a_start_that_declares_more_than_memory_is_refused(tmp_path, monkeypatch):
    folder = left_at(5, tmp_path / "run")
    monkeypatch.setattr(start, "allowed_memory", lambda: P0.nbytes - 1.0)
    with pytest.raises(FileFormatError, match="bytes, more than memory"):
        fp.resume(folder)


def test_a_long_series_of_saving_points_is_kept_with_the_start(tmp_path):
    saves = {"ds": 1 / 512, "save_at": np.arange(300) / 512, "record_every": 512}
    folder = left_at(290, tmp_path / "run", every=100, **saves)
    with pytest.raises(CheckpointMismatchError, match="`save_at` holds other values"):
        run(folder, **{**saves, "save_at": np.arange(301) / 512})
    assert_same_bits(fp.resume(folder), run(**saves))


def test_a_snapshot_of_another_run_is_not_used(tmp_path):
    folder, other = left_at(7, tmp_path / "run"), left_at(7, tmp_path / "b", ds=0.0625)
    newest(other).replace(newest(folder))
    with pytest.warns(UserWarning, match="not used: it belongs to another run"):
        assert_same_bits(run(folder), run())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fpsolve_checkpoint": 2}, r"layout 2, this version of fpsolve reads up to 1"),
        ({"fpsolve_checkpoint": "new"}, "it does not describe a checkpoint"),
        ({"fpsolve_checkpoint": None}, "it does not describe a checkpoint"),
        ({"run": {}}, "its `run` is not that of a run"),
        ({"run": 3}, "its `run` is not that of a run"),
        ({"notes": {"a": "b"}}, "it was changed after it was written"),
    ],
)
def test_what_cannot_be_understood_is_refused(tmp_path, change, message):
    folder = left_at(5, tmp_path / "run")
    content = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**content, **change}))
    for action in (fp.resume, status_of, run):
        with pytest.raises(FileFormatError, match=message):
            action(folder)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", "{}"])
def test_a_manifest_that_is_not_one_is_refused(tmp_path, text):
    folder = left_at(5, tmp_path / "run")
    (folder / "run.json").write_text(text)
    with pytest.raises(FileFormatError, match="it does not describe a checkpoint"):
        fp.resume(folder)


def test_a_manifest_without_a_part_names_it(tmp_path):
    folder = left_at(5, tmp_path / "run")
    content = json.loads((folder / "run.json").read_text())
    del content["notes"], content["versions"]
    (folder / "run.json").write_text(json.dumps(content))
    with pytest.raises(FileFormatError, match="`notes`, `versions` is missing in it"):
        fp.resume(folder)


def test_what_is_no_checkpoint_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="which does not exist"):
        fp.resume(tmp_path / "none")
    with pytest.raises(FileFormatError, match=r"it holds no `run.json`"):
        fp.resume(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(FileFormatError, match=r"it holds no `run.json`"):
        fp.resume(tmp_path / "file")


def test_a_folder_of_something_else_is_not_written_to(tmp_path):
    (tmp_path / "thesis.tex").write_text("precious")
    with pytest.raises(ValueError, match=r"holds `thesis.tex`; name another"):
        run(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_checkpoint_that_is_half_removed_is_begun_anew(tmp_path, monkeypatch):
    run(tmp_path / "run")
    with monkeypatch.context() as patch:
        patch.setattr(
            "fpsolve.density.checkpoints.folder.shutil.rmtree", lambda path: None
        )
        remove_folder(tmp_path / "run")
    assert len(list((tmp_path / "run").iterdir())) > 3
    with pytest.raises(FileFormatError, match=r"it holds no `run.json`"):
        fp.resume(tmp_path / "run")
    begun = []
    run(tmp_path / "run", progress=lambda n, *_: begun.append(n))
    assert begun[0] == 0
    remove_folder(tmp_path / "run")
    assert list(tmp_path.iterdir()) == []


LINEAR = fp.LayDownModel(fp.LinearPotential(), 1.0)
WIDE = fp.LayDownModel(fp.QuadraticPotential(sigma1=1.5), 2.0)
MOVING = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
FINE = fp.PhaseSpaceGrid((6.0, 5.5), (14, 12, 10))
CHANGES = [
    ({"scheme": drift_kick(LINEAR, GRID)},
     ["`potential` was quadratic(sigma1=1.0, sigma2=1.0), is linear(slope=1.0)"]),
    ({"scheme": drift_kick(WIDE, GRID)},
     ["`potential.sigma1` was 1.0, is 1.5", "`noise` was 1.0, is 2.0"]),
    ({"scheme": drift_kick(MOVING, GRID)},
     ["`curve` was fixed_belt(), is moving_belt(speed=0.1)"]),
    ({"scheme": drift_kick(MODEL, FINE), "p0": np.ones(FINE.shape)},
     ["`grid.shape` was [14, 12, 8], is [14, 12, 10]", "`p0` holds other values"]),
    ({"scheme": drift_kick(MODEL, GRID, positive=True)},
     ["`scheme.positive` was False, is True"]),
    ({"ds": 0.25}, ["`ds` was 0.125, is 0.25"]),
    ({"s_span": (0.0, 2.0)}, ["`s_span` was [0.0, 1.0], is [0.0, 2.0]"]),
    ({"save_at": None}, ["`save_at` was [0.0, 0.25, 1.0], is not given"]),
    ({"save_at": np.arange(9) / 8}, ["`save_at` holds other values"]),
    ({"record_every": 2}, ["`record_every` was 1, is 2"]),
    ({"extrapolate": True}, ["`extrapolate` was False, is True"]),
    ({"mass_tolerance": 1e-8}, ["`mass_tolerance` was 1e-10, is 1e-08"]),
    ({"boundary_tolerance": 1e-2}, ["`boundary_tolerance` was 0.001, is 0.01"]),
    ({"negative_tolerance": 0.1}, ["`negative_tolerance` was 0.2, is 0.1"]),
    ({"p0": 1.5 * P0}, ["`p0` holds other values"]),
    ({"reference": np.ones(GRID.shape)}, ["`reference` holds other values"]),
]  # fmt: skip


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """A run that was killed after five steps."""
    return left_at(5, tmp_path_factory.mktemp("begun") / "run")


@pytest.mark.parametrize(("changes", "differences"), CHANGES)
def test_another_run_is_refused_naming_every_difference(begun, changes, differences):
    with pytest.raises(CheckpointMismatchError) as caught:
        run(begun, **changes)
    assert list(caught.value.differences) == differences
    assert str(caught.value) == (
        f"checkpoint `{begun}` is of another run: {', '.join(differences)}; use the "
        "arguments of that run, or name another folder, or remove this one to begin "
        "anew."
    )
    assert isinstance(caught.value, ValueError)


def test_another_scheme_is_named_with_its_options(begun):
    with pytest.raises(CheckpointMismatchError, match=r"`scheme` ") as caught:
        run(begun, scheme=SCHEMES["semi_lagrangian"])
    assert len(caught.value.differences) == 1


def test_a_refusal_leaves_the_checkpoint_as_it_was(tmp_path):
    folder = left_at(5, tmp_path / "run")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with pytest.raises(CheckpointMismatchError):
        run(folder, ds=0.25)
    after = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert after == before
    assert_same_bits(run(folder), run())


# What makes a class look like one of this module.
HOME = {"__module__": __name__, "__qualname__": "Scaled"}


def isotropic(factor):
    return fp.IsotropicPotential(lambda r: factor * r**2 / 2, lambda r: factor * r)


def test_a_potential_of_user_code_is_compared_by_what_it_computes(tmp_path):
    def scheme(factor):
        return drift_kick(fp.LayDownModel(isotropic(factor), 1.0), GRID)

    folder = left_at(5, tmp_path / "run", scheme=scheme(1.0))
    with pytest.raises(ValueError, match=r"user|made of parts of fpsolve.*call `solve` with the arguments of that run"):  # fmt: skip  # noqa: E501
        fp.resume(folder)
    with pytest.raises(CheckpointMismatchError) as caught:
        run(folder, scheme=scheme(1.2))
    assert caught.value.differences == ("`potential` holds other values",)
    assert_same_bits(run(folder, scheme=scheme(1.0)), run(scheme=scheme(1.0)))


class Swing(fp.MovingBelt):
    """A curve whose amplitude is no parameter of it."""

    amplitude = 0.0
    autonomous = fixed = False

    def position(self, s):
        return self.amplitude * np.sin(s), 0.0 * s

    def velocity(self, s):
        return self.amplitude * np.cos(s), 0.0 * s

    def displacement(self, s0, s1):
        return self.amplitude * (np.sin(s1) - np.sin(s0)), 0.0


def swing(amplitude):
    return type("Swing", (Swing,), {"amplitude": amplitude})(0.0)


class Jump(Swing):
    """Its displacements over one half of a step are not those of its positions."""

    def displacement(self, s0, s1):
        moved = 0.1 if s0 >= 0.5 and s1 < 0.6 else 0.0
        return super().displacement(s0, s1)[0] + moved, 0.0


def test_a_curve_of_user_code_is_compared_by_where_it_is(tmp_path):
    def scheme(curve):
        return drift_kick(fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve), GRID)

    folder = left_at(5, tmp_path / "run", scheme=scheme(swing(0.1)))
    for other in (swing(0.3), Jump(0.0)):
        with pytest.raises(CheckpointMismatchError) as caught:
            run(folder, scheme=scheme(other))
        assert caught.value.differences == ("`curve` holds other values",)
    with pytest.raises(ValueError, match="`curve` must not be of your own code to be "):
        fp.resume(folder)
    again = run(folder, scheme=scheme(swing(0.1)))
    assert_same_bits(again, run(scheme=scheme(swing(0.1))))


def test_a_class_of_the_user_is_not_resumed_as_the_one_whose_kind_it_has(tmp_path):
    class Stiff(fp.Potential):
        kind = "quadratic"
        formula = latex = "B"

        def value(self, xi1, xi2):
            return xi1**2 + xi2**2

        def gradient(self, xi1, xi2):
            return 2 * xi1, 2 * xi2

        def to_dict(self):
            return {"kind": "quadratic", "sigma1": 1.0, "sigma2": 1.0}

    own = drift_kick(fp.LayDownModel(Stiff(), 1.0), GRID)
    folder = left_at(5, tmp_path / "run", scheme=own)
    with pytest.raises(ValueError, match="`potential` must not be of your own code t"):
        fp.resume(folder)
    with pytest.raises(CheckpointMismatchError, match="`potential` holds other values"):
        run(folder)


def test_a_force_that_differs_between_the_cells_is_another(tmp_path):
    # Characteristics start in the centres of cells and go anywhere.
    faces = 0.5 * (GRID.xi1[1:] + GRID.xi1[:-1])

    def scheme(step):
        def gradient(xi1, xi2):
            away = np.abs(xi1 - faces[5]) < 0.1 * GRID.spacing[0]
            return xi1 + step * away, xi2 + 0.0 * xi1

        own = fp.CallablePotential(fp.QuadraticPotential().value, gradient)
        return semi_lagrangian(fp.LayDownModel(own, 1.0), GRID)

    folder = left_at(5, tmp_path / "run", scheme=scheme(0.0))
    with pytest.raises(CheckpointMismatchError, match="`potential` holds other values"):
        run(folder, scheme=scheme(1e-9))


class Scaled(drift_kick):
    """A scheme whose parameter is no option of it."""

    factor = 1.0

    def advance(self, state, s, ds, n_steps=1):
        super().advance(state, s, ds, n_steps)
        state.values *= self.factor


def test_a_scheme_of_user_code_is_compared_by_its_code_and_its_first_step(tmp_path):
    def scheme(factor):
        found = Scaled(MODEL, GRID)
        found.factor = factor
        return found

    folder = left_at(5, tmp_path / "run", scheme=scheme(1.0))
    with pytest.raises(CheckpointMismatchError) as caught:
        run(folder, scheme=scheme(1.0 - 1e-12))
    assert caught.value.differences == ("`scheme` holds other values",)
    # The same name, and another method.
    edited = type("Scaled", (Scaled,), {"density": lambda *_: P0, **HOME})(MODEL, GRID)
    with pytest.raises(CheckpointMismatchError) as caught:
        run(folder, scheme=edited)
    assert "`scheme` holds other code" in caught.value.differences
    assert_same_bits(run(folder, scheme=scheme(1.0)), run())


def test_a_scheme_of_user_code_goes_on_by_solve_only(tmp_path):
    class Own(drift_kick):
        pass

    folder = left_at(5, tmp_path / "run", scheme=Own(MODEL, GRID))
    with pytest.raises(ValueError, match=r"`scheme` must be one of fpsolve.*Own"):
        fp.resume(folder)
    with pytest.raises(CheckpointMismatchError, match="`scheme` holds other code"):
        run(folder)
    assert_same_bits(run(folder, scheme=Own(MODEL, GRID)), run())


def test_other_versions_are_a_warning(tmp_path, monkeypatch):
    old = {**versions(), "numpy": "2.0.0"}
    with monkeypatch.context() as patch:
        for module in ("folder", "manifest"):
            patch.setattr(f"fpsolve.density.checkpoints.{module}.versions", lambda: old)
        folder = left_at(5, tmp_path / "run")
    with pytest.warns(UserWarning, match=r"begun with numpy 2\.0\.0, now .*last bits"):
        run(folder)


def full(*arguments, **options):
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_full_disk_stops_the_run_and_keeps_the_last_good_checkpoint(
    tmp_path, monkeypatch
):
    folder = tmp_path / "run"

    def fill(n_done, n_total, s):
        if n_done == 5:
            monkeypatch.setattr(snapshots.np, "savez", full)

    with pytest.raises(CheckpointError) as caught:
        run(folder, progress=fill)
    monkeypatch.undo()
    assert str(caught.value) == (
        f"checkpoint `{folder / 'pass-1-a.npz'}` cannot be written: No space left on "
        "device; the last good one, at s = 0.5, is kept; see to it, then go on with "
        f"`fpsolve resume {folder}`."
    )
    partial = caught.value.solution
    assert (partial.status, len(partial.s)) == ("failed", 7)
    assert status_of(folder).n_done == 4
    assert list(folder.glob("*.draft")) == []
    assert_same_bits(fp.resume(folder), run())


def test_a_full_disk_under_the_output_is_told_too(tmp_path, monkeypatch):
    folder = tmp_path / "run"

    def fill(n_done, n_total, s):
        if n_done == 5:
            monkeypatch.setattr(PassStore, "save", full)

    with pytest.raises(CheckpointError, match=r"density` cannot be written: No space left on device; the last good one, at s = 0\.75, is kept") as caught:  # fmt: skip  # noqa: E501
        run(folder, progress=fill)
    monkeypatch.undo()
    assert caught.value.solution.saved_s.tolist() == [0.0, 0.25]
    assert_same_bits(fp.resume(folder), run())


def test_a_file_size_limit_of_the_system_stops_the_run_likewise(tmp_path):
    folder = tmp_path / "run"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill(n_done, n_total, s):
        if n_done == 5:
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))

    try:
        with pytest.raises(CheckpointError, match="File too large; the last good one"):
            run(folder, progress=fill)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert status_of(folder).n_done == 4
    assert_same_bits(fp.resume(folder), run())


def test_a_disk_that_is_full_at_ctrl_c_is_told_in_the_message(tmp_path, monkeypatch):
    def fill(n_done, n_total, s):
        if n_done == 5:
            monkeypatch.setattr(snapshots.np, "savez", full)
            raise KeyboardInterrupt

    with pytest.raises(fp.RunInterrupted) as caught:
        run(tmp_path / "run", progress=fill)
    assert "cannot be written: No space left" in caught.value.solution.message
    assert status_of(tmp_path / "run").n_done == 4


def test_a_disk_that_is_full_from_the_beginning_computes_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr("zarr.Group.create_array", full)
    with pytest.raises(CheckpointError, match="No space left on device; nothing was computed") as caught:  # fmt: skip  # noqa: E501
        run(tmp_path / "run")
    assert caught.value.solution is None
    monkeypatch.undo()
    assert_same_bits(run(tmp_path / "run"), run())


def test_a_folder_that_cannot_be_written_is_told_before_the_run(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    with pytest.raises(CheckpointError, match=r"cannot be written: Not a directory; nothing was computed; name a folder that can be written to"):  # fmt: skip  # noqa: E501
        run(tmp_path / "file" / "run")
    with pytest.raises(CheckpointError, match="File exists"):
        run(tmp_path / "file")

    def read_only(self, *arguments, **options):
        raise PermissionError(errno.EACCES, "Permission denied", str(self))

    monkeypatch.setattr("pathlib.Path.mkdir", read_only)
    with pytest.raises(CheckpointError, match=r"run` cannot be written: Permission"):
        run(tmp_path / "run")


@pytest.mark.parametrize("every", ["", "5", "1.5", "3 weeks", "0s", "-1min", "nans"])
def test_an_interval_is_a_number_of_steps_or_a_duration(every):
    if every == "5":
        assert parse_interval(every) == parse_interval(5)
        return
    with pytest.raises(ValueError, match="`every` must be a number of steps, such as"):
        Checkpoint("run", every)


def test_an_interval_has_units():
    assert parse_interval("1.5min").seconds == 90.0
    assert parse_interval(" .5 h ").seconds == 1800.0
    assert parse_interval("2s").steps == float("inf")


@pytest.mark.parametrize("every", [0, -1, 1.5, None, True])
def test_an_interval_is_at_least_a_step(every):
    with pytest.raises((ValueError, TypeError), match="`every` must be "):
        Checkpoint("run", every)


def test_a_checkpoint_is_a_checkpoint_or_a_path():
    with pytest.raises(TypeError, match=r"`checkpoint` must be a Checkpoint or a path, got 3; write Checkpoint"):  # fmt: skip  # noqa: E501
        fp.solve(SCHEMES["drift_kick"], P0, (0.0, 1.0), 0.5, checkpoint=3)


def test_a_path_is_a_checkpoint_every_minute(tmp_path):
    with pytest.raises(Killed):
        fp.solve(
            SCHEMES["drift_kick"], P0, (0.0, 1.0), 0.5, checkpoint=tmp_path / "run",
            progress=killing_at(1),
        )  # fmt: skip
    assert manifest.read_manifest(tmp_path / "run").every == "1min"
    assert fp.resume(str(tmp_path / "run")).status == "finished"


def test_the_files_can_be_read_without_fpsolve(begun):
    import zarr

    assert json.loads((begun / "run.json").read_text())["fpsolve_checkpoint"] == 1
    assert zipfile.ZipFile(newest(begun)).testzip() is None
    store = zarr.open_group(begun / "output.zarr", mode="r")
    assert store["pass-1/density"].metadata.dimension_names == (
        "s", "xi1", "xi2", "alpha",
    )  # fmt: skip
    np.testing.assert_array_equal(store["pass-1/density"][0], P0)


def test_a_run_of_older_arithmetic_is_not_continued(tmp_path, monkeypatch):
    scheme = SCHEMES["semi_lagrangian"]
    with monkeypatch.context() as older:
        older.delattr(semi_lagrangian, "revision")
        folder = left_at(4, tmp_path / "run", scheme=scheme)
    with pytest.raises(CheckpointMismatchError, match=r"revision` was not given, is 2"):
        run(folder, scheme=scheme)
