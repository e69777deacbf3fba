"""Moments of smooth fibres over s against exact laws, paths and the basic model."""

import math

import numpy as np
import pytest
from numpy.polynomial import hermite_e

import fpsolve as fp
from fpsolve.paths import GaussianLaw
from fpsolve.spectral.evolution import smooth_transient
from fpsolve.spectral.evolution.circular_functions import (
    CircularFunctions,
    Scales,
    Truncation,
)
from fpsolve.spectral.evolution.smooth_generator import backward_generator
from fpsolve.spectral.evolution.smooth_observables import SERIES
from fpsolve.spectral.evolution.sparse_exponential import SparseExponential
from fpsolve.spectral.work import Work

ROUND, FLAT = fp.QuadraticPotential(), fp.QuadraticPotential(1.0, 0.7)
START = GaussianLaw((0.5, -0.3), ((0.7, 0.1), (0.1, 0.6)), 0.8, 1.0)
# Everything that couples sectors, and nothing that is symmetric.
SKEWED = fp.SmoothLayDownModel(FLAT, 0.4, 1.2, fp.MovingBelt(0.2))
REST = fp.SmoothLayDownModel(ROUND, 0.1, 1.0)
STOPS = (0.0, 0.5, 1.0, 2.0)


@pytest.fixture(scope="module")
def skewed():
    return fp.spectral_solve(SKEWED, START, STOPS, tolerance=1e-5)


@pytest.fixture(scope="module")
def at_rest():
    return fp.spectral_solve(REST, START, STOPS)


def circular_hermite(p, q, z, variance):
    """Σ_k (−1)^k k! C(p, k) C(q, k) z^{p−k} z̄^{q−k}, orthonormal."""
    x = z / math.sqrt(2 * variance)
    terms = (
        (-1) ** k * math.factorial(k) * math.comb(p, k) * math.comb(q, k)
        * x ** (p - k) * np.conj(x) ** (q - k)
        for k in range(min(p, q) + 1)
    )  # fmt: skip
    return sum(terms) / math.sqrt(math.factorial(p) * math.factorial(q))


def values(functions, potential, point):
    """ψ of every function at (ξ₁, ξ₂, α, κ), by its definition."""
    xi1, xi2, alpha, kappa = point
    z, scales = (
        complex(xi1 / potential.sigma1, xi2 / potential.sigma2),
        functions.scales,
    )
    weight = (1 - scales.plane_share) * abs(z) ** 2 / scales.plane
    weight += (1 - scales.curvature_share) * kappa**2 / scales.curvature
    found = []
    for p, q, n, m in functions.indices.T.tolist():
        polynomial = hermite_e.hermeval(
            kappa / math.sqrt(scales.curvature), [0.0] * n + [1.0]
        ) / math.sqrt(math.factorial(n))
        wave = np.exp(1j * (m - p + q) * alpha)
        plane = circular_hermite(p, q, z, scales.plane)
        found.append(1j**n * plane * polynomial * wave)
    return np.exp(-0.5 * weight) * np.array(found)


def test_the_matrix_is_the_backward_equation():
    """At points and with differences, for functions that it keeps inside."""
    scales = Scales(1.3, 0.9, 0.8, 0.7)
    functions = CircularFunctions(Truncation(6, 6, 8), scales)
    p, q, n, m = functions.indices
    inside = (p + q <= 1) & (n <= 1) & (np.abs(m) <= 1)
    matrix = backward_generator(functions, SKEWED).toarray()[:, inside]
    step = 1e-3

    def shifted(point, axis, steps):
        moved = np.array(point)
        moved[axis] += steps * step
        return values(functions, FLAT, moved)[inside]

    for point in ([0.4, -0.3, 0.7, 0.5], [-0.8, 0.2, 2.9, -0.6]):
        here = values(functions, FLAT, point)
        # Differences of order four: 1e-12 times derivatives below 1e3.
        slopes = [
            (8 * (shifted(point, axis, 1) - shifted(point, axis, -1))
             - (shifted(point, axis, 2) - shifted(point, axis, -2))) / (12 * step)
            for axis in range(4)
        ]  # fmt: skip
        bend = (
            16 * (shifted(point, 3, 1) + shifted(point, 3, -1))
            - (shifted(point, 3, 2) + shifted(point, 3, -2)) - 30 * here[inside]
        ) / (12 * step**2)  # fmt: skip
        drift = SKEWED.drift(*point)
        expected = sum(float(a) * b for a, b in zip(drift, slopes, strict=True))
        expected = expected + 0.5 * SKEWED.curvature_noise**2 * bend
        np.testing.assert_allclose(here @ matrix, expected, rtol=0, atol=1e-7)


