"""Paths of (15): inside the interval, repeatable, unbiased laws, sizes of biases."""

import math

import numpy as np
import pytest
from energy_processes import NOISE, PROCESSES, spectrum_of
from scipy.stats import chi2

from fpsolve.reduced.energy.steps import Sphere

QUADRATIC = PROCESSES["quadratic"]
METHODS = ("transition", "sphere")
# Largest deviation in standard errors of a sound sampler: 1e-4 for a single number,
# with fixed seeds.
FOUR = 4.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["quadratic", "steep", "flat"])
def test_paths_never_leave_the_interval(name, method):
    process = PROCESSES[name]
    # Steps of A² ds = 1.7, far beyond what the sphere is accurate for.
    paths = process.sample(
        500, 20.0, 1.0, seed=3, initial=process.g_max, save_at=range(21), method=method
    )
    assert np.all(np.abs(paths.g) <= process.g_max)
    assert np.all(paths.g[0] == process.g_max)
    # They do move, to either sign.
    assert paths.g[-1].min() < 0 < paths.g[-1].max()


@pytest.mark.parametrize("method", METHODS)
def test_equal_arguments_give_equal_paths_bitwise(method):
    def run(seed):
        return QUADRATIC.sample(
            300, 1.0, 0.25, seed=seed, initial="stationary", method=method
        )

    np.testing.assert_array_equal(run(5).g, run(5).g)
    assert np.any(run(5).g != run(6).g)


@pytest.mark.parametrize(
    ("name", "ds"),
    [("quadratic", 1.0), ("quadratic", 0.0625), ("heavy", 0.5), ("flat", 0.25)],
)
def test_averages_of_modes_decay_at_their_rates_whatever_the_step(name, ds):
    # E u_n(G_s) = u_n(g0) e^{-λ_n s}; the cells leave 1e-6.
    process = PROCESSES[name]
    g0, n = 0.4 * process.g_max, 20_000
    g = process.sample(n, 1.0, ds, seed=11, initial=g0).g[-1]
    for family in ("odd", "even"):
        found = spectrum_of(process, family)
        for index in range(1 if family == "even" else 0, 4):
            values = found.eigenfunction(index, g)
            exact = found.eigenfunction(index, g0) * math.exp(-found.eigenvalues[index])
            error = values.std() / math.sqrt(n)
            assert abs(values.mean() - float(exact)) <= FOUR * error


def test_many_small_steps_have_the_law_of_one_long_step():
    n = 10_000
    grid = QUADRATIC.grid(16, signed=True)
    counts = [
        n * QUADRATIC.sample(n, 0.5, ds, seed=seed, initial=0.2).histogram(grid)[0]
        for seed, ds in ((1, 0.5), (2, 0.5 / 64))
    ]
    used = counts[0] + counts[1] > 10
    statistic = np.sum(
        (counts[0] - counts[1])[used] ** 2 / (counts[0] + counts[1])[used]
    )
    # Two samples of equal size: χ² with one degree of freedom less than cells.
    assert statistic <= chi2.isf(1e-4, np.count_nonzero(used) - 1)


@pytest.mark.parametrize("name", ["linear", "heavy", "flat"])
def test_a_stationary_start_stays_stationary(name):
    process, n = PROCESSES[name], 20_000
    grid = process.grid(32, signed=True)
    paths = process.sample(
        n, 2.0, 1.0, seed=7, initial="stationary", save_at=(0.0, 2.0)
    )
    expected = n * grid.equilibrium
    for counts in n * paths.histogram(grid):
        # At 0 the start itself is tested: quantiles by monotone interpolation.
        statistic = np.sum((counts - expected) ** 2 / expected)
        assert statistic <= chi2.isf(1e-4, 31)


def test_the_sampled_law_is_that_of_the_finite_volumes():
    n, grid = 20_000, QUADRATIC.grid(30, signed=True)
    fine = QUADRATIC.grid(480, signed=True)
    run = QUADRATIC.solve(0.3, (0.0, 1.0), 1 / 64, grid=fine, method="sdirk2")
    # Thirty cells whose faces are also faces of 480.
    expected = n * run.mass(1.0).reshape(30, 16).sum(axis=1)
    np.testing.assert_allclose(fine.faces[::16], grid.faces, atol=1e-15)
    counts = n * QUADRATIC.sample(n, 1.0, 1.0, seed=4, initial=0.3).histogram(grid)[0]
    assert np.sum((counts - expected) ** 2 / expected) <= chi2.isf(1e-4, 29)


