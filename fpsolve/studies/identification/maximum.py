"""Where a likelihood is largest, by quasi-Newton and Newton steps; its curvature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError

__all__ = ["Maximum", "maximum", "observed_information"]

# Differences are taken over this share of a standard error: what third derivatives add
# is below a per cent of the second then, and rounding does not show.
_SHARE = 0.1
# Newton steps at most, and how many standard errors from the end they may stop.
_N_STEPS, _CLOSE = 12, 0.05
# Curvature per square of the standard error for known other coordinates that counts as
# none: coordinates that go together may have errors of a hundred times that.
_FLAT = 1e-5

Function = Callable[[Array], float]


@dataclass(frozen=True, eq=False)
class Maximum:
    """A maximum of the logarithm of a likelihood.

    Attributes
    ----------
    at : ndarray, shape (n,)
    value : float
    information : ndarray, shape (n, n)
        Minus the second derivatives.
    scale : ndarray, shape (n,)
        About the standard errors.
    history : ndarray, shape (n_iterations, n)
    distance : float
        Length of the Newton step from there, in standard errors.
    """

    at: Array
    value: float
    information: Array
    scale: Array
    history: Array
    distance: float

    def covariance(self, may_fail: int | None = None) -> Array:
        """The inverse of the information.

        Parameters
        ----------
        may_fail : int, optional
            A coordinate that the likelihood may leave open: its variance is infinite
            then, and the others are those for its value.

        Raises
        ------
        ToleranceError
            If the search did not arrive, or the likelihood is no hill there.
        """
        remedy = "take a longer fibre, or points at other distances"
        if not self.distance <= _CLOSE:
            raise ToleranceError(self.distance, _CLOSE, remedy)
        if self._is_hill(np.arange(len(self.at))):
            return np.asarray(np.linalg.inv(self.information))
        kept = np.delete(np.arange(len(self.at)), [] if may_fail is None else may_fail)
        if may_fail is None or not self._is_hill(kept):
            raise ToleranceError(np.inf, _CLOSE, remedy)
        found = np.zeros_like(self.information)
        block = np.ix_(kept, kept)
        found[block] = np.linalg.inv(self.information[block])
        found[may_fail, may_fail] = np.inf
        return found

    def _is_hill(self, kept: NDArray[np.int64]) -> bool:
        scaled = self.information * np.outer(self.scale, self.scale)
        values = np.linalg.eigvalsh(scaled[np.ix_(kept, kept)])
        return bool(values.min() > _FLAT)


def maximum(f: Function, start: Array, scale: Array) -> Maximum:
    """The maximum of f near `start`.

    Parameters
    ----------
    f : callable
    start : ndarray, shape (n,)
    scale : ndarray, shape (n,)
        About the standard errors, to a factor of ten.
    """
    history, height = [start], f(start)
    found = minimize(
        lambda z: height - f(start + scale * z),
        np.zeros(len(start)),
        method="BFGS",
        jac=lambda z: -scale * _gradient(f, start + scale * z, _SHARE * scale),
        callback=lambda z: history.append(start + scale * z),
        options={"gtol": 0.05, "maxiter": 100},
    )
    at = start + scale * found.x
    for _ in range(_N_STEPS):
        information = observed_information(f, at, _SHARE * scale)
        step, distance = _newton(_gradient(f, at, _SHARE * scale), information, scale)
        share = _rising(f, at, step)
        if not distance > 0.1 * _CLOSE or not share:
            break
        at = at + share * step
        history.append(at)
        scale = _refined(scale, information)
    return Maximum(at, f(at), information, scale, np.array(history), distance)


def observed_information(f: Function, at: Array, steps: Array) -> Array:
    """-∂²f/∂xᵢ∂xⱼ by central differences over the given steps."""
    n, moves = len(at), np.diag(steps)
    found = np.empty((n, n))
    for i in range(n):
        for j in range(i + 1):
            corners = (
                f(at + moves[i] + moves[j]) - f(at + moves[i] - moves[j])
                - f(at - moves[i] + moves[j]) + f(at - moves[i] - moves[j])
            )  # fmt: skip
            found[i, j] = found[j, i] = -corners / (4 * steps[i] * steps[j])
    return found


def _gradient(f: Function, at: Array, steps: Array) -> Array:
    moves = np.diag(steps)
    differences = [f(at + move) - f(at - move) for move in moves]
    return np.array(differences) / (2 * steps)


def _newton(gradient: Array, information: Array, scale: Array) -> tuple[Array, float]:
    """The Newton step and its length in standard errors; uphill where f is no hill."""
    scaled = information * np.outer(scale, scale)
    if not (np.isfinite(scaled).all() and np.isfinite(gradient).all()):
        return np.zeros_like(scale), np.inf
    values, vectors = np.linalg.eigh(scaled)
    values = np.maximum(np.abs(values), _FLAT)
    slope = vectors.T @ (gradient * scale)
    step = np.clip(slope / values, -3.0, 3.0)
    return scale * (vectors @ step), float(np.sqrt(slope**2 @ (1 / values)))


def _rising(f: Function, at: Array, step: Array) -> float:
    """The share of a step that leads up; 0 if none does."""
    here = f(at)
    shares = (0.25**k for k in range(4))
    return next((share for share in shares if f(at + share * step) >= here), 0.0)


def _refined(scale: Array, information: Array) -> Array:
    """What the curvature says of the standard errors, changed by no more than five."""
    diagonal = np.diagonal(information)
    found = np.where(diagonal > 0, diagonal, 1 / scale**2) ** -0.5
    return np.asarray(np.clip(found, 0.2 * scale, 5.0 * scale))
