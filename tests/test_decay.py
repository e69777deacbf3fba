"""Decay rates fitted to a series."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import DecayingCirculation

from fpsolve.decay import fit_decay
from fpsolve.grids import PhaseSpaceGrid
from fpsolve.potentials import QuadraticPotential
from fpsolve.schemes import drift_kick
from fpsolve.solve import solve

S = np.linspace(0.0, 10.0, 101)


@given(rate=st.floats(0.01, 2.0), amplitude=st.floats(1e-3, 1e3))
def test_a_pure_exponential_is_fitted_exactly(rate, amplitude):
    found = fit_decay(S, amplitude * np.exp(-rate * S))
    # Rounding of logarithms of size 30 over a window of 5.
    assert found.rate == pytest.approx(rate, abs=1e-12)
    assert found.amplitude == pytest.approx(amplitude, rel=1e-10)
    # The root of one minus a squared correlation, which rounds to eps.
    assert found.standard_error <= 1e-7


def test_the_window_is_the_second_half_of_what_lies_above_noise():
    values = np.exp(-6.0 * S)
    assert fit_decay(S, np.exp(-S)).window == (5.0, 10.0)
    # e^{−6s} = 1e-14 at s = 5.37.
    start, stop = fit_decay(S, values).window
    assert stop == pytest.approx(5.3)
    assert start == pytest.approx(5.3 / 2)


def test_values_after_the_first_at_noise_level_are_not_trusted():
    values = np.exp(-S)
    values[30:] = 1e-15
    values[60:] = 1e-3
    assert fit_decay(S, values).window[1] == pytest.approx(S[29])


def test_a_given_window_is_used():
    # Two rates; the other one has a share of 2 % at s = 2 and of 0.6 % at s = 8.
    values = np.exp(-2.0 * S) + 1e-3 * np.exp(-0.5 * S)
    early = fit_decay(S, values, (0.0, 2.0))
    late = fit_decay(S, values, (8.0, 10.0))
    assert early.window == (0.0, 2.0)
    assert early.rate == pytest.approx(2.0, abs=0.03)
    assert late.rate == pytest.approx(0.5, abs=0.01)


def test_a_decay_that_bends_has_a_standard_error_that_says_so():
    bent = np.exp(-S) + 0.1 * np.exp(-0.3 * S)
    found = fit_decay(S, bent, (0.0, 6.0))
    # The slope runs from 0.94 to 0.34 on this window.
    assert found.standard_error > 0.05
    assert abs(found.rate - 0.3) < 0.5


@pytest.mark.parametrize(
    "values",
    [np.full_like(S, 1e-16), np.full_like(S, np.nan), np.full_like(S, -1.0)],
    ids=["noise", "NaN", "negative"],
)
def test_nothing_above_noise_cannot_be_fitted(values):
    with pytest.raises(ValueError, match=r"at least 5 values above 1e-14, got 0 in"):
        fit_decay(S, values)


def test_a_window_with_too_few_values_is_refused():
    with pytest.raises(ValueError, match=r"got 3 in \[1, 1\.25\]; record more steps"):
        fit_decay(S, np.exp(-S), (1.0, 1.25))


@pytest.mark.parametrize("noise", [0.8, 1.5])
def test_the_entropy_of_the_exact_circulation_decays_at_its_rate(noise):
    # h − 1 = q e^{−Ds} G, so H ≈ ½ ∫ p_S (h − 1)² ∝ e^{−2Ds} = e^{−A²s} once it is
    # small; ln(1 + x) beyond the square is (q G)² ≤ 1 % of it here.
    problem = DecayingCirculation(
        QuadraticPotential(), noise, PhaseSpaceGrid(6.0, (32, 32, 16)), share=0.1
    )
    scheme = drift_kick(problem.model, problem.grid, balanced=True)
    solution = solve(scheme, problem.initial(), (0.0, 4.0), 0.1)
    found = solution.entropy_rate()
    # ds² of the splitting.
    assert found.rate == pytest.approx(noise**2, rel=1e-2)
    assert found.standard_error < 1e-2
