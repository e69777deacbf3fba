"""A web that was laid: its length density, its orientation, its fibres."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.web.curves import curve_of
from fpsolve.web.images import write_csv, write_tiff
from fpsolve.web.layout import WEB
from fpsolve.web.plan import Plan
from fpsolve.web.polylines import write_vtp
from fpsolve.web.statistics.measures import Measured

__all__ = ["Web"]


@dataclass(frozen=True, eq=False)
class Web(Saved, Measured):
    """The fibres of many spinning positions on a part of the belt.

    All lengths are metres for a web of a `Process`, and else in units of the throwing
    range. Arrays are cross × machine direction; index 1 of ξ and of a tensor is along
    the belt, 2 across it.

    Attributes
    ----------
    plan : Plan
        What determines the fibres, in units of the throwing range.
    process : Process or None
    titer : float or None
        Mass of the fibre in grams per metre.
    length_density : ndarray, shape (n_cross, n_machine)
        Laid length of fibre per area.
    orientation_11, orientation_12 : ndarray, shape (n_cross, n_machine)
        Means of τ₁τ₁ and τ₁τ₂ over the fibre in a pixel; NaN where there is none.
    laid_length : float
        Of all fibres, inside of the window and outside.
    outside_length : float
        Of it, outside. What is inside sums up to the rest, to the last of 2⁻³⁶ of a
        step.
    margin_error : float
        Share of the fibres that may lie beyond the margins, by which the mean may be
        too small near the edges: what was found there, and three relaxation lengths
        more.
    call : Call or None
    provenance : dict
    """

    kind: ClassVar[str] = "web"
    layout = WEB

    plan: Plan = field(repr=False)
    process: Process | None
    titer: float | None
    length_density: Array = field(repr=False)
    orientation_11: Array = field(repr=False)
    orientation_12: Array = field(repr=False)
    laid_length: float
    outside_length: float
    margin_error: float
    call: Call | None = field(default=None, repr=False)
    provenance: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def model(self) -> FibreModel | None:
        """The dimensionless model; None if it was a user's own code, from a file."""
        model: FibreModel | None = self.plan.ensemble.model
        return model

    @property
    def unit_length(self) -> float:
        """σ₁ in metres for a web of a process, else 1."""
        return 1.0 if self.process is None else self.process.length

    @property
    def unit(self) -> str:
        """Of lengths: "m", or "" for throwing ranges."""
        return "" if self.process is None else "m"

    @property
    def width(self) -> float:
        """Of the window, across the belt."""
        return self.plan.window.width * self.unit_length

    @property
    def length(self) -> float:
        """Of the window, along the belt."""
        return self.plan.window.length * self.unit_length

    @property
    def pixel(self) -> float:
        """Side of a pixel."""
        return self.plan.window.pixel * self.unit_length

    @property
    def spacing(self) -> float:
        """Distance d of the spinning positions."""
        return self.plan.spacing * self.unit_length

    @property
    def ds(self) -> float:
        """Step of the fibres."""
        return self.plan.ensemble.schedule.ds * self.unit_length

    @property
    def seed(self) -> int:
        """The number that repeats the web."""
        return self.plan.ensemble.seed

    @property
    def positions(self) -> Array:
        """Places of all spinning positions from which fibres can reach the window."""
        return self.plan.places * self.unit_length

    @property
    def phases(self) -> Array:
        """Phase of each nozzle beside that of the curve, in radians."""
        return self.plan.phases

    @property
    def cross(self) -> Array:
        """Centres of the pixels across the belt."""
        return self.plan.window.centres[0] * self.unit_length

    @property
    def machine(self) -> Array:
        """Centres of the pixels along the belt, increasing in the direction of e₁."""
        return self.plan.window.centres[1] * self.unit_length

    @property
    def inside_length(self) -> float:
        """Laid length inside of the window."""
        return self.laid_length - self.outside_length

    @property
    def burn_in(self) -> float:
        """Length of every fibre before it counts."""
        return self.plan.margins.n_burn * self.ds

    @property
    def burn_in_error(self) -> float:
        """What is left of the start of a fibre when it begins to count, relatively."""
        return self.plan.margins.remainder

    @property
    def expected_density(self) -> float:
        """1/(v d), which the mean of the length density has over an endless belt."""
        return 1.0 / (abs(self.plan.speed) * self.spacing)

    @property
    def base_weight(self) -> float | None:
        """titer/(v d) in g/m²; None where the titer is not known."""
        return None if self.titer is None else self.titer * self.expected_density

    @property
    def mass_density(self) -> Array | None:
        """Mass per area in g/m², cross × machine; None without a titer."""
        return None if self.titer is None else self.titer * self.length_density

    @property
    def orientation(self) -> Array:
        """⟨τ ⊗ τ⟩ of the fibre in every pixel; shape (n_cross, n_machine, 2, 2).

        The trace is one; NaN where there is no fibre.
        """
        first, mixed = self.orientation_11, self.orientation_12
        rows = [np.stack([first, mixed], -1), np.stack([mixed, 1.0 - first], -1)]
        return np.stack(rows, -2)

    def curve(self, fibre: int) -> Array:
        """The corners of one fibre on the belt, shape (n, 2): along and across it.

        It is laid again, bit for bit, from its start on; kept are the corners within
        the margins of the window.

        Raises
        ------
        ValueError
            If the model was a user's own code that a file cannot hold.
        """
        return curve_of(self.plan, fibre) * self.unit_length

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write a table of the pixels: places, length and mass per area, ⟨τ⊗τ⟩.

        Numbers have 17 digits, from which they are read back bit for bit.
        """
        return write_csv(self, path)

    def to_tiff(self, path: str | os.PathLike[str]) -> Path:
        """Write the mass per area, or else the length, in 16 bits with a pixel size.

        65535 stands for the largest value, which the description of the file names as
        `unit_of_one`; a value is rounded by half of that. The first row is the first
        across the belt. For a web in metres the size of a pixel is its resolution.

        Raises
        ------
        ImportError
            If tifffile is not installed; it comes with `pip install 'fpsolve[web]'`.
        """
        return write_tiff(self, path)

    def to_vtp(
        self,
        path: str | os.PathLike[str],
        *,
        fibres: Iterable[int] | None = None,
        diameter: float | None = None,
    ) -> Path:
        """Write fibres as polylines for ParaView: where they cross the window.

        Each polyline has the number of its fibre, `fibre`, and `diameter`, if given.
        Fibres are laid again, one by one.

        Parameters
        ----------
        path : str or os.PathLike
        fibres : iterable of int, optional
            Numbers of fibres, in the order of their `positions`; by default all.
        diameter : float, optional
            Of the fibre, in the unit of the web: 2 √(titer/(π ρ)) for the density ρ of
            the material in grams per cubic metre.
        """
        return write_vtp(self, path, fibres, diameter)
