"""Runs and samplings described in TOML files."""

from fpsolve.cli.config.paths import PathsConfig, PathsProblem
from fpsolve.cli.config.reading import (
    EXAMPLES,
    PATHS_EXAMPLE,
    example_path,
    load_config,
    read_config,
)
from fpsolve.cli.config.run import Problem, RunConfig

__all__ = [
    "EXAMPLES",
    "PATHS_EXAMPLE",
    "PathsConfig",
    "PathsProblem",
    "Problem",
    "RunConfig",
    "example_path",
    "load_config",
    "read_config",
]
