"""Compiled kernels: their source, their threads, what they let through."""

import ast
import inspect
from pathlib import Path

import numpy as np
import pytest
from kernel_cases import Arguments, at_rest
from known_kernels import KERNELS, MODULES, PARALLEL, called

from fpsolve import initial
from fpsolve._kernels import (
    characteristics,
    compiling,
    functionals,
    moebius,
    rotation,
)
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid

SMALL, LARGE = (6, 7, 8), (20, 21, 16)


CASES = Arguments(SMALL).cases()


def test_every_kernel_has_a_case():
    assert CASES.keys() == KERNELS.keys()
    assert set(PARALLEL) == {
        "interpolate_at_feet", "row_functionals", "row_sums", "scale_rows", "rotate",
        "rotation_matrices",
        "translate", "translate_positive", "solve_rows", "kick", "mix",
        "curvature_sums", "add_weighted", "shift_fourier",
    }  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_compiled_kernels_equal_their_source(name):
    # Every kernel calls compiled helpers, each of which is compared on its own.
    for arguments in CASES[name]:
        compiled = called(KERNELS[name], arguments)
        python = called(KERNELS[name].py_func, arguments)
        for one, other in zip(compiled, python, strict=True):
            scale = np.abs(other).max(initial=0.0)
            # Fused multiply-add and another order of additions: a few eps for each of
            # at most 50 terms, relative to the largest.
            np.testing.assert_allclose(one, other, rtol=0, atol=2e-14 * scale)


@pytest.mark.parametrize("name", PARALLEL)
def test_parallel_kernels_do_not_depend_on_the_number_of_threads(name, on_threads):
    for arguments in Arguments(LARGE).cases()[name]:
        one = on_threads(1, lambda args=arguments: called(KERNELS[name], args))
        two = on_threads(2, lambda args=arguments: called(KERNELS[name], args))
        for a, b in zip(one, two, strict=True):
            assert np.array_equal(a, b)


@pytest.mark.parametrize(
    ("scheme", "options"),
    [
        (drift_kick, {}),
        (drift_kick, {"positive": True, "balanced": True}),
        (drift_kick, {"translation": "fourier"}),
        (semi_lagrangian, {}),
        (semi_lagrangian, {"form": "p", "limited": True}),
    ],
)
def test_a_whole_run_does_not_depend_on_the_number_of_threads(
    scheme, options, model, on_threads
):
    grid = PhaseSpaceGrid(6.0, (20, 22, 16))
    p0 = initial.gaussian(grid, (1.0, 0.0), 0.5, 0.3, 2.0)

    def run():
        return solve(scheme(model, grid, **options), p0, (0.0, 1.0), 0.1)

    one, two = on_threads(1, run), on_threads(2, run)
    assert np.array_equal(one.final, two.final)
    for name, values in one.series.items():
        assert np.array_equal(values, two.series[name]), name


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", PARALLEL)
def test_what_is_not_finite_passes_through(name, value):
    # A kernel compiled with fastmath=True may assume that there is no NaN, and the
    # check of a run would then be blind. Every cell is spoiled, as feet and taps do
    # not reach all of them.
    for arguments in CASES[name]:
        spoiled = np.full_like(arguments[0], value)
        result = called(KERNELS[name], (spoiled, *arguments[1:]))[-1]
        assert not np.isfinite(result).all()


def test_one_nan_cell_is_seen_after_one_step_of_every_scheme(model, uneven_grid):
    p = np.full(uneven_grid.shape, 1.0)
    p[3, 4, 5] = np.nan
    for scheme in (
        drift_kick(model, uneven_grid),
        drift_kick(model, uneven_grid, positive=True),
        semi_lagrangian(model, uneven_grid),
        semi_lagrangian(model, uneven_grid, limited=True, interpolation_order=6),
    ):
        state = scheme.start(np.ones(uneven_grid.shape))
        state.values[...] = p
        scheme.advance(state, 0.0, 0.1)
        assert np.isnan(scheme.density(state)).any()


@pytest.mark.parametrize("place", [np.nan, np.inf, -np.inf, 1e17, -1e30])
@pytest.mark.parametrize("n_points", [4, 6])
def test_feet_beyond_all_numbers_read_no_memory_outside_the_array(n_points, place):
    # A force of 1e17 (r³⁰ at r = 6) turns the angle so far that its remainder is lost.
    p = np.ones((6, 7, 18))
    out = np.zeros_like(p)
    for axis in range(3):
        feet = np.zeros((3, *p.shape))
        feet[axis] = place
        ones = np.ones((1, 1, 1))
        characteristics.interpolate_at_feet(
            p, feet, ones, at_rest(p.shape), n_points, True, ones[:0], out
        )
        # The interpolant of one is one, and NaN shows as NaN.
        right = np.isclose(out, 1.0, rtol=0, atol=1e-14) | np.isnan(out)
        assert right.all()


