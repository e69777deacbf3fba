"""What a run writes down at every recorded step."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve import diagnostics
from fpsolve.grids import PhaseSpaceGrid
from fpsolve.models import LayDownModel

Array = NDArray[np.float64]

BASIC = (
    "s",
    "mass",
    "relative_entropy",
    "entropy_dissipation",
    "minimum",
    "negative_mass",
    "boundary_mass",
    "mass_correction",
)


class Recorder:
    """Series of mass, H(p|r), its dissipation, minimum, negative and boundary mass.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha), or None
        What the entropy is relative to; p_S where e^{−B} is normalisable, and for
        other potentials nothing: entropy and dissipation are then NaN.
    """

    def __init__(
        self, model: LayDownModel, grid: PhaseSpaceGrid, reference: Array | None = None
    ) -> None:
        self.model, self.grid = model, grid
        if reference is None and model.potential.normalisable:
            equilibrium = model.equilibrium(*grid.plane())
            reference = np.broadcast_to(equilibrium, grid.shape[:2])
        self.reference = reference
        self.rows: list[dict[str, float]] = []

    def record(self, p: Array, s: float, **extra: float) -> dict[str, float]:
        """Add one record and return it."""
        sums = diagnostics.functionals(p, self.grid)
        values = {
            "s": s,
            "mass": float(sums[:, :, 0].sum()) * self.grid.cell_volume,
            **self._entropy(p, sums),
            "minimum": float(sums[:, :, 4].min()),
            "negative_mass": float(sums[:, :, 5].sum()) * self.grid.cell_volume,
            "boundary_mass": diagnostics.ring_share(np.abs(sums[:, :, 0])),
            **extra,
            **diagnostics.moments_of_rows(sums, self.grid),
        }
        self.rows.append(values)
        return values

    def _entropy(self, p: Array, sums: Array) -> dict[str, float]:
        if self.reference is None or not np.isfinite(sums[:, :, 0].sum()):
            return {"relative_entropy": np.nan, "entropy_dissipation": np.nan}
        noise = self.model.noise
        if np.ndim(self.reference) == 3:
            lost = diagnostics.entropy_dissipation(p, self.grid, noise, self.reference)
        else:
            lost = diagnostics.dissipation_of_rows(sums, self.grid, noise)
        entropy = diagnostics.relative_entropy(p, self.grid, self.reference)
        return {"relative_entropy": entropy, "entropy_dissipation": lost}

    def floor(self) -> float:
        """Entropy of the reference's restriction to the grid, at the initial mass."""
        if self.reference is None:
            return float("nan")
        start = self.rows[0]["mass"] if self.rows else 1.0
        return diagnostics.entropy_floor(self.grid, self.reference, start)

    def series(self) -> dict[str, Any]:
        """The records as arrays, one entry per recorded step."""
        keys = self.rows[0].keys() if self.rows else BASIC
        return {key: np.array([row[key] for row in self.rows]) for key in keys}
