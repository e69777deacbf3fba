"""The folder of a checkpoint: made, checked against the run, and locked."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from fnmatch import fnmatch
from pathlib import Path
from typing import IO, Any

import numpy as np

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

from fpsolve._support.durable import DRAFT, sync
from fpsolve._support.interrupts import deferred_interrupts
from fpsolve._support.provenance import versions
from fpsolve.density.checkpoints.checkpoint import Checkpoint
from fpsolve.density.checkpoints.identity import differing_arguments, digest_of_run
from fpsolve.density.checkpoints.keeper import CheckpointKeeper
from fpsolve.density.checkpoints.manifest import MANIFEST, Manifest, read_manifest
from fpsolve.density.checkpoints.snapshots import SnapshotFiles
from fpsolve.density.checkpoints.start import STORE, digested, write_start
from fpsolve.density.checkpoints.store import PassStore
from fpsolve.density.levels import n_passes
from fpsolve.errors import CheckpointError, CheckpointMismatchError
from fpsolve.evolution.schedule import Schedule

__all__ = ["opened_folder", "remove_folder"]

_TITLE = "Start and saved densities of a run of fpsolve that is not complete"
_LOCK = "lock"
# Patterns of what the folder holds while it has no `run.json`: it is being made, or
# removed.
_OWN = (_LOCK, f"*{DRAFT}", "pass-*-?.npz", STORE)
# What zarr calls a file until it is complete.
_PARTIAL = "*.partial"


@contextmanager
def opened_folder(
    checkpoint: Checkpoint, run: Mapping[str, Any], arrays: Mapping[str, Any]
) -> Iterator[Callable[[str, Schedule], CheckpointKeeper]]:
    """Make the folder of a run, or open it if it is of the same run.

    Yields what makes a keeper for the pass of a name.

    Parameters
    ----------
    checkpoint : Checkpoint
    run : mapping
        What `identified` says of it.
    arrays : mapping
        Its arguments that are arrays.

    Raises
    ------
    CheckpointError
        If it cannot be written, or another run is writing to it.
    CheckpointMismatchError
        If it is of another run.
    ValueError
        If it holds something else.
    FileFormatError
        If it cannot be read.
    """
    folder = checkpoint.folder
    with ExitStack() as stack:
        with _writing(folder):
            _check_entries(folder)
            _check_free(folder)
            folder.mkdir(parents=True, exist_ok=True)
            _lock(stack.enter_context((folder / _LOCK).open("w")), folder)
            if not (folder / MANIFEST).exists():
                _make(checkpoint, run, arrays)
        _check_same(folder, run)
        interrupt = stack.enter_context(deferred_interrupts())

        def keeper(name: str, schedule: Schedule) -> CheckpointKeeper:
            size = len(schedule.saves), arrays["p0"].shape
            _have_group(folder / STORE, name)
            return CheckpointKeeper(
                folder, PassStore(folder / STORE / name, *size),
                SnapshotFiles(folder, name, digest_of_run(run)), checkpoint.interval,
                schedule.records, interrupt,
            )  # fmt: skip

        yield keeper


def _lock(file: IO[str], folder: Path) -> None:
    """Have one run at a time; the lock of a killed process is free at once."""
    try:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise CheckpointError(
            folder, "another run is writing to it", "wait until that has ended"
        ) from None


def _check_entries(folder: Path) -> None:
    """Raise ValueError if something in it is neither file nor folder.

    Writing to it would reach something else, or wait.
    """
    for path in folder.iterdir() if folder.is_dir() else ():
        if not (path.is_file() or path.is_dir()):
            raise ValueError(
                f"`checkpoint` must be a folder of files, got `{folder}`, in which "
                f"`{path.name}` is none; remove it, or name another folder."
            )


def _check_free(folder: Path) -> None:
    if not folder.is_dir() or (folder / MANIFEST).exists():
        return
    others = [path.name for path in sorted(folder.iterdir()) if not _is_own(path)]
    if others:
        raise ValueError(
            f"`checkpoint` must be a new folder or a checkpoint, got `{folder}`, which "
            f"holds `{others[0]}`; name another."
        )


def remove_folder(folder: Path) -> None:
    """Remove the folder of a checkpoint whose result is written."""
    # First, so that a kill in between does not leave a damaged checkpoint.
    (folder / MANIFEST).unlink()
    shutil.rmtree(folder)


def _is_own(path: Path) -> bool:
    return any(fnmatch(path.name, pattern) for pattern in _OWN)


def _make(
    checkpoint: Checkpoint, run: Mapping[str, Any], arrays: Mapping[str, Any]
) -> None:
    import zarr

    folder = checkpoint.folder
    for path in folder.iterdir():
        if path.name == STORE:
            shutil.rmtree(path)
        elif path.name != _LOCK:
            path.unlink()
    store = zarr.create_group(folder / STORE, attributes={"title": _TITLE})
    for number in range(n_passes(run["extrapolate"])):
        store.create_group(f"pass-{number + 1}")
    write_start(store, {name: np.asarray(arrays[name]) for name in digested(run)})
    for path in [*(folder / STORE).rglob("*"), folder / STORE]:
        sync(path)
    # Last: with it the folder becomes a checkpoint.
    Manifest(run, checkpoint.every, checkpoint.notes, versions()).write(folder)
    sync(folder.absolute().parent)


def _have_group(store: Path, name: str) -> None:
    """Make the group of a pass that was not foreseen: levels follow a tolerance."""
    import zarr

    if not (store / name / "zarr.json").exists():
        zarr.open_group(store, mode="r+").create_group(name)
        for path in (*(store / name).rglob("*"), store / name, store):
            sync(path)


def _check_same(folder: Path, run: Mapping[str, Any]) -> None:
    manifest = read_manifest(folder)
    differences = differing_arguments(manifest.run, run)
    if differences:
        raise CheckpointMismatchError(folder, differences)
    manifest.warn_of_other_versions(folder)
    for path in [*folder.glob("*" + DRAFT), *(folder / STORE).rglob(_PARTIAL)]:
        path.unlink(missing_ok=True)


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise CheckpointError(
            error.filename or folder,
            error.strerror or str(error),
            "nothing was computed; name a folder that can be written to",
        ) from error
