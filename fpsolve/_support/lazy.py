"""Names of a package that are loaded on first use, from the table in its stub."""

import sys
from collections.abc import Callable
from typing import Any

import lazy_loader

__all__ = ["attach"]


def attach(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a package, from its `__init__.pyi`.

    The stub is what editors and type checkers read, and says each name once. Names
    that are not in it are refused in the words of Python, which adds what is similar.
    """
    load, listed, names = lazy_loader.attach_stub(package, file)

    def named(name: str) -> Any:
        if name in names:
            return load(name)
        raise AttributeError(
            f"module {package!r} has no attribute {name!r}",
            name=name,
            obj=sys.modules[package],
        )

    return named, listed, names
