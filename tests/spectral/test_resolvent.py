"""The spectrum of a fibre: two forms, its ends, the limit of large noise, and paths."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.centre import centre_of, concentration
from fpsolve.spectral.resolvent.fibre import fibre_of
from fpsolve.spectral.resolvent.fibre_spectrum import FAR, FIRST_LONG
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import SAFETY
from fpsolve.spectral.resolvent.limit import angle_density, short_wave_limit
from fpsolve.spectral.resolvent.waves import along_long_waves, along_short_waves

ISOTROPIC = fp.QuadraticPotential()
BELT = fp.LayDownModel(ISOTROPIC, 1.0, fp.MovingBelt(0.1))
REST = fp.LayDownModel(ISOTROPIC, 1.5)
NARROW = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.6), 2.0, fp.MovingBelt(0.2))
TURNING = fp.LayDownModel(
    ISOTROPIC, 1.0, fp.RotatingNozzle(speed=0.1, radius=0.5, angular_speed=0.1)
)
NOISY = fp.LayDownModel(ISOTROPIC, 10.0, fp.MovingBelt(0.1))


@pytest.mark.parametrize("model", [BELT, REST, NARROW, NOISY])
@pytest.mark.parametrize("k", [(0.0, 1.0), (0.4, 0.9), (1.2, 0.0), (1.5, 1.5)])
def test_both_forms_agree_where_both_converge(model, k):
    """They share the generator, but neither the equation nor what is projected out."""
    generator = Generator(model, Basis(20, 12), centre_of(model))
    (long,) = along_long_waves(generator, k[0], [k[1]])
    # What the truncation leaves at |k|σ = 2 and the lowest noise.
    assert along_short_waves(generator, k) == pytest.approx(long, rel=5e-5)


@pytest.mark.parametrize("model", [BELT, NARROW])
def test_the_stationary_law_is_that_of_the_expansion(model):
    generator = Generator(model, Basis(20, 12), centre_of(model))
    steady = fp.spectral_steady_state(model, tolerance=1e-7)
    assert generator.mean == pytest.approx(steady.moments["mean_xi1"], abs=2e-6)
    # E cos α = −v in every truncation: of L ξ1 = cos α + v no part is left out.
    alpha = np.linspace(0, 2 * math.pi, 64, endpoint=False)
    f = angle_density(generator, alpha)
    assert np.mean(f) * 2 * math.pi == pytest.approx(1, abs=1e-12)
    cosine = np.mean(f * np.cos(alpha)) * 2 * math.pi
    assert cosine == pytest.approx(-model.curve.speed, abs=1e-12)


def test_every_centre_gives_the_same_spectrum():
    """The basis is moved, not the model: as for A = 10, where the mean is 10 σ away."""
    spectra = [
        along_short_waves(Generator(NOISY, Basis(14, 8), centre), (0.2, 1.0))
        for centre in (10.05, 9.5)
    ]
    assert spectra[0] == pytest.approx(spectra[1], rel=1e-8)
    assert centre_of(NOISY) == pytest.approx(10.0509, abs=1e-3)


def test_errors_cover_the_distance_to_larger_truncations():
    k1, k2 = np.array([0.1, 0.8, 1.4, 2.0, 3.0]), np.array([0.3, 1.0, 2.0, 3.0, 4.0])
    for model in (BELT, NARROW):
        coarse = fp.web_spectrum(model, k1, k2, tolerance=1e-2)
        fine = fp.web_spectrum(model, k1, k2, tolerance=5e-4)
        assert (
            coarse.errors <= 1e-2 * np.maximum(coarse, 1 / (1 + np.hypot(k1, k2)))
        ).all()
        assert (np.abs(coarse - fine) <= coarse.errors + fine.errors).all()


def test_the_spectrum_is_even_and_positive():
    k1, k2 = np.array([0.5, 2.0, 4.0]), np.array([1.0, 0.3, 3.0])
    spectrum = fp.web_spectrum(BELT, k1, k2)
    assert (spectrum > 0).all()
    for signs in ((-1, -1), (1, -1), (-1, 1)):
        assert (fp.web_spectrum(BELT, signs[0] * k1, signs[1] * k2) == spectrum).all()


def test_large_noise_gives_the_spectrum_of_an_ornstein_uhlenbeck_process():
    """Ŝ = 2A² ∫ (e^{−k²(1 − e^{−t})} − e^{−k²}) dt, off by O(A⁻⁴) as the rate is.

    ξ has then the correlation e^{−s/A²}; the initial layer is shorter by A⁻⁴, too.
    """
    k = 1.0
    shape, _ = quad(
        lambda t: math.exp(k * k * (math.exp(-t) - 1)) - math.exp(-k * k), 0, 40
    )
    noises = np.array([4.0, 8.0, 16.0])
    found = [
        float(fp.web_spectrum(fp.LayDownModel(ISOTROPIC, A), 0.6, 0.8, tolerance=1e-6))
        for A in noises
    ]
    off = np.abs(np.array(found) / (2 * noises**2 * shape) - 1)
    orders = np.log2(off[:-1] / off[1:])
    assert orders == pytest.approx(4, abs=0.15)


def test_long_waves_end_in_a_quadratic_form():
    """Ŝ = k·V k + O(k⁴), V what the law of large numbers leaves of ∫ ξ ds."""
    small = fp.web_spectrum(
        NARROW, 1e-3 * np.array([1, 0, 1, 1]), 1e-3 * np.array([0, 1, 1, 2])
    )
    along, across, both, steep = np.asarray(small) * 1e6
    assert both == pytest.approx(along + across, rel=1e-5)
    assert steep == pytest.approx(along + 4 * across, rel=1e-5)
    assert fp.web_spectrum(NARROW, 0.0, 0.0) == 0.0


def test_short_waves_end_in_the_law_of_the_angle():
    """They lack O(|k|⁻²), at every doubling once |k| ≫ A²/2; at rest it is 2/|k|."""
    generator = Generator(fp.LayDownModel(ISOTROPIC, 1.0), Basis(6, 44), 0.0)
    sizes = np.array([50.0, 100.0, 200.0, 400.0])
    found = [along_short_waves(generator, (0.6 * k, 0.8 * k)) for k in sizes]
    law = [short_wave_limit(generator, (0.6 * k, 0.8 * k)) for k in sizes]
    assert np.array(law) * sizes == pytest.approx(2, rel=1e-12)
    off = np.abs(np.array(found) / law - 1)
    assert np.log2(off[:-1] / off[1:]) == pytest.approx(2, abs=0.03)


def test_the_law_of_the_angle_goes_on_where_truncations_end():
    """On both sides of where it begins |k| Ŝ agrees within the errors of both.

    |k| Ŝ itself changes by less than 1e-6 between them, of its order |k|⁻².
    """
    k = np.array([0.999, 1.001]) * FAR
    spectrum = fp.web_spectrum(NARROW, 0.6 * k, 0.8 * k)
    near, far = spectrum * k
    assert abs(near - far) <= (spectrum.errors * k).sum() + 1e-6


def test_an_isotropic_law_has_two_over_k():
    far = fp.web_spectrum(REST, 300.0, 400.0)
    assert far == pytest.approx(2 / 500, rel=1e-4)


def test_periodograms_of_paths_agree_within_their_standard_errors():
    """Over S with k1 v S = 2πn the coherent line has no part in them."""
    v, k1, k2, ds, steps = 0.3, 1.0, np.array([0.0, 1.0, 2.5]), 1 / 16, 4000
    # 4000 steps are 12 periods of the belt: k1 = 1.0053.
    k1 = 12 * 2 * math.pi / (v * ds * steps)
    model = fp.LayDownModel(ISOTROPIC, 1.5, fp.MovingBelt(v))
    s = 20.0 + ds * np.arange(steps)
    initial = EquilibriumLaw(ISOTROPIC)
    paths = fp.sample_paths(model, 300, s[-1], ds, seed=5, initial=initial, save_at=s)
    spectrum = fp.web_spectrum(model, k1, k2)
    along = np.asarray(paths.xi)[..., 0] - v * s[:, None]
    for one, expected in zip(k2, spectrum, strict=True):
        wave = np.exp(1j * (k1 * along + one * np.asarray(paths.xi)[..., 1]))
        powers = np.abs(wave.sum(axis=0) * ds) ** 2 / (ds * steps)
        error = powers.std(ddof=1) / math.sqrt(powers.size)
        # Of three numbers the largest lies within 3 standard errors; the sum over
        # steps instead of an integral and the triangle 1 − s/S change less than 1 %.
        assert powers.mean() == pytest.approx(expected, abs=3 * error)


@pytest.mark.parametrize("v", [0.05, 0.5, 0.9, 0.999999])
def test_concentration_inverts_the_ratio_of_bessel_functions(v):
    from scipy.special import ive

    kappa = concentration(v)
    assert ive(1, kappa) / ive(0, kappa) == pytest.approx(v, rel=1e-6)
    assert concentration(0.0) == 0.0


def test_it_is_an_array_with_errors_beside_it():
    spectrum = fp.web_spectrum(BELT, [[0.5], [1.0]], [0.0, 1.0, 2.0])
    assert spectrum.shape == spectrum.errors.shape == (2, 3)
    assert isinstance(spectrum[0], fp.WebSpectrum)
    assert spectrum[0].errors.shape == (3,)
    assert type(2 * spectrum) is np.ndarray
    assert type(np.asarray(spectrum)) is np.ndarray
    single = fp.web_spectrum(BELT, 0.5, 0.0)
    assert float(single) == pytest.approx(spectrum[0, 0], rel=2e-3)
    assert single.shape == ()
    assert single > 0


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"k1": math.nan}, ValueError, "`k1` must be finite"),
        ({"k2": "one"}, TypeError, "`k2` must hold real numbers"),
        ({"tolerance": math.nan}, ValueError, "`tolerance` must be positive"),
        ({"model": 1.0}, TypeError, "`model` must be a LayDownModel"),
        (
            {"model": fp.LayDownModel(fp.LinearPotential(), 1.0)},
            ValueError,
            "`potential` must be a smooth function",
        ),
        (
            {"model": fp.LayDownModel(ISOTROPIC, 0.0)},
            ValueError,
            "`noise` must be positive, got 0",
        ),
        (
            {
                "model": fp.LayDownModel(
                    ISOTROPIC,
                    1.0,
                    fp.RotatingNozzle(speed=0.1, radius=0.5, angular_speed=0.1),
                )
            },
            ValueError,
            "`curve` must be a belt",
        ),
    ],
)
def test_what_has_no_spectrum_is_refused(change, error, words):
    arguments = {"model": BELT, "k1": 0.5, "k2": 0.5} | change
    with pytest.raises(error, match=words):
        fp.web_spectrum(**arguments)


def test_too_little_noise_is_refused_with_what_was_reached(monkeypatch):
    from fpsolve.spectral.resolvent import fibre_spectrum

    monkeypatch.setattr(fibre_spectrum, "MOST_STATES", 5000)
    model = fp.LayDownModel(ISOTROPIC, 0.2, fp.MovingBelt(0.1))
    with pytest.raises(ToleranceError, match="no truncation of 5000 states") as raised:
        fp.web_spectrum(model, 0.5, 1.0)
    assert raised.value.reached > raised.value.tolerance


@pytest.mark.nightly
def test_little_noise_asks_three_truncations_to_agree_on_long_waves():
    """A = 0.5: the first two agree to 2e-4 on what is wrong by 4e-3, by chance."""
    model = fp.LayDownModel(fp.QuadraticPotential(), 0.5, fp.MovingBelt(0.1))
    fibre, k1, k2 = fibre_of(model), 0.18335056, 0.07989665
    first, second, large = (
        float(along_long_waves(fibre.generator(basis), k1, [k2])[0])
        for basis in (FIRST_LONG, FIRST_LONG.grown(1), FIRST_LONG.grown(3))
    )
    # What was the error before: it does not cover.
    assert SAFETY * abs(second - first) < 0.2 * abs(second - large)
    for tolerance in (3e-2, 1e-2):
        value, error = fibre.spectrum(np.array([k1]), np.array([k2]), tolerance)
        assert abs(value[0] - large) < error[0] <= tolerance * value[0]
