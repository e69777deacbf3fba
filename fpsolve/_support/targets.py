"""What a result may be written to: a free path, a file, a store, or a pipe."""

from __future__ import annotations

import errno
import os
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

__all__ = ["check_targets", "is_pipe", "is_store", "opened_pipe", "poured", "target_of"]

_NAMES = (
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISFIFO, "a pipe"),
)


def target_of(path: Path, name: str = "path") -> Path:
    """Return the place that a path names, with links followed to their end.

    It is free, a file, a zarr store, or a pipe (then the path itself comes back).

    Parameters
    ----------
    path : Path
    name : str
        What messages call it.

    Raises
    ------
    FileNotFoundError
        If its folder does not exist, or it is a link to nothing.
    IsADirectoryError
        If it is a folder, of which a file would take the place.
    ValueError
        If it is a device, a socket, or a link in a circle.
    """
    kind = _mode(path, name)
    if kind is None:
        return _free(path, name)
    if stat.S_ISFIFO(kind):
        return path
    place = path.resolve()
    if stat.S_ISDIR(kind):
        if not is_store(place):
            raise IsADirectoryError(
                f"`{name}` must not be a folder, got `{path}`; name a file in it."
            )
    elif not stat.S_ISREG(kind):
        what = next(text for test, text in _NAMES if test(kind))
        raise ValueError(
            f"`{name}` must be a file or a free place, got `{path}`, which is {what}; "
            "name another one."
        )
    return place


def check_targets(paths: Iterable[Path]) -> None:
    """Raise as `target_of` does before anything is computed; pipes do not do either.

    A pipe takes one file that was asked for by its name. What a command writes into a
    folder are several, named by itself.
    """
    for path in paths:
        if path.parent.is_dir() and is_pipe(target_of(path)):
            raise ValueError(
                f"`{path}` must be a file or a free place, got a pipe; remove it, or "
                "name another folder."
            )


def is_pipe(path: Path) -> bool:
    """Whether a path leads to a pipe (FIFO)."""
    try:
        return stat.S_ISFIFO(path.stat().st_mode)
    except OSError:
        return False


@contextmanager
def opened_pipe(path: Path) -> Iterator[IO[bytes]]:
    """Open a pipe for writing, which somebody must be reading already.

    Opening it in the usual way would wait for a reader, for ever if none comes.

    Raises
    ------
    ValueError
        If no program reads from it.
    """
    try:
        handle = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
    except OSError as error:
        if error.errno != errno.ENXIO:
            raise
        raise ValueError(
            f"`path` must be a pipe that a program reads from, got `{path}`; start the "
            "reader first."
        ) from None
    os.set_blocking(handle, True)
    with os.fdopen(handle, "wb") as pipe:
        yield pipe


def poured(draft: Path, pipe: IO[bytes]) -> None:
    """Write a finished file through a pipe."""
    if draft.is_dir():
        raise IsADirectoryError(
            "`path` must be a free place for a store, got a pipe; a store is a folder."
        )
    with draft.open("rb") as file:
        shutil.copyfileobj(file, pipe)


def is_store(path: Path) -> bool:
    """Whether a folder is a zarr store, the only kind that may be replaced."""
    return any((path / name).is_file() for name in ("zarr.json", ".zgroup"))


def _mode(path: Path, name: str) -> int | None:
    """Kind of what a path leads to; None if there is nothing, not even a link."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        if not path.is_symlink():
            return None
        raise FileNotFoundError(
            f"`{name}` must not be a link to nothing, got `{path}`, which leads to "
            f"`{path.readlink()}`; remove it, or name another one."
        ) from None
    except NotADirectoryError:
        return None
    except OSError as error:
        if error.errno != errno.ELOOP:
            raise
        raise ValueError(
            f"`{name}` must not be a link in a circle, got `{path}`; remove it, or "
            "name another one."
        ) from None


def _free(path: Path, name: str) -> Path:
    if not path.parent.is_dir():
        raise FileNotFoundError(
            f"`{name}` must lie in an existing folder, got `{path}`; create "
            f"`{path.parent}` first."
        )
    return path
