"""The partition function Z = ∫ exp(-B) dξ by quadrature."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["partition_function_of"]

# Rings between the radii 2^k. The smallest is far below any throwing range; beyond the
# largest an angle no longer resolves a valley of width one in float64.
_SMALLEST_POWER, _LARGEST_POWER = -40, 26
# What a ring may weigh, relative to the heaviest, to be left out; this many in a row
# end the search outwards.
_NEGLIGIBLE = 1e-18
_N_LIGHT_RINGS = 3
_N_ANGLES = 256
# Circles on which a ring is weighed, relative to its radius.
_CIRCLES = (1.0, 2**-0.25, 2**-0.5, 2**-0.75)
# Relative error aimed at, and allowed where a kink of B across the rings stops the
# adaptive rule short of its aim.
_ERROR_AIMED_AT = 1e-11
_ERROR_ALLOWED = 1e-6
_N_SUBDIVISIONS = 100

_Value = Callable[..., NDArray[np.float64]]


def partition_function_of(value: _Value) -> float:
    """Z = ∫ exp(-B(ξ)) dξ over the plane, or `math.inf` when it does not exist.

    The plane is cut into rings between the radii 2^k. A ring weighs about
    r² exp(-min B); rings lighter than 1e-18 of the heaviest are left out, the others
    are integrated adaptively in polar coordinates. The relative error is about 1e-11
    for smooth potentials and below 1e-6 otherwise. When the rings do not become that
    light the density is taken as not normalisable: this includes potentials that grow
    more slowly than about 4 ln ‖ξ‖.

    Parameters
    ----------
    value : callable
        ``value(xi1, xi2)``, vectorised.

    Raises
    ------
    ValueError
        If B is NaN somewhere, exp(-B) underflows everywhere, or B is too rough for the
        quadrature.
    """
    radii, weights = _weighed_rings(value)
    heaviest = np.max(weights)
    if heaviest == 0:
        raise ValueError(
            "`value` must be small enough somewhere for exp(-B) not to underflow; "
            "subtract the minimum of B."
        )
    if not weights[-1] <= _NEGLIGIBLE * heaviest < math.inf:
        return math.inf
    heavy = np.flatnonzero(weights > _NEGLIGIBLE * heaviest)
    first, last = max(heavy[0] - 1, 0), heavy[-1] + 1
    edges = np.concatenate([[0.0], radii[first : last + 1]])
    parts = [_quadrant_integrals(value, *ring, heaviest) for ring in pairwise(edges)]
    integral, error = np.sum(np.concatenate(parts), axis=0)
    if not error <= _ERROR_ALLOWED * integral:
        raise ValueError(
            f"`value` must allow to integrate exp(-B), got {integral:g} with error "
            f"{error:.2g}; smooth B, scale it, or move its minimum to the origin."
        )
    return float(integral)


def _weighed_rings(value: _Value) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Radii outwards until the rings are negligible, and the weight of each."""
    radii = np.exp2(np.arange(_SMALLEST_POWER, _LARGEST_POWER + 1.0))
    weights: list[float] = []
    heaviest, n_light = 0.0, 0
    for radius in radii:
        weights.append(max(_circle_weight(value, radius * c) for c in _CIRCLES))
        heaviest = max(heaviest, weights[-1])
        light = heaviest > 0 and weights[-1] <= _NEGLIGIBLE * heaviest
        n_light = n_light + 1 if light else 0
        if n_light == _N_LIGHT_RINGS or heaviest == math.inf:
            break
    return radii[: len(weights)], np.array(weights)


def _circle_weight(value: _Value, radius: float) -> float:
    """r² exp(-min B) on the circle of that radius, by scanning and zooming."""
    centre, half_window = math.pi, math.pi
    lowest = math.inf
    for _ in range(4):
        angles = centre + half_window * np.linspace(-1.0, 1.0, _N_ANGLES + 1)
        values = value(radius * np.cos(angles), radius * np.sin(angles))
        at = int(np.argmin(values))
        if np.isnan(values[at]):
            raise ValueError(f"`value` must be a number, got NaN at radius {radius:g}.")
        lowest = min(lowest, float(values[at]))
        centre, half_window = float(angles[at]), 2 * half_window / _N_ANGLES
    with np.errstate(over="ignore", under="ignore"):
        return float(radius**2 * np.exp(-lowest))


def _quadrant_integrals(
    value: _Value, inner: float, outer: float, heaviest: float
) -> list[tuple[float, float]]:
    """∫ exp(-B) over inner < r < outer and its error, for each quadrant."""
    from scipy.integrate import cubature

    def density(points: NDArray[np.float64]) -> NDArray[np.float64]:
        r, angle = points.T
        with np.errstate(under="ignore"):
            weight = np.exp(-value(r * np.cos(angle), r * np.sin(angle)))
            return np.asarray(r * weight)

    results = [
        cubature(
            density,
            [inner, begin],
            [outer, end],
            rtol=_ERROR_AIMED_AT,
            atol=_ERROR_AIMED_AT * heaviest,
            max_subdivisions=_N_SUBDIVISIONS,
        )
        # Potentials often have a kink on the axes, where the quadrants are cut apart.
        for begin, end in pairwise(np.arange(5) * (math.pi / 2))
    ]
    return [(float(result.estimate), float(result.error)) for result in results]
