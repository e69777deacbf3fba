"""Cells per second of whole steps, from 32³ to 192³ cells.

    python validation/performance/scaling_cells.py            # 2 minutes

CPU time of `N_STEPS` steps of ds = 1/8 from the benchmark's start, records excluded,
one thread. Writes results/benchmark-cells.json.
"""

from __future__ import annotations

import argparse
from typing import Any

from results import add_options, run_record, set_threads, write_part

set_threads(1)

from ours import Case, case, make_scheme, make_start  # noqa: E402
from timing import keep_memory, measure  # noqa: E402

DS, N_STEPS = 1 / 8, 4
SIZES, QUICK_SIZES = (32, 48, 64, 96, 128, 192), (16, 24)
SHARP = {"balanced": True, "interpolation_order": 16}


def settings(n: int) -> tuple[Case, ...]:
    """What is measured on n³ cells."""
    shape = (n, n, n)
    return (
        case("drift_kick", shape, DS),
        case("drift_kick", shape, DS, positive=True),
        case("drift_kick", shape, DS, balanced=True),
        case("drift_kick", shape, DS, **SHARP),
        case("drift_kick", shape, DS, translation="fourier"),
        case("semi_lagrangian", shape, DS),
    )


def step_rate(setting: Case) -> dict[str, Any]:
    """Cells per CPU second of whole steps; compiled and warm after the first call."""
    scheme = make_scheme(setting)
    p0 = make_start(scheme.grid)

    def steps() -> None:
        scheme.advance(scheme.start(p0), 0.0, DS, N_STEPS)

    steps()
    seconds = measure(steps).cpu / N_STEPS
    rate = p0.size / seconds
    print(f"{setting.label:40} {setting.shape[0]:>4}³ {rate / 1e6:8.1f} Mcells/s")
    return {
        "scheme": setting.label,
        "n": setting.shape[0],
        "cpu_per_step": seconds,
        "cells_per_second": rate,
    }


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    keep_memory()
    sizes = QUICK_SIZES if arguments.quick else SIZES
    rows = [step_rate(setting) for n in sizes for setting in settings(n)]
    write_part("cells", run_record() | {"rows": rows}, arguments)


if __name__ == "__main__":
    main()
