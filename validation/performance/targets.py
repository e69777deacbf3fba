"""The speed asked for: threads and paths; whole steps, records, import, example.

    python validation/performance/targets.py            # 64³, 3 minutes
    python validation/performance/targets.py --quick    # 16³ without py-pde

Everything is measured in turn, round after round, so that all sees the same machine;
ratios are formed in a round and their median is what is printed. Nothing is asserted
about times. Writes results/benchmark-targets.json:

- `rounds`: what one call took in each round, seconds; CPU time on one thread, elapsed
  time for `*_elapsed`. `steps` is one of N_STEPS steps made by one `advance`, `step`
  one made alone, `record` one `Recorder.record`, `euler` one explicit Euler step of
  py-pde with the equation as a user types it, `euler_fused` with coefficients fused by
  hand into a `PDEBase`, `paths` one call of `sample_paths`.
- `measured`: medians; cells per second, ratios, and seconds.
- `aims`: what some of `measured` are compared with, and whether they are to be above
  or below.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from results import add_options, run_record, set_threads, write_part

set_threads(1)

import os  # noqa: E402

os.environ["NUMBA_NUM_THREADS"] = str(max(2, os.cpu_count() or 1))

import numba  # noqa: E402
from kernels import DS, N_STEPS  # noqa: E402
from ours import case, make_scheme, make_start  # noqa: E402
from paths_ours import MODELS, end_positions  # noqa: E402
from problem import HALF_WIDTH, Problem, initial_density, open_mesh  # noqa: E402
from start_up import IMPORTS, median, timed  # noqa: E402
from tables import AIMS  # noqa: E402
from timing import Stopwatch, keep_memory  # noqa: E402

from fpsolve.density.recorder import Recorder  # noqa: E402

ROUNDS = 15
SECONDS_PER_SAMPLE = 0.05
EULER_STEP, EULER_STEPS = 1e-4, 10
N_PATHS, N_PATH_STEPS = 20_000, 1000
Call = Callable[[], object]


def our_calls(shape: tuple[int, int, int]) -> dict[str, Call]:
    """Steps of `drift_kick` among others and alone, a record; a call of the sampler."""
    scheme = make_scheme(case("drift_kick", shape, DS))
    p = make_start(scheme.grid)
    state = scheme.start(p)
    recorder = Recorder(scheme.model, scheme.grid)
    paths = MODELS["quadratic B"]()
    return {
        "steps": lambda: scheme.advance(state, 0.0, DS, N_STEPS),
        "step": lambda: scheme.advance(state, 0.0, DS, 1),
        "record": lambda: recorder.record(p, 0.0),
        "paths": lambda: end_positions(paths, "splitting", N_PATHS, N_PATH_STEPS),
    }


def euler_call(shape: tuple[int, int, int], *, fused: bool) -> Call:
    """EULER_STEPS explicit Euler steps of py-pde, compiled for this grid."""
    import numpy as np
    import pde
    from peer_pypde import LayDownEquation, expression_equation

    bounds = [(-HALF_WIDTH, HALF_WIDTH)] * 2 + [(0.0, 2 * np.pi)]
    grid = pde.CartesianGrid(bounds, list(shape), periodic=True)
    state = pde.ScalarField(grid, initial_density(*open_mesh(*grid.axes_coords)))
    equation = LayDownEquation if fused else expression_equation
    solver = pde.solvers.EulerSolver(equation(Problem()), backend="numba")
    stepper = solver.make_stepper(state, dt=EULER_STEP)
    return lambda: stepper(state, 0.0, EULER_STEP * EULER_STEPS)


def seconds(call: Call) -> tuple[float, float]:
    """CPU and elapsed seconds of one call, as many as fill a sample."""
    with Stopwatch() as trial:
        call()
    n_calls = max(1, round(SECONDS_PER_SAMPLE / max(trial.wall, 1e-6)))
    with Stopwatch() as watch:
        for _ in range(n_calls):
            call()
    return watch.cpu / n_calls, watch.wall / n_calls


def one_round(calls: dict[str, Call]) -> dict[str, float]:
    """Seconds of every call on one thread, and of whole steps on two."""
    found = {}
    for name, call in calls.items():
        found[name], elapsed = seconds(call)
        if name == "steps":
            found["steps_elapsed"] = elapsed / N_STEPS
            found["steps"] /= N_STEPS
            numba.set_num_threads(2)
            found["two_threads_elapsed"] = seconds(call)[1] / N_STEPS
            numba.set_num_threads(1)
    for name in found.keys() & {"euler", "euler_fused"}:
        found[name] /= EULER_STEPS
    return found


def rounds(shape: tuple[int, int, int], *, quick: bool) -> list[dict[str, float]]:
    """All rounds; compiled and warm before the first."""
    numba.set_num_threads(1)
    calls = our_calls(shape)
    if not quick:
        calls["euler"] = euler_call(shape, fused=False)
        calls["euler_fused"] = euler_call(shape, fused=True)
    one_round(calls)
    return [one_round(calls) for _ in range(2 if quick else ROUNDS)]


def start_up(*, quick: bool) -> dict[str, float]:
    """Elapsed seconds of `import fpsolve` and of a warm `fpsolve run`."""
    repeats = 1 if quick else 5
    nothing = median([timed(["-c", "pass"]) for _ in range(repeats)])["elapsed"]
    found = {}
    for key, name in (
        ("import_seconds", "fpsolve"),
        ("import_solve_seconds", "fpsolve, solve and a scheme"),
    ):
        samples = [timed(["-c", IMPORTS[name]]) for _ in range(repeats + 1)][1:]
        found[key] = median(samples)["elapsed"] - nothing
    if not quick:
        with TemporaryDirectory() as folder:
            command = ["-m", "fpsolve", "run", "--out", str(Path(folder) / "out")]
            samples = [timed(command) for _ in range(4)][1:]
        found["example_seconds"] = median(samples)["elapsed"]
        found["example_cpu_seconds"] = median(samples)["cpu"]
    return found


def summary(all_rounds: list[dict[str, float]], cells: int) -> dict[str, float]:
    """Medians of rates, and of ratios within a round."""

    def middle(value: Callable[[dict[str, float]], float]) -> float:
        return statistics.median(value(one) for one in all_rounds)

    found = {
        "cells_per_second": cells / middle(lambda one: one["steps"]),
        "cells_per_second_alone": cells / middle(lambda one: one["step"]),
        "cells_per_second_two_threads": cells
        / middle(lambda one: one["two_threads_elapsed"]),
        "two_threads": middle(
            lambda one: one["steps_elapsed"] / one["two_threads_elapsed"]
        ),
        "path_steps_per_second": N_PATHS
        * N_PATH_STEPS
        / middle(lambda one: one["paths"]),
        "record_seconds": middle(lambda one: one["record"]),
        "record_share": middle(lambda one: one["record"] / one["steps"]),
        "record_share_alone": middle(lambda one: one["record"] / one["step"]),
    }
    if "euler" in all_rounds[0]:
        found["euler_cells_per_second"] = cells / middle(lambda one: one["euler"])
        found["ratio_to_euler"] = middle(lambda one: one["euler"] / one["steps"])
        found["ratio_to_fused_euler"] = middle(
            lambda one: one["euler_fused"] / one["steps"]
        )
    return found


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    keep_memory()
    shape = (16, 16, 16) if arguments.quick else (64, 64, 64)
    taken = rounds(shape, quick=arguments.quick)
    measured = summary(taken, shape[0] * shape[1] * shape[2])
    measured |= start_up(quick=arguments.quick)
    for name, value in measured.items():
        sign, aim = AIMS.get(name, ("", None))
        print(f"{name:30} {value:10.4g}" + (f"   aim {sign} {aim:g}" if aim else ""))
    content: dict[str, Any] = {
        "run": run_record(),
        "shape": shape,
        "ds": DS,
        "n_steps": N_STEPS,
        "measured": measured,
        "aims": AIMS,
        "rounds": taken,
    }
    write_part("targets", content, arguments)


if __name__ == "__main__":
    main()
