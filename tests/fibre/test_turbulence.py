"""Spectrum of isotropic turbulence: two integrals, two derivatives, white noise."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from fpsolve.fibre import TurbulenceSpectrum

# Air behind a nozzle, nearly no inertial range, and eddies of metres; SI units.
AIR = 1.5e-5
CASES = (
    TurbulenceSpectrum(1.0, 100.0, AIR),
    TurbulenceSpectrum(10.0, 1e4, AIR, 1.2),
    TurbulenceSpectrum(0.02, 100.0, AIR, 0.5),
    TurbulenceSpectrum(100.0, 1.0, AIR, 1.5),
)


def integral(spectrum, power):
    """∫ κ^power E dκ by adaptive quadrature in ln κ, part by part."""
    ends = np.log(spectrum.inertial_range)
    limits = (ends[0] - 60, ends[0], ends[1], ends[1] + 60)
    return sum(
        quad(
            lambda x: math.exp((power + 1) * x) * float(spectrum.energy(math.exp(x))),
            a, b, epsabs=0, epsrel=1e-11, limit=200,
        )[0]
        for a, b in pairwise(limits)
    )  # fmt: skip


@pytest.mark.parametrize("spectrum", CASES)
def test_energy_and_dissipation_are_those_given(spectrum):
    assert spectrum.moment(0) == pytest.approx(spectrum.k, rel=1e-13)
    rate = 2 * spectrum.viscosity * spectrum.moment(2)
    assert rate == pytest.approx(spectrum.dissipation, rel=1e-13)


@pytest.mark.parametrize("spectrum", CASES)
@pytest.mark.parametrize("power", [-3.5, -2, -1, 0, 2 / 3, 0.7, 2, 5])
def test_moments_are_integrals_of_the_energy(spectrum, power):
    assert spectrum.moment(power) == pytest.approx(integral(spectrum, power), rel=1e-9)


def test_moments_are_continuous_at_the_power_of_a_logarithm():
    spectrum = CASES[0]
    near = [spectrum.moment(2 / 3 + x) for x in (-1e-9, 0.0, 1e-9)]
    # The derivative is the moment with ln κ, below 10 times it.
    np.testing.assert_allclose(near, near[1], rtol=2e-8)


@pytest.mark.parametrize("spectrum", CASES[:2])
@pytest.mark.parametrize("end", [0, 1])
def test_energy_has_two_continuous_derivatives(spectrum, end):
    joint = spectrum.inertial_range[end]
    level = float(spectrum.energy(joint))
    for h in (1e-3, 5e-4):
        x = joint * (1 + h * np.arange(-2, 3))
        e = spectrum.energy(x) / level
        left, right = (e[0] - 2 * e[1] + e[2]) / h**2, (e[2] - 2 * e[3] + e[4]) / h**2
        # Third derivatives, up to 300, times h on both sides.
        assert abs(left - right) < 600 * h
        assert abs((e[3] - e[1]) / (2 * h) + 5 / 3) < 200 * h**2


def test_between_energy_falls_like_kolmogorovs():
    spectrum = CASES[3]
    first, last = spectrum.inertial_range
    kappa = np.geomspace(first, last, 7)
    expected = 1.5 * kappa ** (-5 / 3)
    np.testing.assert_allclose(spectrum.energy(kappa), expected, rtol=1e-13)
    assert spectrum.energy(0.0) == 0.0


def test_units_may_be_any_that_fit_each_other():
    metres = CASES[1]
    # Millimetres and milliseconds: k in mm²/ms², ε in mm²/ms³, ν in mm²/ms.
    others = TurbulenceSpectrum(10.0 * 1.0, 1e4 * 1e-3, AIR * 1e3, 1.2)
    np.testing.assert_allclose(
        np.array(others.inertial_range) * 1e3, metres.inertial_range, rtol=1e-12
    )
    assert others.integral_length == pytest.approx(1e3 * metres.integral_length)
    assert others.kolmogorov_length == pytest.approx(1e3 * metres.kolmogorov_length)


def test_no_inertial_range_is_left_at_the_smallest_energy():
    with pytest.raises(ValueError, match="`k` must be at least") as caught:
        TurbulenceSpectrum(1e-3, 100.0, AIR)
    smallest = 1.4394 * 0.5**1.5 * math.sqrt(AIR * 100.0)
    assert f"{smallest:.4f}" in str(caught.value)
    first, last = TurbulenceSpectrum(smallest * 1.0001, 100.0, AIR).inertial_range
    # κ₂/κ₁ − 1 is of the size of what k is above it.
    assert 1 <= last / first < 1.001


def correlations(spectrum, r, n_waves=400):
    """u'² (f + g)(r), f and g the longitudinal and the lateral correlation."""
    first, last = spectrum.inertial_range
    nodes, weights = np.polynomial.legendre.leggauss(n_waves)
    low, high = math.log(first / 30), math.log(last * 30)
    kappa = np.exp(low + (high - low) * (nodes + 1) / 2)
    energies = weights * (high - low) / 2 * kappa * spectrum.energy(kappa)
    x = np.multiply.outer(r, kappa)
    shapes = np.sin(x) / x**3 - np.cos(x) / x**2 + np.sin(x) / x
    return shapes @ energies


