"""What a run of a smooth fibre writes down: no entropy unless it is told of what."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any
from weakref import WeakKeyDictionary

from fpsolve._support.arrays import Array
from fpsolve.density.recorder import Record, Recorder
from fpsolve.evolution.series import Series
from fpsolve.grids import diagnostics
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.grids.smooth_sums import SmoothFunctionals

__all__ = ["SmoothRecorder", "recorder_for"]


# Of runs of a scheme without a reference: p_S and the circulation, a few arrays over ξ,
# for as long as the scheme lives.
_known: WeakKeyDictionary[Any, Recorder] = WeakKeyDictionary()


class SmoothRecord(Record):
    """One step of a run; see `Record`.

    Attributes
    ----------
    p : ndarray, shape (n1, n2, n_alpha, n_kappa)
    sums : SmoothFunctionals
    """

    sums: Any

    def __init__(
        self, recorder: Any, p: Array, s: float, report: Mapping[str, float]
    ) -> None:
        self.recorder, self.p, self.s, self.report = recorder, p, s, report
        self.grid = recorder.grid
        self.sums = SmoothFunctionals(p, recorder.grid)
        self.moments = self.sums.moments()
        self.boundary_mass = diagnostics.ring_share(self.sums.rows[2])
        self.kappa_boundary_mass = self.sums.kappa_boundary_mass()


class SmoothRecorder(Recorder):
    """Series of a run of equation (23).

    What is stationary on a fixed belt has no closed form: the entropy is NaN without a
    reference, and nothing is known that it must obey.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
    reference : ndarray, shape (n1, n2, n_alpha, n_kappa), or None
    observed : sequence of Series
    """

    kind_of_record = SmoothRecord

    def __init__(
        self,
        model: Any,
        grid: Any,
        reference: Array | None = None,
        observed: Sequence[Series] = (),
    ) -> None:
        self.model, self.grid, self.observed = model, grid, observed
        self.noise = model.curvature_noise
        self.reference, self.inverse = reference, None
        self.falls, self.lowest = False, math.inf
        self.circulation = self.uncounted = None
        self.first, self.start, self.numbers = {}, {}, array("d")
        self.floors = {}


def recorder_for(
    scheme: Any, reference: Array | None, observed: Sequence[Series]
) -> Recorder:
    """The recorder for the grid of a scheme, or that which the scheme brings."""
    smooth = isinstance(scheme.grid, SmoothPhaseSpaceGrid)
    usual = SmoothRecorder if smooth else Recorder
    kind: type[Recorder] = getattr(scheme, "kind_of_recorder", usual)
    if kind is not Recorder or reference is not None or observed:
        return kind(scheme.model, scheme.grid, reference, observed)
    # A user's own scheme need not be one that a dictionary can hold.
    with suppress(TypeError):
        return _remembered(scheme).anew()
    return Recorder(scheme.model, scheme.grid)


def _remembered(scheme: Any) -> Recorder:
    known = _known.get(scheme)
    if known and known.model is scheme.model and known.grid is scheme.grid:
        return known
    made = Recorder(scheme.model, scheme.grid)
    # What warns is to warn every time.
    if made.quiet:
        _known[scheme] = made
    return made
