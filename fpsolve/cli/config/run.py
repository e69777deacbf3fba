"""The run that a configuration file describes."""

from __future__ import annotations

from typing import Any, NamedTuple, cast

from fpsolve._support.arrays import Array
from fpsolve._support.memory import check_memory, required_memory
from fpsolve.cli.config.description import Description, named_section
from fpsolve.cli.config.kinds import (
    AUTOMATIC,
    GridSection,
    InitialSection,
    OutputSection,
    RunSection,
    SchemeSection,
)
from fpsolve.density.levels import MOST_LEVELS, n_passes
from fpsolve.density.step_choice import FIRST_ERROR
from fpsolve.density.suggestions import SuggestedStep, suggest_step
from fpsolve.grids.initial import gaussian, with_curvature
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.suggested_grid import suggest_grid

__all__ = ["Problem", "RunConfig"]

# Initial density, unknown and scratch.
_FEWEST_ARRAYS = 3


class Problem(NamedTuple):
    """What `solve` needs: ``solve(scheme, p0, **arguments)``."""

    model: FibreModel
    grid: AnyGrid
    p0: Array
    scheme: Any
    arguments: dict[str, Any]


class RunConfig(Description):
    """A whole run: `potential`, `model` and `curve`, or `process`; then how to solve.

    Without a grid or a step they are chosen by `suggest_grid` and `suggest_step` for
    the tolerance of the run, the grid for the translations of the scheme; their
    `reason` says why.
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
        model = self.build_model()
        with named_section("grid"):
            grid = self._grid(model)
        self._check_memory(grid, saved_in_memory)
        with named_section("initial"):
            p0 = self._start(model, grid)
        with named_section("scheme"):
            scheme = self.scheme.make(grid=grid, model=model)
        with named_section("run"):
            arguments = self._arguments(model, grid)
        return Problem(model, grid, p0, scheme, arguments)

    def resolved(self, problem: Problem) -> RunConfig:
        """Return the configuration with the grid and the step of `problem` in it.

        They are there already unless they were suggested.
        """
        cells: Any = problem.grid
        grid = {"half_width": cells.half_width, "shape": cells.shape[:3]}
        if isinstance(cells, SmoothPhaseSpaceGrid):
            largest, n_kappa = cells.kappa_half_width, cells.shape[3]
            grid |= {"kappa_half_width": largest, "n_kappa": n_kappa}
        run = {**self.run.model_dump(), "ds": float(problem.arguments["ds"])}
        tables = {**self.model_dump(exclude_none=True), "grid": grid, "run": run}
        return RunConfig.model_validate(tables)

    def _grid(self, model: Any) -> Any:
        if self.grid is not None:
            return self.grid.make()
        return suggest_grid(
            model, self.run.tolerance, initial=self._law(), s_end=self.run.s_end,
            translation=getattr(self.scheme, "translation", "lagrange"),
        )  # fmt: skip

    def _start(self, model: Any, grid: Any) -> Array:
        """The initial density; of a smooth fibre with the curvature of a free one."""
        if not isinstance(grid, SmoothPhaseSpaceGrid):
            return cast(Array, self.initial.make(grid=grid, potential=model.potential))
        if not isinstance(model, SmoothLayDownModel):
            raise ValueError(
                "`relaxation_length` of [model] must be given on a grid with a "
                "curvature, got none; leave out `n_kappa` and `kappa_half_width`."
            )
        cells = grid.phase_space
        p = self.initial.make(grid=cells, potential=model.potential)
        return with_curvature(p, grid, model.curvature_variance)

    def _law(self) -> GaussianLaw | None:
        """The law of the start, which a suggested box is to hold."""
        if type(self.initial).target is not gaussian:
            return None
        return GaussianLaw(**self.initial.model_dump(exclude={"kind"}))

    def _check_memory(self, grid: AnyGrid, saved_in_memory: bool) -> None:
        # `solve` knows how much a scheme needs, but by then the initial density is
        # made already, and tables as large as the grid.
        n_saved = len(self.run.saves()) if saved_in_memory else 0
        check_memory(
            required_memory(grid.nbytes, _FEWEST_ARRAYS, n_saved, self._n_passes())
        )

    def _n_passes(self) -> int:
        asked = self.run.extrapolate
        return MOST_LEVELS if isinstance(asked, str) else n_passes(asked)

    def _arguments(self, model: Any, grid: AnyGrid) -> dict[str, Any]:
        run, ds = self.run, self.run.ds
        automatic = run.extrapolate == AUTOMATIC
        if ds is None:
            error = FIRST_ERROR if automatic else run.tolerance
            suggested = suggest_step(model, grid, error)
            ds = SuggestedStep(run.step(suggested), suggested.reason)
            run.check_schedule(ds)
        arguments: dict[str, Any] = {
            "s_span": (0.0, run.s_end),
            "ds": ds,
            "save_at": run.saves(),
            "record_every": run.record_every,
            "extrapolate": False if automatic else run.extrapolate,
        }
        if automatic:
            arguments["tolerance"] = run.tolerance
        return arguments | run.tolerances()
