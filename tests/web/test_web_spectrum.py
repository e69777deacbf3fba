"""The measured spectrum is the spectrum, and strips are told from noise."""

import numpy as np
import pytest
from scipy.signal import lfilter
from straight_fibres import correlated_field, web_of_sticks

from fpsolve.web.statistics.spectrum import power_spectrum
from fpsolve.web.statistics.strips import strips


def uniform(generator, deviation, shape):
    """Noise of mean 0 that leaves a density positive."""
    return deviation * np.sqrt(3) * generator.uniform(-1, 1, shape)


def striped(generator, amplitude=0.1, period=7.3, noise=0.3, shape=(100, 160)):
    wave = amplitude * np.cos(2 * np.pi * (np.arange(shape[0]) + 0.5) / period + 0.4)
    return 1 + wave[:, None] + uniform(generator, noise, shape)


def test_white_noise_has_a_flat_spectrum_of_its_variance():
    web = 1 + 0.1 * np.random.default_rng(1).standard_normal((96, 192))
    for window in ("hann", "none"):
        found = power_spectrum(web, 0.5, block=12.0, window=window)
        # ∫ P d²k/(2π)² is the variance: P = variance × area of a pixel.
        truth = 0.01 * 0.5**2
        deviation = (found.radial.values[1:] - truth) / found.radial.standard_errors[1:]
        # Eleven rings of one web; Student's t of 31 degrees beyond 4.5 is 1e-4.
        assert np.abs(deviation).max() < 4.5
        assert found.radial.values[1:] == pytest.approx(truth, rel=0.2)
        assert found.mean == pytest.approx(1.0, abs=0.01)


def test_power_without_a_window_adds_up_to_the_variance():
    web = np.random.default_rng(2).gamma(3.0, size=(40, 80))
    found = power_spectrum(web, 0.25, block=2.5, window="none")
    cells = np.diff(found.k2)[0] * np.diff(found.k1)[0] / (2 * np.pi) ** 2
    # Parseval on every block.
    assert np.sum(found.power) * cells == pytest.approx(web.var(), rel=1e-12)


def test_clouds_have_their_gaussian_spectrum():
    generator, length = np.random.default_rng(3), 2.0
    field = correlated_field(generator, (256, 512), length)
    found = power_spectrum(1 + 0.1 * field, 1.0)
    k = found.radial.coordinate
    shown = (k > 0.3) & (k < 1.5)
    law = 0.01 * 2 * np.pi * length**2 * np.exp(-(k**2) * length**2 / 2)
    # 16 blocks: Student's t of 15 degrees beyond 5 is 1.6e-4; the window, 64 long,
    # blurs a curvature of ℓ² by (2π/64)² of it, 2 % where k ℓ = 2.
    allowed = 5 * found.radial.standard_errors + 0.04 * law
    assert (np.abs(found.radial.values - law)[shown] < allowed[shown]).all()
    machine = np.interp(0.8, found.machine.coordinate, found.machine.values)
    cross = np.interp(0.8, found.cross.coordinate, found.cross.values)
    # Sections are single wave vectors: sixteen exponential variables each.
    for section in (machine, cross):
        assert section == pytest.approx(np.interp(0.8, k, law), rel=1.0)


def test_straight_fibres_have_two_over_k():
    # Of a fibre of length ℓ ≫ 1/k, isotropic: Ŝ = 2/‖k‖ (MATH, section 10).
    web = web_of_sticks(np.random.default_rng(4), (256, 256), 60.0, 2.0)
    found = power_spectrum(web, 1.0)
    k = found.radial.coordinate
    shown = (k > 0.4) & (k < 0.8)
    one_fibre = found.radial.values[shown] / found.mean
    errors = found.radial.standard_errors[shown] / found.mean
    # Pixels take away (k/2)²/3 × 1 at most, 6 % at k = 0.8; ends of fibres 2/(k ℓ).
    law = 2 / k[shown] * (1 - k[shown] ** 2 / 12)
    assert (np.abs(one_fibre - law) < 4.5 * errors + 0.03 * law).all()


