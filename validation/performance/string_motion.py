"""What the motion of a string costs: an iteration of Newton's method, and a step.

Claims: an iteration, with its share of the series of a step, takes less than three
times what it took on a core of 2 GHz; a shared machine is allowed the rest.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
from reporting import Report

from fpsolve import fibre

STIFF = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}


def costs(n_edges: int, air: fibre.AirFlow | None, repeats: int) -> tuple[float, float]:
    """CPU seconds of a step and of an iteration: the best of several short motions."""
    held = fibre.Clamped((0, 0, 0), (1, 0, 0))
    string = fibre.String(1.0, **STIFF, start=held, end=fibre.Free(), n_edges=n_edges)
    found = []
    for _ in range(repeats):
        began = time.process_time()
        motion = fibre.simulate(string, 0.05, 50, air=air, estimate_error=False)
        took = time.process_time() - began
        found.append((took / 50, took / motion.iterations.sum()))
    return min(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report = Report("string_motion", quick)
    rows = []
    for n_edges, allowed in ((32, 60e-6), (64, 80e-6), (300, 240e-6)):
        for name, air in (("none", None), ("uniform", fibre.AirFlow((1.0, 0, 0)))):
            step, iteration = costs(n_edges, air, 10 if quick else 50)
            rows.append(
                {"edges": n_edges, "air": name, "µs/step": 1e6 * step}
                | {"µs/iteration": 1e6 * iteration}
            )
            claim = f"seconds an iteration, {n_edges} edges, air: {name}"
            report.check(claim, iteration, "<=", 3 * allowed)
    report.table(rows)
    report.finish()


if __name__ == "__main__":
    main()
