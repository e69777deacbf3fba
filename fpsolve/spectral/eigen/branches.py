"""One branch of eigenvalues as a function of the noise, in a fixed truncation."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Complex
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse
from fpsolve.spectral.eigen.family import Family
from fpsolve.spectral.eigen.following import left_vector
from fpsolve.spectral.eigen.survey import Mode

__all__ = ["Branch", "PairBranch"]

# Share of the rate by which a shift stays clear of the eigenvalue.
CLEAR = 1e-3


class Branch:
    """λ(A) followed from a known value, by nearness.

    Parameters
    ----------
    family : Family
    sector : Sector
    level : int
        Of the truncation; the one for `noise` serves for all A.
    noise, eigenvalue : float, complex
        Where the branch is known.
    """

    def __init__(
        self,
        family: Family,
        sector: Sector,
        level: int,
        noise: float,
        eigenvalue: complex,
    ) -> None:
        self.family, self.sector = family, sector
        self.truncation: Truncation = self.family.basis(noise).truncation(level)
        self.known = {noise: eigenvalue}

    def eigenvalue(self, noise: float) -> complex:
        """λ(A), followed from the nearest noise at which it is known."""
        nearest = min(self.known, key=lambda other: abs(other - noise))
        value = self.known[nearest]
        values, _ = self._near(noise, value + CLEAR * abs(value.real), 3)
        self.known[noise] = complex(values[np.argmin(np.abs(values - value))])
        return self.known[noise]

    def rate(self, noise: float) -> float:
        """-Re λ(A)."""
        return -self.eigenvalue(noise).real

    def slope(self, noise: float) -> float:
        """d(-Re λ)/dA = -Re ⟨l, ∂L/∂A r⟩/⟨l, r⟩, l and r eigenvectors of Lᵀ and L."""
        value = self.eigenvalue(noise)
        values, vectors = self._near(noise, value + CLEAR * abs(value.real), 3)
        right = vectors[:, np.argmin(np.abs(values - value))]
        basis = self.family.basis(noise)
        mode = Mode(value, right, self.sector, self.truncation)
        left = left_vector(basis, mode)
        change = basis.noise_derivative(self.sector, self.truncation) @ right
        return -float(((left @ change) / (left @ right)).real)

    def _near(self, noise: float, shift: complex, n: int) -> tuple[Complex, Complex]:
        basis = self.family.basis(noise)
        matrix = basis.matrix(self.sector, *self.truncation)
        return ShiftedInverse(matrix, shift, None, basis.ordering).eigenpairs(n)


class PairBranch(Branch):
    """Two eigenvalues m ± √δ that merge; m and δ are analytic in A where √δ is not."""

    def halves(self, noise: float) -> tuple[float, float]:
        """Mean m and discriminant δ = ((λ₁ - λ₂)/2)², both real."""
        nearest = min(self.known, key=lambda other: abs(other - noise))
        centre = self.known[nearest].real
        (first, second), _ = self._near(noise, centre * (1 - CLEAR), 2)
        mean, delta = (first + second) / 2, ((first - second) / 2) ** 2
        self.known[noise] = complex(mean.real)
        return float(mean.real), float(delta.real)

    def discriminant(self, noise: float) -> float:
        """δ(A): negative for a complex pair, 0 where it merges."""
        return self.halves(noise)[1]

    def rate(self, noise: float) -> float:
        """-m(A)."""
        return -self.halves(noise)[0]
