"""start.npz: the initial density of a run, and the reference of its entropy."""

from __future__ import annotations

from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.digests import digest_of
from fpsolve._support.durable import opened_npz, write_durably
from fpsolve.density.description import RunDescription
from fpsolve.errors import FileFormatError

__all__ = ["START", "read_start", "write_start"]

Array = NDArray[np.float64]

START = "start.npz"


def write_start(folder: Path, p0: Array, reference: Array | None) -> None:
    """Write both, durably."""
    members: dict[str, Any] = {"p0": p0}
    if reference is not None:
        members["reference"] = reference

    def write(file: IO[bytes]) -> None:
        np.savez(file, **members)

    write_durably(folder / START, write)


def read_start(folder: Path, run: RunDescription) -> tuple[Array, Array | None]:
    """Return `p0` and `reference` of a run.

    Raises
    ------
    FileFormatError
        If the file is damaged, or not that of the run.
    """
    path = folder / START
    # Damage makes zipfile and numpy raise whatever they come across.
    try:
        with opened_npz(path) as members:
            p0 = members["p0"]
            reference = members.get("reference")
    except Exception as error:
        reason = str(error).rstrip(".") or type(error).__name__
        raise FileFormatError(path, reason) from error
    if {"p0": digest_of(p0), "reference": digest_of(reference)} != run.start:
        raise FileFormatError(path, "it does not hold the start of the run")
    return p0, reference
