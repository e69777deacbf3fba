"""Cells of a histogram, tests of counts, and how much such a test can see."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import special, stats

import fpsolve as fp
from fpsolve.studies.agreement.cell_probabilities import (
    cell_averages,
    cell_probabilities,
)
from fpsolve.studies.agreement.goodness_of_fit import (
    POWER,
    chi_square,
    largest_deviation,
    z_score,
)
from fpsolve.studies.agreement.partition import (
    ELSEWHERE,
    equal_probability_bins,
    equal_probability_boxes,
)

GRID = fp.PhaseSpaceGrid(5.5, (48, 48, 32))
# Multinomial counts are drawn for these, none of them small.
SHARES = np.linspace(1.0, 3.0, 40) / np.linspace(1.0, 3.0, 40).sum()


def gaussian_density():
    return fp.initial.gaussian(GRID, (1.0, 0.5), 0.3, math.pi / 2, 2.0)


# Probabilities of cells


def gaussian_cells(edges, mean, variance):
    scaled = (edges - mean) / math.sqrt(2 * variance)
    return np.diff(special.erf(scaled)) / 2


def test_cell_probabilities_are_the_integrals_of_a_resolved_density():
    p = gaussian_density()
    d1, _, d3 = GRID.spacing
    edges = -5.5 + d1 * np.arange(49)
    along1 = gaussian_cells(edges, 1.0, 0.3)
    along2 = gaussian_cells(edges, 0.5, 0.3)
    # Gauss-Legendre with eight points integrates the von Mises density to rounding.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    angles = GRID.alpha[:, None] + nodes * d3 / 2
    values = np.exp(2.0 * np.cos(angles - math.pi / 2)) / (2 * np.pi * special.i0(2.0))
    around = (values * weights).sum(axis=1) * d3 / 2
    exact = along1[:, None, None] * along2[None, :, None] * around
    found = cell_probabilities(p, GRID)
    # The Gaussian is cut off by aliasing at exp(-(π σ/d)²/2) = 2e-12 of its peak;
    # the largest cell has probability 3e-3.
    assert np.abs(found - exact).max() < 1e-13
    # The midpoint rule, in comparison, misses 1e-2 of the largest cell.
    midpoint = p * GRID.cell_volume
    assert np.abs(midpoint - exact).max() > 5e-3 * exact.max()


@pytest.mark.parametrize("shape", [(4, 6, 8), (5, 7, 9)])
def test_averages_over_cells_keep_the_total_and_constants(shape, rng):
    p = rng.random(shape)
    assert cell_averages(p).sum() == pytest.approx(p.sum(), rel=1e-13)
    np.testing.assert_allclose(cell_averages(np.ones(shape)), 1.0, rtol=1e-13)


def test_the_average_of_a_wave_is_its_value_times_sinc():
    n = 12
    x = (np.arange(n) + 0.5) * 2 * np.pi / n
    p = np.cos(3 * x)[:, None, None] * np.ones((1, 4, 4))
    factor = math.sin(3 * np.pi / n) / (3 * np.pi / n)
    np.testing.assert_allclose(cell_averages(p), factor * p, atol=1e-14)


# Coarse cells


def test_boxes_have_nearly_the_same_probability_and_the_tails_their_own():
    probabilities = cell_probabilities(gaussian_density(), GRID)
    labels = equal_probability_boxes(probabilities, 128, 25 / 100_000)
    sums = np.bincount(labels.ravel(), probabilities.ravel())
    assert sums.size == 129
    # Columns are added to the tails until they have 1e-3.
    assert 1e-3 <= sums[ELSEWHERE] < 1.2e-3
    # Boxes are cut between fine cells, of which a side has three or more: a half has
    # at least a third, and a second cut along an axis is finer relative to the density.
    assert sums[1:].min() > 0.3 / 128
    assert sums[1:].max() < 2.0 / 128


def test_boxes_are_never_too_small_to_be_tested():
    probabilities = cell_probabilities(gaussian_density(), GRID)
    labels = equal_probability_boxes(probabilities, 4096, 0.005)
    sums = np.bincount(labels.ravel(), probabilities.ravel())
    assert sums.min() >= 0.005
    assert sums.size < 200


def test_a_density_in_one_column_is_a_single_cell_of_tails():
    # Nothing is left to be halved, and nothing breaks.
    probabilities = np.zeros((4, 4, 4))
    probabilities[1, 2] = 0.25
    labels = equal_probability_boxes(probabilities, 8, 1e-3)
    assert labels[1, 2].tolist() == [ELSEWHERE] * 4


@settings(max_examples=60, deadline=None)
@given(
    arrays(np.float64, st.integers(1, 40), elements=st.floats(0.0, 1.0)),
    st.integers(1, 20),
    st.floats(0.0, 0.5),
)
def test_bins_join_neighbours_and_are_large_enough(weights, most, least):
    total = weights.sum()
    if total < 1e-3:
        return
    shares = weights / total
    labels = equal_probability_bins(shares, most, least)
    assert np.all(np.isin(np.diff(labels), (0, 1)))
    sums = np.bincount(labels, shares)
    assert sums.size <= most
    # A single bin is all there can be where the least is not to be had twice.
    assert sums.size == 1 or sums.min() >= least - 1e-12


# Tests of goodness of fit


def test_the_chi_square_statistic_is_pearsons(rng):
    counts = rng.multinomial(10_000, SHARES)
    outcome = chi_square(counts, SHARES, 1e-3)
    expected = stats.chisquare(counts, 10_000 * SHARES)
    assert outcome.statistic == pytest.approx(expected.statistic, rel=1e-12)
    assert outcome.p_value == pytest.approx(expected.pvalue, rel=1e-9)
    assert outcome.degrees == 39
    assert stats.chi2.sf(outcome.critical, 39) == pytest.approx(1e-3)


def test_one_cell_cannot_disagree():
    outcome = chi_square(np.array([7]), np.array([1.0]), 1e-3)
    assert outcome.p_value == 1.0
    assert outcome.detectable == math.inf


def test_a_density_at_the_detectable_distance_is_detected_with_that_power(rng):
    size, n_paths = 1e-3, 20_000
    distance = chi_square(rng.multinomial(n_paths, SHARES), SHARES, size).detectable
    # Half of the cells gain what the others lose, relatively the same everywhere:
    # then Σ (q' - q)²/q = (Σ |q' - q|)² and the distance is the smallest that is
    # detected with that probability.
    sign = np.where(np.arange(40) % 2 == 0, 1.0, -1.0)
    sign[sign > 0] *= SHARES[sign < 0].sum() / SHARES[sign > 0].sum()
    away = SHARES * sign
    away *= distance / math.sqrt((away**2 / SHARES).sum())
    runs = rng.multinomial(n_paths, SHARES + away, size=1000)
    power = np.mean([chi_square(run, SHARES, size).p_value < size for run in runs])
    # Four standard errors of the measured rate are 0.013.
    assert power == pytest.approx(POWER, abs=0.013)


def test_the_largest_deviation_raises_no_more_false_alarms_than_it_may(rng):
    size = 0.05
    runs = rng.multinomial(3000, SHARES, size=1500)
    rate = np.mean(
        [largest_deviation(run, SHARES, size).p_value < size for run in runs]
    )
    # Bonferroni and discrete counts make the rate smaller, not larger than 0.05; four
    # standard errors of the measured rate are 0.023.
    assert 0.01 < rate < 0.073


def test_the_largest_deviation_names_the_cell_that_is_off():
    counts = np.round(10_000 * SHARES).astype(int)
    counts[7] += 200
    outcome = largest_deviation(counts, SHARES, 1e-3)
    expected = 10_200 * SHARES[7]
    z = (counts[7] - expected) / math.sqrt(expected * (1 - SHARES[7]))
    assert outcome.statistic == pytest.approx(z, rel=1e-12)
    assert outcome.p_value < 1e-10
    assert outcome.degrees == 40


def test_a_shift_of_a_mean_is_detected_with_that_power(rng):
    outcome = z_score(0.3, 0.1, 0.1, 1e-3)
    assert outcome.statistic == pytest.approx(2.0)
    assert outcome.p_value == pytest.approx(2 * stats.norm.sf(2.0))
    shifted = rng.normal(outcome.detectable, 0.1, 2000)
    power = np.mean([z_score(one, 0.0, 0.1, 1e-3).p_value < 1e-3 for one in shifted])
    # Four standard errors are 0.009.
    assert power == pytest.approx(POWER, abs=0.009)


def test_without_spread_only_rounding_is_forgiven():
    assert z_score(1.0 + 1e-14, 1.0, 0.0, 1e-3).p_value == 1.0
    assert z_score(1.01, 1.0, 0.0, 1e-3).p_value == 0.0
