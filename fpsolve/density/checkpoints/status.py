"""How far the run is whose checkpoint is in a folder."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

from fpsolve._support.checks import check_path
from fpsolve.density.checkpoints.identity import digest_of_run
from fpsolve.density.checkpoints.manifest import read_manifest
from fpsolve.density.checkpoints.snapshots import SnapshotFiles
from fpsolve.density.levels import n_steps
from fpsolve.evolution.schedule import make_schedule

__all__ = ["CheckpointStatus", "status_of"]


@dataclass(frozen=True)
class CheckpointStatus:
    """Where the newest checkpoint is.

    Attributes
    ----------
    s : float
    n_done, n_total : int
        Steps, those of all passes with extrapolation; with `tolerance` at least so
        many.
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
    digest, done, reached = digest_of_run(run), 0, None
    for number in itertools.count(1):
        found = SnapshotFiles(folder, f"pass-{number}", digest).reached()
        if found is None:
            break
        done, reached = done + found[0], found
    n_total = schedule.n_steps * n_steps(run["extrapolate"])
    if run.get("tolerance") is not None:
        # How many there will be is not known before they are made.
        n_total = max(n_total, done + 1)
    s = schedule.start if reached is None else reached[1]
    return CheckpointStatus(s, done, n_total)
