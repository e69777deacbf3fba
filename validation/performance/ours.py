"""Our schemes on the benchmark problem, through the public interface alone."""

from __future__ import annotations

from typing import Any

import numpy as np
from ours_cases import QUICK_CASES, RICHARDSON, SHARP, Case, case, cases
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
from timing import ONCE_ABOVE, Stopwatch, measure

import fpsolve as fp
from fpsolve.errors import FpsolveError

__all__ = [
    "NEVER",
    "RICHARDSON",
    "SHARP",
    "Case",
    "case",
    "make_scheme",
    "make_start",
    "runs",
    "solve",
]

NEVER = 10**9  # record the first and the last step only
# Too few waves are to show as an error and not to stop a run.
LAX: dict[str, Any] = {
    f"{name}_tolerance": np.inf
    for name in ("boundary", "negative", "entropy", "circulation")
}

QUICK_RUNS = tuple(map(vars, QUICK_CASES))


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Every case at one noise."""
    return tuple(map(vars, cases(problem.noise)))


def make_scheme(setting: Case, noise: float = 1.0) -> Any:
    """Build the scheme of a case."""
    model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=noise)
    grid = fp.PhaseSpaceGrid(half_width=HALF_WIDTH, shape=setting.shape)
    return getattr(fp, setting.scheme)(model, grid, **setting.options)


def make_start(grid: Any) -> np.ndarray:
    """Initial density, normalised on the grid."""
    return fp.initial.gaussian(
        grid,
        mean=MEAN,
        variance=VARIANCE,
        angle=ANGLE,
        concentration=CONCENTRATION,
    )


def solve(problem: Problem, **setting: Any) -> Result:
    """Solve the benchmark problem; kernels are compiled in a first, untimed run.

    `setting` are the attributes of a Case. CPU time is that of `fpsolve.solve` on a
    scheme that has run before; what the first run of a scheme takes longer (its
    tables) is the set-up. `LeftOutError` with what a call said that refused.
    """
    chosen, s_end = Case(**setting), problem.s_end
    lax = LAX if chosen.trigonometric else {}

    def run(scheme: Any, p0: np.ndarray) -> Any:
        return fp.solve(
            scheme,
            p0,
            s_span=(0.0, s_end),
            ds=chosen.ds,
            save_at=(s_end,),
            record_every=NEVER,
            extrapolate=chosen.extrapolate,
            **lax,
        )

    scheme = make_scheme(chosen, problem.noise)
    p0 = make_start(scheme.grid)
    try:
        run(scheme, p0)
    except FpsolveError as error:
        message = str(error).split(";")[0].split(". ")[0]
        raise LeftOutError(f"refused: {type(error).__name__}: {message}") from error
    with Stopwatch() as first:
        scheme = make_scheme(chosen, problem.noise)
        run(scheme, p0)
    measured = measure(lambda: run(scheme, p0), once_above=ONCE_ABOVE)
    solution = measured.value
    return Result(
        solver=chosen.label,
        axes=(scheme.grid.xi1, scheme.grid.xi2, scheme.grid.alpha),
        density=solution.density(s_end),
        step=f"{chosen.ds:.3g}",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=max(first.cpu - measured.cpu, 0.0),
        note="set-up is the tables; kernels are compiled once per machine",
        told=float(solution.errors["density_l1"][-1]) if chosen.extrapolate else None,
    )
