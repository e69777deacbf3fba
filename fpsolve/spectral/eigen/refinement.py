"""Eigenvalues followed through growing bases until they stand still."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.spectral.bases.sectors import Discretisation, Sector
from fpsolve.spectral.eigen.eigenvalues import (
    ShiftedInverse,
    factor_bytes,
    neighbour,
    residual_norm,
)
from fpsolve.spectral.eigen.survey import Mode, Scale, leading, order, survey
from fpsolve.spectral.work import OutOfWork, Work

__all__ = [
    "Refinement",
    "halves",
    "left_vector",
    "next_mode",
    "slowness",
    "with_residual",
]

Complex = NDArray[np.complex128]

# Two truncations show the same branch when its eigenvalue moves by less than this
# share of the rate; what is spurious moves by more.
SAME_BRANCH = 0.1
# Eigenvalues nearer than this share of the rate are compared as a pair.
PAIR = 0.1
# Successive changes that do not fall to this share are the beginning of a long tail, of
# algebraic decay at worst. The first change is taken as if they fell to FIRST, and none
# falls more slowly than to SLOWEST.
FAST, FIRST, SLOWEST = 0.5, 0.6, 0.99
# Scatter of computed eigenvalues, in units of the rounding error of one number.
ROUNDING = 16 * float(np.finfo(np.float64).eps)
TINY = 1e-16
REMEDY = "raise `memory_limit`, enlarge `tolerance` or ask for fewer eigenvalues"


@dataclass(frozen=True)
class Refinement:
    """The slowest n eigenvalues to a tolerance.

    Surveys of growing truncations are compared until the n slowest modes of one are
    branches that the one before has too; what does not stay in place is spurious or
    not yet resolved. Only those modes are then followed to the tolerance, and with
    them every other mode of the survey that may turn out to be as slow.
    """

    discretisation: Discretisation
    n: int
    tolerance: float
    scale: Scale
    memory: int
    sectors: tuple[Sector, ...] | None = None
    work: Work = field(default_factory=Work)

    def run(self) -> list[Mode]:
        """The modes, slowest first."""
        required = self.required(0)
        if required > self.memory:
            raise MemoryLimitError(required, self.memory, "close other programs")
        coarse: list[Mode] = []
        try:
            for coarse, level in self.surveys():
                # Eigenvalues of a survey are rough, and computed again to rounding.
                if all(map(same_branch, self.first(coarse))):
                    modes = self.followed(coarse, level + 1)
                    if distinct(modes, coarse):
                        return self.checked(self.first(modes))
        except OutOfWork:
            pass
        raise self.failure(self.first(coarse))

    def surveys(self) -> Iterator[tuple[list[Mode], int]]:
        """The modes of every level that fits, compared with those of the one before."""
        coarse: list[Mode] = []
        for level in itertools.count():
            if self.required(level) > self.memory:
                return
            before = self.work.spent
            fine = [self.against(coarse, mode) for mode in self.survey(level)]
            yield fine, level
            coarse = fine
            self.work.foresee(self.work.spent - before, self.growth(level))

    def survey(self, level: int) -> list[Mode]:
        """All modes of a level that count."""
        truncation = self.discretisation.truncation(level)
        return survey(
            self.discretisation, truncation, self.n, self.scale, self.sectors, self.work
        )

    def first(self, modes: list[Mode]) -> list[Mode]:
        """The n slowest."""
        return leading(sorted(modes, key=order), self.n)

    def required(self, level: int) -> int:
        """Bytes for the basis of a level, in the largest of the first sectors."""
        return factor_bytes(self.size(level))

    def size(self, level: int) -> int:
        """Functions in the largest of the first sectors."""
        truncation = self.discretisation.truncation(level)
        sectors = itertools.islice(self.discretisation.sectors(), 4)
        return max(len(self.discretisation.harmonics(s, truncation)) for s in sectors)

    def growth(self, level: int) -> float:
        """By which the basis of the next level is larger."""
        return self.size(level + 1) / self.size(level)

    def against(self, coarser: list[Mode], mode: Mode) -> Mode:
        """The mode with its distance to the nearest of the same sector before."""
        same = [other for other in coarser if other.sector == mode.sector]
        if not same:
            return mode
        nearest = min(same, key=lambda other: abs(other.eigenvalue - mode.eigenvalue))
        return compared(mode, nearest, condition(self.discretisation, mode, self.work))

    def followed(self, modes: list[Mode], level: int) -> list[Mode]:
        """The modes that are or may be among the first, each to the tolerance."""
        first = [self.follow(mode, level) for mode in self.first(modes)]
        last = max((mode.rate + mode.error for mode in first), default=math.inf)
        others = []
        for mode in modes[len(first) :]:
            moved = min(mode.error, SAME_BRANCH * mode.rate)
            if mode.rate - moved <= last:
                others.append(self.follow(mode, level, last))
        return first + others

    def follow(self, mode: Mode, level: int, last: float = math.inf) -> Mode:
        """The mode in larger and larger bases, until it is known or known not to count.

        Its error is the distance to the eigenvalue of the truncation before, which
        overestimates while the truncation converges fast, and more where it does not.
        """
        try:
            while not (self.known(mode) or mode.rate - mode.error > last):
                if self.required(level) > self.memory:
                    break
                before = self.work.spent
                mode = next_mode(self.discretisation, mode, level, self.work)
                if not self.known(mode):
                    self.work.foresee(self.work.spent - before, self.growth(level))
                level += 1
        except OutOfWork:
            pass
        return mode

    def known(self, mode: Mode) -> bool:
        """Whether only rounding may keep it from the tolerance."""
        allowed = max(self.tolerance * mode.rate, mode.rounding)
        return mode.error - mode.rounding <= allowed

    def checked(self, modes: list[Mode]) -> list[Mode]:
        """The modes; ToleranceError unless all are known."""
        if not all(map(self.known, modes)):
            raise self.failure(modes)
        return modes

    def failure(self, modes: list[Mode]) -> ToleranceError:
        """How far the modes are from being known, and what it would take."""
        remedy = REMEDY
        if self.work.required:
            remedy = (
                f"at noise {self.discretisation.noise:g} it takes work of "
                f"{self.work.required:.2g} or more, where {self.work.allowed:.2g} is "
                "allowed: choose a larger noise (an isotropic potential has an "
                "EnergyProcess as its limit of little noise), enlarge `tolerance`, ask "
                "for fewer eigenvalues or raise `work_limit`"
            )
        return ToleranceError(worst(modes), self.tolerance, remedy)


def same_branch(mode: Mode) -> bool:
    """Whether two truncations show the same branch."""
    return mode.change + mode.rounding <= SAME_BRANCH * mode.rate


def worst(modes: list[Mode]) -> float:
    """Largest error relative to the rate."""
    return max((mode.error / mode.rate for mode in modes), default=math.inf)


def distinct(modes: list[Mode], before: list[Mode]) -> bool:
    """Whether no two modes were followed to the same eigenvalue."""
    for (mode, start), (other, start_other) in itertools.combinations(
        zip(modes, before, strict=False), 2
    ):
        if mode.sector == other.sector:
            apart = abs(start.eigenvalue - start_other.eigenvalue)
            if abs(mode.eigenvalue - other.eigenvalue) < 1e-3 * apart:
                return False
    return True


def next_mode(
    discretisation: Discretisation, mode: Mode, level: int, work: Work | None = None
) -> Mode:
    """The mode in the basis of a level, with its error."""
    truncation = discretisation.truncation(level)
    matrix = discretisation.matrix(mode.sector, *truncation)
    value = mode.eigenvalue
    start = discretisation.embed(mode.vector, mode.sector, mode.truncation, truncation)
    # Off the eigenvalue itself; and on the axis when that is near, where a complex
    # pair that has just parted from it stays exactly conjugate.
    off = 1e-3 * mode.rate
    real = abs(value.imag) < PAIR * mode.rate
    shift = complex(value.real + off, 0.0 if real else value.imag)
    values, vectors = ShiftedInverse(matrix, shift, work).eigenpairs(4, start)
    chosen = int(np.argmin(np.abs(values - value)))
    partner = neighbour(values, chosen)
    fine = replace(
        mode,
        eigenvalue=complex(values[chosen]),
        vector=vectors[:, chosen],
        truncation=truncation,
        partner=partner,
    )
    return compared(fine, mode, condition(discretisation, fine, work))


def compared(fine: Mode, coarse: Mode, condition: float) -> Mode:
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
            if rounding > gap:
                rounding = math.sqrt(rounding * gap)
    error = moved if moved <= rounding else moved * slowness(moved, coarse.change)
    return replace(fine, change=moved, error=error + rounding, rounding=rounding)


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
    discretisation: Discretisation, mode: Mode, work: Work | None = None
) -> float:
    """1/|⟨l, r⟩|, unit left and right eigenvectors: how far rounding is magnified.

    On a fixed belt turning α by π takes L to L*, so that the left eigenvector is the
    right one with the odd harmonics reversed.
    """
    left = left_vector(discretisation, mode, work)
    return 1 / max(abs(complex(left @ mode.vector)), TINY)


def left_vector(
    discretisation: Discretisation, mode: Mode, work: Work | None = None
) -> Complex:
    """Unit coefficients of the eigenfunction of L*, whose matrix is the transpose."""
    if not getattr(discretisation, "belt_speed", 0.0):
        k = discretisation.harmonics(mode.sector, mode.truncation)
        reversed_: Complex = np.where(k % 2 == 0, 1.0, -1.0) * mode.vector
        return reversed_
    matrix = discretisation.matrix(mode.sector, *mode.truncation)
    shift = mode.eigenvalue + 1e-3 * mode.rate
    values, vectors = ShiftedInverse(matrix.T.tocsc(), shift, work).eigenpairs(2)
    chosen: Complex = vectors[:, np.argmin(np.abs(values - mode.eigenvalue))]
    return chosen


def with_residual(discretisation: Discretisation, mode: Mode) -> Mode:
    """The mode with ‖L f - λ f‖/‖f‖.

    Taken in the next larger basis, or by the quadrature of a basis that does not hold
    L f even there.
    """
    own = getattr(discretisation, "residual", None)
    if own is not None:
        norm = own(mode.vector, mode.eigenvalue, mode.sector, mode.truncation)
        return replace(mode, residual=float(norm))
    large = discretisation.enlarged(mode.truncation)
    vector = discretisation.embed(mode.vector, mode.sector, mode.truncation, large)
    matrix = discretisation.matrix(mode.sector, *large)
    return replace(mode, residual=residual_norm(matrix, mode.eigenvalue, vector))
