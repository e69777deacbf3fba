"""Spectra under isotropic potentials: radial functions in place of Hermite's."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.limit import angle_harmonics
from fpsolve.spectral.resolvent.long_limit import long_wave_form
from fpsolve.spectral.resolvent.plane_waves import characteristic, multiplied
from fpsolve.spectral.resolvent.round_basis import RoundBasis
from fpsolve.spectral.resolvent.round_generator import RoundGenerator
from fpsolve.spectral.resolvent.round_ladder import RoundLadder
from fpsolve.spectral.resolvent.waves import along_long_waves, along_short_waves
from fpsolve.studies.rates.poisson import asymptotic_variances

QUADRATIC = fp.QuadraticPotential()
QUARTIC = fp.PowerPotential(4)
SEXTIC = fp.PowerPotential(6, scale=1.2)
HARMONIC = fp.LayDownModel(QUADRATIC, 1.3, fp.MovingBelt(0.2))
BELT = fp.LayDownModel(QUARTIC, 1.0, fp.MovingBelt(0.1))
REST = fp.LayDownModel(QUARTIC, 1.0)


@pytest.fixture(scope="module")
def both():
    """The same model in the two bases, which span the same functions."""
    return (
        RoundGenerator(HARMONIC, RoundBasis(12, 7), 0.0),
        Generator(HARMONIC, Basis(12, 7), 0.0),
    )


def test_cosines_and_sines_are_orthonormal_and_as_many_as_products():
    basis = RoundBasis(7, 4)
    gram = (basis.real.conj().T @ basis.real).toarray()
    assert gram == pytest.approx(np.eye(basis.size), abs=1e-15)
    assert basis.size == Basis(7, 4).size
    even, odd = basis.parity(1), basis.parity(-1)
    places = np.concatenate([[0], even, odd])
    assert np.array_equal(np.sort(places), np.arange(basis.size))


def test_a_quadratic_potential_has_the_same_spectrum_in_both_bases(both):
    """One space, two bases of it: equal to rounding, whatever the truncation lacks."""
    for k in ((0.3, 0.4), (1.0, 0.5), (0.0, 2.0)):
        waves = [characteristic(generator, k) for generator in both]
        assert waves[0] == pytest.approx(waves[1], abs=1e-13)
        rows = [np.linalg.norm(multiplied(generator, k)) for generator in both]
        assert rows[0] == pytest.approx(rows[1], rel=1e-12)
        long = [along_long_waves(generator, k[0], [k[1]])[0] for generator in both]
        assert long[0] == pytest.approx(long[1], rel=1e-11)
        short = [along_short_waves(generator, k) for generator in both]
        assert short[0] == pytest.approx(short[1], rel=1e-11)
    assert both[0].mean == pytest.approx(both[1].mean, rel=1e-12)
    forms = [long_wave_form(generator) for generator in both]
    assert forms[0] == pytest.approx(forms[1], rel=1e-11)
    harmonics = [angle_harmonics(generator) for generator in both]
    assert harmonics[0] == pytest.approx(harmonics[1], abs=1e-13)


def test_parities_do_not_mix_under_reflection(both):
    for generator in (both[0], RoundGenerator(BELT, RoundBasis(9, 5), 0.0)):
        even, odd = (generator.basis.parity(sign) for sign in (1, -1))
        # Of what folding leaves beside exact zeros.
        assert np.abs(generator.matrix[even][:, odd]).max() < 1e-13
        assert np.abs(generator.matrix[odd][:, even]).max() < 1e-13


def test_at_rest_nothing_but_the_angle_loses_correlations():
    """L + Lᵀ = −A² k²: transport is antisymmetric in L²(e^{−B})."""
    generator = RoundGenerator(REST, RoundBasis(8, 4), 0.0)
    symmetric = (generator.matrix + generator.matrix.T).toarray()
    diagonal = -np.square(generator.basis.orders[1].astype(float))
    assert symmetric == pytest.approx(np.diag(diagonal), abs=1e-12)


@pytest.mark.parametrize("potential", [QUARTIC, SEXTIC])
def test_at_rest_the_spectrum_is_the_variance_of_averages_of_waves(potential):
    """Ŝ = s Var of ∫cos k·ξ/s and of the sine: another basis, sector by sector."""
    model, k = fp.LayDownModel(potential, 1.5), (0.6, 0.8)
    known = asymptotic_variances(
        model,
        {
            "even": lambda x, y, a: np.cos(k[0] * x + k[1] * y) + 0 * a,
            "odd": lambda x, y, a: np.sin(k[0] * x + k[1] * y) + 0 * a,
        },
        tolerance=1e-5,
    )
    spectrum = fp.web_spectrum(model, *k, tolerance=1e-4)
    off = abs(float(spectrum) - known.values.sum())
    assert off <= float(spectrum.errors) + known.errors.sum()
    assert float(spectrum.errors) <= 1e-4 * float(spectrum)


@pytest.mark.parametrize("k", [(0.0, 1.0), (0.6, 0.9), (1.2, 1.2)])
def test_both_forms_agree_where_both_converge(k):
    """Neither the equation nor what is projected out is shared.

    Degree 20 leaves some 1e-4 at A = 1.
    """
    generator = RoundLadder(BELT).generator(Basis(20, 9))
    (long,) = along_long_waves(generator, k[0], [k[1]])
    assert along_short_waves(generator, k) == pytest.approx(long, rel=5e-4)


def test_errors_cover_the_distance_to_a_smaller_tolerance():
    k1, k2 = np.array([0.1, 0.8, 5.0]), np.array([0.3, 1.0, 3.0])
    model = fp.LayDownModel(QUARTIC, 2.0, fp.MovingBelt(0.2))
    coarse = fp.web_spectrum(model, k1, k2, tolerance=1e-2)
    fine = fp.web_spectrum(model, k1, k2, tolerance=5e-4)
    assert (np.abs(coarse - fine) <= coarse.errors + fine.errors).all()
    assert (fine.errors < coarse.errors).any()


def test_short_waves_see_straight_pieces_and_long_ones_a_form():
    """At rest 2/|k| and c |k|² with one c, since no direction is preferred."""
    far = fp.web_spectrum(REST, 300.0, 400.0)
    assert far == pytest.approx(2 / 500, rel=1e-4)
    near = fp.web_spectrum(REST, [1e-5, 0.0, 6e-6], [0.0, 1e-5, 8e-6])
    assert np.asarray(near) == pytest.approx(float(near[0]), rel=1e-9)


def test_users_potentials_give_the_same_numbers():
    """B = r⁴/4 by two functions of the user's."""
    own = fp.IsotropicPotential(lambda r: 0.25 * r**4, lambda r: r**3)
    model = fp.LayDownModel(own, 1.0, fp.MovingBelt(0.1))
    found = [fp.web_spectrum(one, 0.6, 0.8, tolerance=5e-3) for one in (model, BELT)]
    assert float(found[0]) == pytest.approx(float(found[1]), rel=1e-9)


