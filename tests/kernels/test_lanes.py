"""Four values in a register: compiled and as numpy arrays, and their logarithm."""

import numpy as np
import pytest
from numba import njit

from fpsolve._kernels import functionals, lanes
from fpsolve._kernels.lanes import (
    below,
    larger,
    mantissa_and_exponent,
    parts,
    put,
    root,
    smaller,
    spread,
    take,
    transposed,
)


def arithmetic(rows, out):
    a, b = take(rows, (0, 1)), take(rows, (1, 2))
    put(out, (0, 0), a + b)
    put(out, (1, 0), a - b)
    put(out, (2, 0), a * b)
    put(out, (3, 0), a / b)
    put(out, (4, 0), spread(rows[0, 0]))


def comparisons(rows, out):
    a, b = take(rows, (0, 0)), take(rows, (1, 0))
    put(out, (0, 0), smaller(a, b))
    put(out, (1, 0), larger(a, b))


def whole_parts(rows, out):
    put(out, (0, 0), below(take(rows, (0, 0))))
    put(out, (1, 0), below(-take(rows, (1, 0))))


def roots_and_parts(rows, out):
    put(out, (0, 0), root(take(rows, (0, 0))))
    out[1, 0], out[1, 1], out[1, 2], out[1, 3] = parts(take(rows, (1, 0)))


def columns(rows, out):
    a, b, c, d = transposed(
        take(rows, (0, 0)), take(rows, (1, 0)), take(rows, (2, 0)), take(rows, (3, 0))
    )
    put(out, (0, 0), a)
    put(out, (1, 0), b)
    put(out, (2, 0), c)
    put(out, (3, 0), d)


def splitting(rows, out):
    m, e = mantissa_and_exponent(take(rows, (0, 0)))
    put(out, (0, 0), m)
    put(out, (1, 0), e)


@pytest.mark.parametrize(
    "function",
    [arithmetic, comparisons, whole_parts, roots_and_parts, columns, splitting],
)
def test_lanes_do_in_registers_what_numpy_does_with_four_values(function, rng):
    rows = rng.uniform(0.1, 9.0, (4, 6))
    compiled, python = np.zeros((2, 5, 4))
    njit(function)(rows, compiled)
    function(rows, python)
    # One correctly rounded operation each.
    np.testing.assert_array_equal(compiled, python)


def test_comparisons_keep_nan_of_the_first(rng):
    rows = rng.uniform(size=(4, 6))
    rows[0, 2] = np.nan
    out = np.zeros((5, 4))
    njit(comparisons)(rows, out)
    assert np.isnan(out[:2, 2]).all()
    assert np.isfinite(out[:2, [0, 1, 3]]).all()


@njit
def logarithms(x, out):
    for k in range(0, x.size, lanes.LANES):
        put(out, (k,), functionals.logarithm(take(x, (k,))))


@njit
def sums(x, out):
    for k in range(0, x.size, lanes.LANES):
        out[k] = functionals.summed(take(x, (k,)))


def test_sums_of_four_go_in_pairs(rng):
    x, out = rng.normal(size=16), np.zeros(16)
    sums(x, out)
    pairs = x.reshape(4, 4)
    expected = (pairs[:, 0] + pairs[:, 1]) + (pairs[:, 2] + pairs[:, 3])
    np.testing.assert_array_equal(out[::4], expected)
    assert functionals.summed(x[:4]) == out[0]


@pytest.mark.parametrize(
    "x",
    [
        np.exp(np.linspace(-690.0, 700.0, 4000)),
        1.0 + np.linspace(-1e-3, 1e-3, 4000),
        1.0 + np.linspace(-1e-12, 1e-12, 4000),
        np.sqrt(0.5) * (1.0 + np.arange(-4, 4) * np.finfo(float).eps),
        np.ldexp(1.0, np.arange(-996, 1024)),
    ],
    ids=["all magnitudes", "near one", "next to one", "the seam", "powers of two"],
)
def test_logarithms_are_right_to_the_last_place_but_one(x):
    out = np.zeros_like(x)
    logarithms(x, out)
    exact = np.log(x)
    # fdlibm's bound is one unit in the last place; numpy's own may be off by another.
    assert (np.abs(out - exact) <= 2.0 * np.spacing(np.abs(exact))).all()
    python = [functionals.logarithm(x[k : k + 4]) for k in range(0, 8, 4)]
    np.testing.assert_allclose(np.ravel(python), exact[:8], rtol=4e-16)
