"""dm/ds = Q m: mass, positivity, entropy and orders of the implicit steps."""

import re

import numpy as np
import pytest
from orders import assert_order, measure_order
from scipy.linalg import expm
from scipy.sparse import csc_array

from fpsolve.evolution.schedule import make_schedule
from fpsolve.reduced.entropy import Exchange, relative_entropy_of
from fpsolve.reduced.relaxation import relax, relax_extrapolated

EPS = np.finfo(float).eps
METHODS = ("backward_euler", "sdirk2")


def reversible(equilibrium, edges, conductance=1.0):
    """The generator with Q_ij π_j = Q_ji π_i = conductance √(π_i π_j) on the edges."""
    n = len(equilibrium)
    dense = np.zeros((n, n))
    for i, j in edges:
        dense[i, j] = conductance * np.sqrt(equilibrium[i] / equilibrium[j])
        dense[j, i] = conductance * np.sqrt(equilibrium[j] / equilibrium[i])
    dense -= np.diag(dense.sum(axis=0))
    return csc_array(dense)


def chain(n):
    return [(i, i + 1) for i in range(n - 1)]


@pytest.fixture(params=["chain", "graph"])
def problem(request, rng):
    """Generator, stationary law and a start, on a chain and on a random graph."""
    n = 12
    equilibrium = rng.uniform(0.2, 1.0, n)
    equilibrium /= equilibrium.sum()
    edges = chain(n)
    if request.param == "graph":
        edges += [(i, j) for i in range(n) for j in range(i + 2, n) if (i + j) % 3 == 0]
    start = rng.uniform(0.0, 1.0, n) ** 4
    return reversible(equilibrium, edges), equilibrium, start / start.sum()


@pytest.mark.parametrize(("method", "order"), [("backward_euler", 1), ("sdirk2", 2)])
def test_the_declared_order_is_observed_at_every_halving(problem, method, order):
    generator, equilibrium, start = problem
    exact = expm(generator.toarray()) @ start

    def error(n):
        schedule = make_schedule((0.0, 1.0), 1 / n)
        found = relax(generator, start, equilibrium, schedule, method=method)
        return np.abs(found.saved[-1] - exact).sum()

    # Ceilings three times what was measured on the stiffer of the two problems.
    assert_order(measure_order(error, 64, 3), order, {1: 5e-3, 2: 2e-5}[order])


@pytest.mark.parametrize(("method", "order"), [("backward_euler", 2), ("sdirk2", 3)])
def test_extrapolation_raises_the_order_by_one(problem, method, order):
    generator, equilibrium, start = problem
    exact = expm(generator.toarray()) @ start

    def error(n):
        schedule = make_schedule((0.0, 1.0), 1 / n)
        found, estimates = relax_extrapolated(
            generator, start, equilibrium, schedule, method=method
        )
        distance = np.abs(found.saved[-1] - exact).sum()
        # The estimate belongs to the finer run, which is less accurate.
        assert distance < estimates["saved_l1"][-1]
        return distance

    assert_order(measure_order(error, 64, 2), order, {2: 2e-4, 3: 1e-6}[order])


def test_the_estimates_bound_the_errors_of_every_series(problem):
    generator, equilibrium, start = problem
    exact = expm(generator.toarray()) @ start
    number = np.arange(len(start), dtype=float)
    found, estimates = relax_extrapolated(
        generator,
        start,
        equilibrium,
        make_schedule((0.0, 1.0), 1 / 64),
        observables={"number": number},
    )
    expected = {
        "relative_entropy": relative_entropy_of(exact, equilibrium),
        "entropy_dissipation": Exchange(generator)(exact),
        "number": number @ exact,
    }
    series = found.series
    for name, value in expected.items():
        assert 0 < abs(series[name][-1] - value) < estimates[name][-1]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("turn", [0.02, 0.1, 0.5, 1.9])
@pytest.mark.parametrize("begun", ["point", "anywhere"])
def test_the_estimates_bound_the_errors_at_every_record(begun, turn, method, rng):
    # Differences of the two runs go through zero on the way: plain ones are exceeded
    # by factors of up to 300. And a start at one point is rough for every ds.
    equilibrium = rng.uniform(0.2, 1.0, 20)
    equilibrium /= equilibrium.sum()
    generator = reversible(equilibrium, chain(20))
    start = np.zeros(20)
    start[rng.integers(20)] = 1.0
    if begun == "anywhere":
        start = rng.uniform(0.0, 1.0, 20) ** 4
        start /= start.sum()
    gap = -np.sort(np.linalg.eigvals(generator.toarray()).real)[-2]
    n_steps = max(6, round(4.0 / turn))
    ds = turn / gap
    schedule = make_schedule((0.0, n_steps * ds), ds, ds * np.arange(n_steps + 1))
    number = np.arange(20.0)
    found, estimates = relax_extrapolated(
        generator, start, equilibrium, schedule, method=method,
        observables={"number": number, "square": number**2},
    )  # fmt: skip
    step = expm(ds * generator.toarray())
    exact = [start]
    for _ in range(n_steps):
        exact.append(step @ exact[-1])
    true = {
        "relative_entropy": [relative_entropy_of(one, equilibrium) for one in exact],
        "entropy_dissipation": [Exchange(generator)(one) for one in exact],
        "number": [number @ one for one in exact],
        "square": [number**2 @ one for one in exact],
    }
    series = found.series
    for name, values in true.items():
        # At the start the dissipation of a point is infinite; no step was made.
        off = np.abs(series[name] - values)[1:]
        # Products of matrices and sums of twenty masses, relative to the largest.
        rounding = 1e-12 * np.abs(values[1:]).max()
        assert np.all(off <= estimates[name][1:] + rounding), name
    off = np.abs(found.saved - exact).sum(axis=1)
    assert np.all(off <= estimates["saved_l1"] + 1e-12)


