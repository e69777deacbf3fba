"""What `design_web` is asked, checked before anything is predicted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fpsolve._support.checks import (
    check_integer,
    check_kind,
    check_one_of,
    check_positive,
)
from fpsolve.model.process import Process
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.spectral.resolvent.fibre import check_fibre, scales_of
from fpsolve.studies.arguments import several
from fpsolve.studies.design.front import SPEED
from fpsolve.studies.design.settings import Settings
from fpsolve.studies.design.space import Space, space_of
from fpsolve.studies.design.target import Target, check_cost, target_of
from fpsolve.web.order import checked_titer
from fpsolve.web.predict import checked_zones
from fpsolve.web.prediction import POSITIONS

__all__ = ["Task", "task_of"]


@dataclass(frozen=True, eq=False)
class Task:
    """The arguments of `design_web`, checked.

    Attributes
    ----------
    space : Space
        The free parameters, with the start in it.
    target : Target
    positions : {"regular", "random"}
    cost : str
    tolerance : float
    front, n_webs, seed : int
    """

    space: Space
    target: Target
    positions: str
    cost: str
    tolerance: float
    front: int
    n_webs: int
    seed: int


def task_of(
    process: Any,
    target: Any,
    *,
    spacing: Any,
    titer: Any,
    free: Any,
    bounds: Any = None,
    positions: Any = "regular",
    cost: Any = "throughput",
    tolerance: Any = 2e-2,
    front: Any = 0,
    n_webs: Any = 0,
    seed: Any = 1,
) -> Task:
    """Check the arguments of `design_web`."""
    start, aim = checked_start(process, spacing, titer), target_of(target)
    space = space_of(start, free, bounds)
    check_cost(cost, aim, space.names)
    checked_zones(aim.zones, process.length * max(scales_of(process.model)))
    check_one_of("positions", positions, POSITIONS)
    made = Task(
        space, aim, positions, cost, checked_tolerance(tolerance),
        several("front", front), several("n_webs", n_webs),
        check_integer("seed", seed, at_least=0),
    )  # fmt: skip
    if made.front and SPEED not in space.names:
        raise ValueError(
            f"`free` must name {SPEED} for a front, got {', '.join(space.names)}; at a "
            "fixed base weight the throughput goes with the belt speed."
        )
    return made


def checked_start(process: Any, spacing: Any, titer: Any) -> Settings:
    """The settings from which a search begins."""
    check_kind("process", process, Process)
    check_fibre(process.model)
    if not abs(process.speed_ratio) > 0:
        raise ValueError(
            "`process` must have a belt in motion, got `speed_ratio` 0; on a belt at "
            "rest there is no web."
        )
    checked_titer(check_positive("titer", titer), process)
    return Settings(process, check_positive("spacing", spacing), float(titer))