def test_planted_strips_are_found_with_their_period_and_amplitude():
    found = strips(striped(np.random.default_rng(5)), 1.0)
    assert abs(found.period - 7.3) < 4 * found.period.standard_error
    assert abs(found.amplitude - 0.1) < 4 * found.amplitude.standard_error
    assert found.period.standard_error < 0.03
    assert found.amplitude.standard_error < 0.01
    assert found.p_value < 1e-9
    # CV² of the profile: that of the strips, and of the noise of 160 pixels.
    truth = 0.005 / (0.005 + 0.09 / 160)
    assert abs(found.share - truth) < 4 * found.share.standard_error


def test_strips_across_the_machine_are_those_of_the_web_turned():
    web = striped(np.random.default_rng(6))
    turned = strips(web.T, 1.0, direction="cross")
    straight = strips(web, 1.0)
    assert float(turned.period) == pytest.approx(float(straight.period), rel=1e-12)
    assert turned.p_value == pytest.approx(straight.p_value, rel=1e-6)
    assert turned.direction == "cross"


def test_errors_cover_amplitude_period_and_share():
    generator = np.random.default_rng(7)
    webs = [striped(generator, 0.06, shape=(60, 100)) for _ in range(60)]
    found = [strips(web, 1.0) for web in webs]
    # The share is of the profile of 100 columns, with their noise.
    wave = np.var(0.06 * np.cos(2 * np.pi * (np.arange(60) + 0.5) / 7.3))
    share = wave / (wave + 0.09 / 100 * 59 / 60)
    for name, truth in (("amplitude", 0.06), ("period", 7.3), ("share", share)):
        intervals = [getattr(one, name).interval() for one in found]
        inside = np.mean([low <= truth <= high for low, high in intervals])
        # Of 60, 57 ± 1.7 are expected.
        assert inside > 0.95 - 4 * 0.028
    # And no more than that: 60 webs know a scatter to a tenth; the jackknife of the
    # variance of pure noise is √2 too large.
    errors = [one.share.standard_error for one in found]
    assert 0.7 < np.mean(errors) / np.std([one.share for one in found]) < 1.7


@pytest.mark.parametrize("strength", [0.0, 1.0, 2.0])
def test_errors_cover_where_noise_hides_the_strip(strength):
    # Strips of a known period as strong as the noise in their wave, and none at all:
    # of 60 × 80 pixels of deviation 0.3, |c|² has the mean 4 × 0.09/4800.
    generator, planted = np.random.default_rng(11), strength * np.sqrt(0.36 / 4800)
    wave = planted * np.cos(2 * np.pi * (np.arange(60) + 0.5) / 7.5)[:, None]
    webs = [1 + wave + uniform(generator, 0.3, (60, 80)) for _ in range(200)]
    found = [strips(web, 1.0, period=7.5) for web in webs]
    truth = {"amplitude": planted}
    power = planted**2 / 2
    truth["share"] = power / (power + 0.09 / 80)
    for name, value in truth.items():
        estimates = [getattr(one, name) for one in found]
        assert min(one.standard_error for one in estimates) > 0
        intervals = [one.interval() for one in estimates]
        inside = np.mean([low <= value <= high for low, high in intervals])
        # Four standard deviations of 200 below 95 %.
        assert inside > 0.95 - 4 * 0.0154, name
    if strength == 0:
        # And in 1 - 1/e of webs without strips nothing is left of the amplitude.
        assert 0.5 < np.mean([one.amplitude == 0 for one in found]) < 0.75
        # There the error is that of noise; more where stretches differ about the rest.
        errors = [one.amplitude.standard_error for one in found if one.amplitude == 0]
        assert np.median(errors) == pytest.approx(np.sqrt(0.36 / 4800), rel=0.1)


@pytest.mark.nightly
def test_noise_alone_is_seldom_called_a_strip():
    generator = np.random.default_rng(8)
    p_values = np.array([
        strips(1 + uniform(generator, 0.3, (40, 80)), 1.0).p_value
        for _ in range(200)
    ])  # fmt: skip
    # Bonferroni over dependent frequencies counts too many: at most 10 ± 3.1 of 200.
    assert np.sum(p_values < 0.05) <= 10 + 3 * 3.1
    # And it is no constant: half of the noise has a wave below one half.
    assert np.mean(p_values < 0.9) > 0.2


def remembering(generator, shape, length):
    """Noise whose correlation e^{-h/length} along the machine is a fibre's memory."""
    kept, cells = np.exp(-1 / length), shape[1] + int(8 * length)
    noise = uniform(generator, 0.1, (shape[0], cells))
    field = lfilter([np.sqrt(1 - kept**2)], [1, -kept], noise, axis=1)
    return 1 + field[:, -shape[1] :]


