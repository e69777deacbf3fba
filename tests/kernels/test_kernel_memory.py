"""Kernels read no memory that nothing has written, whatever it happens to hold."""

import numpy as np
import pytest
from kernel_cases import Arguments
from known_kernels import KERNELS, PARALLEL, called
from numba import njit, prange

# Memory that is asked for next comes from what was last given back, by size: every size
# that kernels ask for on the grids below, several times.
SIZES = np.concatenate([np.repeat(np.arange(1, 140), 8), [200, 500, 1000, 4000] * 4])
ATTEMPTS = 5


@njit(parallel=True)
def spoil_memory(sizes, out):
    """Fill memory with NaN and give it back, on every thread."""
    for thread in prange(out.size):
        held = [np.full(size, np.nan) for size in sizes]
        out[thread] = len(held)


# Whole registers, and two angles more; schemes take even numbers of angles only.
@pytest.mark.parametrize("n_alpha", [8, 10, 14, 16])
@pytest.mark.parametrize("name", PARALLEL)
def test_results_do_not_depend_on_what_was_in_memory_before(name, n_alpha):
    for arguments in Arguments((6, 7, n_alpha)).cases()[name]:
        first = called(KERNELS[name], arguments)
        for _ in range(ATTEMPTS):
            spoil_memory(SIZES, np.empty(8))
            again = called(KERNELS[name], arguments)
            for one, other in zip(first, again, strict=True):
                assert np.array_equal(one, other)
