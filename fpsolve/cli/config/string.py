"""The fibre in the air that a configuration file asks for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from pydantic import model_validator

from fpsolve._support.checks import check_integer, check_non_negative
from fpsolve.cli.config.description import Written, named_section
from fpsolve.cli.config.kinds import OutputSection
from fpsolve.cli.config.sections import Section, section
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.ends import Belt, Free, Nozzle
from fpsolve.fibre.string import String
from fpsolve.fibre.turbulent_force import TurbulentForce

__all__ = ["StringConfig", "StringProblem"]

_Vector = tuple[float, float, float]

if TYPE_CHECKING:
    # The sections are made when this module is loaded; checkers know what they share.
    BeltSection: TypeAlias = Section
    NozzleSection: TypeAlias = Section
    TurbulenceSection: TypeAlias = Section
else:
    BeltSection, NozzleSection = section(Belt), section(Nozzle)
    TurbulenceSection = section(TurbulentForce)


class FibreSection(Section):
    """The fibre that hangs from the nozzle at the beginning; SI units."""

    length: float
    diameter: float
    density: float
    youngs_modulus: float
    n_edges: int
    gravity: _Vector = (0.0, 0.0, -9.81)


class AirSection(Section):
    """The air: the same everywhere, or of a `file` that a CFD code has exported."""

    velocity: _Vector | None = None
    file: str | None = None
    density: float = 1.2
    viscosity: float = 1.5e-5
    k: float | None = None
    dissipation: float | None = None

    @model_validator(mode="after")
    def _check_source(self) -> AirSection:
        if (self.velocity is None) == (self.file is None):
            raise ValueError(
                "one of `velocity` and `file` must be given; remove or add one of them."
            )
        return self

    def make(self, **others: Any) -> AirFlow:
        """The flow.

        Raises
        ------
        ValueError
            If a number is out of its range, or the file holds no flow.
        FileNotFoundError
            If there is no such file.
        """
        given = self.model_dump(exclude={"velocity", "file"}, exclude_none=True)
        if self.velocity is not None:
            return AirFlow(velocity=self.velocity, **given)
        return AirFlow.from_file(Path(str(self.file)), **given)


class StepsSection(Section):
    """How long to spin, in which steps, and what to keep; see `fibre.lay_down`.

    `skip` is the length of fibre at the beginning that the curve on the belt is
    without. A seed that is not given is 0.
    """

    t_end: float
    n_steps: int
    theta: float = 0.6
    save_every: int | None = None
    skip: float = 0.0
    seed: int = 0
    estimate_error: bool = False

    @model_validator(mode="after")
    def _check_numbers(self) -> StepsSection:
        check_non_negative("skip", self.skip)
        check_integer("seed", self.seed, at_least=0)
        return self


class StringProblem(NamedTuple):
    """What `fibre.lay_down` needs: ``lay_down(string, **arguments)``."""

    string: String
    arguments: dict[str, Any]


class StringConfig(Written):
    """A fibre spun from a nozzle: `fibre`, `nozzle`, `steps`; `belt`, `air`, …"""

    fibre: FibreSection
    nozzle: NozzleSection
    belt: BeltSection | None = None
    air: AirSection | None = None
    turbulence: TurbulenceSection | None = None
    steps: StepsSection
    output: OutputSection = OutputSection(name="string")

    def build(self) -> StringProblem:
        """Return the fibre and the other arguments of `lay_down`.

        Raises
        ------
        ConfigurationError
            If sections do not fit each other, or nothing can be made of one.
        """
        arguments = self.steps.model_dump(exclude={"skip", "seed"}, exclude_none=True)
        with named_section("nozzle"):
            nozzle = self.nozzle.make()
        with named_section("fibre"):
            string = String(**self.fibre.model_dump(), start=nozzle, end=Free())
        for name in ("belt", "air", "turbulence"):
            part = getattr(self, name)
            if part is not None:
                with named_section(name):
                    arguments[name] = part.make()
        if self.turbulence is not None:
            arguments["seed"] = self.steps.seed
        return StringProblem(string, arguments)
