"""A step of κ, α and ∫α: its law in closed form, and its order uniformly in R."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import fpsolve as fp
from fpsolve._kernels import paths as kernels
from fpsolve.paths.integrators import translate
from fpsolve.paths.smooth_step import phi, smooth_step

RATIOS = [1e-9, 1e-4, 0.03, 0.9, 1.1, 7.0, 39.0, 41.0, 400.0, 1e6]


@pytest.mark.parametrize("k", [0, 1, 2, 3])
@pytest.mark.parametrize("x", RATIOS)
def test_phi_is_its_integral(k, x):
    def integrand(t):
        return math.exp(-x * t) * (1 - t) ** (k - 1) / math.factorial(k - 1)

    expected = math.exp(-x)
    if k:
        # All of the integral lies within 40/x of the origin.
        edges = np.unique(np.minimum(np.array([0, 0.1, 0.3, 1]) * 40 / x, 1.0))
        expected = sum(
            quad(integrand, *edge, epsabs=0, epsrel=1e-13)[0]
            for edge in pairwise(edges)
        )
        # Beyond, e^{-40} of it.
    assert float(phi(k, x)) == pytest.approx(expected, rel=5e-14, abs=1e-300)


def covariance(x, h=0.1, noise=1.3):
    """Covariance of the noise of κ, α and J = ∫ (α - α₀) over a step with h/R = x."""
    n11, n21, n22, n31, n32, n33 = smooth_step(h / x, noise, h).noise
    root = np.array([[n11, 0, 0], [n21, n22, 0], [h * n31, h * n32, h * n33]])
    return root @ root.T


def transition(x, h):
    """What a step without force makes of (κ, α, ∫α), with h/R = x."""
    p0, p1, p2 = (float(phi(k, x)) for k in range(3))
    return np.array([[p0, 0, 0], [h * p1, 1, 0], [h**2 * p2, h, 1]])


@pytest.mark.parametrize("x", RATIOS)
def test_two_half_steps_have_the_covariance_of_the_whole(x):
    # The law of Chapman and Kolmogorov; sums of positive terms only.
    h = 0.1
    half, move = covariance(x / 2, h / 2), transition(x / 2, h / 2)
    twice = move @ half @ move.T + half
    scale = np.sqrt(np.outer(np.diag(twice), np.diag(twice)))
    # Rounding, relative to the standard deviations.
    assert np.abs((covariance(x, h) - twice) / scale).max() < 2e-14


@pytest.mark.parametrize("x", [0.03, 0.9, 7.0])
def test_the_covariance_is_the_integral_of_the_responses_to_white_noise(x):
    h, noise = 0.1, 1.3
    length = h / x

    def responses(u):
        e = math.exp(-u / length)
        return [e, length * (1 - e), length * (u - length * (1 - e))]

    found = covariance(x, h, noise)
    for i in range(3):
        for j in range(3):
            product = quad(lambda u, i=i, j=j: responses(u)[i] * responses(u)[j], 0, h)
            expected = (noise / length) ** 2 * product[0]
            # u - R(1 - e) as written here loses three digits for h/R = 0.03.
            assert found[i, j] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("x", [0.1, 1.0, 300.0])
def test_increments_of_angle_and_curvature_have_the_variances_of_the_paper(x):
    # Γ_α(h) = RK √(1 - (R/h)(1 - e^{-h/R})), Γ_κ(h) = K √((R/h)(1 - e^{-h/R})), with κ
    # stationary at the start.
    h, noise = 0.1, 1.3
    length = h / x
    before, move = noise**2 / (2 * length), transition(x, h)
    found = covariance(x, h, noise)
    faded = -math.expm1(-x) / x
    gamma_alpha = found[1, 1] + move[1, 0] ** 2 * before
    gamma_kappa = found[0, 0] + (1 - move[0, 0]) ** 2 * before
    assert gamma_alpha / h == pytest.approx(noise**2 * (1 - faded), rel=1e-12)
    expected = (noise / length) ** 2 * faded
    assert gamma_kappa / h == pytest.approx(expected, rel=1e-12)


def test_the_spread_of_the_angle_over_a_step_is_that_of_a_random_walk_for_short_r():
    # A Brownian path of variance A² h: ∫ (α - ᾱ)² du/h = A² h/6 in the mean.
    spread, of_kappa = smooth_step(1e-9, 1.3, 0.1).spread
    assert spread == pytest.approx(0.5 * 1.3**2 * 0.1 / 6, rel=1e-7)
    # And of a straight turn κ u, for long R, it is κ² h²/12.
    assert smooth_step(1e9, 1.3, 0.1).spread[1] == pytest.approx(0.5 * 0.1**2 / 12)
    assert of_kappa * 1.3**2 / 2e-9 < 1e-8


class Coupled:
    """The steps of one length of paths whose noise is common to all lengths."""

    def __init__(self, model, ds, state):
        self.model, self.ds, self.state = model, ds, state.copy()
        self.law = smooth_step(model.relaxation_length, model.noise, ds)
        n11, n21, n22, n31, n32, n33 = self.law.noise
        scale = np.array([[n11, 0, 0], [n21, n22, 0], [n31, n32, n33]])
        self.root = np.array([[1], [1], [ds]]) * scale
        self.move = transition(ds / model.relaxation_length, ds)
        self.before = None

    def take(self, noise):
        """One step with a given noise of κ, α and ∫α."""
        numbers = np.linalg.solve(self.root, noise)
        nothing = np.zeros(2)
        translate(self.state, 0.5 * self.ds, nothing)
        forces = np.stack(self.model.potential.gradient(*self.state[:2]))
        kernels.turn_paths(self.law, numbers, forces, nothing, self.state)

    def joined(self, noise):
        """The noise of a step twice as long, once both halves of it are there."""
        if self.before is None:
            self.before = noise
            return None
        whole, self.before = self.move @ self.before + noise, None
        return whole


def moments_by_steps(length, noise, steps, s_end, n_paths):
    """Samples of some functions at the end, for each of several step lengths."""
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), length, noise)
    rng = np.random.default_rng(11)
    kappa = math.sqrt(model.curvature_variance) * rng.standard_normal(n_paths)
    angle = np.full(n_paths, 0.7)
    first = np.stack([np.ones(n_paths), 0.5 + 0 * angle, np.cos(angle), np.sin(angle),
                      0 * angle, kappa])  # fmt: skip
    levels = [Coupled(model, ds, first) for ds in steps]
    for _ in range(round(s_end / steps[-1])):
        given = levels[-1].root @ rng.standard_normal((3, n_paths))
        for level in reversed(levels):
            level.take(given)
            given = level.joined(given)
            if given is None:
                break
    states = np.stack([level.state for level in levels])
    xi1, cosine, sine = states[:, 0], states[:, 2], states[:, 3]
    square = xi1**2 + states[:, 1] ** 2
    return {"xi1": xi1, "square": square, "sin": sine, "xi1 cos": xi1 * cosine}


# R, A, the end, the longest step: functions whose bias is asymptotic from there on.
UNIFORM = [
    (1.0, 1.0, 2.0, 0.2, "sin"),
    (1.0, 1.0, 2.0, 0.2, "xi1 cos"),
    (1e-3, 0.5, 2.0, 0.4, "xi1"),
    (1e-3, 1.0, 1.0, 0.5, "sin"),
]


@pytest.mark.parametrize(("length", "noise", "s_end", "longest", "name"), UNIFORM)
def test_the_step_is_weakly_of_order_two_however_long_it_is_beside_r(
    length, noise, s_end, longest, name
):
    # For R = 1e-3 the steps are from 500 to 50 times as long.
    steps = [longest / 2**k for k in range(4)]
    values = moments_by_steps(length, noise, steps, s_end, 20_000)[name]
    between = values[:-1] - values[1:]
    change, error = between.mean(axis=1), between.std(axis=1) / math.sqrt(20_000)
    # Noise is common, so that changes of the mean stand out of it.
    assert (np.abs(change) > 10 * error).all()
    orders = np.log2(change[:-1] / change[1:])
    # 0.15 of noise at most; the rest is the next order at the coarsest step.
    assert np.abs(orders - 2).max() < 0.35, orders


@pytest.mark.parametrize("length", [0.3, 0.1, 0.03, 0.01, 1e-4])
def test_between_the_limits_the_bias_is_no_larger(length):
    values = moments_by_steps(length, 1.0, (0.2, 0.1), 2.0, 5_000)["xi1"]
    change = values[0] - values[1]
    # 0.2 ds² is what is measured for R = 1e-3; three standard errors besides.
    bound = 0.2 * 0.2**2 + 3 * change.std() / math.sqrt(5_000)
    assert abs(change.mean()) < bound


@pytest.mark.parametrize("length", [1.0, 0.02])
def test_without_noise_paths_solve_the_ordinary_equations_to_second_order(length):
    model = fp.SmoothLayDownModel(
        fp.QuadraticPotential(1.0, 0.7), length, 0.0, fp.MovingBelt(0.2)
    )
    exact = solve_ivp(
        lambda s, y: [float(part) for part in model.drift(*y)], (0.0, 2.0),
        [1.0, 0.5, 0.7, 0.4], rtol=1e-10, atol=1e-12, method="Radau",
    ).y[:, -1]  # fmt: skip
    errors = []
    for n in (20, 40, 80):
        start = ((1.0, 0.5), 0.7, 0.4)
        paths = fp.sample_paths(model, 1, 2.0, 2.0 / n, seed=1, initial=start)
        end = [*paths.xi[0, 0], paths.alpha[0, 0], paths.kappa[0, 0]]
        errors.append(np.linalg.norm(np.array(end) - exact))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # The next order: the first steps are five times R = 0.02.
    assert np.abs(orders - 2).max() < 0.4, orders
