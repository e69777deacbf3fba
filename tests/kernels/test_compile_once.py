"""Of a parallel kernel, machine code is made once; what is linked into it has none."""

import ctypes

import numba
import numpy as np
import pytest
from numba import prange
from numba.core.codegen import JITCodeLibrary

from fpsolve._kernels import compile_once, compiling
from fpsolve._kernels.compile_once import PartOfKernel

SCALES = np.array([1.0, 10.0, 100.0])


def inverses(x, out):
    """out[i] = Σ_k SCALES[k] // x[i]."""
    for i in prange(x.size):
        row = np.empty(SCALES.size)
        for k in range(SCALES.size):
            row[k] = SCALES[k] // x[i]
        out[i] = row[0] + row[1] + row[2]


@pytest.fixture
def finished(monkeypatch):
    """Names of the libraries that machine code was made of."""
    names, finish = [], JITCodeLibrary._finalize_specific

    def note(library):
        names.append(library.name)
        finish(library)

    monkeypatch.setattr(JITCodeLibrary, "_finalize_specific", note)
    return names


def test_a_parallel_kernel_is_made_machine_code_without_its_parts(finished):
    kernel = compiling.njit(parallel=True)(inverses)
    x, out, expected = np.array([3.0, 7.0, 11.0]), np.zeros(3), np.zeros(3)
    kernel(x, out)
    inverses(x, expected)
    # Whole numbers.
    np.testing.assert_array_equal(out, expected)
    assert [name for name in finished if "inverses" in name or "numba" in name] == [
        "inverses"
    ]


def test_what_a_kernel_has_left_as_a_part_serves_kernels_of_others(finished):
    compiling.njit(parallel=True)(inverses)(np.ones(3), np.zeros(3))
    assert "create_library" not in vars(numba.njit(inverses).targetctx.codegen())
    finished.clear()
    out = np.zeros(3)
    numba.njit(inverses)(np.array([3.0, 7.0, 11.0]), out)
    np.testing.assert_array_equal(out, [36.0, 15.0, 9.0])
    assert finished[-1] == "inverses"


def test_a_kernel_made_inside_a_function_is_no_part():
    @compiling.njit()
    def twice(x):
        return 2 * x

    @compiling.njit()
    def four_times(x):
        return twice(twice(x))

    assert four_times(2.0) == 8.0
    assert twice(3.0) == 6.0


def test_where_numba_is_another_nothing_is_replaced(monkeypatch):
    monkeypatch.setattr(compile_once, "REPLACED", ("of_another_version",))
    kernel = numba.njit(inverses)
    before = kernel.compile
    compile_once.compile_once(kernel)
    assert kernel.compile == before


def test_a_part_is_found_by_its_name():
    codegen = numba.njit(inverses).targetctx.codegen()
    with compile_once.parts_unfinished(codegen):
        part = codegen.create_library("__numba_parfor_gufunc_0x7f")
        assert type(part) is PartOfKernel
        assert type(codegen.create_library("inverses")) is JITCodeLibrary
    assert type(codegen.create_library("__numba_parfor_gufunc")) is JITCodeLibrary


def test_what_numba_keeps_of_a_part_is_found_from_the_kernel():
    target = numba.njit(inverses).targetctx
    codegen, kept = target.codegen(), numba.core.environment.lookup_environment
    compiling.njit(parallel=True)(inverses)(np.ones(3), np.zeros(3))
    name = next(
        name for name in codegen._engine._defined_symbols
        if name.startswith("_ZN08NumbaEnv") and "__numba_parfor_gufunc" in name
        and kept(name) is not None
    )  # fmt: skip
    address = codegen._engine.get_global_value_address(name)
    assert ctypes.c_void_p.from_address(address).value == id(kept(name))
