"""The gap of smooth fibres on belts and about unequal throwing ranges."""

import math

import pytest
from polynomial_galerkin import galerkin_rate

import fpsolve as fp
from fpsolve.spectral import Sector
from fpsolve.spectral.bases.choice import smooth_discretisation_for
from fpsolve.spectral.eigen.following import left_to_come
from fpsolve.spectral.eigen.survey import Scale, Search


def fibre(length, noise, speed=0.0, ratio=1.0):
    belt = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.SmoothLayDownModel(fp.QuadraticPotential(1.0, ratio), length, noise, belt)


# The slowest mode is along the wider range: on a round potential along the belt.
@pytest.mark.parametrize(
    ("case", "parity"),
    [
        ((0.1, 3.0, 0.2, 1.3), -1),
        ((0.1, 3.0, 0.2, 1.0), 1),
    ],
)
@pytest.mark.nightly
def test_the_gap_is_that_of_polynomials_in_every_coordinate(case, parity):
    """A Galerkin method of another basis, in another frame."""
    gap = fp.spectral_gap(fibre(*case), tolerance=1e-2)
    assert gap.sector == Sector(parity=parity)
    known, fine = (
        galerkin_rate(case, parity, sizes, near=0.1) for sizes in ((6, 5, 5), (8, 6, 6))
    )
    # That of the polynomials is less than what a third more of them change.
    assert abs(gap - fine) <= gap.error + abs(fine - known)


def test_a_slow_mode_is_not_taken_for_the_constants():
    """Along a range eight times as wide as that across, it is slow beside 1/(A²σ²)."""
    case = (0.02, 8.0, 0.2, 0.125)
    model = fibre(*case)
    basis = smooth_discretisation_for(model)
    sector, scale = basis.stationary_sector, Scale.of(model, None)
    search = Search(basis, sector, basis.truncation(0), scale)
    slowest = search.run(1, math.inf)[0]
    rate = galerkin_rate(case, 1, (6, 5, 5), near=0.0144)
    # The first truncation, of degree 6, is good for a per cent.
    assert slowest.rate == pytest.approx(rate, rel=0.02)
    assert slowest.rate < 0.02 * scale.rate
    # What was left out is 0 but for the truncation, and constant.
    assert abs(search.constants.eigenvalue) < 1e-4


# Tens of seconds: for a tolerance of 1e-4 it takes several truncations.
@pytest.mark.nightly
@pytest.mark.parametrize("case", [(0.1, 2.0, 0.2, 1.0), (0.3, 2.0, 0.2, 1.3)])
def test_errors_of_the_gap_cover_what_a_smaller_tolerance_changes(case):
    """Of the first case two truncations agree to a tenth of their distance from it."""
    coarse = fp.spectral_gap(fibre(*case), tolerance=3e-3)
    fine = fp.spectral_gap(fibre(*case), tolerance=1e-4)
    assert abs(coarse - fine) <= coarse.error + fine.error
    assert fine.error <= 1e-4 * fine


def test_one_change_from_one_truncation_to_the_next_is_no_error():
    """It may be small by chance; and so may the second."""
    assert left_to_come(1e-9, math.inf) == math.inf
    # Twice the change, if that has halved, and twice a quarter of the one before.
    assert left_to_come(1e-4, 2e-4) == pytest.approx(2e-4)
    assert left_to_come(1e-9, 2e-4) == pytest.approx(1e-4)
    # Geometric changes of ratio q leave q/(1 - q); doubled twice.
    assert left_to_come(1.5e-4, 2e-4) == pytest.approx(4 * 3 * 1.5e-4)
