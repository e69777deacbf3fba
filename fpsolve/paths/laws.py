"""Laws of the point (ξ, α) at which a path starts."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_finite,
    check_kind,
    check_non_negative,
    check_pair,
)
from fpsolve.grids.initial import checked_covariance
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.gibbs import GibbsSampler
from fpsolve.paths.interpolated import InterpolatedDensity

__all__ = ["DensityLaw", "EquilibriumLaw", "GaussianLaw", "Law", "PointLaw"]

Sample = tuple[Array, Array]
TURN = 2.0 * np.pi


class Law(Protocol):
    """What `sample_paths` needs of a law of the start."""

    def sample(self, rng: np.random.Generator, n: int) -> Sample:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""


@dataclass(frozen=True)
class PointLaw:
    """δ(ξ - ξ0), with the angle α0 or uniform in it.

    Parameters
    ----------
    xi : (float, float)
        The point ξ0; the origin is the point below the nozzle.
    alpha : float, optional
        The angle α0 in radians; uniform on [0, 2π) when left out.

    Raises
    ------
    ValueError
        If a number is not finite, or ξ0 not two numbers.
    """

    _recorded: ClassVar[str] = "law"

    xi: tuple[float, float] = (0.0, 0.0)
    alpha: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "xi", check_pair("xi", self.xi))
        if self.alpha is not None:
            object.__setattr__(self, "alpha", check_finite("alpha", self.alpha))

    def sample(self, rng: np.random.Generator, n: int) -> Sample:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        if self.alpha is None:
            return np.tile(self.xi, (n, 1)), rng.uniform(0.0, TURN, n)
        return np.tile(self.xi, (n, 1)), np.full(n, self.alpha)

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the parameters as a JSON-able dictionary."""
        return {"kind": "point", "xi": list(self.xi), "alpha": self.alpha}


@dataclass(frozen=True)
class GaussianLaw:
    """exp(-(ξ - m)ᵀ C⁻¹ (ξ - m)/2) exp(κ cos(α - α0)): Gaussian times von Mises.

    The law that `fpsolve.initial.gaussian` puts on a grid.

    Parameters
    ----------
    mean : (float, float)
        Mean m.
    variance : float, (float, float) or 2x2 matrix
        One variance for both components, one for each, or the covariance matrix C.
    angle : float, optional
        Mean direction α0 in radians; needed when `concentration` is positive.
    concentration : float
        Concentration κ >= 0; 0 makes the angle uniform.

    Raises
    ------
    ValueError
        If the variance is not positive definite, the concentration negative, or
        positive without an angle.
    """

    _recorded: ClassVar[str] = "law"

    mean: tuple[float, float] = (0.0, 0.0)
    variance: Any = 1.0
    angle: float | None = None
    concentration: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", check_pair("mean", self.mean))
        covariance = checked_covariance(self.variance)
        as_tuples = tuple(tuple(row) for row in covariance.tolist())
        object.__setattr__(self, "variance", as_tuples)
        concentration = check_non_negative("concentration", self.concentration)
        object.__setattr__(self, "concentration", concentration)
        if self.angle is not None:
            object.__setattr__(self, "angle", check_finite("angle", self.angle))
        elif concentration > 0:
            raise ValueError(
                "`angle` must be given when `concentration` is positive, got None "
                f"with concentration {concentration:g}."
            )

    def sample(self, rng: np.random.Generator, n: int) -> Sample:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        (root11, _), (root21, root22) = np.linalg.cholesky(np.array(self.variance))
        normal1, normal2 = rng.standard_normal((n, 2)).T
        xi1 = self.mean[0] + root11 * normal1
        xi2 = self.mean[1] + root21 * normal1 + root22 * normal2
        xi = np.stack([xi1, xi2], axis=1)
        alpha = rng.vonmises(self.angle or 0.0, self.concentration, n)
        return xi, alpha % TURN

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the parameters as a JSON-able dictionary."""
        return {
            "kind": "gaussian",
            "mean": list(self.mean),
            "variance": [list(row) for row in self.variance],
            "angle": self.angle,
            "concentration": self.concentration,
        }


@dataclass(frozen=True)
class EquilibriumLaw:
    """μ: exp(-B(ξ)) normalised, uniform in α; equation (10).

    Exact for quadratic, linear and power potentials. Others are sampled by rejection,
    inside a box beyond whose edges e^{-B} is below 1e-14 of its maximum.

    Parameters
    ----------
    potential : Potential
        Normalisable.

    Raises
    ------
    ValueError
        If exp(-B) has no finite integral.

    References
    ----------
    [KMW09]_, section 3.1.1.
    """

    _recorded: ClassVar[str] = "law"

    potential: Potential
    _sampler: GibbsSampler = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_kind("potential", self.potential, Potential)
        object.__setattr__(self, "_sampler", GibbsSampler(self.potential))

    def sample(self, rng: np.random.Generator, n: int) -> Sample:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        return self._sampler(rng, n), rng.uniform(0.0, TURN, n)

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the potential as a JSON-able dictionary."""
        return {"kind": "equilibrium", "potential": potential_to_dict(self.potential)}


@dataclass(frozen=True, eq=False)
class DensityLaw:
    """A density known at the cells of a grid, between them by interpolation.

    Points are drawn from the quintic spline through the cell centres, which is
    periodic like the grid, by rejection from bounds that are proved; where it is
    negative it counts as zero. Its difference from a smooth density behind the values
    is of order six in the spacing. Beside a jump the spline rings; what is cut off
    below zero may be a hundredth of the mass.

    Parameters
    ----------
    grid : PhaseSpaceGrid
    p : array_like, shape ``grid.shape``
        The density; it need not be normalised.

    Raises
    ------
    ValueError
        If p is not finite, has no mass, or more than a hundredth of it or of the
        spline through it is negative; GridMismatchError if it has another shape.
    """

    _recorded: ClassVar[str] = "density_law"

    grid: PhaseSpaceGrid
    p: ArrayLike = field(repr=False)
    _sampler: InterpolatedDensity = field(init=False, repr=False)

    def __post_init__(self) -> None:
        check_grid(self.grid)
        p = self.grid.check(self.p, "p")
        object.__setattr__(self, "p", p)
        object.__setattr__(self, "_sampler", InterpolatedDensity(self.grid, p))

    def sample(self, rng: np.random.Generator, n: int) -> Sample:
        """Draw n points: ξ of shape (n, 2) and α of shape (n,)."""
        return self._sampler(rng, n)

    def density(self, grid: PhaseSpaceGrid) -> Array:
        """The density that is sampled, not normalised, at the centres of any grid."""
        check_grid(grid)
        return self._sampler.at_centres(grid)

    def cell_shares(self) -> Array:
        """Probabilities with which points are drawn in the cells of the own grid."""
        return self._sampler.cell_shares()

    def to_dict(self) -> dict[str, Any]:
        """Return a description; the density itself is not in it."""
        return {"kind": "density", "grid": self.grid.to_dict()}

    def _recorded_parts(self) -> dict[str, Any]:
        return {"grid": self.grid, "p": self.p}
