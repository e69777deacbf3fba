"""Spectra on a belt at rest, sector by sector, down to little noise."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent import rest
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.long_limit import long_wave_form
from fpsolve.spectral.resolvent.rest import AtRest, at_rest, bessel, is_round_at_rest
from fpsolve.spectral.resolvent.round_ladder import RoundLadder
from fpsolve.spectral.resolvent.waves import along_long_waves

QUADRATIC, QUARTIC = fp.QuadraticPotential(), fp.PowerPotential(4)
SIZES = np.array([0.1, 1.0, 2.5])


@pytest.mark.parametrize("potential", [QUADRATIC, QUARTIC])
def test_sectors_add_up_to_the_resolvent_of_all_of_them(potential):
    """Of Hermite polynomials or all radial waves at once; they lack 2e-4 at A = 1.2."""
    model = fp.LayDownModel(potential, 1.2)
    ladder = (Ladder if potential is QUADRATIC else RoundLadder)(model)
    generator = ladder.generator(Basis(20, 9))
    whole = [along_long_waves(generator, 0.0, [k])[0] for k in SIZES]
    parts = AtRest(model, Basis(48, 20)).spectrum(SIZES)
    assert parts == pytest.approx(np.array(whole), rel=2e-4)


def test_long_waves_end_in_the_form_at_every_halving():
    """Relatively by O(|k|²), down to where Hermite polynomials know the form."""
    model = fp.LayDownModel(QUADRATIC, 2.0)
    sizes = 0.1 / 2.0 ** np.arange(5)
    ratios = AtRest(model, Basis(48, 20)).spectrum(sizes) / sizes**2
    form = long_wave_form(Generator(model, Basis(20, 9), 0.0))[0]
    off = np.abs(ratios / form - 1)
    assert np.log2(off[:-1] / off[1:]) == pytest.approx(2, abs=0.02)
    tiny = fp.web_spectrum(model, 1e-150, 0.0)
    assert float(tiny) / 1e-300 == pytest.approx(form, rel=1e-6)


def test_the_bessel_function_less_one_keeps_its_digits():
    x = np.array([1e-9, 0.9999 * rest.SMALL, 1.0001 * rest.SMALL, 2.0])
    exact = -(x**2) / 4 + x**4 / 64 - x**6 / 2304
    # J0 − 1 by subtraction is known to 1e-16 of 1, which is 1e-9 at SMALL.
    assert bessel(0, x)[:3] == pytest.approx(exact[:3], rel=1e-9)
    assert bessel(0, x)[0] == pytest.approx(-2.5e-19, rel=1e-12)


@pytest.mark.parametrize("noise", [0.5, pytest.param(0.3, marks=pytest.mark.nightly)])
def test_at_little_noise_errors_cover_the_distance_to_smaller_tolerances(noise):
    model = fp.LayDownModel(QUADRATIC, noise)
    coarse, error = at_rest(model, SIZES, 2e-2)
    fine, finer = at_rest(model, SIZES, 5e-3)
    assert (error <= 2e-2 * coarse).all()
    assert (np.abs(coarse - fine) <= error + finer).all()


@pytest.mark.nightly
def test_at_little_noise_periodograms_of_paths_agree():
    """A = 0.3, which no truncation of 24 000 products resolves: 200 long fibres.

    They begin in the stationary law, and are 750 long, against a memory of 1/A² = 11:
    the triangle 1 − s/S takes about 1.5 %, less than a standard error.
    """
    ds, steps = 1 / 8, 6000
    model = fp.LayDownModel(QUADRATIC, 0.3)
    s = ds * np.arange(steps)
    paths = fp.sample_paths(
        model, 200, s[-1], ds, seed=3, initial=EquilibriumLaw(QUADRATIC), save_at=s
    )
    xi1, xi2 = np.moveaxis(np.asarray(paths.xi), 2, 0)
    spectrum = fp.web_spectrum(model, [0.6, 1.2], [0.8, 1.6])
    for k, expected in zip(((0.6, 0.8), (1.2, 1.6)), spectrum, strict=True):
        wave = np.exp(1j * (k[0] * xi1 + k[1] * xi2))
        # The coherent line at rest is a part of every periodogram.
        wave -= math.exp(-0.5 * (k[0] ** 2 + k[1] ** 2))
        powers = np.abs(wave.sum(axis=0) * ds) ** 2 / (ds * steps)
        error = powers.std(ddof=1) / math.sqrt(powers.size)
        assert powers.mean() == pytest.approx(expected, abs=3 * error)
        assert error < 0.1 * expected


@pytest.mark.parametrize("size", [3.2, 4.0])
def test_short_waves_at_rest_are_those_of_larger_sectors(size):
    """Where products of polynomials agreed in a row on 0.373 in place of 0.480."""
    model = fp.LayDownModel(QUADRATIC, 0.3)
    spectrum = fp.web_spectrum(model, 0.6 * size, 0.8 * size, tolerance=1e-2)
    (larger,) = AtRest(model, Basis(110, 40)).spectrum(np.array([size]))
    assert abs(float(spectrum) - larger) <= float(spectrum.errors) + 1e-4 * larger


def test_short_waves_of_little_noise_on_a_belt_are_refused():
    model = fp.LayDownModel(QUADRATIC, 0.3, fp.MovingBelt(0.1))
    with pytest.raises(ToleranceError, match="choose a larger noise or longer waves"):
        fp.web_spectrum(model, 1.9, 2.6, tolerance=1e-2)


def test_what_keeps_the_angular_index_is_told():
    assert is_round_at_rest(fp.LayDownModel(QUARTIC, 1.0))
    assert not is_round_at_rest(fp.LayDownModel(QUARTIC, 1.0, fp.MovingBelt(0.1)))
    narrow = fp.QuadraticPotential(1.0, 0.5)
    assert not is_round_at_rest(fp.LayDownModel(narrow, 1.0))


def test_what_is_too_quiet_is_refused_with_what_was_reached(monkeypatch):
    monkeypatch.setattr(rest, "LAST_LEVEL", 2)
    with pytest.raises(ToleranceError, match="orbits last for long") as raised:
        at_rest(fp.LayDownModel(QUADRATIC, 0.1), SIZES, 1e-3)
    assert raised.value.reached > 1e-3
