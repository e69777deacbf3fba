"""Fokker-Planck solvers for stochastic fibre lay-down.

The public names are those of the table `__init__.pyi`. They are loaded on first use, so
that importing the package costs milliseconds.
"""

from typing import Any

from fpsolve._support.lazy import attach

_named, __dir__, __all__ = attach(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("fpsolve")
    return _named(name)
