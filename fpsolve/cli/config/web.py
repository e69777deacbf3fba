"""The web that a configuration file asks for."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, cast

import numpy as np
from pydantic import model_validator

from fpsolve._support.checks import check_integer, check_positive
from fpsolve.cli.config.description import Description, named_section
from fpsolve.cli.config.kinds import OutputSection
from fpsolve.cli.config.sections import Section
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.web.lay_web import check_pixels
from fpsolve.web.order import Order, order_of
from fpsolve.web.window import Window

__all__ = ["WebConfig", "WebProblem", "WebSection"]

_Numbers = tuple[float, ...]
# Keys that say what is done with a web that is laid.
_AFTERWARDS = {"zones", "exports"}


class WebSection(Section):
    """The window, the spinning positions and the fibre; see `fpsolve.lay_web`.

    Lengths are metres beside [process], else in throwing ranges. `zones` are the sides
    of squares whose variation is printed, `exports` further files that are written. A
    seed that is not given is drawn, shown, and written down with the result.
    """

    width: float
    length: float
    pixel: float
    spacing: float | None = None
    positions: Literal["regular", "random"] | _Numbers = "regular"
    phases: Literal["independent", "in phase"] | _Numbers = "independent"
    ds: float | None = None
    seed: int | None = None
    periodic: bool = False
    titer: float | None = None
    zones: _Numbers | None = None
    exports: tuple[Literal["png", "tiff", "vtp", "csv"], ...] = ()

    @model_validator(mode="after")
    def _check_numbers(self) -> WebSection:
        Window.of(self.width, self.length, self.pixel)
        if self.seed is not None:
            check_integer("seed", self.seed, at_least=0)
        longest = min(self.width, self.length)
        for zone in self.zones or ():
            if not self.pixel <= check_positive("zones", zone) <= longest:
                raise ValueError(
                    f"`zones` must lie between `pixel` = {self.pixel:g} and the "
                    f"shorter side of the window, {longest:g}, got {zone:g}."
                )
        return self

    @property
    def window(self) -> Window:
        """The window, in the unit of the file."""
        return Window.of(self.width, self.length, self.pixel)


class WebProblem(NamedTuple):
    """What `lay_web` needs: ``lay_web(model, **arguments)``; the order says more."""

    model: FibreModel | Process
    arguments: dict[str, Any]
    order: Order


class WebConfig(Description):
    """A web: `potential`, `model` and `curve`, or `process`; then what of it."""

    web: WebSection
    output: OutputSection = OutputSection(name="web")

    def build(self) -> WebProblem:
        """Return the model, the arguments of `lay_web`, and what they come to.

        Raises
        ------
        ConfigurationError
            If sections do not fit each other, or no web can be made of them.
        MemoryLimitError
            If the pixels would not fit into memory.
        """
        model = self.laid_model()
        with named_section("web"):
            check_pixels(self.web.window, None)
            arguments = self.web.model_dump(exclude=_AFTERWARDS)
            if self.web.seed is None:
                arguments["seed"] = int(np.random.SeedSequence().generate_state(1)[0])
            order = order_of(model, **arguments)
        return WebProblem(model, arguments, order)

    def resolved(self, problem: WebProblem) -> WebConfig:
        """Return the configuration with the seed of `problem` in it."""
        return self.changed("web", seed=problem.arguments["seed"])

    def laid_model(self) -> FibreModel | Process:
        """Return the model, or the process whose lengths are metres."""
        if self.process is None:
            return self.build_model()
        with named_section("process"):
            return cast(Process, self.process.make())
