"""The whole benchmark, part after part: errors against CPU time, scaling, start.

    python validation/performance/run.py                     # 80 minutes
    python validation/performance/run.py --part noises --noises 0.3 --solvers fipy
    python validation/performance/run.py --resume            # only what is not there
    python validation/performance/run.py --quick             # tiny grids, a minute

Every part is a process of its own, on one thread (threads: two), and writes a JSON
file of its own under results/, so that a run can be stopped and gone on with. At the
end the tables are printed and the figures drawn from these files. Peers are optional
(README.md says how to install them): those that cannot be imported are named and left
out. The full run asserts nothing about times.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from results import FOLDER, add_options, path_of

HERE = Path(__file__).parent
NOISES = (1.0, 0.3, 3.0, 0.1, 10.0)
PACKAGE = {"pypde": "pde"}  # whose import name is not that of its module here
SOLVERS = ("ours", "sectors", "pypde", "fipy", "dedalus", "fplanck", "fourier")
STUDIES = {
    "cells": "scaling_cells.py",
    "s": "scaling_s.py",
    "memory": "memory_use.py",
    "operators": "operators.py",
    "threads": "scaling_threads.py",
    "start": "start_up.py",
    "targets": "targets.py",
}


@dataclass(frozen=True)
class Step:
    """One process: its script and options, and whether its numbers are there."""

    script: str
    options: tuple[str, ...]
    done: bool


def parse(arguments: list[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parts = ("noises", *STUDIES)
    parser.add_argument("--part", nargs="+", choices=parts, help="default: all")
    parser.add_argument("--noises", nargs="+", type=float, choices=NOISES)
    parser.add_argument("--solvers", nargs="+", choices=SOLVERS, help="default: all")
    parser.add_argument("--resume", action="store_true", help="only what is not there")
    add_options(parser)
    return parser.parse_args(arguments)


def installed(solver: str) -> bool:
    """Whether a solver can be imported; a missing one is named."""
    package = PACKAGE.get(solver, solver)
    if solver in ("ours", "sectors", "fourier") or importlib.util.find_spec(package):
        return True
    print(f"{solver} left out: no module {package!r} is installed", file=sys.stderr)
    return False


def has_section(noise: float, solver: str, arguments: argparse.Namespace) -> bool:
    """Whether the numbers of one solver at one noise are there."""
    path = path_of(f"noise-{noise:g}", arguments.out, quick=arguments.quick)
    return path.exists() and solver in json.loads(path.read_text("utf-8"))["sections"]


def noise_steps(arguments: argparse.Namespace) -> Iterator[Step]:
    """Errors against CPU time: a process for every noise and solver."""
    noises = arguments.noises or (NOISES[:1] if arguments.quick else NOISES)
    solvers = [name for name in arguments.solvers or SOLVERS if installed(name)]
    for noise in noises:
        for solver in solvers:
            options = ("--noise", f"{noise:g}", "--solver", solver)
            done = has_section(noise, solver, arguments)
            yield Step("noises.py", options, done)


def steps(arguments: argparse.Namespace) -> Iterator[Step]:
    """Everything that was asked for."""
    chosen = arguments.part or ("noises", *STUDIES)
    if "noises" in chosen:
        yield from noise_steps(arguments)
    for part, script in STUDIES.items():
        if part in chosen:
            done = path_of(part, arguments.out, quick=arguments.quick).exists()
            yield Step(script, (), done)


def call(script: str, *options: str) -> bool:
    """Run a script; whether it ended well."""
    print(f"== {script} {' '.join(options)}".rstrip(), flush=True)
    command = [sys.executable, str(HERE / script), *options]
    return subprocess.run(command, check=False).returncode == 0


def main() -> None:
    """Run what was asked for, print the tables, draw the figures."""
    arguments = parse()
    common = ["--out", str(arguments.out), *(["--quick"] if arguments.quick else [])]
    failed = [
        f"{step.script} {' '.join(step.options)}".rstrip()
        for step in steps(arguments)
        if not (arguments.resume and step.done)
        and not call(step.script, *step.options, *common)
    ]
    for script in ("tables.py", "figures.py"):
        if not call(script, *common):
            failed.append(script)
    if failed:
        sys.exit(f"failed: {'; '.join(failed)}")
    if arguments.out == FOLDER and not arguments.quick:
        print("docs/benchmarks.md shows these numbers: refresh it with page.py")


if __name__ == "__main__":
    main()
