"""Runs described in TOML files."""

from fpsolve.config.examples import EXAMPLES, example_path
from fpsolve.config.reading import load_config, read_config
from fpsolve.config.run import Problem, RunConfig

__all__ = [
    "EXAMPLES",
    "Problem",
    "RunConfig",
    "example_path",
    "load_config",
    "read_config",
]
