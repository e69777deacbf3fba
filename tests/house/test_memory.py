"""How much memory a run takes, and what it is refused for."""

import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest

from fpsolve import initial
from fpsolve._support import memory
from fpsolve._support.memory import check_memory, required_memory
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


@pytest.fixture
def readings(monkeypatch):
    """What the system says, how often it was asked, and the clock."""
    told = SimpleNamespace(available=2**30, n_asked=0, now=0.0)

    def asked():
        told.n_asked += 1
        return SimpleNamespace(available=told.available)

    monkeypatch.setattr(memory.psutil, "virtual_memory", asked)
    monkeypatch.setattr(memory.time, "monotonic", lambda: told.now)
    monkeypatch.setattr(memory, "_last", memory.NO_READING)
    return told


def test_what_the_system_said_serves_small_runs_for_a_second(readings):
    for readings.now in (0.0, 0.5, 1.0):
        check_memory(2**26)
    assert readings.n_asked == 1
    readings.now = 1.001
    check_memory(2**26)
    assert readings.n_asked == 2


def test_who_needs_more_than_a_sixteenth_asks_anew_and_is_refused(readings):
    check_memory(2**26)
    readings.available = 2**26
    with pytest.raises(MemoryLimitError, match="but 64 MiB are available"):
        check_memory(2**26 + 1)
    # And the next one, however little it needs, is judged by what was said last.
    check_memory(2**22)
    assert readings.n_asked == 2
    with pytest.raises(MemoryLimitError, match="but 64 MiB are available"):
        check_memory(2**28)


def test_a_limit_is_kept_whatever_the_system_said(readings):
    check_memory(2**20)
    with pytest.raises(MemoryLimitError, match=r"but 0\.5 MiB are available"):
        check_memory(2**20, 2**19)
    assert readings.n_asked == 1
