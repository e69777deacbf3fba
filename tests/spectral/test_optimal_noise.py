"""The best noise: where it is, what makes it, and that it is one."""

import functools
import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.spectral import Sector, SpectralGap, optimal_noise, spectral_gap
from fpsolve.spectral.eigen import optimal
from fpsolve.spectral.eigen.branches import Branch
from fpsolve.spectral.eigen.family import Family


@pytest.fixture(scope="module", autouse=True)
def rough_gaps_are_computed_once():
    """All searches for the same potential scan the same noises."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(optimal, "rough_gap", functools.cache(optimal.rough_gap))
        yield


@pytest.fixture(scope="module")
def best():
    return optimal_noise(fp.QuadraticPotential())


def test_the_best_noise_of_the_quadratic_potential_is_a_double_eigenvalue(best):
    assert best.kind == "double eigenvalue"
    assert best.sectors == (Sector(1),)
    # Measured with degree 68, 96 and 136: equal to 13 digits.
    assert best.noise == pytest.approx(1.6157138035238, abs=2e-13)
    assert best.gap == pytest.approx(0.7222717229986, abs=2e-13)
    assert best.noise_error < 1e-8 * best.noise
    assert best.gap_error < 1e-8 * best.gap


def test_the_gap_is_smaller_on_both_sides(best):
    for step, power in ((-1, 1.0), (1, 0.5)):
        distances = np.array([1e-4, 4e-4])
        gaps = [
            spectral_gap(
                fp.LayDownModel(fp.QuadraticPotential(), best.noise + step * distance),
                tolerance=1e-8,
            )
            for distance in distances
        ]
        loss = best.gap - np.array(gaps)
        assert np.all(loss > 0)
        # Linear below, where the pair is complex; a square root above.
        assert loss[1] / loss[0] == pytest.approx(4**power, rel=0.05)


@pytest.mark.nightly
def test_the_best_noise_scales_with_the_throwing_range(best):
    sigma = 2.5
    found = optimal_noise(fp.QuadraticPotential(sigma, sigma))
    assert found.noise == pytest.approx(best.noise / math.sqrt(sigma), rel=1e-12)
    assert found.gap == pytest.approx(best.gap / sigma, rel=1e-12)


def test_a_tighter_tolerance_changes_nothing_but_the_error(best):
    rough = optimal_noise(fp.QuadraticPotential(), tolerance=1e-3)
    assert abs(rough.noise - best.noise) <= rough.noise_error + best.noise_error
    assert abs(rough.gap - best.gap) <= rough.gap_error + best.gap_error


def test_the_best_noise_of_the_linear_potential_is_a_crossing():
    # Of -A²/2 and a branch with M = ±2 that is still isolated; the ends of the bracket
    # are given here because looking for them takes ten seconds.
    potential = fp.LinearPotential()
    noises, rates = (0.8015, 0.8029), (0.8015**2 / 2, 0.32134)
    gaps = tuple(
        SpectralGap(rate, 1e-4, sector, complex(-rate))
        for rate, sector in zip(rates, (Sector(0, -1), Sector(2)), strict=True)
    )
    meeting = optimal.Meeting(Family(potential), noises, gaps)
    assert meeting.kind == "crossing"
    coarse, fine = meeting.solve(1), meeting.solve(2)
    np.testing.assert_allclose(coarse, fine, rtol=1e-7)
    noise, gap = fine
    assert noise == pytest.approx(0.80219260, abs=1e-7)
    assert gap == pytest.approx(noise**2 / 2, rel=1e-12)


def test_a_smooth_maximum_is_where_the_derivative_vanishes(monkeypatch):
    # The exact derivative of a branch against a difference quotient.
    gap = spectral_gap(fp.LayDownModel(fp.QuadraticPotential(), 1.2))
    family = Family(fp.QuadraticPotential())
    branch = Branch(family, gap.sector, 4, 1.2, gap.eigenvalue)
    step = 1e-3
    quotient = (branch.rate(1.2 + step) - branch.rate(1.2 - step)) / (2 * step)
    # Second order in the step.
    assert branch.slope(1.2) == pytest.approx(quotient, abs=1e-5)
    # With a derivative of known zero in its place, the maximum is put there.
    monkeypatch.setattr(Branch, "slope", lambda self, noise: 1.3 - noise)
    meeting = optimal.Meeting(family, (1.2, 1.35), (gap, gap))
    assert meeting.kind == "smooth maximum"
    noise, rate = meeting.solve(4)
    assert noise == pytest.approx(1.3, abs=1e-12)
    assert rate == pytest.approx(0.508546805918, abs=1e-10)


def test_golden_section_encloses_a_corner_and_a_smooth_maximum():
    for function in (lambda a: -abs(a - 1.3), lambda a: -((a - 1.3) ** 2)):
        lower, upper = optimal.shrunk(function, np.array([0.5, 1.0, 2.0]))
        assert lower <= 1.3 <= upper
        assert upper - lower <= 1e-3 * 1.3


def test_refusals():
    with pytest.raises(
        ValueError, match=r"`potential` must confine, got FreePotential"
    ):
        optimal_noise(fp.FreePotential())
    with pytest.raises(TypeError, match=r"`potential` must be a Potential, got 3"):
        optimal_noise(3)
    with pytest.raises(ValueError, match=r"`tolerance` must lie in"):
        optimal_noise(fp.QuadraticPotential(), tolerance=0.0)


def test_a_maximum_at_the_end_of_the_scan_is_not_reported(monkeypatch):
    monkeypatch.setattr(optimal, "rough_gap", lambda family, noise: noise)
    with pytest.raises(
        ValueError, match=r"`potential` must have its best noise between 0\.4 and 4"
    ):
        optimal_noise(fp.QuadraticPotential())


def test_a_tolerance_out_of_reach_says_so(monkeypatch):
    monkeypatch.setattr(optimal, "LEVELS", range(2))
    with pytest.raises(ToleranceError, match=r"not reached: .*; enlarge `tolerance`\."):
        optimal_noise(fp.QuadraticPotential(), tolerance=1e-13)
