"""Peak memory of a run against the number of cells, and what fpsolve says it needs.

    python validation/performance/memory_use.py            # 4 minutes, 3 for py-pde

Every run is a process of its own. Its peak resident memory is compared with that of
the same process after a tiny run: what remains grows with the cells. The C library's
allocator is left as it is. Writes results/benchmark-memory.json.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

from results import add_options, run_record, set_threads, write_part

SOLVERS = ("drift_kick", "semi_lagrangian", "py-pde")
SIZES, QUICK_SIZES = (32, 64, 96, 128), (24,)
PYPDE_SIZES = (64, 128)  # each compiles for a minute
N_STEPS = 4
TINY = 24
KIBIBYTE = 1024  # unit of ru_maxrss on Linux


def peak_memory() -> int:
    """Largest resident memory of this process so far, in bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KIBIBYTE


def run_ours(name: str, n: int) -> int:
    """Solve on n³ cells; bytes that fpsolve estimates before it starts."""
    import ours

    import fpsolve as fp
    from fpsolve._support.memory import required_memory

    ds = 1 / 8
    scheme = ours.make_scheme(ours.case(name, (n, n, n), ds))
    p0 = ours.make_start(scheme.grid)
    fp.solve(scheme, p0, (0.0, N_STEPS * ds), ds, record_every=N_STEPS)
    return required_memory(p0.nbytes, scheme.n_arrays + 1.0, 1)


def run_pypde(n: int) -> None:
    """Compile and solve on n³ cells."""
    import peer_pypde
    from problem import Problem

    peer_pypde.solve(Problem(s_end=0.02), (n, n, n))


def measure_here(solver: str, n: int) -> dict[str, Any]:
    """Peak memory of this process before and after the run."""
    estimate = None
    if solver == "py-pde":
        import peer_pypde  # noqa: F401

        before = peak_memory()
        run_pypde(n)
    else:
        run_ours(solver, TINY)
        before = peak_memory()
        estimate = run_ours(solver, n)
    density = 8 * n**3
    return {
        "solver": solver,
        "n": n,
        "density_bytes": density,
        "before_bytes": before,
        "peak_bytes": peak_memory(),
        "estimate_bytes": estimate,
    }


def measure(solver: str, n: int) -> dict[str, Any]:
    """Measure in a process of its own."""
    command = [sys.executable, str(Path(__file__)), "--solver", solver, "--n", str(n)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    grown = row["peak_bytes"] - row["before_bytes"]
    print(
        f"{solver:16} {n:>4}³: peak {row['peak_bytes'] / 2**20:6.0f} MiB, "
        f"{grown / row['density_bytes']:.1f} densities above the start",
        flush=True,
    )
    return row


def sizes_of(solver: str, *, quick: bool) -> tuple[int, ...]:
    """Grids of one solver; none for py-pde where it is missing or would take long."""
    if solver != "py-pde":
        return QUICK_SIZES if quick else SIZES
    installed = importlib.util.find_spec("pde") is not None
    return PYPDE_SIZES if installed and not quick else ()


def main() -> None:
    """Measure in processes, print, write; or measure here and print JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--solver", choices=SOLVERS, help="measure this process")
    parser.add_argument("--n", type=int, default=64)
    add_options(parser)
    arguments = parser.parse_args()
    set_threads(1)
    if arguments.solver:
        print(json.dumps(measure_here(arguments.solver, arguments.n)))
        return
    rows = [
        measure(solver, n)
        for solver in SOLVERS
        for n in sizes_of(solver, quick=arguments.quick)
    ]
    write_part("memory", run_record() | {"rows": rows}, arguments)


if __name__ == "__main__":
    main()
