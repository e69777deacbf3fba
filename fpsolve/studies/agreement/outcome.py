"""One test of a density against paths, and what it found."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["MARGINALS", "AgreementTest"]

MARGINALS = ("xi1", "xi2", "alpha")


@dataclass(frozen=True)
class AgreementTest:
    """One test at one arclength.

    Attributes
    ----------
    s : float
    name : str
        "coarse cells", "cells" and "largest cell" (histogram over phase space),
        "marginal xi1", "marginal xi2", "marginal alpha", or the name of a moment.
    statistic : float
        χ² of cells and the marginals, largest |z| of "largest cell", z of a moment.
    critical : float
        |statistic| from which on the test disagrees.
    p_value, threshold : float
        The test disagrees when the p-value is below the threshold.
    detectable : float
        Smallest disagreement that is seen with probability 0.99: an L1 distance of
        χ² tests, a relative error of one cell, a shift of a moment.
    difference : float
        The disagreement found, in the unit of `detectable`; for χ² tests the excess
        √(max(χ² − k + 1, 0)/N), zero when there is none.
    step_error : float
        Estimated step error of density and paths together, in the unit of
        `detectable`; NaN where nothing is known of it.
    grid_error : float
        Estimated error of the density's grid, in the unit of `detectable`; the test
        allows for it. NaN where nothing is known of it.
    degrees : int or None
        Degrees of freedom of χ², number of cells of "largest cell".
    density, paths, standard_error : float
        Both values of a moment and the standard error of that of the paths; NaN for
        the other tests.
    """

    s: float
    name: str
    statistic: float
    critical: float
    p_value: float
    threshold: float
    detectable: float
    difference: float
    step_error: float = math.nan
    degrees: int | None = None
    density: float = math.nan
    paths: float = math.nan
    standard_error: float = math.nan
    grid_error: float = math.nan

    @property
    def agrees(self) -> bool:
        """Whether the p-value reaches the threshold; a NaN does not."""
        return self.p_value >= self.threshold

    @property
    def may_be_step_error(self) -> bool:
        """Whether the difference is at most twice the estimated step error."""
        return abs(self.difference) <= 2 * self.step_error

    @property
    def blurred(self) -> bool:
        """Whether step errors are more than a tenth of what would be detected."""
        return self.step_error > 0.1 * self.detectable
