"""S, J, N, σ² and the orbits: closed forms, quadrature, and what is refused."""

import math
from itertools import pairwise

import numpy as np
import pytest
from energy_processes import CURVATURES, NOISE, PROCESSES
from scipy.integrate import quad

from fpsolve.model.potentials import (
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.reduced.energy import EnergyProcess
from fpsolve.reduced.energy.averages import OrbitAverages

# Shares of g_max: both ends, both sides of the places where the method changes.
SHARES = np.array([1e-8, 1e-3, 0.1, 0.5, 0.77, 0.79, 0.9, 0.997, 0.999, 1 - 1e-6])


@pytest.fixture(params=PROCESSES, ids=str)
def name(request):
    return request.param


@pytest.fixture
def process(name):
    return PROCESSES[name]


def by_quadrature(process, share, integrand):
    """2 ∫ f(w, g) dr by adaptive quadrature with r = middle + half sin t."""
    g = share * process.g_max
    ends = process.turning_points(g)
    middle, half = (ends[0] + ends[1]) / 2, (ends[1] - ends[0]) / 2

    def of_angle(t):
        r = middle + half * math.sin(t)
        w = r * math.exp(-float(process.potential.radial_value(r)))
        return 2.0 * integrand(w, max((w - g) * (w + g), 0.0)) * half * math.cos(t)

    return quad(of_angle, -math.pi / 2, math.pi / 2, epsabs=0, epsrel=1e-11, limit=400)


@pytest.mark.parametrize("share", [0.1, 0.95])
def test_period_action_and_measure_are_the_integrals_over_r(process, share):
    g = share * process.g_max
    cases = [
        (process.period, lambda w, gap: w / math.sqrt(gap) if gap else 0.0),
        (process.action, lambda w, gap: w * math.sqrt(gap)),
        (
            lambda g: process._averages.measure(np.asarray(g)),
            lambda w, gap: w * math.atan2(math.sqrt(gap), g),
        ),
    ]
    for function, integrand in cases:
        expected, error = by_quadrature(process, share, integrand)
        # At the ends of the interval the gap w² - g² has lost half its digits.
        assert float(function(g)) == pytest.approx(expected, rel=1e-8, abs=2 * error)


def test_twice_the_quadrature_points_change_nothing(process):
    g = process.g_max * SHARES
    own = process._averages
    finer = OrbitAverages(own.well, n_points=192)
    for function, tolerance in (
        ("period", 2e-11),
        ("action", 1e-12),
        ("measure", 1e-12),
    ):
        # The period's integrand is infinite at the turning points: at the last node,
        # 1e-6 of the way from them, rounding of ln r is 1e-10 of the distance, and the
        # node has 1e-2 of the weight. The other integrands vanish there.
        np.testing.assert_allclose(
            getattr(own, function)(g), getattr(finer, function)(g), rtol=tolerance
        )


def test_the_period_at_the_circle_is_that_of_small_oscillations(name, process):
    # Linearised at (R, π/2), (13) is δr' = -δβ, δβ' = (B'' + 1/R²) δr. Below
    # u = 2e-3, S is a polynomial through values good to 1e-13.
    exact = 2 * math.pi * process.radius / math.sqrt(1 + CURVATURES[name])
    assert float(process.period(process.g_max)) == pytest.approx(exact, rel=1e-11)


def test_derivatives_of_action_and_measure_are_those_of_the_period(process):
    # Sixth-order differences at h = 1e-2 of the distance to the nearer end: the error
    # is about (h/distance)⁶ times derivatives of order one, 1e-11.
    g = process.g_max * np.array([0.05, 0.3, 0.6, 0.9])
    h = 1e-2 * np.minimum(g, process.g_max - g)
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}

    def slope(function):
        return sum(
            c * (function(g + k * h) - function(g - k * h)) / h
            for k, c in weights.items()
        )

    period = process.period(g)
    np.testing.assert_allclose(slope(process.action), -g * period, rtol=1e-8)
    np.testing.assert_allclose(slope(process._averages.measure), -period, rtol=1e-8)


def test_values_at_zero_are_integrals_over_the_plane(process):
    def weight(r):
        return r * math.exp(-float(process.potential.radial_value(r)))

    def integral(f):
        cuts = [0.0, 0.3, 1.0, 3.0, 30.0, 3000.0]
        # Where nothing is left, adaptive quadrature would warn of rounding.
        return sum(
            quad(f, a, b, epsabs=1e-15, epsrel=1e-12, full_output=1)[0]
            for a, b in pairwise(cuts)
        )

    one, squared = integral(weight), integral(lambda r: weight(r) ** 2)
    # Beyond 3000 the heavy tail has 1e-14 of the mass.
    assert process._averages.total == pytest.approx(math.pi * one, rel=1e-10)
    assert float(process.action(0.0)) == pytest.approx(2 * squared, rel=1e-10)


