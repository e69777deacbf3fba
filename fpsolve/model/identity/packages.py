"""Code that a name and a version tell: Python, installed packages, fpsolve itself."""

from __future__ import annotations

import hashlib
import platform
import sys
import sysconfig
import types
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

__all__ = ["package_of_class", "package_of_file", "package_of_module"]

_OWN = Path(__file__).parents[2]
_PACKAGES = {"site-packages", "dist-packages"}
_STANDARD = tuple(sysconfig.get_path(name) for name in ("stdlib", "platstdlib"))


def package_of_module(module: types.ModuleType | None) -> str | None:
    """Return name and version of the package of a module; None for a user's own."""
    if module is None:
        return None
    file = getattr(module, "__file__", None)
    if file is None:
        built_in = module.__name__.split(".")[0] in sys.stdlib_module_names
        return _python() if built_in else None
    return package_of_file(file)


def package_of_class(kind: type) -> str | None:
    """Return name and version of the package of a class; None for a user's own."""
    return package_of_module(sys.modules.get(kind.__module__))


@cache
def package_of_file(file: str) -> str | None:
    """Return name and version of the package that a file is part of, if it is one."""
    path = Path(file)
    if path.is_relative_to(_OWN):
        return f"fpsolve {_version('fpsolve')} {_own_source()}"
    for place, part in enumerate(path.parts[:-1]):
        if part in _PACKAGES:
            name = path.parts[place + 1].split(".")[0]
            return f"{name} {_version(name)}"
    return _python() if file.startswith(("<frozen ", *_STANDARD)) else None


def _python() -> str:
    # Code is compiled alike, and the library does the same, in all versions 3.11.x.
    return "python " + ".".join(platform.python_version_tuple()[:2])


@cache
def _own_source() -> str:
    """Digest of the source of fpsolve: between two versions it changes too."""
    found = hashlib.sha256()
    for path in sorted(_OWN.rglob("*.py")):
        found.update(f"{path.relative_to(_OWN).as_posix()}\0".encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        # A package need not be called like what it installs.
        return str(getattr(sys.modules.get(name), "__version__", ""))
