"""What a run writes down at every recorded step, and what it may not do."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve.grids import diagnostics
from fpsolve.grids.circulation import Circulation, obeys_circulation_law, remaining
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import SMALLEST, RowFunctionals, inverse_of
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.potential import Potential

Array = NDArray[np.float64]

# A share of H that matters: a warning tells where B beyond 690 is not counted.
_UNCOUNTED = 1e-3
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


def uncounted(potential: Potential, grid: PhaseSpaceGrid, ratio: float) -> Array | None:
    """How far −ln(ratio p_S) lies beyond −ln 1e-300; None where nowhere."""
    value = np.broadcast_to(potential.value(*grid.plane()), grid.shape[:2])
    level = potential.normalisation.log_value + math.log(2 * math.pi / ratio)
    beyond = np.maximum(0.0, value + level + math.log(SMALLEST))
    return beyond if beyond.any() else None


class Recorder:
    """Series of mass, H(p|r), its dissipation, minimum, negative and boundary mass.

    On a belt at rest H(p|p_S) can only fall; `entropy_rise` is H minus the smallest H
    before. Where B is isotropic as well E G decays by a law; `circulation` is E G and
    `circulation_deviation` what it misses. Neither is recorded where no law holds.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    reference : ndarray, shape (n1, n2) or (n1, n2, n_alpha), or None
        What the entropy is relative to; p_S where e^{−B} is normalisable, and for
        other potentials nothing: entropy and dissipation are then NaN.

    Warns
    -----
    UserWarning
        If the start has mass where p_S is below 1e-300, which H does not count further.
    """

    def __init__(
        self, model: LayDownModel, grid: PhaseSpaceGrid, reference: Array | None = None
    ) -> None:
        self.model, self.grid = model, grid
        given = reference
        self.falls = reference is None and model.has_equilibrium
        self.lowest = math.inf
        self.circulation = (
            Circulation(model.potential, grid) if obeys_circulation_law(model) else None
        )
        if reference is None and model.potential.normalisable:
            value_at(model.potential, *grid.plane())
            equilibrium = model.equilibrium(*grid.plane())
            reference = np.broadcast_to(equilibrium, grid.shape[:2])
        self.uncounted: Array | None = None
        self.reference = reference
        self.ratio = 1.0
        self.inverse: Array | None = None
        if reference is not None and np.ndim(reference) == 2:
            # Near equilibrium p is r normalised on this grid: logarithms are small.
            field = diagnostics.as_field(reference, grid)
            total = diagnostics.reference_sum(field, grid) * grid.cell_volume
            self.ratio = 1.0 / total if total > 0.0 else np.nan
            self.inverse = inverse_of(reference, self.ratio)
        if self.inverse is not None and given is None:
            self.uncounted = uncounted(model.potential, grid, self.ratio)
        # The first record stays when a caller takes `rows` elsewhere.
        self.first: dict[str, float] = {}
        self.rows: list[dict[str, float]] = []

    def record(self, p: Array, s: float, **extra: float) -> dict[str, float]:
        """Add one record and return it."""
        found = RowFunctionals(p, self.grid, self.inverse)
        values = {
            "s": s,
            "mass": found.mass(),
            **self._entropy(p, found),
            "minimum": found.minimum(),
            "negative_mass": found.negative_mass(),
            "boundary_mass": diagnostics.ring_share(np.abs(found.rows[0])),
            **extra,
            **found.moments(),
        }
        values |= self._kept_laws(values, found)
        if not self.first:
            self._check_entropy(values["relative_entropy"], found)
        self.first = self.first or values
        self.rows.append(values)
        return values

    def _entropy(self, p: Array, found: RowFunctionals) -> dict[str, float]:
        if self.reference is None or not math.isfinite(found.mass()):
            lost = entropy = math.nan
        elif self.inverse is None:
            arguments = p, self.grid, self.model.noise, self.reference
            lost = diagnostics.entropy_dissipation(*arguments)
            entropy = diagnostics.relative_entropy(p, self.grid, self.reference)
        else:
            lost = found.entropy_dissipation(self.model.noise)
            entropy = found.relative_entropy(self.ratio)
        return {"relative_entropy": entropy, "entropy_dissipation": lost}

    def _check_entropy(self, entropy: float, found: RowFunctionals) -> None:
        """Warn if the start lies where p_S is too small for a logarithm."""
        if self.uncounted is None:
            return
        positive = found.rows[0] + found.rows[5]
        # Times zero even an infinite B counts nothing.
        missing = np.where(positive > 0.0, positive, 0.0)[self.uncounted > 0.0]
        lost = float(missing @ self.uncounted[self.uncounted > 0.0])
        lost *= self.grid.cell_volume
        if lost > _UNCOUNTED * max(1.0, entropy):
            mass = float(missing.sum()) * self.grid.cell_volume
            warnings.warn(
                f"`p0` has a mass of {mass:.2g} where p_S is below {SMALLEST:g}, its "
                "least value under the logarithm; `relative_entropy` begins at "
                f"{entropy:.4g} and is too small by {lost:.2g}. Choose a start or a "
                "box within the walls of the potential.",
                stacklevel=5,
            )

    def _kept_laws(
        self, values: dict[str, float], found: RowFunctionals
    ) -> dict[str, float]:
        """How far the record is from what the equation allows."""
        laws = {}
        if self.falls:
            entropy = values["relative_entropy"]
            self.lowest = min(self.lowest, entropy)
            laws["entropy_rise"] = entropy - self.lowest
        if self.circulation is not None:
            now = self.circulation.of(found)
            start = self.first or {"s": values["s"], "circulation": now}
            left = remaining(self.model.noise, values["s"] - start["s"])
            laws["circulation"] = now
            laws["circulation_deviation"] = now - left * start["circulation"]
        return laws

    def go_on(self, series: Mapping[str, Array]) -> None:
        """Continue after the records in `series`, which were made elsewhere."""
        entropies = series["relative_entropy"]
        self.lowest = float(np.fmin.reduce(entropies, initial=math.inf))

    def floor(self) -> float:
        """Entropy of the reference's restriction to the grid, at the initial mass."""
        if self.reference is None:
            return float("nan")
        start = self.first.get("mass", 1.0)
        return diagnostics.entropy_floor(self.grid, self.reference, start)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of what is recorded."""
        return tuple(self.first) or BASIC

    def series(self) -> dict[str, Any]:
        """The records as arrays, one entry per recorded step."""
        return {key: np.array([row[key] for row in self.rows]) for key in self.columns}
