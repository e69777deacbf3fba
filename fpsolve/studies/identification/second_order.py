"""Parameters that numbers allow which depend on them to second order, and on chance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from fpsolve._support.arrays import Array

__all__ = ["Allowed", "Response", "allowed", "fitted", "widened"]

# Draws of parameters, and the degrees of freedom of their law, whose tails are heavy.
N_DRAWS, FREEDOM = 4000, 5
# Draws that must count; while fewer do, squared errors of the data are taken larger.
FEWEST_DRAWS, WARMING, WARMEST = 200.0, 1.5, 1e12
# Rounds in which the draws learn where to be.
N_ROUNDS = 12
# Standard deviations of the points of a fit, beyond which it says nothing.
REACH = 3.5


@dataclass(frozen=True, eq=False)
class Response:
    """Law of numbers given parameters: Gaussian, with the mean a parabola of them.

    Logarithms of the standard deviations are linear, correlations constant.

    Attributes
    ----------
    centre : ndarray, shape (n,)
        Mean of the points of the fit.
    scale : ndarray, shape (n, n)
        Cholesky factor of their covariance, the unit of parameters in what follows.
    means : ndarray, shape (1 + n + n (n + 1)/2, m)
        Coefficients of 1, p_i and p_i p_j.
    spreads : ndarray, shape (1 + n, m)
    correlation : ndarray, shape (m, m)
    """

    centre: Array
    scale: Array
    means: Array
    spreads: Array
    correlation: Array

    def mean(self, points: Array) -> Array:
        """Means of the numbers, (n_points, m)."""
        return np.asarray(_terms(self._unit(points)) @ self.means)

    def spread(self, points: Array) -> Array:
        """Standard deviations of the numbers, (n_points, m)."""
        return np.asarray(np.exp(_linear(self._unit(points)) @ self.spreads))

    def log_density(self, points: Array, data: Array) -> Array:
        """Of the data, but for a constant; -∞ beyond the points of the fit."""
        spread = self.spread(points)
        left = (data - self.mean(points)) / spread
        weighted = np.linalg.solve(self.correlation, left.T).T
        found = -0.5 * np.sum(left * weighted, axis=1) - np.log(spread).sum(axis=1)
        inside = np.sum(self._unit(points) ** 2, axis=1) < REACH**2
        return np.where(inside, found, -np.inf)

    def _unit(self, points: Array) -> Array:
        return np.asarray(np.linalg.solve(self.scale, (points - self.centre).T).T)


@dataclass(frozen=True, eq=False)
class Allowed:
    """Mean and covariance of the parameters, and whether all errors were as given."""

    mean: Array
    covariance: Array
    settled: bool


def fitted(points: Array, means: Array, covariances: Array) -> Response:
    """Least squares through means and covariances of numbers at points.

    What a parabola misses of the means is counted as chance.

    Parameters
    ----------
    points : ndarray, shape (n_points, n)
    means : ndarray, shape (n_points, m)
    covariances : ndarray, shape (n_points, m, m)
    """
    centre = points.mean(axis=0)
    scale = np.asarray(np.linalg.cholesky(np.cov(points.T)), dtype=np.float64)
    unit = np.linalg.solve(scale, (points - centre).T).T
    terms = _terms(unit)
    coefficients = _least_squares(terms, means)
    missed = means - terms @ coefficients
    total = covariances + missed.T @ missed / (len(points) - terms.shape[1])
    deviations = np.sqrt(np.einsum("ijj->ij", total))
    spreads = _least_squares(_linear(unit), np.log(deviations))
    scaled = total / (deviations[:, :, None] * deviations[:, None, :])
    correlation = np.asarray(scaled.mean(axis=0), dtype=np.float64)
    return Response(centre, scale, coefficients, spreads, correlation)


def widened(response: Response, factors: Array) -> Response:
    """With standard deviations so many times as large."""
    spreads = response.spreads.copy()
    spreads[0] += np.log(factors)
    return replace(response, spreads=spreads)


def allowed(response: Response, data: Array, seed: int) -> Allowed:
    """Mean and covariance of parameters whose density is that of the data given them.

    To first order they are the least squares and its covariance (JᵀC⁻¹J)⁻¹; where the
    numbers fold, so that two sets of parameters have the same, both are allowed. The
    moments are those of importance sampling by Student's law, which learns them in
    rounds, as synthetic likelihoods are used in [Wood10]_. The law is not even where
    numbers fold: standard deviations are made such that intervals about the mean hold
    both of the ends between which 95 % of it lie.
    """
    rng = np.random.default_rng(seed)
    mean, scale = response.centre, response.scale
    covariance = scale @ scale.T
    for _ in range(N_ROUNDS):
        normal = rng.standard_normal((N_DRAWS, len(mean)))
        normal *= np.sqrt(FREEDOM / rng.chisquare(FREEDOM, (N_DRAWS, 1)))
        draws = mean + normal @ scale.T
        square = np.sum(normal**2, axis=1)
        proposed = -0.5 * (FREEDOM + len(mean)) * np.log1p(square / FREEDOM)
        weights, warmth = _weights(response.log_density(draws, data), proposed)
        mean = weights @ draws
        covariance = (weights[:, None] * (draws - mean)).T @ (draws - mean)
        scale = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
    ratio = _farther_end(draws - mean, weights) / np.sqrt(np.diag(covariance))
    ratio = np.maximum(1.0, ratio)
    return Allowed(mean, covariance * np.outer(ratio, ratio), warmth == 1.0)


def _farther_end(draws: Array, weights: Array) -> Array:
    """Of the ends outside which 2.5 % lie each, over that of a Gaussian law."""
    found = np.empty(draws.shape[1])
    for number, values in enumerate(draws.T):
        order = np.argsort(values)
        below = np.cumsum(weights[order])
        low, high = np.interp([0.025, 0.975], below, values[order])
        found[number] = max(-low, high) / ndtri(0.975)
    return found


def _weights(density: Array, proposed: Array) -> tuple[Array, float]:
    """Weights of draws, and by what squared errors were multiplied for enough."""
    warmth = 1.0
    while True:
        logs = density / warmth - proposed
        weights = np.exp(logs - logs.max())
        weights /= weights.sum()
        if 1 / np.sum(weights**2) > FEWEST_DRAWS or not warmth < WARMEST:
            return weights, warmth
        warmth *= WARMING


def _least_squares(terms: Array, values: Array) -> Array:
    found = np.linalg.lstsq(terms, values, rcond=None)[0]
    return np.asarray(found, dtype=np.float64)


def _linear(unit: Array) -> Array:
    return np.column_stack([np.ones(len(unit)), unit])


def _terms(unit: Array) -> Array:
    """1, p_i and p_i p_j at points, (n_points, 1 + n + n (n + 1)/2)."""
    rows, columns = np.triu_indices(unit.shape[1])
    return np.column_stack([_linear(unit), unit[:, rows] * unit[:, columns]])
