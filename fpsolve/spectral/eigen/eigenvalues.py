"""A few eigenvalues of one sparse matrix next to a shift."""

from __future__ import annotations

import math
from copy import copy
from typing import Any

import numpy as np
from scipy.sparse import csc_array, eye_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, SuperLU, eigs, splu

from fpsolve._support.arrays import Complex
from fpsolve.spectral.work import Work

__all__ = ["ShiftedInverse", "factor_bytes", "factorised", "neighbour"]

# Below this size LAPACK is as fast as Arnoldi, and Arnoldi needs room.
DENSE = 40
# A pivot may be this many times smaller than the largest entry of its column.
THRESHOLD = 0.1
# Where more of the columns have no such pivot on the diagonal, rows are exchanged all
# the time and the symmetric order fills the factors; unless they are full anyway.
FEW, SPARSE = 0.4, 20
# How rough the neighbour of an eigenvalue may be that is followed, relative to its
# distance from the shift; how much of everything its start holds; from which distance
# on, in units of that of the eigenvalue, inverse iteration converges; and how often it
# is applied.
ROUGH, EVERYTHING, APART, MOST = 0.1, 1e-2, 8.0, 24
# An eigenvector that inverse iteration moves by less is known.
STILL = 2e-13
# Restarts of one Arnoldi iteration; most end after twenty. Below a size all eigenvalues
# cost less than another iteration.
RESTARTS, SMALL = 200, 600


class ShiftedInverse:
    """(matrix - shift)⁻¹ and Arnoldi iteration on it.

    The start vector is fixed, so that equal arguments give equal results.

    Parameters
    ----------
    matrix : csc_array
        Real and square.
    shift : complex
        Must not be an eigenvalue. Every point with a positive real part is safe:
        L + L* is negative semidefinite. A real shift keeps complex pairs exactly
        conjugate.
    work : Work, optional
        What all of it may cost.
    ordering : str, optional
        Of the columns, as SuperLU calls it, with pivots from all rows.
    """

    def __init__(
        self,
        matrix: csc_array,
        shift: complex,
        work: Work | None = None,
        ordering: str | None = None,
    ) -> None:
        self.matrix, self.size = matrix, matrix.shape[0]
        self.shift = complex(shift)
        self.work = Work() if work is None else work
        self.ordering = ordering
        self.dense = self.size <= DENSE
        if not self.dense:
            self._factorise()

    def _factorise(self) -> None:
        real = self.shift.imag == 0
        self.dtype = np.float64 if real else np.complex128
        shift = self.shift.real if real else self.shift
        shifted = (self.matrix - shift * eye_array(self.size)).astype(self.dtype)
        self.factors = factorised(shifted.tocsc(), self.work, self.ordering)
        self.operator = self._operator("N")

    def _operator(self, transposed: str) -> LinearOperator:
        factors, work, n = self.factors, self.work, self.size

        # Not a method: what refers to this object and belongs to it keeps the factors
        # in memory until the garbage is collected.
        def solve(right: Any) -> Any:
            work.solved(n, factors.nnz)
            return factors.solve(right, transposed)

        return LinearOperator((n, n), matvec=solve, dtype=self.dtype)

    def transposed(self) -> ShiftedInverse:
        """(matrixᵀ - shift)⁻¹, of the same factors."""
        other = copy(self)
        other.matrix = self.matrix.T.tocsc()
        if not self.dense:
            other.operator = self._operator("T")
        return other

    def eigenpairs(
        self, n: int, start: Any = None, tolerance: float = 0.0
    ) -> tuple[Complex, Complex]:
        """The n eigenvalues nearest to the shift, nearest first, and unit eigenvectors.

        Fewer when the matrix is smaller; `start` is a vector near them.
        The tolerance is relative to the distance from the shift, 0 for rounding.
        """
        found = None
        if not self.dense and n < self.size - 1:
            found = self._arnoldi(n, self._start(start), tolerance)
        values, vectors = self._all() if found is None else found
        order = np.argsort(np.abs(values - self.shift), kind="stable")[:n]
        return values[order].astype(complex), vectors[:, order].astype(complex)

    def nearest(self, n: int, start: Any, apart: float) -> tuple[Complex, Complex]:
        """The nearest eigenvalue to rounding, and its neighbours.

        Those are rough, and there may be one only, if they are more than `apart` from
        it; else they are n, as of `eigenpairs`. Among many at nearly the same distance,
        as where an essential spectrum is near, all of them cost a hundred times as much
        as the nearest does by inverse iteration.
        """
        if self.dense or self.size <= 2 * n:
            return self.eigenpairs(n, start)
        known, everything = self._start(start), self._start(None)
        share = EVERYTHING * np.linalg.norm(known) / np.linalg.norm(everything)
        values, vectors = self.eigenpairs(2, known + share * everything, ROUGH)
        near, far = np.abs(values - self.shift)
        beside = neighbour(values, 0)
        alone = beside is not None and abs(beside - values[0]) > apart
        if alone and far > APART * near and self._iterate(values, vectors):
            return values, vectors
        return self.eigenpairs(n, start)

    def _iterate(self, values: Complex, vectors: Complex) -> bool:
        """The first eigenpair by inverse iteration; whether it stands still."""
        vector = self._start(vectors[:, 0])
        vector = vector / np.linalg.norm(vector)
        for _ in range(MOST):
            image = self.operator.matvec(vector)
            inverse = np.vdot(vector, image)
            defect = np.linalg.norm(image - inverse * vector)
            vector = image / np.linalg.norm(image)
            if defect <= STILL * abs(inverse):
                values[0], vectors[:, 0] = self.shift + 1.0 / inverse, vector
                return True
        return False

    def distance(self) -> float:
        """Distance of the nearest eigenvalue from the shift, to about one per cent."""
        if self.dense:
            self.work.diagonalised(self.size)
            values = np.linalg.eigvals(self.matrix.toarray())
            return float(np.abs(values - self.shift).min())
        try:
            found = eigs(
                self.operator,
                k=1,
                ncv=16,
                v0=self._start(None),
                tol=1e-2,
                return_eigenvectors=False,
            )
        except ArpackNoConvergence:
            return 0.0
        return float(1 / np.abs(found[0]))

    def _start(self, start: Any) -> Any:
        # Of all eigenvectors a random vector has a part, and this one always the same.
        if start is None:
            start = np.random.default_rng(0).standard_normal(self.size)
        real = self.shift.imag == 0
        return (np.real(start) if real else np.asarray(start)).astype(self.dtype)

    def _all(self) -> tuple[Complex, Complex]:
        self.work.diagonalised(self.size)
        values, vectors = np.linalg.eig(self.matrix.toarray())
        return values, vectors

    def _arnoldi(
        self, n: int, start: Any, tolerance: float
    ) -> tuple[Complex, Complex] | None:
        """The n largest of the inverse; None if it takes all to be sure of them."""
        for n_krylov in (2 * n + 12, 4 * n + 40, 8 * n + 120):
            n_krylov = min(n_krylov, self.size)
            try:
                values, vectors = eigs(
                    self.operator,
                    k=n,
                    ncv=n_krylov,
                    v0=start,
                    tol=tolerance,
                    maxiter=RESTARTS,
                )
            except ArpackNoConvergence:
                # Those that have converged need not be the nearest.
                if self.size <= SMALL:
                    break
                continue
            shift = self.shift.real if self.shift.imag == 0 else self.shift
            return shift + 1 / values, vectors
        return None


