"""Runs and samplings described in TOML files."""

from fpsolve.config.examples import EXAMPLES, PATHS_EXAMPLE, example_path
from fpsolve.config.paths import PathsConfig, PathsProblem
from fpsolve.config.reading import load_config, read_config
from fpsolve.config.run import Problem, RunConfig

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
