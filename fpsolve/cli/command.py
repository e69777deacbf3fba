"""The command that made a file, as one can type it again."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from fpsolve.cli.potentials import PARAMETERS

__all__ = ["command_line"]


def command_line(name: str, *arguments: str, **options: Any) -> dict[str, str]:
    """Return the attribute `command`: a command with its options, defaults resolved.

    Where it was computed and where it was written are left out.

    Parameters
    ----------
    name : str
    *arguments : str
    **options
        By their names on the command line, with `_` for `-`; None and False are not
        shown, of several values each comes with its own option, and so does each
        parameter of a potential.
    """
    words = ["fpsolve", name, *arguments]
    for option, value in options.items():
        words += _words(f"--{option.replace('_', '-')}", value)
    return {"command": shlex.join(words)}


def _words(option: str, value: Any) -> list[str]:
    if value is None or value is False:
        return []
    if value is True:
        return [option]
    if hasattr(value, "to_dict"):
        return [option, value.kind, *_parameters(value.to_dict())]
    if isinstance(value, str) or not isinstance(value, Iterable):
        return [option, _text(value)]
    return [word for one in value for word in (option, _text(one))]


def _parameters(described: dict[str, Any]) -> list[str]:
    """Those parameters of a potential that are options of the command line."""
    own = sorted(asdict(PARAMETERS).keys() & described.keys())
    return [word for name in own for word in (f"--{name}", _text(described[name]))]


def _text(value: Any) -> str:
    return repr(float(value)) if isinstance(value, float) else str(value)
