"""How much memory a run takes, and what it is refused for."""

import tracemalloc

import numpy as np
import pytest

from fpsolve import initial
from fpsolve._support.memory import required_memory
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.errors import MemoryLimitError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (20, 20, 16))
P0 = initial.gaussian(GRID, (1.5, 0.0), 0.5, np.pi / 2, 2.0)


def test_a_run_that_does_not_fit_is_refused_before_it_starts():
    calls = []
    with pytest.raises(MemoryLimitError, match=r"the run needs .* MiB but 1 MiB are available; save fewer") as caught:  # fmt: skip  # noqa: E501
        solve(
            drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125, memory_limit=2**20,
            progress=lambda *call: calls.append(call),
        )  # fmt: skip
    assert calls == []
    assert caught.value.required > caught.value.available == 2**20


def test_the_estimate_counts_saved_densities_twice_with_extrapolation():
    one = required_memory(10**6, 6.0, 3)
    assert required_memory(10**6, 6.0, 4) - one == 10**6
    assert required_memory(10**6, 6.0, 3, n_passes=2) - one == 3 * 10**6


MEMORY = [
    (drift_kick, {}, 6),
    (drift_kick, {"positive": True, "balanced": True}, 6),
    (semi_lagrangian, {}, 10),
    (semi_lagrangian, {"form": "p", "limited": True, "interpolation_order": 6}, 10),
]


@pytest.mark.parametrize(("scheme", "options", "most"), MEMORY)
def test_a_run_stays_within_its_densities(scheme, options, most):
    # numpy reports its arrays to tracemalloc; those of the kernels (a few rows each)
    # are not seen. The scheme and its tables are built inside, p0 outside.
    grid = PhaseSpaceGrid(6.0, (48, 48, 48))
    p0 = initial.gaussian(grid, (1.5, 0.0), 0.5, np.pi / 2, 2.0)
    solve(scheme(MODEL, GRID, **options), P0, (0.0, 0.25), 0.125)
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        built = scheme(MODEL, grid, **options)
        solve(built, p0, (0.0, 0.5), 0.125, save_at=())
        peak = tracemalloc.get_traced_memory()[1] - before
    finally:
        tracemalloc.stop()
    # Planes of the grid, weights, and what Python itself allocates.
    assert peak / grid.nbytes <= most + 0.1
    # The estimate that refuses runs is an honest upper bound.
    assert peak <= required_memory(grid.nbytes, built.n_arrays, 0)
