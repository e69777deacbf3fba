"""Kernels are compiled once; where they cannot be kept anew, and it is said once."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from fpsolve._kernels import compile_lock

# Each compiles in a process of its own.
pytestmark = pytest.mark.processes

KERNELS = """
from fpsolve._kernels.compiling import njit


@njit(cache=True)
def twice(x):
    return 2 * x


@njit(cache=True)
def four_times(x):
    return twice(twice(x))
"""
USE = """
import own_kernels as kernels
print(kernels.four_times(2.0), kernels.twice(3.0))
"""
# A folder that cannot be written, whoever asks.
READ_ONLY = """
import tempfile
def refuse(*arguments, **options):
    raise OSError(30, "Read-only file system")
tempfile.TemporaryFile = refuse
"""
# A disk on which a file can be made, but nothing be written to it.
FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
"""
# Compilation takes so long that two processes must meet in it.
TOGETHER = """
import os, time
import numba.core.event as event
import own_kernels as kernels

class Slow(event.Listener):
    def on_start(self, compilation):
        time.sleep(0.3)
    def on_end(self, compilation):
        pass

event.register("numba:compile", Slow())
for _ in range(2):
    if os.fork() == 0:
        assert kernels.four_times(2.0) == 8.0
        both = kernels.twice, kernels.four_times
        print(*(sum(one.stats.cache_misses.values()) for one in both), flush=True)
        os._exit(0)
for _ in range(2):
    assert os.waitstatus_to_exitcode(os.wait()[1]) == 0
"""
# A process that is killed in the lock, and has forked another one there.
KILLED = """
import os, signal
import own_kernels as kernels
from fpsolve._kernels import compile_lock

inside, told = os.pipe()
until, end = os.pipe()
if os.fork() == 0:
    with compile_lock.locked(compile_lock.lock_path(kernels.twice)):
        if os.fork() == 0:
            os.close(end)
            os.write(told, b"1")
            os.read(until, 1)
            os._exit(0)
        os.kill(os.getpid(), signal.SIGKILL)
os.read(inside, 1)
os.wait()

def refuse(seconds):
    raise AssertionError("waits for a process that is not there any more")

compile_lock.time.sleep = refuse
print(kernels.twice(3.0))
"""


@pytest.fixture
def run(tmp_path):
    """`run(source)` executes it beside two small kernels; its output, and warnings."""
    (tmp_path / "own_kernels.py").write_text(KERNELS)
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[2]), str(tmp_path)]),
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
    }

    def call(source):
        found = subprocess.run(
            [sys.executable, "-c", source], env=environment, capture_output=True,
            text=True, check=True,
        )  # fmt: skip
        return found.stdout.strip(), found.stderr

    return call


@pytest.mark.parametrize(
    ("obstacle", "reason"),
    [
        pytest.param(READ_ONLY, "no locator available", id="read-only"),
        pytest.param(FULL, "File too large", id="full", marks=pytest.mark.nightly),
    ],
)
def test_kernels_that_cannot_be_kept_are_compiled_anew(run, obstacle, reason):
    found, told = run(obstacle + USE)
    assert found == "8.0 6.0"
    assert told.count("UserWarning") == 1
    assert reason in told
    assert "set NUMBA_CACHE_DIR to a folder that can be written" in told


def test_a_damaged_cache_is_begun_anew(tmp_path, monkeypatch):
    source = tmp_path / "own_kernels.py"
    source.write_text(KERNELS)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))

    def loaded():
        """Whether a new process would find what one before it has compiled."""
        twice = runpy.run_path(str(source))["twice"]
        assert twice(3.0) == 6.0
        return bool(twice.stats.cache_hits)

    assert [loaded(), loaded()] == [False, True]
    for suffix, content in {".nbi": b"no index", ".nbc": b""}.items():
        (file,) = (tmp_path / "cache").rglob(f"*{suffix}")
        file.write_bytes(content)
        assert [loaded(), loaded()] == [False, True]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="locks of POSIX")
def test_of_two_processes_one_compiles_and_the_other_loads(run):
    found, _ = run(TOGETHER)
    # Misses of both kernels, in either order.
    assert sorted(found.splitlines()) == ["0 0", "1 1"]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="locks of POSIX")
def test_the_lock_of_a_killed_process_is_free(run):
    found, _ = run(KILLED)
    assert found == "6.0"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="locks of POSIX")
def test_a_process_that_has_stopped_is_not_waited_for_without_end(
    tmp_path, monkeypatch
):
    source = tmp_path / "own_kernels.py"
    source.write_text(KERNELS)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(compile_lock, "PATIENCE", 0.1)
    twice = runpy.run_path(str(source))["twice"]
    with compile_lock.locked(compile_lock.lock_path(twice)):
        assert twice(3.0) == 6.0


def test_the_command_line_works_where_nothing_can_be_kept(run):
    found, told = run(
        READ_ONLY + "from fpsolve.cli import app\napp(['info'], standalone_mode=False)"
    )
    assert "none; set NUMBA_CACHE_DIR to a folder that can be written" in found
    # One line, as every warning of the command line.
    (line,) = told.splitlines()
    assert line.startswith("warning: compiled kernels cannot be kept")
