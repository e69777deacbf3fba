"""Paths against exact laws: weak orders, stationary laws, conserved quantities."""

import math
from functools import cache

import numpy as np
import pytest
from orders import measure_order
from scipy import stats

import fpsolve as fp
from fpsolve.paths import EquilibriumLaw, PointLaw

# Where all ensembles of this file start that do not start from a stationary law.
START = PointLaw((1.2, -0.4), 0.9)
QUADRATIC = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
POTENTIALS = {
    "quadratic": fp.QuadraticPotential(),
    "anisotropic": fp.QuadraticPotential(1.0, 0.5),
    "linear": fp.LinearPotential(),
    "quartic": fp.PowerPotential(4.0),
}


@cache
def moments(model, n_steps, s_end, method="splitting", n_paths=1_000_000, seed=7):
    """Moments at the end, and their standard errors."""
    paths = fp.sample_paths(
        model, n_paths, s_end, s_end / n_steps, seed=seed, method=method,
        initial=START, keep=False,
    )  # fmt: skip
    found = paths.moments()
    return {name: (found[name][0][0], found[name][1][0]) for name in found}


@pytest.fixture(scope="module")
def limits():
    """Moments at s = 2 by 32 steps: a bias 16 times below the finest measured here."""
    # It moves the last order by log2(16/15) = 0.09.
    return moments(QUADRATIC, 32, 2.0, n_paths=4_000_000)


# Numbers of steps over s = 2 at which the bias is asymptotic and still at least ten
# standard errors (1e-3 for E‖ξ‖², 3e-4 for E cos α with 2e6 paths): the orders are then
# known to about 0.2.
WEAK = [
    ("splitting", 2, "mean_square", 2),
    ("splitting", 2, "mean_cos_alpha", 2),
    ("heun", 2, "mean_cos_alpha", 2),
    ("euler_maruyama", 1, "mean_square", 8),
    ("euler_maruyama", 1, "mean_cos_alpha", 8),
]


# Orders and survival are looked at where steps are long, which is told.
LONG_STEPS = pytest.mark.filterwarnings("ignore:`ds` = .* is long for this force")


@LONG_STEPS
@pytest.mark.parametrize(("method", "order", "name", "first"), WEAK)
def test_weak_orders_are_observed_at_every_halving(method, order, name, first, limits):
    def bias(n_steps):
        found = moments(QUADRATIC, n_steps, 2.0, method, n_paths=2_000_000)
        return abs(found[name][0] - limits[name][0])

    convergence = measure_order(bias, first)
    # 0.2 of noise, and what the next order leaves at the coarsest step.
    assert np.abs(convergence.orders - order).max() < 0.4, str(convergence)


def test_the_splitting_is_biased_less_than_the_others_at_the_same_step(limits):
    def bias(method):
        found = moments(QUADRATIC, 20, 2.0, method)
        return abs(found["mean_square"][0] - limits["mean_square"][0])

    # Measured: 0.002, of Euler-Maruyama 0.11; the standard error is 0.002.
    assert bias("splitting") < 0.01
    assert bias("euler_maruyama") > 0.05


@pytest.mark.parametrize("potential", [POTENTIALS["quadratic"], POTENTIALS["quartic"]])
@pytest.mark.parametrize("noise", [0.5, 1.0, 2.0])
def test_the_mean_of_g_decays_like_its_eigenvalue(potential, noise):
    # MATH statement: G = e^{-B}(ξ1 sin α - ξ2 cos α) satisfies L G = -(A²/2) G.
    model = fp.LayDownModel(potential, noise)

    def g(xi1, xi2, alpha):
        away = xi1 * np.sin(alpha) - xi2 * np.cos(alpha)
        return np.exp(-potential.value(xi1, xi2)) * away

    paths = fp.sample_paths(
        model, 200_000, 2.0, 1 / 32, seed=3, initial=START, save_at=(0.0, 0.5, 1.0, 2.0)
    )
    value, error = paths.expectation(g)
    exact = value[0] * np.exp(-0.5 * noise**2 * paths.s)
    # Four standard errors, and 2e-4 for the bias of the step (order two, 3e-3 at 1/8).
    assert np.all(np.abs(value - exact)[1:] < 4 * error[1:] + 2e-4)


