"""What instances and classes consist of, and what a name is enough for."""

from __future__ import annotations

import copyreg
import functools
import sys
import types
from collections.abc import Iterator
from typing import Any

from fpsolve._support.checks import shown
from fpsolve.model.identity.packages import package_of_module

__all__ = ["UnidentifiedError", "name_of", "own_entries", "state_of", "without_kept"]

# What a class holds besides what its author wrote, or only shows.
_GENERATED = {
    "__module__", "__qualname__", "__dict__", "__weakref__", "__doc__", "__slots__",
    "__annotations__", "__dataclass_fields__", "__dataclass_params__", "__match_args__",
    "__parameters__", "__abstractmethods__", "_abc_impl", "__orig_bases__",
    "__static_attributes__", "__firstlineno__", "__slotnames__", "__annotate__",
    "__annotate_func__", "__annotations_cache__", "__repr__", "__str__",
}  # fmt: skip
_DESCRIPTORS = (types.MemberDescriptorType, types.GetSetDescriptorType)
# Where the named functions of numpy and scipy live that do not say so.
_HOMES = ("numpy", "scipy.special")


class UnidentifiedError(ValueError):
    """An object cannot be told from others by code and data.

    Parameters
    ----------
    value : object
    """

    def __init__(self, value: Any) -> None:
        super().__init__(f"{shown(value)} cannot be told from others by code and data")
        self.value = value


def own_entries(kind: type) -> dict[str, Any]:
    """Return what the author of a class has put into it, by name."""
    return {
        name: entry
        for name, entry in sorted(vars(kind).items())
        if name not in _GENERATED and not isinstance(entry, _DESCRIPTORS)
    }


def state_of(value: Any) -> list[Any]:
    """Return what `pickle` would keep of an object."""
    own = copyreg.dispatch_table.get(type(value))
    # An object that cannot be taken apart raises whatever it likes.
    try:
        reduced = value.__reduce_ex__(4) if own is None else own(value)
        if isinstance(reduced, str):
            raise UnidentifiedError(value)
        parts = [list(one) if isinstance(one, Iterator) else one for one in reduced]
    except Exception:
        raise UnidentifiedError(value) from None
    return [without_kept(value, part) for part in parts]


def without_kept(value: Any, state: Any) -> Any:
    """Return the state without what an object keeps of questions already asked."""
    if type(state) is not dict:
        return state
    kind = type(value)
    return {
        name: entry
        for name, entry in sorted(state.items(), key=lambda pair: str(pair[0]))
        if not isinstance(getattr(kind, str(name), None), functools.cached_property)
    }


def name_of(value: Any) -> tuple[str, str] | None:
    """Return package and name of what a known package holds under its name."""
    name = getattr(value, "__qualname__", None) or getattr(value, "__name__", None)
    if not isinstance(name, str):
        return None
    for home in (getattr(value, "__module__", None) or "builtins", *_HOMES):
        module = sys.modules.get(home)
        package = package_of_module(module)
        first, *rest = name.split(".")
        # A module may warn of what it is asked for.
        found = vars(module).get(first) if module else None
        for part in rest:
            found = getattr(found, part, None)
        if found is value and package is not None:
            return package, f"{home}.{name}"
    return None
