"""How far the run is whose checkpoint is in a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fpsolve._support.checks import check_path
from fpsolve.density.checkpoints.identity import digest_of_run
from fpsolve.density.checkpoints.manifest import read_manifest
from fpsolve.density.checkpoints.snapshots import SnapshotFiles
from fpsolve.evolution.schedule import make_schedule

__all__ = ["CheckpointStatus", "status_of"]


@dataclass(frozen=True)
class CheckpointStatus:
    """Where the newest checkpoint is.

    Attributes
    ----------
    s : float
    n_done, n_total : int
        Steps, those of both passes with extrapolation.
    """

    s: float
    n_done: int
    n_total: int

    @property
    def finished(self) -> bool:
        """Whether nothing is left to compute."""
        return self.n_done == self.n_total

    def __str__(self) -> str:
        return f"s = {self.s:g}, after {self.n_done} of {self.n_total} steps"


def status_of(directory: str | Path) -> CheckpointStatus:
    """Return how far a run is.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If the folder is not a checkpoint.
    """
    folder = check_path("directory", directory)
    run = read_manifest(folder).run
    schedule = make_schedule(run["s_span"], run["ds"], record_every=run["record_every"])
    n_total = schedule.n_steps * (3 if run["extrapolate"] else 1)
    for name, n_before in (("pass-2", schedule.n_steps), ("pass-1", 0)):
        reached = SnapshotFiles(folder, name, digest_of_run(run)).reached()
        if reached is not None:
            step, s = reached
            return CheckpointStatus(s, n_before + step, n_total)
    return CheckpointStatus(schedule.start, 0, n_total)
