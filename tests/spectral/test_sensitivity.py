"""Derivatives of a fibre's spectrum: exact laws, tangents, differences, scaling."""

import math
from itertools import pairwise

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.centre import centre_of
from fpsolve.spectral.resolvent.fibre_spectrum import fibre_gradient, fibre_spectrum
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.limit import harmonic_derivatives, limit_derivatives
from fpsolve.spectral.resolvent.plane_waves import (
    characteristic,
    multiplied,
    plane_wave,
)
from fpsolve.spectral.resolvent.sensitivity import (
    long_wave_columns,
    short_wave_columns,
)
from fpsolve.spectral.resolvent.waves import (
    along_long_waves,
    along_short_waves,
    long_wave_halves,
)

NUMBERS = np.array([2.0, 0.2, 1.0, 0.7])


def model_of(numbers):
    noise, speed, sigma1, sigma2 = numbers
    potential = fp.QuadraticPotential(sigma1, sigma2)
    curve = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.LayDownModel(potential, noise, curve)


BELT, NOISY = model_of(NUMBERS), model_of([8.0, 0.1, 1.0, 1.3])
REST = model_of([1.5, 0.0, 1.2, 0.7])
K = [(0.0, 1.0), (0.4, 0.9), (1.2, 0.0), (1.5, 2.0)]


class Other(Generator):
    """The same functional with its derivative in the place of the stationary law."""


def with_law(generator, law):
    other = Other(generator.model, generator.basis, generator.centre)
    other.__dict__["stationary"] = law
    return other


def test_at_rest_the_law_changes_as_a_gaussian():
    """E he_2(ξ_i/σ_i) = (Var/σ_i² − 1)/√2 has the derivative √2/σ_i in σ_i."""
    generator = Generator(REST, Basis(8, 5), 0.0)
    m, n, harmonic = generator.basis.states
    noise, _, by1, by2 = generator.stationary_derivatives
    for change, first, second, sigma in ((by1, 2, 0, 1.2), (by2, 0, 2, 0.7)):
        expected = np.where(
            (m == first) & (n == second) & (harmonic == 0), math.sqrt(2) / sigma, 0.0
        )
        assert change == pytest.approx(expected, abs=1e-12)
    assert noise == pytest.approx(0, abs=1e-13)


def test_the_mean_cosine_is_minus_the_belt_speed_and_so_is_its_derivative():
    """E cos α = −v in every truncation, whatever the noise and the ranges."""
    changes = harmonic_derivatives(Generator(BELT, Basis(8, 5), 0.4))[:, 1]
    assert changes == pytest.approx([0.0, -1.0, 0.0, 0.0], abs=1e-12)


def test_short_waves_without_a_favoured_direction_depend_on_nothing():
    """Ŝ → 2/|k| at rest for equal ranges, where σ1 alone does not stay equal."""
    generator = Generator(model_of([1.5, 0.0, 1.0, 1.0]), Basis(10, 6), 0.0)
    found = limit_derivatives(generator, (300.0, 400.0))
    # The law of the angle stays uniform even where they differ: e^{−B} knows no angle.
    assert found[[0, 2, 3]] == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("model", [BELT, NOISY, REST])
