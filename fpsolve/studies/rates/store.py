"""Finished cases of a sweep, one small file each."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from fpsolve.io.atomic import atomic_path
from fpsolve.provenance import versions

__all__ = ["CaseStore"]

_VALUE = "value."


class CaseStore:
    """Folder with one file for each finished case of a function.

    The name of a file is a hash of the function's name, the case and the version of
    fpsolve, so that several sweeps can share a folder and a changed case is a new one.

    Parameters
    ----------
    directory : Path
        Made if it does not exist.
    function : callable
        Known by its module and name.
    """

    def __init__(self, directory: Path, function: Callable[..., Any]) -> None:
        directory.mkdir(parents=True, exist_ok=True)
        self.directory = directory
        module, name = getattr(function, "__module__", ""), _name_of(function)
        self.home = f"{module}.{name}"

    def path(self, arguments: Mapping[str, Any]) -> Path:
        """Where a case is kept.

        Raises
        ------
        ValueError
            If the case holds something that cannot be told from others by its value.
        """
        text = json.dumps(
            [self.home, versions()["fpsolve"], arguments],
            default=_described, sort_keys=True, ensure_ascii=False,
        )  # fmt: skip
        return self.directory / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.npz"

    def read(self, arguments: Mapping[str, Any]) -> dict[str, NDArray[Any]] | None:
        """The values of a case, or None if they are not there or damaged."""
        path = self.path(arguments)
        try:
            # Opened here: a damaged archive would leave the file open.
            with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
                return {name.removeprefix(_VALUE): file[name] for name in file.files}
        # None is kept yet, or what is there is damaged: the case is computed again.
        except (OSError, EOFError, ValueError, BadZipFile):
            return None

    def write(self, arguments: Mapping[str, Any], values: Mapping[str, Any]) -> None:
        """Keep the values of a case, at once and whole."""
        path = self.path(arguments)
        with atomic_path(path) as draft, draft.open("wb") as file:
            # The prefix keeps names apart from the arguments of savez.
            np.savez(file, **{_VALUE + name: one for name, one in values.items()})


def _name_of(function: Callable[..., Any]) -> str:
    name = str(getattr(function, "__qualname__", ""))
    if not name or "<" in name:
        raise ValueError(
            "`function` must be defined at the top of a module for its cases to be "
            f"kept, got {function!r}; give it a name, or leave `directory` out."
        )
    return name


def _described(value: Any) -> Any:
    """What JSON can hold, and is the same for the same value in another process."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if hasattr(value, "to_dict"):
        text = json.dumps(value.to_dict(), default=_described, sort_keys=True)
        if " at 0x" not in text and "lambda" not in text:
            return {type(value).__name__: json.loads(text)}
    elif is_dataclass(value) and not isinstance(value, type):
        parts = {field.name: getattr(value, field.name) for field in fields(value)}
        return {type(value).__name__: parts}
    elif callable(value) and "<" not in getattr(value, "__qualname__", "<"):
        return f"{value.__module__}.{value.__qualname__}"
    raise ValueError(
        f"`cases` must be told apart by their values to be kept, got {value!r}; leave "
        "`directory` out."
    )
