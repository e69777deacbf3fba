"""Functions of ξ and α in the bases of the generator."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from scipy.sparse import csc_array

from fpsolve._support.arrays import Array, Complex
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.bases.hermite_functions import hermite_polynomials
from fpsolve.spectral.bases.radial import RadialDiscretisation
from fpsolve.spectral.bases.radial_basis import radial_basis
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation
from fpsolve.spectral.bases.tensor import TensorDiscretisation, TensorStates
from fpsolve.studies.observables import Observable

__all__ = ["Basis", "basis_for"]


# Angles in which functions are sampled, and harmonics of theirs that are used.
_ANGLES, _HARMONICS = 64, 16
# Parts of a function below this share of it are rounding.
_SILENT = 1e-12


class Basis(ABC):
    """Parts of a function in the invariant subspaces, and the generator there."""

    discretisation: Discretisation

    @abstractmethod
    def parts(
        self, f: Observable, truncation: Truncation
    ) -> Iterator[tuple[Sector, int, Array | Complex]]:
        """Sectors, how often each counts, and coefficients."""

    @abstractmethod
    def size(self, truncation: Truncation) -> int:
        """Functions in the sector of the constants."""

    @abstractmethod
    def kernel(self, sector: Sector, truncation: Truncation) -> Array | None:
        """Orthonormal columns that span the kernel of the matrix, or None."""

    def matrix(self, sector: Sector, truncation: Truncation) -> csc_array:
        """The generator on a sector."""
        return self.discretisation.matrix(sector, *truncation)


def basis_for(model: LayDownModel) -> Basis:
    """The basis of a model; ValueError for a potential without one."""
    potential, noise = model.potential, model.noise
    if potential.isotropic:
        return _RadialBasis(RadialDiscretisation(potential, noise))
    if isinstance(potential, QuadraticPotential):
        sigmas = potential.sigma1, potential.sigma2
        return _TensorBasis(TensorDiscretisation(*sigmas, noise))
    raise ValueError(
        f"`potential` must be isotropic or quadratic, got {potential!r}; average along "
        "paths instead."
    )


@dataclass(frozen=True)
class _RadialBasis(Basis):
    """Isotropic potentials: sectors M >= 0; f is real, so that −M only doubles."""

    discretisation: RadialDiscretisation

    def parts(
        self, f: Observable, truncation: Truncation
    ) -> Iterator[tuple[Sector, int, Complex]]:
        basis = radial_basis(self.discretisation.potential, truncation.degree)
        weight = np.exp(0.5 * basis.rule.log_weight)
        modes = _angular_modes(f, basis.rule.r) * weight[:, None, None]
        for M in _indices_of(modes):
            harmonics = self.discretisation.harmonics(Sector(M), truncation)
            blocks: list[Any] = [np.zeros(0)]
            for k, n in zip(*np.unique(harmonics, return_counts=True), strict=True):
                angular = M - int(k)
                seen = abs(angular) <= _HARMONICS and abs(k) <= _HARMONICS
                column = modes[:, angular, k] if seen else np.zeros(len(weight))
                functions, _ = basis.weighted(angular, truncation.degree)
                blocks.append(functions[:n] @ column)
            yield Sector(M), 2 if M else 1, np.concatenate(blocks)

    def size(self, truncation: Truncation) -> int:
        return int(self.discretisation.harmonics(Sector(0), truncation).size)

    def kernel(self, sector: Sector, truncation: Truncation) -> Array | None:
        if sector.M:
            return None
        # The constants, or what comes nearest to them in a basis that grows outwards.
        basis = radial_basis(self.discretisation.potential, truncation.degree)
        _, _, right = np.linalg.svd(basis.raising(0, 0, truncation.degree))
        k = self.discretisation.harmonics(sector, truncation)
        kernel = np.zeros((k.size, 1))
        kernel[k == 0, 0] = right[-1]
        return kernel


def _indices_of(modes: Complex) -> list[int]:
    """M = l + k >= 0 of the modes that are not rounding."""
    norms = np.linalg.norm(modes, axis=0)
    used = np.arange(-_HARMONICS, _HARMONICS + 1)
    found = {
        int(angular + k)
        for angular in used
        for k in used
        if norms[angular, k] > _SILENT * norms.max()
    }
    return sorted(M for M in found if M >= 0)


def _angular_modes(f: Observable, r: Array) -> Complex:
    """Means of f exp(−ilφ − ikα) over φ and α, indexed [r, l, k]."""
    angles = np.arange(_ANGLES) * (2 * np.pi / _ANGLES)
    xi1 = r[:, None, None] * np.cos(angles)[:, None]
    xi2 = r[:, None, None] * np.sin(angles)[:, None]
    values = _sampled(f, xi1, xi2, angles)
    return np.asarray(np.fft.fft2(values, axes=(1, 2)) / _ANGLES**2)


def _sampled(f: Observable, *coordinates: Any) -> Array:
    """f on the product of its coordinates; it may be a constant in some of them."""
    shape = np.broadcast_shapes(*map(np.shape, coordinates))
    with np.errstate(under="ignore"):
        return np.broadcast_to(np.asarray(f(*coordinates), float), shape)


@dataclass(frozen=True)
class _TensorBasis(Basis):
    """Quadratic potentials with σ1 ≠ σ2: four sectors."""

    discretisation: TensorDiscretisation

    def parts(
        self, f: Observable, truncation: Truncation
    ) -> Iterator[tuple[Sector, int, Array]]:
        cosines, sines = self.tables(f, truncation)
        for sector in self.discretisation.sectors():
            states = TensorStates(sector, truncation)
            where = states.m, states.n, states.k
            yield sector, 1, np.where(states.cosine, cosines[where], sines[where])

    def tables(self, f: Observable, truncation: Truncation) -> tuple[Array, Array]:
        """⟨f, he_m he_n √2 cos kα⟩ and with sin, indexed [m, n, k]."""
        degree, harmonics = truncation[:2]
        places, weights = hermegauss(min(2 * degree, 180))
        weights = weights / weights.sum()
        table = hermite_polynomials(degree, places) * weights
        angles = np.arange(_ANGLES) * (2 * np.pi / _ANGLES)
        xi1 = self.discretisation.sigma1 * places[:, None, None]
        xi2 = self.discretisation.sigma2 * places[:, None]
        values = _sampled(f, xi1, xi2, angles)
        modes = np.zeros((degree + 1, degree + 1, harmonics + 1), complex)
        seen = min(harmonics, _HARMONICS) + 1
        waves = np.fft.rfft(values, axis=2)[:, :, :seen] / _ANGLES
        modes[:, :, :seen] = np.einsum("mi,ijk,nj->mnk", table, waves, table,
                                       optimize=True)  # fmt: skip
        scale = np.where(np.arange(harmonics + 1) == 0, 1.0, np.sqrt(2.0))
        return scale * modes.real, -scale * modes.imag

    def size(self, truncation: Truncation) -> int:
        # Factors of these three-dimensional matrices fill up more.
        return 2 * len(TensorStates(next(self.discretisation.sectors()), truncation).k)

    def kernel(self, sector: Sector, truncation: Truncation) -> Array | None:
        if not sector.has_constants:
            return None
        one = np.zeros((len(TensorStates(sector, truncation).k), 1))
        one[0] = 1.0
        return one