@pytest.mark.parametrize("potential", [QuadraticPotential(), LinearPotential()])
def test_the_measure_of_all_orbits_is_pi(potential):
    assert EnergyProcess(potential, 1.0)._averages.total == pytest.approx(
        math.pi, rel=1e-13
    )


@pytest.mark.parametrize(
    ("potential", "g_max"),
    [
        (QuadraticPotential(), math.exp(-0.5)),
        (LinearPotential(), math.exp(-1.0)),
        (PowerPotential(4.0), math.exp(-0.25)),
        # Normalised to B(1) = 0 the energies fill [0, 1], as the paper says.
        (IsotropicPotential(lambda r: r - 1.0, lambda r: r**0), 1.0),
    ],
)
def test_the_largest_energy_is_exp_minus_b_of_one(potential, g_max):
    process = EnergyProcess(potential, 1.0)
    assert process.g_max == pytest.approx(g_max, rel=1e-15)
    assert process.radius == pytest.approx(1.0, rel=1e-15)


def test_variance_is_the_average_of_the_squared_cotangent_over_the_orbit(process):
    for share in (0.05, 0.5, 0.95):
        g = share * process.g_max
        orbit = process.orbit(g, 513)
        # The trapezoidal rule is exact for periodic functions but for what 512 points
        # do not resolve; the orbit is integrated to about 1e-10.
        cotangent = np.mean(np.cos(orbit.beta[:-1]) ** 2 / np.sin(orbit.beta[:-1]) ** 2)
        expected = NOISE**2 * g**2 * cotangent
        assert float(process.variance(g)) == pytest.approx(expected, rel=1e-7)


def test_orbits_conserve_the_energy_and_close(process):
    for share in (1e-3, 0.5, 0.999, 1.0, -0.4):
        g = share * process.g_max
        orbit = process.orbit(g)
        # Local errors of 1e-12 add up over a few hundred steps.
        kept = process.energy(*orbit.xi.T, orbit.alpha)
        np.testing.assert_allclose(kept, g, rtol=1e-8)
        assert orbit.s[-1] == pytest.approx(float(process.period(g)), rel=1e-15)
        assert orbit.r[-1] == pytest.approx(orbit.r[0], rel=1e-8)
        # β turns at the rate 1/r there: an error of 1e-10 in s is 1e-10/r in β.
        assert abs(orbit.beta[-1] - orbit.beta[0]) * orbit.r[0] <= 1e-10
        r_min, r_max = process.turning_points(g)
        assert orbit.r.min() == pytest.approx(float(r_min), rel=1e-10)
        # The farthest point lies between two of 200.
        assert r_max * (1 - 1e-2) <= orbit.r.max() <= r_max * (1 + 1e-10)


def test_a_negative_energy_runs_the_other_way_round():
    process = PROCESSES["quadratic"]
    there, back = process.orbit(0.3), process.orbit(-0.3)
    np.testing.assert_array_equal(there.r, back.r)
    np.testing.assert_array_equal(there.beta, -back.beta)
    np.testing.assert_array_equal(there.phi, -back.phi)


def test_turning_points_solve_r_exp_minus_b_equal_to_g(process):
    g = process.g_max * SHARES
    for r in process.turning_points(g):
        w = r * np.exp(-process.potential.radial_value(r))
        # |d ln w/d ln r| <= 12 e^(…) of the steep potential amplifies rounding.
        np.testing.assert_allclose(w, g, rtol=1e-12)
    inner, outer = process.turning_points([0.0, process.g_max])
    np.testing.assert_array_equal(inner, [0.0, process.radius])
    np.testing.assert_array_equal(outer, [math.inf, process.radius])


def test_the_stationary_law_is_that_of_g_under_the_equilibrium_of_the_plane(process):
    # P(|G| <= g) with r of density r e^{-B} and a uniform angle: the angle takes part
    # (2/π) arcsin(g/w(r)) where w > g, and all where w < g.
    g = 0.35 * process.g_max
    inner, outer = (float(r) for r in process.turning_points(g))
    value = process.potential.radial_value

    def weight(r):
        return r * math.exp(-float(value(r)))

    def inside(r):
        return weight(r) * (2 / math.pi) * math.asin(min(1.0, g / weight(r)))

    cuts = [inner, (inner + process.radius) / 2, process.radius, outer]
    part = sum(quad(inside, a, b, limit=200)[0] for a, b in pairwise(cuts))
    part += quad(weight, 0.0, inner)[0] + quad(weight, outer, math.inf)[0]
    total = process._averages.total / math.pi
    # quad's square-root singularities at the turning points leave about 1e-9.
    assert float(process.stationary_distribution(g)) == pytest.approx(
        part / total, rel=1e-7
    )


