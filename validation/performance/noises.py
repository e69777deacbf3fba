"""Error against CPU time at one noise, one solver: a section of the benchmark.

    python validation/performance/noises.py --noise 0.3 --solver fipy

Solves on every grid of the solver, from the smallest, and merges the section into
results/benchmark-noise-0.3.json. A grid that is predicted to take more than `PATIENCE`
CPU seconds, from the last one that was solved, is listed with the reason and not run.
With `--more` rows that are there stay, and only settings without one are run.
"""

from __future__ import annotations

import argparse
import fcntl
import importlib
import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from results import add_options, path_of, read_part, run_record, set_threads, write_part

SOLVERS = ("ours", "sectors", "pypde", "fipy", "dedalus", "fplanck", "fourier")
NOISES = (0.1, 0.3, 1.0, 3.0, 10.0)
OURS = {"ours": "ours", "sectors": "ours_sectors"}
PATIENCE = 90.0
# Of a solve: cells times steps, which are bounded by the spacing. Of the set-up: cells.
SOLVE_POWER, SETUP_POWER = 4 / 3, 1.0
COMPILED = "compilation"


def parse() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--noise", type=float, default=1.0, choices=NOISES)
    parser.add_argument("--solver", choices=SOLVERS, default="ours")
    parser.add_argument("--more", action="store_true", help="only what is not there")
    add_options(parser)
    return parser.parse_args()


def prepare_environment(solver: str, *, quick: bool) -> None:
    """One thread; Open MPI starts for root; nothing compiled in a quick py-pde."""
    set_threads(1)
    for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
        os.environ[name] = "1"
    if quick and solver == "pypde":  # it compiles for a minute in every process
        os.environ["NUMBA_DISABLE_JIT"] = "1"


def cells(shape: tuple[int, ...]) -> int:
    """Number of cells of a grid."""
    return math.prod(shape)


def predicted_seconds(row: dict[str, Any], shape: tuple[int, ...]) -> float:
    """CPU seconds of solve and set-up on `shape`, from a row; compilation excluded."""
    ratio = cells(shape) / cells(row["shape"])
    setup = 0.0 if COMPILED in row["note"] else row["setup"]
    return float(row["cpu"] * ratio**SOLVE_POWER + setup * ratio**SETUP_POWER)


def reason_to_skip(
    rows: list[dict[str, Any]], shape: tuple[int, ...], same: dict[str, Any]
) -> str | None:
    """Why a run is not made, judged by the largest run with the same options."""
    known = [row for row in rows if row["options"] == same]
    if not known:
        return None
    largest = max(known, key=lambda row: cells(row["shape"]))
    seconds = predicted_seconds(largest, shape)
    if seconds <= PATIENCE:
        return None
    grid = "x".join(map(str, largest["shape"]))
    return f"about {seconds:.0f} s of CPU time, predicted from {grid}"


def label(setting: dict[str, Any]) -> str:
    """Name of the options of a run that are not the grid, to tell runs apart."""
    options = {name: value for name, value in setting.items() if name != "shape"}
    return ", ".join(
        f"{name} {getattr(value, '__name__', value)}" for name, value in options.items()
    )


def row_of(result: Any, reference: Any, options: str) -> dict[str, Any]:
    """Compare a result with the reference on its own grid."""
    return {
        "solver": result.solver,
        "options": options,
        "shape": result.shape,
        "step": result.step,
        "l1_error": result.l1_error(reference(*result.axes)),
        "cpu": result.cpu,
        "wall": result.wall,
        "setup": result.setup,
        "note": result.note,
        "told": result.told,
    }


