"""Formation compares with random straight fibres, and cloudiness shares out CV²."""

from itertools import pairwise

import numpy as np
import pytest
from straight_fibres import correlated_field, tiles_of_lines

from fpsolve.web.statistics.cloudiness import cloudiness
from fpsolve.web.statistics.formation import STRAIGHT_FIBRES, formation_number
from fpsolve.web.statistics.zones import coefficient_of_variation


def share_covered(estimates, truth):
    intervals = [one.interval() for one in estimates]
    return np.mean([low <= truth <= high for low, high in intervals])


def test_random_straight_fibres_have_the_formation_number_one():
    generator = np.random.default_rng(1)
    webs = [tiles_of_lines(generator, (6, 10), 6, 2.0) for _ in range(25)]
    for zone in (1.0, 3.0):
        found = [formation_number(web, 1.0, zone, block=6.0) for web in webs]
        # Four standard errors of the mean of 25 webs.
        error = np.std(found) / 5
        assert abs(np.mean(found) - 1.0) < 4 * error
        assert error < 0.04
        # Of 25, 23.75 ± 1.1 are expected inside.
        assert share_covered(found, 1.0) > 0.95 - 4 * 0.044


def test_formation_is_the_ratio_of_variances_at_the_same_mean():
    web = np.random.default_rng(2).uniform(0, 4, (40, 60))
    variation = float(coefficient_of_variation(web, 0.5, 1.0))
    law = STRAIGHT_FIBRES / (web.mean() * 1.0)
    assert formation_number(web, 0.5, 1.0) == pytest.approx(variation**2 / law)
    # The constant that MATH, section 7, gives to six digits.
    assert pytest.approx(0.946402, abs=5e-7) == STRAIGHT_FIBRES


def test_bands_of_all_wavelengths_add_up_to_the_variation_of_pixels():
    web = np.random.default_rng(3).gamma(2.0, size=(45, 64))
    edges = [0, 1, 2.5, 4, 10, 30, np.inf]
    bands = list(pairwise(edges))
    powers = cloudiness(web, 0.5, bands)
    whole = float(coefficient_of_variation(web, 0.5, 0.5)) ** 2
    # Parseval, to the rounding of a transform of 2880 numbers.
    assert np.sum(powers) == pytest.approx(whole, rel=1e-12)
    assert (powers.values > 0).all()
    # No block holds the longest waves more than once.
    assert np.isnan(powers[-1].standard_error)
    assert "independent block" in powers[-1].reason


def test_a_wave_lies_in_the_band_of_its_wavelength():
    place = np.arange(120) + 0.5
    web = np.ones((60, 1)) * (1 + 0.2 * np.cos(2 * np.pi * place / 8))
    inside, outside = cloudiness(web, 1.0, [(7, 9), (9, 100)])
    # The power of a cosine is half the square of its amplitude; 15 periods fit.
    assert float(inside) == pytest.approx(0.02, rel=1e-12)
    assert float(outside) < 1e-25


def test_the_power_of_a_band_of_white_noise_is_its_share_of_the_waves():
    generator, shape = np.random.default_rng(4), (64, 96)
    k = [np.arange(n) / (2 * n) for n in shape]
    frequency = np.hypot(k[0][:, None], k[1])
    share = np.mean((frequency <= 1 / 4) & (frequency > 1 / 8))
    truth = 0.1**2 * share
    webs = (1 + 0.1 * generator.standard_normal(shape) for _ in range(150))
    found = [cloudiness(web, 1.0, (4.0, 8.0)) for web in webs]
    assert abs(np.mean(found) - truth) < 4 * np.std(found) / np.sqrt(150)
    # Of 150, 142.5 ± 2.7 are expected.
    assert share_covered(found, truth) > 0.95 - 4 * 0.018


def test_the_power_of_a_band_of_clouds_is_that_of_their_spectrum():
    # A window of a larger field: its edges do not fit, and no sine would like that.
    generator, length = np.random.default_rng(5), 2.0
    found = []
    for _ in range(60):
        field = correlated_field(generator, (128, 256), length)[:64, :128]
        found.append(cloudiness(1 + 0.1 * field, 1.0, (10.0, 20.0)))
    # ∫ over a ring of the density ℓ²/(2π) e^{-k²ℓ²/2} of the wave vectors.
    low, high = (np.exp(-((2 * np.pi / wave * length) ** 2) / 2) for wave in (20, 10))
    truth = 0.01 * (low - high)
    # The window blurs wave numbers by π/64, a twentieth of the band.
    assert np.mean(found) == pytest.approx(truth, rel=0.02)
    # Of 60, 57 ± 1.7 are expected.
    assert share_covered(found, truth) > 0.95 - 4 * 0.028


@pytest.mark.parametrize(
    ("band", "message"),
    [
        ((4.0, 2.0), r"`band` must be .* with 0 ≤ λ₁ < λ₂, got \(4, 2\)"),
        ((-1.0, 2.0), r"`band` must be .* got \(-1, 2\)"),
        ((np.nan, 2.0), r"`band` must be .* got \(nan, 2\)"),
        ((1.0, 2.0, 3.0), "`band` must be a shortest and a longest wavelength, or"),
    ],
)
def test_what_is_no_band_is_refused(band, message):
    with pytest.raises(ValueError, match=message):
        cloudiness(np.ones((8, 8)), 1.0, band)