def test_the_stationary_density_is_the_derivative_of_the_distribution(process):
    g = process.g_max * np.array([0.1, 0.4, 0.8])
    h = 1e-4 * process.g_max
    for signed in (False, True):
        p = [process.stationary_distribution(g + k, signed) for k in (h, -h)]
        # Central differences: h² p''/6.
        np.testing.assert_allclose(
            (p[0] - p[1]) / (2 * h), process.stationary_density(g, signed), rtol=1e-5
        )
    assert float(process.stationary_distribution(process.g_max)) == 1.0
    assert float(process.stationary_distribution(0.0)) == 0.0
    assert float(process.stationary_distribution(0.0, signed=True)) == 0.5
    assert float(process.stationary_distribution(-process.g_max, signed=True)) == 0.0


def test_the_ends_are_what_the_limits_say(process):
    top = process.g_max
    assert float(process.period(0.0)) == math.inf
    assert float(process.variance(0.0)) == 0.0
    assert float(process.action(top)) == 0.0
    assert float(process.variance(top)) == 0.0
    # Next to the circle J = g_max S (g_max - g), with relative accuracy.
    near = top * (1 - 2.0**-40)
    expected = top * float(process.period(top)) * (top - near)
    assert float(process.action(near)) == pytest.approx(expected, rel=1e-3)
    # An energy a rounding error beyond the circle is one on it.
    assert float(process.action(top * (1 + 2e-15))) == 0.0


def test_the_variance_is_at_most_that_of_brownian_motion_on_a_sphere(process):
    # J <= (g_max² - g²) S because w <= g_max; equality would be a box, and the steps
    # of the sampler rest on it.
    g = process.g_max * np.linspace(1e-6, 1.0, 501)
    room = NOISE**2 * (process.g_max**2 - g**2)
    assert np.all(process.variance(g) <= room)
    assert float(process.variance(g).max()) > 0.05 * NOISE**2 * process.g_max**2


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_lengths_scale(scale):
    one, other = (
        EnergyProcess(QuadraticPotential(size, size), 0.7) for size in (1.0, scale)
    )
    g = one.g_max * SHARES
    assert other.g_max == pytest.approx(scale * one.g_max, rel=1e-14)
    # Lengths scale by c, and G is a length. The last energy is 1e-6 from the largest,
    # where rounding of g is 1e-10 of what J is proportional to.
    for function, power in (("period", 1), ("variance", 2), ("action", 3)):
        np.testing.assert_allclose(
            getattr(other, function)(scale * g),
            getattr(one, function)(g) * float(scale) ** power,
            rtol=1e-9,
        )


def test_noise_only_scales_the_variance_and_the_drift():
    one, other = (EnergyProcess(QuadraticPotential(), a) for a in (0.5, 2.0))
    g = one.g_max * SHARES
    np.testing.assert_allclose(other.variance(g), 16 * one.variance(g), rtol=1e-15)
    np.testing.assert_array_equal(other.drift(g), -2.0 * g)
    np.testing.assert_array_equal(
        other.stationary_density(g), one.stationary_density(g)
    )


@pytest.mark.parametrize("shape", [(), (1,), (2, 3), (0,)])
def test_results_have_the_shape_of_the_energies(shape):
    process = PROCESSES["linear"]
    g = np.full(shape, 0.2)
    functions = [
        process.period, process.action, process.variance, process.drift,
        process.stationary_density, process.stationary_distribution,
        lambda g: process.turning_points(g)[1],
    ]  # fmt: skip
    for function in functions:
        value = function(g)
        assert isinstance(value, np.ndarray)
        assert value.shape == shape
    one = float(process.period(0.2))
    np.testing.assert_array_equal(process.period(g), np.full(shape, one))


def test_all_functions_are_even_and_the_drift_odd():
    process = PROCESSES["quadratic"]
    for function in (process.period, process.action, process.variance):
        assert float(function(-0.2)) == float(function(0.2))
    assert float(process.drift(-0.2)) == -float(process.drift(0.2))
