"""`numba.njit` that works where nothing can be kept, and where threads are shared.

What one process compiles, others that need it meanwhile wait for.
"""

import warnings
from functools import wraps

import numba

from fpsolve._kernels.compile_lock import compile_alone
from fpsolve._kernels.compile_once import compile_once
from fpsolve._kernels.threads import parallel_region

__all__ = ["ParallelKernel", "kernels_are_kept", "njit"]

# What numba would take from whichever caller is compiled first, if it were not said: a
# helper compiled on its own, and kept, would round otherwise than one compiled for its
# caller.
INHERITED = {"fastmath": False, "forceinline": False, "error_model": "python"}

_told = False


def njit(**options):
    """``numba.njit(**options)``, which compiles anew if the result cannot be kept.

    With ``parallel=True`` gives a `ParallelKernel`. What is not said is the default of
    numba, also where another kernel asks for the compilation.
    """
    options = {**INHERITED, **options}

    def decorate(function):
        try:
            compiled = numba.njit(**options)(function)
        except RuntimeError as error:
            # No folder to keep it in: the only thing that is looked for before a call.
            if not options.get("cache"):
                raise
            tell(error)
            compiled = numba.njit(**{**options, "cache": False})(function)
        forgive(compiled)
        compile_once(compiled)
        compile_alone(compiled)
        return ParallelKernel(compiled) if options.get("parallel") else compiled

    return decorate


class ParallelKernel:
    """A compiled kernel that uses threads; not to be called from other kernels.

    Attributes
    ----------
    compiled : numba.core.dispatcher.Dispatcher

    Raises
    ------
    ForkedProcessError
        When called in a process in which threads cannot run.
    """

    def __init__(self, compiled):
        self.compiled = compiled
        self.__name__, self.__doc__ = compiled.__name__, compiled.__doc__

    def __call__(self, *arguments):
        """Call the compiled function."""
        with parallel_region():
            return self.compiled(*arguments)

    @property
    def py_func(self):
        """The Python source as a function."""
        return self.compiled.py_func


def forgive(compiled):
    """Let a cache that cannot be read or written count as an empty one."""
    cache = getattr(compiled, "_cache", None)
    if hasattr(cache, "load_overload") and hasattr(cache, "save_overload"):
        cache.load_overload = loading(cache)
        cache.save_overload = saving(cache)


def loading(cache):
    """What loads from a cache; nothing is found in one that is damaged."""
    load = cache.load_overload

    @wraps(load)
    def load_or_nothing(*arguments):
        try:
            return load(*arguments)
        except OSError as error:
            tell(error)
        except Exception:
            # Damage makes pickle raise whatever it comes across. The cache begins anew.
            try:
                cache.flush()
            except OSError as error:
                tell(error)
        return None

    return load_or_nothing


def saving(cache):
    """What saves to a cache; a full disk is told, and forgotten."""
    save = cache.save_overload

    @wraps(save)
    def save_or_tell(*arguments):
        try:
            save(*arguments)
        except OSError as error:
            tell(error)

    return save_or_tell


def kernels_are_kept() -> bool:
    """Whether nothing has stood in the way until now."""
    return not _told


def tell(reason):
    """Say once that kernels are not kept, and what helps."""
    global _told
    if not _told:
        _told = True
        warnings.warn(
            f"compiled kernels cannot be kept, and are compiled anew by every process: "
            f"{str(reason).rstrip('.')}; set NUMBA_CACHE_DIR to a folder that can be "
            "written and has room.",
            UserWarning,
            stacklevel=2,
        )
