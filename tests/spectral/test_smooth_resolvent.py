"""The spectrum of a smooth fibre: its law, two forms, both ends, R → 0, and paths."""

import math
from dataclasses import replace

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent import smooth_spectrum
from fpsolve.spectral.resolvent.fibre import fibre_of
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_limit import (
    smooth_angle_limit,
    smooth_short_wave_limit,
)
from fpsolve.spectral.resolvent.smooth_solutions import (
    along_long_waves,
    along_short_waves,
)
from fpsolve.spectral.resolvent.smooth_spectrum import far_of, first_of
from fpsolve.spectral.resolvent.smooth_waves import (
    angle_moments,
    characteristic,
    position_variances,
)
from fpsolve.web import coherent

ISOTROPIC = fp.QuadraticPotential()
V = 0.2
BELT = fp.SmoothLayDownModel(ISOTROPIC, 0.1, 2.0, fp.MovingBelt(V))
NARROW = fp.SmoothLayDownModel(
    fp.QuadraticPotential(1.0, 0.7), 0.1, 2.0, fp.MovingBelt(V)
)
LAW = SmoothBasis(11, 6, 8)


@pytest.fixture(scope="module")
def belt():
    return fibre_of(BELT)


@pytest.fixture(scope="module")
def narrow():
    return fibre_of(NARROW)


def test_the_stationary_law_is_that_of_the_body_frame(belt):
    """`spectral_steady_state` expands it in other functions; E cos α = −v exactly."""
    law = belt.generator(LAW)
    known = fp.spectral_steady_state(BELT, tolerance=1e-4).moments
    mean, along, across = position_variances(law)
    # What a truncation of degree 11 leaves; both know the moments to 1e-4.
    assert mean == pytest.approx(known["mean_xi1"], rel=1e-4)
    assert along == pytest.approx(known["variance_xi1"], rel=1e-4)
    assert across == pytest.approx(known["variance_xi2"], rel=1e-4)
    assert angle_moments(law, 0)[1] == pytest.approx(-V, abs=1e-5)
    assert angle_moments(law, 2)[0] == pytest.approx(known["mean_kappa2"], rel=1e-4)


def test_every_placement_gives_the_same_law(narrow):
    """The basis is wider, not the fibre: |φ(k)| of two widths."""
    law = narrow.generator(LAW)
    width1, width2 = law.placement.widths
    wider = replace(
        law, placement=replace(law.placement, widths=(1.1 * width1, 1.1 * width2))
    )
    for k in (0.5, 1.5):
        found = [characteristic(one, (0.3, k)) for one in (law, wider)]
        assert abs(found[0]) == pytest.approx(abs(found[1]), abs=2e-4)


def test_curvature_and_direction_balance(narrow):
    """E κ² = K²R/2 + E cos²α/σ1² + E sin²α/σ2² − v²/σ1² exactly; ⟨τ⊗τ⟩ is told so."""
    law = narrow.generator(LAW)
    double = angle_moments(law, 0)[2]
    force = 0.5 * (1 + double) + 0.5 * (1 - double) / 0.7**2 - V**2
    square = angle_moments(law, 2)[0]
    # Of the 20 that the noise gives; the truncation leaves 4e-4 of the force's part.
    assert square - NARROW.curvature_variance == pytest.approx(force, rel=2e-3)
    orientation, _ = coherent.orientation(narrow)
    assert orientation[0, 0] == pytest.approx(0.5 * (1 + double), abs=1e-3)


@pytest.mark.parametrize("k", [(0.0, 1.6), (1.2, 1.4)])
def test_both_forms_agree_where_both_converge(narrow, k):
    """They share the generator, but neither the equation nor what is projected out."""
    law = narrow.generator(LAW)
    (long,) = along_long_waves(law, k[0], [k[1]])
    basis = first_of(narrow, math.hypot(*k)).grown(1)
    p = basis.picked(LAW.table(law.stationary))
    (short,) = along_short_waves(narrow.generator(basis), [p], k)
    # What both truncations leave at |k| σ near 2.
    assert short == pytest.approx(long, rel=4e-3)


@pytest.mark.nightly
def test_the_basic_spectrum_is_approached_at_first_order():
    """Ŝ_R − Ŝ_0 = c R + O(R²), at every halving of R."""
    basic = fp.LayDownModel(ISOTROPIC, 2.0, fp.MovingBelt(V))
    limit = float(fp.web_spectrum(basic, 0.5, 1.0, tolerance=1e-5))
    away = []
    for length in (0.04, 0.02, 0.01, 0.005):
        smooth = fp.SmoothLayDownModel(ISOTROPIC, length, 2.0, fp.MovingBelt(V))
        generator = fibre_of(smooth).generator(SmoothBasis(11, 6, 7))
        away.append(along_long_waves(generator, 0.5, [1.0])[0] - limit)
    orders = np.log2(np.array(away[:-1]) / away[1:])
    # From 0.93 on; the last truncations lack about 1e-3 of Ŝ, 0.02 of the order.
    assert orders == pytest.approx(1.0, abs=0.1)
    assert orders[-1] > orders[0]


