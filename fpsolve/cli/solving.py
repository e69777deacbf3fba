"""What `fpsolve run` and `fpsolve resume` do once they know what to solve."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fpsolve.cli.errors import say
from fpsolve.cli.writing import claim_result, print_solution, write_result

if TYPE_CHECKING:
    from fpsolve.cli.config.run import Problem, RunConfig
    from fpsolve.cli.frame import Frame
    from fpsolve.density.checkpoints.checkpoint import Checkpoint
    from fpsolve.density.solution import Solution

__all__ = ["RECORDED", "say_where", "solve_and_write"]

# What a run leaves that stops early.
RECORDED = "what was recorded until then is kept"


def solve_and_write(
    frame: Frame,
    problem: Problem,
    config: RunConfig,
    checkpoint: Checkpoint | None = None,
    keep: bool = False,
) -> None:
    """Solve, and write the result, or the part of it that was recorded.

    Parameters
    ----------
    frame : Frame
    problem : Problem
    config : RunConfig
        With grid and step in it.
    checkpoint : Checkpoint, optional
    keep : bool
        Leave its folder when the result is written.
    """
    from fpsolve.cli.plan import print_plan, suggestions
    from fpsolve.density.solve import solve

    name = config.output.file_name
    frame.figures = config.output.figures
    claim_result(frame, name)
    print_plan(config, problem, frame.out)

    def write(solution: Solution) -> None:
        reasons = suggestions(problem)
        if reasons:
            about = {**solution.provenance, "suggested": reasons}
            solution = replace(solution, provenance=about)
        write_result(solution, frame, name, print_solution, config.to_toml())

    if checkpoint is not None:
        say_where(checkpoint.folder)
    with frame.computing(keep=write, kept=RECORDED) as report:
        solution = solve(
            problem.scheme,
            problem.p0,
            **problem.arguments,
            progress=report,
            checkpoint=checkpoint,
        )
    write(solution)
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
