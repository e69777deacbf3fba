"""Eigenvalues followed through growing bases until they stand still."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.spectral.bases.sectors import Discretisation, Sector
from fpsolve.spectral.eigen.eigenvalues import factor_bytes
from fpsolve.spectral.eigen.following import compared, condition, next_mode
from fpsolve.spectral.eigen.survey import Mode, Scale, leading, order, survey
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["Refinement"]

# Two truncations show the same branch when its eigenvalue moves by less than this
# share of the rate; what is spurious moves by more.
SAME_BRANCH = 0.1
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
    # Error relative to the rate that will do where memory or work end.
    largest: float = 0.0

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
        truncation = self.discretisation.truncation(level)
        entries = self.discretisation.factor_entries(truncation)
        return factor_bytes(self.size(level), entries)

    def size(self, level: int) -> int:
        """Functions in the largest of the first sectors."""
        truncation = self.discretisation.truncation(level)
        sectors = itertools.islice(self.discretisation.sectors(), 4)
        return max(self.discretisation.size(sector, truncation) for sector in sectors)

    def growth(self, level: int) -> float:
        """By which the basis of the next level is larger."""
        return self.size(level + 1) / self.size(level)

    def against(self, coarser: list[Mode], mode: Mode) -> Mode:
        """The mode with its distance to the nearest of the same sector before."""
        same = [other for other in coarser if other.sector == mode.sector]
        if not same:
            return mode
        nearest = min(same, key=lambda other: abs(other.eigenvalue - mode.eigenvalue))
        known = condition(self.discretisation, mode, self.work)
        return compared(mode, nearest, known, self.discretisation.irregular)

    def followed(self, modes: list[Mode], level: int) -> list[Mode]:
        """The modes that are or may be among the first, each to the tolerance."""
        first = [self.follow(mode, level) for mode in self.first(modes)]
        last = max((mode.rate + mode.error for mode in first), default=math.inf)
        # Beyond the n-th of the survey, which is rough, but perhaps not of L.
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
        """The modes; ToleranceError unless all are known, or well enough."""
        if all(map(self.known, modes)) or worst(modes) <= self.largest:
            return modes
        raise self.failure(modes)

    def fewer(self, modes: list[Mode]) -> str:
        """Fewer eigenvalues, and how many where the slowest of all stand still.

        Right of an essential spectrum truncations have modes that move to it slowly,
        and among which those of L, if there are more, would be told much later.
        """
        steady = itertools.takewhile(same_branch, modes)
        n = sum(mode.count for mode in steady)
        if not 0 < n < self.n:
            return "ask for fewer eigenvalues"
        return f"ask for fewer eigenvalues (the slowest {n} are resolved)"

    def failure(self, modes: list[Mode]) -> ToleranceError:
        """How far the modes are from being known, and what it would take."""
        remedy = REMEDY
        if self.work.required:
            remedy = (
                f"at noise {self.discretisation.noise:g} it takes work of "
                f"{self.work.required:.2g} or more, where {self.work.allowed:.2g} is "
                "allowed: choose a larger noise (an isotropic potential has an "
                "EnergyProcess as its limit of little noise), enlarge `tolerance`, "
                f"{self.fewer(modes)} or raise `work_limit`"
            )
        return ToleranceError(worst(modes), max(self.tolerance, self.largest), remedy)


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
