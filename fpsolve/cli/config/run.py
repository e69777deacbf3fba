"""The run that a configuration file describes."""

from __future__ import annotations

from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.memory import check_memory, required_memory
from fpsolve.cli.config.description import Description, named_section
from fpsolve.cli.config.kinds import (
    GridSection,
    InitialSection,
    OutputSection,
    RunSection,
    SchemeSection,
)
from fpsolve.density.suggestions import SuggestedStep, suggest_step
from fpsolve.grids.initial import gaussian
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.suggested_grid import suggest_grid

__all__ = ["Problem", "RunConfig"]

# Initial density, unknown and scratch.
_FEWEST_ARRAYS = 3


class Problem(NamedTuple):
    """What `solve` needs: ``solve(scheme, p0, **arguments)``."""

    model: LayDownModel
    grid: PhaseSpaceGrid
    p0: NDArray[np.float64]
    scheme: Any
    arguments: dict[str, Any]


class RunConfig(Description):
    """A whole run: `potential`, `model` and `curve`, or `process`; then how to solve.

    Without a grid or a step they are chosen by `suggest_grid` and `suggest_step` for
    the tolerance of the run; their `reason` says why.
    """

    grid: GridSection | None = None
    initial: InitialSection
    scheme: SchemeSection
    run: RunSection
    output: OutputSection = OutputSection()

    def build(self, saved_in_memory: bool = True) -> Problem:
        """Return model, grid, initial density, scheme and the arguments of `solve`.

        Parameters
        ----------
        saved_in_memory : bool
            Count the memory that saved densities take; they take none in a run with
            checkpoints.

        Raises
        ------
        ConfigurationError
            If sections do not fit each other.
        MemoryLimitError
            If the densities alone would not fit into memory.
        """
        # Grids and schemes refuse another kind.
        model = cast(LayDownModel, self.build_model())
        with named_section("grid"):
            grid = self._grid(model)
        self._check_memory(grid, saved_in_memory)
        with named_section("initial"):
            p0 = self.initial.make(grid=grid, potential=model.potential)
        with named_section("scheme"):
            scheme = self.scheme.make(grid=grid, model=model)
        with named_section("run"):
            arguments = self._arguments(model, grid)
        return Problem(model, grid, p0, scheme, arguments)

    def resolved(self, problem: Problem) -> RunConfig:
        """Return the configuration with the grid and the step of `problem` in it.

        They are there already unless they were suggested.
        """
        grid = {"half_width": problem.grid.half_width, "shape": problem.grid.shape}
        run = {**self.run.model_dump(), "ds": float(problem.arguments["ds"])}
        tables = {**self.model_dump(exclude_none=True), "grid": grid, "run": run}
        return RunConfig.model_validate(tables)

    def _grid(self, model: LayDownModel) -> PhaseSpaceGrid:
        if self.grid is None:
            return suggest_grid(
                model, self.run.tolerance, initial=self._law(), s_end=self.run.s_end
            )
        return cast(PhaseSpaceGrid, self.grid.make())

    def _law(self) -> GaussianLaw | None:
        """The law of the start, which a suggested box is to hold."""
        if type(self.initial).target is not gaussian:
            return None
        return GaussianLaw(**self.initial.model_dump(exclude={"kind"}))

    def _check_memory(self, grid: PhaseSpaceGrid, saved_in_memory: bool) -> None:
        # `solve` knows how much a scheme needs, but by then the initial density is
        # made already, and tables as large as the grid.
        n_saved = len(self.run.saves()) if saved_in_memory else 0
        check_memory(
            required_memory(grid.nbytes, _FEWEST_ARRAYS, n_saved, self.run.extrapolate)
        )

    def _arguments(self, model: LayDownModel, grid: PhaseSpaceGrid) -> dict[str, Any]:
        run, ds = self.run, self.run.ds
        if ds is None:
            suggested = suggest_step(model, grid, run.tolerance)
            ds = SuggestedStep(run.step(suggested), suggested.reason)
            run.check_schedule(ds)
        arguments: dict[str, Any] = {
            "s_span": (0.0, run.s_end),
            "ds": ds,
            "save_at": run.saves(),
            "record_every": run.record_every,
            "extrapolate": run.extrapolate,
        }
        return arguments | run.tolerances()
