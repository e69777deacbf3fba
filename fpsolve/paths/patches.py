"""Rejection from exp(-B) on the cells of its quadrature."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.partition import Normalisation
from fpsolve.model.potentials.quadrature import lowest_nearby, node_values, rules_for
from fpsolve.paths.rejection import drawn

__all__ = ["PatchRejection"]


# Around a node B falls by no more than its differences to the neighbours say, where it
# is convex or concave; the margin is for places where it turns from one to the other.
MARGIN, SLACK = 1.5, 0.02
# Patches that weigh less than this part of all are never drawn.
NEGLIGIBLE = 1e-20


class PatchRejection:
    """Draws ξ with the density e^{-B}/Z, by rejection on patches around the nodes.

    The rule that integrated e^{-B} knows B at its nodes. Each is the node of a patch
    in (r, θ), on which neighbouring values bound e^{-B}. A patch is chosen by its
    bound, a point evenly in it, and kept with the ratio of e^{-B} to the bound. The
    result is exact as long as the bounds hold, which every point checks.

    Parameters
    ----------
    value : callable
        B.
    normalisation : Normalisation
        With the cells that resolve e^{-B}.
    isotropic : bool
    """

    def __init__(
        self, value: Callable[..., Array], normalisation: Normalisation, isotropic: bool
    ) -> None:
        self.value, self.lowest = value, normalisation.lowest
        edges = normalisation.edges
        if edges is None:
            raise ValueError("`normalisation` must have cells, got a closed form.")
        rules = rules_for(isotropic)
        values = node_values(value, edges, rules)
        r = sides(edges[:, 0], edges[:, 1], rules[0].weights)
        angle = sides(edges[:, 2], edges[:, 3], rules[1].weights)
        low = self.lowest - values
        low += drop(values, rules[0].nodes, rules[0].weights, 1)
        low += drop(values, rules[1].nodes, rules[1].weights, 2)
        with np.errstate(under="ignore"):
            bound = np.exp(np.minimum(low, 0.0) + SLACK)
        area = np.diff(r**2)[:, :, None] * np.diff(angle)[:, None, :] / 2
        weight = bound * area
        kept = np.nonzero(weight > NEGLIGIBLE * weight.sum())
        cell, first, second = kept
        self.squares = r[cell, first] ** 2, r[cell, first + 1] ** 2
        self.angles = angle[cell, second], angle[cell, second + 1]
        self.bounds = bound[kept]
        self.cumulated = np.cumsum(weight[kept])

    def __call__(self, rng: np.random.Generator, n: int) -> Array:
        """Draw n points, shape (n, 2)."""
        return drawn(self._proposed, rng, n, 2)

    def _proposed(self, rng: np.random.Generator, n: int) -> Array:
        chosen = rng.uniform(0.0, self.cumulated[-1], n)
        at = np.searchsorted(self.cumulated, chosen, side="right")
        at = np.minimum(at, self.bounds.size - 1)
        # Evenly in r² is evenly in the plane.
        r = np.sqrt(between(rng, self.squares, at))
        angle = between(rng, self.angles, at)
        xi1, xi2 = r * np.cos(angle), r * np.sin(angle)
        ratio = np.exp(self.lowest - self.value(xi1, xi2)) / self.bounds[at]
        if not np.all(ratio <= 1.0):
            worst = int(np.argmax(ratio))
            raise ValueError(
                "`potential` must be smooth enough to be sampled, got exp(-B) of "
                f"{ratio[worst]:.3g} times its bound at ({xi1[worst]:.4g}, "
                f"{xi2[worst]:.4g})."
            )
        points = np.stack([xi1, xi2], axis=1)
        return np.asarray(points[rng.uniform(size=n) < ratio])


def between(
    rng: np.random.Generator, ends: tuple[Array, Array], at: NDArray[np.int64]
) -> Array:
    """Evenly between the two ends of each chosen interval."""
    low, high = ends[0][at], ends[1][at]
    return np.asarray(low + (high - low) * rng.uniform(size=at.size))


def sides(low: Array, high: Array, weights: Array) -> Array:
    """Borders of the patches of a cell, as long as the weights; shape (n, m + 1)."""
    places = np.concatenate([[0.0], np.cumsum(weights)])
    places[-1] = 1.0
    return np.asarray(low[:, None] + (high - low)[:, None] * places)


def drop(values: Array, nodes: Array, weights: Array, axis: int) -> Array:
    """By how much B may fall from a node to the border of its patch along an axis."""
    if nodes.size == 1:
        return np.zeros_like(values)
    v = np.moveaxis(values, axis, -1)
    slope = np.abs(np.diff(v, axis=-1) / np.diff(nodes))
    steepest = np.empty_like(v)
    steepest[..., 1:-1] = np.maximum(slope[..., :-1], slope[..., 1:])
    steepest[..., 0], steepest[..., -1] = slope[..., 0], slope[..., -1]
    borders = np.concatenate([[0.0], np.cumsum(weights)])
    reach = np.maximum(nodes - borders[:-1], borders[1:] - nodes)
    by_slope = np.moveaxis(reach * steepest, -1, axis)
    return np.asarray(
        MARGIN * np.minimum(by_slope, values - lowest_nearby(values, nodes, axis))
    )
