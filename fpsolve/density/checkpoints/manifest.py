"""run.json: which run a checkpoint is of, written once, when its folder is made."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from fpsolve._support.durable import write_durably
from fpsolve._support.json_text import bounded_json
from fpsolve._support.provenance import versions
from fpsolve.errors import FileFormatError

__all__ = ["FORMAT", "MANIFEST", "Manifest", "read_manifest"]

# Number of the layout of the folder; raised whenever an older version could misread it.
FORMAT = 1
MANIFEST = "run.json"
_ABOUT = "Checkpoint of a run of fpsolve. Go on with `fpsolve resume FOLDER`."
_NEEDED = ("run", "every", "notes", "versions", "checksum")


@dataclass(frozen=True)
class Manifest:
    """The run, how often its checkpoints are written, and the caller's notes.

    `run` is what `fpsolve.density.checkpoints.identity.identified` says of it.
    """

    run: Mapping[str, Any]
    every: int | str
    notes: Mapping[str, str]
    versions: Mapping[str, str]

    def write(self, folder: Path) -> None:
        """Write it; from then on the folder is a checkpoint."""
        content = {
            "about": _ABOUT,
            "fpsolve_checkpoint": FORMAT,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
            "versions": dict(self.versions),
            "every": self.every,
            "run": self.run,
            "notes": dict(self.notes),
        }
        content["checksum"] = _checksum(content)
        text = json.dumps(content, indent=1, ensure_ascii=False)
        write_durably(folder / MANIFEST, lambda file: file.write(text.encode()))

    def warn_of_other_versions(self, folder: Path) -> None:
        """Warn if the run began with other versions: bits may differ from here on."""
        now = versions()
        other = [
            f"{name} {old}, now {now[name]}"
            for name, old in self.versions.items()
            if name in now and now[name] != old
        ]
        if other:
            warnings.warn(
                f"checkpoint `{folder}` was begun with {'; '.join(other)}: the result "
                "may differ in its last bits from an uninterrupted run",
                UserWarning,
                stacklevel=4,
            )


def read_manifest(folder: Path) -> Manifest:
    """Return what run.json says.

    Raises
    ------
    FileNotFoundError
        If there is no such folder.
    FileFormatError
        If it is not a checkpoint, of a newer layout, or changed by hand.
    """
    path = folder / MANIFEST
    if not folder.exists():
        raise FileNotFoundError(
            f"`directory` must be the folder of a checkpoint, got `{folder}`, which "
            "does not exist."
        )
    if not path.is_file():
        raise FileFormatError(
            folder, f"it is not a checkpoint of fpsolve (it holds no `{MANIFEST}`)"
        )
    try:
        content = bounded_json(MANIFEST, path.read_text(encoding="utf-8"))
        written = int(content["fpsolve_checkpoint"])
    except (ValueError, KeyError, TypeError, OverflowError):
        raise FileFormatError(path, "it does not describe a checkpoint") from None
    if written > FORMAT:
        raise FileFormatError(
            path,
            f"it has layout {written}, this version of fpsolve reads up to {FORMAT}; "
            "update fpsolve",
        )
    return _checked(path, content)


def _checked(path: Path, content: Mapping[str, Any]) -> Manifest:
    missing = [f"`{name}`" for name in _NEEDED if name not in content]
    if missing:
        raise FileFormatError(path, f"{', '.join(missing)} is missing in it")
    run = content["run"]
    if not (isinstance(run, dict) and run.keys() >= {"scheme", "p0", "s_span", "ds"}):
        raise FileFormatError(path, "its `run` is not that of a run")
    if content["checksum"] != _checksum(content):
        raise FileFormatError(path, "it was changed after it was written")
    return Manifest(run, content["every"], content["notes"], content["versions"])


def _checksum(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of all entries but this one."""
    covered = {name: one for name, one in content.items() if name != "checksum"}
    text = json.dumps(covered, sort_keys=True, ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()
