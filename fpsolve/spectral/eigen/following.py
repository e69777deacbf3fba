"""An eigenvalue followed from one basis to the next, with its error."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from fpsolve._support.arrays import Complex
from fpsolve.spectral.bases.sectors import Discretisation
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse, neighbour
from fpsolve.spectral.eigen.inverses import IteratedInverse, inverse_of
from fpsolve.spectral.eigen.survey import Mode
from fpsolve.spectral.work import Work

__all__ = [
    "compared",
    "condition",
    "halves",
    "left_to_come",
    "left_vector",
    "next_mode",
    "slowness",
]

# Eigenvalues nearer than this share of the rate are compared as a pair.
PAIR = 0.1
# Those further from each other than this share, roughly, are not.
BESIDE = 3 * PAIR
# Successive changes that do not fall to this share are the beginning of a long tail, of
# algebraic decay at worst. The first change is taken as if they fell to FIRST, and none
# falls more slowly than to SLOWEST.
FAST, FIRST, SLOWEST = 0.5, 0.6, 0.99
# Scatter of computed eigenvalues, in units of the rounding error of one number.
ROUNDING = 16 * float(np.finfo(np.float64).eps)
TINY = 1e-16
# Of irregular truncations: times the last change, or this share of the one before.
SAFETY, BEFORE = 2.0, 0.25


def next_mode(
    discretisation: Discretisation, mode: Mode, level: int, work: Work | None = None
) -> Mode:
    """The mode in the basis of a level, with its error."""
    truncation = discretisation.truncation(level)
    value = mode.eigenvalue
    start = discretisation.embed(mode.vector, mode.sector, mode.truncation, truncation)
    # Off the eigenvalue itself; and on the axis when that is near, where a complex
    # pair that has just parted from it stays exactly conjugate.
    off = 1e-3 * mode.rate
    real = abs(value.imag) < PAIR * mode.rate
    shift = complex(value.real + off, 0.0 if real else value.imag)
    inverse = inverse_of(discretisation, mode.sector, truncation, shift, work)
    values, vectors = inverse.nearest(4, start, BESIDE * mode.rate)
    chosen = int(np.argmin(np.abs(values - value)))
    partner = neighbour(values, chosen)
    fine = replace(
        mode,
        eigenvalue=complex(values[chosen]),
        vector=vectors[:, chosen],
        truncation=truncation,
        partner=partner,
    )
    known = condition(discretisation, fine, work, inverse)
    return compared(fine, mode, known, discretisation.irregular)


def compared(
    fine: Mode, coarse: Mode, condition: float, irregular: bool = False
) -> Mode:
    """The finer mode with its distance to the coarser one, and its error.

    Near a double eigenvalue λ = m ± √δ the mean m and δ, not λ, converge smoothly, so
    that their distances are taken and carried over to λ.
    """
    rounding = ROUNDING * condition * abs(fine.eigenvalue)
    moved = abs(fine.eigenvalue - coarse.eigenvalue)
    if fine.partner is not None and coarse.partner is not None:
        gap = abs(fine.eigenvalue - fine.partner) / 2
        if gap < PAIR * fine.rate:
            mean, delta = halves(fine)
            mean_before, delta_before = halves(coarse)
            change = abs(delta - delta_before)
            moved = abs(mean - mean_before) + math.sqrt(gap**2 + change) - gap
            # The condition grows like 1/gap: their product is the rounding of δ, and
            # its root that of √δ.
            if rounding > gap:
                rounding = math.sqrt(rounding * gap)
    if irregular:
        error = left_to_come(moved, coarse.change)
    else:
        error = moved if moved <= rounding else moved * slowness(moved, coarse.change)
    return replace(fine, change=moved, error=error + rounding, rounding=rounding)


def left_to_come(change: float, before: float) -> float:
    """What is left after two changes of truncations that do not converge in step.

    One change may be small by chance: for R = 0.1, A = 2, v = 0.2 the first is 2e-5 and
    the distance to the gap 1.7e-4. Infinite, therefore, after one.
    """
    if math.isinf(before):
        return math.inf
    change = max(change, BEFORE * before)
    return SAFETY * change * slowness(change, before) if change else 0.0


def slowness(change: float, before: float) -> float:
    """What is left to come, relative to the last change; 1 where they fall fast.

    Geometric changes of ratio q < 1 leave q/(1 - q) of the last; those of algebraic
    decay, whose ratio tends to 1, up to twice as much.
    """
    if change <= FAST * before < math.inf:
        return 1.0
    ratio = min(change / before, SLOWEST) if before else SLOWEST
    if math.isinf(before):
        ratio = FIRST
    return 2 * ratio / (1 - ratio)


def halves(mode: Mode) -> tuple[complex, complex]:
    """Mean m and discriminant δ of an eigenvalue and its neighbour, m ± √δ."""
    assert mode.partner is not None
    mean = (mode.eigenvalue + mode.partner) / 2
    return mean, ((mode.eigenvalue - mode.partner) / 2) ** 2


def condition(
    discretisation: Discretisation,
    mode: Mode,
    work: Work | None = None,
    inverse: ShiftedInverse | IteratedInverse | None = None,
) -> float:
    """1/|⟨l, r⟩|, unit left and right eigenvectors: how far rounding is magnified.

    Of a basic fibre on a fixed belt turning α by π takes L to L*, so that the left
    eigenvector is the right one with the odd harmonics reversed.
    """
    left = left_vector(discretisation, mode, work, inverse)
    return 1 / max(abs(complex(left @ mode.vector)), TINY)


def left_vector(
    discretisation: Discretisation,
    mode: Mode,
    work: Work | None = None,
    inverse: ShiftedInverse | IteratedInverse | None = None,
) -> Complex:
    """Unit coefficients of the eigenfunction of L*, whose matrix is the transpose.

    Where `inverse` is known of a shift near the eigenvalue, by its factors.
    """
    if discretisation.reversible:
        k = discretisation.harmonics(mode.sector, mode.truncation)
        reversed_: Complex = np.where(k % 2 == 0, 1.0, -1.0) * mode.vector
        return reversed_
    if inverse is None:
        shift = mode.eigenvalue + 1e-3 * mode.rate
        where = mode.sector, mode.truncation
        inverse = inverse_of(discretisation, *where, shift, work)
    values, vectors = inverse.transposed().eigenpairs(2)
    chosen: Complex = vectors[:, np.argmin(np.abs(values - mode.eigenvalue))]
    return chosen
