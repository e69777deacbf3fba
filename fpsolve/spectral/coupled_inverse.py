"""Equations between many angular indices, solved from those of each index alone."""

from __future__ import annotations

from copy import copy
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import LinearOperator, SuperLU, gmres, splu

from fpsolve.errors import ToleranceError
from fpsolve.spectral.work import Work

__all__ = ["CoupledInverse"]

# What GMRES reduces a residual to, where rounding does not stop it before; and what it
# must have reached.
TOLERANCE, REACHED = 1e-13, 1e-9
# Its vectors, and how often it may begin anew.
VECTORS, RESTARTS = 200, 2
REMEDY = (
    "choose a slower belt or more nearly equal throwing ranges, or use `steady_state`"
)


class CoupledInverse:
    """(matrix - shift)⁻¹ by GMRES, preconditioned by its diagonal blocks.

    The blocks, one for each angular index M, are the generator of a round potential on
    a belt at rest. What a belt and unequal throwing ranges add is a moderate
    perturbation of them, so that a few tens of iterations do.

    Parameters
    ----------
    matrix : csc_array
        Real and square.
    offsets : ndarray of int
        Where its blocks begin, and its size.
    shift : complex
        Must not be an eigenvalue of a block.
    work : Work, optional
        What all of it may cost.

    Raises
    ------
    OutOfWork
        Also by `solve`.
    """

    def __init__(
        self,
        matrix: csc_array,
        offsets: NDArray[np.int64],
        shift: complex = 0.0,
        work: Work | None = None,
    ) -> None:
        self.work = Work() if work is None else work
        self.shift: Any = shift.real if np.imag(shift) == 0 else complex(shift)
        self.dtype = np.float64 if np.imag(shift) == 0 else np.complex128
        size = matrix.shape[0]
        shifted = (matrix - self.shift * eye_array(size)).astype(self.dtype)
        self.matrix = csr_array(shifted)
        self.blocks = [slice(int(a), int(b)) for a, b in pairwise(offsets)]
        self.factors = [self._factorised(block) for block in self.blocks]
        self.entries = sum(factors.nnz for factors in self.factors)
        self.form = "N"

    def _factorised(self, block: slice) -> SuperLU:
        part = csc_array(self.matrix[block, block])
        factors = splu(part, permc_spec="COLAMD")
        self.work.factorised(part.shape[0], factors.nnz)
        return factors

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return int(self.matrix.shape[0])

    def precondition(self, right: Any) -> Any:
        """The solution without the couplings."""
        self.work.solved(self.size, self.entries)
        solution = np.empty(self.size, np.result_type(self.dtype, right))
        for block, factors in zip(self.blocks, self.factors, strict=True):
            part = right[block].astype(solution.dtype)
            solution[block] = factors.solve(part, self.form)
        return solution

    def transposed(self) -> CoupledInverse:
        """(matrixᵀ - shift)⁻¹, of the same factors."""
        other = copy(self)
        other.matrix = csr_array(self.matrix.T)
        other.form = "T"
        return other

    def solve(
        self, right: Any, tolerance: float = TOLERANCE, reached: float = REACHED
    ) -> Any:
        """x with (matrix - shift) x = right, to a residual of `reached` at worst.

        Raises
        ------
        ToleranceError
            If the iteration does not converge: the couplings are too strong.
        """
        if len(self.blocks) == 1:
            return self.precondition(right)
        shape = (self.size, self.size)
        dtype = np.result_type(self.dtype, right)
        product = LinearOperator(
            shape, lambda x: self.matrix @ self.precondition(x), dtype=dtype
        )
        inner, _ = gmres(
            product,
            right,
            rtol=tolerance,
            atol=0.0,
            restart=VECTORS,
            maxiter=RESTARTS,
        )
        solution = self.precondition(inner)
        defect = np.linalg.norm(self.matrix @ solution - right) / np.linalg.norm(right)
        if not defect <= reached:
            raise ToleranceError(float(defect), reached, REMEDY)
        return solution
