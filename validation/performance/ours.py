"""Our schemes on the benchmark problem, through the public interface alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from problem import (
    ANGLE,
    CONCENTRATION,
    HALF_WIDTH,
    MEAN,
    VARIANCE,
    Problem,
    Result,
)
from timing import Stopwatch, measure

import fpsolve as fp

NEVER = 10**9  # record the first and the last step only


@dataclass(frozen=True)
class Case:
    """One setting of one of our schemes.

    Attributes
    ----------
    scheme : str
        Name of the function in `fpsolve` that builds it.
    shape : tuple of int
    ds : float
        With `extrapolate` the coarser of the two steps.
    options : dict
        Keyword arguments of the scheme.
    extrapolate : bool
    """

    scheme: str
    shape: tuple[int, int, int]
    ds: float
    options: dict[str, Any] = field(default_factory=dict)
    extrapolate: bool = False

    @property
    def label(self) -> str:
        """Scheme and options, as printed."""
        order = self.options.get("interpolation_order")
        words = [name for name, value in self.options.items() if value is True]
        words += [f"order {order}"] if order else []
        words += ["extrapolated"] if self.extrapolate else []
        return self.scheme + (f" ({', '.join(words)})" if words else "")


def case(scheme: str, shape: tuple[int, int, int], ds: float, **options: Any) -> Case:
    """Build a Case; `extrapolate=True` is the run's, the rest the scheme's options."""
    extrapolate = options.pop("extrapolate", False)
    return Case(scheme, shape, ds, options, extrapolate)


RICHARDSON = {"extrapolate": True}
SHARP = {"balanced": True, "interpolation_order": 16, "extrapolate": True}

SMALL = (
    case("semi_lagrangian", (32, 32, 16), 1 / 4),
    case("semi_lagrangian", (48, 48, 32), 1 / 4),
    case("semi_lagrangian", (64, 64, 32), 1 / 8),
    case("semi_lagrangian", (64, 64, 32), 1 / 4, **RICHARDSON),
    case("semi_lagrangian", (64, 64, 32), 1 / 4, interpolation_order=6, **RICHARDSON),
    case("drift_kick", (24, 24, 16), 1 / 2),
    case("drift_kick", (32, 32, 16), 1 / 3),
    case("drift_kick", (32, 32, 16), 1 / 4),
    case("drift_kick", (40, 40, 24), 1 / 4),
    case("drift_kick", (64, 64, 32), 1 / 8),
    case("drift_kick", (32, 32, 16), 1 / 4, positive=True),
    case("drift_kick", (64, 64, 32), 1 / 8, positive=True),
    case("drift_kick", (32, 32, 16), 1 / 4, balanced=True),
    case("drift_kick", (64, 64, 32), 1 / 8, balanced=True),
    case("drift_kick", (64, 64, 32), 1 / 4, **RICHARDSON),
    case("drift_kick", (64, 64, 32), 1 / 4, balanced=True, **RICHARDSON),
)
# Sharpest settings: little noise needs angles, much noise needs steps.
SHARPEST = {
    0.3: (
        case("drift_kick", (48, 48, 24), 1 / 4, **SHARP),
        case("drift_kick", (48, 48, 32), 1 / 6, **SHARP),
        case("drift_kick", (64, 64, 48), 1 / 8, **SHARP),
        case("drift_kick", (80, 80, 48), 1 / 12, **SHARP),
        case("drift_kick", (96, 96, 64), 1 / 16, **SHARP),
        case("drift_kick", (128, 128, 96), 1 / 32, **SHARP),
    ),
    1.0: (
        case("drift_kick", (40, 40, 16), 1 / 4, **SHARP),
        case("drift_kick", (44, 44, 16), 1 / 4, **SHARP),
        case("drift_kick", (48, 48, 24), 1 / 6, **SHARP),
        case("drift_kick", (64, 64, 32), 1 / 8, **SHARP),
        case("drift_kick", (80, 80, 32), 1 / 16, **SHARP),
        case("drift_kick", (96, 96, 48), 1 / 32, **SHARP),
    ),
    3.0: (
        case("drift_kick", (40, 40, 16), 1 / 8, **SHARP),
        case("drift_kick", (44, 44, 16), 1 / 12, **SHARP),
        case("drift_kick", (48, 48, 16), 1 / 16, **SHARP),
        case("drift_kick", (64, 64, 24), 1 / 24, **SHARP),
        case("drift_kick", (80, 80, 24), 1 / 48, **SHARP),
        case("drift_kick", (96, 96, 32), 1 / 96, **SHARP),
    ),
}


def cubes() -> tuple[Case, ...]:
    """The grids that every solver is asked for, and finer ones."""
    sizes = (32, 64, 96, 128)
    plain = [case("drift_kick", (n, n, n), 1 / 8) for n in sizes]
    sharp = [case("drift_kick", (n, n, n), 1 / 16, **SHARP) for n in sizes]
    slow = [case("semi_lagrangian", (n, n, n), 1 / 8) for n in sizes]
    return (*slow, *plain, *sharp)


QUICK_CASES = (
    case("semi_lagrangian", (16, 16, 16), 1 / 4),
    case("drift_kick", (16, 16, 16), 1 / 4),
    case("drift_kick", (24, 24, 16), 1 / 4, positive=True),
    case("drift_kick", (24, 24, 16), 1 / 4, balanced=True),
    case("drift_kick", (32, 32, 16), 1 / 4, **SHARP),
)
QUICK_RUNS = tuple(map(vars, QUICK_CASES))


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Every case at one noise."""
    cases = (*SMALL, *SHARPEST[problem.noise], *cubes())
    return tuple(map(vars, cases))


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
    tables) is the set-up.
    """
    chosen, s_end = Case(**setting), problem.s_end

    def run(scheme: Any, p0: np.ndarray) -> Any:
        return fp.solve(
            scheme,
            p0,
            s_span=(0.0, s_end),
            ds=chosen.ds,
            save_at=(s_end,),
            record_every=NEVER,
            extrapolate=chosen.extrapolate,
        )

    scheme = make_scheme(chosen, problem.noise)
    p0 = make_start(scheme.grid)
    run(scheme, p0)
    with Stopwatch() as first:
        scheme = make_scheme(chosen, problem.noise)
        run(scheme, p0)
    measured = measure(lambda: run(scheme, p0))
    return Result(
        solver=chosen.label,
        axes=(scheme.grid.xi1, scheme.grid.xi2, scheme.grid.alpha),
        density=measured.value.density(s_end),
        step=f"{chosen.ds:.3g}",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=max(first.cpu - measured.cpu, 0.0),
        note="set-up is the tables; kernels are compiled once per machine",
    )
