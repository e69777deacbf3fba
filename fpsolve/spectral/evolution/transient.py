"""Truncations of the basic model, each finer than the one before, until two agree."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.memory import allowed_memory
from fpsolve.errors import MemoryLimitError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.agreement import excess, failure
from fpsolve.spectral.evolution import quadrature, sector_transient
from fpsolve.spectral.evolution.expansion import Expansion, spread
from fpsolve.spectral.evolution.exponential import ForwardOperator
from fpsolve.spectral.evolution.layout import SERIES
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["TOLERANCE", "transient"]

# Unless told otherwise.
TOLERANCE = 1e-8
# Refinements before giving up; each multiplies degrees and harmonics by RATIO and
# divides what is neglected by TIGHTER.
LEVELS = 6
RATIO, TIGHTER = 4 / 3, 10.0
DEGREES_PER_DIGIT, HARMONICS_PER_DIGIT = 16, 6
# Room beyond the last significant coefficient, and how close to its limits the
# expansion may come over one step before the step is repeated with more; see `spread`.
MARGIN, NEEDED = 0.4, 0.1
WIDER = 1.5
# The series of one step may be wrong by this share of what a truncation neglects.
SHARE = 1e-4
# The same for the quadrature of the entropy.
SHARE_OF_ENTROPY = 0.1
# As an expansion spreads, its steps may become cheaper and longer by no more than this.
CHEAPER = 1e-4
# Coefficient arrays alive at a time: three of the recurrence, the start, a copy.
ARRAYS = 5


def transient(
    model: LayDownModel,
    p0: Any,
    stops: Array,
    tolerance: float,
    memory_limit: int | None,
    work: Work,
) -> SpectralSolution:
    """Truncations of the basic model, until two agree."""
    start = start_of(p0, quadratic(model), tolerance)
    budget = allowed_memory(memory_limit)
    result: SpectralSolution | None = None
    try:
        if sector_transient.applies(model):
            result = sector_transient.in_sectors(
                model, start, stops, tolerance, budget, work
            )
            if result is not None and excess(result) <= 1:
                return result
        coarse = run(model, start, stops, level(0, tolerance, budget, stops.size), work)
        for refinement in range(1, LEVELS):
            try:
                finer = level(refinement, tolerance, budget, stops.size)
            except MemoryLimitError:
                if refinement == 1:
                    raise
                break
            fine = run(model, start, stops, finer, work)
            result = compared(model, stops, coarse, fine, tolerance)
            if excess(result) <= 1:
                return result
            coarse = fine
    except OutOfWork:
        pass
    raise failure(result, model, work, tolerance)


@dataclass(frozen=True)
class Level:
    """A truncation: largest degree and harmonic, and the norm that is neglected."""

    degree: int
    harmonics: int
    neglected: float


@dataclass(frozen=True, eq=False)
class Run:
    """What one truncation gives at each s."""

    series: dict[str, Array]
    expansions: tuple[Expansion, ...]
    # Estimated error of the quadrature of the entropy.
    doubts: Array


def level(refinement: int, tolerance: float, budget: float, n_stops: int) -> Level:
    """Truncation number `refinement`; MemoryLimitError if it may not fit."""
    digits = max(4.0, -math.log10(tolerance))
    size = digits * RATIO**refinement
    degree, harmonics = int(DEGREES_PER_DIGIT * size), int(HARMONICS_PER_DIGIT * size)
    one = (degree + 2) ** 2 * (2 * harmonics + 4) * 8
    # Expansions that are kept, of two runs, shrink as the density spreads.
    required = int(one * (ARRAYS + 0.5 * n_stops))
    if not required <= budget:
        raise MemoryLimitError(required, int(budget), "ask for fewer `s`")
    return Level(degree, harmonics, tolerance * TIGHTER ** (1 - refinement))


def run(
    model: LayDownModel,
    start: GaussianStart | DensityStart,
    stops: Array,
    level: Level,
    work: Work,
) -> Run:
    """Evolve the start to every stop within one truncation."""
    potential = quadratic(model)
    found, rows, doubts = [], [], []
    for s, h in zip(stops, evolve(model, start, stops, level, work), strict=True):
        entropy, doubt = quadrature.relative_entropy(
            h, SHARE_OF_ENTROPY * level.neglected
        )
        if s == 0 and start.relative_entropy is not None:
            entropy, doubt = start.relative_entropy, 0.0
        mass = float(h.values[0, 0, 0])
        rows.append((mass, entropy, *quadrature.moments(h, potential).values()))
        found.append(h)
        doubts.append(doubt)
    columns = np.array(rows).T
    return Run(dict(zip(SERIES, columns, strict=True)), tuple(found), np.array(doubts))


def evolve(
    model: LayDownModel,
    start: GaussianStart | DensityStart,
    stops: Array,
    level: Level,
    work: Work,
) -> Iterator[Expansion]:
    """The expansion at every stop, its limits following what is significant."""
    operator = ForwardOperator(model)
    h = fitted(start.expansion(level.degree, level.harmonics), level)
    reached = 0.0
    for stop in stops:
        while reached < stop:
            ds, before = min(operator.longest(h.limits), stop - reached), work.spent
            h = step(operator, h, ds, level, work)
            left = (stops[-1] - reached) / ds
            work.foresee(CHEAPER * left * (work.spent - before))
            reached = stop if stop - reached - ds <= 1e-13 * stop else reached + ds
        # A copy without the room that the next step needs.
        yield fitted(h, level, 0)


def step(
    operator: ForwardOperator, h: Expansion, ds: float, level: Level, work: Work
) -> Expansion:
    """One step, repeated with more room while the expansion runs into its limits."""
    margin = MARGIN
    while True:
        moved = operator.advance(h, ds, SHARE * level.neglected, work)
        needed = limits_of(moved, level, NEEDED)
        n = max(needed.size, h.limits.size)
        if np.all(padded(needed, n) <= padded(h.limits, n)):
            return fitted(moved, level)
        margin *= WIDER
        wider = limits_of(moved, level, margin)
        n = max(wider.size, n)
        h = h.within(np.maximum(padded(wider, n), padded(h.limits, n)))


def limits_of(h: Expansion, level: Level, margin: float) -> NDArray[np.int64]:
    """Limits around what is significant in h, within the truncation."""
    cap = level.degree, level.harmonics
    return spread(h.energies(), level.neglected, margin, cap)


def fitted(h: Expansion, level: Level, margin: float = MARGIN) -> Expansion:
    """The same expansion under limits that follow it."""
    return h.within(limits_of(h, level, margin))


def padded(limits: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Limits for n degrees, −1 beyond the last."""
    return np.concatenate([limits, np.full(n - limits.size, -1)])


