"""Shapes that a fibre may have before anything pulls at it."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve.fibre.ends import Clamped, Free, place_of
from fpsolve.fibre.string import String

__all__ = ["checked_shape", "checked_vectors", "first_shape"]

# Of the length of an edge: what a user's shape may be off.
ROUNDING = 1e-6


def first_shape(string: String) -> Array:
    """Straight where one end is held, an arc of edges of equal length between two."""
    first, last = place_of(string.start), place_of(string.end)
    if first is not None and last is not None:
        return _arc(string, first, last)
    direction = _direction(string)
    if first is None and last is not None:
        return np.asarray(last + (string.s - string.length)[:, None] * direction)
    return np.asarray((0.0 if first is None else first) + string.s[:, None] * direction)


def checked_shape(string: String, shape: object) -> Array:
    """Positions as an array; ValueError unless edges and held ends fit the string."""
    r = check_finite_numbers("shape", shape)
    if r.shape != (string.n_edges + 1, 3):
        raise ValueError(
            f"`shape` must be the positions of {string.n_edges + 1} nodes, shape "
            f"{(string.n_edges + 1, 3)}, got {r.shape}."
        )
    lengths = np.linalg.norm(np.diff(r, axis=0), axis=1)
    off = np.abs(lengths / string.edge - 1).max()
    if not off <= ROUNDING:
        raise ValueError(
            f"`shape` must have edges of {string.edge:g}, got one that is off by a "
            f"part of {off:.2g}; the fibre does not stretch."
        )
    for held, node, name in ((string.start, r[0], "start"), (string.end, r[-1], "end")):
        place = place_of(held)
        if place is not None and not np.allclose(
            place, node, atol=ROUNDING * string.edge
        ):
            raise ValueError(
                f"`shape` must have its {name} at {tuple(place.tolist())}, got "
                f"{tuple(node.tolist())}."
            )
    return r


def checked_vectors(name: str, value: object, shape: tuple[int, ...]) -> Array:
    """One vector for every node, or for all of them, as an array of them."""
    found = check_finite_numbers(name, value)
    if found.shape not in (shape, (3,)):
        raise ValueError(
            f"`{name}` must have the shape {shape} or (3,), got {found.shape}."
        )
    return np.array(np.broadcast_to(found, shape))


def _direction(string: String) -> Array:
    """Of a straight fibre: as it is clamped, or as it hangs."""
    for end in (string.start, string.end):
        if isinstance(end, Clamped):
            return np.array(end.direction)
    gravity = np.array(string.gravity)
    weight = float(np.linalg.norm(gravity))
    if not weight:
        return np.array([1.0, 0.0, 0.0])
    # Down from the end that is held.
    sign = -1.0 if isinstance(string.start, Free) else 1.0
    return np.asarray(sign * gravity / weight)


def _arc(string: String, first: Array, last: Array) -> Array:
    """Nodes on a circle through both ends, on the side to which gravity pulls."""
    n, chord = string.n_edges, last - first
    apart = float(np.linalg.norm(chord))
    # Half of the angle between neighbours: sin(nβ)/sin β = distance/edge.
    half = brentq(
        lambda b: math.sin(n * b) / math.sin(b) - apart / string.edge,
        1e-9 / n, math.pi / n, xtol=1e-16,
    )  # fmt: skip
    along = chord / apart if apart else _across(np.array([0.0, 0.0, 1.0]), string)
    across = _across(along, string)
    turned = (2 * np.arange(n) - (n - 1)) * half
    edges = np.cos(turned)[:, None] * along - np.sin(turned)[:, None] * across
    r = first + np.concatenate(
        [np.zeros((1, 3)), string.edge * np.cumsum(edges, axis=0)]
    )
    r[-1] = last
    return np.asarray(r)


def _across(along: Array, string: String) -> Array:
    """A unit vector orthogonal to one, towards gravity if that has such a part."""
    for wanted in (np.array(string.gravity), np.eye(3)[np.abs(along).argmin()]):
        across = wanted - (wanted @ along) * along
        length = float(np.linalg.norm(across))
        if length > 1e-9 * float(np.linalg.norm(wanted)):
            return np.asarray(across / length)
    raise AssertionError("an axis is orthogonal to every vector, or nearly so")
