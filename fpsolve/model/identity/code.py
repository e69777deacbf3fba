"""What functions refer to: global names, attributes of modules, their own imports."""

from __future__ import annotations

import dis
import importlib
import importlib.util
import types
from collections.abc import Iterator
from typing import Any

__all__ = ["attribute_names", "enclosed", "facts", "imported", "named_globals"]

_GLOBALS = {"LOAD_GLOBAL", "LOAD_NAME", "LOAD_FROM_DICT_OR_GLOBALS"}


def facts(code: types.CodeType) -> list[Any]:
    """Return what decides what the code does, but its constants and surroundings."""
    return [
        code.co_code, code.co_exceptiontable, code.co_names, code.co_varnames,
        code.co_freevars, code.co_cellvars, code.co_flags, code.co_argcount,
        code.co_posonlyargcount, code.co_kwonlyargcount,
    ]  # fmt: skip


def enclosed(function: types.FunctionType) -> list[Any]:
    """Return the values of the variables that the function encloses."""
    return [_content(cell) for cell in function.__closure__ or ()]


def _content(cell: types.CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:
        # The variable has not been assigned yet.
        return None


def named_globals(function: types.FunctionType) -> dict[str, Any]:
    """Return the global variables that the code reads, by name."""
    names = {
        str(one.argval)
        for code in _codes(function.__code__)
        for one in dis.get_instructions(code)
        if one.opname in _GLOBALS
    }
    # Where a module lies, and whether it is the main one, says nothing of its code.
    found = sorted(name for name in names if not name.startswith("__"))
    space = function.__globals__
    return {name: space[name] for name in found if name in space}


def attribute_names(function: types.FunctionType) -> tuple[str, ...]:
    """Return all names in the code: those of attributes of modules are among them."""
    names = (name for code in _codes(function.__code__) for name in code.co_names)
    return tuple(sorted(set(names)))


def imported(function: types.FunctionType) -> dict[str, types.ModuleType | None]:
    """Return the modules that the code itself imports; None if there is none."""
    package = function.__globals__.get("__package__") or ""
    found: dict[str, types.ModuleType | None] = {}
    for code in _codes(function.__code__):
        before: list[Any] = [0, 0]
        for one in dis.get_instructions(code):
            if one.opname == "IMPORT_NAME":
                # The level of a relative import is pushed first.
                level = before[-2] if isinstance(before[-2], int) else 0
                name = "." * level + str(one.argval)
                found[name] = _module(name, package)
            before.append(one.argval)
    return found


def _module(name: str, package: str) -> types.ModuleType | None:
    # It may be absent on purpose, and a module raises whatever it likes.
    try:
        return importlib.import_module(importlib.util.resolve_name(name, package))
    except Exception:
        return None


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    """The code and that of its inner functions."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes(constant)
