"""Remark 3.7: for a quadratic potential the limit is an Ornstein-Uhlenbeck process."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers, check_numbers
from fpsolve._support.checks import check_integer, check_non_negative, check_pair
from fpsolve.grids.initial import checked_covariance
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.reduced.hydrodynamic.effective_potential import check_limit

__all__ = ["OrnsteinUhlenbeckLimit"]


@dataclass(frozen=True, eq=False)
class OrnsteinUhlenbeckLimit:
    """dξ_i = (−ξ_i/(A²σ_i²) + v δ_i1) ds + (√(2F)/A) dW_i from a Gaussian: exact.

    The hydrodynamic limit for B = (ξ1²/σ1² + ξ2²/σ2²)/2. It stays Gaussian; the
    component i relaxes at the rate k_i = 1/(A²σ_i²) to the mean (A²v σ1², 0) and the
    variance Fσ_i². F = ₁F₁(1; a+1; a) for a smooth fibre with a = A²R/2, 1 for the
    basic one: a curvature spreads the fibre, and changes neither rates nor means.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        With a QuadraticPotential, positive noise, and a belt of constant speed.
    mean : (float, float)
        Mean at s = 0.
    variance : float, (float, float) or array_like of shape (2, 2)
        Variance of both components, of each, or their covariance matrix, at s = 0.

    Raises
    ------
    ValueError
        If the model has no such limit or the variance is not positive definite.

    References
    ----------
    [KMW09]_, remark 3.7 (for σ1 = σ2 = 1, basic model).
    """

    model: FibreModel
    mean_at_start: Array
    covariance_at_start: Array
    _temperature: float = field(repr=False)

    def __init__(
        self,
        model: FibreModel,
        mean: tuple[float, float] = (0.0, 0.0),
        variance: ArrayLike = 1.0,
    ) -> None:
        phi = check_limit(model)
        if not isinstance(model.potential, QuadraticPotential):
            raise ValueError(
                "`potential` must be quadratic for an Ornstein-Uhlenbeck limit, got "
                f"{model.potential!r}; use HydrodynamicLimit for others."
            )
        start = np.array(check_pair("mean", mean))
        object.__setattr__(self, "model", model)
        object.__setattr__(self, "_temperature", phi.temperature)
        object.__setattr__(self, "mean_at_start", start)
        object.__setattr__(self, "covariance_at_start", checked_covariance(variance))

    @property
    def rates(self) -> Array:
        """(k1, k2) = (1/(A²σ1²), 1/(A²σ2²)), shape (2,)."""
        return 1.0 / (self.model.noise**2 * self._squares)

    @property
    def stationary_mean(self) -> Array:
        """(A²v σ1², 0), shape (2,)."""
        pull = self.model.noise**2 * self.model.belt_speed
        return np.array([pull * self._squares[0], 0.0])

    @property
    def stationary_variance(self) -> Array:
        """(Fσ1², Fσ2²), shape (2,); the components are independent."""
        return self._temperature * self._squares

    @property
    def _squares(self) -> Array:
        """(σ1², σ2²), shape (2,)."""
        potential: Any = self.model.potential
        return np.array([potential.sigma1**2, potential.sigma2**2])

    def mean(self, s: ArrayLike) -> Array:
        """E ξ at s >= 0; shape (..., 2) for s of shape (...)."""
        away = self.mean_at_start - self.stationary_mean
        return np.asarray(self.stationary_mean + self._decay(s) * away)

    def covariance(self, s: ArrayLike) -> Array:
        """Covariance matrix of ξ at s >= 0; shape (..., 2, 2)."""
        decay = self._decay(s)
        kept = decay[..., :, None] * decay[..., None, :] * self.covariance_at_start
        gained = self._gained(s)[..., None] * np.eye(2)
        return np.asarray(kept + gained)

    def density(self, xi1: ArrayLike, xi2: ArrayLike, s: float = 0.0) -> Array:
        """𝒫(ξ1, ξ2, s), in the broadcast shape of xi1 and xi2."""
        s = check_non_negative("s", s)
        mean, covariance = self.mean(s), self.covariance(s)
        (a, b), (_, c) = np.linalg.inv(covariance)
        away1 = np.subtract(check_numbers("xi1", xi1), mean[0])
        away2 = np.subtract(check_numbers("xi2", xi2), mean[1])
        # As squares: far away they overflow, and the density is zero.
        with np.errstate(over="ignore"):
            exponent = 0.5 * (a * (away1 + b / a * away2) ** 2)
            exponent = exponent + 0.5 * (c - b * b / a) * away2**2
        scale = 2 * math.pi * math.sqrt(np.linalg.det(covariance))
        return np.asarray(np.exp(-exponent) / scale)

    def relative_entropy(self, s: ArrayLike) -> Array:
        """H(𝒫|𝒫_S) = ½ Σ (λ − 1 − ln λ) + ½ Σ (E ξ_i − m_i)²/Fσ_i²; shape of s.

        λ are the eigenvalues of the covariance relative to the stationary one.
        """
        scale = np.sqrt(self.stationary_variance)
        relative = self.covariance(s) / (scale[:, None] * scale[None, :])
        excess = np.linalg.eigvalsh(relative - np.eye(2))
        away = (self.mean(s) - self.stationary_mean) / scale
        spread = np.sum(excess - np.log1p(excess), axis=-1)
        return np.asarray(0.5 * (spread + np.sum(away**2, axis=-1)))

    def eigenvalues(self, n: int) -> Array:
        """The n slowest decay rates k i + l j, i, j = 0, 1, …, ascending from 0."""
        n = check_integer("n", n, at_least=1)
        degrees = np.arange(n)
        every = self.rates[0] * degrees[:, None] + self.rates[1] * degrees[None, :]
        return np.asarray(np.sort(every.ravel())[:n])

    def transition(self, xi: Array, s: float, rng: np.random.Generator) -> Array:
        """ξ at s given ξ at 0, drawn from the exact law.

        Parameters
        ----------
        xi : ndarray, shape (n_paths, 2)
        s : float
            Arclength in between, s >= 0.
        rng : numpy.random.Generator
        """
        moved = self.stationary_mean + self._decay(s) * (xi - self.stationary_mean)
        kick = np.sqrt(self._gained(s)) * rng.standard_normal(np.shape(xi))
        return np.asarray(moved + kick)

    def _decay(self, s: ArrayLike) -> Array:
        """e^{−k_i s}; shape (..., 2)."""
        return np.asarray(np.exp(-np.multiply.outer(_arclengths(s), self.rates)))

    def _gained(self, s: ArrayLike) -> Array:
        """Fσ_i² (1 − e^{−2 k_i s}); shape (..., 2)."""
        lost = -np.expm1(-2.0 * np.multiply.outer(_arclengths(s), self.rates))
        return np.asarray(self.stationary_variance * lost)


def _arclengths(s: ArrayLike) -> Array:
    """s as an array of numbers s >= 0."""
    values = check_finite_numbers("s", s)
    if not (values >= 0.0).all():
        raise ValueError(f"`s` must be non-negative and finite, got {values.min():g}.")
    return values
