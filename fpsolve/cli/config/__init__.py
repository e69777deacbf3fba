"""Runs, samplings, webs, designs and strings described in TOML files."""

from fpsolve.cli.config.design import DesignConfig
from fpsolve.cli.config.paths import PathsConfig, PathsProblem
from fpsolve.cli.config.reading import (
    DESIGN_EXAMPLE,
    EXAMPLES,
    PATHS_EXAMPLE,
    STRING_EXAMPLE,
    WEB_EXAMPLE,
    check_config,
    example_path,
    load_config,
    read_config,
)
from fpsolve.cli.config.run import Problem, RunConfig
from fpsolve.cli.config.string import StringConfig, StringProblem
from fpsolve.cli.config.web import WebConfig, WebProblem

__all__ = [
    "DESIGN_EXAMPLE",
    "EXAMPLES",
    "PATHS_EXAMPLE",
    "STRING_EXAMPLE",
    "WEB_EXAMPLE",
    "DesignConfig",
    "PathsConfig",
    "PathsProblem",
    "Problem",
    "RunConfig",
    "StringConfig",
    "StringProblem",
    "WebConfig",
    "WebProblem",
    "check_config",
    "example_path",
    "load_config",
    "read_config",
]