def decorators():
    for module in MODULES:
        tree = ast.parse(Path(inspect.getfile(module)).read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef):
                for decorator in node.decorator_list:
                    # What acts on registers is compiled into its callers.
                    if ast.unparse(decorator).startswith("njit"):
                        yield node.name, decorator


def test_no_kernel_relaxes_more_than_contraction():
    seen = set()
    for name, decorator in decorators():
        options = {option.arg: option.value for option in decorator.keywords}
        seen.add(name)
        if "fastmath" in options:
            assert ast.literal_eval(options["fastmath"]) == {"contract"}, name
        assert ast.literal_eval(options["cache"]) is True
        assert ast.literal_eval(options["error_model"]) == "numpy"
    assert seen == KERNELS.keys()


def test_a_helper_rounds_alike_compiled_for_a_caller_and_on_its_own():
    # Where it does not say how, numba takes what its first caller allows, and keeps it.
    @compiling.njit()
    def rounding(a, product):
        return a * a - product

    @compiling.njit(fastmath={"contract"})
    def caller(a, product):
        return rounding(a, product)

    # Zero as the product is rounded before the difference; 9e-18 if they are fused.
    assert caller(1.1, 1.1 * 1.1) == rounding(1.1, 1.1 * 1.1) == 0.0


def test_no_kernel_leaves_its_arithmetic_to_its_callers():
    for name, kernel in KERNELS.items():
        options = getattr(kernel, "compiled", kernel).targetoptions
        assert options.keys() >= compiling.INHERITED.keys(), name
    # What acts on registers numba compiles for its callers, the first of them.
    tree = ast.parse(Path(inspect.getfile(functionals)).read_text())
    for node in ast.walk(tree):
        for decorator in getattr(node, "decorator_list", []):
            if ast.unparse(decorator).startswith("register_jitable"):
                said = {option.arg for option in getattr(decorator, "keywords", [])}
                assert said == compiling.INHERITED.keys(), node.name


@pytest.mark.parametrize(
    ("weights", "nodes"),
    [
        (characteristics.cubic_weights, np.arange(-1, 3)),
        (characteristics.quintic_weights, np.arange(-2, 4)),
    ],
)
def test_weights_reproduce_polynomials_of_their_degree(weights, nodes):
    for fraction in (0.0, 0.1, 1 / 3, 0.5, 0.9, 1 - 1e-15):
        # Four at once, and alike.
        w = np.array(weights(fraction))[:, 0]
        assert w.sum() == pytest.approx(1.0, abs=4e-16)
        for degree in range(nodes.size):
            # Terms of up to 3^degree with weights up to 1: a few eps of these.
            assert w @ nodes.astype(float) ** degree == pytest.approx(
                fraction**degree, abs=1e-15 * 3.0**degree
            )


def test_moebius_powers_are_the_taylor_coefficients():
    # By the discrete Fourier transform on the unit circle: aliases are a^64 = 3e-26.
    a, half = 0.4, 6
    z = np.exp(2j * np.pi * np.arange(64) / 64)
    table = np.empty((half, half))
    moebius.moebius_powers(a, half, table)
    for m in range(half):
        expected = np.fft.fft(((z - a) / (1 - a * z)) ** m)[:half] / 64
        np.testing.assert_allclose(table[m], expected.real, rtol=0, atol=1e-14)


def test_the_row_limiter_keeps_the_sum_and_removes_the_negative():
    row = np.array([0.5, -0.2, 1.0, 0.3, -0.1, 0.7])
    limited = row.copy()
    rotation.limit_row(limited)
    # Rounding of six numbers of size one.
    assert limited.sum() == pytest.approx(row.sum(), abs=1e-15)
    assert 0.0 <= limited.min() <= 1e-16
    mean = row.mean()
    ratio = (limited - mean) / (row - mean)
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-14)


def test_subnormal_tails_are_flushed_and_nothing_else():
    p = np.array([1e-310, -1e-310, 1e-200, np.nan, 1.0]).reshape(1, 1, 5)
    functionals.scale_rows(p, np.ones((1, 1)), p)
    np.testing.assert_array_equal(p.ravel(), [0.0, 0.0, 1e-200, np.nan, 1.0])
