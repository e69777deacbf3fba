"""Relative entropy of a smooth fibre to its own stationary density."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import diagnostics, initial

MODEL = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.1, 2.0)
# Five deviations of κ, 2/√0.2, and five and a half of ξ.
GRID = fp.SmoothPhaseSpaceGrid(5.5, 23.0, (24, 24, 16, 18))
DS = 0.25
SCHEME = fp.smooth_drift_kick(MODEL, GRID)


@pytest.fixture(scope="module")
def steady():
    return fp.steady_state(SCHEME, ds=DS, tolerance=1e-9, error_tolerance=0.5)


@pytest.fixture(scope="module")
def gap():
    return fp.spectral_gap(MODEL)


@pytest.fixture(scope="module")
def run(steady):
    start = initial.with_curvature(
        initial.gaussian(GRID.phase_space, (0.8, -0.4), 0.8),
        GRID,
        MODEL.curvature_variance,
    )
    return fp.solve(SCHEME, start, (0.0, 20.0), DS, reference=steady.density)


def test_a_run_tends_to_the_stationary_density_of_its_step(steady, run):
    # What steps go on from is 0.03 away: κ is corrected where it is read. e^{−0.27 s}
    # of the start is left, at s = 20 a share of 4e-3 of its distance of 0.9.
    assert diagnostics.l1_distance(run.final, steady.density, GRID) < 6e-3
    evolved = steady.density - SCHEME.correction_of(steady.density, DS)
    assert diagnostics.l1_distance(evolved, steady.density, GRID) > 0.02


def test_a_run_from_the_stationary_density_returns_to_it(steady):
    # Its curvature is corrected twice in the first steps, which moves the others by a
    # share of R, here 0.17 of what the splitting is off. That decays with the rest.
    again = fp.solve(SCHEME, steady.density, (0.0, 8.0), DS, save_at=[1.0, 8.0])
    first, last = (
        diagnostics.l1_distance(p, steady.density, GRID) for p in again.densities
    )
    assert first < 0.4 * steady.splitting["density"]
    assert last < first / 4


def test_the_entropy_falls_all_the_way(run):
    assert run.relative_entropy[0] > 0.4
    assert np.diff(run.relative_entropy).max() < 0
    # To zero: no floor of another density, e^{−0.54 s}.
    assert 0 < run.relative_entropy[-1] < 2e-5


def test_the_entropy_decays_at_twice_the_gap(run, gap):
    # From s = 9 on what decays faster has a share of e^{−0.5 s} and less. The rate is
    # that of the splitting: of order 2 in ds. Twice the gap of R = 0 is 0.561.
    for begin, end in ((9.0, 11.0), (15.0, 20.0)):
        first, last = run.relative_entropy[np.searchsorted(run.s, [begin, end])]
        rate = np.log(first / last) / (end - begin)
        assert rate == pytest.approx(2 * gap, rel=5e-3)


def test_what_a_reference_has_below_zero_counts_as_zero(steady, run):
    # Ripples of the tails: 3.6e-8, of a density of 1.8e-3 at most.
    assert steady.density.min() < 0
    assert np.array_equal(run.reference, np.maximum(steady.density, 0.0))
    entropy = diagnostics.relative_entropy(run.final, GRID, run.reference)
    assert entropy == run.relative_entropy[-1]
    # One angle in sixteen with a tenth of its mass below zero.
    spoilt = steady.density.copy()
    spoilt[:, :, 0] *= -0.1
    message = r"Below zero may be 0.001 of the mass.*np.maximum\(reference, 0.0\)"
    with pytest.raises(ValueError, match=message):
        fp.solve(SCHEME, steady.density, (0.0, DS), DS, reference=spoilt)


def test_the_derivative_of_the_gap_at_r_zero_leads_to_this_gap(gap):
    limit = fp.spectral_gap(MODEL.white_noise_limit)
    slope = fp.studies.gap_slope(MODEL)
    # The rest is O(R²): 0.15 R².
    assert limit + 0.1 * slope == pytest.approx(gap, abs=2e-3)