def test_a_step_longer_than_two_relaxation_times_is_told(problem):
    generator, equilibrium, start = problem
    gap = -np.sort(np.linalg.eigvals(generator.toarray()).real)[-2]
    schedule = make_schedule((0.0, 20.0 / gap), 5.0 / gap)
    told = r"slowest mode falls by exp\(-(.+)\) in a step.*; take ds below (.+)\.$"
    with pytest.warns(UserWarning, match=told) as found:
        relax_extrapolated(generator, start, equilibrium, schedule)
    turn, longest = map(float, re.search(told, str(found[0].message)).groups())
    # At the last record the entropy is down to the slowest mode, up to percents.
    assert turn == pytest.approx(5.0, rel=0.05)
    assert longest == pytest.approx(2.0 / gap, rel=0.05)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ds", [1e-3, 1.0, 1e3])
def test_the_mass_is_kept_to_rounding(problem, method, ds):
    generator, equilibrium, start = problem
    schedule = make_schedule((0.0, 100 * ds), ds)
    found = relax(generator, 3.0 * start, equilibrium, schedule, method=method)
    # One rounding of a sum; it is put right at every step.
    assert np.abs(found.mass / 3.0 - 1.0).max() < 8 * EPS


@pytest.mark.parametrize("ds", [1e-3, 0.1, 10.0, 1e6])
def test_backward_euler_is_positive_and_loses_entropy_at_every_step(problem, ds):
    generator, equilibrium, _ = problem
    start = np.zeros(len(equilibrium))
    start[3] = 1.0
    schedule = make_schedule((0.0, 30 * ds), ds)
    found = relax(generator, start, equilibrium, schedule)
    assert np.all(found.minimum[1:] > 0)
    # Near equilibrium entropies are sums of squares of rounding errors.
    assert np.all(np.diff(found.relative_entropy) <= 1e-28)
    assert np.all(found.entropy_dissipation >= 0)


def test_sdirk2_undershoots_from_a_rough_start_and_says_so(problem):
    generator, equilibrium, _ = problem
    start = np.zeros(len(equilibrium))
    start[3] = 1.0
    # Steps long against the rate at which the cell empties, about 2.
    schedule = make_schedule((0.0, 5.0), 5.0)
    found = relax(generator, start, equilibrium, schedule, method="sdirk2")
    assert found.minimum.min() < 0
    assert found.minimum[-1] == found.saved[-1].min()


@pytest.mark.parametrize("method", METHODS)
def test_one_huge_step_leads_to_the_equilibrium(problem, method):
    generator, equilibrium, start = problem
    schedule = make_schedule((0.0, 1e9), 1e9)
    found = relax(generator, start, equilibrium, schedule, method=method)
    # L-stability: what is left is of the order 1/(ds gap), with a gap of about 0.1.
    assert np.abs(found.saved[-1] - equilibrium).sum() < 1e-7


def test_the_dissipation_is_minus_the_slope_of_the_entropy(problem):
    generator, equilibrium, start = problem

    def entropy(s):
        return relative_entropy_of(expm(generator.toarray() * s) @ start, equilibrium)

    # Central difference of fourth order with step 1e-3: error about 1e-11.
    h = 1e-3
    slope = 8 * (entropy(0.5 + h) - entropy(0.5 - h))
    slope -= entropy(0.5 + 2 * h) - entropy(0.5 - 2 * h)
    half = expm(generator.toarray() * 0.5) @ start
    assert Exchange(generator)(half) == pytest.approx(-slope / (12 * h), rel=1e-8)


def test_the_dissipation_is_the_sum_of_its_definition(problem):
    generator, equilibrium, start = problem
    expected = -(generator @ start) @ np.log(start / equilibrium)
    # Cancelling terms of size one.
    assert Exchange(generator)(start) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("delta", [1e-3, 1e-6, 1e-10])
