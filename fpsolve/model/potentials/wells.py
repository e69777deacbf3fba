"""Wells of B at known places: cells around them are halved until the nodes see them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import Array, check_numbers
from fpsolve.model.potentials.quadrature import Cells, Rule, node_values, refined

__all__ = ["NO_PLACES", "check_places", "opened", "unseen"]

Value = Callable[..., Array]
Rules = tuple[Rule, Rule]

NO_PLACES: Array = np.empty((0, 2))
NO_PLACES.flags.writeable = False
# A place is seen if B at one of the nodes around it is hardly above B there.
_HARDLY = 0.1
# Points around a place, at these distances in terms of its cell.
_N_DIRECTIONS, _AWAY = 16, np.geomspace(0.1, 10.0, 21)
# Halvings of a side: a cell is then as small as the rounding of its distance.
_MOST = 2 * 48


def check_places(name: str, places: ArrayLike) -> Array:
    """Return places (ξ1, ξ2) as an array of shape (n, 2); ValueError unless finite."""
    points = check_numbers(name, places)
    if not points.size:
        return NO_PLACES
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ValueError(
            f"`{name}` must be finite places [(xi1, xi2), ...], got {places!r}."
        )
    return points


def opened(value: Value, cells: Cells, places: Array, rules: Rules) -> Cells:
    """Cells with those around every place halved until their nodes see B there.

    A narrow well is then no longer between the nodes, and the ladder of the quadrature
    goes on from there. Part of it may lie in the next cell, so that points around the
    place, near and far in terms of its cell, are to be seen too.
    """
    cells = _until_seen(value, cells, places, rules)
    return _until_seen(value, cells, _around(places, cells.edges, rules), rules)


def _until_seen(value: Value, cells: Cells, places: Array, rules: Rules) -> Cells:
    for _ in range(_MOST):
        places = places[unseen(value, cells.edges, places, rules)]
        chosen = np.asarray(containing(cells.edges, places, rules).any(axis=0))
        if not chosen.any():
            break
        cells = refined(value, _turned(cells, chosen, rules), chosen, rules)
    return cells


def _around(places: Array, edges: Array, rules: Rules) -> Array:
    """Points around every place, at distances in terms of the cell it lies in."""
    found, cell = np.nonzero(containing(edges, places, rules))
    size = _sizes(edges[cell], rules)
    turns = 2 * math.pi * (np.arange(_N_DIRECTIONS) + 0.5) / _N_DIRECTIONS
    away = np.stack([np.cos(turns), np.sin(turns)], axis=1)[:, None] * _AWAY[:, None]
    points: Array = places[found, None, None] + size[:, None, None, None] * away
    return points.reshape(-1, 2)


def _turned(cells: Cells, chosen: NDArray[np.bool_], rules: Rules) -> Cells:
    """The cells, the chosen ones to be halved across their longer side."""
    r0, r1, a0, a1 = cells.edges[chosen].T
    wide = (r1 * (a1 - a0) > r1 - r0) & (rules[1].nodes.size > 1)
    cells.axis[chosen] = wide.astype(np.int64)
    return cells


def containing(edges: Array, places: Array, rules: Rules) -> NDArray[np.bool_]:
    """Which cells contain which place, shape (n_places, n_cells)."""
    r, angle = _polar(places)
    r0, r1, a0, a1 = edges.T
    within = (r0 <= r) & (r < r1)
    if rules[1].nodes.size > 1:
        within &= (a0 <= angle) & (angle < a1)
    return np.asarray(within)


def unseen(
    value: Value, edges: Array, places: Array, rules: Rules
) -> NDArray[np.bool_]:
    """Which places lie in none of the cells, or deeper than the nodes around them."""
    missed = np.ones(len(places), dtype=bool)
    found, cell = np.nonzero(containing(edges, places, rules))
    if not found.size:
        return missed
    with np.errstate(all="ignore"):
        depth = np.asarray(value(places[found, 0], places[found, 1]))
    used, cell = np.unique(cell, return_inverse=True)
    nodes = node_values(value, edges[used], rules)
    r, angle = (side[found, 0] for side in _polar(places))
    r0, r1, a0, a1 = edges[used][cell].T
    first = _nodes_beside(rules[0], (r - r0) / (r1 - r0))
    second = _nodes_beside(rules[1], (angle - a0) / (a1 - a0))
    near = nodes[cell[:, None, None], first[:, :, None], second[:, None, :]]
    missed[found] = near.min(axis=(1, 2)) > depth + _HARDLY
    return missed


def _polar(places: Array) -> tuple[Array, Array]:
    """r and 0 ≤ θ < 2π, shapes (n, 1)."""
    xi1, xi2 = places.T[:, :, None]
    angle = np.arctan2(xi2, xi1)
    angle = np.where(angle < 0.0, angle + 2 * math.pi, angle)
    return np.hypot(xi1, xi2), np.where(angle < 2 * math.pi, angle, 0.0)


def _nodes_beside(rule: Rule, at: Array) -> NDArray[np.int64]:
    """Numbers of the nodes before and after places in 0 ... 1, shape (n, 2)."""
    after = np.searchsorted(rule.nodes, at)
    beside = np.stack([after - 1, after], axis=1)
    return np.clip(beside, 0, rule.nodes.size - 1)


def _sizes(edges: Array, rules: Rules) -> Array:
    """The longer side of every cell."""
    r0, r1, a0, a1 = edges.T
    around = r1 * (a1 - a0) if rules[1].nodes.size > 1 else 0.0
    return np.asarray(np.maximum(r1 - r0, around))
