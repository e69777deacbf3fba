"""Files that are complete, and on the disk, before anything refers to them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np

from fpsolve._support.memory import allowed_memory

__all__ = ["DRAFT", "opened_npz", "sync", "write_durably"]

DRAFT = ".draft"


def write_durably(path: Path, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file that takes the place of `path` when it is complete and on disk.

    A kill or a power cut leaves either the old file or the new one, and at worst a
    draft beside it, which the next call overwrites. An error leaves no draft.
    """
    draft = path.with_name(path.name + DRAFT)
    # What a kill left may be anything by now, a link or a pipe too.
    draft.unlink(missing_ok=True)
    try:
        with draft.open("wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise
    sync(path.parent)


@contextmanager
def opened_npz(path: Path) -> Iterator[Mapping[str, Any]]:
    """Yield the arrays in an .npz; closed whatever is wrong with it.

    Raises
    ------
    ValueError
        If it declares more than fits into memory, or is no file.
    """
    # A pipe would be waited for.
    if not path.is_file():
        raise ValueError("it is no file")
    # Of a path, numpy would leave a damaged file open.
    with path.open("rb") as file, np.load(file, allow_pickle=False) as members:
        n_bytes = sum(one.file_size for one in members.zip.infolist())
        if not n_bytes <= allowed_memory():
            raise ValueError(f"it declares {n_bytes / 2**30:.3g} GiB, more than memory")
        yield members


def sync(path: Path) -> None:
    """Have the system put a file, or the entries of a folder, on the disk."""
    if os.name == "nt" and path.is_dir():
        # Windows has no way to do that for a folder.
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
