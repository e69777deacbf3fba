"""The paths that a configuration file asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from pydantic import model_validator

from fpsolve._support.checks import check_integer
from fpsolve.cli.config.description import Description, named_section
from fpsolve.cli.config.kinds import VARIANCE, GridSection, OutputSection, SpanSection
from fpsolve.cli.config.sections import Section, one_of, section
from fpsolve.model.fibre import FibreModel
from fpsolve.paths.laws import EquilibriumLaw, GaussianLaw, PointLaw

__all__ = ["PathsConfig", "PathsProblem", "PathsSection", "StartSection"]

if TYPE_CHECKING:
    # Made when this module is loaded; checkers know what they share.
    StartSection: TypeAlias = Section
else:
    StartSection = one_of(
        section(PointLaw, "point"),
        section(GaussianLaw, "gaussian", VARIANCE),
        section(EquilibriumLaw, "equilibrium"),
    )


class PathsSection(SpanSection):
    """How many paths, how far, and what to keep; see `fpsolve.sample_paths`.

    A seed that is not given is drawn, shown, and written down with the result.
    """

    ds: float
    n_paths: int
    seed: int | None = None
    method: Literal["splitting", "euler_maruyama", "heun"] = "splitting"
    keep: bool = True

    @model_validator(mode="after")
    def _check_numbers(self) -> PathsSection:
        check_integer("n_paths", self.n_paths, at_least=1)
        if self.seed is not None:
            check_integer("seed", self.seed, at_least=0)
        return self


class HistogramSection(GridSection):
    """Cells in which paths are counted while they are sampled."""

    shape: tuple[int, int, int] = (64, 64, 32)


class PathsProblem(NamedTuple):
    """What `sample_paths` needs: ``sample_paths(model, **arguments)``."""

    model: FibreModel
    arguments: dict[str, Any]


class PathsConfig(Description):
    """Sampled paths: `potential`, `model` and `curve`, or `process`; then how many.

    Without a section `start` all paths begin at ξ = 0 with a uniform angle.
    """

    start: StartSection | None = None
    paths: PathsSection
    histogram: HistogramSection | None = None
    output: OutputSection = OutputSection()

    def build(self) -> PathsProblem:
        """Return the model and the arguments of `sample_paths`.

        Raises
        ------
        ConfigurationError
            If sections do not fit each other.
        """
        model = self.build_model()
        arguments = {
            **self.paths.model_dump(exclude={"save_every"}),
            "initial": self._law(model),
            "save_at": self.paths.saves(),
        }
        if self.paths.seed is None:
            arguments["seed"] = int(np.random.SeedSequence().generate_state(1)[0])
        if self.histogram is not None:
            with named_section("histogram"):
                arguments["histogram"] = self.histogram.make()
        return PathsProblem(model, arguments)

    def resolved(self, problem: PathsProblem) -> PathsConfig:
        """Return the configuration with the seed of `problem` in it."""
        return self.changed("paths", seed=problem.arguments["seed"])

    def _law(self, model: FibreModel) -> Any:
        if self.start is None:
            return PointLaw()
        with named_section("start"):
            return self.start.make(potential=model.potential)
