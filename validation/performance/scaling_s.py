"""Cost and error of runs to growing s, A = 1.

    python validation/performance/scaling_s.py            # 4 minutes

Our schemes and the Fourier code, each at one setting, to s = 1, 2, 5 and 10, against
one reference. Writes results/benchmark-s.json.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

from results import add_options, run_record, set_threads, write_part

set_threads(1)

import ours  # noqa: E402
import peer_fourier  # noqa: E402
import reference  # noqa: E402
from ours import RICHARDSON, SHARP, case  # noqa: E402
from ours_cases import fourier  # noqa: E402
from problem import Problem, Result  # noqa: E402
from timing import keep_memory  # noqa: E402

END, QUICK_END = (1.0, 2.0, 5.0, 10.0), (0.5, 1.0)
CASES = (
    case("semi_lagrangian", (64, 64, 32), 1 / 8),
    case("drift_kick", (64, 64, 32), 1 / 8),
    case("drift_kick", (64, 64, 32), 1 / 8, balanced=True),
    case("drift_kick", (64, 64, 32), 1 / 4, **RICHARDSON),
    case("drift_kick", (64, 64, 32), 1 / 8, **SHARP),
    fourier((40, 40, 24), 2, 4),
)
QUICK_CASES = (case("drift_kick", (24, 24, 16), 1 / 4),)
FOURIER, QUICK_FOURIER = (40, 40, 32), (16, 16, 16)

Solve = Callable[[Problem], Result]


def solvers(*, quick: bool) -> list[Solve]:
    """What is run to every s."""
    cases = QUICK_CASES if quick else CASES
    shape = QUICK_FOURIER if quick else FOURIER
    mine: list[Solve] = [partial(ours.solve, **vars(chosen)) for chosen in cases]
    return [*mine, partial(peer_fourier.solve, shape=shape)]


def row(solve: Solve, s: float, exact: Any) -> dict[str, Any]:
    """Cost and error of one run to s."""
    result = solve(Problem(noise=1.0, s_end=s))
    found = {
        "solver": result.solver,
        "shape": result.shape,
        "step": result.step,
        "s": s,
        "cpu": result.cpu,
        "l1_error": result.l1_error(exact(*result.axes)),
    }
    print(
        f"{result.solver:46} s = {s:<4g} {found['l1_error']:.2e} {result.cpu:.3g} s",
        flush=True,
    )
    return found


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    keep_memory()
    end = QUICK_END if arguments.quick else END
    exact = reference.load_all(1.0, end, quick=arguments.quick)
    rows = [
        row(solve, s, at_s)
        for solve in solvers(quick=arguments.quick)
        for s, at_s in zip(end, exact, strict=True)
    ]
    write_part("s", run_record() | {"rows": rows}, arguments)


if __name__ == "__main__":
    main()
