"""Threads, floating-point errors and what many tests share."""

import os
import signal

# Two threads can be had on every machine, so that tests of thread counts mean the
# same everywhere; one for BLAS, whose small products are called from these threads.
# To be set before numba and BLAS are loaded.
os.environ.setdefault("NUMBA_NUM_THREADS", "2")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numba
import numpy as np
import pytest
from formulas import parse_each_once
from hypothesis import HealthCheck, settings
from netcdf_handles import look_up_each_once

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

# A shell ignores this signal in what it runs in the background, and so do all commands
# that are started from there; tests send it to commands.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The grids are small: where a test does not ask for two threads, waiting for the
# second one would cost more than it does.
numba.set_num_threads(1)


# The same examples every time, so that a failure is that of a change. "thorough" looks
# at ten times as many, others each time: HYPOTHESIS_PROFILE=thorough pytest ...
COMMON = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("ci", derandomize=True, **COMMON)
settings.register_profile("thorough", max_examples=1000, **COMMON)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))

parse_each_once()
look_up_each_once()


@pytest.fixture(autouse=True)
def floating_point_errors_raise():
    """An overflow or an invalid operation in numpy is a failure; underflow is not."""
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture
def rng():
    """Seeded random numbers."""
    return np.random.default_rng(20080611)


@pytest.fixture
def uneven_grid():
    """A grid with a different size along every axis: a swapped index shows."""
    return PhaseSpaceGrid(half_width=(3.0, 2.5), shape=(6, 7, 8))


@pytest.fixture
def model():
    """B = |ξ|²/2, A = 1: the example of the paper."""
    return LayDownModel(QuadraticPotential(), noise=1.0)


@pytest.fixture
def unsynced(monkeypatch):
    """Files are not put on the disk at once, which takes long on a busy one."""
    monkeypatch.setattr("os.fsync", lambda handle: None)


@pytest.fixture
def undrawn(monkeypatch):
    """Pictures are empty files: for tests of which there are, not of what they show."""

    def write(figure, path):
        path.touch()
        return path

    monkeypatch.setattr("fpsolve.plotting.files.write_figure", write)


@pytest.fixture
def on_threads(monkeypatch):
    """`on_threads(n, f)` calls f on n threads of numba, however little it computes."""
    monkeypatch.setattr("fpsolve._kernels.threads.CELLS_PER_THREAD", 1)
    before = numba.get_num_threads()

    def call(n, f):
        numba.set_num_threads(n)
        try:
            return f()
        finally:
            numba.set_num_threads(before)

    return call


@pytest.fixture
def fpsolve(tmp_path, monkeypatch):
    """Call the command line in an empty folder; returns what click recorded."""
    from typer.testing import CliRunner

    from fpsolve.cli import app

    monkeypatch.chdir(tmp_path)
    # Wide enough that nothing is wrapped.
    monkeypatch.setenv("COLUMNS", "200")
    return lambda *words: CliRunner().invoke(app, list(map(str, words)))