def solve_all(
    module: Any, problem: Any, reference: Any, settings: tuple[dict[str, Any], ...],
    kept: list[dict[str, Any]],
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:  # fmt: skip
    """Rows of the runs that were made, and reasons of those that were not."""
    from problem import LeftOutError

    rows = list(kept)
    there = {key(row["options"], row["shape"]) for row in kept}
    left_out: list[dict[str, Any]] = []
    for setting in settings:
        options, shape = label(setting), setting.get("shape", (0,))
        if key(options, shape) in there:
            continue
        reason = reason_to_skip(rows, shape, options)
        if reason is None:
            try:
                result = module.solve(problem, **setting)
            except LeftOutError as error:
                reason = str(error)
            except MemoryError:
                reason = "not enough memory"
        if reason is not None:
            left_out.append({"options": options, "shape": shape, "reason": reason})
            print(f"  {'x'.join(map(str, shape))} {options}: {reason}", flush=True)
            continue
        rows.append(row_of(result, reference, options))
        last = rows[-1]
        print(
            f"  {last['solver']:45} {'x'.join(map(str, result.shape)):>11} "
            f"{last['l1_error']:.2e} {last['cpu']:.3g} s, set-up {last['setup']:.3g} s",
            flush=True,
        )
    return rows, left_out


def check(rows: list[dict[str, Any]], *, quick: bool) -> None:
    """Assert what does not depend on the machine: that every solver converges to p.

    No bound on time. The loosest error of a full run is fplanck's, 0.9; a density that
    has nothing to do with p has 2.
    """
    for row in rows:
        bound = 1.8 if quick else 1.0
        message = f"{row['solver']}: L1 error {row['l1_error']:.2e}"
        assert row["l1_error"] <= bound, message


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Hold the folder's lock: two sections may end at the same time."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def key(options: str, shape: Any) -> tuple[Any, ...]:
    """What tells runs of a solver apart."""
    return (options, *shape)


def kept_rows(
    settings: tuple[dict[str, Any], ...], arguments: argparse.Namespace
) -> list[dict[str, Any]]:
    """Rows that `--more` keeps: those of the settings of this solver."""
    part = f"noise-{arguments.noise:g}"
    path = path_of(part, arguments.out, quick=arguments.quick)
    if not (arguments.more and path.exists()):
        return []
    sections = read_part(part, arguments.out, quick=arguments.quick)["sections"]
    rows = sections.get(arguments.solver, {"rows": []})["rows"]
    wanted = {key(label(one), one.get("shape", (0,))) for one in settings}
    return [row for row in rows if key(row["options"], row["shape"]) in wanted]


def merge(
    section: dict[str, Any], setting: dict[str, Any], arguments: argparse.Namespace
) -> None:
    """Put a section beside those of the other solvers at this noise."""
    part = f"noise-{arguments.noise:g}"
    content: dict[str, Any] = {"noise": arguments.noise, "s": 1.0, "sections": {}}
    with alone(arguments.out):
        if path_of(part, arguments.out, quick=arguments.quick).exists():
            content = read_part(part, arguments.out, quick=arguments.quick)
        sections = content["sections"] | {arguments.solver: section}
        content["sections"] = {n: sections[n] for n in SOLVERS if n in sections}
        write_part(part, content | {"reference": setting}, arguments)


def main() -> None:
    """Solve, print, merge."""
    arguments = parse()
    prepare_environment(arguments.solver, quick=arguments.quick)
    import reference
    from machine import measure_machine
    from problem import Problem
    from timing import keep_memory

    keep_memory()
    name = OURS.get(arguments.solver, f"peer_{arguments.solver}")
    module = importlib.import_module(name)
    problem = Problem(noise=arguments.noise)
    exact = reference.load(problem, quick=arguments.quick)
    machine = measure_machine(quick=True)
    settings = module.QUICK_RUNS if arguments.quick else module.runs(problem)
    print(f"A = {problem.noise:g}, {arguments.solver}")
    kept = kept_rows(settings, arguments)
    rows, left_out = solve_all(module, problem, exact, settings, kept)
    check(rows, quick=arguments.quick)
    section = {"machine": machine.to_dict(), "rows": rows, "left_out": left_out}
    setting = reference.settings(problem.noise, quick=arguments.quick)
    merge(run_record() | section, setting, arguments)


if __name__ == "__main__":
    main()
