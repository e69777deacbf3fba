"""Coefficients of an initial density in the basis of the forward equation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import ive

from fpsolve._support.arrays import Array, Complex
from fpsolve.grids.initial import checked_covariance
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.bases.hermite_functions import hermite_functions, root_of_normal
from fpsolve.spectral.evolution.expansion import Expansion

__all__ = ["DensityStart", "GaussianStart"]

# Largest share of the norm that a density on a grid may have in the last tenth of
# what its grid resolves, relative to the tolerance.
FINEST = 0.1


class GaussianStart:
    """Coefficients, entropy and moments of a Gaussian times von Mises, closed form.

    With a = m/σ and R = C/(σσᵀ) − 1 the coefficients have the generating function
    exp(a·t + tᵀRt/2), hence √(i+1) c_{i+1,j} = a₁ c_ij + R₁₁ √i c_{i−1,j} +
    R₁₂ √j c_{i,j−1}; harmonic k is I_k(κ)/I_0(κ) e^{−ikα₀}.

    Parameters
    ----------
    law : object
        With `mean`, `variance`, `angle` and `concentration`.
    potential : QuadraticPotential

    Raises
    ------
    ValueError
        If p0/p_S is not in L²(μ): a variance, in units of σ², is not below 2.
    """

    def __init__(self, law: Any, potential: QuadraticPotential) -> None:
        sigma = np.array([potential.sigma1, potential.sigma2])
        self.mean = np.asarray(law.mean, float) / sigma
        self.covariance = checked_covariance(law.variance) / np.outer(sigma, sigma)
        self.concentration = float(law.concentration)
        self.angle = float(law.angle or 0.0)
        largest = float(np.linalg.eigvalsh(self.covariance)[-1])
        if not largest < 2:
            raise ValueError(
                "`variance` must be below 2 σ² in every direction, which p0/p_S needs "
                f"to have a finite norm, got {largest:g} σ²; start from a narrower "
                "density."
            )

    def expansion(self, degree: int, harmonics: int) -> Expansion:
        """Coefficients of degree at most `degree`, harmonics at most `harmonics`."""
        result = Expansion.empty(np.full(degree + 1, harmonics))
        plane, angular = self._plane(degree), self._angular(harmonics)
        # c = i^j d.
        phased = plane * (-1j) ** np.arange(degree + 1)
        values = phased[:, :, None] * angular
        result.values[:-1, :-1, :-2] = values.view(np.float64)
        result.clear_outside()
        return result

    @property
    def relative_entropy(self) -> float:
        """H(p0|p_S) = (tr S + |a|² − 2 − ln det S)/2 + κ I₁/I₀ − ln I₀, exactly."""
        spread = np.trace(self.covariance) + self.mean @ self.mean - 2
        plane = 0.5 * (spread - math.log(np.linalg.det(self.covariance)))
        kappa = self.concentration
        scaled = float(ive(0, kappa))
        angular = kappa * float(ive(1, kappa)) / scaled - math.log(scaled) - kappa
        return float(plane) + angular

    def _plane(self, degree: int) -> Array:
        """c[i, j] = ∫ p0 He_i He_j, zero where i + j is above the degree."""
        drift, mixed = self.mean, self.covariance - np.eye(2)
        root = np.sqrt(np.arange(degree + 2.0))
        c = np.zeros((degree + 1, degree + 1))
        c[0, 0] = 1.0
        for j in range(degree):
            less = mixed[1, 1] * root[j] * c[0, j - 1] if j else 0.0
            c[0, j + 1] = (drift[1] * c[0, j] + less) / root[j + 1]
        for i in range(degree):
            row = drift[0] * c[i]
            row[1:] += mixed[0, 1] * root[1 : degree + 1] * c[i, :-1]
            if i:
                row += mixed[0, 0] * root[i] * c[i - 1]
            c[i + 1] = row / root[i + 1]
        return c

    def _angular(self, harmonics: int) -> Complex:
        k = np.arange(harmonics + 1)
        share = ive(k, self.concentration) / ive(0, self.concentration)
        return np.asarray(share * np.exp(-1j * k * self.angle))


class DensityStart:
    """Coefficients ∫ p0 He_i He_j e^{−ikα} of a density on a grid, by midpoint rule.

    Spectrally accurate as long as the density has decayed at the edges of the box and
    is resolved; both show in coefficients that have decayed at the last degree and
    harmonic the grid resolves, which is checked.

    Parameters
    ----------
    grid : PhaseSpaceGrid
    p : array_like, shape ``grid.shape``
        Normalised here.
    potential : QuadraticPotential
    tolerance : float

    Raises
    ------
    ValueError
        If p is negative, not finite, without mass, or not resolved by its grid.
    """

    relative_entropy = None

    def __init__(
        self,
        grid: PhaseSpaceGrid,
        p: Any,
        potential: QuadraticPotential,
        tolerance: float,
    ) -> None:
        self.grid, self.potential = grid, potential
        self.p = checked_density(grid, p)
        sigma = potential.sigma1, potential.sigma2
        # A degree n has wavelengths down to 2π/√n at the origin, where p He_n with
        # p as fine again must still be resolved.
        finest = min(
            math.pi * scale / step
            for scale, step in zip(sigma, grid.spacing, strict=False)
        )
        self.resolved = int(finest**2) // 2, grid.shape[2] // 2 - 1
        self._held: Expansion | None = None
        self._check_decay(tolerance)

    def expansion(self, degree: int, harmonics: int) -> Expansion:
        """Coefficients of degree at most `degree`, harmonics at most `harmonics`."""
        degree = min(degree, self.resolved[0])
        harmonics = min(harmonics, self.resolved[1])
        limits = np.full(degree + 1, harmonics)
        if self._held is None or self._held.degree < degree:
            self._held = self._project(degree, self.resolved[1])
        return self._held.within(limits)

    def _project(self, degree: int, harmonics: int) -> Expansion:
        result = Expansion.empty(np.full(degree + 1, harmonics))
        matrix1 = weighted_hermite(self.grid.xi1 / self.potential.sigma1, degree)
        matrix2 = weighted_hermite(self.grid.xi2 / self.potential.sigma2, degree)
        phase = (-1j) ** np.arange(degree + 1)
        waves = np.fft.rfft(self.p, axis=2)[:, :, : harmonics + 1]
        k = np.arange(harmonics + 1)
        waves *= np.exp(-1j * k * self.grid.alpha[0]) * self.grid.cell_volume
        half = np.tensordot(matrix1, waves, (1, 0))
        values = np.einsum("jb,ibk->ijk", matrix2 * phase[:, None], half, optimize=True)
        result.values[:-1, :-1, :-2] = np.ascontiguousarray(values).view(np.float64)
        result.clear_outside()
        return result

    def _check_decay(self, tolerance: float) -> None:
        energies = self.expansion(*self.resolved).energies()
        degree, harmonics = energies.shape
        edge = (
            energies[int(0.9 * degree) :].sum()
            + energies[: int(0.9 * degree), int(0.9 * harmonics) :].sum()
        )
        share = math.sqrt(float(edge))
        if not share <= FINEST * tolerance:
            raise ValueError(
                "`p0` must be resolved by its grid, got coefficients of norm "
                f"{share:.2g} at the last degrees it resolves (at most "
                f"{FINEST * tolerance:.2g} for this `tolerance`); enlarge `half_width` "
                "if the box cuts the density off, otherwise refine `shape`."
            )


def checked_density(grid: PhaseSpaceGrid, p: Any) -> Array:
    """Return p normalised to mass one; ValueError unless it is a density."""
    p = grid.check(p, "p0")
    mass = float(p.sum()) * grid.cell_volume
    if not (math.isfinite(mass) and mass > 0):
        raise ValueError(f"`p0` must be finite and have mass, got mass {mass:g}.")
    lowest = float(p.min())
    if not lowest >= -1e-8 * float(p.max()):
        raise ValueError(f"`p0` must not be negative, got a minimum of {lowest:g}.")
    normalised: Array = p / mass
    return normalised


def weighted_hermite(x: Array, degree: int) -> Array:
    """He_n(x), normalised, by way of the bounded Hermite functions."""
    return hermite_functions(degree, x) / root_of_normal(x)
