"""Derivatives of a smooth fibre's spectrum: differences, scaling, R → 0, known laws."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.spectral.resolvent import smooth_sensitivity, smooth_solutions
from fpsolve.spectral.resolvent.fibre import BasicFibre, SmoothFibre
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_limit import smooth_short_wave_limit
from fpsolve.spectral.resolvent.smooth_sensitivity import smooth_long_columns
from fpsolve.spectral.resolvent.smooth_spectrum import (
    GRADIENTS,
    VALUES,
    smooth_gradient,
    smooth_spectrum,
)
from fpsolve.spectral.resolvent.smooth_waves import angle_moments

# Noise, belt speed, σ1, σ2, R.
NUMBERS = np.array([3.0, 0.2, 1.0, 0.8, 0.3])
# What derivatives in the logarithm of the unit of length are.
WEIGHTS = np.array([-0.5, 0.0, 1.0, 1.0, 1.0]) * NUMBERS
SMALL, LARGER = SmoothBasis(4, 3, 3), SmoothBasis(4, 3, 4)


def model_of(numbers):
    noise, speed, sigma1, sigma2, length = numbers
    potential = fp.QuadraticPotential(sigma1, sigma2)
    return fp.SmoothLayDownModel(potential, length, noise, fp.MovingBelt(speed))


@pytest.fixture(scope="module")
def fibre():
    return SmoothFibre(model_of(NUMBERS))


def columns_of(method, kind, placement, numbers):
    """Ŝ, and maybe derivatives, of the two small truncations in one basis."""
    generator, law = (
        SmoothGenerator(model_of(numbers), placement, one) for one in (SMALL, LARGER)
    )
    if kind == "long":
        return method.long(generator, 0.3, [0.5, 0.9])
    if kind == "at rest":
        return method.long(generator, 0.0, [0.7])
    if kind == "limit":
        return method.limit(law, (1.0, 4.0))[None]
    return method.short(generator, (law, generator), (1.0, 4.0))


@pytest.mark.parametrize(
    "kind",
    ["long", "at rest", pytest.param("short", marks=pytest.mark.nightly), "limit"],
)
def test_differences_converge_with_order_two_at_every_halving(monkeypatch, fibre, kind):
    """Of truncations whose Gaussians stay: derivatives are theirs, adjoint or not."""
    # So that the iteration is no part of differences.
    monkeypatch.setattr(smooth_solutions.ByDegree.solve, "__defaults__", ("N", 1e-12))
    monkeypatch.setattr(smooth_sensitivity, "OF_DIFFERENCE", 1e-10)
    found = columns_of(GRADIENTS, kind, fibre.placement, NUMBERS)
    plain = columns_of(VALUES, kind, fibre.placement, NUMBERS)
    assert found[:, 0] == pytest.approx(plain[:, 0], rel=1e-9)
    for parameter in range(5):
        errors = []
        for share in (0.01, 0.005, 0.0025):
            step = share * NUMBERS * np.eye(5)[parameter]
            there, back = (
                columns_of(VALUES, kind, fibre.placement, NUMBERS + sign * step)[:, 0]
                for sign in (1, -1)
            )
            difference = (there - back) / (2 * step.sum())
            errors.append(np.abs(difference - found[:, 1 + parameter]))
        rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
        # Beside h² there is h⁴, of which 1 % of the parameter leaves some hundredths.
        assert rates == pytest.approx(2, abs=0.1)


def test_the_spectrum_fulfils_the_law_of_dimensions(fibre):
    """Ŝ is a length: its derivatives by lengths, less those by k, add up to Ŝ.

    Gaussians keep their widths, so that no truncation does so by construction; k ∂_k is
    a difference of order h² = 1e-4.
    """
    h, k2 = 0.01, 0.8
    waves = k2 * np.array([1 - h, 1.0, 1 + h])
    generator = fibre.generator(fibre.first.grown(1))
    values = smooth_long_columns(generator, 0.0, waves.tolist())
    by_k = (values[2, 0] - values[0, 0]) / (2 * h)
    total = WEIGHTS @ values[1, 1:] - by_k - values[1, 0]
    # What a truncation of degree 10 leaves of Ŝ and of its derivatives.
    assert abs(total) <= 2e-3 * np.abs(WEIGHTS) @ np.abs(values[1, 1:])


@pytest.mark.nightly
def test_the_law_of_dimensions_holds_within_the_errors(fibre):
    """Of a long wave and of a short one, both to a tolerance."""
    h = 0.01
    for wave in ((0.0, 0.8), (1.0, 4.0)):
        k1, k2 = np.multiply.outer(wave, np.array([1 - h, 1.0, 1 + h]))
        values, errors = smooth_gradient(fibre, k1, k2, 1e-2)
        by_k = (values[2, 0] - values[0, 0]) / (2 * h)
        total = WEIGHTS @ values[1, 1:] - by_k - values[1, 0]
        size = np.abs(WEIGHTS) @ np.abs(values[1, 1:])
        # Differences by k have errors of their own.
        own = (errors[0, 0] + errors[2, 0]) / (2 * h)
        bound = errors[1, 0] + np.abs(WEIGHTS) @ errors[1, 1:]
        assert abs(total) <= min(bound + own, 0.02 * size)


@pytest.mark.nightly
def test_values_and_errors_are_those_without_derivatives(fibre):
    k1, k2 = np.array([0.4, 2.0]), np.array([0.7, 3.0])
    values, errors = smooth_gradient(fibre, k1, k2, 0.05)
    plain, of_plain = smooth_spectrum(fibre, k1, k2, 0.05)
    # Sums in another order.
    assert values[:, 0] == pytest.approx(plain, rel=1e-9)
    assert errors[:, 0] == pytest.approx(of_plain, rel=1e-4)


@pytest.mark.nightly
def test_the_law_of_the_angle_has_the_derivatives_that_are_known(fibre):
    """E cos α = −v, ∂/∂v = −1 and no other; nothing of E cos 2α knows the unit."""
    law, coarse = fibre.laws(2e-3)
    means = [angle_moments(law, 0, one)[1] for one in law.stationary_derivatives]
    # By truncation, which has the constants only nearly.
    assert means == pytest.approx([0.0, -1.0, 0.0, 0.0, 0.0], abs=1e-4)
    fine, less = fibre.double_cosine_changes()
    assert abs(WEIGHTS @ fine) < 1e-3 * np.abs(WEIGHTS) @ np.abs(fine)
    assert (np.abs(fine - less) < 1e-2 * np.abs(fine).max()).all()
    # Total mass is one whatever the parameters.
    assert coarse.stationary_derivatives @ coarse.one == pytest.approx(0, abs=1e-12)


def test_arcs_without_a_favoured_direction_know_the_curvature_alone():
    """2/|k| − E κ²/(4|k|³): its derivative in R is that of E κ²."""
    numbers = np.array([3.0, 1e-9, 1.0, 1.0, 0.3])
    fibre = SmoothFibre(model_of(numbers))
    law = SmoothGenerator(fibre.model, fibre.placement, fibre.first.grown(1))
    change = law.stationary_derivatives[4]
    found = smooth_short_wave_limit(law, (0.0, 10.0), change)
    squares = angle_moments(law, 2, change)[0]
    # The sum over harmonics is of a uniform law to the truncation.
    assert found == pytest.approx(-squares / 4e3, rel=1e-3)
    # About that of the free fibre, A²/(2R), which the force makes larger.
    assert squares == pytest.approx(-9.0 / (2 * 0.3**2), rel=0.05)


@pytest.mark.nightly
def test_the_slope_in_the_relaxation_length_is_that_of_the_way_from_the_basic_model():
    """[Ŝ(R) − Ŝ(0)]/R = ∂Ŝ/∂R(R) + O(R), at every halving of R."""
    k1, k2, numbers = 0.3, 0.7, np.array([2.0, 0.2, 1.0, 0.8, 0.0])
    basic = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.8), 2.0, fp.MovingBelt(0.2))
    at_zero, _ = BasicFibre(basic).spectrum(np.array([k1]), np.array([k2]), 1e-8)
    away = []
    for length in (0.00625, 0.003125, 0.0015625):
        numbers[4] = length
        fibre = SmoothFibre(model_of(numbers))
        generator = fibre.generator(fibre.first.grown(1))
        values = smooth_long_columns(generator, k1, [k2])[0]
        away.append(abs((values[0] - at_zero[0]) / length - values[5]))
    orders = np.log2(np.array(away[:-1]) / np.array(away[1:]))
    # R² is felt: the order goes from 0.5 at R = 0.1 to one.
    assert orders == pytest.approx(1, abs=0.1)
    # The slope itself is 3.2.
    assert away[-1] < 0.01 * abs(values[5])
