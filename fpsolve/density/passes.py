"""The passes of a run: one, those of an extrapolation, or as many as are needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

from fpsolve._support.progress import ProgressCallback
from fpsolve.density import levels
from fpsolve.density.extrapolation import extrapolated
from fpsolve.density.keeper import MemoryKeeper
from fpsolve.density.run import Run
from fpsolve.density.solution import Solution
from fpsolve.density.tableau import combined, largest_cells_error, step_error
from fpsolve.errors import ToleranceError
from fpsolve.evolution.schedule import Schedule

if TYPE_CHECKING:
    from fpsolve.density.checkpoints.keeper import CheckpointKeeper

__all__ = ["Keepers", "run_passes", "run_within"]

# Of the name of a pass and its schedule.
Keepers: TypeAlias = Callable[[str, Schedule], "MemoryKeeper | CheckpointKeeper"]

# A level that leaves more than this of the estimate is not worth its steps: a shorter
# step is. Halved so often a step is of no use: something else limits the accuracy.
WORTHWHILE, MOST_HALVINGS = 0.5, 4


def run_passes(
    begin: Callable[..., Run],
    keepers: Keepers,
    schedule: Schedule,
    extrapolate: bool | int,
    report: ProgressCallback,
) -> Solution:
    """The one pass of a run, or all of an extrapolation, combined."""
    n_total = schedule.n_steps * levels.n_steps(extrapolate)
    found: list[Solution] = []
    for number in range(1, levels.n_passes(extrapolate) + 1):
        one = schedule.refined(number)
        run = begin(one, keepers(f"pass-{number}", one))
        n_before = schedule.n_steps * levels.n_steps(number - 1) if found else 0
        found.append(run.complete(report, n_before, n_total, found))
    if len(found) == 1:
        return found[0]
    if extrapolate is True:
        return extrapolated(found[0], found[1], run.scheme.order)
    return combined(found)


def run_within(
    begin: Callable[..., Run],
    keepers: Keepers,
    schedule: Schedule,
    tolerance: float,
    report: ProgressCallback,
) -> Solution:
    """Levels until at most `tolerance` is left; else half the step, anew."""
    best: Any = None
    least, first = float("inf"), 1
    for halvings in range(MOST_HALVINGS + 1):
        attempt = Attempt(schedule.refined(2**halvings), first)
        reached = attempt.climb(begin, keepers, tolerance, report)
        if reached:
            return combined(attempt.found)
        if attempt.step + attempt.cells < least:
            least, best = attempt.step + attempt.cells, attempt
        first += len(attempt.found)
        if attempt.cells > tolerance:
            break
    error = ToleranceError(least, tolerance, _remedy(best, tolerance))
    error.solution = combined(best.found)
    raise error


class Attempt:
    """Levels from one step on.

    Parameters
    ----------
    schedule : Schedule
        That of the longest step.
    first : int
        Number of the first pass.

    Attributes
    ----------
    found : list of Solution
        The runs with ds, ds/2, …
    step, cells : float
        Estimated L1 errors of what they combine to.
    """

    def __init__(self, schedule: Schedule, first: int) -> None:
        self.schedule, self.first = schedule, first
        self.found: list[Solution] = []
        self.step, self.cells = float("inf"), 0.0

    def climb(
        self,
        begin: Callable[..., Run],
        keepers: Keepers,
        tolerance: float,
        report: ProgressCallback,
    ) -> bool:
        """Add levels while they help; whether at most the tolerance is left."""
        for level in range(1, levels.MOST_LEVELS + 1):
            one = self.schedule.refined(level)
            run = begin(one, keepers(f"pass-{self.first + level - 1}", one))
            before = self.schedule.n_steps * levels.n_steps(level - 1) * (level > 1)
            total = before + one.n_steps
            self.found.append(run.complete(report, before, total, self.found))
            if level == 1:
                continue
            last, self.step = self.step, step_error(self.found)
            self.cells = largest_cells_error(self.found[-1])
            if self.step + self.cells <= tolerance:
                return True
            hopeless = self.cells > tolerance and self.step <= self.cells
            if hopeless or not self.step <= WORTHWHILE * last:
                return False
        return False


def _remedy(best: Attempt, tolerance: float) -> str:
    """What lets the tolerance be reached."""
    if best.cells > tolerance:
        return f"the cells leave {best.cells:.2g} of it: refine the grid"
    return "what the cells do not resolve changes with the step: refine the grid"
