"""The design that a configuration file asks for."""

from __future__ import annotations

from typing import Any, Literal, cast

from pydantic import model_validator

from fpsolve.cli.config.description import Description, named_section
from fpsolve.cli.config.kinds import OutputSection
from fpsolve.cli.config.sections import Section
from fpsolve.model.process import Process
from fpsolve.studies.design.task import task_of

__all__ = ["BoundsSection", "DesignConfig", "DesignSection"]

_Numbers = tuple[float, ...]
_Pair = tuple[float, float] | None
_Names = tuple[
    Literal[
        "noise",
        "sigma1",
        "sigma2",
        "speed_ratio",
        "spacing",
        "titer",
        "relaxation_length",
    ],
    ...,
]


class DesignSection(Section):
    """What is asked of a web; see `fpsolve.studies.design_web`.

    `zones` are sides of squares whose variation is minimised; with `largest`, a CV for
    each, they are bounds that are met at the least `cost`.
    """

    spacing: float
    titer: float
    zones: _Numbers
    largest: _Numbers | None = None
    free: _Names
    positions: Literal["regular", "random"] = "regular"
    cost: Literal["throughput", "positions", "fineness"] = "throughput"
    tolerance: float = 2e-2
    front: int = 0
    n_webs: int = 12
    seed: int = 1

    @model_validator(mode="after")
    def _check_bounds(self) -> DesignSection:
        if self.largest is not None and len(self.largest) != len(self.zones):
            raise ValueError(
                f"`largest` must hold a CV for each of the {len(self.zones)} zones, "
                f"got {len(self.largest)}."
            )
        return self

    @property
    def asked(self) -> Any:
        """Zones, or pairs of a zone and its largest CV."""
        if self.largest is None:
            return list(self.zones)
        return [list(pair) for pair in zip(self.zones, self.largest, strict=True)]


class BoundsSection(Section):
    """Lowest and highest value of free parameters."""

    noise: _Pair = None
    sigma1: _Pair = None
    sigma2: _Pair = None
    speed_ratio: _Pair = None
    spacing: _Pair = None
    titer: _Pair = None
    relaxation_length: _Pair = None


class DesignConfig(Description):
    """A design: `process`, what is asked of its web, and bounds."""

    design: DesignSection
    bounds: BoundsSection = BoundsSection()
    output: OutputSection = OutputSection(name="design")

    @model_validator(mode="after")
    def _check_process(self) -> DesignConfig:
        if self.process is None:
            raise ValueError(
                "the section [process] must be given, got [potential] and [model]; a "
                "design has a base weight in g/m²."
            )
        return self

    def build(self) -> tuple[Process, dict[str, Any]]:
        """Return the process, and the other arguments of `design_web`.

        Raises
        ------
        ConfigurationError
            If they do not fit each other.
        """
        with named_section("process"):
            process = cast(Process, cast(Section, self.process).make())
        asked = self.design.model_dump(exclude={"zones", "largest"})
        asked |= {
            "target": self.design.asked,
            "bounds": self.bounds.model_dump(exclude_none=True),
        }
        with named_section("design"):
            task_of(process, **asked)
        return process, asked
