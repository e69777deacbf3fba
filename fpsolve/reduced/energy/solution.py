"""The law of the energy at saved arclengths, and series over the steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.schedule import saved_index
from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.layout import SOLUTION
from fpsolve.reduced.relaxed import Relaxed

__all__ = ["EnergySolution"]


@dataclass(frozen=True, eq=False, repr=False)
class EnergySolution(Relaxed):
    """Densities p(g, s) of (16) that were saved, and series over every recorded step.

    Every series is an attribute but "mass", which is a method here.

    Attributes
    ----------
    process : EnergyProcess
    grid : EnergyGrid
    method : str
    ds : float
        Step; with extrapolation the longer of the two.
    series : dict of ndarray, each (n_recorded,)
        "s", "mass", "relative_entropy" (to S/∫S), "entropy_dissipation", "minimum".
    errors : dict of ndarray, or None
        Estimates in ds of an extrapolated run: "relative_entropy",
        "entropy_dissipation" (n_recorded,), "saved_l1" (n_saved,).
    saved_s : ndarray, shape (n_saved,)
    masses : ndarray, shape (n_saved, n)
        Masses of the n cells.
    provenance : dict
        Versions, date, times, number of steps.
    initial_masses : ndarray, shape (n,), or None
        Masses of the start as they were given, of any sum.
    status : str
        "finished" or "interrupted".
    call : Call or None
        How it was called.
    """

    kind: ClassVar[str] = "energy"
    layout = SOLUTION

    process: Any
    grid: EnergyGrid
    method: str
    ds: float
    series: Mapping[str, Array]
    errors: Mapping[str, Array] | None
    saved_s: Array
    masses: Array
    provenance: dict[str, Any] = field(default_factory=dict)
    initial_masses: Array | None = None
    status: str = "finished"
    call: Call | None = None

    @property
    def densities(self) -> Array:
        """Cell means of p(g, s), shape (n_saved, n_cells)."""
        return self.masses / self.grid.widths

    def mass(self, s: float) -> Array:
        """Cell masses at a saved s, shape (n_cells,); ValueError if none were saved."""
        return np.asarray(self.masses[saved_index(self.saved_s, s, self.ds)])

    def mean(self, s: float) -> float:
        """E G at a saved s; of |G| on an unsigned grid."""
        return float(self.mass(s) @ self.grid.centres)

    def distribution(self, s: float) -> Array:
        """P(G <= face) at a saved s for the faces of the grid, (n_cells + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.mass(s))])

    def __repr__(self) -> str:
        return (
            f"EnergySolution({self.method}, ds = {self.ds:g}, s = {self.s[-1]:g}, "
            f"{self.grid!r}, {len(self.saved_s)} saved)"
        )
