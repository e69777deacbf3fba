"""What an expansion costs, counted so that it is the same on every machine."""

from __future__ import annotations

import math

__all__ = ["DEFAULT_WORK", "OutOfWork", "Work"]

# About twenty seconds: two nanoseconds for every entry of the factors in a solution.
DEFAULT_WORK = 1e10
# The same for a generator applied to an expansion: for every coefficient, and at least.
PER_COEFFICIENT, AT_LEAST = 2.0, 5e3
# Measured, in solutions: what a factorisation costs, for every entry of the factors
# and for every pair of them in a column; a full matrix, for every n³; and how many
# entries the vectors of an iteration are worth.
PER_ENTRY, PER_PAIR, PER_CUBE, PER_ROW = 20.0, 0.15, 6.0, 40.0
# A basis that is n times as large costs at least n to this power as much.
GROWTH = 1.5


class OutOfWork(Exception):
    """The work that is allowed is spent, or will be.

    Parameters
    ----------
    required : float
        How much it takes at least.
    """

    def __init__(self, required: float) -> None:
        super().__init__(f"{required:g}")
        self.required = required


class Work:
    """Numbers that are gone through, of factors or expansions, and what is allowed.

    No clock is asked: what is refused does not depend on what else the machine does.

    Parameters
    ----------
    allowed : float
        May be infinite.

    Attributes
    ----------
    spent : float
    required : float
        0, or what was refused.
    """

    def __init__(self, allowed: float = math.inf) -> None:
        self.allowed, self.spent, self.required = allowed, 0.0, 0.0

    def factorised(self, n: int, entries: int) -> None:
        """A sparse matrix of n columns has been factorised."""
        self.spend(PER_ENTRY * entries + PER_PAIR * entries**2 / n)

    def solved(self, n: int, entries: int) -> None:
        """One system has been solved, in an iteration."""
        self.spend(entries + PER_ROW * n)

    def applied(self, n_coefficients: int) -> None:
        """A generator has been applied to an expansion."""
        self.spend(PER_COEFFICIENT * n_coefficients + AT_LEAST)

    def diagonalised(self, n: int) -> None:
        """All eigenvalues of a full matrix will be computed."""
        self.spend(PER_CUBE * n**3)

    def spend(self, work: float) -> None:
        """Count; OutOfWork when more than allowed is spent."""
        self.spent += work
        self.foresee(0.0)

    def foresee(self, work: float, growth: float = 1.0) -> None:
        """OutOfWork if so much more, in a basis larger by `growth`, is too much."""
        required = self.spent + work * growth**GROWTH
        if not required <= self.allowed:
            self.required = max(self.required, required)
            raise OutOfWork(required)
