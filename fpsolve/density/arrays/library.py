"""The array library that a density belongs to, and what is asked of it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["Foreign", "Library", "brought", "library_of", "on_host"]

# An array of a library that is known when it is called only.
Foreign: TypeAlias = Any

X64 = 'call jax.config.update("jax_enable_x64", True) before you make arrays'


@dataclass(frozen=True)
class Library:
    """A namespace of the array API standard, and a device of it.

    Parameters
    ----------
    xp : module
        `jax.numpy`, `cupy`, `numpy`, or another one of the standard.
    device : object, optional
        As its arrays tell it; None for the one that the library takes by itself.

    References
    ----------
    The functions that are called are those of the standard [Meu23]_.
    """

    xp: Any
    device: Any = None

    @property
    def name(self) -> str:
        """The package: jax, cupy."""
        return str(self.xp.__name__).partition(".")[0]

    @property
    def origin(self) -> str:
        """What a result says of where it was computed."""
        version = getattr(sys.modules[self.name], "__version__", "of no version")
        return f"{self.name} {version} on {self.device or 'its device'}"

    def array(self, values: Any) -> Foreign:
        """A copy of host numbers on the device; raises unless float64 stays float64."""
        values = np.ascontiguousarray(values)
        if self.name == "cupy":
            made = self.xp.asarray(values)
        else:
            made = self.xp.asarray(values, device=self.device)
        if values.dtype == np.float64:
            check_double("values", made, self)
        return made

    def compiled(self, program: Callable[..., Any]) -> Callable[..., Any]:
        """program(xp, …) with the namespace filled in; under jax one kernel."""
        return compiled(program, self.xp)


@cache
def compiled(program: Callable[..., Any], xp: ModuleType) -> Callable[..., Any]:
    """A program for a namespace, made once: jax compiles what it meets."""
    filled = partial(program, xp)
    if xp.__name__ == "jax.numpy":
        made: Callable[..., Any] = sys.modules["jax"].jit(filled)
        return made
    return filled


def library_of(p: Any) -> Library | None:
    """The library of an array; None for one of numpy, or what is no array at all."""
    if isinstance(p, np.ndarray | np.generic):
        return None
    device = getattr(p, "device", None)
    if hasattr(p, "__array_namespace__"):
        return Library(p.__array_namespace__(), device)
    # Its arrays tell their namespace in some versions only.
    if type(p).__module__.partition(".")[0] == "cupy":
        return Library(sys.modules["cupy"], device)
    return None


def check_double(name: str, values: Foreign, library: Library) -> None:
    """Raise TypeError unless an array holds float64, which jax has to be asked for."""
    if values.dtype == library.xp.float64:
        return
    remedy = X64 if library.name == "jax" else "convert it to float64"
    raise TypeError(
        f"`{name}` must hold float64 to be evolved by {library.name}, got "
        f"{values.dtype}; {remedy}."
    )


def brought(values: Any) -> Any:
    """An array of another library on the host; anything else as it is."""
    return values if library_of(values) is None else on_host(values)


def on_host(values: Foreign) -> Array:
    """A copy in the memory of the host."""
    if hasattr(values, "get") and type(values).__module__.startswith("cupy"):
        values = values.get()
    found: Array = np.asarray(values)
    return found
