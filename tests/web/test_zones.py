"""The variation of zones is what is known of straight fibres, and its errors cover."""

import pickle

import numpy as np
import pytest
from straight_fibres import (
    POISSON_LINES,
    correlated_field,
    gaussian_power,
    stick_variance,
    tiles_of_lines,
    web_of_sticks,
)

from fpsolve.web.statistics.estimate import Estimate
from fpsolve.web.statistics.zones import (
    coefficient_of_variation,
    mean_density,
    zone_means,
)


def covered(estimates, truth):
    """Share of the 95 % intervals with the truth inside, mean error over scatter."""
    intervals = [one.interval() for one in estimates]
    share = np.mean([low <= truth <= high for low, high in intervals])
    errors = [one.standard_error for one in estimates]
    return share, np.mean(errors) / np.std([float(one) for one in estimates])


def test_zones_of_whole_pixels_have_the_means_of_their_pixels():
    density = np.random.default_rng(3).uniform(0, 2, (12, 20))
    means = density.reshape(3, 4, 5, 4).mean(axis=(1, 3))
    # Sums of 240 numbers, each rounded.
    assert np.abs(zone_means(density, 0.1, 0.4) - means).max() < 1e-13
    found = coefficient_of_variation(density, 0.1, 0.4)
    assert found == pytest.approx(means.std() / means.mean(), rel=1e-12)
    assert found.n_samples == 15


def test_a_pixel_that_a_zone_cuts_counts_by_its_area():
    density = np.arange(1.0, 13.0).reshape(3, 4)
    # Every pixel split into 4 × 4: zones of 1.5 pixels are zones of 6 × 6 of them.
    fine = np.kron(density, np.ones((4, 4)))
    means = fine.reshape(2, 6, 16)[:, :, :12].reshape(2, 6, 2, 6).mean(axis=(1, 3))
    assert np.abs(zone_means(density, 1.0, 1.5) - means).max() < 1e-14


def test_infinite_straight_fibres_have_their_law_at_every_zone():
    # CV² = 0.946402/(m x); 400 independent tiles know CV to about 1 %.
    web = tiles_of_lines(np.random.default_rng(18), (20, 20), 8, 3.0)
    found = coefficient_of_variation(web, 1.0, [1, 2, 4, 8], block=8.0)
    law = np.sqrt(POISSON_LINES / (3.0 * found.coordinate))
    assert (np.abs(found.values - law) < 4 * found.standard_errors).all()
    assert (found.standard_errors < 0.04 * law).all()
    assert list(found.n_samples) == [25600, 6400, 1600, 400]
    assert abs(mean_density(web, 1.0, block=8.0) - 3.0) < 0.1


@pytest.mark.parametrize("zone", [1.0, 2.5, 6.0])
def test_errors_cover_the_variation_of_white_noise(zone):
    generator, truth = np.random.default_rng(5), 0.1 / zone
    if zone == 2.5:
        # Two whole pixels and half of a third, in turns: (2 + 1/4)²/2.5⁴ either way.
        truth = 0.1 * 2.25 / 2.5**2
    webs = (1 + 0.1 * generator.standard_normal((48, 96)) for _ in range(200))
    found = [coefficient_of_variation(web, 1.0, zone) for web in webs]
    share, ratio = covered(found, truth)
    # Of 200, 190 ± 3.1 are expected; the error itself is known to 10 % and less.
    assert share > 0.95 - 4 * 0.0154
    assert 0.8 < ratio < 1.25


@pytest.mark.parametrize("zone", [1, 8])
def test_errors_cover_where_neighbouring_zones_are_alike(zone):
    generator, shape = np.random.default_rng(6), (96, 192)
    power = gaussian_power(shape, 2.0)
    waves = [np.fft.fft(np.arange(n) < zone) / zone for n in shape]
    smoothed = np.abs(waves[0][:, None] * waves[1]) ** 2
    truth = 0.1 * np.sqrt(np.sum(power * smoothed))
    webs = (1 + 0.1 * correlated_field(generator, shape, 2.0) for _ in range(200))
    found = [coefficient_of_variation(web, 1.0, zone) for web in webs]
    share, ratio = covered(found, truth)
    assert share > 0.95 - 4 * 0.0154
    assert 0.8 < ratio < 1.25