def factorised(matrix: csc_array, work: Work, ordering: str | None = None) -> SuperLU:
    """L U = the matrix, its rows and columns in an order that leaves few entries."""
    if ordering is not None:
        factors = splu(matrix, permc_spec=ordering, diag_pivot_thresh=1.0)
    elif few_pivots(matrix):
        factors = splu(matrix, permc_spec="COLAMD", diag_pivot_thresh=1.0)
    else:
        # Structure and elimination order are symmetric: small factors.
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=THRESHOLD)
    work.factorised(matrix.shape[0], factors.nnz)
    return factors


def few_pivots(matrix: csc_array) -> bool:
    """Whether a sparse matrix has pivots on its diagonal in too few columns.

    So it is where the noise is small: L is nearly skew then.
    """
    largest = np.ravel(abs(matrix).max(axis=0).toarray())
    small = np.abs(matrix.diagonal()) < THRESHOLD * largest
    return bool(np.mean(small) > FEW and matrix.nnz < SPARSE * matrix.shape[0])


def neighbour(values: Complex, chosen: int | np.integer[Any]) -> complex | None:
    """The nearest other eigenvalue, its conjugate included."""
    others = np.delete(np.concatenate([values, values.conj()]), chosen)
    others = others[np.abs(others - values[chosen]) > 0]
    if not others.size:
        return None
    return complex(others[np.argmin(np.abs(others - values[chosen]))])


def factor_bytes(size: int, entries: int | None = None) -> int:
    """Memory for the factors of a matrix of a sector, and its Krylov vectors.

    Measured on the matrices of quadratic potentials: the factors hold about 3 log₂ n
    complex entries and indices for every row, unless it is said how many.
    """
    if entries is None:
        entries = math.ceil(3 * size * math.log2(max(size, 2)))
    return int(24 * entries + 60 * 16 * size)
