"""Keeps what a pass records on the disk, and where it can go on."""

from __future__ import annotations

import time
import warnings
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.density.checkpoints.checkpoint import Interval
from fpsolve.density.checkpoints.snapshots import SnapshotFiles
from fpsolve.density.checkpoints.store import PassStore
from fpsolve.density.keeper import Snapshot, Take
from fpsolve.errors import CheckpointError

__all__ = ["CheckpointKeeper"]


class CheckpointKeeper:
    """One pass of a run with checkpoints; see `fpsolve.density.keeper.MemoryKeeper`.

    Data first, then the snapshot that refers to them: at every instant the newest
    snapshot on the disk finds all that it counts.

    Parameters
    ----------
    folder : Path
        That of the checkpoint.
    store : PassStore
    files : SnapshotFiles
    interval : Interval
    records : sequence of int
        Steps at which the pass records.
    raise_if_interrupted : callable
        Raises KeyboardInterrupt if Ctrl-C was pressed.
    """

    def __init__(
        self,
        folder: Path,
        store: PassStore,
        files: SnapshotFiles,
        interval: Interval,
        records: Sequence[int],
        raise_if_interrupted: Callable[[], None],
    ) -> None:
        self.folder, self.store, self.files = folder, store, files
        self.interval, self.records = interval, records
        self.raise_if_interrupted = raise_if_interrupted
        # Step and arclength of the newest one.
        self.kept: tuple[int, float] | None = None
        self.kept_at = time.monotonic()

    @property
    def n_saved(self) -> int:
        """Densities saved so far."""
        return self.store.n_saved

    def last(self) -> Snapshot | None:
        """The last good checkpoint of the pass; None if there is none."""
        for snapshot in self.files.read():
            if self.store.holds(snapshot.n_saved):
                self.store.n_saved = snapshot.n_saved
                self.kept = snapshot.step, snapshot.s
                return snapshot
            warnings.warn(
                f"checkpoint `{self.files.newest}` is not used: output that belongs to "
                f"it is missing or damaged in `{self.store.path.parent}`",
                UserWarning,
                stacklevel=2,
            )
        self.files.clear()
        return None

    def save(self, p: Array) -> None:
        """Append a density to the store."""
        with self._writing(self.store.path):
            self.store.save(p)

    def after(self, step: int, take: Take) -> None:
        """Write a checkpoint if one is due, and heed Ctrl-C."""
        self.raise_if_interrupted()
        last = self.kept[0] if self.kept else 0
        seconds = time.monotonic() - self.kept_at
        place = bisect_right(self.records, step)
        # The end of a pass is not waited for here: `finish` writes it.
        ahead = self.records[place] - last if place < len(self.records) else 0
        if self.interval.over(ahead, seconds):
            self._write(take)

    def finish(self, step: int, take: Take) -> None:
        """Write the checkpoint of a complete pass, unless it is there."""
        if self.kept is None or self.kept[0] != step:
            self._write(take)

    def interrupted(self, step: int | None, take: Take) -> str:
        """Write a last checkpoint; say how to go on."""
        if step is not None:
            try:
                self.finish(step, take)
            except CheckpointError as error:
                return f"; {error}"
        return f"; `fpsolve resume {self.folder}` goes on"

    def densities(self) -> Any:
        """The saved densities, read when they are asked for."""
        return self.store.densities()

    def _write(self, take: Take) -> None:
        snapshot = take(self.store.n_saved)
        with self._writing(self.files.next_path):
            self.store.synchronise()
            self.files.write(snapshot)
        self.kept, self.kept_at = (snapshot.step, snapshot.s), time.monotonic()

    @contextmanager
    def _writing(self, path: Path) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            reason = error.strerror or str(error)
            raise CheckpointError(path, reason, self._remedy()) from error

    def _remedy(self) -> str:
        again = f"see to it, then go on with `fpsolve resume {self.folder}`"
        if self.kept is None:
            return f"no earlier one of this pass is there; {again}"
        return f"the last good one, at s = {self.kept[1]:g}, is kept; {again}"
