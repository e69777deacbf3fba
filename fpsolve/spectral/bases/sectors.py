"""Invariant subspaces of the generator, and what a Galerkin basis in them offers.

A discretisation is an orthonormal basis of L²(μ), μ = exp(-B) dξ dα / (2π Z), of
functions of ξ times harmonics of α (for smooth fibres two dual ones, see
`BodyFrameDiscretisation`). The generator of (9),

    L f = (τ + v e₁)·∇f - ∇B·τ⊥ ∂_α f + (A²/2) ∂_αα f,

leaves subspaces invariant that symmetries define; in each of them it is one real
matrix, and the matrix of the adjoint L* is its transpose.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array

from fpsolve._support.arrays import Complex

__all__ = ["Discretisation", "Sector", "Truncation"]

# Coefficients, real or complex.
Vector = NDArray[Any]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Sector:
    """An invariant subspace of the generator.

    Parameters
    ----------
    M : int or None
        Conserved total angular index of an isotropic potential on a fixed belt: the
        function is a sum of g_k(r) exp(i l φ + i k α) with l + k = M. The reflection
        (ξ2, α) → -(ξ2, α) turns M into -M, so that M > 0 stands for both, with the
        same eigenvalues. None where the index is not conserved.
    parity : int or None
        +1 or -1 under the reflection (ξ2, α) → -(ξ2, α); None for M other than 0.
    parity_along : int or None
        +1 or -1 under (ξ1, α) → (-ξ1, π - α), a symmetry of quadratic potentials with
        σ1 ≠ σ2 on a fixed belt; None elsewhere.
    """

    _recorded: ClassVar[str] = "sector"

    M: int | None = None
    parity: int | None = None
    parity_along: int | None = None

    def to_dict(self) -> dict[str, int | None]:
        """M and the parities."""
        return asdict(self)

    @property
    def multiplicity(self) -> int:
        """How many sectors share these eigenvalues: 2 for ±M, else 1."""
        return 2 if self.M else 1

    @property
    def has_constants(self) -> bool:
        """Whether the constants, eigenvalue 0, belong to it."""
        return not self.M and self.parity != -1 and self.parity_along != -1

    def __str__(self) -> str:
        if self.M:
            return f"M = ±{self.M}"
        names = {1: "even", -1: "odd"}
        if self.M == 0:
            return f"M = 0 {names.get(self.parity or 0, '')}".strip()
        across, along = names[self.parity or 1], names.get(self.parity_along or 0)
        return across if along is None else f"{along} along, {across} across"


class Truncation(NamedTuple):
    """Size of a basis: `degree` in ξ, |k| <= harmonics in α and a degree in κ.

    In the frame of the fibre the harmonics of α are those of ξ, no more than `degree`.
    """

    degree: int
    harmonics: int
    curvature: int = 0


class Discretisation(ABC):
    """A family of nested orthonormal bases of L²(μ), sorted into sectors."""

    noise: float
    belt_speed: float = 0.0
    # Of the columns before they are eliminated; None for one that the matrix decides.
    ordering: ClassVar[str | None] = None
    # Up to here an eigenvalue is the 0 of the constants, in units of a slow rate,
    # unless their coefficients tell it.
    zero: ClassVar[float] = 1e-6
    # Whether truncations grow in several directions that do not converge in step.
    irregular: ClassVar[bool] = False

    @property
    def reversible(self) -> bool:
        """Whether turning α by π takes L to L*: of basic fibres on a fixed belt."""
        return not self.belt_speed

    @abstractmethod
    def sectors(self) -> Iterator[Sector]:
        """All sectors, those that hold the slowest modes first: by |M|.

        Endless for an isotropic potential; the caller stops.
        """

    @abstractmethod
    def truncation(self, level: int) -> Truncation:
        """The basis of a level, 0, 1, 2, ...: a sequence for refinement."""

    @abstractmethod
    def enlarged(self, truncation: Truncation) -> Truncation:
        """The basis in which L f lies (nearly, for a general B) for f of this one."""

    def constants(self, sector: Sector, truncation: Truncation) -> Vector | None:
        """Coefficients of 1, where the functions only approximate it; else None."""
        return None

    @abstractmethod
    def harmonics(self, sector: Sector, truncation: Truncation) -> Integers:
        """The harmonic k of every basis function."""

    @abstractmethod
    def matrix(self, sector: Sector, *sizes: int) -> Any:
        """The real matrix of L (columns: images) of a truncation, as a CSC array."""

    @abstractmethod
    def embed(
        self, vector: Vector, sector: Sector, small: Truncation, large: Truncation
    ) -> Vector:
        """Coefficients in the larger basis."""

    @abstractmethod
    def values(
        self,
        vector: Vector,
        sector: Sector,
        truncation: Truncation,
        grid: Any,
    ) -> Complex:
        """f on a grid of the phase space, shape `grid.shape`, from its coefficients."""

    def noise_derivative(self, sector: Sector, truncation: Truncation) -> Any:
        """dL/dA on fixed functions, as a sparse matrix: -A k² on the diagonal."""
        k = self.harmonics(sector, truncation).astype(float)
        return diags_array(-self.noise * k**2)

    def size(self, sector: Sector, truncation: Truncation) -> int:
        """Number of basis functions."""
        return len(self.harmonics(sector, truncation))

    def factor_entries(self, truncation: Truncation) -> int | None:
        """Entries of the factors of a matrix; None where its size tells them."""
        return None

    def on_edge(self, vector: Vector, sector: Sector, truncation: Truncation) -> bool:
        """Whether an eigenvector belongs to the truncation and not to L."""
        return False

    def residual(
        self,
        vector: Vector,
        eigenvalue: complex,
        sector: Sector,
        truncation: Truncation,
    ) -> float:
        """‖L f - λ f‖/‖f‖ in L²(μ), computed in the enlarged basis."""
        large = self.enlarged(truncation)
        vector = self.embed(vector, sector, truncation, large)
        defect = self.matrix(sector, *large) @ vector - eigenvalue * vector
        return float(np.linalg.norm(defect) / np.linalg.norm(vector))
