"""Proven bounds lie below the gap, asymptotes meet it, constants are what they are."""

import math
from functools import cache

import numpy as np
import pytest

from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    FreePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.spectral.eigen.gap import spectral_gap
from fpsolve.studies.constants.poincare import poincare_constant
from fpsolve.studies.rates.bounds import (
    averaging_bound,
    hypocoercive_bound,
    large_noise_asymptote,
    small_noise_asymptote,
)

QUADRATIC = QuadraticPotential()


@cache
def gap(potential, noise):
    return spectral_gap(LayDownModel(potential, noise), tolerance=1e-6)


def as_isotropic(potential):
    """The same potential without its name: constants come from the eigenproblem."""
    return IsotropicPotential(potential.radial_value, potential.radial_derivative)


@pytest.mark.parametrize("noise", [0.4, 1.0, 1.7, 3.0, 10.0])
def test_the_proven_bound_and_theorem_3_3_lie_below_the_gap(noise):
    true = gap(QUADRATIC, noise)
    assert 0 < hypocoercive_bound(QUADRATIC, noise).rate < true
    assert 0 < averaging_bound(QUADRATIC, noise) < true


def test_the_proven_bound_of_the_linear_potential_lies_below_its_gap():
    bound = hypocoercive_bound(LinearPotential(), 3.0).rate
    assert 0 < bound < gap(LinearPotential(), 3.0)


@pytest.mark.parametrize(
    "potential", [QUADRATIC, LinearPotential(), QuadraticPotential(1.0, 2.0)]
)
def test_the_proven_bound_grows_like_A2_and_falls_like_its_inverse(potential):
    small = [hypocoercive_bound(potential, noise).rate for noise in (0.003, 0.006)]
    # The correction to A² is of relative order A or less.
    assert small[1] / small[0] == pytest.approx(4.0, rel=0.02)
    large = hypocoercive_bound(potential, 100.0).rate
    # At large noise it is even sharp: Λ/A², here up to the relative order 1/A.
    assert large == pytest.approx(poincare_constant(potential) / 1e4, rel=0.02)


def test_the_factor_in_front_can_be_limited_at_a_price():
    free = hypocoercive_bound(QUADRATIC, 1.0)
    tight = hypocoercive_bound(QUADRATIC, 1.0, factor=1.05)
    assert free.factor > tight.factor > 1
    assert tight.factor <= 1.05 * (1 + 1e-12)
    assert 0 < tight.rate < free.rate
    # The inequality that proves it, with the constants of B = |ξ|²/2.
    room = 4 * (free.epsilon / (1 + 2 * free.kappa**2) - free.rate)
    room *= 0.5 - free.epsilon - free.rate
    constant = 1 + math.sqrt(2) + math.sqrt(2) / (4 * free.kappa)
    cross = constant + (0.5 - 2 * free.rate) / (2 * free.kappa)
    assert room == pytest.approx((free.epsilon * cross) ** 2, rel=1e-6)


def norm_of_second_transport(degree):
    """‖(1 − Π)T²Πu‖²/‖½(−Δ + ∇B·∇)u‖² at most, over Hermite polynomials up to degree.

    With ∂ = ∂₁ + i∂₂ the numerator is the mean of |∂²u + ∂B ∂u|²/16 and of the same
    with the conjugate ∂; ∂ = √2 b, ∂B = √2 (a† + b) in the ladder operators.
    """
    largest = 0.0
    for index in range(degree + 1):
        n = np.arange(max(index, 2 - index % 2), degree + 1, 2)
        images = np.zeros((2, degree + 1, n.size))
        for column, total in enumerate(n):
            a, b = (total + index) // 2, (total - index) // 2
            for side, (one, other) in enumerate([(b, a), (a, b)]):
                images[side, total - 2, column] = 4 * math.sqrt(one * (one - 1))
                images[side, total, column] = 2 * math.sqrt((other + 1) * one)
        square = sum(image.T @ image for image in images) / 16
        if n.size:
            largest = max(largest, np.linalg.eigvalsh(square / np.outer(n, n) * 4)[-1])
    return largest


def test_the_constant_of_the_quadratic_potential_is_above_every_truncation():
    norms = [norm_of_second_transport(degree) for degree in (10, 20, 40, 80)]
    assert np.all(np.diff(norms) > 0)
    # They rise towards 14/3, with a distance that halves at every doubling of the
    # degree; the constant that is proven leaves out a positive term.
    assert 14 / 3 - norms[-1] < 0.06
    assert math.sqrt(norms[-1]) < math.sqrt(14 / 3) < 1 + math.sqrt(2)


