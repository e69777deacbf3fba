"""Processes forked from running threads: the same numbers or a word, never a wait."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fpsolve._kernels import threads
from fpsolve.errors import ForkedProcessError

SCRIPT = '''
import multiprocessing, os, sys
from concurrent.futures import ProcessPoolExecutor
import numpy as np
import fpsolve as fp
from fpsolve.errors import ForkedProcessError

model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
grid = fp.PhaseSpaceGrid(4.0, (6, 6, 8))
p0 = fp.initial.gaussian(grid, (0.0, 0.0), 0.5)

def density(k):
    scheme = fp.drift_kick(model, grid)
    return fp.solve(scheme, p0, (0.0, 0.5), 0.25, boundary_tolerance=1.0).final.sum()

def paths(k):
    return fp.sample_paths(model, 4, 0.5, 0.25, seed=k).xi.sum()

def grandchild(k):
    """What a process gets that a forked process has forked."""
    reading, writing = os.pipe()
    if os.fork() == 0:
        try:
            text = repr(density(k))
        except ForkedProcessError:
            text = "refused"
        os.write(writing, text.encode())
        os._exit(0)
    os.wait()
    return os.read(reading, 100).decode()

def refused_or(compute):
    try:
        return repr(compute())
    except ForkedProcessError:
        return "refused"

context = multiprocessing.get_context("fork")
here = repr([density(0), density(1)]), repr([paths(0), paths(1)]), repr(density(0))
with context.Pool(1) as pool:
    print(here[0], "|", refused_or(lambda: pool.map(density, [0, 1])))
    print(here[2], "|", pool.map(grandchild, [0])[0])
with ProcessPoolExecutor(1, mp_context=context) as pool:
    print(here[1], "|", refused_or(lambda: list(pool.map(paths, [0, 1]))))
'''


def lines_of(layer, script, *more):
    """What a script prints on a threading layer; a wait is a failure."""
    environment = {
        **os.environ,
        "NUMBA_THREADING_LAYER": layer,
        "PYTHONPATH": str(Path(__file__).parents[2]),
    }
    # Newer Pythons warn of any fork while there are threads.
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", script, *more]
    found = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    return found.stdout.splitlines()


@pytest.mark.processes
@pytest.mark.parametrize("layer", ["omp", "workqueue"])
def test_a_pool_by_fork_gives_the_same_numbers_or_refuses(layer):
    lines = [line.split(" | ") for line in lines_of(layer, SCRIPT)]
    assert len(lines) == 3
    for here, forked in lines:
        assert forked == ("refused" if layer == "omp" else here)


def test_a_process_knows_whether_its_threads_were_left_behind(monkeypatch):
    monkeypatch.setattr(threads, "_region", threads._Region())
    threads.check_not_forked()
    monkeypatch.setattr(threads, "_threads_do_not_survive", lambda: False)
    threads._after_fork()
    threads.check_not_forked()
    monkeypatch.setattr(threads, "_threads_do_not_survive", lambda: True)
    threads._after_fork()
    # Of its own children none can use them either.
    monkeypatch.setattr(threads, "_threads_do_not_survive", lambda: False)
    threads._after_fork()
    for use in (threads.parallel_region, threads.check_not_forked):
        with pytest.raises(ForkedProcessError, match=r"get_context\('spawn'\)"):
            use()


TOGETHER = """
import numpy as np
from concurrent.futures import ThreadPoolExecutor
import numba
from fpsolve._kernels.functionals import row_sums

p = np.random.default_rng(1).normal(size=(40, 40, 64))

def sums(k):
    out = np.empty((40, 40))
    for _ in range(20):
        row_sums(p, out)
    return out

alone = sums(0)
with ThreadPoolExecutor(4) as pool:
    same = [np.array_equal(alone, found) for found in pool.map(sums, range(8))]
print(numba.threading_layer(), all(same))
"""


def test_a_layer_for_one_thread_at_a_time_serves_several():
    # By itself it ends the process: "Concurrent access has been detected".
    assert lines_of("workqueue", TOGETHER) == ["workqueue True"]
