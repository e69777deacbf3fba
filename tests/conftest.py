"""Threads, floating-point errors and what many tests share."""

import gc
import os
import signal

# Two threads can be had on every machine, so that tests of thread counts mean the
# same everywhere; one for BLAS, whose small products are called from these threads.
# To be set before numba and BLAS are loaded.
os.environ.setdefault("NUMBA_NUM_THREADS", "2")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest

# A shell ignores this signal in what it runs in the background, and so do all commands
# that are started from there; tests send it to commands.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_configure(config):
    """Prepare a process for tests; one that hands them out to others loads nothing."""
    if config.getoption("numprocesses", None) and not hasattr(config, "workerinput"):
        return
    import numba
    from formulas import parse_each_once
    from netcdf_handles import look_up_each_once

    # The grids are small: where a test does not ask for two threads, waiting for the
    # second one would cost more than it does.
    numba.set_num_threads(1)
    choose_examples()
    parse_each_once()
    look_up_each_once()


def pytest_collection_finish(session):
    """What is loaded by now stays: the garbage collector need not look at it again."""
    gc.freeze()


def choose_examples():
    """Let hypothesis draw the same examples every time: a failure is that of a change.

    "thorough" looks at ten times as many, others each time:
    HYPOTHESIS_PROFILE=thorough pytest ...
    """
    from hypothesis import HealthCheck, settings

    common = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
    settings.register_profile("ci", derandomize=True, **common)
    settings.register_profile("thorough", max_examples=1000, **common)
    settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))


@pytest.fixture(autouse=True)
def floating_point_errors_raise():
    """An overflow or an invalid operation in numpy is a failure; underflow is not."""
    import numpy as np

    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture
def rng():
    """Seeded random numbers."""
    import numpy as np

    return np.random.default_rng(20080611)


@pytest.fixture
def uneven_grid():
    """A grid with a different size along every axis: a swapped index shows."""
    from fpsolve.grids.phase_space import PhaseSpaceGrid

    return PhaseSpaceGrid(half_width=(3.0, 2.5), shape=(6, 7, 8))


@pytest.fixture
def model():
    """B = |ξ|²/2, A = 1: the example of the paper."""
    from fpsolve.model.laydown import LayDownModel
    from fpsolve.model.potentials import QuadraticPotential

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
    import numba

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
