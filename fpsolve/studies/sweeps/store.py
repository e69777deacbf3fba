"""Finished cases of a sweep, one small file each."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import shown
from fpsolve._support.files import atomic_path
from fpsolve._support.provenance import versions
from fpsolve.model.identity.digests import identity_digest
from fpsolve.model.identity.objects import UnidentifiedError

__all__ = ["CaseStore"]

_VALUE = "value."


class CaseStore:
    """Folder with one file for each finished case of a function.

    The name of a file is a digest of the function, the case and the versions of fpsolve
    and of what it computes with, so that several sweeps can share a folder and a
    changed case is a new one. Functions and arguments are known by what they are, not
    by their names; see `identity_digest` for what that sees.

    Parameters
    ----------
    directory : Path
        Made if it does not exist.
    function : callable
    key : str, optional
        What stands for the function, if not its code.

    Raises
    ------
    ValueError
        If the function cannot be identified.
    """

    def __init__(
        self, directory: Path, function: Callable[..., Any], key: str | None = None
    ) -> None:
        self.about = [_function_digest(function) if key is None else f"key {key}"]
        self.about += [f"{name} {one}" for name, one in sorted(versions().items())]
        directory.mkdir(parents=True, exist_ok=True)
        self.directory = directory

    def path(self, arguments: Mapping[str, Any]) -> Path:
        """Where a case is kept, for arguments in any order.

        Raises
        ------
        ValueError
            If the case holds something that cannot be identified.
        """
        try:
            case = identity_digest(sorted(arguments.items(), key=lambda pair: pair[0]))
        except UnidentifiedError as error:
            raise ValueError(
                "`cases` must be told apart by code and data to be kept, got "
                f"{shown(error.value)} among them; leave `directory` out."
            ) from None
        text = "\0".join([*self.about, case])
        return self.directory / f"{hashlib.sha256(text.encode()).hexdigest()[:24]}.npz"

    def read(self, path: Path) -> dict[str, NDArray[Any]] | None:
        """The values of a case, or None if they are not there or damaged."""
        # A pipe would be waited for.
        if not path.is_file():
            return None
        try:
            # Opened here: a damaged archive would leave the file open.
            with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
                return {name.removeprefix(_VALUE): file[name] for name in file.files}
        # None is kept yet, or what is there is damaged: the case is computed again.
        except (OSError, EOFError, ValueError, BadZipFile):
            return None

    def write(self, path: Path, values: Mapping[str, Any]) -> None:
        """Keep the values of a case, at once and whole."""
        with atomic_path(path) as draft, draft.open("wb") as file:
            # The prefix keeps names apart from the arguments of savez.
            np.savez(file, **{_VALUE + name: one for name, one in values.items()})


def _function_digest(function: Callable[..., Any]) -> str:
    try:
        return identity_digest(function)
    except UnidentifiedError as error:
        raise ValueError(
            "`function` must be told from others by code and data for its cases to be "
            f"kept, got {shown(error.value)} in it; name what it computes by `key`, or "
            "leave `directory` out."
        ) from None
