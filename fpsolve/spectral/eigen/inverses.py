"""Which inverse of L - λ follows an eigenvalue: by factors, or by iteration."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Complex
from fpsolve.errors import ToleranceError
from fpsolve.spectral.bases.coupled import CoupledDiscretisation
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation
from fpsolve.spectral.coupled_inverse import CoupledInverse
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse
from fpsolve.spectral.work import Work

__all__ = ["IteratedInverse", "inverse_of"]

# Up to this size factors of everything cost less than iteration.
DIRECT = 4000
# An eigenvalue that has moved less, relative to itself, stands still; how often the
# inverse is applied; the residuals of its equations, which next to an eigenvalue stall
# before rounding, wanted and allowed; and that of what is returned.
STILL, MOST = 1e-11, 20
EQUATIONS, ALLOWED, RESIDUAL = 1e-9, 1e-6, 1e-7


def inverse_of(
    discretisation: Discretisation,
    sector: Sector,
    truncation: Truncation,
    shift: complex,
    work: Work | None = None,
) -> ShiftedInverse | IteratedInverse:
    """(L - shift)⁻¹ in a truncation."""
    matrix = discretisation.matrix(sector, *truncation)
    large = matrix.shape[0] > DIRECT
    if large and isinstance(discretisation, CoupledDiscretisation):
        offsets = discretisation.states(sector, truncation).offsets
        return IteratedInverse(CoupledInverse(matrix, offsets, shift, work))
    return ShiftedInverse(matrix, shift, work, discretisation.ordering)


class IteratedInverse:
    """The eigenvalue next to a shift by inverse iteration.

    Parameters
    ----------
    inverse : CoupledInverse
        Its shift lies much nearer to one eigenvalue than to all others.
    """

    def __init__(self, inverse: CoupledInverse) -> None:
        self.inverse = inverse

    def eigenpairs(self, n: int, start: Any = None) -> tuple[Complex, Complex]:
        """The nearest eigenvalue and its unit eigenvector, however many are asked for.

        Raises
        ------
        ToleranceError
            If another one is as near.
        """
        inverse = self.inverse
        vector = self._start(start)
        value: complex = inverse.shift
        for _ in range(MOST):
            image = inverse.solve(vector, EQUATIONS, ALLOWED)
            before = value
            value = inverse.shift + 1.0 / np.vdot(vector, image)
            vector = image / np.linalg.norm(image)
            if abs(value - before) <= STILL * abs(value):
                break
        defect = inverse.matrix @ vector - (value - inverse.shift) * vector
        residual = float(np.linalg.norm(defect))
        if not residual <= RESIDUAL * max(1.0, abs(value)):
            remedy = "two eigenvalues lie too near to each other: change the model"
            raise ToleranceError(residual, RESIDUAL, remedy)
        return np.array([value], complex), vector[:, None].astype(complex)

    def nearest(self, n: int, start: Any, apart: float) -> tuple[Complex, Complex]:
        """As `eigenpairs`, which finds no neighbours."""
        return self.eigenpairs(n, start)

    def transposed(self) -> IteratedInverse:
        """That of the transposed matrix, of the same factors."""
        return IteratedInverse(self.inverse.transposed())

    def _start(self, start: Any) -> Any:
        """A unit vector, the same for equal arguments."""
        if start is None:
            start = np.random.default_rng(0).standard_normal(self.inverse.size)
        real = self.inverse.dtype is np.float64
        vector = np.real(start) if real else np.asarray(start, complex)
        return vector / np.linalg.norm(vector)
