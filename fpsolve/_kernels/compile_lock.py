"""One process at a time compiles a kernel; the others load what it has kept."""

import os
import time
from contextlib import contextmanager
from functools import wraps
from pathlib import Path

from numba.core.compiler_lock import global_compiler_lock
from numba.core.sigutils import normalize_signature

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None

__all__ = ["PATIENCE", "compile_alone"]

# Seconds to wait for another process. The longest compilation takes six; a process
# that has been stopped while it compiles would be waited for without end.
PATIENCE = 60.0

# Files that this process has locked.
_locked = set()


def compile_alone(compiled):
    """Let `compiled.compile` wait while another process compiles the same kernel.

    It then finds the result in the cache. Kernels call one another without a circle,
    so that processes never wait for one another in one. Of the threads of a process,
    numba compiles on one at a time, and its own lock is taken first: a thread that
    waits here holds up all others, but for nothing that they have.
    """
    compile_now = compiled.compile
    path = lock_path(compiled)
    if fcntl is None or path is None:
        return

    @wraps(compile_now)
    def compile_or_wait(signature):
        types, _ = normalize_signature(signature)
        if tuple(types) in compiled.overloads:
            return compile_now(signature)
        with global_compiler_lock, locked(path):
            return compile_now(signature)

    compiled.compile = compile_or_wait


def lock_path(compiled):
    """The file beside the index of the kernel's cache; None without a cache."""
    cache = getattr(compiled, "_cache", None)
    folder, kept = getattr(cache, "cache_path", None), getattr(cache, "_impl", None)
    if folder is None or kept is None:
        return None
    return Path(folder) / f"{kept.filename_base}.lock"


@contextmanager
def locked(path):
    """Hold the lock of a file; go on without where there is none to be had."""
    file = opened(path)
    if file is None:
        yield
        return
    _locked.add(file)
    try:
        wait_for(file)
        yield
    finally:
        _locked.discard(file)
        # Closing alone would leave it to a process that was forked meanwhile.
        release(file)
        os.close(file)


def opened(path):
    """A file to be locked, made if needed; None where that cannot be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        return None


def wait_for(file):
    """Take the lock, or wait until the patience ends or locks prove impossible."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(0.02)
        except OSError:
            return
        else:
            return


def release(file):
    """Let the next one in; harmless where nothing was locked."""
    try:
        fcntl.flock(file, fcntl.LOCK_UN)
    except OSError:
        return


def _after_fork():
    # The lock is the parent's, which may be killed before it is released.
    while _locked:
        os.close(_locked.pop())


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
