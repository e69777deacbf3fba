"""Initial densities: mass one on the grid, and the moments asked for."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ive

from fpsolve import initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.potentials import FreePotential, LinearPotential, QuadraticPotential

GRID = PhaseSpaceGrid(half_width=(8.0, 6.0), shape=(48, 36, 32))
# Summing n cells of one sign: the error is far below n eps.
ROUNDING = 1e-13


def expectation(grid, p, f):
    xi1, xi2, alpha = grid.mesh()
    return float(np.sum(p * f(xi1, xi2, alpha))) * grid.cell_volume


@given(
    mean=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    variance=st.floats(0.25, 1.0),
    angle=st.floats(0.0, 2 * math.pi),
    concentration=st.floats(0.0, 10.0),
)
def test_a_gaussian_has_mass_one_on_the_grid(mean, variance, angle, concentration):
    p = initial.gaussian(GRID, mean, variance, angle, concentration)
    assert p.shape == GRID.shape
    assert p.flags.c_contiguous
    assert p.min() >= 0
    assert p.sum() * GRID.cell_volume == pytest.approx(1.0, abs=ROUNDING)


@pytest.mark.parametrize(
    ("variance", "covariance"),
    [
        (0.5, [[0.5, 0.0], [0.0, 0.5]]),
        ((0.4, 0.7), [[0.4, 0.0], [0.0, 0.7]]),
        ([[0.5, 0.2], [0.2, 0.6]], [[0.5, 0.2], [0.2, 0.6]]),
    ],
)
def test_a_gaussian_has_the_moments_asked_for(variance, covariance):
    p = initial.gaussian(GRID, (1.0, -0.5), variance)
    mean1 = expectation(GRID, p, lambda x, y, a: x)
    mean2 = expectation(GRID, p, lambda x, y, a: y)
    away = [
        [expectation(GRID, p, lambda x, y, a: (x - mean1) ** 2), 0.0],
        [0.0, expectation(GRID, p, lambda x, y, a: (y - mean2) ** 2)],
    ]
    away[0][1] = away[1][0] = expectation(
        GRID, p, lambda x, y, a: (x - mean1) * (y - mean2)
    )
    # Midpoint sums of a Gaussian: 2 exp(-2π²σ²/d²) = 3e-29 for the narrowest
    # direction; the tails cut at 5.5 off the mean weigh exp(-21) times 30.
    assert (mean1, mean2) == pytest.approx((1.0, -0.5), abs=1e-7)
    np.testing.assert_allclose(away, covariance, rtol=0, atol=1e-6)


@pytest.mark.parametrize("concentration", [0.0, 0.5, 4.0])
def test_the_angle_is_von_mises(concentration):
    p = initial.gaussian(GRID, angle=1.0, concentration=concentration)
    ratio = ive(1, concentration) / ive(0, concentration)
    # The midpoint rule is spectrally accurate on the circle: I_32/I_0 < 1e-20.
    for f, expected in ((np.cos, ratio * math.cos(1)), (np.sin, ratio * math.sin(1))):
        value = expectation(GRID, p, lambda x, y, a, f=f: f(a))
        assert value == pytest.approx(expected, abs=1e-12)


def test_a_large_concentration_does_not_overflow():
    fine = PhaseSpaceGrid(4.0, (8, 8, 512))
    with np.errstate(over="raise"):
        p = initial.gaussian(fine, angle=1.0, concentration=1000.0)
    assert np.all(np.isfinite(p))


def test_the_equilibrium_is_uniform_in_the_angle_and_exp_minus_b_in_the_plane():
    potential = QuadraticPotential(1.0, 2.0)
    p = initial.equilibrium(GRID, potential)
    assert p.flags.c_contiguous
    assert np.array_equal(p, np.repeat(p[:, :, :1], GRID.shape[2], axis=2))
    assert p.sum() * GRID.cell_volume == pytest.approx(1.0, abs=ROUNDING)
    ratio = p[:, :, 0] * np.exp(potential.value(*GRID.plane()))
    # B reaches 37 in the corners: exp(B) amplifies the rounding of B by that.
    np.testing.assert_allclose(ratio, ratio[0, 0], rtol=1e-13)


def test_the_box_makes_every_potential_normalisable_and_no_height_underflows():
    box = 4 * 8.0 * 6.0 * 2 * math.pi
    assert initial.equilibrium(GRID, FreePotential()) == pytest.approx(1 / box)
    steep = initial.equilibrium(GRID, LinearPotential(slope=5000.0))
    assert steep.sum() * GRID.cell_volume == pytest.approx(1.0, abs=ROUNDING)


def test_a_function_is_sampled_and_normalised():
    p = initial.from_function(GRID, lambda x, y, a: 3 * np.exp(-(x**2)) * (y > 0))
    assert p.sum() * GRID.cell_volume == pytest.approx(1.0, abs=ROUNDING)
    assert np.all(p[:, GRID.xi2 < 0] == 0)
    ratio = p[5, -1, 0] / p[20, -1, 0]
    assert ratio == pytest.approx(math.exp(GRID.xi1[20] ** 2 - GRID.xi1[5] ** 2))


def test_a_function_that_is_no_density_is_refused():
    with pytest.raises(
        ValueError, match=r"^`f` must be non-negative .* got -1; a dens"
    ):
        initial.from_function(GRID, lambda *_: -1.0)
    with pytest.raises(
        ValueError, match=r"^`f` must be finite on the grid, got NaN or"
    ):
        initial.from_function(GRID, lambda *_: math.nan)
    with pytest.raises(
        ValueError, match=r"^`f` must be positive somewhere .* zero mas"
    ):
        initial.from_function(GRID, lambda *_: 0.0)


@pytest.mark.parametrize("mean", [(8.0, 0.0), (0.0, -6.5), (9.0, 9.0)])
def test_a_mean_outside_the_box_is_refused(mean):
    message = (
        r"^`mean` must lie inside the box of half widths \(8, 6\), got "
        rf"\({mean[0]:g}, {mean[1]:g}\); enlarge `half_width` or move the mean\.$"
    )
    with pytest.raises(ValueError, match=message):
        initial.gaussian(GRID, mean)


def test_a_mean_is_two_finite_numbers():
    with pytest.raises(ValueError, match=r"`mean` must be two numbers, got 1\.0"):
        initial.gaussian(GRID, 1.0)
    with pytest.raises(ValueError, match="`mean` must be finite, got nan"):
        initial.gaussian(GRID, (math.nan, 0.0))


@pytest.mark.parametrize(
    "variance",
    [
        0.0,
        -1.0,
        math.nan,
        (1.0, 0.0),
        (-1.0, -1.0),
        [[1.0, 2.0], [2.0, 1.0]],
        [[1.0, 0.5], [0.0, 1.0]],
    ],
)
def test_a_variance_is_positive_definite(variance):
    with pytest.raises(
        ValueError, match="`variance` must be positive, as a matrix sym"
    ):
        initial.gaussian(GRID, variance=variance)


def test_a_variance_has_one_two_or_four_numbers():
    with pytest.raises(ValueError, match=r"two, or a 2x2 matrix, got shape \(3,\)"):
        initial.gaussian(GRID, variance=(1.0, 1.0, 1.0))


def test_a_concentration_needs_an_angle_and_a_sign():
    with pytest.raises(ValueError, match=r"`angle` must be given .* concentration 4"):
        initial.gaussian(GRID, concentration=4.0)
    with pytest.raises(ValueError, match="`concentration` must be non-negative"):
        initial.gaussian(GRID, angle=0.0, concentration=-1.0)
    with pytest.raises(ValueError, match="`angle` must be finite, got nan"):
        initial.gaussian(GRID, angle=math.nan, concentration=1.0)


@pytest.mark.parametrize(
    "arguments",
    [
        {"mean": (7.5, 0.0)},  # a third of it beyond the boundary
        {"variance": 100.0},  # wider than the box
        {"variance": 1e-4},  # narrower than a cell
        {"angle": 0.1, "concentration": 500.0},  # narrower than a cell in α
    ],
)
def test_a_gaussian_that_does_not_fit_the_grid_is_reported(arguments):
    with pytest.warns(
        UserWarning, match=r"had mass .* before normalisation: .* or ref"
    ):
        p = initial.gaussian(GRID, **arguments)
    assert p.sum() * GRID.cell_volume == pytest.approx(1.0, abs=ROUNDING)


def test_a_gaussian_that_fits_is_silent():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        initial.gaussian(GRID, (1.5, 0.0), 0.25, math.pi / 2, 4.0)
