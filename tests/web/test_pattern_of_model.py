"""The mean pattern from the generator: limits, symmetries, errors, paths."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import jv

import fpsolve as fp
from fpsolve.errors import ToleranceError

QUADRATIC = fp.QuadraticPotential()
NARROW = fp.QuadraticPotential(1.0, 0.6)


def pattern_of(curve, noise=1.5, potential=QUADRATIC, spacing=2.5, **options):
    # Symmetries hold in every truncation, and small ones are quick.
    options.setdefault("tolerance", 1e-2)
    model = fp.LayDownModel(potential, noise, curve)
    return fp.mean_pattern(model, spacing=spacing, **options)


def coefficient(pattern, n, m):
    middle1, middle2 = (size // 2 for size in pattern.coefficients.shape)
    return pattern.coefficients[middle1 + n, middle2 + m]


def test_the_formula_of_small_curvature_is_approached_with_order_two():
    """2|J₁(kr) φ(k)| with ω/v = k = 1, r = 1: halving ω halves v and ωr."""
    formula = 2 * jv(1, 1.0) * math.exp(-0.5)
    away, errors = [], []
    for omega in (0.05, 0.025, 0.0125):
        curve = fp.RotatingNozzle(omega, 1.0, omega)
        value, error = pattern_of(curve, 1.0, tolerance=1e-4).amplitude(1, 0)
        away.append(abs(value - formula))
        errors.append(error)
    orders = np.log2(np.array(away[:-1]) / away[1:])
    # The next term is of order four: (ωr)² times that of order two, up to 2 % here.
    assert np.all(np.abs(orders - 2) < 0.05), orders
    # The distances are those of the patterns, and not of their truncations.
    assert np.all(np.array(errors) < 0.1 * np.array(away))


@pytest.mark.parametrize(
    ("curve", "noise", "potential"),
    [
        (fp.RotatingNozzle(0.5, 0.8, 1.0), 1.5, QUADRATIC),
        (fp.OscillatingNozzle(-0.3, 0.8, 0.5), 1.5, NARROW),
        (fp.EllipticNozzle(0.3, 0.5, 0.8, 0.6, 0.4), 3.0, NARROW),
    ],
)
def test_the_errors_cover_what_larger_truncations_change(curve, noise, potential):
    rough = pattern_of(curve, noise, potential, tolerance=5e-2)
    fine = pattern_of(curve, noise, potential, tolerance=1e-3)
    away = np.abs(rough.coefficients - fine.coefficients)
    assert np.all(away <= rough.errors)
    # Not by being enormous, and there is something to be covered.
    assert rough.errors.max() <= 2.5e-2
    assert fine.errors.max() <= 5e-4
    assert np.abs(fine.coefficients).max() == 1.0


def test_an_oscillation_is_its_own_mirror_image_half_a_period_later():
    """c_{n,−m} = (−1)ⁿ c_{nm}, to rounding: truncations have the symmetry."""
    c = pattern_of(fp.OscillatingNozzle(0.3, 0.8, 0.5), potential=NARROW).coefficients
    n = np.arange(c.shape[0]) - c.shape[0] // 2
    np.testing.assert_allclose(
        c[:, ::-1], ((-1.0) ** np.abs(n))[:, None] * c, atol=1e-9
    )
    assert np.abs(c[n % 2 == 1]).max() > 1e-3


def test_turning_the_other_way_is_the_mirror_image():
    here, there = (
        pattern_of(fp.RotatingNozzle(0.5, 0.8, omega)).coefficients
        for omega in (1.0, -1.0)
    )
    # GMRES leaves 1e-9 of the right-hand side.
    np.testing.assert_allclose(here[:, ::-1], there, atol=1e-7)


def test_a_nozzle_that_is_ahead_lays_the_same_pattern_farther_on():
    """γ with a phase φ is γ(s + φ/ω) + v φ/ω e₁."""
    curve = fp.RotatingNozzle(0.5, 0.8, 1.0)
    early = pattern_of(replace(curve, phase=1.0))
    of_row = pattern_of(curve, phases=[1.0])
    np.testing.assert_allclose(early.coefficients, of_row.coefficients, atol=1e-7)
    staggered = pattern_of(curve, phases=[0.0, math.pi])
    assert staggered.machine_amplitudes[0] < 1e-12 < early.machine_amplitudes[0]
    assert pattern_of(curve, phases="independent").machine_amplitudes.max() == 0


def test_waves_are_those_of_paths_of_another_potential_and_a_swinging_nozzle():
    curve = fp.EllipticNozzle(-0.3, 0.4, 1.0, 0.6)
    model = fp.LayDownModel(NARROW, 1.5, curve)
    pattern = fp.mean_pattern(model, spacing=2.5)
    n_phases, n_paths, first = 12, 2000, 3
    ds = curve.period / (10 * n_phases)
    saved = [(first * n_phases + j) * 10 * ds for j in range(3 * n_phases)]
    paths = fp.sample_paths(model, n_paths, saved[-1], ds, seed=5, save_at=saved)
    eta = paths.xi + np.stack(curve.position(paths.s), axis=-1)[:, None]
    seen = 0
    for n, m in ((1, 0), (0, 1), (1, 1), (1, -1)):
        k1, k2 = 2 * math.pi * n / pattern.length, 2 * math.pi * m / 2.5
        waves = np.exp(-1j * (k1 * eta[..., 0] + k2 * eta[..., 1])).mean(axis=0)
        spread = math.sqrt(waves.real.var() + waves.imag.var()) / math.sqrt(n_paths)
        expected = coefficient(pattern, n, m)
        # Four standard errors; steps of 0.09 are off by less than 1e-3, h² A²/24.
        assert abs(waves.mean() - expected) < 4 * spread + 1e-3, (n, m)
        seen += abs(expected) > 5 * spread
    # Not all of them are zero within the noise.
    assert seen >= 2


def test_what_is_not_known_is_refused():
    curve = fp.RotatingNozzle(0.5, 0.8, 1.0)

    def refused(message, kind=ValueError, model=None, **options):
        model = fp.LayDownModel(QUADRATIC, 1.5, curve) if model is None else model
        with pytest.raises(kind, match=message):
            fp.mean_pattern(model, **{"spacing": 1.0, **options})

    def with_curve(other):
        return fp.LayDownModel(QUADRATIC, 1.5, other)

    refused("`spacing` must be positive", spacing=-1.0)
    refused("`tolerance` must be positive", tolerance=math.nan)
    refused("`phases` must be 'in phase', 'independent' or an array", phases="alike")
    refused(
        "`noise` must be at least 0.7", model=fp.LayDownModel(QUADRATIC, 0.5, curve)
    )
    refused(
        "`potential` must be a QuadraticPotential",
        model=fp.LayDownModel(fp.LinearPotential(), 1.5, curve),
    )
    refused("`curve` must be a nozzle that moves", model=with_curve(fp.MovingBelt(0.1)))
    refused(
        "`curve` must be on a belt that moves",
        model=with_curve(fp.RotatingNozzle(0.0, 0.8, 1.0)),
    )
    smooth = fp.SmoothLayDownModel(QUADRATIC, 0.1, 1.5, curve)
    refused("it is what `periodic_state` returns", TypeError, model=smooth)
    # A nozzle that is twice as fast as the fibre.
    refused(
        "let the nozzle move less", ToleranceError,
        model=fp.LayDownModel(QUADRATIC, 0.8, fp.RotatingNozzle(0.1, 4.0, 0.5)),
    )  # fmt: skip
