"""Wells that a grid meets and Z does not count: what is computed with Z is refused."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.partition import Normalisation, normalisation_of
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadrature import rules_for
from fpsolve.model.potentials.wells import check_places, unseen

__all__ = ["check_wells_met"]

# So many of the deepest places are compared with what the quadrature saw.
_MOST = 64
# A place matters if a well of a thousandth of the pattern, or of its distance squared,
# would weigh more than this share of all.
_WEIGHT = 1e-6


def check_wells_met(
    potential: Potential, xi1: ArrayLike, xi2: ArrayLike, value: Array | None = None
) -> None:
    """Raise ValueError if B has a well at one of the points that Z does not count.

    The quadrature of Z sees B at its nodes only. The lowest of the points, on a grid
    the 64 deepest that are lower than their neighbours, are second opinions: where B is
    lower than at the nodes around, Z is computed again with cells that see the place,
    and must be the same within the errors of both.

    Parameters
    ----------
    potential : Potential
        With a finite Z; one whose Z is known in closed form is not checked.
    xi1, xi2 : array_like
        Points, for instance ``grid.plane()``.
    value : ndarray, optional
        B there, if it is known already.
    """
    if potential.has_closed_form or not potential.normalisable:
        return
    if value is None:
        value = potential.value(xi1, xi2)
    found = potential.normalisation
    places = _deep(xi1, xi2, value, found)
    if found.edges is not None and len(places):
        rules = rules_for(potential.isotropic)
        places = places[unseen(potential.value, found.edges, places, rules)]
    if len(places):
        _compare(potential, found, places)


def _deep(xi1: ArrayLike, xi2: ArrayLike, value: Array, found: Normalisation) -> Array:
    """Points where a well may lie that counts, the deepest first; shape (n, 2)."""
    full1, full2 = np.broadcast_arrays(xi1, xi2)
    value = np.broadcast_to(value, full1.shape)
    pattern = found.integral / (2 * np.pi)
    with np.errstate(over="ignore", under="ignore"):
        weight = np.exp(found.lowest - value)
        weight = weight * np.maximum(full1**2 + full2**2, pattern) / found.integral
    chosen = weight > _WEIGHT
    if value.ndim == 2:
        chosen &= _lowest_around(value)
    at = np.flatnonzero(chosen)
    at = at[np.argsort(value.ravel()[at], kind="stable")][:_MOST]
    return np.stack([full1.ravel()[at], full2.ravel()[at]], axis=1).astype(np.float64)


def _lowest_around(value: Array) -> NDArray[np.bool_]:
    """Where B is lower than at the eight neighbours; one place of a level piece."""
    padded = np.pad(value, 1, constant_values=np.inf)
    n1, n2 = value.shape
    lowest = np.ones(value.shape, dtype=bool)
    for i in (0, 1, 2):
        for j in (0, 1, 2):
            other = padded[i : i + n1, j : j + n2]
            if (i, j) < (1, 1):
                lowest &= value < other
            elif (i, j) > (1, 1):
                lowest &= value <= other
    return lowest


def _compare(potential: Potential, found: Normalisation, places: Array) -> None:
    known = check_places("well_places", potential.well_places)
    again = normalisation_of(
        potential.value, potential.isotropic, np.concatenate([known, places])
    )
    missed = float(np.expm1(again.log_value - found.log_value))
    if abs(missed) <= found.error + again.error:
        return
    depth = potential.value(*places.T)
    at = int(np.argmin(depth))
    xi1, xi2 = places[at]
    raise ValueError(
        "Z of `potential` must count every well, got one at about "
        f"xi = ({xi1:.6g}, {xi2:.6g}), B = {depth[at]:.4g}, between the nodes of its "
        f"quadrature: exp(-B) has an integral of {1 + missed:.6g} times the one found "
        "without it; name the place, `well_places=[(xi1, xi2)]` of the potential."
    )
