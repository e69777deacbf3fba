"""The model of which a configuration file asks the spectrum."""

from __future__ import annotations

from fpsolve.cli.config.description import Description
from fpsolve.cli.config.kinds import (
    GridSection,
    InitialSection,
    OutputSection,
    RunSection,
    SchemeSection,
)
from fpsolve.cli.config.paths import HistogramSection, PathsSection, StartSection

__all__ = ["SpectrumConfig"]


class SpectrumConfig(Description):
    """`potential`, `model` and `curve`, or `process`: all that a generator depends on.

    The other sections of a run and of sampled paths may be there and are checked, so
    that one file serves all commands, but nothing is read from them.
    """

    grid: GridSection | None = None
    initial: InitialSection | None = None
    scheme: SchemeSection | None = None
    run: RunSection | None = None
    start: StartSection | None = None
    paths: PathsSection | None = None
    histogram: HistogramSection | None = None
    output: OutputSection | None = None
