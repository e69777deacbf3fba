"""Where a basis serves the stationary density, from small truncations of it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.sparse import csc_array

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.coupled import CoupledDiscretisation
from fpsolve.spectral.bases.placement import (
    Placement,
    first_placement,
    throwing_ranges,
)
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.coupled_inverse import CoupledInverse
from fpsolve.spectral.work import Work

__all__ = ["coupled_discretisation", "stationary_vector"]

# Degree of the truncation that places the basis.
DEGREE = 10
# A basis that has moved less, in units of its width, is where it should be; how often
# it may move; and the digits that are kept, so that rounding does not move it.
SETTLED, MOVES, DIGITS = 0.05, 8, 2


@lru_cache(maxsize=64)
def coupled_discretisation(model: SmoothLayDownModel) -> CoupledDiscretisation:
    """The basis of a model about its stationary density.

    The centre and the widths are moved to the mean and the variances that a small
    basis gives until they stay.

    Raises
    ------
    ToleranceError
        If they do not: the belt is too fast.
    """
    basis = CoupledDiscretisation(model, first_placement(model))
    truncation = basis.truncation_of(DEGREE)
    distance = math.inf
    for _ in range(MOVES):
        vector, _ = stationary_vector(basis, truncation)
        moved = moved_placement(basis, vector, truncation)
        distance = basis.placement.distance(moved)
        basis = replace(basis, placement=moved)
        if distance < SETTLED:
            return replace(basis, placement=rounded(moved))
    remedy = "choose a slower belt, or use `steady_state`: no basis is wide enough"
    raise ToleranceError(distance, SETTLED, remedy)


def moved_placement(
    basis: CoupledDiscretisation, vector: Array, truncation: Truncation
) -> Placement:
    """The placement about the density that a vector stands for."""
    moments = basis.stationary_moments(vector, truncation)
    variances = moments["variance_xi1"], moments["variance_xi2"]
    sigmas = throwing_ranges(basis.model)
    return basis.placement.about(moments["mean_xi1"], variances, sigmas)


def rounded(place: Placement) -> Placement:
    """Widths to two digits, and the centre to as much."""
    width1, width2 = (round_to(width, DIGITS) for width in place.widths)
    step = 10.0 ** (math.floor(math.log10(width1)) - DIGITS)
    centre = step * round(place.centre / step)
    return replace(place, centre=centre, widths=(width1, width2))


def round_to(value: float, digits: int) -> float:
    """The value with so many digits after the first."""
    return float(f"{value:.{digits}e}")


def stationary_vector(
    basis: CoupledDiscretisation, truncation: Truncation, work: Work | None = None
) -> tuple[Array, int]:
    """Coefficients of p with L* p = 0, the first one 1, and the entries of the factors.

    The first equation is left out for it: the sum of all of them, weighted by the
    coefficients of 1, vanishes.

    Raises
    ------
    ToleranceError
        If the couplings of the angular indices are too strong for the iteration.
    OutOfWork
        If it takes more work than allowed.
    """
    sector = basis.stationary_sector
    forward = csc_array(basis.matrix(sector, *truncation).T)
    offsets = np.maximum(basis.states(sector, truncation).offsets - 1, 0)
    inverse = CoupledInverse(csc_array(forward[1:, 1:]), offsets, work=work)
    rest = inverse.solve(-forward[1:, [0]].toarray()[:, 0])
    return np.concatenate([[1.0], rest]), inverse.entries