def test_rates_scale_like_the_gap():
    # ξ = σx, s = σt turns σ = 1 and noise √σ A into σ and A.
    for sigma in (0.5, 2.0):
        wide = QuadraticPotential(sigma, sigma)
        for bound in (lambda p, A: hypocoercive_bound(p, A).rate, averaging_bound):
            scaled = bound(QUADRATIC, math.sqrt(sigma) * 1.3) / sigma
            assert bound(wide, 1.3) == pytest.approx(scaled, rel=1e-6)
        scaled = large_noise_asymptote(QUADRATIC, math.sqrt(sigma) * 5) / sigma
        assert large_noise_asymptote(wide, 5.0) == pytest.approx(scaled, rel=1e-12)
    steep = hypocoercive_bound(LinearPotential(4.0), 2.0).rate
    scaled = 4 * hypocoercive_bound(LinearPotential(), 1.0).rate
    assert steep == pytest.approx(scaled, rel=1e-6)


def test_the_gap_meets_both_asymptotes():
    # Exact below the first crossing of branches.
    for potential in (QUADRATIC, LinearPotential()):
        noise = 0.4
        exact = float(small_noise_asymptote(potential, noise))
        assert gap(potential, noise) == pytest.approx(exact, rel=1e-6)
    # The next term of the series is of the order A⁻⁸.
    for noise, error in ((5.0, 30 / 5**8), (10.0, 30 / 10**8)):
        series = float(large_noise_asymptote(QUADRATIC, noise))
        assert gap(QUADRATIC, noise) == pytest.approx(series, rel=error)
    # The correction itself is 2e-4 here, the next one 3e-3/A⁸.
    series = float(large_noise_asymptote(LinearPotential(), 3.0))
    assert gap(LinearPotential(), 3.0) == pytest.approx(series, rel=2e-6)


def test_poincare_constants_are_known_or_computed():
    assert poincare_constant(QuadraticPotential(1.0, 3.0)) == pytest.approx(1 / 9)
    assert poincare_constant(LinearPotential(3.0)) == pytest.approx(2.0)
    # Finite volumes of second order, extrapolated; |ξ| is cut by the box where the
    # slowest function, r e^{r/3}, still counts.
    assert poincare_constant(as_isotropic(QUADRATIC)) == pytest.approx(1, rel=1e-6)
    found = poincare_constant(as_isotropic(LinearPotential()))
    assert found == pytest.approx(2 / 9, rel=1e-4)
    assert poincare_constant(PowerPotential(2.0)) == pytest.approx(1, rel=1e-6)


def test_the_small_noise_asymptote_is_that_of_isotropic_potentials():
    assert np.isnan(small_noise_asymptote(QuadraticPotential(1.0, 2.0), 0.1))
    noises = np.array([0.1, 0.2])
    np.testing.assert_allclose(
        small_noise_asymptote(PowerPotential(4.0), noises), noises**2 / 2
    )


@pytest.mark.parametrize(
    "ask", [hypocoercive_bound, averaging_bound], ids=["hypocoercive", "averaging"]
)
def test_without_noise_there_is_no_rate(ask):
    with pytest.raises(ValueError, match="`noise` must be positive and finite, got 0"):
        ask(QUADRATIC, 0.0)


def test_what_is_not_known_is_refused():
    with pytest.raises(ValueError, match="`potential` must be quadratic or linear for"):
        hypocoercive_bound(PowerPotential(4.0), 1.0)
    with pytest.raises(ValueError, match="`potential` must be an isotropic Quadratic"):
        averaging_bound(LinearPotential(), 1.0)
    with pytest.raises(ValueError, match=r"`potential` must confine, got FreePot"):
        poincare_constant(FreePotential())
    with pytest.raises(ValueError, match="`factor` must be above 1, got 1; no rate is"):
        hypocoercive_bound(QUADRATIC, 1.0, factor=1.0)
    uneven = CallablePotential(
        lambda x, y: (x**2 + 2 * y**2) / 2, lambda x, y: (x + 0 * y, 2 * y + 0 * x)
    )
    with pytest.raises(ValueError, match="`potential` must be isotropic or quadratic"):
        poincare_constant(uneven)
