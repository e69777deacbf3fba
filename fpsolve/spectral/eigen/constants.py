"""Which eigenvalue of a truncation is the 0 of the constants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Complex
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation

__all__ = ["Constants"]

# Found from two shifts, an eigenvalue differs by rounding only, relative to its
# distance from them.
SAME = 1e-6


@dataclass
class Constants:
    """The mode of the constants, which is no mode of a decay.

    Where they belong to the basis, its eigenvalue is 0 to rounding. Where functions
    only approximate them it is the eigenvalue whose function is most nearly constant.
    No bound on eigenvalues would do: of unequal throwing ranges the gap may be
    arbitrarily much slower than any other rate, and a coarse truncation has 0 at the
    distance of its error. Should it be mistaken, the eigenvalue that is kept, near 0,
    changes by more than itself from one truncation to the next, and does not count.

    Parameters
    ----------
    basis : Discretisation
    sector : Sector
    truncation : Truncation
    rate : float
        A rate smaller than all others, of a basis with constants.
    """

    basis: Discretisation
    sector: Sector
    truncation: Truncation
    rate: float
    eigenvalue: complex | None = None

    def among(
        self, values: Complex, vectors: Complex, shift: complex
    ) -> NDArray[np.bool_]:
        """Which of the eigenvalues nearest to a shift it is; the first shift is at 0.

        The vectors have norm one.
        """
        if not self.sector.has_constants:
            return np.zeros(values.shape, np.bool_)
        one = self.basis.constants(self.sector, self.truncation)
        if one is None:
            return np.abs(values) <= self.basis.zero * self.rate
        if self.eigenvalue is None:
            self.eigenvalue = complex(values[np.argmax(np.abs(one @ vectors))])
        return np.abs(values - self.eigenvalue) <= SAME * np.abs(values - shift)