def test_small_entropies_keep_their_digits(problem, delta):
    generator, equilibrium, start = problem
    excess = start / equilibrium - 1.0
    mass = equilibrium * (1.0 + delta * excess)
    excess = (mass - equilibrium) / equilibrium
    # H = ½ Σ π x² (1 − x/3 + …): x is of size 3 delta, and rounding of m makes an
    # error of 1e-16/delta in x.
    expected = 0.5 * (equilibrium @ excess**2)
    entropy = relative_entropy_of(mass, equilibrium)
    assert entropy == pytest.approx(expected, rel=10 * delta + 1e-5)
    slope = Exchange(generator)(mass)
    definition = -(generator @ (equilibrium * excess)) @ excess
    assert slope == pytest.approx(definition, rel=10 * delta + 1e-5)


def test_entropy_of_another_mass_has_the_term_of_the_masses(problem):
    _, equilibrium, start = problem
    expected = np.sum(2 * start * np.log(2 * start / equilibrium))
    found = relative_entropy_of(2 * start, equilibrium)
    assert found == pytest.approx(expected, rel=1e-13)


def test_empty_and_negative_cells_have_a_finite_entropy_and_no_mass_none(problem):
    generator, equilibrium, start = problem
    start[0], start[1] = 0.0, -0.01
    for value in (relative_entropy_of(start, equilibrium), Exchange(generator)(start)):
        assert np.isfinite(value)
    assert np.isnan(relative_entropy_of(np.zeros(12), equilibrium))


def test_tails_of_three_hundred_orders_keep_their_relative_accuracy():
    # Neighbours differ by a factor of 1e10, the ends by 1e290.
    equilibrium = 10.0 ** (-10.0 * np.arange(30))
    equilibrium /= equilibrium.sum()
    generator = reversible(equilibrium, chain(30))
    schedule = make_schedule((0.0, 50.0), 0.5)
    found = relax(generator, equilibrium, equilibrium, schedule)
    # Substitutions subtract nothing, so each mass is accurate relative to itself; an
    # error per step of a few eps over a hundred steps.
    assert np.abs(found.saved[-1] / equilibrium - 1.0).max() < 1e-12
    assert found.relative_entropy[-1] < 1e-24
    # From the far end everything comes back down to the equilibrium.
    start = np.zeros(30)
    start[-1] = 1.0
    found = relax(generator, start, equilibrium, schedule)
    assert np.abs(found.saved[-1] / equilibrium - 1.0).max() < 1e-10
    assert np.all(np.diff(found.relative_entropy) < 1e-20)


def test_records_saves_and_reports_are_those_of_the_schedule(problem):
    generator, equilibrium, start = problem
    told = []
    schedule = make_schedule((1.0, 3.0), 0.25, save_at=(1.0, 1.5, 3.0), record_every=3)
    number = np.arange(12.0)
    found = relax(
        generator,
        start,
        equilibrium,
        schedule,
        observables={"number": number},
        report=lambda *what: told.append(what),
    )
    np.testing.assert_array_equal(found.saved_s, [1.0, 1.5, 3.0])
    np.testing.assert_array_equal(found.s, [1.0, 1.5, 1.75, 2.5, 3.0])
    np.testing.assert_array_equal(found.saved[0], start)
    # Sums of a dozen terms.
    assert found.number[1] == pytest.approx(number @ found.saved[1])
    assert told == [(2, 8, 1.5), (3, 8, 1.75), (6, 8, 2.5), (8, 8, 3.0)]


def test_an_extrapolated_run_reports_the_steps_of_both(problem):
    generator, equilibrium, start = problem
    told = []
    relax_extrapolated(
        generator,
        start,
        equilibrium,
        make_schedule((0.0, 1.0), 0.5),
        report=lambda *what: told.append(what),
    )
    assert told == [(1, 6, 0.5), (2, 6, 1.0), (4, 6, 0.5), (6, 6, 1.0)]


def test_arguments_that_do_not_fit_are_refused(problem):
    generator, equilibrium, start = problem
    schedule = make_schedule((0.0, 1.0), 0.5)
    with pytest.raises(ValueError, match=r"`method` must be one of 'backward_euler', "):
        relax(generator, start, equilibrium, schedule, method="euler")
    with pytest.raises(ValueError, match=r"`start` must have the shape \(12,\) of the"):
        relax(generator, start[:-1], equilibrium, schedule)
    with pytest.raises(ValueError, match="`start` must be finite with positive mass"):
        relax(generator, np.nan * start, equilibrium, schedule)
    with pytest.raises(ValueError, match="`equilibrium` must be finite with positive"):
        relax(generator, start, 0 * equilibrium, schedule)
    law = equilibrium.copy()
    law[0] = -law[0]
    with pytest.raises(ValueError, match="`equilibrium` must be non-negative, got a m"):
        relax(generator, start, law, schedule)
    broken = generator.copy()
    broken[0, 0] *= 0.9
    with pytest.raises(ValueError, match="`generator` must keep the mass: its columns"):
        relax(broken, start, equilibrium, schedule)
