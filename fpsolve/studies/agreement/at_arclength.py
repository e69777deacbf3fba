"""Density and paths at one s: counts, probabilities, and the tests between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.density.solution import Solution
from fpsolve.density.steady_state import SteadyState
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.studies.agreement.cell_probabilities import cell_probabilities
from fpsolve.studies.agreement.coarser import within_error
from fpsolve.studies.agreement.goodness_of_fit import (
    Outcome,
    chi_square,
    largest_deviation,
    z_score,
)
from fpsolve.studies.agreement.outcome import MARGINALS, AgreementTest
from fpsolve.studies.agreement.partition import (
    ELSEWHERE,
    equal_probability_bins,
    equal_probability_boxes,
)
from fpsolve.studies.agreement.reference import MOMENTS, reference_at
from fpsolve.studies.agreement.steps import step_bias

if TYPE_CHECKING:
    from fpsolve.paths.result import Paths

__all__ = ["TESTS_PER_STATION", "Station"]

Counts = NDArray[np.int64]

# Counts expected in every cell of a chi-square test: its law is then accurate far
# into the tails.
LEAST_COUNT = 25
MOST_BINS = 32
# A test of fewer, larger cells sees smaller differences of large scale.
COARSENING, FEWEST_BOXES = 16, 8
TESTS_PER_STATION = 3 + len(MARGINALS) + len(MOMENTS)


class Station:
    """Both answers at one s, on the cells of the grid."""

    def __init__(
        self,
        density: Solution | SteadyState,
        paths: Paths,
        s: float,
        size: float,
        cells: int,
        coarser: Sequence[Solution] = (),
    ) -> None:
        self.s, self.size, self.cells = s, size, cells
        self.reference = reference_at(density, s)
        self.probabilities = cell_probabilities(self.reference.density, density.grid)
        self.other: Array | None = None
        self.other_moments: dict[str, float] | None = None
        if coarser:
            self._allow_for(density.grid, coarser)
        histogram = paths.histogram(density.grid, s)
        self.counts: Counts = np.asarray(histogram.counts)
        self.outside, self.n_paths = int(histogram.outside), paths.n_paths
        self.values = {name: _at(paths, name, s) for name in MOMENTS}
        self.bias_factor = _bias_factor(density, paths)
        self.line_probabilities = _lines(self.probabilities)
        self.line_counts = _lines(self.counts)

    def tests(self) -> Iterator[AgreementTest]:
        """Yield every test of this s."""
        yield from self._tests_of_cells()
        for which in MARGINALS:
            yield self._test_of_line(which)
        for name in MOMENTS:
            yield self._test_of_moment(name)

    def _allow_for(self, grid: PhaseSpaceGrid, coarser: Sequence[Solution]) -> None:
        """Probabilities and moments as far off as the grid's error may take them."""
        error = within_error(self.reference.density, grid, self.s, coarser)
        moments = reference_at(coarser[0], self.s).moments
        self.other = self.probabilities + error.cells
        self.other_moments = {
            name: value + error.factor * (moments[name] - value)
            for name, value in self.reference.moments.items()
        }

    def _tests_of_cells(self) -> Iterator[AgreementTest]:
        boxes = self._boxes(max(FEWEST_BOXES, self.cells // COARSENING))
        yield self._of_counts("coarse cells", *boxes)
        boxes = self._boxes(self.cells)
        yield self._of_counts("cells", *boxes)
        counts, probabilities, error = boxes
        outcome = largest_deviation(counts, probabilities, self.size, error)
        off = (
            math.nan if error is None else float(np.max(np.abs(error / probabilities)))
        )
        yield self._row("largest cell", outcome, difference=math.nan, grid_error=off)

    def _boxes(self, most: int) -> tuple[Counts, Array, Array | None]:
        """Counts, probabilities and their errors of boxes and tails.

        What left the grid belongs to the tails, of which the density knows all that
        is not in a box.
        """
        least = LEAST_COUNT / self.n_paths
        labels = equal_probability_boxes(self.probabilities, most, least).ravel()
        probabilities = _with_tails(labels, self.probabilities)
        error = None
        if self.other is not None:
            error = _with_tails(labels, self.other) - probabilities
        counts = _summed(labels, self.counts).astype(np.int64)
        counts[ELSEWHERE] += self.outside
        return counts, probabilities, error

    def _test_of_line(self, which: str) -> AgreementTest:
        """χ² of a marginal, given that a path is inside of the box."""
        share = self.line_probabilities[which] / self.line_probabilities[which].sum()
        counts = self.line_counts[which]
        least = LEAST_COUNT / max(1, int(counts.sum()))
        labels = equal_probability_bins(share, MOST_BINS, least)
        error = None
        if self.other is not None:
            other = _lines(self.other)[which]
            error = _summed(labels, other / other.sum() - share)
        summed = _summed(labels, counts).astype(np.int64)
        return self._of_counts(
            f"marginal {which}", summed, _summed(labels, share), error
        )

    def _of_counts(
        self, name: str, counts: Counts, probabilities: Array, error: Array | None
    ) -> AgreementTest:
        outcome = chi_square(counts, probabilities, self.size, error)
        # χ² scatters about its degrees of freedom when there is nothing to find.
        excess = max(outcome.statistic - (outcome.degrees or 0), 0.0)
        off = math.nan
        if error is not None:
            # At least the L1 distance, and what the test goes by.
            off = math.sqrt(float((error**2 / probabilities).sum()))
        return self._row(
            name,
            outcome,
            difference=math.sqrt(excess / self.n_paths),
            step_error=self._with_bias(
                self.reference.distance, self.reference.half_step_distance
            ),
            grid_error=off,
        )

    def _test_of_moment(self, name: str) -> AgreementTest:
        value, error = self.values[name]
        expected = self.reference.moments[name]
        off = math.nan
        if self.other_moments is not None:
            off = abs(self.other_moments[name] - expected)
        allowed = 0.0 if math.isnan(off) else off
        return self._row(
            name,
            z_score(value, expected, error, self.size, allowed),
            difference=value - expected,
            step_error=self._with_bias(
                self.reference.errors[name], self.reference.half_step_errors[name]
            ),
            density=expected,
            paths=value,
            standard_error=error,
            grid_error=off,
        )

    def _with_bias(self, error: float, half_step: float) -> float:
        return error + half_step * self.bias_factor

    def _row(self, name: str, outcome: Outcome, **more: Any) -> AgreementTest:
        return AgreementTest(
            s=self.s, name=name, threshold=self.size, **outcome._asdict(), **more
        )


def _bias_factor(density: Solution | SteadyState, paths: Paths) -> float:
    """Bias of the paths relative to the density's error; NaN for other splittings."""
    if paths.method != "splitting" or not isinstance(paths.model, LayDownModel):
        return math.nan
    return step_bias(float(paths.ds), density.ds, 1.0)


def _at(paths: Paths, name: str, s: float) -> tuple[float, float]:
    """A moment of the paths at s, and its standard error."""
    place = int(np.argmin(np.abs(np.asarray(paths.s) - s)))
    values, errors = paths.moments()[name]
    return float(values[place]), float(errors[place])


def _lines(cells: Any) -> dict[str, Any]:
    """Sums over all cells with the same ξ1, ξ2 or α."""
    axes = {"xi1": (1, 2), "xi2": (0, 2), "alpha": (0, 1)}
    return {which: cells.sum(axis=axes[which]) for which in MARGINALS}


def _with_tails(labels: NDArray[np.intp], cells: Array) -> Array:
    """Probabilities of boxes, and of the tails what is left of one."""
    probabilities = _summed(labels, cells)
    probabilities[ELSEWHERE] = 1.0 - probabilities[1:].sum()
    return probabilities


def _summed(labels: NDArray[np.intp], cells: Any) -> Array:
    """Sum over the cells with the same label; exact for counts below 2⁵³."""
    return np.asarray(np.bincount(labels, cells.ravel()), dtype=np.float64)
