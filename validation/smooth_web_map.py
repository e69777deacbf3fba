"""Where spectra of webs of smooth fibres are known, and where they are refused.

Claim: what a node of (R/σ, A √σ, |k| σ) answers has an error within the tolerance asked
for, and at a loose tolerance lies within both errors of what it answers at a tighter
one; what is refused names a remedy. The table says where a spectrum is known, refused,
or takes longer than a node may.
"""

from __future__ import annotations

import argparse
import itertools
import os
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.errors import ToleranceError  # noqa: E402
from fpsolve.spectral.resolvent.fibre import fibre_of  # noqa: E402

SPEED, LOOSE, TIGHT = 0.1, 5e-2, 1e-2
WAVES = (0.1, 1.0, 3.0)
# R/σ and A √σ.
QUICK = [(0.1, 3.0), (0.1, 1.0), (0.5, 3.0)]
FULL = [
    (length, noise)
    for length in (0.03, 0.1, 0.3, 0.5, 1.0, 2.0)
    for noise in (0.7, 1.0, 2.0, 3.0, 5.0, 10.0)
]


def node(length: float, noise: float, k: float, tolerance: float) -> dict[str, Any]:
    """Ŝ at one node, between the directions of the belt and across it; or why not."""
    curve = fp.MovingBelt(SPEED)
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), length, noise, curve)
    began, row = time.process_time(), {"R": length, "A": noise, "k": k}
    row["tolerance"] = tolerance
    nan = float("nan")
    try:
        fibre = fibre_of(model)
        value, error = fibre.spectrum(
            np.array([0.6 * k]), np.array([0.8 * k]), tolerance
        )
        states = max((one.size for one in getattr(fibre, "_kept", {})), default=0)
        row |= {"S": float(value[0]), "error": float(error[0]), "states": states}
        row["outcome"] = "known"
    except ToleranceError as refusal:
        row |= {"S": nan, "error": nan, "states": 0}
        row["outcome"] = f"refused: {refusal.remedy}"
    return {**row, "seconds": time.process_time() - began}


def limited(budget: int) -> None:
    """End this process after so many seconds of CPU time, however busy the machine."""
    resource.setrlimit(resource.RLIMIT_CPU, (budget, budget))


def within(budget: int, *arguments: float) -> dict[str, Any]:
    """A node in a process of its own, which is ended after the budget."""
    with ProcessPoolExecutor(1, initializer=limited, initargs=(budget,)) as pool:
        try:
            return pool.submit(node, *arguments).result()
        except BrokenProcessPool:
            pass
    length, noise, k, tolerance = arguments
    nan = float("nan")
    return {"R": length, "A": noise, "k": k, "tolerance": tolerance, "S": nan,
            "error": nan, "states": 0, "outcome": "longer",
            "seconds": budget}  # fmt: skip


def check_node(report: Report, length: float, noise: float, budget: int) -> None:
    """Three waves at two tolerances."""
    rows = []
    for k in WAVES:
        for tolerance in (LOOSE, TIGHT):
            rows.append(within(budget, length, noise, k, tolerance))
            if rows[-1]["outcome"] != "known":
                break
    report.table(rows)
    name = f"R = {length:g} σ, A = {noise:g}/√σ"
    known = [row for row in rows if row["outcome"] == "known"]
    limits = [row["error"] / (row["tolerance"] * max(row["S"], 1 / (1 + row["k"])))
              for row in known]  # fmt: skip
    if limits:
        report.check(f"{name}: error over tolerance", max(limits), "<=", 1.0)
    pairs = [(one, two) for one, two in itertools.pairwise(known)
             if one["k"] == two["k"]]  # fmt: skip
    shares = [abs(one["S"] - two["S"]) / (one["error"] + two["error"])
              for one, two in pairs]  # fmt: skip
    if shares:
        report.check(f"{name}: loose from tight over errors", max(shares), "<", 1.0)
    silent = [row for row in rows if row["outcome"] == "refused: "]
    report.check(f"{name}: refusals without a remedy", float(len(silent)), "<=", 0.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="three nodes")
    parser.add_argument("--budget", type=int, default=60, help="seconds of a node")
    parser.add_argument("--nodes", type=int, nargs="+", help="some of the full ones")
    options = parser.parse_args()
    report = Report("smooth_web_map", options.quick)
    nodes = QUICK if options.quick else FULL
    if options.nodes:
        nodes = [FULL[number] for number in options.nodes]
    for length, noise in nodes:
        check_node(report, length, noise, options.budget)
    report.finish()


if __name__ == "__main__":
    main()
