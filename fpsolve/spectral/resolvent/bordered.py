"""Sparse equations without their null function, of few solutions with a regular one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array, Complex

__all__ = ["Bordered", "Plain"]


@dataclass(frozen=True, eq=False)
class Plain:
    """A u = f by sparse LU factors.

    Attributes
    ----------
    factors
        SuperLU's.
    """

    factors: Any

    @classmethod
    def of(cls, operator: Any) -> Plain:
        """Of a sparse matrix."""
        return cls(splu(operator.tocsc()))

    def solve(self, right: Any) -> Complex:
        """u."""
        return np.asarray(self.factors.solve(right.astype(complex)))

    def adjoint(self, functional: Any) -> tuple[Complex, complex]:
        """(λ, 0) with Aᵀλ = functional."""
        right = functional.astype(complex)
        return np.asarray(self.factors.solve(right, trans="T")), 0j


@dataclass(frozen=True, eq=False)
class Bordered:
    """Of f the u with row·u = 0 and A u + μ column = f, unique although A column ≈ 0.

    A bordered matrix would be dense after elimination. One number, added to A where it
    lifts the singularity, leaves it sparse: A = B − λ eᵢ eⱼᵀ, and with uⱼ as another
    unknown beside μ all follows from solutions with B.

    Attributes
    ----------
    factors
        SuperLU's, of B.
    column, row : ndarray
    place : (int, int)
        i and j.
    lift : float
        λ.
    trans : {"N", "T"}
        Whether A is the matrix of the factors or its transposed one.
    """

    factors: Any
    column: Any
    row: Any
    place: tuple[int, int]
    lift: float
    trans: Literal["N", "T"] = "N"

    @classmethod
    def of(cls, operator: Any, column: Any, row: Any) -> Bordered:
        """Of a sparse matrix with row A ≈ 0 ≈ A column."""
        i, j = int(np.abs(row).argmax()), int(np.abs(column).argmax())
        lift = float(np.abs(operator.diagonal()).max())
        single = sparse.csr_array(([lift], ([i], [j])), shape=operator.shape)
        return cls(splu((operator + single).tocsc()), column, row, (i, j), lift)

    @property
    def transposed(self) -> Bordered:
        """Aᵀλ + ν row = g, column·λ = 0, by the same factors."""
        return Bordered(
            self.factors, self.row, self.column, self.place[::-1], self.lift, "T"
        )

    def solve(self, right: Any) -> Complex:
        """u."""
        return self.with_multiplier(right)[0]

    def adjoint(self, functional: Any) -> tuple[Complex, complex]:
        """(λ, ν) with Aᵀλ + ν row = functional, column·λ = 0: functional·u = λ·f."""
        return self._transposed.with_multiplier(functional)

    def with_multiplier(self, right: Any) -> tuple[Complex, complex]:
        """u and μ."""
        plain, (lifted, along, small) = self._solved(right), self._of_border
        ends = [-plain[self.place[1]], -(self.row @ plain)]
        at, mu = np.linalg.solve(small, ends)
        return np.asarray(plain + at * lifted - mu * along), complex(mu)

    @cached_property
    def _transposed(self) -> Bordered:
        return self.transposed

    @cached_property
    def _of_border(self) -> tuple[Complex, Complex, Array]:
        """Solutions for λ eᵢ and for the column, and the equation of uⱼ and μ."""
        i, j = self.place
        unit = np.zeros(len(self.row), complex)
        unit[i] = self.lift
        lifted, along = self._solved(unit), self._solved(self.column)
        lower = [self.row @ lifted, -(self.row @ along)]
        return lifted, along, np.array([[lifted[j] - 1.0, -along[j]], lower])

    def _solved(self, right: Any) -> Complex:
        right = np.asarray(right, complex)
        return np.asarray(self.factors.solve(right, trans=self.trans))
