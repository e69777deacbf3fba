"""The end of long waves in closed form: two equations of Poisson."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.centre import centre_of
from fpsolve.spectral.resolvent.fibre_spectrum import FIRST_LONG, MOST_STATES
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.long_limit import (
    long_wave_form,
    long_wave_limit,
    reach_of,
)
from fpsolve.spectral.resolvent.waves import along_long_waves
from fpsolve.studies.rates.poisson import asymptotic_variances

ISOTROPIC = fp.QuadraticPotential()
NARROW = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.6), 2.0, fp.MovingBelt(0.2))
NOISY = fp.LayDownModel(ISOTROPIC, 8.0, fp.MovingBelt(0.1))
QUIET = fp.LayDownModel(ISOTROPIC, 0.5, fp.MovingBelt(0.1))


@pytest.mark.parametrize("model", [NARROW, NOISY])
@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (0.6, 0.8)])
def test_the_resolvent_approaches_the_form_at_every_halving_of_k(model, direction):
    """Of one truncation, relatively by O(|k|²), of which O((k1 v)²) is a part.

    A² v = 6 lays NOISY far from the nozzle and makes its peak in k1 narrow: from
    k1 v A² = 0.16 on each order is within 0.01 of 2.
    """
    generator = Generator(model, Basis(14, 7), centre_of(model))
    form = long_wave_form(generator)
    sizes = 0.025 / 2.0 ** np.arange(5)
    off = [
        along_long_waves(generator, direction[0] * k, [direction[1] * k])[0]
        / (form @ np.square(direction) * k * k)
        - 1
        for k in sizes
    ]
    orders = np.log2(np.abs(off[:-1]) / np.abs(off[1:]))
    assert orders == pytest.approx(2, abs=0.03)
    assert np.abs(np.diff(orders)).max() < 0.03


def test_at_rest_the_form_is_the_variance_of_averages_of_the_place():
    """2 E ξi (−L)⁻¹ ξi is what s times the variance of ∫ξi/s ends in, another basis."""
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.6), 1.5)
    known = asymptotic_variances(
        model, {"1": lambda x, y, a: x + 0 * a, "2": lambda x, y, a: y + 0 * a}
    )
    end = long_wave_limit(Ladder(model), FIRST_LONG, 1e-5, MOST_STATES)
    assert (np.abs(end.form - known.values) <= end.errors + known.errors).all()
    assert (end.errors <= 1e-5 * end.form).all()


def test_large_noise_ends_in_the_diffusion_of_an_ornstein_uhlenbeck_process():
    """c = 2 A² σ⁴, of which O(A⁻⁴) is lacking: orders at every doubling."""
    noises = np.array([4.0, 8.0, 16.0])
    found = [
        long_wave_form(Generator(fp.LayDownModel(ISOTROPIC, A), Basis(14, 7), 0.0))[0]
        for A in noises
    ]
    off = np.abs(np.array(found) / (2 * noises**2) - 1)
    assert np.log2(off[:-1] / off[1:]) == pytest.approx(4, abs=0.15)


def test_the_spectrum_keeps_its_relative_accuracy_down_to_no_wave_at_all():
    """From the resolvent to the form, and down to 1e-120: Ŝ/|k|² is one number.

    At |k| = 1e-2 it still lacks O(|k|²) of NARROW, 1e-4 of it.
    """
    sizes = np.array([1e-2, 1e-3, 4e-4, 1e-5, 1e-9, 1e-14, 1e-120])
    spectrum = fp.web_spectrum(NARROW, 0.6 * sizes, 0.8 * sizes)
    assert (spectrum.errors <= 1e-3 * spectrum).all()
    ratios = spectrum / sizes / sizes
    assert ratios[1:] == pytest.approx(ratios[-1], rel=2e-6)
    assert ratios[0] == pytest.approx(ratios[-1], rel=1e-4)


def test_errors_of_the_form_cover_the_resolvent_of_a_larger_truncation():
    reach = reach_of(Ladder(NARROW))
    for share in (1.0, 0.3):
        k = share * reach * np.array([0.6, 0.8])
        spectrum = fp.web_spectrum(NARROW, *k)
        generator = Generator(NARROW, Basis(24, 10), centre_of(NARROW))
        exact = along_long_waves(generator, k[0], [k[1]])[0]
        assert abs(float(spectrum) - exact) <= float(spectrum.errors)
        # Most of it is what the form lacks: the bound is no more than three times that.
        lacking = long_wave_form(generator) @ k**2 - exact
        assert float(spectrum.errors) < 3 * abs(lacking) + 1e-6 * exact


def test_no_wave_has_no_power():
    spectrum = fp.web_spectrum(QUIET, [0.0, 0.0], 0.0)
    assert (np.asarray(spectrum) == 0).all()
    assert (spectrum.errors == 0).all()


@pytest.mark.parametrize(("model", "blamed"), [(QUIET, True), (NOISY, False)])
def test_noise_is_blamed_only_where_more_of_it_would_help(model, blamed):
    with pytest.raises(ToleranceError, match="raise `tolerance`") as raised:
        Ladder(model).climb(
            Basis(4, 3), lambda g: np.array([[g.basis.size / 1.0]]), lambda x: 1e-9 * x,
            most=500,
        )  # fmt: skip
    assert ("or the noise" in str(raised.value)) == blamed
    assert "no truncation of 500 states is fine enough" in str(raised.value)
    assert math.isfinite(raised.value.reached)
