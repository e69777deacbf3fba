"""What would make a stationary density accurate enough, in numbers."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

from fpsolve.density.stationary.start import concentration_of
from fpsolve.errors import ToleranceError
from fpsolve.model.fibre import FibreModel

__all__ = ["WORTHLESS", "check_error", "remedy"]

# Orders in which the number of cells is extrapolated.
LOWEST, HIGHEST = 1.0, 12.0
# Share of the tolerance that a part may have after what is proposed.
SHARE = 0.4
WIDENING, WIDEST = 1.02, 8.0
# Above, an estimate is no more than a sign that nothing is resolved.
WORTHLESS = 0.1


def check_error(
    what: str, result: Any, tolerance: float, advice: Callable[[], str]
) -> None:
    """Warn above the tolerance; ToleranceError where nothing is resolved.

    Parameters
    ----------
    what : str
        Kind of density.
    result : SteadyState or PeriodicState
    tolerance : float
    advice : callable
        What would be accurate enough.
    """
    if result.error <= tolerance:
        return
    told = advice()
    if not result.error <= max(WORTHLESS, tolerance):
        raise ToleranceError(result.error, tolerance, told)
    parts = ", ".join(f"{name} {size:.1g}" for name, size in result.errors.items())
    warnings.warn(
        f"the {what} density has an L1 error of about {result.error:.1g} "
        f"({parts}), above `error_tolerance` = {tolerance:g}; {told}, or raise "
        "`error_tolerance` if this is enough.",
        UserWarning,
        stacklevel=5,
    )


def remedy(result: Any, tolerance: float, order: float) -> str:
    """Advice for every part of the error that is too large.

    Parameters
    ----------
    result : SteadyState or PeriodicState
        Of a model on a belt of constant speed, or the mean one.
    tolerance : float
    order : float
        At which the error falls with the cells.
    """
    goal = SHARE * tolerance
    advice = []
    widening = 1.0
    if result.errors["box"] > goal:
        widening = wider(result.model, result.grid, result.errors["box"] / goal)
    finer = 1.0
    # What comes back over the edge of a box that is too small is rough on any grid.
    if result.errors["grid"] > max(goal, result.errors["box"]):
        power = 1.0 / min(max(order, LOWEST), HIGHEST)
        finer = (result.errors["grid"] / goal) ** power
    if max(widening, finer) > 1.0:
        advice.append(
            f"a grid of about {proposed(result.grid, widening, finer)} would do"
        )
    if max(result.errors["step"], result.errors.get("scheme", 0.0)) > goal:
        advice.append(f"shorten `ds` = {result.ds:.3g}, or leave it out")
    return "; ".join(advice) or "`tolerance` is too large"


def proposed(grid: Any, widening: float, finer: float) -> str:
    """The grid in words: half widths, and even numbers of cells as dense as needed."""
    half1, half2 = (widening * half for half in grid.half_widths)
    n1, n2 = (2 * math.ceil(widening * finer * n / 2) for n in grid.shape[:2])
    n_alpha = 4 * math.ceil(finer * grid.shape[2] / 4)
    curved = "".join(f", {2 * math.ceil(finer * n / 2)}" for n in grid.shape[3:])
    cells = f"({n1}, {n2}, {n_alpha}{curved})"
    return f"half widths ({half1:.3g}, {half2:.3g}) and {cells} cells"


def wider(model: FibreModel | None, grid: Any, excess: float) -> float:
    """Factor of the half widths at which e^{−B} on the belt has fallen by `excess`."""
    if model is None:
        return WIDEST
    velocity = model.curve.velocity(0.0)
    speed = math.hypot(float(velocity[0]), float(velocity[1]))
    pull = 0.5 * model.noise**2 * concentration_of(speed)
    directions = [(-float(one) / speed if speed else 0.0) for one in velocity]

    def lowest(factor: float) -> float:
        half1, half2 = (factor * half for half in grid.half_widths)
        edges = ((half1, 0.0), (-half1, 0.0), (0.0, half2), (0.0, -half2))
        return min(
            float(model.potential.value(x, y))
            - pull * (directions[0] * x + directions[1] * y)
            for x, y in edges
        )

    needed, factor = lowest(1.0) + math.log(excess), 1.0
    while lowest(factor) < needed and factor < WIDEST:
        factor *= WIDENING
    return factor