def test_the_random_walk_has_its_exact_moments():
    # Statement 2: E cos(α_s - α_0) = e^{-A²s/2}, exact for the splitting, and
    # E‖ξ_s - ξ_0‖² = (4/A²)(s - (2/A²)(1 - e^{-A²s/2})).
    noise, s = 1.3, np.array([0.5, 1.0, 3.0])
    model = fp.LayDownModel(fp.FreePotential(), noise)
    start = (0.0, 0.0), 0.0
    paths = fp.sample_paths(
        model, 400_000, 3.0, 1 / 32, seed=3, initial=start, save_at=s
    )
    found = paths.moments()
    rate = 0.5 * noise**2
    cosine = np.exp(-rate * s)
    square = (2 / rate) * (s - (1 - np.exp(-rate * s)) / rate)
    for name, exact in (("mean_cos_alpha", cosine), ("mean_square", square)):
        value, error = found[name]
        # Four standard errors; the bias of the square is A² ds² s/12 = 4e-4.
        assert np.all(np.abs(value - exact) < 4 * error + 5e-4), name


@pytest.mark.parametrize("noise", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("name", POTENTIALS)
def test_paths_that_start_from_the_stationary_law_keep_it(name, noise):
    potential = POTENTIALS[name]
    model = fp.LayDownModel(potential, noise)
    law = EquilibriumLaw(potential)
    paths = fp.sample_paths(model, 40_000, 5.0, 0.05, seed=11, initial=law)
    # Kolmogorov-Smirnov against the law of B (gamma for powers of ‖ξ‖, exponential
    # for quadratic B), and uniform angles; 24 tests, each with a false alarm in 1e-4.
    shape = {"linear": 2.0, "quartic": 0.5}.get(name, 1.0)
    energy = potential.value(paths.xi[0, :, 0], paths.xi[0, :, 1])
    assert stats.kstest(energy, stats.gamma(shape).cdf).pvalue > 1e-4
    share = paths.wrapped_alpha[0] / (2 * np.pi)
    assert stats.kstest(share, "uniform").pvalue > 1e-4
    # ξ and α are independent in the stationary law.
    correlation = np.corrcoef(paths.xi[0, :, 0], np.cos(paths.alpha[0]))[0, 1]
    assert abs(correlation) < 4 / math.sqrt(paths.n_paths)


@pytest.mark.parametrize("potential", [POTENTIALS["quadratic"], POTENTIALS["linear"]])
@pytest.mark.parametrize("ds", [0.1, 0.5])
def test_on_a_moving_belt_the_mean_direction_is_minus_the_belt_speed(potential, ds):
    # E τ = γ' in the stationary state, for the splitting at every step: the mean of ξ
    # over a step then does not move.
    model = fp.LayDownModel(potential, 1.0, fp.MovingBelt(0.3))
    paths = fp.sample_paths(model, 20_000, 200.0, ds, seed=2, keep=False, save_at=SAVES)
    found = paths.moments()
    for name, exact in (("mean_cos_alpha", -0.3), ("mean_sin_alpha", 0.0)):
        value, error = found[name]
        combined = math.sqrt(np.sum(error**2)) / len(value)
        # Arclengths 20 apart are independent to 2 %; four standard errors.
        assert abs(value.mean() - exact) < 4 * combined, name


SAVES = np.arange(40.0, 201.0, 20.0)


@pytest.mark.parametrize("name", ["quadratic", "linear", "quartic"])
def test_without_noise_the_energy_of_the_orbit_is_kept_to_second_order(name):
    # Statement 3: A = 0 carries G along; its error does not grow with s.
    potential = POTENTIALS[name]
    model = fp.LayDownModel(potential, 0.0)

    def worst(n_steps):
        start = (0.7, 0.3), 1.0
        path = fp.sample_paths(model, 1, 40.0, 40 / n_steps, seed=0, initial=start)
        path = path.replay(0)
        away = path.xi[:, 0] * np.sin(path.alpha) - path.xi[:, 1] * np.cos(path.alpha)
        g = np.exp(-potential.value(*path.xi.T)) * away
        return np.abs(g - g[0]).max()

    convergence = measure_order(worst, 400, 3)
    assert np.abs(convergence.orders - 2).max() < 0.3, str(convergence)
    assert convergence.errors[-1] < 1e-4, str(convergence)


@LONG_STEPS
def test_noise_of_any_size_leaves_the_tangent_on_the_circle():
    for noise in (10.0, 1e3, 1e6):
        for method in ("splitting", "euler_maruyama", "heun"):
            model = fp.LayDownModel(fp.QuadraticPotential(), noise)
            paths = fp.sample_paths(
                model, 2000, 20.0, 0.5, seed=1, method=method, initial=START
            )
            cosine, sine = paths.states[0, 2:4]
            # One Newton step a step leaves rounding only.
            np.testing.assert_allclose(cosine**2 + sine**2, 1, rtol=0, atol=1e-15)
            # At most 40 independent steps of length ds: deviation 3.2; five times that.
            share = paths.wrapped_alpha[0] / (2 * np.pi)
            assert stats.kstest(share, "uniform").pvalue > 1e-4
            assert np.hypot(*paths.xi[0].T).max() < 16


@LONG_STEPS
def test_a_force_of_any_size_turns_the_tangent_but_breaks_nothing():
    # |∇B| ds = 4e6: the rotation ends where the angle comes to rest.
    model = fp.LayDownModel(fp.PowerPotential(4.0), 1.0)
    paths = fp.sample_paths(
        model, 500, 5.0, 0.05, seed=1, initial=((400.0, 0.0), 0.3), save_at=(0.05, 5.0)
    )
    assert np.isfinite(paths.states).all()
    # At once all paths run back towards the origin.
    np.testing.assert_allclose(np.cos(paths.alpha[0]), -1, rtol=0, atol=1e-9)
    np.testing.assert_allclose(paths.xi[1, :, 0], 400 - 5 + 0.05, rtol=0, atol=0.1)


def test_paths_go_through_the_kink_of_the_linear_potential():
    model = fp.LayDownModel(fp.LinearPotential(), 0.0)
    start = (-1.0, 0.0), 0.0
    # Without noise and straight at the origin there is no force that turns it, on
    # either side; the midpoint of a step hits the origin exactly.
    path = fp.sample_paths(model, 1, 2.0, 0.125, seed=0, initial=start).replay(0)
    np.testing.assert_allclose(path.xi[-1], (1.0, 0.0), rtol=0, atol=1e-15)
    assert np.abs(path.alpha).max() == 0


def test_the_curve_enters_by_its_exact_displacement():
    # Free fibres without noise: ξ = s τ - (γ(s) - γ(0)) for every step.
    curve = fp.RotatingNozzle(0.1, 0.8, 5.0, 0.2)
    model = fp.LayDownModel(fp.FreePotential(), 0.0, curve)
    for method in ("splitting", "euler_maruyama", "heun"):
        paths = fp.sample_paths(
            model, 1, 9.0, 0.75, seed=0, initial=((0.0, 0.0), 0.5), method=method,
            s_start=0.0,
        )  # fmt: skip
        moved = np.subtract(curve.position(9.0), curve.position(0.0))
        exact = 9 * np.array([np.cos(0.5), np.sin(0.5)]) - moved
        np.testing.assert_allclose(paths.xi[0, 0], exact, rtol=0, atol=1e-13)


def test_s_start_is_where_the_curve_is_taken_from():
    curve = fp.OscillatingNozzle(0.0, 1.0, 1.0)
    model = fp.LayDownModel(fp.FreePotential(), 0.0, curve)
    paths = fp.sample_paths(
        model, 1, 3.0, 0.5, seed=0, initial=((0.0, 0.0), 0.0), s_start=1.0
    )
    moved = math.sin(3.0) - math.sin(1.0)
    np.testing.assert_allclose(paths.xi[0, 0], (2.0, -moved), rtol=0, atol=1e-14)
