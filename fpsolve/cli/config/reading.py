"""Configuration files and packaged examples, and what is said about wrong ones."""

from __future__ import annotations

import os
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar, overload

from pydantic import ValidationError

from fpsolve._support.checks import check_path
from fpsolve.cli.config.complaints import complaints, suggestion
from fpsolve.cli.config.description import Written
from fpsolve.cli.config.run import RunConfig
from fpsolve.errors import ConfigurationError

__all__ = [
    "DESIGN_EXAMPLE",
    "EXAMPLES",
    "PATHS_EXAMPLE",
    "STRING_EXAMPLE",
    "WEB_EXAMPLE",
    "check_config",
    "example_path",
    "load_config",
    "read_config",
]

T = TypeVar("T", bound=Written)

# What `fpsolve run` can solve, `fpsolve paths` samples, `fpsolve web` lays,
# `fpsolve design` improves, and `fpsolve string` spins.
EXAMPLES = ("laydown", "spunbond")
PATHS_EXAMPLE = "fibres"
WEB_EXAMPLE = "web"
DESIGN_EXAMPLE = "design"
STRING_EXAMPLE = "string"


@overload
def load_config(path: str | os.PathLike[str]) -> RunConfig: ...


@overload
def load_config(path: str | os.PathLike[str], kind: type[T]) -> T: ...


def load_config(
    path: str | os.PathLike[str], kind: type[Written] = RunConfig
) -> Written:
    """Read and check a TOML file that describes a run.

    Parameters
    ----------
    path : str or os.PathLike
    kind : type, optional
        RunConfig, PathsConfig for sampled paths, WebConfig for a web, DesignConfig, or
        StringConfig.

    Raises
    ------
    ConfigurationError
        If there is no such file, it is not TOML, or it asks for something that does
        not exist or does not fit. The message names the section, the key, and the
        nearest valid name.
    """
    path = check_path("config", path)
    return read_config(_text(path), f"configuration `{path}`", kind=kind)


@overload
def read_config(text: str, source: str = "configuration") -> RunConfig: ...


@overload
def read_config(text: str, source: str = ..., *, kind: type[T]) -> T: ...


def read_config(
    text: str, source: str = "configuration", *, kind: type[Written] = RunConfig
) -> Written:
    """Check a configuration given as TOML text.

    Parameters
    ----------
    text : str
    source : str, optional
        What messages call it.
    kind : type, optional
        As for `load_config`.

    Raises
    ------
    ConfigurationError
        As for `load_config`.
    """
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        reason = str(error).rstrip(".")
        raise ConfigurationError(f"{source} is not valid TOML: {reason}.") from None
    return check_config(_with_tuples(tables), source, kind)


def check_config(tables: dict[str, Any], source: str, kind: type[T]) -> T:
    """Check a configuration given as tables by their names, tuples for lists.

    Parameters
    ----------
    tables : dict
    source : str
        What messages call it.
    kind : type
        As for `load_config`.

    Raises
    ------
    ConfigurationError
        As for `load_config`.
    """
    try:
        return kind.model_validate(tables)
    except ValidationError as error:
        lines = "\n".join(complaints(error, kind))
        raise ConfigurationError(f"{source}, {lines}") from None


def example_path(name: str) -> Path:
    """Return the TOML file of a packaged example.

    Parameters
    ----------
    name : {"laydown", "spunbond", "fibres", "web", "design", "string"}
        B = ‖ξ‖²/2 with A = 1, a spunbond process in SI units, paths on a belt, the
        web of a spunbond process, what is asked of its design, or a fibre in the air.

    Raises
    ------
    ConfigurationError
        If there is no such example.
    """
    others = (PATHS_EXAMPLE, WEB_EXAMPLE, DESIGN_EXAMPLE, STRING_EXAMPLE)
    if name not in (*EXAMPLES, *others):
        raise ConfigurationError(
            f"`example` must be one of {', '.join(EXAMPLES)}, got {name!r}"
            f"{suggestion(name, EXAMPLES)}"
        )
    return Path(str(files("fpsolve") / "examples" / f"{name}.toml"))


def _text(path: Path) -> str:
    if path.is_dir():
        raise ConfigurationError(
            f"`config` must be a TOML file, got the folder `{path}`; name a file in it."
        )
    try:
        # Some editors begin a file with a byte order mark.
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise ConfigurationError(
            f"`config` must be an existing TOML file, got `{path}`; leave it out to "
            "run the packaged example."
        ) from None
    except UnicodeDecodeError:
        raise ConfigurationError(
            f"configuration `{path}` is not valid TOML: it is not text in UTF-8."
        ) from None
    except OSError as error:
        raise ConfigurationError(
            f"configuration `{path}` cannot be read: {error.strerror}."
        ) from None


def _with_tuples(value: Any) -> Any:
    """Return the value with tuples for lists, as constructors want them."""
    if isinstance(value, dict):
        return {key: _with_tuples(entry) for key, entry in value.items()}
    return tuple(map(_with_tuples, value)) if isinstance(value, list) else value
