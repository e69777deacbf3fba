"""What a row of the tables is, and what every message has in common."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest


@dataclass(frozen=True)
class Case:
    """A mistake and what must be said about it.

    Attributes
    ----------
    what : str
        The mistake in a few words, unique in its table.
    do : callable
        Makes it.
    value : str
        Regular expression: the value as the message names it.
    remedy : str
        Regular expression: the rule that was broken, or the way out.
    error : type
        What is raised.
    """

    what: str
    do: Callable[..., Any]
    value: str
    remedy: str
    error: type[Exception] | tuple[type[Exception], ...] = ValueError

    def __str__(self) -> str:
        return self.what


def parametrised(cases):
    """Parametrise a test by the rows of a table, and name it after what is wrong."""
    return pytest.mark.parametrize("case", cases, ids=str)


def assert_said(message: str, case: Case) -> None:
    """The message names value and remedy, and reads like the project's own."""
    assert re.search(case.value, message, re.DOTALL), message
    assert re.search(case.remedy, message, re.DOTALL), message
    assert "`" in message or "[" in message, message
    assert message.rstrip()[-1] in ".?", message
    assert "object at 0x" not in message, message
    assert "Traceback" not in message, message


# What many rows are made of.
NAN, INF = float("nan"), float("inf")
NUMBER = "must be a real number"
POSITIVE = "must be positive"
