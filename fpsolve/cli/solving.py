"""What `fpsolve run` and `fpsolve resume` do once they know what to solve."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fpsolve.cli.errors import FAILED, INTERRUPTED, fail, say

if TYPE_CHECKING:
    from fpsolve.cli.config.run import Problem, RunConfig
    from fpsolve.density.checkpoints.checkpoint import Checkpoint
    from fpsolve.density.solution import Solution

__all__ = ["keeping_partial_results", "say_where", "solve_and_write"]

# How the message of a solution begins that Ctrl-C left.
_STOPPED = "stopped by the user"


def solve_and_write(
    problem: Problem,
    config: RunConfig,
    out: Path,
    checkpoint: Checkpoint | None = None,
    keep: bool = False,
) -> None:
    """Solve, and write the result, or the part of it that was recorded.

    Parameters
    ----------
    problem : Problem
    config : RunConfig
        With grid and step in it.
    out : Path
    checkpoint : Checkpoint, optional
    keep : bool
        Leave its folder when the result is written.
    """
    from fpsolve.cli.plan import print_plan, suggestions
    from fpsolve.cli.writing import check_result

    check_result(config, out)
    print_plan(config, problem, out)

    def write(solution: Solution, figures: bool) -> None:
        from fpsolve.cli.solution_table import print_solution
        from fpsolve.cli.writing import write_result

        reasons = suggestions(problem)
        if reasons:
            about = {**solution.provenance, "suggested": reasons}
            solution = replace(solution, provenance=about)
        write_result(solution, config, out, figures=figures, show=print_solution)

    if checkpoint is not None:
        say_where(checkpoint.folder)
    with keeping_partial_results(write):
        solution = _evolve(problem, checkpoint)
    write(solution, config.output.figures)
    if checkpoint is not None and not keep:
        from fpsolve.density.checkpoints.folder import remove_folder

        remove_folder(checkpoint.folder)


def say_where(folder: Path) -> None:
    """Say where a run with checkpoints begins, if not at its start."""
    from fpsolve.density.checkpoints.manifest import MANIFEST
    from fpsolve.density.checkpoints.status import status_of

    if not (folder / MANIFEST).exists():
        return
    status = status_of(folder)
    if status.finished:
        say(f"the run in `{folder}` was finished; its result is written now")
    else:
        say(f"going on from `{folder}` at {status}")


@contextmanager
def keeping_partial_results(write: Callable[[Solution, bool], None]) -> Iterator[None]:
    """Write what a run had recorded when it stops early, then exit."""
    from fpsolve.errors import RunError, RunInterrupted

    try:
        yield
    except RunInterrupted as interrupt:
        write(interrupt.solution, False)
        how = interrupt.solution.message.removeprefix(_STOPPED)
        fail(f"interrupted; what was recorded until then is kept{how}", INTERRUPTED)
    except RunError as error:
        if error.solution is not None:
            _write_if_possible(error.solution, write)
        fail(error, FAILED)


def _write_if_possible(
    solution: Solution, write: Callable[[Solution, bool], None]
) -> None:
    """Write a partial result; where there is no room, what stopped the run counts."""
    try:
        write(solution, False)
    except OSError as error:
        say(f"warning: what was recorded cannot be written: {error}")


def _evolve(problem: Problem, checkpoint: Checkpoint | None) -> Solution:
    # Not `from fpsolve.solve import solve`: a test replaces the bar in its module.
    from fpsolve.cli import progress
    from fpsolve.density.solve import solve

    with progress.progress_bar() as report:
        return solve(
            problem.scheme,
            problem.p0,
            **problem.arguments,
            progress=report,
            checkpoint=checkpoint,
        )
