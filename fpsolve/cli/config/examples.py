"""The examples that come with the package."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from fpsolve.cli.config.names import suggestion
from fpsolve.errors import ConfigurationError

__all__ = ["EXAMPLES", "PATHS_EXAMPLE", "example_path"]

# What `fpsolve run` can solve, and what `fpsolve paths` samples.
EXAMPLES = ("laydown", "spunbond")
PATHS_EXAMPLE = "fibres"


def example_path(name: str) -> Path:
    """Return the TOML file of a packaged example.

    Parameters
    ----------
    name : {"laydown", "spunbond", "fibres"}
        B = ‖ξ‖²/2 with A = 1, a spunbond process in SI units, or paths on a belt.

    Raises
    ------
    ConfigurationError
        If there is no such example.
    """
    if name not in (*EXAMPLES, PATHS_EXAMPLE):
        raise ConfigurationError(
            f"`example` must be one of {', '.join(EXAMPLES)}, got {name!r}"
            f"{suggestion(name, EXAMPLES)}"
        )
    return Path(str(files("fpsolve") / "examples" / f"{name}.toml"))
