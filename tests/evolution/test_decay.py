"""Decay rates fitted to a series."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from problems import DecayingCirculation

from fpsolve import initial
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.evolution.decay import fit_decay, hidden_error
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, QuadraticPotential

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


TRUE_RATE = 0.5
# What else a series may hold, relative to e^{−λs}.
COMPANY = {
    "a faster mode": lambda s, share: share * np.exp(-0.2 * s),
    "a much faster mode": lambda s, share: share * np.exp(-1.0 * s),
    "an oscillation": lambda s, share: share / (1 + share) * np.cos(1.3 * s + 1.0),
    "a slow oscillation": lambda s, share: share / (1 + share) * np.cos(0.4 * s),
    "two of them": lambda s, share: (
        share * np.exp(-0.3 * s) * (1 + 0.5 * np.cos(0.9 * s))
    ),
}


@pytest.mark.parametrize("company", COMPANY)
@pytest.mark.parametrize("share", [0.1, 1.0, 10.0])
def test_the_error_covers_the_rate_of_the_slowest_exponential(company, share):
    # The faster part may be what a line follows: only the errors are asked to be right.
    s = np.linspace(0.0, 20.0, 161)
    values = np.exp(-TRUE_RATE * s) * (1 + COMPANY[company](s, share))
    found = fit_decay(s, values)
    # By its scatter and its bend alone a line is off by up to 4.7 errors here.
    assert abs(found.rate - TRUE_RATE) <= 2 * found.standard_error


@pytest.mark.parametrize("level", [1e-9, 1e-7, 1e-5, 1e-3])
def test_a_series_that_levels_off_is_fitted_above_its_level(level):
    # ½‖x + y‖² with ‖x‖ ~ e^{−λs/2}: both squares and their product.
    s = np.linspace(0.0, 60.0, 301)
    decay = np.exp(-TRUE_RATE * s)
    values = decay + level + 2 * 0.7 * np.sqrt(level * decay)
    found = fit_decay(s, values)
    assert found.window[1] < s[values > 99 * level][-1] + 0.3
    assert abs(found.rate - TRUE_RATE) <= 2 * found.standard_error


def test_a_rate_that_is_not_resolved_comes_with_what_would_resolve_it():
    flat = fit_decay(S, np.exp(-2.0 * S) + 1e-5 * np.exp(-0.02 * S), (2.0, 8.0))
    assert not flat.resolved
    assert "is not resolved on [2, 8]: the series levels off; use" in flat.advice
    assert "`fp.spectral_gap(model)` gives half of it without a run" in flat.advice
    bent = fit_decay(S, np.exp(-S) + 0.2 * np.exp(-0.2 * S), (0.0, 4.0))
    assert not bent.resolved
    assert "is not resolved on [0, 4]: go on to s = 8 or further" in bent.advice
    assert fit_decay(S, np.exp(-S)).advice == ""


def test_errors_of_the_values_and_of_the_step_are_part_of_the_error():
    values = np.exp(-S)
    known = fit_decay(S, values, step_error=0.03)
    assert known.step_error == pytest.approx(0.03)
    assert known.standard_error == pytest.approx(0.03)
    # Values that are too large by a share growing like s: a slope off by 0.02.
    shifted = fit_decay(S, values, errors=values * np.expm1(0.02 * S))
    assert shifted.step_error == pytest.approx(0.02)


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


def test_a_series_that_is_level_almost_from_the_start_is_refused():
    with pytest.raises(ValueError, match=r"the series levels off at 0\.05, which `bal"):
        fit_decay(S, np.exp(-9.0 * S) + 0.05)


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


# Twice `fp.spectral_gap(LayDownModel(LinearPotential(), 1.0))`, to three digits.
RATE_OF_LINEAR = 0.436


@pytest.mark.parametrize(
    "options", [{}, {"positive": True}, {"balanced": True}], ids=str
)
def test_a_rate_that_is_still_falling_is_covered_wherever_a_run_ends(options):
    # The modes of |ξ| are a crowd: the slope of ln H rises to 0.74, stays there until
    # H has fallen by e⁻⁵, and then takes until s = 40 to come down to 0.5. On this
    # grid a plain run levels off before, so that a line sees 0.73 ± 0.14 only.
    grid = PhaseSpaceGrid(15.4, (64, 64, 16))
    model = LayDownModel(LinearPotential(), 1.0)
    start = initial.gaussian(grid, (0.6, 0.0), 0.2, np.pi / 2, 4.0)
    solution = solve(
        drift_kick(model, grid, **options), start, (0.0, 15.0), 0.3,
        negative_tolerance=1.0,
    )  # fmt: skip
    entropy = solution.relative_entropy - solution.entropy_floor
    whole = solution.entropy_rate()
    ended = [
        fit_decay(solution.s[:n], entropy[:n], step_error=whole.step_error / whole.rate)
        for n in (20, 25, 30, 40, 45)
    ]
    for found in (whole, *ended):
        assert abs(found.rate - RATE_OF_LINEAR) <= 2 * found.standard_error


def test_nothing_is_hidden_beside_one_exponential_and_at_most_the_inverse_length():
    assert hidden_error(S, -2.0 * S, (2.0, 8.0), 2.0) < 1e-12
    # Slope 1 before s = 4 and 2 after it: a change of 1, doubled, is above 1/4.
    bent = np.where(S < 4.0, -S, 4.0 - 2.0 * S)
    assert hidden_error(S, bent, (4.0, 8.0), 2.0) == pytest.approx(0.25)
    # And 1.95 before: 0.1 is below.
    little = np.where(S < 4.0, -1.95 * S, 0.2 - 2.0 * S)
    assert hidden_error(S, little, (4.0, 8.0), 2.0) == pytest.approx(0.1)
