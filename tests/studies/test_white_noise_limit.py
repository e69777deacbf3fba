"""Smooth fibres approach the basic model in the powers of R that are derived."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import studies
from fpsolve.paths import GaussianLaw
from fpsolve.plotting.limits import plot_white_noise
from fpsolve.studies.limits.coupled_paths import coupled_distances

UNIT = fp.QuadraticPotential()
LENGTHS = (0.0125, 0.025, 0.05, 0.1)
START = GaussianLaw((0.8, -0.4), 0.3, 0.6, 2.0)


def of(dataset, quantity):
    return dataset.sel(quantity=quantity)


@pytest.fixture(scope="module")
def dataset():
    return studies.white_noise_limit(
        UNIT, 1.5, LENGTHS, quick=True, parts=["density", "paths"], workers=0
    )


@pytest.mark.parametrize(
    "measure", ["joint", "marginal", "mean", "second_moment", "direction", "angle"]
)
def test_densities_and_moments_are_of_order_one_at_every_halving(dataset, measure):
    one = of(dataset, f"density/{measure}")
    assert one.expected_order == 1
    # The next order is R² with a factor that the direction of a directed start, which
    # falls over 2/A² = 0.9, makes as large as 10: R = 0.05 to 0.1 shows 1.3. No other
    # multiple of one half passes at the smallest R.
    orders = one.observed_order.to_numpy()[1:]
    bands = 10 * np.array(LENGTHS[1:])
    assert (np.abs(orders - 1) < np.minimum(bands, 0.4)).all()
    assert (one.distance > 3 * one.distance_error).all()


def test_paths_of_the_same_noise_are_of_order_one_in_position(dataset):
    for name in ("position", "corrected"):
        one = of(dataset, f"paths/{name}")
        assert one.expected_order == 1
        # Four thousand paths, and a next order that lowers the first: 0.92 from
        # R = 0.05 to 0.1 with many paths.
        assert one.fitted_order == pytest.approx(1.0, abs=0.15)


def test_the_angle_is_off_by_the_curvature_times_r(dataset):
    one = of(dataset, "paths/angle")
    assert one.expected_order == 0.5
    # α − α_0 = −Rκ + O(R), κ Gaussian of variance A²/2R: √(2/π) √(A²R/2)(1 + O(√R)).
    expected = 1.5 * np.sqrt(np.array(LENGTHS) / math.pi)
    excess = one.distance.to_numpy() / expected - 1
    assert (np.abs(excess) < 0.9 * np.sqrt(LENGTHS)).all()
    assert (np.abs(one.observed_order.to_numpy()[1:] - 0.5) < 0.15).all()


def test_without_a_force_the_coupling_is_exact_in_the_angle():
    # β = α + Rκ is then A W itself, and E|Rκ| = √(2/π) A √(R(1 − e^{−2s/R})/2).
    model = fp.SmoothLayDownModel(fp.FreePotential(), 0.4, 1.2)
    found = coupled_distances(model, START, 0.5, 2.0, 20_000, 5)
    assert found["corrected"] < 1e-14
    expected = 1.2 * math.sqrt(0.4 / math.pi * -math.expm1(-2 * 0.5 / 0.4))
    assert abs(found["angle"] - expected) < 4 * found["angle_error"]


def test_coupled_smooth_paths_have_the_law_of_sampled_ones():
    # Of E‖ξ_s − ξ_0‖² where nothing turns the fibre but noise, κ from 0: with twice as
    # many steps the distance to the basic model moves by chance only.
    model = fp.SmoothLayDownModel(UNIT, 0.2, 1.5)
    few, many = (
        coupled_distances(model, START, 1.5, steps, 20_000, seed)
        for steps, seed in ((2.0, 3), (8.0, 4))
    )
    for name in ("angle", "position"):
        error = math.hypot(few[f"{name}_error"], many[f"{name}_error"])
        assert abs(few[name] - many[name]) < 4 * error + 0.01 * many[name], name


@pytest.mark.nightly
def test_gap_and_variance_are_of_order_one_and_two_after_their_derivatives():
    # σ = 1.2: nothing is hidden by σ = 1.
    potential = fp.QuadraticPotential(1.2, 1.2)
    found = studies.white_noise_limit(
        potential, 1.5, LENGTHS[:3], parts=["gap", "variance"], workers=0
    )
    assert (found.status == "finished").all(), found.message.to_numpy()
    limit = fp.LayDownModel(potential, 1.5)
    known = {"gap": studies.gap_slope(limit), "variance": studies.variance_slope(limit)}
    for part, slope in known.items():
        for measure, order in ((part, 1), ("next_term", 2)):
            one = of(found, f"{part}/{measure}")
            assert one.expected_order == order
            assert (one.distance > 100 * one.distance_error).all()
            # What follows is a share of 3R and less: that much of an order.
            missing = np.abs(one.observed_order.to_numpy()[1:] - order)
            assert (missing < 3 * np.array(LENGTHS[1:3])).all()
        # (4d(R) − d(2R))/2R is the derivative up to O(R²).
        near, far = of(found, f"{part}/{part}").distance.to_numpy()[:2]
        derivative = (4 * near - far) / (2 * LENGTHS[0])
        assert derivative == pytest.approx(abs(slope), rel=5e-3)


def test_on_a_belt_and_for_another_potential_the_orders_are_the_same():
    found = studies.white_noise_limit(
        fp.PowerPotential(4.0), 1.5, (0.0125, 0.025), belt_speed=0.2, quick=True,
        parts=["density"], workers=0,
    )  # fmt: skip
    assert (found.status == "finished").all(), found.message.to_numpy()
    for measure in ("joint", "mean"):
        order = of(found, f"density/{measure}").observed_order.to_numpy()[1]
        assert order == pytest.approx(1.0, abs=0.2)


def test_a_figure_shows_all_panels(dataset):
    figure = plot_white_noise(dataset)
    assert [axes.get_title() for axes in figure.axes] == [
        "densities and moments", "paths",
    ]  # fmt: skip
    variance = studies.white_noise_limit(
        UNIT, 1.5, LENGTHS[1:3], parts=["variance"], workers=0
    )
    (axes,) = plot_white_noise(variance).axes
    assert axes.get_title() == "stationary, and rates"
    with pytest.raises(ValueError, match="`dataset` must come from `white_noise_limit"):
        plot_white_noise(dataset.drop_vars("expected_order"))


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"relaxation_lengths": []}, ValueError, "must hold at least one, got none"),
        ({"relaxation_lengths": [0.0]}, ValueError, "`relaxation_length` must be pos"),
        ({"relaxation_lengths": 0.1}, TypeError, "must be a series of numbers"),
        ({"noise": math.nan}, ValueError, "`noise` must be"),
        ({"potential": fp.FreePotential()}, ValueError, "`potential` must confine"),
        ({"belt_speed": 1.5}, ValueError, "`speed` must lie strictly between -1 and 1"),
        ({"s_end": 0.0}, ValueError, "`s_end` must be positive"),
        ({"n_paths": 1}, ValueError, "`n_paths` must be"),
        ({"p0": "gauss"}, TypeError, "`p0` must be a GaussianLaw"),
        ({"parts": ["gaps"]}, ValueError, "`parts` must be among density, paths, gap"),
        (
            {"parts": ["gap"], "belt_speed": 0.2},
            ValueError,
            "among density, paths for this study",
        ),
        (
            {"parts": ["variance"], "potential": fp.QuadraticPotential(1.0, 0.7)},
            ValueError,
            "among density, paths for this study",
        ),
    ],
)
def test_arguments_that_do_not_fit_are_refused(changes, error, message):
    arguments = {"potential": UNIT, "noise": 1.0, "relaxation_lengths": [0.1]} | changes
    with pytest.raises(error, match=message):
        studies.white_noise_limit(**arguments, workers=0)
