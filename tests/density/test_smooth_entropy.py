"""Relative entropy of a smooth fibre to its own stationary density."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import initial

MODEL = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.1, 2.0)
# Five deviations of κ, 2/√0.2, and five and a half of ξ.
GRID = fp.SmoothPhaseSpaceGrid(5.5, 23.0, (24, 24, 16, 18))
DS = 0.25
# Of the generator, by an expansion in its own frame, at R = 0.1 and A = 2.
GAP = 0.27110266


@pytest.fixture(scope="module")
def run():
    scheme = fp.smooth_drift_kick(MODEL, GRID)
    steady = fp.steady_state(scheme, ds=DS, tolerance=1e-9, error_tolerance=0.5)
    # What is iterated is the density before the curvature is corrected; one step on it
    # is the one that a run tends to. Where it is below rounding it may be negative.
    kept = fp.solve(scheme, steady.density, (0.0, DS), DS).final
    reference = np.maximum(kept, 1e-8 * kept.max())
    start = initial.with_curvature(
        initial.gaussian(GRID.phase_space, (0.8, -0.4), 0.8),
        GRID,
        MODEL.curvature_variance,
    )
    return fp.solve(scheme, start, (0.0, 14.0), DS, reference=reference)


def test_the_entropy_falls_all_the_way(run):
    assert run.relative_entropy[0] > 0.4
    assert np.diff(run.relative_entropy).max() < 0


def test_the_entropy_decays_at_twice_the_gap(run):
    # From s = 9 on what decays faster has a share of e^{−0.5 s} and less. The rate is
    # that of the splitting: of order 2 in ds. Twice the gap of R = 0 is 0.561.
    at = np.searchsorted(run.s, [9.0, 11.0])
    first, last = run.relative_entropy[at]
    assert np.log(first / last) / 2 == pytest.approx(2 * GAP, rel=5e-3)


def test_the_derivative_of_the_gap_at_r_zero_leads_to_this_gap():
    limit = fp.spectral_gap(MODEL.white_noise_limit)
    slope = fp.studies.gap_slope(MODEL)
    # The rest is O(R²): 0.15 R².
    assert limit + 0.1 * slope == pytest.approx(GAP, abs=2e-3)
