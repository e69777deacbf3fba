"""The best noise of smooth fibres: where it is, and that it tends to the basic one."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.spectral import Sector, SpectralGap, optimal_noise, spectral_gap
from fpsolve.spectral.eigen import optimal
from fpsolve.spectral.eigen.branches import Branch
from fpsolve.spectral.eigen.family import Family

PLANE = fp.QuadraticPotential()
# Of the basic model, and its gap (test_optimal_noise.py).
BASIC = np.array([1.6157138035, 0.7222717230])


def meeting_at(length, noise, width=0.01):
    """Both sides of a double eigenvalue near a noise, with rates to ten per cent."""
    family = Family(PLANE, length)
    gaps = tuple(
        SpectralGap(0.7, 0.1, Sector(1), complex(-0.7, imaginary))
        for imaginary in (0.1, 0.0)
    )
    return optimal.Meeting(family, (noise - width, noise + width), gaps)


@pytest.fixture(scope="module")
def best():
    # The whole scan takes ten seconds more and finds the same bracket.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(optimal, "SCAN", np.array([1.55, 1.6, 1.68]))
        return optimal_noise(PLANE, relaxation_length=0.1, tolerance=1e-3)


@pytest.mark.nightly
def test_the_best_noise_of_a_smooth_fibre_is_a_double_eigenvalue(best):
    assert best.kind == "double eigenvalue"
    assert best.sectors == (Sector(1),)
    assert best.noise_error <= 1e-3 * best.noise
    assert best.gap_error <= 1e-3 * best.gap


@pytest.mark.nightly
def test_its_errors_cover_finer_truncations(best):
    # Measured with the whole scan and the default tolerance, to 6e-7 and 3e-6.
    assert abs(best.noise - 1.60338212) <= best.noise_error + 6.3e-7
    assert abs(best.gap - 0.69743533) <= best.gap_error + 2.6e-6


@pytest.mark.nightly
def test_the_gap_of_a_smooth_fibre_is_smaller_on_both_sides(best):
    # All sectors are searched; the coarsest truncation is good to 1e-3.
    for noise in (best.noise - 0.05, best.noise + 0.05):
        assert optimal.rough_gap(Family(PLANE, 0.1), noise) < best.gap - 0.02


def test_the_best_noise_tends_to_that_of_the_basic_model_to_first_order():
    lengths = (0.04, 0.02, 0.01)
    found = [meeting_at(one, 1.61).solve(1) for one in lengths]
    away = BASIC - np.array(found)
    # The terms of second order are 2 R of the first.
    np.testing.assert_allclose(away[:-1] / away[1:], 2.0, rtol=0.05)


def test_the_derivative_of_a_smooth_branch_is_its_difference_quotient():
    gap = spectral_gap(fp.SmoothLayDownModel(PLANE, 0.1, 2.0), tolerance=1e-4)
    branch = Branch(Family(PLANE, 0.1), gap.sector, 1, 2.0, gap.eigenvalue)
    step = 1e-3
    quotient = (branch.rate(2.0 + step) - branch.rate(2.0 - step)) / (2 * step)
    # Second order in the step, and the truncation is good to 1e-8.
    assert branch.slope(2.0) == pytest.approx(quotient, rel=1e-5)


def test_a_truncation_without_the_maximum_is_passed_over():
    assert np.all(np.isnan(meeting_at(0.1, 1.9).solve(0)))


def test_refusals_of_smooth_fibres(monkeypatch):
    with pytest.raises(
        ValueError, match=r"`relaxation_length` must be at most 0\.5, .*, got 0\.7"
    ):
        optimal_noise(PLANE, relaxation_length=0.7)
    with pytest.raises(ValueError, match=r"`relaxation_length` must be positive"):
        optimal_noise(PLANE, relaxation_length=float("nan"))
    with pytest.raises(ValueError, match=r"`potential` must be a QuadraticPotential"):
        optimal_noise(fp.LinearPotential(), relaxation_length=0.1)
    monkeypatch.setattr(optimal, "located", lambda family: (1.60, 1.61))
    monkeypatch.setattr(optimal.Meeting, "near", lambda *given: meeting_at(0.1, 1.605))
    monkeypatch.setattr(optimal, "SMOOTH_LEVELS", range(2))
    with pytest.raises(ToleranceError, match=r"not reached: .*; enlarge `tolerance`\."):
        optimal_noise(PLANE, relaxation_length=0.1, tolerance=1e-12)
