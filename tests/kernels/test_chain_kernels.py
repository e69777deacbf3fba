"""Kernels of the string: banded systems, a step of Newton's method, drag."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, RegularGridInterpolator

from fpsolve._kernels import banded, chain, drag
from fpsolve._kernels.chain import Chain, Iterate, Pull, Step
from fpsolve._kernels.chain_series import chain_numbers
from fpsolve._kernels.flow import between_planes, cubic_values
from fpsolve.fibre import AirFlow

N_EDGES = 6


def banded_problem(n, rng):
    """Rows about their diagonals, the same as a dense matrix, a right side."""
    dense = np.triu(np.tril(rng.normal(size=(n, n)), 8), -8)
    # A positive definite symmetric part: no pivots are needed.
    dense += (1 - np.linalg.eigvalsh(dense + dense.T)[0]) / 2 * np.eye(n)
    padded = np.pad(dense, ((0, 0), (8, 8)), constant_values=7.0)
    rows = np.array([padded[i, i : i + 17] for i in range(n)])
    return rows, dense, rng.normal(size=n)


@pytest.mark.parametrize("n", [3, 8, 9, 43])
def test_a_banded_system_is_solved_as_by_lapack(n):
    rows, dense, known = banded_problem(n, np.random.default_rng(4))
    expected = np.linalg.solve(dense, known)
    for function in (banded.solve_banded_rows, banded.solve_banded_rows.py_func):
        found = known.copy()
        function(rows.copy(), found)
        # Of rounding, times the condition.
        allowed = 1e-15 * np.linalg.cond(dense) * np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0, atol=allowed)


def test_a_singular_system_leaves_no_number():
    rows, known = np.zeros((20, 17)), np.ones(20)
    banded.solve_banded_rows(rows, known)
    assert not np.isfinite(known).any()


def newton_problem():
    rng = np.random.default_rng(5)
    nodes = N_EDGES + 1
    bending = rng.normal(size=(nodes, 5))
    fixed = np.zeros((nodes, 3), dtype=bool)
    fixed[0], fixed[-2:], fixed[3, 2] = True, True, True
    masses = rng.uniform(1, 2, nodes)
    numbers = Chain(bending, rng.normal(size=(nodes, 3)), masses, fixed, 0.5)
    r = np.cumsum(rng.normal(size=(nodes, 3)), axis=0)
    moved, v = rng.normal(size=(2, nodes, 3))
    slope = rng.normal(size=(nodes, 3, 3))
    iterate = Iterate(r, v, moved, rng.normal(size=N_EDGES))
    return numbers, Step(0.3, 0.6, 0.2), iterate, Pull(0.1 * v, slope)


def after(function, problem):
    numbers, step, iterate, pull = problem
    mine = Iterate(*(one.copy() for one in iterate))
    rows, known = np.full((4 * N_EDGES + 4, 17), 7.0), np.full(4 * N_EDGES + 4, 7.0)
    said = function(numbers, step, mine, pull, rows, known)
    return said, mine


def test_a_compiled_step_of_newton_equals_its_source():
    compiled = after(chain.newton, newton_problem())
    python = after(chain.newton.py_func, newton_problem())
    assert compiled[0] == pytest.approx(python[0], rel=1e-11)
    for one, other in zip(compiled[1], python[1], strict=True):
        # Rounding of some 20 numbers, times the condition 1e3 of the system.
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11)


def balance(problem, moved, tension):
    """Forces and inertia at the nodes, lengths of the edges, by plain arithmetic."""
    numbers, step, iterate, pull = problem
    r, v = iterate.r, iterate.v
    middle, h = r + step.theta * moved, numbers.edge
    rate = moved / step.dt
    change = (rate - v) / (step.theta * step.dt) + step.damping * rate
    found = numbers.masses[:, None] * change - numbers.constant - pull.force
    # The force of the air is known at `iterate.moved`, and linear from there.
    since = (moved - iterate.moved) / step.dt
    found += np.einsum("nij,nj->ni", pull.slope, since)
    for i in range(N_EDGES + 1):
        for apart in range(-2, 3):
            if 0 <= i + apart <= N_EDGES:
                found[i] += numbers.bending[i, apart + 2] * middle[i + apart]
    pulled = tension[:, None] * np.diff(middle, axis=0) / h
    found[:-1] -= pulled
    found[1:] += pulled
    length = ((np.diff(r + moved, axis=0) ** 2).sum(axis=1) - h**2) / (2 * h)
    laid = numbers.fixed[:-1].all(axis=1) & numbers.fixed[1:].all(axis=1)
    return np.where(numbers.fixed, moved, found), np.where(laid, tension, length)


def test_a_step_of_newton_solves_the_linearised_balance():
    problem = newton_problem()
    old = problem[2]
    _, new = after(chain.newton, problem)
    step = new.moved - old.moved, new.tension - old.tension
    np.testing.assert_array_equal(step[0][problem[0].fixed], 0.0)
    forces, lengths = balance(problem, old.moved, old.tension)
    # Derivatives along the step; quadratic functions, so that differences are exact.
    ahead = balance(problem, old.moved + step[0], old.tension + step[1])
    behind = balance(problem, old.moved - step[0], old.tension - step[1])
    free = ~problem[0].fixed
    slope = 0.5 * (ahead[0] - behind[0])
    size = np.abs(slope).max() + np.abs(forces).max()
    np.testing.assert_allclose(slope[free], -forces[free], rtol=0, atol=1e-11 * size)
    size = np.abs(ahead[1]).max()
    np.testing.assert_allclose(
        0.5 * (ahead[1] - behind[1]), -lengths, rtol=0, atol=1e-11 * size
    )


def test_the_largest_stretch_sees_what_is_no_number():
    r = np.cumsum(np.ones((5, 3)), axis=0)
    moved = np.zeros((5, 3))
    expected = (3 - 0.25) / 1.0
    assert chain.largest_stretch(0.5, r, moved) == pytest.approx(expected)
    assert chain.largest_stretch.py_func(0.5, r, moved) == pytest.approx(expected)
    moved[2, 1] = np.nan
    assert np.isnan(chain.largest_stretch(0.5, r, moved))


@pytest.mark.parametrize("reynolds", [1e-3, 0.05, 2.0, 500.0])
def test_the_slope_of_the_drag_is_its_derivative(reynolds):
    numbers = AirFlow((0.0, 0.0, 0.0)).drag(20e-6)
    tangent = np.array([[1.0, 2.0, 2.0]]) / 3
    across = np.array([[2.0, 1.0, -2.0]]) / 3 * reynolds / numbers.reynolds
    velocity, step = across + 3 * tangent, 1e-4 * np.linalg.norm(across)
    found, slope = np.empty((1, 3)), np.empty((1, 3, 3))
    drag.drag_slopes(numbers, velocity, tangent, found, slope)
    for d in range(3):
        ends = np.empty((2, 1, 3))
        for sign, end in zip((-1, 1), ends, strict=True):
            drag.drag_slopes(
                numbers, velocity + sign * step * np.eye(3)[d], tangent, end,
                np.empty((1, 3, 3)),
            )  # fmt: skip
        difference = (ends[1] - ends[0])[0] / (2 * step)
        # Differences of relative steps of 1e-4, of order 2.
        size = np.abs(slope).max()
        np.testing.assert_allclose(slope[0, :, d], difference, rtol=0, atol=1e-7 * size)


def test_compiled_drag_equals_its_source():
    rng = np.random.default_rng(6)
    numbers = AirFlow((0.0, 0.0, 0.0)).drag(20e-6)
    r = np.cumsum(rng.normal(size=(9, 3)), axis=0)
    # Of Reynolds numbers in all four ranges.
    wind = rng.normal(size=(9, 3)) * np.geomspace(1e-4, 1e3, 9)[:, None]
    rate, lengths = 0.01 * wind[::-1], rng.uniform(1, 2, 9)
    tangent = r / np.linalg.norm(r, axis=1, keepdims=True)
    for name, arguments in (
        ("pull_chain", (numbers, r, rate, wind, lengths)),
        ("drag_slopes", (numbers, wind, tangent)),
        ("shaking", (numbers, wind, tangent, rng.uniform(size=(3, 9)))),
    ):
        results = []
        for function in (getattr(drag, name), getattr(drag, name).py_func):
            out = np.empty((9, 3)), np.empty((9, 3, 3))
            out = out[1:] if name == "shaking" else out
            function(*arguments, *out)
            results.append(out)
        for one, other in zip(*results, strict=True):
            # Rounding; slopes are differences of 1e-6 of it.
            np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-22)
    w = np.geomspace(1e-5, 1e4, 30)
    out = np.empty((2, 2, 30))
    drag.many_resistances(w, *numbers[:3], out[0])
    drag.many_resistances.py_func(w, *numbers[:3], out[1])
    np.testing.assert_allclose(out[0], out[1], rtol=1e-14)


def test_compiled_numbers_of_a_chain_equal_their_source():
    rng = np.random.default_rng(7)
    r = np.cumsum(rng.normal(size=(6, 3)), axis=0)
    v, tension, masses = rng.normal(size=(6, 3)), rng.normal(size=5), np.arange(1.0, 7)
    laid = np.array([False, True, False, False, True, True])
    arguments = (r, v, tension, masses, laid, 0.5)
    found = chain_numbers(*arguments)
    np.testing.assert_allclose(found, chain_numbers.py_func(*arguments), rtol=1e-14)
    lengths = np.linalg.norm(np.diff(r, axis=0), axis=1)
    kinetic = 0.5 * (masses * (v**2).sum(axis=1))[~laid].sum()
    expected = [kinetic, np.abs(tension).max(), np.abs(2 * lengths - 1).max(), 2.0]
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_values_between_planes_are_those_of_scipy():
    rng = np.random.default_rng(8)
    axes = tuple(np.sort([0.0, 1.0, *rng.uniform(size=n)]) for n in (2, 0, 3))
    values = rng.normal(size=(4, 2, 5, 3))
    r = rng.uniform(-0.1, 1.1, (50, 3))
    # Corners of the grid, a place on one of its planes, and none.
    r[:2] = [[one[end] for one in axes] for end in (0, -1)]
    r[2] = np.nan
    r[3:8, 0] = axes[0][1]
    expected = RegularGridInterpolator(axes, values, bounds_error=False)(r)
    assert 10 < np.isfinite(expected[:, 0]).sum() < 40
    for function in (between_planes, between_planes.py_func):
        found = np.empty((50, 3))
        assert function(axes, values, r, found) == 2
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
    # Nothing depends on a coordinate that has one plane.
    flat = (axes[0], np.zeros(1), axes[2])
    function(flat, values[:, :1], r, found)
    flattened = RegularGridInterpolator(
        (axes[0], axes[2]), values[:, 0], bounds_error=False
    )
    np.testing.assert_allclose(found, flattened(r[:, [0, 2]]), rtol=0, atol=1e-14)


def test_cubics_between_equally_spaced_places_are_those_of_scipy():
    rng = np.random.default_rng(9)
    places = np.linspace(-1.0, 2.0, 13)
    spline = CubicSpline(places, rng.normal(size=(13, 2)))
    x = np.concatenate([rng.uniform(-1.2, 2.2, 40), places])
    for function in (cubic_values, cubic_values.py_func):
        found = np.empty((2, x.size))
        function(-1.0, 0.25, spline.c, x, found)
        np.testing.assert_allclose(found, spline(x).T, rtol=0, atol=1e-12)
