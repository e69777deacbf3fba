"""Whether a point is an optimum, what its bounds cost, and how well it is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.optimize import nnls

from fpsolve._support.arrays import Array
from fpsolve.studies.design.goals import Goal
from fpsolve.studies.design.predictions import At, Predictions
from fpsolve.studies.design.space import Space

__all__ = ["Optimality", "optimality"]

Mask = NDArray[np.bool_]
# Logarithms nearer than this to a bound are at it.
AT_BOUND, AT_TARGET = 1e-6, 1e-4
# A bound with a smaller multiplier holds nothing.
HOLDS = 1e-9
# Step of differences of slopes, a logarithm.
STEP = 0.03


@dataclass(frozen=True, eq=False)
class Optimality:
    """The conditions of Karush, Kuhn and Tucker at a point.

    Attributes
    ----------
    residual : float
        Largest part of the gradient that no active bound balances, per logarithm of a
        parameter.
    lower, upper : ndarray
        Multipliers of the bounds of the free parameters, 0 where they are not active:
        what the objective gains per logarithm that a bound gives way.
    targets : ndarray
        Multipliers of the bounds of CV.
    errors : ndarray
        Of the logarithms of the free parameters, to first order.
    """

    residual: float
    lower: Array
    upper: Array
    targets: Array
    errors: Array


@dataclass(frozen=True, eq=False)
class Active:
    """Which bounds hold a point, and their gradients.

    Attributes
    ----------
    lower, upper, targets : ndarray of bool
        Over the free parameters, and the bounds of CV.
    rows : ndarray
        Gradients of what is at its bound, and of the base weight with both signs.
    """

    lower: Mask
    upper: Mask
    targets: Mask
    rows: Array

    @classmethod
    def of(cls, goal: Goal, space: Space, y: Array, at: At) -> Active:
        """At a point."""
        margins, jacobian = goal.margins(y, at)
        lower, upper = y - space.low <= AT_BOUND, space.high - y <= AT_BOUND
        reached, axes, row = margins <= AT_TARGET, np.eye(y.size), space.row[None]
        parts = (axes[lower], -axes[upper], jacobian[reached], row, -row)
        return cls(lower, upper, reached, np.vstack(parts))

    def split(self, numbers: Array) -> tuple[Array, Array, Array]:
        """Numbers of the rows by what they belong to; zeros where nothing is active."""
        all_of_them = self.lower, self.upper, self.targets
        placed = tuple(np.zeros(which.size) for which in all_of_them)
        first = 0
        for which, into in zip(all_of_them, placed, strict=True):
            last = first + int(which.sum())
            into[which], first = numbers[first:last], last
        return placed[0], placed[1], placed[2]


def optimality(
    goal: Goal, space: Space, predicted: Predictions, y: Array
) -> Optimality:
    """Multipliers, residual and errors at a point of the space."""
    at = predicted(y)
    active = Active.of(goal, space, y, at)
    gradient = goal.objective(y, at)[1]
    multipliers, _ = nnls(active.rows.T, gradient)
    rest = gradient - active.rows.T @ multipliers
    lower, upper, targets = active.split(multipliers)
    weights = goal.weights(targets)
    of_slopes = at.slope_errors[space.places] @ weights
    # Where the errors of slopes could undo a multiplier, its bound may hold nothing.
    held = lower + upper > np.maximum(of_slopes, HOLDS), targets > HOLDS
    of_gradient = np.abs(rest) + of_slopes
    errors = errors_of(goal, space, predicted, y, held, weights, of_gradient)
    return Optimality(float(np.abs(rest).max()), lower, upper, targets, errors)


def errors_of(
    goal: Goal,
    space: Space,
    predicted: Predictions,
    y: Array,
    held: tuple[Mask, Mask],
    weights: Array,
    of_gradient: Array,
) -> Array:
    """How far a point may be from the optimum, as errors of CV and of slopes say.

    The conditions of the optimum are linearised: what is held by its bound stays so, up
    to the errors of CV, and along the rest the gradient of the Lagrangian vanishes up
    to its errors, with second derivatives from differences of slopes. Infinite where
    these do not tell an optimum.
    """
    at = predicted(y)
    margins, jacobian = goal.margins(y, at)
    exact = np.vstack([np.eye(y.size)[held[0]], space.row[None]])
    of_targets = np.abs(margins) + at.errors / at.cv if margins.size else margins
    rows = np.vstack([exact, jacobian[held[1]]])
    of_rows = np.append(np.zeros(len(exact)), of_targets[held[1]])
    back = np.linalg.pinv(rows, rcond=1e-8)
    errors = np.abs(back) @ of_rows
    along = null_space(rows, rcond=1e-8)
    if not along.size:
        return np.asarray(errors)
    # Second derivatives along what is left, and of that with what is held.
    curvature = curved(space, predicted, y, weights, along)
    reduced = along.T @ curvature
    reduced = 0.5 * (reduced + reduced.T)
    if not np.linalg.eigvalsh(reduced).min() > 0:
        return np.where(np.abs(along).max(axis=1) > AT_BOUND, np.inf, errors)
    inverse = np.linalg.solve(reduced, along.T)
    shifted = np.abs(along @ np.linalg.solve(reduced, curvature.T @ back)) @ of_rows
    return np.asarray(errors + np.abs(along @ inverse) @ of_gradient + shifted)


def curved(
    space: Space, predicted: Predictions, y: Array, weights: Array, along: Array
) -> Array:
    """Second derivatives of Σ w log CV along directions, by differences of slopes."""
    here = predicted(y).slopes[space.places] @ weights
    ahead = [predicted(y + STEP * one).slopes[space.places] for one in along.T]
    return np.array([(one @ weights - here) / STEP for one in ahead]).T
