"""Hidden folders in which files are written, and what killed processes left in them."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

_CAN_LOCK = fcntl is not None

__all__ = ["REPLACED", "remove_stale", "staging_folder"]

# Held by the process that writes, and by no one once that has ended, however it did.
_LOCK = ".fpsolve-lock"
# A store that was moved aside, for the instant until the new one is in its place.
REPLACED = ".fpsolve-replaced"
# Lengths of what `mkdtemp` appends to a name.
_RANDOM = 8
_TRIALS = 100


@contextmanager
def staging_folder(parent: Path, name: str) -> Iterator[Path]:
    """Make a hidden folder for the draft of a file of that name; it goes in the end.

    A folder instead of a temporary file: the file in it gets the permissions that the
    user's umask asks for.

    Parameters
    ----------
    parent : Path
    name : str
    """
    remove_stale(parent)
    folder, lock = _made(parent, name)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        lock.close()


def remove_stale(parent: Path) -> None:
    """Remove the staging folders whose process has ended; put back what it moved.

    Those of processes that still write are locked, and stay.
    """
    if not _CAN_LOCK:
        return
    # What may not be read or removed here is somebody else's.
    with suppress(OSError):
        with os.scandir(parent) as entries:
            found = [Path(one.path) for one in entries if _looks_staged(one)]
        for folder in found:
            with suppress(OSError):
                _remove_if_stale(folder)


def _looks_staged(entry: os.DirEntry[str]) -> bool:
    name, dot, random = entry.name.rpartition(".")
    return (
        name.startswith(".")
        and bool(dot)
        and len(random) == _RANDOM
        and entry.is_dir(follow_symlinks=False)
    )


def _remove_if_stale(folder: Path) -> None:
    if not (folder / _LOCK).is_file():
        return
    with (folder / _LOCK).open("rb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        aside, name = folder / REPLACED, folder.name[1 : -_RANDOM - 1]
        if aside.exists() and not (folder.parent / name).exists():
            aside.rename(folder.parent / name)
        shutil.rmtree(folder)


def _made(parent: Path, name: str) -> tuple[Path, IO[bytes]]:
    """Return a new folder and the lock in it, which is held."""
    for _ in range(_TRIALS):
        folder = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=parent))
        lock = (folder / _LOCK).open("wb")
        if _taken(lock, folder):
            return folder, lock
        # Another process took it for one that was left, between the two lines above.
        lock.close()
    raise FileExistsError(f"no staging folder could be kept in `{parent}`")


def _taken(lock: IO[bytes], folder: Path) -> bool:
    if not _CAN_LOCK:
        return True
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        # A file system without locks: nobody may take the folder for one that is left.
        (folder / _LOCK).unlink()
        return True
    return os.fstat(lock.fileno()).st_nlink > 0
