"""First passage: the equation, exact occupations, killed chains, sampled paths."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from energy_processes import NOISE, PROCESSES
from orders import assert_order, measure_order

from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess

QUADRATIC = PROCESSES["quadratic"]
RATE = NOISE**2 / 2
# -ζ(1/2)/√(2π): mean overshoot of a Gaussian random walk over a high barrier, in
# steps' standard deviations.
OVERSHOOT = 0.5825971579390107


@pytest.fixture(params=["quadratic", "linear", "heavy", "flat"])
def process(request):
    return PROCESSES[request.param]


def slope(function, g, h):
    """Sixth-order central difference."""
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    return sum(
        c * (function(g + k * h) - function(g - k * h)) / h for k, c in weights.items()
    )


@pytest.mark.parametrize("side", ["below", "above"])
def test_the_mean_solves_the_backward_equation(process, side):
    # (A²/2)(J V')' = -S once integrated: no flux at 0 from below, none at g_max from
    # above.
    target = 0.5 * process.g_max
    passage = process.passage(target)
    g = process.g_max * np.array([0.1, 0.3] if side == "below" else [0.6, 0.85])
    flux = RATE * process.action(g) * slope(passage.mean, g, 1e-2 * process.g_max)
    beyond = process._averages.measure(g)
    exact = beyond - process._averages.total if side == "below" else beyond
    # (h/distance)⁶ of the differences, 1e-6 at worst.
    np.testing.assert_allclose(flux, exact, rtol=1e-5)
    assert float(passage.mean(target)) == 0.0


def test_the_expected_integral_of_the_energy_is_the_energy_lost(process):
    # Optional stopping of dG = -(A²/2) G ds + martingale, from above the target, where
    # G does not change its sign: exact for every potential.
    for share in (0.0, 0.3):
        target = share * process.g_max
        g = process.g_max * np.array([0.4, 0.9, 1.0])
        found = process.passage(target).expected(lambda g: g, g)
        np.testing.assert_allclose(found, (g - target) / RATE, rtol=1e-9)


def test_eigenfunctions_give_exact_integrals(process):
    # L u = -λ u gives E ∫ λ u ds = u(g) - u(target), for the even family from either
    # side.
    found = process.spectrum(2)
    rate, g = found.eigenvalues[1], process.g_max * np.array([0.0, 0.2, 0.7, 1.0])
    for share in (0.1, 0.5, 0.95):
        target = share * process.g_max
        integral = process.passage(target).expected(
            lambda g: rate * found.eigenfunction(1, g), g
        )
        exact = found.eigenfunction(1, g) - found.eigenfunction(1, target)
        # Eigenfunctions of two hundred coefficients are good to about 1e-10.
        np.testing.assert_allclose(integral, exact, atol=1e-8)


def test_occupations_add_up_to_the_mean(process):
    passage = process.passage(0.6 * process.g_max)
    g = process.g_max * np.array([0.0, 0.35, 0.6, 0.9])
    ends = process.g_max * np.array([0.0, 0.1, 0.35, 0.6, 0.75, 1.0])
    parts = [passage.occupation(low, high, g) for low, high in pairwise(ends)]
    mean = passage.mean(g)
    np.testing.assert_allclose(sum(parts), mean, rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(
        passage.occupation(0.0, process.g_max, g), mean, rtol=1e-10, atol=1e-14
    )
    assert np.all(np.array(parts) >= -1e-14)
    # From below the target nothing is spent above it, and the other way round.
    assert parts[-1][0] == 0.0
    assert parts[0][-1] == 0.0


@pytest.mark.parametrize("from_above", [False, True])
def test_a_killed_chain_of_cells_converges_to_mean_and_variance(from_above):
    @cache
    def errors(n):
        grid = QUADRATIC.grid(n)
        place = n // 2
        alive = np.arange(n) > place if from_above else np.arange(n) < place
        target, g = grid.centres[place], grid.centres[alive]
        matrix = grid.generator(NOISE).toarray()[np.ix_(alive, alive)].T
        mean = np.linalg.solve(matrix, -np.ones(alive.sum()))
        second = np.linalg.solve(matrix, -2 * mean)
        exact = QUADRATIC.passage(target)
        wrong = np.abs(mean - exact.mean(g)).max() / np.abs(mean).max()
        variance = second - mean**2
        return wrong, np.abs(variance - exact.variance(g)).max() / variance.max()

    for which in (0, 1):
        measured = measure_order(lambda n, which=which: errors(n)[which], 20, 3)
        assert_order(measured, declared=2, ceiling=1e-3)


def first_passages(process, start, target, ds, n, seed):
    """Arclengths at which paths observed every ds are first below the target."""
    s_end = 16.0
    steps = round(s_end / ds)
    paths = process.sample(
        n, s_end, ds, seed=seed, initial=start, save_at=ds * np.arange(steps + 1)
    )
    below = np.abs(paths.g) <= target
    assert np.all(below.any(axis=0))
    return paths.s[below.argmax(axis=0)]


def test_sampled_paths_take_the_expected_length_and_its_variance():
    # A path that is looked at every ds crosses earlier than seen. In Wald's identity
    # the target is overshot by 0.583 σ√ds on average: the same as a continuous path to
    # a target that much farther. What is left is of order ds.
    start, target, ds, n = 0.5, 0.25, 0.01, 3000
    times = first_passages(QUADRATIC, start, target, ds, n, seed=5)
    sigma = math.sqrt(float(QUADRATIC.variance(target)))
    shifted = QUADRATIC.passage(target - OVERSHOOT * sigma * math.sqrt(ds))
    mean, variance = float(shifted.mean(start)), float(shifted.variance(start))
    assert abs(times.mean() - mean) <= 4 * math.sqrt(variance / n) + ds
    # The unshifted mean is excluded, so that the correction was tested too.
    plain = float(QUADRATIC.passage(target).mean(start))
    assert times.mean() - plain > 4 * math.sqrt(variance / n)
    # Standard error of a variance, from the sample's own fourth moment.
    fourth = np.mean((times - times.mean()) ** 4)
    error = math.sqrt((fourth - variance**2) / n)
    assert abs(times.var() - variance) <= 4 * error + 2 * ds * mean


def test_lengths_scale_like_the_inverse_squared_noise():
    one, other = (
        EnergyProcess(QuadraticPotential(), noise).passage(0.2) for noise in (0.1, 1.0)
    )
    g = np.array([0.0, 0.1, 0.5])
    np.testing.assert_allclose(one.mean(g), 100 * other.mean(g), rtol=1e-13)
    np.testing.assert_allclose(one.variance(g), 1e4 * other.variance(g), rtol=1e-11)
    np.testing.assert_allclose(
        one.occupation(0.0, 0.1, g), 100 * other.occupation(0.0, 0.1, g), rtol=1e-13
    )


def test_the_circle_is_never_reached(process):
    passage = process.passage(process.g_max)
    np.testing.assert_array_equal(
        passage.mean([0.0, 0.5 * process.g_max, process.g_max]),
        [math.inf, math.inf, 0.0],
    )
    np.testing.assert_array_equal(
        passage.variance([0.0, process.g_max]), [math.inf, 0.0]
    )
    # Before that the length grows like a logarithm of the distance.
    close = [
        float(process.passage(process.g_max * (1 - share)).mean(0.0))
        for share in (1e-4, 1e-6, 1e-8)
    ]
    growth = np.diff(close)
    assert growth[1] == pytest.approx(growth[0], rel=1e-2)
    # V' = 2 N(0)/(A² J), J ~ g_max S (g_max - g).
    top = process.g_max
    expected = process._averages.total / (RATE * top * float(process.period(top)))
    assert growth[1] == pytest.approx(expected * math.log(100), rel=1e-4)


def test_reversal_takes_longer_than_any_other_decrease(process):
    g = process.g_max * np.array([0.2, 0.5, 1.0])
    reversal = process.passage(0.0).mean(g)
    assert np.all(np.diff(reversal) > 0)
    assert np.all(reversal > process.passage(0.1 * process.g_max).mean(g))
    assert float(process.passage(0.0).mean(0.0)) == 0.0


@pytest.mark.parametrize("shape", [(), (1,), (2, 3)])
def test_results_have_the_shape_of_the_energies(shape):
    passage = QUADRATIC.passage(0.3)
    g = np.full(shape, 0.2)
    for values in (
        passage.mean(g), passage.variance(g), passage.occupation(0.0, 0.1, g),
        passage.expected(np.ones_like, g),
    ):  # fmt: skip
        assert values.shape == shape
    np.testing.assert_allclose(
        passage.expected(np.ones_like, g), passage.mean(g), rtol=1e-15
    )


@pytest.mark.parametrize("target", [-0.1, 0.7, math.nan])
def test_targets_outside_are_refused(target):
    with pytest.raises(ValueError, match=r"`target` must lie in \[0, 0\.606"):
        QUADRATIC.passage(target)


def test_energies_and_intervals_outside_are_refused():
    passage = QUADRATIC.passage(0.3)
    with pytest.raises(ValueError, match=r"`g` must lie in \[0, 0\.606.*got -0\.1"):
        passage.mean(-0.1)
    with pytest.raises(ValueError, match=r"`interval` must lie in \[0, 0\.606"):
        passage.occupation(0.1, 0.8, 0.2)
    with pytest.raises(ValueError, match=r"`low` must be below `high`, got 0\.2 and 0"):
        passage.occupation(0.2, 0.1, 0.2)
    with pytest.raises(TypeError, match="`target` must be a real number"):
        QUADRATIC.passage("zero")
