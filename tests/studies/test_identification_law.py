"""The law of chord angles that a likelihood filters: against dense laws and paths."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import multivariate_normal

from fpsolve._kernels.chord_filter import bend_chord, set_factors
from fpsolve.studies.identification.chord_law import Parameters, chord_law
from fpsolve.studies.identification.chord_paths import grown
from fpsolve.studies.identification.chords import chords_of
from fpsolve.studies.identification.likelihood import Likelihood


def factors_of(at, ds):
    """The law, and its factors without a force that turns with the fibre."""
    law, now = chord_law(at, ds), np.empty(15)
    set_factors(law.factors, 0.0, 0.0, now)
    return law, now


def variogram_of_means(variogram, lag, ds):
    """E(ᾱ_{j+lag} - ᾱ_j)² of means over ds from V(h) = E(α_{s+h} - α_s)²."""

    def averaged(shift):
        # Differences of two uniform numbers in a step have a triangular density.
        value, _ = quad(
            lambda u: (1 - abs(u)) * variogram(abs(u + shift) * ds), -1, 1, points=[0]
        )
        return value

    return averaged(lag) - averaged(0)


@pytest.mark.parametrize("relaxation_length", [0.0, 0.05, 0.4, 3.0])
def test_angles_without_force_have_the_gaussian_law_of_means_of_the_angle(
    relaxation_length,
):
    # An independent way: the dense covariance of increments, by quadrature of the
    # variogram of α, exact for both models.
    # Turns of 0.01 a step, so that chords are mean angles to 1e-5.
    A, R, ds, n = 0.02, relaxation_length, 0.2, 9

    def variogram(h):
        return A**2 * (h + (R * math.expm1(-h / R) if R else 0.0))

    V = [variogram_of_means(variogram, lag, ds) for lag in range(n)]
    V = np.array(V)
    lags = np.abs(np.subtract.outer(np.arange(n - 1), np.arange(n - 1)))
    covariance = 0.5 * (V[lags + 1] + V[np.abs(lags - 1)] - 2 * V[lags])
    angles = np.concatenate([[0.4], 0.4 + np.cumsum(0.3 * A * np.sin(np.arange(1, n)))])
    chord = ds * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    eta = np.concatenate([[[0.0, 0.0]], np.cumsum(chord, axis=0)])
    likelihood = Likelihood([chords_of(eta, np.zeros_like(eta), ds)], ds)
    found = likelihood.densities(Parameters((0.0, 0.0), A, R))[1].sum()
    exact = multivariate_normal(np.zeros(n - 1), covariance).logpdf(np.diff(angles))
    # 1e-5 of a sum of squares of order one, beside rounding against the variance of
    # 1e5 of the first angle.
    assert found == pytest.approx(exact, abs=1e-3)


def test_increments_of_mean_angles_of_the_basic_model_are_a_moving_average():
    V = [variogram_of_means(lambda h: h, lag, 1.0) for lag in range(4)]
    assert V[1] == pytest.approx(2 / 3, rel=1e-8)
    # Covariance of neighbours (V₂ - 2V₁)/2 = 1/6, a quarter of the variance; then none.
    assert 0.5 * (V[2] - 2 * V[1]) == pytest.approx(1 / 6, rel=1e-8)
    assert 0.5 * (V[3] - 2 * V[2] + V[1]) == pytest.approx(0.0, abs=1e-8)


def test_the_angle_of_a_chord_differs_from_the_mean_angle_as_the_law_says():
    # Both of the same Brownian paths, so that only the difference has an error.
    A2h, m, n = 0.4, 24, 40_000
    steps = np.random.default_rng(5).standard_normal((n, m)) * math.sqrt(A2h / m)
    alpha = np.cumsum(steps, axis=1) - 0.5 * steps
    chord = np.angle(np.exp(1j * alpha).mean(axis=1))
    excess = chord**2 - alpha.mean(axis=1) ** 2
    law, now = factors_of(Parameters((0.0, 0.0), math.sqrt(A2h)), 1.0)
    bend_chord(law.path, 0.0, 0.0, 0.0, now)
    variance = now[14] + law.chord_variance
    series = (1 / 3, 1 / 360, 19 / 45360, 31 / 362880)
    # Exact: Gauss nodes integrate these polynomials.
    exact = sum(g * A2h ** (k + 1) for k, g in enumerate(series))
    assert variance == pytest.approx(exact, rel=1e-12)
    error = excess.std() / math.sqrt(n)
    # The next term of the series is 2e-7.
    assert excess.mean() == pytest.approx(variance - A2h / 3, abs=3 * error)
    assert excess.mean() > 3 * error


@pytest.mark.parametrize(("kappa", "force"), [(60.0, 10.0), (40.0, -120.0)])
def test_a_bent_fibre_has_the_chord_that_the_law_says(kappa, force):
    # Exact steps of 1/24 of a chord, which turns by up to 1.2, and its noise by 0.3.
    R, A, h, m, n = 0.05, 5.0, 0.02, 24, 40_000
    at = Parameters((0.0, 0.0), A, R)
    law, now = factors_of(at, h)
    plain = now.copy()
    mean = now[2] * kappa + now[7] * force
    shift = bend_chord(law.path, kappa, force, 0.0, now)
    small, rng = factors_of(at, h / m)[1], np.random.default_rng(3)
    root = np.linalg.cholesky(
        [[small[9], small[10], small[12]], [small[10], small[11], small[13]],
         [small[12], small[13], small[14]]]
    )  # fmt: skip
    k, alpha, total = np.full(n, kappa), np.zeros(n), np.zeros(n, dtype=complex)
    linear = np.zeros(n)
    for _ in range(m):
        noise = root @ rng.standard_normal((3, n))
        middle = alpha + small[2] * k + small[7] * force + noise[2]
        total, linear = total + np.exp(1j * middle), linear + middle / m
        alpha = alpha + small[1] * k + small[5] * force + noise[1]
        k = small[0] * k + small[3] * force + noise[0]
    chord = np.angle(total)
    away = chord - linear
    # Third order in turns of half a radian on either side: the fifth is a fiftieth.
    slack = 0.02 * abs(shift) + 3 * away.std() / math.sqrt(n)
    assert away.mean() == pytest.approx(shift, abs=slack)
    for row, other, factor in ((12, k, 1), (13, alpha, 1), (14, chord + linear, 1)):
        change = away * (other - other.mean())
        error = 3 * change.std() / math.sqrt(n)
        expected = factor * (now[row] - plain[row])
        # Of what is changed, by squares of turns of next order: d²/2 of it, 0.05.
        assert change.mean() == pytest.approx(
            expected, abs=error + 0.06 * abs(expected)
        )
    # What is claimed is seen.
    assert abs(away.mean()) > 30 * away.std() / math.sqrt(n)
    assert abs(now[14] - plain[14]) > 2 * error
    assert mean == pytest.approx(linear.mean(), abs=3 * linear.std() / math.sqrt(n))


@pytest.mark.parametrize("relaxation_length", [0.0, 0.05, 1.0])
def test_a_force_that_turns_with_the_fibre_is_there_to_second_order(relaxation_length):
    # Dense: α = path + (c/h) K (α - ᾱ) on 400 midpoints, solved. Both ways are compared
    # in what c changes, so that the midpoints err by the square of 1/400 of that.
    h, R, m = 0.1, relaxation_length, 400
    law = chord_law(Parameters((0.0, 0.0), 1.0, R), h)
    x = h / R if R else math.inf
    t = (np.arange(m) + 0.5) / m
    ends = np.append(t, 1.0)

    def responses(k):
        # Of α, or of its integral, at all midpoints and at the end.
        lag = ends[:, None] - t
        return np.where(lag > 0, grown(k, x, np.maximum(lag, 0.0)), 0.0) + (
            0.5 * (lag == 0) if k == 1 and not R else 0.0
        )

    turns = responses(1)
    kicks = math.sqrt(h / m) * turns
    forced = h * grown(2, x, ends)
    centred = np.eye(m) - 1 / m

    def changed(c):
        inner = np.linalg.inv(np.eye(m) - c / m * turns[:m] @ centred)

        def solved(path):
            along = inner @ path[:m]
            end = path[m] + c / m * turns[m] @ centred @ along
            return end, along.mean(axis=0)

        force, noise = solved(forced), solved(kicks)
        return np.array(
            [*force, *(noise[i] @ noise[j] for i, j in ((0, 0), (0, 1), (1, 1)))]
        )

    errors = []
    for c in (0.4, 0.2, 0.1):
        found = law.factors @ [0.0, c, c * c, 0.0]
        away = found[[5, 7, 11, 13, 14]] - (changed(c) - changed(0.0))
        errors.append(np.abs(away / (found[[5, 7, 11, 13, 14]] + 1e-3 * h)).max())
    # Relative to what is changed: c³ is left of c, and of κ 1/R times the grid.
    for c, error in zip((0.4, 0.2, 0.1), errors, strict=True):
        assert error < 0.03 * c**2 + 3e-4
    if not R:
        orders = np.log2(np.divide(errors[:-1], errors[1:]))
        assert orders == pytest.approx([2.0, 2.0], abs=0.25)


def test_forces_along_a_circle_are_its_line_integrals():
    # ξ = r(cos, sin): ∫ ξ1 dη2 = ∫ r² cos². The trapezoidal rule errs by O(Δs²), with
    # the area between arc and chord by O(Δs⁴).
    rule, mended = [], []
    for n in (40, 80, 160, 320):
        t = np.linspace(0.0, 1.0, n + 1)
        eta = 2.0 * np.stack([np.cos(t), np.sin(t)], axis=1)
        chords = chords_of(eta, np.zeros_like(eta), 2.0 / n)
        exact = 4.0 * (0.5 + math.sin(2.0) / 4)
        area = chords.areas[:, 0] / (12 * n)
        rule.append(abs(2.0 / n * chords.forces[:, 0].sum() - exact))
        mended.append(abs(2.0 / n * (chords.forces[:, 0] + area).sum() - exact))
    for errors, order in ((rule, 2.0), (mended, 4.0)):
        orders = np.log2(np.divide(errors[:-1], errors[1:]))
        assert orders == pytest.approx([order] * 3, abs=0.02)
