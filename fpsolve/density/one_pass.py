"""Where one pass of a run is: what its keeper writes down, and takes it back to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.provenance import Stopwatch
from fpsolve.density.recorder import Recorder
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.snapshot import Snapshot, fields_of, rows_to_array
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

    def snapshot(self, n_saved: int, n_stored: int) -> Snapshot:
        """Return what is needed to go on from here.

        Parameters
        ----------
        n_saved, n_stored : int
            Densities and rows that are kept elsewhere.
        """
        recorder = self.recorder
        columns = tuple(recorder.first)
        return Snapshot(
            step=self.step,
            s=self.schedule.s(self.step),
            n_saved=n_saved,
            n_stored=n_stored,
            seconds=self.watch.seconds(),
            columns=columns,
            first=rows_to_array([recorder.first], columns)[0],
            tail=rows_to_array(recorder.rows, columns),
            state=fields_of(self.state),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go to where a snapshot was taken."""
        snapshot.restore(self.state)
        columns = snapshot.columns

        def row(values: Any) -> dict[str, float]:
            return dict(zip(columns, values, strict=True))

        self.recorder.first = row(snapshot.first.tolist())
        self.recorder.rows = [row(values) for values in snapshot.tail.tolist()]
        self.watch.add(*snapshot.seconds)
        self.step = snapshot.step
