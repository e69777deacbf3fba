"""Our spectral method on the benchmark problem: sectors of the angular index.

No grid: CPU time is that of a whole call of `fpsolve.spectral_solve`, with H, moments
and all bounds, and of the density on `SHAPE` cells, where the error is taken. A method
for this kind of potential alone, isotropic and quadratic, on a belt at rest.
"""

from __future__ import annotations

from typing import Any

from problem import (
    ANGLE,
    CONCENTRATION,
    HALF_WIDTH,
    MEAN,
    VARIANCE,
    LeftOutError,
    Problem,
    Result,
)
from timing import ONCE_ABOVE, measure

import fpsolve as fp
from fpsolve.errors import MemoryLimitError, ToleranceError

NAME = "spectral_solve (sectors)"
SHAPE = (48, 48, 32)
WORK = 1e12
SMALLEST = {0.1: 4, 0.3: 8}  # powers of ten; beyond a run takes many seconds
QUICK_RUNS = ({"tolerance": 1e-1}, {"tolerance": 1e-3})


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost."""
    smallest = SMALLEST.get(problem.noise, 9)
    return tuple({"tolerance": 10.0**-k} for k in range(1, smallest + 1))


def solve(problem: Problem, *, tolerance: float) -> Result:
    """Solve the benchmark problem; what is told is the error of H."""
    model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=problem.noise)
    law = fp.paths.GaussianLaw(MEAN, VARIANCE, ANGLE, CONCENTRATION)
    grid = fp.PhaseSpaceGrid(half_width=HALF_WIDTH, shape=SHAPE)

    def run() -> Any:
        found = fp.spectral_solve(
            model, law, problem.s_end, tolerance=tolerance, work_limit=WORK
        )
        return found, found.density(problem.s_end, grid)

    try:
        run()
    except (ToleranceError, MemoryLimitError) as error:
        raise LeftOutError(f"refused: {type(error).__name__}") from error
    measured = measure(run, once_above=ONCE_ABOVE)
    found, density = measured.value
    return Result(
        solver=NAME,
        axes=(grid.xi1, grid.xi2, grid.alpha),
        density=density,
        step=f"tolerance {tolerance:.0e}",
        cpu=measured.cpu,
        wall=measured.wall,
        note="a whole call and the density on these cells",
        told=float(found.errors["relative_entropy"][0]),
    )
