"""(16) by finite volumes: mass, positivity, equilibrium, entropy, exact solutions."""

import math

import numpy as np
import pytest
from energy_processes import NOISE, PROCESSES, exact_masses, tilted
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from orders import assert_order, measure_order
from scipy.linalg import expm

from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess

EPS = np.finfo(float).eps
QUADRATIC = PROCESSES["quadratic"]
GRIDS = {"|G|": QUADRATIC.grid(24), "signed": QUADRATIC.grid(24, signed=True)}
RATE = NOISE**2 / 2


@pytest.fixture(params=PROCESSES, ids=str)
def process(request):
    return PROCESSES[request.param]


@pytest.fixture(params=GRIDS.values(), ids=GRIDS.keys())
def grid(request):
    return request.param


# --- what is kept -------------------------------------------------------------------


def test_the_generator_keeps_mass_has_positive_rates_and_balances_in_detail(process):
    for signed in (False, True):
        grid = process.grid(40, signed)
        matrix = grid.generator(NOISE).toarray()
        rates = np.abs(np.diag(matrix))
        assert np.all(np.abs(matrix.sum(axis=0)) <= 4 * EPS * rates)
        assert (matrix - np.diag(np.diag(matrix))).min() >= 0
        flows = matrix * grid.equilibrium
        np.testing.assert_allclose(flows, flows.T, rtol=8 * EPS, atol=0)


def test_the_mean_of_signed_energy_is_an_eigenvector_of_the_generator(process):
    grid = process.grid(40, signed=True)
    matrix = grid.generator(NOISE).toarray()
    # E G decays at A²/2 on every grid; rounding is that of the largest rates.
    left = grid.centres @ matrix
    scale = 8 * EPS * np.abs(np.diag(matrix)) * process.g_max
    assert np.all(np.abs(left + RATE * grid.centres) <= scale)


def test_cell_masses_and_centres_of_the_equilibrium_are_exact(process):
    for signed in (False, True):
        grid = process.grid(30, signed)
        assert grid.equilibrium.sum() == pytest.approx(1.0, abs=8 * EPS)
        assert np.all(grid.equilibrium > 0)
        assert np.all(grid.faces[:-1] < grid.centres)
        assert np.all(grid.centres < grid.faces[1:])
        below = np.concatenate([[0.0], np.cumsum(grid.equilibrium)])
        exact = process.stationary_distribution(grid.faces, signed)
        np.testing.assert_allclose(below, exact, atol=64 * EPS)


@pytest.mark.parametrize("method", ["backward_euler", "sdirk2"])
def test_the_stationary_law_stays_to_rounding(grid, method):
    run = QUADRATIC.solve(grid.equilibrium, (0.0, 100.0), 0.5, grid=grid, method=method)
    # Rates up to 2e4 amplify rounding by ds times them; the steps are stable.
    np.testing.assert_allclose(run.mass(100.0), grid.equilibrium, rtol=1e-10)
    assert np.all(run.relative_entropy <= 1e-18)
    assert np.all(np.abs(run.series["mass"] - 1.0) <= 4 * EPS)


@settings(max_examples=25, deadline=None)
@given(
    start=arrays(float, 24, elements=st.floats(0, 1)).filter(lambda m: m.sum() > 1e-3),
    ds=st.sampled_from([1e-3, 0.1, 10.0, 1e6]),
    signed=st.booleans(),
)
def test_from_any_start_with_any_step_masses_stay_positive_and_entropy_falls(
    start, ds, signed
):
    grid = GRIDS["signed" if signed else "|G|"]
    run = QUADRATIC.solve(start, (0.0, 8 * ds), ds, grid=grid)
    # A theorem for backward Euler: the step is a Markov matrix with the stationary law
    # of the generator. Rounding of the entropy is relative to itself, but a law that
    # has arrived only has rounding left.
    assert np.all(run.series["minimum"][1:] > 0)
    assert np.all(np.abs(run.series["mass"] - 1.0) <= 4 * EPS)
    assert np.all(np.diff(run.relative_entropy) <= 1e-15)
    assert np.all(run.series["entropy_dissipation"] >= 0)


def test_a_rough_start_makes_the_second_order_method_negative():
    # What "positivity not promised" means: all mass in one cell, a long step.
    grid = QUADRATIC.grid(200)
    run = QUADRATIC.solve(0.3, (0.0, 1.0), 0.5, grid=grid, method="sdirk2")
    assert run.series["minimum"].min() < 0
    safe = QUADRATIC.solve(0.3, (0.0, 1.0), 0.5, grid=grid)
    assert safe.series["minimum"][1:].min() > 0


def test_the_mean_of_signed_energy_decays_as_the_method_says(process):
    grid = process.grid(30, signed=True)
    start, ds, n = 0.4 * process.g_max, 0.25, 8
    run = process.solve(start, (0.0, n * ds), ds, grid=grid, save_at=(0.0, n * ds))
    assert run.mean(0.0) == pytest.approx(start, rel=1e-14)
    # Exact in the cells: backward Euler divides by 1 + ds A²/2 at every step.
    factor = (1 + ds * RATE) ** -n
    assert run.mean(n * ds) == pytest.approx(start * factor, rel=1e-12)


def test_a_symmetric_start_stays_symmetric():
    grid = GRIDS["signed"]
    mirrored = lambda g: 1.0 + np.abs(g) + np.cos(9 * g)  # noqa: E731
    run = QUADRATIC.solve(mirrored, (0.0, 2.0), 0.1, grid=grid)
    # The factorisation goes through the cells in one direction.
    np.testing.assert_allclose(run.mass(2.0), run.mass(2.0)[::-1], rtol=1e-12)


