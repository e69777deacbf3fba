"""Where one pass of a run is: what its keeper writes down, and takes it back to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.provenance import Stopwatch
from fpsolve.density.recorder import Recorder
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.snapshot import Snapshot, fields_of
from fpsolve.evolution.schedule import Schedule
from fpsolve.evolution.series import Series

__all__ = ["Pass"]

Array = NDArray[np.float64]


class Pass:
    """State, records and time of one pass over a schedule.

    Attributes
    ----------
    step : int
        Steps done at the last record.
    settled : bool
        Whether the state is that of the last record: between two it is not.
    """

    def __init__(
        self,
        scheme: Scheme,
        p0: Array,
        reference: Array | None,
        observed: Sequence[Series],
        schedule: Schedule,
    ) -> None:
        self.scheme, self.schedule = scheme, schedule
        self.recorder = Recorder(scheme.model, scheme.grid, reference, observed)
        self.state = scheme.start(p0)
        self.step, self.settled = 0, False
        self.watch = Stopwatch()

    def snapshot(self, n_saved: int) -> Snapshot:
        """Return what is needed to go on from here, with so many densities saved."""
        return Snapshot(
            step=self.step,
            s=self.schedule.s(self.step),
            n_saved=n_saved,
            seconds=self.watch.seconds(),
            columns=self.recorder.columns,
            records=self.recorder.table(),
            state=fields_of(self.state),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go to where a snapshot was taken."""
        for name, value in snapshot.state.items():
            setattr(self.state, name, value)
        self.recorder.go_on(snapshot.columns, snapshot.records)
        self.watch.add(*snapshot.seconds)
        self.step = snapshot.step