@pytest.mark.parametrize(("length", "n_webs"), [
    (2.0, 200), pytest.param(5.0, 200, marks=pytest.mark.nightly), (48.0, 50)
])  # fmt: skip
def test_webs_that_remember_for_long_are_not_called_striped(length, n_webs):
    generator = np.random.default_rng(10)
    webs = [remembering(generator, (48, 96), length) for _ in range(n_webs)]
    p_values = np.array([strips(web, 1.0).p_value for web in webs])
    # Counted 1 % and 5 %, each with three standard errors of the count.
    for level in (0.01, 0.05):
        allowed = level * n_webs + 3 * np.sqrt(level * n_webs)
        assert np.sum(p_values < level) <= allowed
    # Memories of a fifteenth and less of the web leave it some judgement, those of
    # half of it none.
    assert np.isnan(p_values).mean() == pytest.approx(1.0 * (length > 10), abs=0.6)


def test_a_memory_as_long_as_the_web_leaves_no_p_value_and_says_so():
    web = remembering(np.random.default_rng(11), (48, 96), 96.0)
    found = strips(web, 1.0)
    assert np.isnan(found.p_value)
    assert np.isnan(found.amplitude.standard_error)
    assert "4 are needed; lay a larger web" in found.amplitude.reason


def test_strips_in_a_web_that_remembers_are_found():
    web = remembering(np.random.default_rng(12), (48, 400), 5.0)
    place = np.arange(48) + 0.5
    web += 0.1 * np.cos(2 * np.pi * place / 6.0)[:, None]
    found = strips(web, 1.0)
    assert found.p_value < 1e-6
    assert abs(found.amplitude - 0.1) < 4 * found.amplitude.standard_error


def test_the_error_of_no_amplitude_is_that_of_the_noise():
    generator = np.random.default_rng(13)
    webs = [1 + uniform(generator, 0.3, (40, 80)) for _ in range(100)]
    found = [strips(web, 1.0, period=8.0) for web in webs]
    # Noise of 0.3 in 3200 pixels: E|c|² = 4 × 0.09/3200, known to a twelfth from some
    # 50 stretches; half of it is left of each direction.
    least = 0.7 * np.sqrt(2 * 0.09 / 3200)
    assert min(one.amplitude.standard_error for one in found) > least
    inside = [one.amplitude.interval()[0] <= 0.0 for one in found]
    # Of 100, 95 ± 2.2 are expected.
    assert np.mean(inside) > 0.95 - 4 * 0.022


def test_a_period_that_is_known_is_the_only_one_tried():
    generator = np.random.default_rng(9)
    webs = [1 + uniform(generator, 0.3, (40, 80)) for _ in range(200)]
    p_values = np.array([strips(web, 1.0, period=8.0).p_value for web in webs])
    # Uniform then: Kolmogorov's distance beyond 1.95/√200 has a probability of 1e-3.
    ranks = (np.arange(200) + 0.5) / 200
    assert np.abs(np.sort(p_values) - ranks).max() < 1.95 / np.sqrt(200)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"period": 1.5}, "`period` must lie between two pixels, 2, and half the web"),
        ({"period": 40.0}, "`period` must lie .* got 40"),
        ({"period": np.nan}, "`period` must be positive and finite, got nan"),
        ({"direction": "up"}, "`direction` must be one of 'machine', 'cross'"),
    ],
)
def test_what_is_no_strip_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        strips(np.ones((40, 60)), 1.0, **change)


def test_a_web_too_small_for_a_spectrum_or_strips_says_so():
    with pytest.raises(ValueError, match="`block` must leave 4 blocks of 8 × 8 pixels"):
        power_spectrum(np.ones((12, 12)), 1.0)
    with pytest.raises(ValueError, match="must hold 8 pixels or more across the strip"):
        strips(np.ones((6, 60)), 1.0)
    with pytest.raises(ValueError, match="`window` must be one of 'hann', 'none'"):
        power_spectrum(np.ones((40, 40)), 1.0, window="hamming")
    few = strips(striped(np.random.default_rng(1)), 1.0, block=80.0)
    assert np.isnan(few.p_value)
    assert "2 independent blocks of side 80, 4 are needed" in few.period.reason
