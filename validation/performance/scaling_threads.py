"""Elapsed time of whole steps on one thread and on two.

    python validation/performance/scaling_threads.py            # half a minute

Both numbers of threads are measured in turn in one process, so that what else the
machine does meets both. It must have as many free cores as there are threads. Writes
results/benchmark-threads.json.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

from results import add_options, run_record, set_threads, write_part

THREADS = (1, 2)
set_threads(max(THREADS))

import numba  # noqa: E402
from ours import Case, case, make_scheme, make_start  # noqa: E402
from timing import keep_memory  # noqa: E402

DS, N_STEPS, ROUNDS = 1 / 8, 4, 7
SIZES, QUICK_SIZES = (64, 128), (16,)


def settings(n: int) -> tuple[Case, ...]:
    """What is measured on n³ cells."""
    shape = (n, n, n)
    return (
        case("drift_kick", shape, DS),
        case("drift_kick", shape, DS, balanced=True),
        case("drift_kick", shape, DS, translation="fourier"),
        case("semi_lagrangian", shape, DS),
    )


def elapsed(call: Callable[[], None]) -> float:
    """Elapsed seconds of one call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def compare(setting: Case, rounds: int) -> dict[str, Any]:
    """Median elapsed seconds of a step for every number of threads, and the ratio."""
    scheme = make_scheme(setting)
    p0 = make_start(scheme.grid)

    def steps() -> None:
        scheme.advance(scheme.start(p0), 0.0, DS, N_STEPS)

    samples: dict[int, list[float]] = {n: [] for n in THREADS}
    for round_ in range(rounds + 1):
        for n_threads in THREADS:
            numba.set_num_threads(n_threads)
            seconds = elapsed(steps) / N_STEPS
            if round_:  # the first is compilation and tables
                samples[n_threads].append(seconds)
    medians = {n: statistics.median(times) for n, times in samples.items()}
    ratio = medians[1] / medians[2]
    print(f"{setting.label:30} {setting.shape[0]:>4}³ one thread / two: {ratio:.2f}")
    return {
        "scheme": setting.label,
        "n": setting.shape[0],
        "seconds_per_step": medians,
        "ratio": ratio,
    }


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    keep_memory()
    sizes, rounds = (QUICK_SIZES, 1) if arguments.quick else (SIZES, ROUNDS)
    rows = [compare(setting, rounds) for n in sizes for setting in settings(n)]
    write_part("threads", run_record() | {"rows": rows}, arguments)


if __name__ == "__main__":
    main()