def test_the_sign_forgotten_gives_the_process_of_the_absolute_value():
    signed, unsigned = QUADRATIC.grid(48, signed=True), QUADRATIC.grid(24)
    one = QUADRATIC.solve(0.2, (0.0, 1.0), 0.05, grid=signed).mass(1.0)
    other = QUADRATIC.solve(0.2, (0.0, 1.0), 0.05, grid=unsigned).mass(1.0)
    # The same faces, centres and fluxes, folded at 0.
    np.testing.assert_allclose(one[24:] + one[23::-1], other, rtol=1e-12)


def test_entropy_falls_at_its_own_dissipation():
    grid = GRIDS["signed"]
    run = QUADRATIC.solve(tilted(), (0.0, 0.5), 0.5 / 512, grid=grid, method="sdirk2")
    slope = np.gradient(run.relative_entropy, run.s, edge_order=2)
    # Central differences of order 2 in ds = 1e-3.
    np.testing.assert_allclose(-slope, run.series["entropy_dissipation"], rtol=1e-4)


# --- exact solutions and orders -----------------------------------------------------


def test_the_tilted_law_is_an_exact_solution_on_every_grid():
    # Its masses lie in the span of two eigenvectors, equilibrium and equilibrium times
    # centres: cells make no error at all, and what is left is that of the step.
    for n in (8, 40):
        grid = QUADRATIC.grid(n, signed=True)
        start = exact_masses(grid, 0.0)
        run = QUADRATIC.solve(
            start, (0.0, 1.0), 1 / 64, grid=grid, method="sdirk2", extrapolate=True
        )
        difference = np.abs(run.mass(1.0) - exact_masses(grid, 1.0)).sum()
        assert difference < 2e-7
        assert difference <= 2 * run.errors["saved_l1"][-1]


@pytest.mark.parametrize(
    ("method", "order", "ceiling"), [("backward_euler", 1, 6e-3), ("sdirk2", 2, 3e-5)]
)
def test_orders_in_the_step(method, order, ceiling):
    grid = QUADRATIC.grid(16, signed=True)

    def error(n_steps):
        start = exact_masses(grid, 0.0)
        run = QUADRATIC.solve(start, (0.0, 1.0), 1 / n_steps, grid=grid, method=method)
        return np.abs(run.mass(1.0) - exact_masses(grid, 1.0)).sum()

    assert_order(measure_order(error, 8, 3), declared=order, ceiling=ceiling)


def test_order_two_in_the_cells():
    # A start with several modes, against the expansion in eigenfunctions: e^{sQ} on
    # cells has no error of the step.
    spectrum = QUADRATIC.spectrum(3)
    decay = np.exp(-spectrum.eigenvalues)

    def density(g, factors):
        modes = [spectrum.eigenfunction(index, g) for index in range(3)]
        return QUADRATIC.stationary_density(g) * (
            modes[0] + factors[1] * 0.3 * modes[1] + factors[2] * 0.1 * modes[2]
        )

    def error(n):
        grid = QUADRATIC.grid(n)
        save = QUADRATIC.solve(
            lambda g: density(g, np.ones(3)), (0.0, 1.0), 1.0, grid=grid, save_at=(0.0,)
        )
        ends = expm(grid.generator(NOISE).toarray()) @ save.mass(0.0)
        exact = np.array([
            density(a + (b - a) * NODES, decay) @ WEIGHTS * (b - a)
            for a, b in zip(grid.faces[:-1], grid.faces[1:], strict=True)
        ])  # fmt: skip
        return np.abs(ends - exact).sum()

    assert_order(measure_order(error, 12, 3), declared=2, ceiling=2e-4)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2


def test_the_law_forgets_at_the_rate_of_its_family():
    # |G| at the first even rate, signed G at A²/2; H decays at twice the rate.
    for signed, rate in ((False, QUADRATIC.eigenvalues(2)[1]), (True, RATE)):
        grid = QUADRATIC.grid(100, signed)
        run = QUADRATIC.solve(0.5, (0.0, 6.0), 0.01, grid=grid, method="sdirk2")
        late = run.relative_entropy[[500, 600]]
        # Order 2 in cells and step; the next mode is e^{-2 · 3 · 5} down.
        assert -math.log(late[1] / late[0]) == pytest.approx(2 * rate, rel=2e-3)


@pytest.mark.parametrize("method", ["backward_euler", "sdirk2"])
@pytest.mark.parametrize("ds", [0.05, 0.25])
def test_the_fitted_rate_is_twice_the_gap_of_the_grid_within_its_error(ds, method):
    # Rates relative to A² = RATE·2, so that a step is ds of a unit.
    grid = GRIDS["|G|"]
    rates = np.linalg.eigvals(grid.generator(NOISE).toarray()).real
    twice_the_gap = -2.0 * np.sort(rates)[-2]
    unit = 1.0 / (2.0 * RATE)
    run = QUADRATIC.solve(0.3, (0.0, 6 * unit), ds * unit, grid=grid, method=method)
    found = run.entropy_rate()
    assert abs(found.rate - twice_the_gap) < found.standard_error < 0.5 * twice_the_gap


def test_noise_only_scales_the_arclength():
    slow, fast = (EnergyProcess(QuadraticPotential(), noise) for noise in (0.1, 1.0))
    runs = [
        process.solve(0.3, (0.0, end), end / 20, grid=process.grid(20)).mass(end)
        for process, end in ((slow, 200.0), (fast, 2.0))
    ]
    np.testing.assert_allclose(runs[0], runs[1], rtol=1e-12)
