"""The basic model at rest under an isotropic force: sector by sector, with bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fpsolve._kernels.sector_evolution import (
    DIVERGED,
    TOO_LARGE,
    TOO_LONG,
    Allowance,
    evolve_sector,
)
from fpsolve._kernels.sectors import Equation, distance
from fpsolve._support.arrays import Array
from fpsolve.errors import MemoryLimitError
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.agreement import excess
from fpsolve.spectral.evolution import rings
from fpsolve.spectral.evolution.expansion import Limits
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion, moments
from fpsolve.spectral.evolution.sector_start import (
    OF_MOMENTS,
    of_density,
    of_gaussian,
)
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["applies", "in_sectors"]

# What all sectors together may neglect at first, in units of the tolerance, below which
# errors stay then; and how much less they may where errors are above it.
SHARE, TIGHTER, LEVELS = 4.0, 0.1, 3
# Errors are smaller than their bounds as far as a coarser evolution of the sectors of
# the moments, and of these thirds of all, tells: by how much it is coarser, how often
# the errors may be as large as it tells, and the least share of the bounds that counts.
PROBES, COARSER, SAFETY, LEAST = (1, 2), 100.0, 3.0, 0.01
# What the start may lack of this, in every sector and of all that are left out.
OF_START = 0.01
# Of the tolerance, what the quadrature of the entropy may be wrong by.
SHARE_OF_ENTROPY = 0.1
# Rounding of a few hundred terms of size one.
ROUNDING = 1e-13
# √n for all degrees that may occur, which no memory holds the sectors of.
ROOTS = np.sqrt(np.arange(2.0**15))
# Arrays of one sector alive at a time.
ARRAYS, BYTES = 6, 16


def applies(model: LayDownModel) -> bool:
    """Whether the angular index is kept: B isotropic, and no belt that moves."""
    return bool(model.potential.isotropic) and model.belt_speed == 0


def in_sectors(
    model: LayDownModel,
    start: GaussianStart | DensityStart,
    stops: Array,
    tolerance: float,
    budget: float,
    work: Work,
) -> SpectralSolution | None:
    """The solution, its bounds of errors within the tolerance or the best there is.

    None if the start takes more coefficients than its sectors are tried with.

    Raises
    ------
    MemoryLimitError
        If the start does not fit.
    OutOfWork
    """
    neglected, result = SHARE * tolerance, None
    for _ in range(LEVELS):
        found = coefficients_of(start, OF_START * neglected)
        if found is None:
            return result
        run = Run(model, start, stops, neglected, budget, work)
        try:
            result = run.solution(*found, tolerance)
        except MemoryLimitError:
            if result is None:
                raise
            return result
        if excess(result) <= 1:
            return result
        neglected *= TIGHTER
    return result


def coefficients_of(
    start: GaussianStart | DensityStart, neglected: float
) -> tuple[SectorExpansion, float] | None:
    """The start in sectors, and what each of them lacks."""
    if isinstance(start, GaussianStart):
        return of_gaussian(start, neglected)
    return of_density(start, neglected)


class Run:
    """One evolution of all sectors.

    Parameters
    ----------
    model, start, stops, budget, work
        As for `in_sectors`.
    neglected : float
        Norm that all sectors together may lose.
    """

    def __init__(
        self,
        model: LayDownModel,
        start: GaussianStart | DensityStart,
        stops: Array,
        neglected: float,
        budget: float,
        work: Work,
    ) -> None:
        self.model, self.start, self.stops = model, start, stops
        self.neglected, self.budget, self.work = neglected, budget, work
        # Bytes of what is kept.
        self.held = 0
        self.sigma = quadratic(model).sigma1
        scale = 1.0 / (math.sqrt(2.0) * self.sigma)
        self.equation = Equation(scale, model.diffusivity, ROOTS)

    def solution(
        self, first: SectorExpansion, lacking: float, tolerance: float
    ) -> SpectralSolution:
        """The expansions at all stops, their numbers and bounds."""
        expansions, errors = self.expansions(first)
        rows, bounds = [], []
        for s, h, error in zip(self.stops, expansions, errors, strict=True):
            numbers, bound = self.numbers(s, h, error + lacking, tolerance)
            rows.append(numbers)
            bounds.append(bound)
        names = "mass", "relative_entropy", *MOMENTS
        return SpectralSolution(
            self.model,
            self.stops,
            {name: np.array([row[name] for row in rows]) for name in names},
            {name: np.array([row[name] for row in bounds]) for name in names},
            tuple((h.degree, h.harmonics) for h in expansions),
            tolerance,
            expansions,
        )

    def expansions(
        self, first: SectorExpansion
    ) -> tuple[tuple[SectorExpansion, ...], Array]:
        """At every stop, and the error of every sector there; shape (stops, M)."""
        errors = np.zeros((self.stops.size, len(first.values)))
        values: list[list[Array]] = [[] for _ in self.stops]
        counts: list[list[Limits]] = [[] for _ in self.stops]
        for index in range(len(first.values)):
            for place, (c, count, error) in enumerate(self.stages(first, index)):
                errors[place, index] = error
                values[place].append(c)
                counts[place].append(count)
                self.held += BYTES * int(count.sum())
        found = tuple(
            SectorExpansion(tuple(v), tuple(n))
            for v, n in zip(values, counts, strict=True)
        )
        return found, errors * self.shares(first, found)[:, None]

    def shares(
        self, first: SectorExpansion, found: tuple[SectorExpansion, ...]
    ) -> Array:
        """At every stop, which share of their bounds the errors are taken to be.

        Bounds of losses that are added up as if they all pointed in one direction are
        much larger than the errors, which are known of a coarser evolution: they are
        its distances from the present one. The share that they have of its bounds, the
        largest of a few sectors, times `SAFETY`, is never taken as above one.
        """
        n_sectors = len(first.values)
        thirds = (third * n_sectors // 3 for third in PROBES)
        probes = sorted({*range(OF_MOMENTS), *thirds})
        largest = np.zeros(self.stops.size)
        for index in probes:
            stages = self.stages(first, index, COARSER)
            for place, (c, count, error) in enumerate(stages):
                fine = found[place].values[index], found[place].counts[index]
                away = distance(c, count, *fine)
                largest[place] = max(largest[place], away / error if error else 0.0)
        return np.clip(SAFETY * largest, LEAST, 1.0)

    def stages(
        self, first: SectorExpansion, index: int, coarser: float = 1.0
    ) -> Iterator[tuple[Array, Limits, float]]:
        """One sector at every stop, and its error there."""
        norm = coarser * self.neglected / math.sqrt(2.0 * len(first.values))
        c, count = first.values[index], first.counts[index]
        error, reached = 0.0, 0.0
        for stop in map(float, self.stops):
            c, count, more = self.evolved(c, count, index, stop - reached, norm)
            error, reached = error + more, stop
            yield c, count, error

    def evolved(
        self, c: Array, counts: Limits, index: int, length: float, norm: float
    ) -> tuple[Array, Limits, float]:
        """One sector a length later, and its error; see `evolve_sector`."""
        over = float(self.stops[-1]) or 1.0
        left = self.work.allowed - self.work.spent
        largest = (self.budget - self.held) / (BYTES * ARRAYS)
        allowance = Allowance(norm, over, largest, left)
        c, counts, error, work, ended = evolve_sector(
            c, counts, index, self.equation, length, allowance
        )
        if ended == TOO_LARGE:
            required = self.held + BYTES * ARRAYS * int(counts.sum())
            raise MemoryLimitError(required, int(self.budget), "ask for fewer `s`")
        if ended == DIVERGED:
            raise ArithmeticError("the Chebyshev series did not converge.")
        self.work.spend(work)
        if ended == TOO_LONG:
            raise OutOfWork(work)
        return c, counts, float(error)

    def numbers(
        self, s: float, h: SectorExpansion, errors: Array, tolerance: float
    ) -> tuple[dict[str, float], dict[str, float]]:
        """Mass, entropy and moments at s, and bounds of their errors."""
        values, bounds = moments(h, errors, self.sigma)
        mass = h.at(0, 0, 0).real
        values["mass"] = mass
        # The derivative of this coefficient is zero, term by term.
        bounds["mass"] = abs(mass - 1.0)
        if s == 0 and self.start.relative_entropy is not None:
            values["relative_entropy"] = self.start.relative_entropy
            bounds["relative_entropy"] = 0.0
        else:
            lacking = OF_START * self.neglected
            others = math.sqrt(2.0) * float(np.linalg.norm(errors[1:]))
            both = math.hypot(errors[0], others + lacking)
            found = rings.relative_entropy(h, SHARE_OF_ENTROPY * tolerance, both)
            values["relative_entropy"] = found.value
            bounds["relative_entropy"] = found.error(errors, lacking) + found.doubt
        for name, value in values.items():
            bounds[name] += ROUNDING * max(1.0, abs(value))
        return values, bounds