@pytest.mark.parametrize("k", K)
def test_adjoints_of_long_waves_are_tangents(model, k):
    """∂(row·u) with ∂u = A⁻¹(−∂A u), parameter by parameter, to rounding."""
    generator = Generator(model, Basis(9, 6), centre_of(model))
    (found,) = long_wave_columns(generator, k[0], [k[1]])
    assert found[0] == along_long_waves(generator, k[0], [k[1]])[0]
    expected = np.zeros(4)
    for half in long_wave_halves(generator, k[0], [k[1]]):
        u = half.solver.solve(half.wave)
        for p, (change, law) in enumerate(
            zip(generator.derivatives, generator.stationary_derivatives, strict=True)
        ):
            changed = (change[half.states][:, half.states]) @ u
            changed = changed - 1j * k[0] * u if p == 1 else changed
            tangent = half.solver.solve(changed)
            other = with_law(generator, law)
            row = (
                multiplied(other, k)
                - np.conj(characteristic(other, k)) * generator.stationary
                - np.conj(characteristic(generator, k)) * law
            )
            expected[p] += 2 * (half.row @ tangent + row[half.states] @ u).real
    assert found[1:] == pytest.approx(expected, rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("model", [BELT, NOISY, REST])
@pytest.mark.parametrize("k", [(0.0, 1.0), (1.2, 0.0), (2.0, 3.0), (6.0, 1.0)])
def test_adjoints_of_short_waves_are_tangents(model, k):
    """Of the bordered matrix, dense, and its solution and tangents."""
    generator = Generator(model, Basis(7, 5), centre_of(model))
    found = short_wave_columns(generator, k)
    assert found[0] == along_short_waves(generator, k)
    cosine, sine = generator.directions
    matrix = (-generator.matrix - 1j * (k[0] * cosine + k[1] * sine)).toarray()
    opposite = -k[0], -k[1]
    null, n = plane_wave(generator, opposite), generator.basis.size
    right = np.eye(n + 1)[0].astype(complex)
    bordered = np.vdot(null, null).real > 0.5
    dense = np.zeros((n + 1, n + 1), complex)
    dense[:n, :n], dense[n, n] = matrix, 1.0
    if bordered:
        right[:n] -= characteristic(generator, k) * null
        dense[:n, n], dense[n, :n] = null, multiplied(generator, opposite)
        dense[n, n] = 0.0
    u = np.linalg.solve(dense, right)
    for p, (change, law) in enumerate(
        zip(generator.derivatives, generator.stationary_derivatives, strict=True)
    ):
        source = np.append(change @ u[:n], 0.0)
        if bordered:
            other = with_law(generator, law)
            source[:n] -= characteristic(other, k) * null
            source[n] = -multiplied(other, opposite) @ u[:n]
        tangent = np.linalg.solve(dense, source)[:n]
        expected = 2 * (law @ u[:n] + generator.stationary @ tangent).real
        # Near-null functions cost digits of both.
        assert found[1 + p] == pytest.approx(expected, rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("parameter", range(4))
def test_central_differences_converge_to_derivatives(parameter):
    """Of the order two at every halving, in polynomials that move with the ranges."""
    basis, centre, k = Basis(14, 9), centre_of(BELT), (0.4, 0.9)
    found = long_wave_columns(Generator(BELT, basis, centre), k[0], [k[1]])[0]
    errors = []
    for step in (0.08, 0.04, 0.02):
        there, back = (
            along_long_waves(Generator(model_of(numbers), basis, centre), k[0], [k[1]])
            for numbers in NUMBERS
            + step * np.array([[1.0], [-1.0]]) * np.eye(4)[parameter]
        )
        errors.append(abs((there - back)[0] / (2 * step) - found[1 + parameter]))
    # What is left of the truncation is 1e-7.
    assert errors[2] < 3e-3
    for coarse, fine in pairwise(errors):
        assert math.log2(coarse / fine) == pytest.approx(2, abs=0.15)


def test_derivatives_fulfil_the_law_of_dimensions():
    """Ŝ is a length: σ1 ∂1 + σ2 ∂2 − (A/2) ∂_A − k·∂_k multiplies it by one.

    ∂_k by differences of the fourth order, of which h⁴ is left.
    """
    generator = Generator(BELT, Basis(15, 10), centre_of(BELT))
    k, h = np.array([0.4, 0.9]), 0.02
    value, noise, _, by1, by2 = long_wave_columns(generator, k[0], [k[1]])[0]
    factors = 1 + h * np.array([-2, -1, 1, 2])
    values = np.array(
        [along_long_waves(generator, a, [b])[0] for a, b in np.outer(factors, k)]
    )
    by_size = values @ [1, -8, 8, -1] / (12 * h)
    total = 1.0 * by1 + 0.7 * by2 - 0.5 * 2.0 * noise - by_size
    assert total == pytest.approx(value, abs=3e-6)
    assert abs(by_size) > 0.1


def test_derivatives_keep_the_spectrum_and_its_errors():
    ladder, k = Ladder(BELT), np.array([[0.0, 0.5, 30.0], [0.5, 1.0, 500.0]])
    values, errors = fibre_gradient(ladder, *k, 1e-2)
    plain, plain_errors = fibre_spectrum(ladder, *k, 1e-2)
    assert (plain == values[:, 0]).all()
    assert (plain_errors == errors[:, 0]).all()
    finer, left = fibre_gradient(ladder, *k, 2e-3)
    assert (np.abs(values - finer) <= errors + left).all()


@pytest.mark.nightly
@pytest.mark.parametrize(
    "numbers", [NUMBERS, [1.2, 0.1, 1.0, 1.0], [8.0, 0.1, 1.0, 1.3]]
)
def test_errors_cover_the_distance_to_larger_truncations(numbers):
    k1 = np.array([0.0, 0.1, 0.8, 1.4, 2.0, 30.0])
    k2 = np.array([0.5, 0.3, 1.0, 2.0, 3.0, 500.0])
    ladder = Ladder(model_of(numbers))
    values, errors = fibre_gradient(ladder, k1, k2, 1e-2)
    finer, left = fibre_gradient(ladder, k1, k2, 5e-4)
    assert (np.abs(values - finer) <= errors + left).all()
    # They are of some use, too: a tenth in units of Ŝ.
    units = np.abs(finer[:, :1]) / np.array([numbers[0], 1.0, *numbers[2:]])
    assert (errors[:, 1:] <= 0.1 * units).all()
