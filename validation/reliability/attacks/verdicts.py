"""What a case wrote down about itself, and the one word that sums it up."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fpsolve.errors import FpsolveError

__all__ = ["FINDINGS", "VERDICTS", "Notes", "Record", "judged"]

# The last five are findings: "warned" is a right answer beside a warning that is none
# of the project's, "leftover" a file that is neither complete nor removed.
FINDINGS = ("wrong", "traceback", "hang", "crash", "leftover", "warned")
VERDICTS = ("right", "refused", *FINDINGS)
# What the project's own messages look like: a name in backticks, a full stop.
HOUSE = re.compile(r"`[^`]+`.*[.?]$", re.DOTALL)
EXPECTED = (FpsolveError, ValueError, TypeError, OSError, ImportError)


@dataclass
class Record:
    """One case: how to repeat it, what came out, and what it cost."""

    family: str
    number: int
    verdict: str
    call: str = ""
    message: str = ""
    n_compared: int = 0
    seconds: float = 0.0

    @property
    def found(self) -> bool:
        return self.verdict in FINDINGS

    def __str__(self) -> str:
        head = f"{self.verdict}: {self.family}:{self.number} ({self.seconds:.1f} s)"
        return f"{head}\n    {self.call}\n    {self.message}"


@dataclass
class Notes:
    """What a case says while it runs: its calls, and comparisons that failed."""

    calls: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    leftovers: list[str] = field(default_factory=list)
    n_compared: int = 0

    def say(self, *words: Any) -> None:
        """Write down a call before it is made."""
        self.calls.append(" ".join(map(str, words)))

    def holds(self, claim: str, truth: Any) -> None:
        """Note whether something is so."""
        self.n_compared += 1
        if not bool(truth):
            self.failed.append(claim)

    def close(self, name: str, got: Any, expected: Any, error: Any) -> None:
        """Note whether |got − expected| ≤ error everywhere; NaN is not close."""
        got, expected = np.asarray(got), np.asarray(expected)
        self.n_compared += 1
        if got.shape != np.broadcast_shapes(got.shape, expected.shape):
            self.failed.append(f"{name}: shape {got.shape}, not {expected.shape}")
            return
        away = np.abs(got - expected)
        bad = ~(away <= error)
        if bad.any():
            worst = np.unravel_index(np.argmax(np.where(bad, away, -1.0)), away.shape)
            allowed = float(np.broadcast_to(error, away.shape)[worst])
            text = (
                f"{float(got[worst]):.10g}, not {self._at(expected, away, worst):.10g}"
            )
            self.failed.append(f"{name}: {text} ± {allowed:.2g}")

    def same(self, name: str, got: Any, expected: Any, relative: float = 1e-9) -> None:
        """Note whether two arrays agree but for rounding of the largest value."""
        size = float(np.max(np.abs(expected), initial=0.0))
        self.close(name, got, expected, relative * size)

    @staticmethod
    def _at(expected: Any, away: Any, worst: Any) -> float:
        return float(np.broadcast_to(expected, away.shape)[worst])


def judged(
    family: str, number: int, case: Callable[[Any, Notes], None], rng: Any
) -> Record:
    """Run a case and say in one word what came of it."""
    notes = Notes()
    record = Record(family, number, "right")
    try:
        record.verdict, record.message = _outcome(case, rng, notes)
    finally:
        record.call = "; ".join(notes.calls)
        record.n_compared = notes.n_compared
    return record


def _outcome(
    case: Callable[[Any, Notes], None], rng: Any, notes: Notes
) -> tuple[str, str]:
    try:
        foreign = _foreign_warnings(lambda: case(rng, notes))
    except EXPECTED as error:
        if HOUSE.search(str(error)) or isinstance(error, FpsolveError):
            # What was compared before the refusal still counts.
            verdict = "wrong" if notes.failed else "refused"
            said = f"{type(error).__name__}: {error}"
            return verdict, "; ".join([*notes.failed, said])
        return "traceback", _short(error)
    except Exception as error:
        return "traceback", _short(error)
    if notes.failed:
        return "wrong", "; ".join(notes.failed)
    if notes.leftovers:
        return "leftover", "; ".join(notes.leftovers)
    return ("warned", foreign[0]) if foreign else ("right", "")


def _foreign_warnings(do: Callable[[], Any]) -> list[str]:
    """Warnings that are none of the project's own, while doing something."""
    import warnings

    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        do()
    ours = (UserWarning,)
    return [
        f"{one.category.__name__}: {one.message} ({one.filename}:{one.lineno})"
        for one in told
        if issubclass(one.category, RuntimeWarning) or one.category not in ours
        if not issubclass(one.category, DeprecationWarning | ResourceWarning)
    ]


def _short(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)
    inside = [one for one in frames if "fpsolve" in one.filename] or list(frames)
    where = f"{inside[-1].filename}:{inside[-1].lineno}" if inside else "?"
    last = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else "?"
    return f"{type(error).__name__}: {error} (at {where}; raised at {last})"