def test_the_mean_of_the_sphere_decays_without_bias_that_can_be_seen():
    # The height of Brownian motion on a sphere has the drift of (15) exactly.
    n = 40_000
    g = QUADRATIC.sample(n, 1.0, 0.05, seed=2, initial=0.4, method="sphere").g[-1]
    exact = 0.4 * math.exp(-(NOISE**2) / 2)
    assert abs(g.mean() - exact) <= FOUR * g.std() / math.sqrt(n)


def test_the_bias_of_the_sphere_is_at_zero_and_falls_with_the_step():
    # Where σ² vanishes like an inverse logarithm the steps do not know it: too few
    # paths are left near 0. Measured for |G| <= 0.1 g_max, which has 0.145 of the
    # stationary mass: 0.018, 0.011, 0.004 at A² ds = 0.42, 0.11, 0.026.
    n, share = 60_000, 0.1
    inside = float(QUADRATIC.stationary_distribution(share * QUADRATIC.g_max))

    def bias(ds):
        paths = QUADRATIC.sample(
            n, 1.0, ds, seed=1, initial="stationary", method="sphere"
        )
        return np.mean(np.abs(paths.g[-1]) <= share * QUADRATIC.g_max) - inside

    error = math.sqrt(inside / n)
    biases = np.abs([bias(0.25), bias(0.0625), bias(1 / 64)])
    assert biases[0] > 8 * error
    assert np.all(np.diff(biases) < 0)
    assert biases[-1] <= 0.6 * biases[0]


def test_the_sphere_has_noise_to_spare_in_every_well():
    # ρ = 2J/(S (g_max² - g²)) <= 2 is what the step along the parallel rests on.
    largest = {}
    for name, process in PROCESSES.items():
        largest[name] = Sphere(process._averages, NOISE, 0.1).share.max()
        assert largest[name] <= 2.0
    assert largest["flat"] > 1.2


def test_places_inside_a_cell_keep_its_mean():
    # E G of paths in their cells is that of the centres: at s = 0+ nothing else acts.
    n = 40_000
    paths = QUADRATIC.sample(n, 1e-9, 1e-9, seed=8, initial=0.2)
    cell = 2e-3
    # A start between two centres, each spread over its cell of about 1e-3.
    assert abs(paths.g[-1].mean() - 0.2) <= FOUR * cell / math.sqrt(n)


def test_starts_are_one_energy_many_or_the_stationary_law():
    many = np.linspace(-0.6, 0.6, 7)
    paths = QUADRATIC.sample(7, 1.0, 0.5, seed=0, initial=many, save_at=(0.0, 0.5, 1.0))
    np.testing.assert_array_equal(paths.g[0], many)
    np.testing.assert_array_equal(paths.s, [0.0, 0.5, 1.0])
    assert paths.g.shape == (3, 7)
    assert repr(paths) == "EnergyPaths(7 paths, 3 saved, ds = 0.5)"
    assert (paths.seed, paths.method, paths.ds) == (0, "transition", 0.5)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"method": "euler"}, ValueError, "must be one of 'transition', 'sphere', got"),
        ({"n_paths": 0}, ValueError, "`n_paths` must be at least 1, got 0"),
        ({"seed": -1}, ValueError, "`seed` must be at least 0, got -1"),
        ({"seed": 1.5}, TypeError, "`seed` must be an integer"),
        ({"ds": 0.3}, ValueError, "`ds` must divide the span"),
        ({"initial": "uniform"}, ValueError, "energies or 'stationary', got 'uniform'"),
        ({"initial": 0.7}, ValueError, r"`initial` must lie in \[-0\.606"),
        ({"initial": math.nan}, ValueError, r"`initial` must lie in .*got nan"),
        (
            {"initial": [0.1, 0.2]},
            ValueError,
            r"one energy or 5 of them, got shape \(2",
        ),
        ({"save_at": [0.7]}, ValueError, "`save_at` must hold multiples of ds"),
    ],
)
def test_wrong_arguments_are_named(arguments, error, message):
    given = {"n_paths": 5, "s_end": 1.0, "ds": 0.5, "seed": 1, "initial": 0.2}
    with pytest.raises(error, match=message):
        QUADRATIC.sample(**(given | arguments))
