"""Patterns of moving nozzles against larger truncations, and designs against scans.

Claims: the errors of patterns from the generator cover what larger truncations change,
at every noise, frequency and radius at which they are given; no pattern of a scan four
times as fine is better than a design beyond the errors of both; the optimum lies in the
range that the design says; laid webs share a pattern whose CV² is the predicted one.
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import replace
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402
from scipy.special import stdtrit  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve import studies  # noqa: E402
from fpsolve.errors import ToleranceError  # noqa: E402
from fpsolve.plotting import plot_nozzle_design  # noqa: E402
from fpsolve.spectral.evolution.quadratic import quadratic  # noqa: E402
from fpsolve.spectral.resolvent.nozzle_ladder import (  # noqa: E402
    FIRST,
    MOST_UNKNOWNS,
    NozzleLadder,
)
from fpsolve.web.pattern_of_model import averaged, waves  # noqa: E402

ROUND, NARROW = fp.QuadraticPotential(), fp.QuadraticPotential(1.0, 0.6)
# Noise, potential, nozzle; the last ones are as fast as the fibre, or as little noisy
# as is allowed.
QUICK = [
    (1.5, ROUND, fp.RotatingNozzle(0.2, 0.8, 0.5)),
    (1.0, ROUND, fp.OscillatingNozzle(0.1, 1.0, 0.3)),
]
FULL = [
    *QUICK,
    (0.7, ROUND, fp.RotatingNozzle(0.1, 1.0, 0.2)),
    (0.7, ROUND, fp.OscillatingNozzle(0.2, 0.5, 1.0)),
    (0.95, NARROW, fp.OscillatingNozzle(0.1, 1.0, 0.2)),
    (2.0, NARROW, fp.EllipticNozzle(0.3, 0.5, 1.5, -0.4)),
    (3.0, ROUND, fp.RotatingNozzle(0.1, 2.0, 0.3)),
    (1.0, ROUND, fp.RotatingNozzle(0.1, 2.0, 0.25)),
    (10.0, ROUND, fp.RotatingNozzle(0.3, 1.0, 0.05)),
]
# Steps by which the large truncation is larger than the smallest.
LARGE, SPACING = 4, 3.0
N_WEBS, ONCE_IN = 12, 100
Case = tuple[float, fp.Potential, Any]


def told(case: Case) -> str:
    noise, potential, curve = case
    return f"A = {noise:g}, {potential.formula}, γ = {curve.formula}"


def check_coverage(report: Report, cases: list[Case]) -> None:
    """Distance of every truncation to a large one over its error, at every wave."""
    for case in cases:
        model = fp.LayDownModel(case[1], case[0], case[2])
        ladder, curve = NozzleLadder(model), case[2]
        scales = quadratic(model).sigma1, quadratic(model).sigma2
        k1 = waves(abs(curve.speed) * curve.period, scales[0])
        k2 = waves(SPACING, scales[1])

        def compute(law: Any, k1: Any = k1, k2: Any = k2) -> Any:
            return averaged(law, k1, k2).ravel()

        fine, rows = compute(ladder.generator(FIRST.grown(LARGE))), []
        for level in range(LARGE - 2):
            began = time.process_time()
            # Anything goes: the first change is taken as it is.
            found, errors, _ = ladder.climb(
                FIRST, compute, lambda one: np.ones(one.shape), level, MOST_UNKNOWNS
            )
            rows.append({
                "case": told(case), "level": level + 1,
                "seconds": time.process_time() - began,
                "error": float(errors.max()),
                "distance": float(np.abs(found - fine).max()),
            })  # fmt: skip
        report.table(rows)
        largest = max(row["distance"] / row["error"] for row in rows)
        report.check(f"{told(case)}: distance over error", largest, "<", 1.0)


def check_design(
    report: Report, name: str, model: fp.LayDownModel, bounds: Any, n_scan: int
) -> None:
    """A design against a scan four times as fine, and its webs."""
    zones = [0.3, 1.0]
    design = studies.design_nozzles(
        model, zones, spacing=4.0, bounds=bounds, n_scan=n_scan, n_webs=N_WEBS
    )
    (free,) = design.names
    rows = []
    for value in np.geomspace(*bounds[free], 4 * (n_scan - 1) + 1):
        curve: Any = replace(model.curve, **{free: float(value)})  # type: ignore[type-var]
        one = replace(model, curve=curve)
        try:
            pattern = fp.mean_pattern(one, spacing=4.0, tolerance=2e-3)
        except ToleranceError:
            continue
        pairs = np.array([pattern.coefficient_of_variation(x) for x in zones])
        square = float(np.mean(pairs[:, 0] ** 2))
        error = float(np.mean(2 * pairs[:, 0] * pairs[:, 1] + pairs[:, 1] ** 2))
        rows.append({"design": name, free: float(value), "mean CV²": square,
                     "error": error})  # fmt: skip
    report.table(rows)
    best = min(rows, key=lambda row: row["mean CV²"])
    known = float(np.mean(2 * design.pattern_cv * design.pattern_errors
                          + design.pattern_errors**2))  # fmt: skip
    lead = float(np.nanmin(design.squares)) - best["mean CV²"]
    report.check(f"{name}: a finer scan is not better, beyond errors", lead, "<",
                 known + best["error"])  # fmt: skip
    # Of two points beside each other of the finer scan one may be the lowest by chance.
    step = (bounds[free][1] / bounds[free][0]) ** (0.25 / (n_scan - 1))
    low, high = design.ranges[:, 0]
    report.check(f"{name}: lowest point of the finer scan, below the range",
                 low / best[free], "<=", step)  # fmt: skip
    report.check(f"{name}: lowest point of the finer scan, above the range",
                 best[free] / high, "<=", step)  # fmt: skip
    bound = float(stdtrit(N_WEBS - 1, 1 - 0.5 / (ONCE_IN * design.z.size)))
    report.check(f"{name}: largest |z|", float(np.abs(design.z).max()), "<", bound)
    save_figure(plot_nozzle_design(design), f"nozzle_design_{free}.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two patterns, one design")
    options = parser.parse_args()
    report = Report("nozzle_design", options.quick)
    swinging = fp.LayDownModel(ROUND, 1.5, fp.OscillatingNozzle(0.05, 1.0, 0.3))
    turning = fp.LayDownModel(ROUND, 1.5, fp.RotatingNozzle(0.2, 1.0, 0.3))
    check_coverage(report, QUICK if options.quick else FULL)
    check_design(report, "width of a swing", swinging, {"amplitude": (0.5, 2.5)}, 7)
    if not options.quick:
        speeds = {"angular_speed": (0.05, 0.7)}
        check_design(report, "frequency of a swing", swinging, speeds, 13)
        check_design(report, "frequency of a rotation", turning, speeds, 13)
    report.finish()


if __name__ == "__main__":
    main()
