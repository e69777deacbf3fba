"""A command line called in this process, and what every one of them owes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from typer.testing import CliRunner

import fpsolve as fp
from fpsolve.results.compare.reading import dataset_of, kind_of_dataset

__all__ = ["called", "check_files", "check_manners", "everything"]

CODES = (0, 1, 2)
DRAFTS = (".draft", ".partial", ".tmp")


def called(notes: Any, words: list[str]) -> Any:
    """Run a command; the result has exit_code, stdout, stderr and exception."""
    from fpsolve.cli import app

    notes.say(
        "$ fpsolve",
        *(
            repr(word) if not word.isascii() or " " in word or not word else word
            for word in words
        ),
    )
    done = CliRunner().invoke(app, words, prog_name="fpsolve")
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise ForeignError(done.exception) from done.exception
    return done


class ForeignError(Exception):
    """What a command did not turn into one line of error."""

    def __init__(self, error: BaseException) -> None:
        super().__init__(f"{type(error).__name__}: {error}")


def check_manners(notes: Any, done: Any) -> None:
    """Exit code 0, 1 or 2; no traceback; one line of error unless it is 0."""
    notes.holds(f"exit code {done.exit_code}", done.exit_code in CODES)
    notes.holds("no traceback", "Traceback" not in done.output)
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    usage = "Usage:" in done.output
    if done.exit_code == 2:
        notes.holds(
            f"one line of error, got {done.stderr[-400:]!r}", len(errors) == 1 or usage
        )
    if done.exit_code == 0:
        notes.holds(f"no error beside exit code 0: {errors}", not errors)
    for line in errors:
        house = (line.rstrip().endswith((".", "?")) and "`" in line) or "[" in line
        notes.holds(f"house wording: {line[:300]}", house or "interrupted" in line)


def check_files(notes: Any, done: Any) -> dict[str, Any]:
    """Everything that was left is whole; results by their names."""
    found: dict[str, Any] = {}
    for path in sorted(Path().rglob("*")):
        inside = [parent.suffix for parent in path.parents]
        if ".zarr" in inside or "rate-cases" in str(path) or ".checkpoint" in inside:
            continue
        if path.name.endswith(DRAFTS) or (
            path.name.startswith(".") and path.name != "."
        ):
            notes.leftovers.append(f"{path} is left")
        if path.suffix in (".nc", ".zarr"):
            try:
                found[str(path)] = result_in(path)
            except Exception as error:
                notes.leftovers.append(f"{path}: {type(error).__name__}: {error}")
        elif path.is_file() and not path.stat().st_size and path.suffix != ".lock":
            notes.leftovers.append(f"{path} is empty")
    if done.exit_code == 2:
        notes.holds(f"nothing is written: {sorted(found)}", not found)
    return found


def result_in(path: Path) -> Any:
    """A solution or paths as such, a study as its dataset."""
    dataset = dataset_of(path, "path")
    if kind_of_dataset(dataset, "path") in ("solution", "paths"):
        return fp.load(path)
    return dataset.load()


def everything() -> set[str]:
    """Names of all files below the folder."""
    return {str(path) for path in Path().rglob("*")}
