"""Z = ∫ exp(-B) dξ by quadrature, with an error, whatever the lowest value of B."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.quadrature import (
    ONE_NODE,
    Cells,
    Rule,
    refined,
    rules_for,
    weighed,
)
from fpsolve.model.potentials.rings import lowest_in_ring
from fpsolve.model.potentials.wells import NO_PLACES, opened

__all__ = ["Normalisation", "normalisation_of"]

Value = Callable[..., Array]
Rules = tuple[Rule, Rule]

# Rings between the radii 2^k. The smallest is far below any throwing range; beyond the
# largest an angle no longer resolves a valley of width one in float64.
_SMALLEST_POWER, _LARGEST_POWER = -40, 26
# Relative error aimed at, and allowed when this many cells were not enough.
_LADDER = ((6_000, 1e-11), (12_000, 1e-8), (24_000, 1e-6))
_ALLOWED = 1e-6
# Error of the first look that tells how large the pattern is.
_ROUGH = 1e-2
# Around that size wells in flat surroundings are looked for: cells no larger than this
# part of their distance and this angle, from the size over 2^5 to the size times 2^6.
_SIDE, _ISOTROPIC_SIDE, _ANGLE = 0.26, 0.02, 0.2
_INWARDS, _OUTWARDS = 5, 6
# Weight of rings, relative to all, that is nothing; this many of them in a row are to
# lie around everything else where B is not known farther out.
_NEGLIGIBLE, _N_LIGHT_RINGS = 1e-18, 3
# Rings whose weights fall by less than this do not end.
_ENDLESS = 0.999
_EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Normalisation:
    """Z = e^{-lowest} · integral, so that neither part over- or underflows.

    Attributes
    ----------
    lowest : float
        B at about its minimum, or another value near it.
    integral : float
        ∫ e^{lowest - B} dξ; infinite when it does not exist.
    error : float
        Bound of the relative error of the integral, as estimated.
    tail : float
        Share of the integral beyond the last ring, extrapolated.
    edges : ndarray, shape (n, 4), or None
        The cells (r0, r1, θ0, θ1) that resolve e^{-B}; None for a closed form.
    """

    lowest: float
    integral: float
    error: float = 0.0
    tail: float = 0.0
    edges: Array | None = None

    @property
    def log_value(self) -> float:
        """ln Z."""
        return math.log(self.integral) - self.lowest

    def scaled(self, length: float) -> Normalisation:
        """The same for B(ξ/length)."""
        edges = self.edges
        if edges is not None:
            edges = edges * np.array([length, length, 1.0, 1.0])
        return replace(self, integral=self.integral * length**2, edges=edges)


def normalisation_of(
    value: Value, isotropic: bool = False, well_places: Array = NO_PLACES
) -> Normalisation:
    """Z = ∫ exp(-B(ξ)) dξ over the plane; an infinite integral when it does not exist.

    The plane is cut into rings between the radii 2^k and those into cells in (r, θ),
    which are halved until the sum of their errors is below 1e-11 (1e-6 where kinks of
    B stop the rule short of that). Cells also carry a bound of what may hide between
    their nodes, so that wells and valleys far out are found as long as B leads there.
    A hole in flat surroundings is found if it is wider than about a thirtieth of its
    distance from the origin (isotropic: a ring wider than a five-hundredth of its
    radius); a Gaussian well if its standard deviation is above a five-hundredth of
    it. Narrower ones are missed, without a sign in the error, unless a place in them
    is given. Tails like a power of r are extrapolated. Potentials that grow more
    slowly than about 2 ln ‖ξ‖ have an infinite integral.

    Parameters
    ----------
    value : callable
        ``value(xi1, xi2)``, vectorised.
    isotropic : bool
        Whether B depends on ‖ξ‖ alone; the rule in θ is then one node.
    well_places : ndarray, shape (n, 2)
        Places in wells, at which B is lower than around them: cells there are halved
        until they see them.

    Raises
    ------
    ValueError
        If B is NaN somewhere, or too rough for the quadrature.
    """
    rules = rules_for(isotropic)
    cells, known = _rings(value, rules)
    cells = _until(value, cells, rules, _ROUGH, _LADDER[0][0])
    if not _error(cells) <= _ROUGH:
        cells = _without_empty_rings(value, cells)
    if known and _falls(cells) >= _ENDLESS:
        return Normalisation(cells.reference, math.inf)
    cells = opened(value, _searched(value, cells, rules), well_places, rules)
    for most, aim in _LADDER:
        cells = _until(value, cells, rules, aim, most)
        if _error(cells) <= _aimed(cells, aim):
            break
    return _checked(cells, known)


def _rings(value: Value, rules: Rules) -> tuple[Cells, bool]:
    """The first cells, and whether B is known as far as the last ring."""
    radii = np.exp2(np.arange(_SMALLEST_POWER, _LARGEST_POWER + 1.0))
    edges = np.concatenate([[0.0], radii])
    rings = np.stack([edges[:-1], edges[1:]], axis=1)
    # Potentials often have a kink on the axes, where the quadrants are cut apart.
    n_parts = 1 if rules[1] is ONE_NODE else 4
    angles = np.arange(n_parts + 1) * (2 * math.pi / n_parts)
    sides = np.stack([angles[:-1], angles[1:]], axis=1)
    all_edges = np.concatenate(
        [np.repeat(rings, n_parts, axis=0), np.tile(sides, (len(rings), 1))], axis=1
    )
    cells = weighed(value, all_edges, rules, math.inf)
    bad = np.flatnonzero(np.isnan(cells.integral))
    if not bad.size:
        return cells, True
    first = all_edges[bad, 0].min()
    inside = cells.chosen(all_edges[:, 1] <= first)
    total = inside.integral.sum()
    outermost = inside.edges[:, 1] > first * 2.0 ** (0.5 - _N_LIGHT_RINGS)
    if not inside.bound[outermost].sum() <= _NEGLIGIBLE * total:
        raise ValueError(
            f"`value` must be a number, got NaN at radius {first:g} or beyond."
        )
    return inside, False


def _until(value: Value, cells: Cells, rules: Rules, aim: float, most: int) -> Cells:
    """Halve the worst cells until the error is below the aim, or there are too many."""
    n = len(cells)
    while n < most and not _error(cells) <= _aimed(cells, aim):
        order = np.argsort(cells.error)
        left = np.cumsum(cells.error[order])
        allowed = 0.5 * _aimed(cells, aim) * cells.integral.sum()
        # All but those small ones whose errors together may stay.
        worst = order[left > allowed]
        room = max(64, most - n)
        worst = worst[-room:]
        cells = refined(value, cells, worst, rules)
        _require_numbers(cells)
        n += len(worst)
    return cells


def _without_empty_rings(value: Value, cells: Cells) -> Cells:
    """Leave out rings that cells cannot bound but whose valleys are nowhere low."""
    total = float(cells.integral.sum())
    for number in range(_LARGEST_POWER - _SMALLEST_POWER + 1):
        ring = _ring_of(cells) == number
        if not ring.any() or cells.error[ring].sum() <= _NEGLIGIBLE * total:
            continue
        inner = 2.0 ** (number + _SMALLEST_POWER - 1)
        depth = cells.reference - lowest_in_ring(value, inner)
        if depth + math.log(4 * math.pi * inner**2) <= math.log(_NEGLIGIBLE * total):
            cells = cells.chosen(~ring)
    return cells


def _require_numbers(cells: Cells) -> None:
    bad = np.isnan(cells.integral)
    if bad.any():
        r0, r1 = cells.edges[bad, 0].min(), cells.edges[bad, 1].min()
        raise ValueError(
            f"`value` must be a number, got NaN at radius {r0:g} to {r1:g}."
        )


def _aimed(cells: Cells, aim: float) -> float:
    """The aim, or what is left of B after rounding if that is more."""
    return max(aim, 8 * _EPS * abs(cells.reference))


def _error(cells: Cells) -> float:
    total = float(cells.integral.sum())
    return float(cells.error.sum()) / total if total > 0 else math.inf


def _by_ring(cells: Cells) -> Array:
    """Integrals over the rings between 2^k and 2^{k+1}."""
    n_rings = _LARGEST_POWER - _SMALLEST_POWER + 1
    rings = np.bincount(_ring_of(cells), cells.integral, n_rings)
    return np.asarray(rings, dtype=np.float64)


def _ring_of(cells: Cells) -> NDArray[np.int64]:
    """Numbers of the rings from inside; 0 is the disc in their middle."""
    middle = 0.5 * (cells.edges[:, 0] + cells.edges[:, 1])
    power = np.maximum(np.floor(np.log2(middle)), _SMALLEST_POWER - 1)
    return (power - (_SMALLEST_POWER - 1)).astype(np.int64)


def _falls(cells: Cells) -> float:
    """Ratio of the last ring to the one before; zero if it weighs nothing."""
    rings = _by_ring(cells)
    if rings[-1] <= _NEGLIGIBLE * rings.sum():
        return 0.0
    return float(rings[-1] / rings[-2]) if rings[-2] > 0 else math.inf


def _searched(value: Value, cells: Cells, rules: Rules) -> Cells:
    """Cells small enough about the size of the pattern to find wells in flat places."""
    while True:
        r0, r1, a0, a1 = cells.edges.T
        size = _median_radius(cells)
        near = (r1 > size / 2.0**_INWARDS) & (r0 < size * 2.0**_OUTWARDS) & (r0 > 0)
        isotropic = rules[1] is ONE_NODE
        long = near & (r1 - r0 > (_ISOTROPIC_SIDE if isotropic else _SIDE) * r0)
        wide = near & (a1 - a0 > _ANGLE) & (not isotropic)
        if not (long | wide).any():
            return cells
        axis = np.where(long, 0, 1)
        chosen = long | wide
        cells.axis[chosen] = axis[chosen]
        cells = refined(value, cells, chosen, rules)
        _require_numbers(cells)


def _median_radius(cells: Cells) -> float:
    order = np.argsort(cells.edges[:, 1])
    share = np.cumsum(cells.integral[order])
    return float(cells.edges[order[np.searchsorted(share, 0.5 * share[-1])], 1])


def _checked(cells: Cells, known: bool) -> Normalisation:
    tail, tail_error = _tail(cells) if known else (0.0, 0.0)
    if math.isinf(tail):
        return Normalisation(cells.reference, math.inf)
    total = float(cells.integral.sum()) + tail
    error = (float(cells.error.sum()) + tail_error) / total
    error += _EPS * (abs(cells.reference) + _distance_in_cells(cells))
    if not error <= _ALLOWED:
        raise ValueError(
            f"`value` must allow to integrate exp(-B), got {total:g} times its "
            f"largest value with error {error:.2g} of it; smooth B, scale it, or move "
            "its minimum to the origin."
        )
    heavy = cells.bound > 1e-20 * total
    return Normalisation(
        cells.reference, total, error, tail / total, cells.edges[heavy]
    )


def _distance_in_cells(cells: Cells) -> float:
    """Mean distance in units of the cells: places far out are rounded by that much."""
    r0, r1, a0, a1 = cells.edges.T
    side = np.minimum(r1 - r0, r1 * (a1 - a0))
    total = float(cells.integral.sum())
    return float(cells.integral @ (r1 / side)) / total


def _tail(cells: Cells) -> tuple[float, float]:
    """Integral beyond the last ring and its error, from how the rings fall."""
    rings, fall = _by_ring(cells), _falls(cells)
    if fall == 0.0:
        return 0.0, 0.0
    if fall >= _ENDLESS:
        return math.inf, 0.0
    before = float(rings[-2] / rings[-3])
    tail = float(rings[-1]) * fall / (1 - fall)
    error = float(rings[-1]) * abs(fall - before) / (1 - fall) ** 2
    return tail, error