def test_periodograms_of_paths_agree_within_their_standard_errors():
    """Over S with k1 v S = 2πn the coherent line has no part in them."""
    v, ds, steps, k2 = 0.3, 1 / 16, 4000, np.array([0.0, 1.0, 2.5])
    k1 = 12 * 2 * math.pi / (v * ds * steps)
    model = fp.LayDownModel(QUARTIC, 2.0, fp.MovingBelt(v))
    s = 20.0 + ds * np.arange(steps)
    paths = fp.sample_paths(
        model, 300, s[-1], ds, seed=5, initial=EquilibriumLaw(QUARTIC), save_at=s
    )
    spectrum = fp.web_spectrum(model, k1, k2)
    xi1, xi2 = np.moveaxis(np.asarray(paths.xi), 2, 0)
    for one, expected in zip(k2, spectrum, strict=True):
        wave = np.exp(1j * (k1 * (xi1 - v * s[:, None]) + one * xi2))
        powers = np.abs(wave.sum(axis=0) * ds) ** 2 / (ds * steps)
        error = powers.std(ddof=1) / math.sqrt(powers.size)
        # The largest of three; of the sum over steps and the triangle 1 − s/S less
        # than 1 % remains, as for the quadratic potential.
        assert powers.mean() == pytest.approx(expected, abs=3 * error)


@pytest.mark.parametrize(
    ("potential", "words"),
    [
        (fp.LinearPotential(), "`potential` must be a smooth function of ‖ξ‖²"),
        (fp.FreePotential(), "`potential` must confine"),
        (
            fp.CallablePotential(
                lambda x, y: x**4 / 4 + y**2 / 2, lambda x, y: (x**3, y)
            ),
            "`potential` must be quadratic or isotropic",
        ),
    ],
)
def test_potentials_without_a_basis_are_refused(potential, words):
    with pytest.raises(ValueError, match=words):
        fp.web_spectrum(fp.LayDownModel(potential, 1.0), 0.5, 0.5)


def test_too_fast_a_belt_is_refused_with_what_was_reached():
    """It lays the fibre where e^{−B} has no weight: A² v = 40 of it."""
    model = fp.LayDownModel(QUARTIC, 10.0, fp.MovingBelt(0.4))
    with pytest.raises(ToleranceError, match="no truncation of 500 states") as raised:
        RoundLadder(model).climb(
            Basis(4, 3),
            lambda g: along_long_waves(g, 0.3, [0.4]),
            lambda found: 1e-3 * np.abs(found),
            most=500,
        )
    assert raised.value.reached > raised.value.tolerance