def test_white_noise_has_the_integral_of_the_correlations_across_the_fibre():
    # With E(κ₂) hardly below E(κ₁), so that few waves must be resolved.
    spectrum = CASES[2]
    first, _ = spectrum.inertial_range
    speed = 3.0
    expected = speed * float(spectrum.frozen_amplitude(speed)) ** 2
    distances = []
    for length in np.array([4.0, 8.0, 16.0]) / first:
        # In the plane of the fibre and the flow the mean of the two components is
        # u'² (f + g)/2; smoothly cut off, it sees wave vectors 1/length off the normal.
        r = (np.arange(6000) + 0.5) * 5 * length / 6000
        cut = np.exp(-((r / length) ** 2) / 2)
        found = math.pi * (correlations(spectrum, r) * cut * r).sum() * r[0] * 2
        distances.append(abs(found / expected - 1))
    orders = np.log2(np.array(distances[:-1]) / distances[1:])
    # The bias is of order 2 in 1/(κ₁ length).
    assert (orders > 1.8).all(), orders
    assert distances[-1] < 0.05


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: TurbulenceSpectrum(-1.0, 1.0, AIR),
            "`k` must be positive and finite, got -1",
        ),
        (
            lambda: TurbulenceSpectrum(1.0, math.nan, AIR),
            "`dissipation` must be positive",
        ),
        (
            lambda: TurbulenceSpectrum(1.0, 1.0, 0.0),
            "`viscosity` must be positive and finite, got 0",
        ),
        (lambda: CASES[0].energy(-1.0), "`kappa` must be non-negative, got -1"),
        (lambda: CASES[0].moment(6.0), "`power` must lie between -5 and 6, got 6"),
        (lambda: CASES[0].moment(math.nan), "`power` must lie between"),
        (lambda: CASES[0].frozen_amplitude(0.0), "`speed` must be positive, got 0"),
        (
            lambda: CASES[0].decaying_amplitudes(-1.0, 1.0),
            "`speed` must be non-negative, got -1",
        ),
        (
            lambda: CASES[0].decaying_amplitudes(1.0, 0.0),
            "`decay_time` must be positive",
        ),
    ],
)
def test_what_is_no_turbulence_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_decaying_amplitudes_are_those_of_the_spectral_tensor_over_angles():
    spectrum, time = CASES[1], 2e-3
    angles = (np.arange(4000) + 0.5) * 2 * np.pi / 4000
    for speed in (0.0, 0.3, 3.0):
        kappa, weights = spectrum._nodes
        left = np.exp(
            -np.multiply.outer((kappa * speed * time) ** 2 / 2, np.cos(angles) ** 2)
        )
        squares = []
        for share in (np.ones_like(angles), np.sin(angles) ** 2, np.cos(angles) ** 2):
            around = 2 * np.pi * (left * share).mean(axis=1)
            tensor = spectrum.energy(kappa) / (4 * np.pi * kappa)
            squares.append((2 * np.pi) ** 1.5 * time * (weights * tensor) @ around)
        found = spectrum.decaying_amplitudes(speed, time)
        # The midpoint rule of a periodic function, sharp like 1/(κ |w| t_T).
        np.testing.assert_allclose(found**2, squares, rtol=1e-9)


def test_what_passes_faster_than_it_decays_is_frozen():
    spectrum = CASES[0]
    speeds = np.array([1e2, 1e3, 1e4])
    along, across, normal = spectrum.decaying_amplitudes(speeds, 10.0)
    frozen = spectrum.frozen_amplitude(speeds)
    np.testing.assert_allclose(along, frozen, rtol=1e-7)
    np.testing.assert_allclose(across, frozen, rtol=1e-4)
    assert (normal < 0.01 * frozen).all()


def test_air_at_rest_shakes_alike_in_all_directions_across():
    along, across, normal = CASES[0].decaying_amplitudes(0.0, 0.01)
    assert across == normal
    # Of three equal squares a plane has the half of two in each of its directions.
    assert along == pytest.approx(math.sqrt(2) * across, rel=1e-12)


@pytest.mark.parametrize("power", [-2, -1, 0])
def test_nodes_of_the_quadrature_give_the_moments(power):
    for spectrum in CASES:
        kappa, weights = spectrum._nodes
        found = weights @ (spectrum.energy(kappa) * kappa**power)
        assert found == pytest.approx(spectrum.moment(power), rel=1e-9)