def test_long_waves_end_in_a_quadratic_form(narrow):
    """Ŝ = k·V k + O(k⁴), and the reflection of ξ2 leaves no mixed term."""
    generator, small = narrow.generator(SmoothBasis(8, 5, 7)), 1e-3
    across, none = along_long_waves(generator, 0.0, [small, 0.0])
    along, both, steep = along_long_waves(generator, small, [0.0, small, 2 * small])
    assert both == pytest.approx(along + across, rel=1e-4)
    assert steep == pytest.approx(along + 4 * across, rel=1e-4)
    # Of k = 0 rounding is left.
    assert none == pytest.approx(0.0, abs=1e-12)


def test_short_waves_see_arcs():
    """At rest Ŝ → 2/|k| − E κ²/(4|k|³), E κ² = K²R/2 + 1 exactly."""
    rest = fp.SmoothLayDownModel(ISOTROPIC, 0.3, 2.0)
    fibre, k = fibre_of(rest), (0.6 * 40, 0.8 * 40)
    law = fibre.generator(SmoothBasis(10, 6, 9))
    square = rest.curvature_variance + 1.0
    arcs = smooth_short_wave_limit(law, k)
    assert smooth_angle_limit(law, k) * 40 == pytest.approx(2.0, rel=1e-9)
    assert (2 / 40 - arcs) * 4 * 40**3 == pytest.approx(square, rel=1e-3)


def test_the_arcs_go_on_where_truncations_end(belt):
    """Beyond `far_of` nothing is solved: held against a truncation that does it."""
    k = 1.5 * far_of(belt)
    wave = 0.6 * k, 0.8 * k
    spectrum = fp.web_spectrum(BELT, *wave, tolerance=1e-2)
    law = belt.laws(2e-3)[0]
    basis = SmoothBasis(4, 26, 18)
    p = basis.picked(law.basis.table(law.stationary))
    (solved,) = along_short_waves(belt.generator(basis), [p], wave)
    assert abs(float(spectrum) - solved) <= float(spectrum.errors)
    assert float(spectrum.errors) <= 1e-2 / k * 2.2


@pytest.mark.nightly
def test_errors_cover_the_distance_to_larger_truncations():
    """Where few functions suffice, R = 0.05 and A = 4; validation has other cases."""
    loud = fp.SmoothLayDownModel(
        fp.QuadraticPotential(1.0, 0.7), 0.05, 4.0, fp.MovingBelt(V)
    )
    fibre = fibre_of(loud)
    k1, k2 = np.array([0.2, 0.8, 6.0]), np.array([0.5, 1.0, 8.0])
    coarse, errors = fibre.spectrum(k1, k2, 3e-2)
    fine, left = fibre.spectrum(k1, k2, 3e-3)
    assert (errors <= 3e-2 * np.maximum(coarse, 0.7 / (1 + np.hypot(k1, k2)))).all()
    assert (np.abs(coarse - fine) <= errors + left).all()
    assert (fine > 0).all()


@pytest.mark.nightly
def test_periodograms_of_paths_agree_within_their_standard_errors():
    """Over S with k1 v S = 2πn the coherent line has no part in them."""
    k2, ds, steps = np.array([0.0, 1.0]), 1 / 16, 4000
    k1 = 8 * 2 * math.pi / (V * ds * steps)
    s = 20.0 + ds * np.arange(steps)
    initial = EquilibriumLaw(ISOTROPIC)
    paths = fp.sample_paths(BELT, 300, s[-1], ds, seed=5, initial=initial, save_at=s)
    spectrum = fp.web_spectrum(BELT, k1, k2, tolerance=2e-2)
    along = np.asarray(paths.xi)[..., 0] - V * s[:, None]
    for one, expected in zip(k2, spectrum, strict=True):
        wave = np.exp(1j * (k1 * along + one * np.asarray(paths.xi)[..., 1]))
        powers = np.abs(wave.sum(axis=0) * ds) ** 2 / (ds * steps)
        error = powers.std(ddof=1) / math.sqrt(powers.size)
        # As for the basic model; the tolerance is less than half a standard error.
        assert powers.mean() == pytest.approx(expected, abs=3 * error)


def test_what_no_truncation_resolves_is_refused(monkeypatch):
    monkeypatch.setattr(smooth_spectrum, "MOST_LONG", 5000)
    quiet = fp.SmoothLayDownModel(ISOTROPIC, 0.5, 0.7, fp.MovingBelt(0.1))
    with pytest.raises(ToleranceError, match="no truncation of 5000 states"):
        fp.web_spectrum(quiet, 0.5, 1.0, tolerance=1e-3)


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (
            fp.SmoothLayDownModel(fp.LinearPotential(), 0.1, 1.0),
            "`potential` must be a QuadraticPotential",
        ),
        (fp.SmoothLayDownModel(ISOTROPIC, 0.1, 0.0), "`noise` must be positive, got 0"),
        (
            fp.SmoothLayDownModel(
                ISOTROPIC, 0.1, 1.0,
                fp.RotatingNozzle(speed=0.1, radius=0.5, angular_speed=0.1),
            ),
            "`curve` must be a belt",
        ),
    ],
)  # fmt: skip
def test_what_has_no_spectrum_is_refused(model, words):
    with pytest.raises(ValueError, match=words):
        fp.web_spectrum(model, 0.5, 0.5)