def compared(
    model: LayDownModel, stops: Array, coarse: Run, fine: Run, tolerance: float
) -> SpectralSolution:
    """The finer run, with its change from the coarser one as estimate."""
    drift = np.abs(fine.series["mass"] - 1.0)
    errors = {}
    for name, values in fine.series.items():
        change = np.abs(values - coarse.series[name])
        errors[name] = change + drift * np.maximum(1.0, np.abs(values))
    errors["relative_entropy"] += fine.doubts
    truncation = tuple((h.degree, h.harmonics) for h in fine.expansions)
    return SpectralSolution(
        model, stops, fine.series, errors, truncation, tolerance, fine.expansions
    )


def start_of(
    p0: Any, potential: QuadraticPotential, tolerance: float
) -> GaussianStart | DensityStart:
    """The initial density; TypeError if it is of no known kind."""
    if all(hasattr(p0, name) for name in ("mean", "variance", "concentration")):
        return GaussianStart(p0, potential)
    if isinstance(p0, tuple) and len(p0) == 2 and isinstance(p0[0], PhaseSpaceGrid):
        return DensityStart(*p0, potential, tolerance)
    raise TypeError(
        "`p0` must be a GaussianLaw or a pair (grid, density), got "
        f"{type(p0).__name__}; a path's point law has no density."
    )
