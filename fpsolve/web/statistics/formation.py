"""The variation of a web in units of that of random straight fibres."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.web.statistics.estimate import Estimate
from fpsolve.web.statistics.jackknife import estimate
from fpsolve.web.statistics.zones import measured_zones, relative_variance

__all__ = ["STRAIGHT_FIBRES", "formation_number"]

# CV² m x of infinite straight fibres at random: 1/π times the mean of 1/|r - r'| over
# the pairs of points of the unit square, 4 ln(1 + √2) + 4 (1 - √2)/3.
STRAIGHT_FIBRES = 4 / math.pi * (math.log(1 + math.sqrt(2)) + (1 - math.sqrt(2)) / 3)


def formation_number(
    length_density: Any, pixel: float, zone: float, *, block: float | None = None
) -> Estimate:
    """F(x) = CV²(x)/CV₀²(x), CV₀² = 0.946402/(⟨m⟩ x) that of random straight fibres.

    The web compared with is a Poisson process of infinite lines of the same length
    per area, uniform in place and direction, for which the law is exact at every x. A
    fibre that curls within a zone adds up there, F > 1; F < 1 is more even than
    chance. F is a ratio of variances, not of their roots.

    Parameters
    ----------
    length_density : array
        Laid length per area, cross × machine direction, in the unit of `pixel`. Mass
        per area does not serve: the law counts fibres.
    pixel : float
        Side of a pixel.
    zone : float
        Side x of the zones.
    block : float, optional
        As for `coefficient_of_variation`.

    Returns
    -------
    Estimate

    Raises
    ------
    TypeError, ValueError
        As for `coefficient_of_variation`.

    References
    ----------
    [Deng94]_.
    """
    side, fields = measured_zones(length_density, pixel, zone)

    def formation(means: Array) -> Array:
        mean = means[..., 0] + means[..., 2]
        return np.asarray(relative_variance(means) * mean * side / STRAIGHT_FIBRES)

    return estimate(formation, fields, side, block)
