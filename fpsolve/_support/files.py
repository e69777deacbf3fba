"""Files and folders that appear complete or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fpsolve._support.checks import check_path
from fpsolve._support.staging import REPLACED, staging_folder
from fpsolve._support.targets import is_pipe, opened_pipe, poured, target_of

__all__ = ["atomic_path", "check_folder", "check_room", "made_folder"]

# Bytes of attributes, coordinates and the tables of HDF5, generously.
DESCRIPTION = 2**20


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to; at the end what lies there takes the place of `path`.

    After an exception, Ctrl-C included, `path` is as it was and nothing else is left
    behind; what a killed process left is removed by the next one that writes there.
    The draft has the same name and suffix and lies on the same file system, so that
    the last move is one renaming. A link is followed: the file that it names is
    replaced, and the link stays. Through a pipe the finished draft is written.

    Parameters
    ----------
    path : str or os.PathLike
        Final place of the file or folder; its parent must exist.

    Raises
    ------
    FileNotFoundError
        If the parent folder does not exist, or the path is a link to nothing.
    IsADirectoryError
        If a file is to take the place of a folder.
    ValueError
        If the path is a device, a socket, a link in a circle, or a pipe from which no
        program reads.
    """
    given = check_path("path", path)
    target = target_of(given)
    if is_pipe(target):
        with _through_pipe(target) as draft:
            yield draft
        return
    with staging_folder(target.parent, target.name) as staging:
        draft = staging / given.name
        yield draft
        _move(draft, target, aside=staging / REPLACED)


@contextmanager
def _through_pipe(path: Path) -> Iterator[Path]:
    """Yield a path to write to, of which a pipe gets the bytes when it is complete."""
    home = Path(tempfile.gettempdir())
    with opened_pipe(path) as pipe, staging_folder(home, path.name) as staging:
        draft = staging / path.name
        yield draft
        poured(draft, pipe)


def check_folder(path: str | os.PathLike[str], name: str = "directory") -> Path:
    """Return the path of a folder that is there or can be made.

    Parameters
    ----------
    path : str or os.PathLike
    name : str
        What messages call it.

    Raises
    ------
    NotADirectoryError
        If it, or what lies above it, is a file.
    PermissionError
        If nothing may be written there.
    """
    folder = check_path(name, path)
    nearest = folder
    while not os.path.lexists(nearest) and nearest != nearest.parent:
        nearest = nearest.parent
    if not nearest.is_dir():
        raise NotADirectoryError(
            f"`{name}` must be a folder, got `{folder}`: `{nearest}` is none; name "
            "another one."
        )
    if not os.access(nearest, os.W_OK):
        raise PermissionError(
            f"`{name}` must be a folder to write to, got `{folder}`: `{nearest}` may "
            "not be changed; name another one."
        )
    return folder


def made_folder(path: str | os.PathLike[str], name: str = "directory") -> Path:
    """Return the path of a folder, made if it was not there; see `check_folder`."""
    folder = check_folder(path, name)
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def check_room(path: Path, n_bytes: int, draft: Path) -> None:
    """Raise OSError unless a file of n_bytes and what describes it fit on the disk.

    The disk is that of the draft; the message names the path asked for.

    To be asked before netCDF is written: HDF5 ends the process, without a word, some
    time after it met a full disk.
    """
    free, needed = shutil.disk_usage(draft.parent).free, n_bytes + DESCRIPTION
    if not needed <= free:
        mebibytes = f"{needed / 2**20:.0f} MiB needed, {free / 2**20:.0f} MiB free"
        reason = f"{os.strerror(errno.ENOSPC)} ({mebibytes})"
        raise OSError(errno.ENOSPC, reason, str(path))


def _move(draft: Path, target: Path, aside: Path) -> None:
    if not target.is_dir():
        draft.replace(target)
        return
    if not draft.is_dir():
        raise IsADirectoryError(
            f"`path` must not be a folder, got `{target}`; name a file in it."
        )
    # No system call replaces a folder that is not empty.
    target.rename(aside)
    try:
        draft.rename(target)
    except BaseException:
        aside.rename(target)
        raise