def test_errors_cover_the_variation_of_straight_fibres_of_finite_length():
    generator, truth = np.random.default_rng(7), np.sqrt(stick_variance(2.0, 6.0, 1.0))
    webs = (web_of_sticks(generator, (60, 120), 6.0, 1.0) for _ in range(100))
    share, ratio = covered([coefficient_of_variation(w, 1.0, 2) for w in webs], truth)
    # Of 100, 95 ± 2.2 are expected.
    assert share > 0.95 - 4 * 0.022
    assert 0.75 < ratio < 1.33


def test_small_zones_of_sticks_have_the_law_of_lines():
    for zone in (0.1, 0.05, 0.025):
        # The ends of fibres take away 1.05 x/ℓ: half a side each, and a bit.
        law = POISSON_LINES / (2.0 * zone)
        assert abs(stick_variance(zone, 5.0, 2.0) / law - 1) < 1.2 * zone / 5.0


def test_one_web_in_two_has_no_error_and_says_why():
    web = 1 + 0.1 * np.random.default_rng(2).standard_normal((20, 40))
    found = coefficient_of_variation(web, 1.0, 20.0)
    assert float(found) > 0
    assert found.n_samples == 2
    assert np.isnan(found.standard_error)
    assert "2 independent blocks of side 20, 4 are needed" in found.reason
    assert np.isnan(found.interval()).all()


def test_equal_zones_vary_by_nothing():
    found = coefficient_of_variation(np.full((20, 30), 0.1), 0.5, [0.5, 2.5])
    assert (found.values < 1e-15).all()
    assert (found.standard_errors < 1e-9).all()


def test_variation_does_not_know_the_unit_of_mass():
    web = np.random.default_rng(4).uniform(0, 1, (24, 24))
    ours, grams = (coefficient_of_variation(one, 1.0, 2.0) for one in (web, 4.5 * web))
    assert float(grams) == pytest.approx(float(ours), rel=1e-12)
    assert grams.standard_error == pytest.approx(ours.standard_error, rel=1e-9)


def test_an_estimate_is_a_float_that_survives_pickling():
    made = pickle.loads(pickle.dumps(Estimate(2.0, 0.5, 9, 40, "small")))
    assert made == 2.0
    assert (made.standard_error, made.n_blocks, made.n_samples) == (0.5, 9, 40)
    assert made.reason == "small"
    # The quantile of Student's law with eight degrees of freedom, from tables.
    assert made.interval() == pytest.approx(
        (2 - 2.306 * 0.5, 2 + 2.306 * 0.5), abs=1e-3
    )
    with pytest.raises(ValueError, match="`level` must lie between 0 and 1, got 95"):
        made.interval(95)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"zone": 0.5}, "`zone` must be at least the pixel, 1, got 0.5; lay"),
        ({"zone": 21.0}, "`zone` must fit at least twice into the web of 20 × 30"),
        ({"zone": np.nan}, "`zone` must be positive and finite, got nan"),
        ({"zone": []}, "`zone` must be a number or a list of them, got shape"),
        ({"pixel": 0.0}, "`pixel` must be positive and finite, got 0"),
        ({"block": -1.0}, "`block` must be positive and finite, got -1"),
        ({"web": np.full((4, 4), np.nan)}, "`length_density` must be finite, got nan"),
        ({"web": np.zeros((4, 4))}, "`length_density` must hold some fibre"),
        ({"web": -np.ones((4, 4))}, "`length_density` must be non-negative, got -1"),
        ({"web": np.ones(4)}, "`length_density` must have two dimensions"),
    ],
)
def test_what_cannot_be_measured_is_refused(change, message):
    chosen = {"web": np.ones((20, 30)), "pixel": 1.0, "zone": 2.0, **change}
    with pytest.raises(ValueError, match=message):
        coefficient_of_variation(
            chosen["web"], chosen["pixel"], chosen["zone"], block=chosen.get("block")
        )
