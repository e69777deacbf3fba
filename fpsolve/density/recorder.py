"""What a run writes down at every recorded step, and what it may not do."""

from __future__ import annotations

import copy
import math
import warnings
from array import array
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.series import SERIES, Series
from fpsolve.grids import diagnostics
from fpsolve.grids.circulation import Circulation, obeys_circulation_law, remaining
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.reference import as_field, reference_sum
from fpsolve.grids.row_sums import SMALLEST, RowFunctionals, inverse_of
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import value_at
from fpsolve.model.potentials.potential import Potential

# A share of H that matters: a warning tells where B beyond 690 is not counted.
_UNCOUNTED = 1e-3
# A mass of p_S on the grid beyond one that is told.
_TOO_MUCH = 0.01
# What every run records; a run that ends before its first record has these, empty.
ALWAYS = (
    "s", "mass", "relative_entropy", "entropy_dissipation", "minimum", "negative_mass",
    "boundary_mass", "mass_correction",
)  # fmt: skip


def uncounted(potential: Potential, grid: PhaseSpaceGrid, ratio: float) -> Array | None:
    """How far −ln(ratio p_S) lies beyond −ln 1e-300; None where nowhere."""
    value = np.broadcast_to(potential.value(*grid.plane()), grid.shape[:2])
    level = potential.normalisation.log_value + math.log(2 * math.pi / ratio)
    beyond = np.maximum(0.0, value + level + math.log(SMALLEST))
    return beyond if beyond.any() else None


