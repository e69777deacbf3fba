"""The state of a pass at a record, in two files that are written in turn."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.durable import opened_npz, write_durably
from fpsolve._support.json_text import bounded_json
from fpsolve.density.keeper import Snapshot

__all__ = ["SnapshotFiles"]


_SLOTS = ("a", "b")
# Prefix of the arrays of a state among the members of a file.
_ARRAY = "state_"


class SnapshotFiles:
    """The two files of a pass: the newest checkpoint and the one before it.

    Each is an .npz, whose members carry a checksum, and is renamed to its place when
    it is on the disk. The newer one is never touched while the next is written.

    Parameters
    ----------
    folder : Path
    name : str
        Name of the pass.
    run : str
        Digest of the run that the files must belong to.
    """

    def __init__(self, folder: Path, name: str, run: str) -> None:
        self.paths = [folder / f"{name}-{slot}.npz" for slot in _SLOTS]
        self.run = run
        self.number, self.newest = 0, self.paths[1]

    @property
    def next_path(self) -> Path:
        """The file that the next snapshot takes the place of."""
        return self.paths[1 - self.paths.index(self.newest)]

    def write(self, snapshot: Snapshot) -> None:
        """Write a snapshot in the place of the older one."""
        path = self.next_path
        kept = {
            name: value
            for name, value in vars(snapshot).items()
            if name not in ("state", "records")
        }
        plain, arrays = _split(snapshot.state)
        about = {
            **kept,
            "state": plain,
            "arrays": list(arrays),
            "run": self.run,
            "number": self.number + 1,
        }
        members: dict[str, Any] = {
            "about": np.array(json.dumps(about)),
            "records": snapshot.records,
            **{_ARRAY + name: values for name, values in arrays.items()},
        }
        write_durably(path, lambda file: np.savez(file, **members))
        self.number, self.newest = self.number + 1, path

    def read(self) -> Iterator[Snapshot]:
        """Yield what can be read, the newest first; damage is a warning.

        The run goes on from the one that is taken last: the other file is written
        next.
        """
        for number, path, _ in sorted(self._abouts(), reverse=True):
            with _told(path):
                snapshot = self._read(path)
                self.number, self.newest = number, path
                yield snapshot

    def clear(self) -> None:
        """Remove both: the pass begins anew."""
        for path in self.paths:
            path.unlink(missing_ok=True)
        self.number, self.newest = 0, self.paths[1]

    def reached(self) -> tuple[int, float] | None:
        """Step and arclength of the newest one, without reading its arrays."""
        _, _, place = max(self._abouts(), default=(0, None, None))
        return place

    def _abouts(self) -> Iterator[tuple[int, Path, tuple[int, float]]]:
        """Number, path, and step and arclength of each one that can be read."""
        for path in self.paths:
            if path.exists():
                with _told(path):
                    yield self._about(path)

    def _about(self, path: Path) -> tuple[int, Path, tuple[int, float]]:
        with opened_npz(path) as members:
            about = bounded_json("about", str(members["about"]))
        number, step, s = (about[name] for name in ("number", "step", "s"))
        if not all(isinstance(one, int | float) for one in (number, step, s)):
            raise ValueError("it does not say where it is")
        return number, path, (step, s)

    def _read(self, path: Path) -> Snapshot:
        with opened_npz(path) as members:
            about = bounded_json("about", str(members["about"]))
            if about.pop("run") != self.run:
                raise ValueError("it belongs to another run")
            del about["number"]
            state = about.pop("state")
            for name in about.pop("arrays"):
                state[name] = members[_ARRAY + name]
            about["columns"] = tuple(about["columns"])
            about["seconds"] = tuple(about["seconds"])
            return Snapshot(records=members["records"], state=state, **about)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turn damage into a warning."""
    # It makes zipfile, json and numpy raise whatever they come across.
    try:
        yield
    except Exception as error:
        reason = str(error).rstrip(".") or type(error).__name__
        message = f"checkpoint `{path}` is damaged and not used: {reason}"
    else:
        return
    warnings.warn(message, UserWarning, stacklevel=2)


def _split(state: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Array]]:
    """Separate numbers from arrays."""
    arrays = {name: v for name, v in state.items() if isinstance(v, np.ndarray)}
    plain = {name: v for name, v in state.items() if name not in arrays}
    return {name: _plain(value) for name, value in plain.items()}, arrays


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value
