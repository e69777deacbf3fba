"""∫ exp(-B) dξ by Gauss-Kronrod rules on cells in (r, θ), halved until B is resolved.

A rule only sees its nodes: a narrow well between them weighs nothing, with an error
estimate of nothing. So each cell also has a bound. Where B is convex it lies above
every line through two of its values, outside of them; the largest e^{-B} that these
lines allow between the nodes times the area bounds the integral. A cell whose bound is
far above its integral hides something, or cannot tell, and is halved as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array

__all__ = [
    "Cells",
    "Rule",
    "lowest_nearby",
    "node_places",
    "node_values",
    "refined",
    "rules_for",
    "weighed",
]

Value = Callable[..., Array]

# B is cut off here, so that differences of it do not overflow.
_HIGHEST = 1e60
# Weights e^{-80} = 2e-35 of the largest are nothing.
_DEEPEST = 80.0
# A bound this many times the integral says that the nodes do not see B. Resolved tails
# stay well below: B falls by less than ln 1e6 = 14 between their nodes.
_UNSEEN = 1e6
# What B may fall between a node lower than its neighbours and these, in terms of its
# rise to them.
_DIP = 2.0
# Cells evaluated at once.
_CHUNK = 2048

# Nodes on [0, 1] of Kronrod's rule with 15 points, its weights, and those of Gauss's
# rule with 7 points among them.
_NODES = np.array([
    0.0, 0.207784955007898467600689403773, 0.405845151377397166906606412077,
    0.586087235467691130294144691694, 0.741531185599394439863864773281,
    0.864864423359769072789712788641, 0.949107912342758524526189684048,
    0.991455371120812639206854697526,
])  # fmt: skip
_KRONROD = np.array([
    0.209482141084727828012999174892, 0.204432940075298892414161999235,
    0.190350578064785409913256402421, 0.169004726639267902826583426599,
    0.140653259715525918745189590510, 0.104790010322250183839876322542,
    0.063092092629978553290700663189, 0.022935322010529224963732008059,
])  # fmt: skip
_GAUSS = np.array([
    0.417959183673469387755102040816, 0.0, 0.381830050505118944950369775489, 0.0,
    0.279705391489276667901467771424, 0.0, 0.129484966168869693270611432679, 0.0,
])  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """Nodes on [0, 1] and two sets of weights, the second for the error."""

    nodes: Array
    weights: Array
    coarse: Array


def _mirrored(half: Array, sign: float) -> Array:
    return np.concatenate([sign * half[:0:-1], half])


KRONROD = Rule(
    0.5 + 0.5 * _mirrored(_NODES, -1.0),
    0.5 * _mirrored(_KRONROD, 1.0),
    0.5 * _mirrored(_GAUSS, 1.0),
)
# For the angle of an isotropic potential.
ONE_NODE = Rule(np.array([0.5]), np.ones(1), np.ones(1))


def rules_for(isotropic: bool) -> tuple[Rule, Rule]:
    """The rules in r and θ."""
    return KRONROD, ONE_NODE if isotropic else KRONROD


# Attributes with an entry for every cell.
_BY_CELL = ("edges", "integral", "error", "bound", "axis")


@dataclass(frozen=True)
class Cells:
    """Cells [r0, r1] × [a0, a1] and what is known of e^{reference - B} on them.

    Attributes
    ----------
    edges : ndarray, shape (n, 4)
        r0, r1, a0, a1.
    integral, error, bound : ndarray, shape (n,)
        Relative to `reference`. The error counts a bound far above the integral.
    axis : ndarray of int, shape (n,)
        Which way the cell should be halved.
    reference : float
        The least value of B at any node so far.
    """

    edges: Array
    integral: Array
    error: Array
    bound: Array
    axis: NDArray[np.int64]
    reference: float

    def __len__(self) -> int:
        return len(self.edges)

    def relative_to(self, reference: float) -> Cells:
        """The same, relative to a lower reference."""
        factor = np.exp(max(reference - self.reference, -700.0))
        changed: dict[str, Any] = {
            name: getattr(self, name) * factor
            for name in ("integral", "error", "bound")
        }
        return replace(self, **changed, reference=reference)

    def chosen(self, which: Any) -> Cells:
        """Some of the cells."""
        return replace(self, **{name: getattr(self, name)[which] for name in _BY_CELL})

    def joined(self, other: Cells) -> Cells:
        """Both, relative to the lower reference."""
        reference = min(self.reference, other.reference)
        one, two = self.relative_to(reference), other.relative_to(reference)
        both: dict[str, Any] = {
            name: np.concatenate([getattr(one, name), getattr(two, name)])
            for name in _BY_CELL
        }
        return replace(one, **both)


def node_places(edges: Array, rules: tuple[Rule, Rule]) -> tuple[Array, Array]:
    """r and θ of the nodes, shapes (n, n1, 1) and (n, 1, n2)."""
    r0, r1, a0, a1 = edges.T[:, :, None]
    r = r0 + (r1 - r0) * rules[0].nodes
    angle = a0 + (a1 - a0) * rules[1].nodes
    return r[:, :, None], angle[:, None, :]


def node_values(value: Value, edges: Array, rules: tuple[Rule, Rule]) -> Array:
    """B at the nodes, cut off at ±1e60; shape (n, n1, n2)."""
    r, angle = node_places(edges, rules)
    xi1, xi2 = r * np.cos(angle), r * np.sin(angle)
    # Far out a user's formula may overflow, to the right sign.
    with np.errstate(all="ignore"):
        values = np.asarray(value(xi1.ravel(), xi2.ravel())).reshape(xi1.shape)
    return np.asarray(np.clip(values, -_HIGHEST, _HIGHEST))


def weighed(
    value: Value, edges: Array, rules: tuple[Rule, Rule], reference: float
) -> Cells:
    """Integrals, errors and bounds of new cells; NaN if B is NaN at a node."""
    parts: list[Cells] = []
    for start in range(0, len(edges), _CHUNK):
        some = edges[start : start + _CHUNK]
        values = node_values(value, some, rules)
        lowest = float(np.nanmin(values, initial=_HIGHEST))
        reference = min(reference, lowest)
        parts.append(_summed(values, some, rules, reference))
    return _all_joined(parts)


def _all_joined(parts: list[Cells]) -> Cells:
    while len(parts) > 1:
        pairs = zip(parts[::2], parts[1::2], strict=False)
        joined = [one.joined(two) for one, two in pairs]
        parts = joined + parts[len(parts) - len(parts) % 2 :]
    return parts[0]


def _summed(
    values: Array, edges: Array, rules: tuple[Rule, Rule], reference: float
) -> Cells:
    low1 = lowest_nearby(values, rules[0].nodes, 1)
    low2 = lowest_nearby(values, rules[1].nodes, 2)
    # Between nodes B may be lower than at one by what it falls along both axes.
    allowed = reference - (low1 + low2 - values)
    n = len(edges)
    integral, error, bound = np.zeros(n), np.zeros(n), np.zeros(n)
    axis = _longer_side(edges)
    # Most cells are far from every well.
    heavy = np.flatnonzero(~(allowed.max(axis=(1, 2)) < -_DEEPEST))
    r, _ = node_places(edges[heavy], rules)
    area = (edges[heavy, 1] - edges[heavy, 0]) * (edges[heavy, 3] - edges[heavy, 2])
    area = area[:, None, None] * r
    first, second = (rule.weights for rule in rules)
    coarse1, coarse2 = (rule.coarse for rule in rules)
    weight = area * _exponential(reference - values[heavy])
    fine = _contracted(weight, first, second)
    error1 = np.abs(fine - _contracted(weight, coarse1, second))
    error2 = np.abs(fine - _contracted(weight, first, coarse2))
    bounds = [
        _contracted(area * _exponential(exponent), first, second)
        for exponent in (
            allowed[heavy], reference - low1[heavy], reference - low2[heavy],
        )
    ]  # fmt: skip
    unseen = bounds[0] > _UNSEEN * fine
    integral[heavy], bound[heavy] = fine, bounds[0]
    error[heavy] = error1 + error2 + np.where(unseen, bounds[0], 0.0)
    worse1 = np.where(unseen, bounds[1] > bounds[2], error1 > error2)
    worse2 = np.where(unseen, bounds[1] < bounds[2], error1 < error2)
    axis[heavy] = np.where(worse1, 0, np.where(worse2, 1, axis[heavy]))
    if rules[1] is ONE_NODE:
        axis[:] = 0
    return Cells(edges, integral, error, bound, axis, reference)


def _exponential(exponent: Array) -> Array:
    with np.errstate(under="ignore"):
        return np.asarray(np.exp(np.minimum(exponent, 0.0)))


def _contracted(weight: Array, first: Array, second: Array) -> Array:
    return np.asarray((weight @ second) @ first)


def _longer_side(edges: Array) -> NDArray[np.int64]:
    r0, r1, a0, a1 = edges.T
    return np.asarray(r1 * (a1 - a0) > r1 - r0).astype(np.int64)


def lowest_nearby(values: Array, nodes: Array, axis: int) -> Array:
    """Least B between a node and its neighbours along an axis, if B is convex there.

    Between two nodes B lies above the lines through the next two on either side.
    """
    if nodes.size == 1:
        return values
    v = np.moveaxis(values, axis, -1)
    gap = np.diff(nodes)
    rise = np.diff(v, axis=-1)
    slope = rise / gap
    from_left = v[..., 1:-1] + np.minimum(slope[..., :-1], 0.0) * gap[1:]
    from_right = v[..., 1:-1] - np.maximum(slope[..., 1:], 0.0) * gap[:-1]
    low = np.minimum(v[..., :-1], v[..., 1:])
    allowed = np.full_like(low, -np.inf)
    allowed[..., 1:] = from_left
    allowed[..., :-1] = np.maximum(allowed[..., :-1], from_right)
    low = np.minimum(low, allowed)
    # At a node lower than both neighbours, perhaps the only one in a well, B may fall
    # as steeply as it rises there.
    dip = np.maximum(-rise[..., :-1], 0.0) * (rise[..., 1:] > 0.0)
    dip = np.where(dip > 0.0, _DIP * np.maximum(dip, rise[..., 1:]), 0.0)
    low[..., :-1] = np.minimum(low[..., :-1], v[..., 1:-1] - dip)
    low[..., 1:] = np.minimum(low[..., 1:], v[..., 1:-1] - dip)
    nearby = np.empty_like(v)
    before = v[..., 0] - np.maximum(slope[..., 0], 0.0) * nodes[0]
    after = v[..., -1] + np.minimum(slope[..., -1], 0.0) * (1.0 - nodes[-1])
    nearby[..., 1:-1] = np.minimum(low[..., :-1], low[..., 1:])
    nearby[..., 0] = np.minimum(before, low[..., 0])
    nearby[..., -1] = np.minimum(after, low[..., -1])
    return np.moveaxis(nearby, -1, axis)


def halves(edges: Array, axis: NDArray[np.int64]) -> Array:
    """Both halves of each cell along its axis; shape (2 n, 4)."""
    rows, low = np.arange(len(edges)), 2 * axis
    middle = 0.5 * (edges[rows, low] + edges[rows, low + 1])
    one, two = edges.copy(), edges.copy()
    one[rows, low + 1] = middle
    two[rows, low] = middle
    return np.concatenate([one, two])


def refined(value: Value, cells: Cells, which: Any, rules: tuple[Rule, Rule]) -> Cells:
    """The cells with some of them halved."""
    chosen = np.zeros(len(cells), dtype=bool)
    chosen[which] = True
    old = cells.chosen(chosen)
    new = weighed(value, halves(old.edges, old.axis), rules, cells.reference)
    return cells.chosen(~chosen).joined(new)