def test_the_start_has_its_moments(skewed):
    """Closed forms: Gaussian, I₁/I₀ of von Mises, K²R/2; all to the truncation."""
    share = 0.44639  # I₁(1)/I₀(1) to 1e-5
    exact = {
        "mass": 1.0, "mean_xi1": 0.5, "mean_xi2": -0.3, "variance_xi1": 0.7,
        "variance_xi2": 0.6, "covariance": 0.1, "mean_kappa": 0.0,
        "mean_cos_alpha": share * math.cos(0.8),
        "mean_sin_alpha": share * math.sin(0.8),
        "mean_kappa2": SKEWED.curvature_variance,
    }  # fmt: skip
    assert set(exact) == set(SERIES)
    for name, value in exact.items():
        error = skewed.errors[name][0] + 1e-5 * name.endswith("alpha")
        assert abs(skewed.series[name][0] - value) <= error, name


def test_the_plane_moves_with_the_mean_tangent():
    """E ξ(s) − E ξ(0) = ∫ (E τ + v e₁) ds, exact: Gauss's rule with eight nodes."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    s = np.append(0.5 * (nodes + 1), 1.0)
    found = fp.spectral_solve(SKEWED, START, s, tolerance=1e-5)
    for name, start, tangent in (
        ("mean_xi1", 0.5, found.mean_cos_alpha + 0.2),
        ("mean_xi2", -0.3, found.mean_sin_alpha),
    ):
        moved = 0.5 * weights @ tangent[:-1]
        # The rule is exact to 1e-9 for rates up to 1/R = 2.5 on a unit interval.
        assert abs(found.series[name][-1] - start - moved) < 1e-6


def test_the_angle_turns_first_by_its_curvature_and_then_by_the_force():
    """E cos α = c₀ + (s²/2)(−K²R/2 c₀ + E[∇B·τ⊥ sin α]/R) + O(s³), ξ, α, κ apart."""
    model = fp.SmoothLayDownModel(ROUND, 0.4, 1.2)
    found = fp.spectral_solve(model, START, (0.0, 0.0125, 0.025, 0.05), tolerance=1e-8)
    bessel1, bessel2 = 0.44638999, 0.10722038  # I₁/I₀ and I₂/I₀ at 1, to 1e-8
    c0 = bessel1 * math.cos(0.8)
    sine_square, product = (
        0.5 - 0.5 * bessel2 * math.cos(1.6),
        0.5 * bessel2 * math.sin(1.6),
    )
    force = -0.5 * sine_square + (-0.3) * product
    curvature = -model.curvature_variance * c0 + force / 0.4
    rest = found.mean_cos_alpha[1:] - c0 - 0.5 * curvature * found.s[1:] ** 2
    orders = np.log2(rest[1:] / rest[:-1])
    # Of third order, with a fourth-order part of relative size s/R up to 0.1.
    assert np.all(np.abs(orders - 3.0) < 0.2), orders


@pytest.mark.parametrize("model", [REST, SKEWED], ids=["at rest", "belt, two widths"])
def test_paths_have_these_moments(model):
    """20000 paths: within four standard errors; a step of 0.02 moves them by less."""
    s = (0.5, 1.0, 2.0)
    found = fp.spectral_solve(model, START, s, tolerance=1e-4)
    paths = fp.sample_paths(
        model, 20_000, 2.0, 0.02, seed=4, initial=START, save_at=s, keep=False
    )
    sampled = paths.moments()
    for name in SERIES[1:]:
        value, error = sampled[name]
        away = np.abs(found.series[name] - value[-3:])
        assert np.all(away <= 4 * error[-3:] + found.errors[name]), name


def test_short_relaxation_gives_the_basic_model_to_first_order():
    """The distance halves with R, at every halving; 5 % of O(R²) at R = 0.04."""
    curve = fp.MovingBelt(0.2)
    basic = fp.spectral_solve(fp.LayDownModel(ROUND, 1.0, curve), START, 1.0)
    distances = []
    for length in (0.04, 0.02, 0.01):
        model = fp.SmoothLayDownModel(ROUND, length, 1.0, curve)
        found = fp.spectral_solve(model, START, 1.0, tolerance=1e-5)
        names = ("mean_xi1", "variance_xi1", "variance_xi2", "mean_cos_alpha")
        distances.append(
            [float(found.series[k][0] - basic.series[k][0]) for k in names]
        )
    orders = np.log2(np.divide(distances[:-1], distances[1:]))
    assert np.all(np.abs(orders - 1.0) < 0.15), orders


@pytest.mark.nightly
def test_what_is_stationary_is_reached():
    """Var ξ₁ = 1.1177619 for R = 0.1, A = 1 (a three-dimensional Galerkin method in
    the frame of the fibre), E κ² = K²R/2 + 1 exactly; e^{−gap s} is 1e-6 at s = 50.
    """
    found = fp.spectral_solve(REST, START, (5.0, 50.0), tolerance=1e-4)
    for name, exact in (
        ("variance_xi1", 1.1177619), ("variance_xi2", 1.1177619),
        ("mean_kappa2", REST.curvature_variance + 1), ("mean_cos_alpha", 0.0),
    ):  # fmt: skip
        assert abs(found.series[name][-1] - exact) <= found.errors[name][-1] + 2e-6


@pytest.mark.nightly
def test_on_a_belt_the_mean_tangent_turns_back():
    """E cos α → −v and E sin α → 0, exactly; e^{−gap s} is 1e-3 at s = 30."""
    model = fp.SmoothLayDownModel(ROUND, 0.1, 1.0, fp.MovingBelt(0.3))
    found = fp.spectral_solve(model, START, (0.5, 30.0), tolerance=1e-2)
    errors = found.errors["mean_cos_alpha"], found.errors["mean_sin_alpha"]
    away = np.array([found.mean_cos_alpha + 0.3, found.mean_sin_alpha])
    assert np.all(np.abs(away[:, 1]) <= np.array(errors)[:, 1] + 1e-3)
    assert np.all(np.abs(away[:, 0]) > 0.1)


def test_a_turned_start_gives_turned_moments(at_rest):
    """B is isotropic: exact in every truncation, so that only rounding is left."""
    turn = 1.1
    rotation = np.array(
        [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    )
    turned = GaussianLaw(
        tuple(rotation @ START.mean), rotation @ START.variance @ rotation.T,
        START.angle + turn, 1.0,
    )  # fmt: skip
    found = fp.spectral_solve(REST, turned, STOPS)
    before = np.array([at_rest.mean_xi1, at_rest.mean_xi2])
    after = np.array([found.mean_xi1, found.mean_xi2])
    # The exponential is computed to a thousandth of the tolerance of 1e-6.
    np.testing.assert_allclose(after, rotation @ before, rtol=0, atol=1e-8)
    np.testing.assert_allclose(
        found.mean_kappa2, at_rest.mean_kappa2, rtol=0, atol=1e-8
    )


@pytest.mark.nightly
def test_exchanged_axes_give_exchanged_moments():
    law = GaussianLaw((0.3, -0.2), (0.7, 0.4), 0.8, 1.0)
    # A turn by −π/2 takes ξ₂ to ξ₁.
    turned = GaussianLaw((-0.2, -0.3), (0.4, 0.7), 0.8 - 0.5 * math.pi, 1.0)
    one, other = (
        fp.spectral_solve(
            fp.SmoothLayDownModel(fp.QuadraticPotential(*sigma), 0.3, 1.5), start,
            1.0, tolerance=1e-4,
        )
        for sigma, start in (((1.0, 0.7), law), ((0.7, 1.0), turned))
    )  # fmt: skip
    for here, there, sign in (
        ("mean_xi2", "mean_xi1", 1), ("variance_xi1", "variance_xi2", 1),
        ("covariance", "covariance", -1), ("mean_kappa", "mean_kappa", 1),
    ):  # fmt: skip
        # Both truncations are the same, and the exponential is good to 1e-7.
        assert abs(one.series[here][0] - sign * other.series[there][0]) < 1e-6


COVERED = [
    (0.05, 0.7, 0.0), (0.05, 2.0, 0.3), (0.3, 0.7, 0.0), (0.3, 2.0, 0.3),
    (1.0, 1.0, 0.0), (1.0, 4.0, 0.0),
]  # fmt: skip


@pytest.mark.parametrize(("length", "noise", "belt"), COVERED)
def test_errors_cover(length, noise, belt):
    """What is claimed at 1e-2 holds against what is claimed at 1e-4."""
    curve = fp.MovingBelt(belt) if belt else None
    model = fp.SmoothLayDownModel(ROUND, length, noise, curve)
    rough, fine = (
        fp.spectral_solve(model, START, (0.5, 2.0), tolerance=tolerance)
        for tolerance in (1e-2, 1e-4)
    )
    for name in SERIES:
        away = np.abs(rough.series[name] - fine.series[name])
        assert np.all(away <= rough.errors[name] + fine.errors[name]), name


def test_a_sparse_exponential_is_that_of_the_matrix():
    """Against the rational approximation of scipy, for real and complex spectra."""
    from scipy import sparse
    from scipy.linalg import expm

    rng = np.random.default_rng(2)
    for turning in (0.1, 1.0, 20.0):
        part = rng.standard_normal((60, 60))
        full = turning * (part - part.T) - np.diag(np.arange(60.0))
        x = rng.standard_normal(60)
        found = SparseExponential(sparse.csr_array(full))(x, 0.7, 1e-11, Work())
        # Rounding grows with the terms of the series, of which there are hundreds.
        np.testing.assert_allclose(found, expm(0.7 * full) @ x, rtol=0, atol=1e-9)


@pytest.mark.nightly
def test_without_damping_a_truncation_grows(monkeypatch):
    """What makes the last functions of a truncation grow is real, and is damped."""
    law = START
    functions = CircularFunctions(
        Truncation(20, 14, 0), smooth_transient.scales_of(REST, law)
    )
    stops = np.array([90.0])
    damped = smooth_transient.run(REST, functions, law, stops, 1e-6, Work())
    monkeypatch.setattr(smooth_transient, "DAMPING", 0.0)
    free = smooth_transient.run(REST, functions, law, stops, 1e-6, Work())
    assert abs(damped[0, 0] - 1) < 1e-5
    assert not abs(free[0, 0] - 1) < 1e-3


def test_a_truncation_that_overflows_has_no_moments(monkeypatch):
    law = START
    functions = CircularFunctions(
        Truncation(8, 6, 0), smooth_transient.scales_of(REST, law)
    )
    monkeypatch.setattr(smooth_transient, "DAMPING", -3.0)
    lost = smooth_transient.run(REST, functions, law, np.array([90.0]), 1e-6, Work())
    assert np.isnan(lost).all()
