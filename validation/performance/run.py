"""Error against CPU time: our schemes and their peers on one problem, in one run.

    python validation/performance/run.py            # all peers that are installed
    python validation/performance/run.py --quick    # tiny grids, under 40 s

Every density is compared with the same converged reference (reference.py). Peers are
optional: py-pde comes with fpsolve, FiPy with the extra "benchmarks"; Dedalus needs
MPI and FFTW on the machine (README.md). Those that
cannot be imported are named and left out.
"""

from __future__ import annotations

import argparse
import importlib
import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"
PEERS = ("pypde", "fipy", "dedalus", "fourier")
PACKAGES = ("fpsolve", "numpy", "scipy", "numba", "py-pde", "fipy", "dedalus")
THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


def parse(arguments: list[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="tiny grids, no timings")
    parser.add_argument("--peers", nargs="*", choices=PEERS, help="default: all")
    parser.add_argument("--threads", type=int, default=1, help="default: 1")
    parser.add_argument("--s", type=float, default=1.0, help="solve to this s")
    parser.add_argument("--out", type=Path, default=RESULTS, help="folder for results")
    return parser.parse_args(arguments)


def set_threads(n_threads: int) -> None:
    """Fix the number of threads; numpy and numba read it when they are imported."""
    for name in THREAD_VARIABLES:
        os.environ[name] = str(n_threads)


def installed_versions() -> dict[str, str | None]:
    """Versions of Python and of everything that is compared."""
    found: dict[str, str | None] = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = None
    return found


def solve_ours(s_end: float, *, quick: bool) -> list[Any]:
    """Run every case of ours.py."""
    import ours

    cases = ours.QUICK_CASES if quick else ours.CASES
    return [ours.solve(setting, s_end) for setting in cases]


def solve_peer(name: str, s_end: float, *, quick: bool) -> list[Any]:
    """Run one peer with its own settings; a peer that is not installed is named."""
    try:
        peer = importlib.import_module(f"peer_{name}")
    except ImportError as error:
        print(f"peer {name} left out: {error}", file=sys.stderr)
        return []
    runs = peer.QUICK_RUNS if quick else peer.RUNS
    return [peer.solve(s_end, **setting) for setting in runs]


def check(rows: list[Any], *, quick: bool) -> None:
    """Assert what does not depend on the machine: that every solver converges to p.

    No bound on time. The loosest error of a full run is FiPy's on 32³.
    """
    worst = max(rows, key=lambda row: row.l1_error)
    bound = 0.8 if quick else 0.3
    assert worst.l1_error <= bound, f"{worst.solver}: L1 error {worst.l1_error:.2e}"
    best = min(row.l1_error for row in rows if row.solver.startswith("drift_kick"))
    bound = 2e-2 if quick else 1e-5
    assert best <= bound, f"the best drift_kick has an L1 error of {best:.2e}"


def write(
    path: Path,
    arguments: argparse.Namespace,
    rows: list[Any],
    verdicts: list[Any],
    machine: Any,
    rates: list[Any],
) -> None:
    """Write all numbers of the run, with what is needed to repeat it."""
    import reference
    import report

    content = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "s": arguments.s,
        "threads": arguments.threads,
        "versions": installed_versions(),
        "reference": reference.QUICK if arguments.quick else reference.FINE,
        "machine": machine.to_dict(),
        "rows": [vars(row) for row in rows],
        "aims": verdicts,
        "kernels": report.kernel_records(rates, machine),
    }
    report.write_json(path, content)


def main() -> None:
    """Solve, print, write."""
    arguments = parse()
    set_threads(arguments.threads)
    import reference
    import report
    from kernels import measure_kernels
    from machine import measure_machine
    from timing import keep_memory

    keep_memory()
    quick = arguments.quick
    exact = reference.load(arguments.s, quick=quick)
    machine = measure_machine(quick=quick)
    results = solve_ours(arguments.s, quick=quick)
    for name in PEERS if arguments.peers is None else arguments.peers:
        results += solve_peer(name, arguments.s, quick=quick)
    rows = [report.make_row(result, exact) for result in results]
    verdicts = report.judge_all(rows) if arguments.s == 1.0 else []
    rates = measure_kernels(quick=quick)
    report.print_table(rows)
    print()
    report.print_aims(verdicts)
    print(f"\n{machine}")
    report.print_kernels(rates, machine)
    stem = "quick" if quick else f"benchmark-s{arguments.s:g}"
    write(arguments.out / f"{stem}.json", arguments, rows, verdicts, machine, rates)
    report.draw(rows, arguments.s, arguments.out / f"{stem}.png")
    print(f"\nwritten: {arguments.out / stem}.json and .png")
    check(rows, quick=quick)


if __name__ == "__main__":
    main()
