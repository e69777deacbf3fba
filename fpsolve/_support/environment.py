"""What a result was computed on: packages, processor, threads. No names, no paths."""

from __future__ import annotations

import platform
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

__all__ = ["environment"]

# What the last bits of a result may depend on, beyond fpsolve itself.
PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "xarray")
_PROCESSORS = Path("/proc/cpuinfo")


def environment() -> dict[str, Any]:
    """Packages, system, processor, BLAS and threads, as JSON can hold them.

    Threads are those in use now. What numba compiles for is in it once numba is
    loaded; a computation that needs none does not load it for this. There is no name
    of a host or a user in it, and no path.
    """
    # Nothing in it is nested deeper; a copy of every depth takes as long as a step.
    found: dict[str, Any] = {
        name: one.copy() if isinstance(one, dict | list) else one
        for name, one in fixed_environment()
    }
    found["blas"] = _blas()
    if "numba" in sys.modules:
        found["numba"] = _numba()
    return found


@cache
def fixed_environment() -> tuple[tuple[str, Any], ...]:
    """What stays the same as long as the process runs."""
    import numpy as np

    found = np.show_config(mode="dicts")["SIMD Extensions"]
    return (
        ("python", f"{platform.python_implementation()} {platform.python_version()}"),
        ("packages", {name: _version(name) for name in PACKAGES}),
        ("system", platform.system()),
        # The functions exp, log, sin and cos are those of this library.
        ("c_library", " ".join(platform.libc_ver()).strip()),
        ("architecture", platform.machine()),
        ("processor", _processor()),
        ("vector_instructions", [*found.get("baseline", ()), *found.get("found", ())]),
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    """Name of the processor as its maker calls it, if the system tells it."""
    try:
        lines = _PROCESSORS.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    names = (line.split(":", 1)[1] for line in lines if line.startswith("model name"))
    return next(names, platform.processor()).strip()


def _blas() -> list[dict[str, Any]]:
    """Library, version, processor and threads of every BLAS that is loaded."""
    names = {"internal_api": "library", "version": "version",
             "architecture": "architecture", "num_threads": "threads"}  # fmt: skip
    loaded = [
        {name: one.get(key) for key, name in names.items()}
        for one in _libraries("scipy.linalg" in sys.modules).info()
        if one["user_api"] == "blas"
    ]
    # In the order in which the libraries came, which says nothing.
    return sorted(loaded, key=str)


@cache
def _libraries(scipy_is_loaded: bool) -> Any:
    """Libraries that use threads; finding them takes as long as a small solve.

    scipy brings a BLAS of its own: before it is loaded there are fewer to find.
    """
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def _numba() -> dict[str, Any]:
    import numba

    return {"threads": numba.get_num_threads(), "compiles_for": _host()}


@cache
def _host() -> str:
    import llvmlite.binding as llvm

    return str(llvm.get_host_cpu_name())
