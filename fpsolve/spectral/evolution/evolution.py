"""Time evolution for quadratic B by expansion: H(s) and moments to many digits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_positive
from fpsolve._support.memory import allowed_memory
from fpsolve.errors import MemoryLimitError
from fpsolve.evolution.call import recorded
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.agreement import excess, failure
from fpsolve.spectral.evolution import quadrature
from fpsolve.spectral.evolution.expansion import Expansion, spread
from fpsolve.spectral.evolution.exponential import ForwardOperator
from fpsolve.spectral.evolution.layout import SERIES
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.quadratic import (
    check_model,
    checked_tolerance,
    quadratic,
)
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["spectral_solve"]

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
# Work that is allowed unless told otherwise: about a minute.
DEFAULT_WORK = 3e10
# As an expansion spreads, its steps may become cheaper and longer by no more than this.
CHEAPER = 1e-4
# Coefficient arrays alive at a time: three of the recurrence, the start, a copy.
ARRAYS = 5


@recorded()
@one_blas_thread()
def spectral_solve(
    model: LayDownModel,
    p0: Any,
    s: ArrayLike,
    *,
    tolerance: float = 1e-8,
    memory_limit: int | None = None,
    work_limit: float = DEFAULT_WORK,
) -> SpectralSolution:
    """H(p|p_S) and moments at s, for B quadratic, by expansion in Hermite × Fourier.

    p/p_S is expanded in the basis He_i(ξ1/σ1) He_j(ξ2/σ2) e^{ikα}, orthonormal in
    L²(μ), where (7) is a sparse matrix; its exponential is applied by Chebyshev
    series, and which coefficients are kept follows the solution. Nothing of a grid
    scheme is used. Exact: the norm balance d‖h‖²/ds = −A²‖∂_α h‖² on a fixed belt.
    Conserved: mass, up to the tolerance of the exponential. Refined until two
    truncations agree to `tolerance` in every number at every s. The entropy converges
    last, most slowly just after a narrow start; low noise lets the density fold and
    needs many more degrees and harmonics.

    Parameters
    ----------
    model : LayDownModel
        With a QuadraticPotential, isotropic or not, positive noise, and a belt at rest
        or of constant speed.
    p0 : GaussianLaw or (PhaseSpaceGrid, ndarray)
        A law with `mean`, `variance`, `angle` and `concentration`, whose coefficients
        are known in closed form, or a density on a grid that resolves it and has room
        for it: p0/p_S must be in L²(μ).
    s : float or array_like
        Arclengths, non-negative and increasing; p0 is the density at s = 0.
    tolerance : float
        Largest error of each number, relative where the number is above one.
    memory_limit : int, optional
        Bytes; by default what the machine has available.
    work_limit : float
        Coefficients that may be gone through, about two nanoseconds each: with little
        noise they become many, with much noise the steps.

    Returns
    -------
    SpectralSolution

    Raises
    ------
    ValueError
        If the potential is not quadratic, the noise not positive, the curve not a
        straight line at constant speed, the arclengths not increasing, or the start
        not in L²(μ) or not resolved by its grid.
    TypeError
        If `p0` is of another kind.
    MemoryLimitError
        If not even the two coarsest truncations fit.
    ToleranceError
        If the tolerance is not reached within the memory, the work or five refinements.

    References
    ----------
    [KMW09]_, equations (7), (9) and (11).
    """
    check_model(model)
    tolerance = checked_tolerance(tolerance)
    stops = checked_arclengths(s)
    start = start_of(p0, quadratic(model), tolerance)
    budget = allowed_memory(memory_limit)
    work = Work(check_positive("work_limit", work_limit))
    result: SpectralSolution | None = None
    try:
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


def checked_arclengths(s: ArrayLike) -> Array:
    """s as an increasing array; ValueError unless it is one."""
    stops = np.atleast_1d(check_numbers("s", s))
    if stops.ndim != 1 or stops.size == 0:
        raise ValueError(f"`s` must be one number or a list of them, got {s!r}.")
    rising = np.isfinite(stops).all() and (np.diff(stops) > 0).all()
    if not (rising and stops[0] >= 0):
        raise ValueError(
            f"`s` must be finite, non-negative and increasing, got {stops.tolist()}."
        )
    return stops