class Record:
    """One step of a run, of which every series says what it takes from it.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha), or DeviceDensity
        As the scheme gives it.
    s : float
    grid : PhaseSpaceGrid
    sums : RowFunctionals
        Of the density, in one pass over it.
    report : mapping of float
        What the scheme says of the steps before.
    """

    def __init__(
        self, recorder: Recorder, p: Array, s: float, report: Mapping[str, float]
    ) -> None:
        self.recorder, self.density, self.s, self.report = recorder, p, s, report
        self.grid = recorder.grid
        self.sums = self.functionals()
        self.moments = self.sums.moments()
        self.boundary_mass = diagnostics.ring_share(np.abs(self.sums.rows[0]))

    @cached_property
    def p(self) -> Array:
        """The density on the host, shape (n1, n2, n_alpha)."""
        return np.asarray(self.density)

    def functionals(self) -> RowFunctionals:
        """Sums over α for every ξ."""
        return RowFunctionals(self.p, self.grid, self.recorder.inverse)

    @cached_property
    def relative_entropy(self) -> float:
        """H(p|r); NaN without a reference or a finite mass."""
        known = self.recorder
        if known.reference is None or not math.isfinite(self.sums.mass()):
            return math.nan
        if known.inverse is None:
            return diagnostics.relative_entropy(self.p, self.grid, known.reference)
        return self.sums.relative_entropy(known.ratio)

    @cached_property
    def entropy_dissipation(self) -> float:
        """−dH/ds by the angle alone; NaN where H is."""
        known, noise = self.recorder, self.recorder.noise
        if known.reference is None or not math.isfinite(self.sums.mass()):
            return math.nan
        if known.inverse is None:
            arguments = self.p, self.grid, noise, known.reference
            return diagnostics.entropy_dissipation(*arguments)
        return self.sums.entropy_dissipation(noise)

    @property
    def entropy_rise(self) -> float | None:
        """H minus the smallest H before, on a belt at rest."""
        return self.recorder.rise(self.relative_entropy)

    @cached_property
    def circulation(self) -> float | None:
        """E G/max |G| where it obeys its law."""
        known = self.recorder.circulation
        return None if known is None else known.of(self.sums)

    @property
    def circulation_deviation(self) -> float | None:
        """E G minus what the law leaves of that at the start."""
        if self.circulation is None:
            return None
        first = self.recorder.first
        start = first or {"s": self.s, "circulation": self.circulation}
        left = remaining(self.recorder.model.noise, self.s - start["s"])
        return self.circulation - left * start["circulation"]


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
    observed : sequence of Series
        Numbers of the caller's own, beside those of `SERIES`.

    Warns
    -----
    UserWarning
        If the start has mass where p_S is below 1e-300, which H does not count
        further, or if p_S weighs more than 1.01 on cells that do not resolve it.
    """

    kind_of_record: type[Record] = Record

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        reference: Array | None = None,
        observed: Sequence[Series] = (),
    ) -> None:
        self.model, self.grid, self.observed = model, grid, observed
        self.noise = model.noise
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
            field = as_field(reference, grid)
            total = reference_sum(field, grid) * grid.cell_volume
            self.ratio = 1.0 / total if total > 0.0 else np.nan
            self.inverse = inverse_of(reference, self.ratio)
        if self.inverse is not None and given is None:
            self.uncounted = uncounted(model.potential, grid, self.ratio)
            self._check_mass(total)
        self.first: dict[str, float] = {}
        self.start: dict[str, float] = {}
        self.floors: dict[float, float] = {}
        self.quiet = self.inverse is None or total <= 1.0 + _TOO_MUCH
        # All records, one after the other: 8 bytes a number.
        self.numbers = array("d")

    def fresh(self) -> Recorder:
        """One with no records yet, which shares what only depends on the run."""
        other = copy.copy(self)
        other.first, other.numbers, other.lowest = {}, array("d"), math.inf
        return other

    def anew(self) -> Recorder:
        """One for another run of the same model on the same grid."""
        other = self.fresh()
        other.start, other.floors = {}, {}
        return other

    def record(
        self, p: Array, s: float, told: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """Add one record and return it.

        Parameters
        ----------
        p : ndarray, shape (n1, n2, n_alpha)
        s : float
        told : mapping of float, optional
            What the scheme says of the steps before; each becomes a series.
        """
        found = self.kind_of_record(self, p, s, told or {})
        values = {}
        for one in (*SERIES.values(), *self.observed):
            value = one.value(found)
            if value is not None:
                values[one.name] = value
        values |= {
            name: one for name, one in found.report.items() if name not in values
        }
        if not self.first:
            self._check_entropy(values["relative_entropy"], found.sums)
        self.first = self.first or values
        self.numbers.extend(values[name] for name in self.first)
        return values

    def record_start(
        self, p: Array, s: float, told: Mapping[str, float]
    ) -> dict[str, float]:
        """`record` of the first density, which all passes of a run have in common."""
        if not self.start:
            self.start.update(self.record(p, s, told))
            return self.start
        self.first = dict(self.start)
        self.numbers.extend(self.first.values())
        self.rise(self.first["relative_entropy"])
        return self.first

    @staticmethod
    def _check_mass(total: float) -> None:
        """Warn if p_S weighs more than one on these cells: H is then below zero."""
        if total > 1.0 + _TOO_MUCH:
            warnings.warn(
                f"`grid` must have cells that resolve p_S, got a mass of {total:.4g} "
                "for it: its wells are narrower than a few cells. `relative_entropy` "
                f"falls to {-math.log(total):.3g} here instead of zero "
                "(`entropy_floor`); refine the cells.",
                stacklevel=5,
            )

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

    def rise(self, entropy: float) -> float | None:
        """How far H lies above its smallest value so far, where it can only fall."""
        if not self.falls:
            return None
        self.lowest = min(self.lowest, entropy)
        return entropy - self.lowest

    def go_on(self, columns: Sequence[str], table: Array) -> None:
        """Continue after the records of a `table`, which were made elsewhere."""
        self.first = dict(zip(columns, table[0].tolist(), strict=True))
        self.numbers = array("d", table.tobytes())
        entropies = self.series()["relative_entropy"]
        self.lowest = float(np.fmin.reduce(entropies, initial=math.inf))

    def floor(self) -> float:
        """Entropy of the reference's restriction to the grid, at the initial mass."""
        if self.reference is None:
            return float("nan")
        start = self.first.get("mass", 1.0)
        if start not in self.floors:
            found = diagnostics.entropy_floor(self.grid, self.reference, start)
            self.floors[start] = found
        return self.floors[start]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of what is recorded."""
        return tuple(self.first) or ALWAYS

    def table(self) -> Array:
        """The records, shape (n_records, n_columns)."""
        return np.array(self.numbers).reshape(-1, len(self.columns))

    def series(self) -> dict[str, Array]:
        """The records as arrays, one entry per recorded step."""
        columns = np.ascontiguousarray(self.table().T)
        return {name: columns[k].copy() for k, name in enumerate(self.columns)}
