"""Stationary densities of smooth fibres through growing truncations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fpsolve._support.arrays import Array
from fpsolve.spectral.bases.coupled import CoupledDiscretisation
from fpsolve.spectral.bases.placing import stationary_vector
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["REMEDY", "Density", "Known", "Refinement"]

# Degree of the first truncation and its growth.
DEGREE, RATIO = 10, 1.3
# Bytes for every entry of a factor, and for every unknown in the iteration.
PER_ENTRY, PER_UNKNOWN = 12, 1600
# Power of the size by which the entries of the factors grow, at most.
FILLING = 1.7
REMEDY = (
    "raise `memory_limit` or `tolerance`, choose a shorter `relaxation_length`, more "
    "noise or a slower belt, for which expansions converge faster, or use "
    "`steady_state`"
)
# What is left to come of the last change where changes fall to less than half of the
# one before; and the share of the largest error, in units of the scale of a moment,
# that no error is below: a change may vanish by chance.
FAST, SHARE, ROUNDING = 0.5, 0.1, 1e-11
SLOWEST = 0.95
# The three truncations do not converge in step, and a change may be less than the next.
SAFETY = 2.0
# For the same reason this share of the change before it counts, too.
BEFORE = 0.25

# Coefficients of a density and their truncation.
Density = tuple[Array, Truncation]


@dataclass(frozen=True)
class Known:
    """A density, its moments, how well they are known, and the coarser one.

    Attributes
    ----------
    fine, coarse : (ndarray, Truncation)
    moments, errors : dict of float
    changes : dict of float
        From the coarser truncation.
    settled : bool
        Whether a third, still coarser one is known: one change may be small by chance.
    """

    fine: Density
    coarse: Density
    moments: dict[str, float]
    errors: dict[str, float]
    changes: dict[str, float]
    settled: bool

    @property
    def both(self) -> tuple[Density, Density]:
        """The coarser one and the finer one."""
        return self.coarse, self.fine

    @property
    def relative(self) -> float:
        """Largest error, relative where the moment is above one."""
        return max(
            error / max(1.0, abs(self.moments[name]))
            for name, error in self.errors.items()
        )


@dataclass(frozen=True)
class Refinement:
    """Truncations of growing degree, until the moments are known or it costs too much.

    Parameters
    ----------
    basis : CoupledDiscretisation
    tolerance : float
        Largest error of a moment, relative where it is above one.
    memory : float
        Bytes.
    work : Work
    """

    basis: CoupledDiscretisation
    tolerance: float
    memory: float
    work: Work

    def run(self) -> Known | None:
        """The last density that could be afforded."""
        known: Known | None = None
        try:
            for known in self.densities():
                if known.settled and known.relative <= self.tolerance:
                    break
        except OutOfWork:
            pass
        return known

    def densities(self) -> Iterator[Known]:
        """One after the other, as long as the next fits into the memory."""
        known: Known | None = None
        coarse: Density | None = None
        degree = DEGREE
        while True:
            truncation, before = self.basis.truncation_of(degree), self.work.spent
            vector, entries = stationary_vector(self.basis, truncation, self.work)
            if coarse is not None:
                known = compared(self.basis, known, coarse, (vector, truncation))
                yield known
            coarse, degree = (vector, truncation), math.ceil(RATIO * degree)
            growth = self.growth(truncation, self.basis.truncation_of(degree))
            needed = PER_ENTRY * entries * growth**FILLING
            if not needed + PER_UNKNOWN * growth * vector.size <= self.memory:
                return
            self.work.foresee(self.work.spent - before, growth)

    def growth(self, small: Truncation, large: Truncation) -> float:
        """By which a larger basis is larger."""
        sector = self.basis.stationary_sector
        return self.basis.size(sector, large) / self.basis.size(sector, small)


def compared(
    basis: CoupledDiscretisation,
    before: Known | None,
    coarse: Density,
    fine: Density,
) -> Known:
    """The finer density with the errors of its moments.

    An error is twice the last change where changes fall to half or less, else twice
    what a geometric sequence has left.
    """
    coarser, moments = (basis.stationary_moments(*one) for one in (coarse, fine))
    coarse, fine = of_mass_one(coarse, coarser), of_mass_one(fine, moments)
    changes = {name: abs(value - coarser[name]) for name, value in moments.items()}
    scale = {name: max(1.0, abs(value)) for name, value in moments.items()}
    if before is not None:
        changes = {
            name: max(one, BEFORE * before.changes[name])
            for name, one in changes.items()
        }
    largest = max(changes[name] / scale[name] for name in moments)
    last = math.inf
    if before is not None:
        last = max(before.changes[name] / scale[name] for name in moments)
    factor = SAFETY * left_to_come(largest, last)
    errors = {
        name: factor * max(changes[name], SHARE * largest * scale[name])
        + ROUNDING * scale[name]
        for name in moments
    }
    return Known(fine, coarse, moments, errors, changes, before is not None)


def left_to_come(change: float, before: float) -> float:
    """What follows the last change, in units of it; at least 1."""
    if math.isinf(before) or change <= FAST * before:
        return 1.0
    ratio = min(change / before, SLOWEST) if before else SLOWEST
    return max(1.0, 2.0 * ratio / (1.0 - ratio))


def of_mass_one(density: Density, moments: dict[str, float]) -> Density:
    """The density over its mass, which is taken out of its moments."""
    vector, truncation = density
    return vector / moments.pop("mass"), truncation
