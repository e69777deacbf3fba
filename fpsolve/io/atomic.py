"""Files and folders that appear complete or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fpsolve._checks import check_path

__all__ = ["atomic_path", "check_folder", "check_room", "made_folder"]

# Bytes of attributes, coordinates and the tables of HDF5, generously.
DESCRIPTION = 2**20


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to; at the end what lies there takes the place of `path`.

    After an exception, Ctrl-C included, `path` is as it was and nothing else is left
    behind. The draft has the same name and suffix and lies on the same file system,
    so that the last move is one renaming.

    Parameters
    ----------
    path : str or os.PathLike
        Final place of the file or folder; its parent must exist.

    Raises
    ------
    FileNotFoundError
        If the parent folder does not exist.
    IsADirectoryError
        If a file is to take the place of a folder.
    """
    target = check_path("path", path)
    if not target.parent.is_dir():
        raise FileNotFoundError(
            f"`path` must lie in an existing folder, got `{target}`; create "
            f"`{target.parent}` first."
        )
    if target.is_dir() and not is_store(target):
        raise IsADirectoryError(
            f"`path` must not be a folder, got `{target}`; name a file in it."
        )
    # A folder instead of a temporary file: the file in it gets the permissions that
    # the user's umask asks for.
    staging = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    try:
        draft = staging / target.name
        yield draft
        _move(draft, target, aside=staging / "replaced")
    finally:
        shutil.rmtree(staging, ignore_errors=True)


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


def check_room(path: Path, n_bytes: int) -> None:
    """Raise OSError unless a file of n_bytes and what describes it fit on the disk.

    To be asked before netCDF is written: HDF5 ends the process, without a word, some
    time after it met a full disk.
    """
    free, needed = shutil.disk_usage(path.parent).free, n_bytes + DESCRIPTION
    if not needed <= free:
        mebibytes = f"{needed / 2**20:.0f} MiB needed, {free / 2**20:.0f} MiB free"
        reason = f"{os.strerror(errno.ENOSPC)} ({mebibytes})"
        raise OSError(errno.ENOSPC, reason, str(path))


def is_store(path: Path) -> bool:
    """Whether a folder is a zarr store, the only kind that may be replaced."""
    return any((path / name).is_file() for name in ("zarr.json", ".zgroup"))


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
