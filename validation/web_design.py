"""Designs of webs are where scans and grids of predictions have their best point.

Claims: no prediction of a scan of σ₂, nor of a grid of σ₂ and belt speed at the base
weight of the design, has a smaller CV than the optimum, beyond the errors of both; the
lowest point of the scan and the belt speed at which a scan crosses a bound of CV are
those of the design, within its errors and those of the interpolation; a process three
times as large has the same optimum; the laid webs vary as predicted.
"""

from __future__ import annotations

import argparse
import os
from dataclasses import replace
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402
from scipy.special import stdtrit  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve import studies  # noqa: E402
from fpsolve.plotting import plot_web_design  # noqa: E402

PROCESS = fp.Process(0.005, 0.005, 20.0, 0.1, 50.0)
TITER, WIDE, NARROW = 1.5e-4, 0.015, 5e-4
TOLERANCE = 2e-2
SIGMA2, SPEED = (2e-3, 15e-3), (0.05, 0.2)
# Once in so many studies chance alone goes beyond the bound of the scores.
ONCE_IN, N_WEBS = 100, 12
N_SCAN, N_GRID = 9, 4


def predicted(process: fp.Process, spacing: float, zone: float) -> tuple[float, float]:
    """Log CV, and the bound of its error."""
    found = fp.predict_web(process, spacing=spacing, zones=zone, tolerance=TOLERANCE)
    return float(np.log(found.cv[0])), float(found.errors[0] / found.cv[0])


def designed(target: Any, spacing: float, process: Any = PROCESS, **asked: Any) -> Any:
    """A design of the study."""
    return studies.design_web(
        process, target, spacing=spacing, titer=TITER, tolerance=TOLERANCE,
        n_webs=N_WEBS, **asked,
    )  # fmt: skip


def value(design: Any, name: str) -> tuple[float, float]:
    """A parameter of the optimum, and its relative error."""
    place = design.parameters.index(name)
    return float(design.values[place]), float(design.value_errors[place])


def laid_as_predicted(report: Report, name: str, design: Any) -> None:
    """Whether the scores of the laid webs are those of chance."""
    bound = float(stdtrit(N_WEBS - 1, 1 - 0.5 / (ONCE_IN * design.z.size)))
    report.check(f"{name}: largest |z|", float(np.abs(design.z).max()), "<", bound)


def between_strips_and_clouds(report: Report) -> None:
    """The throwing range of wide spacings, against a scan and in other units."""
    asked = {"free": ["sigma2"], "bounds": {"sigma2": SIGMA2}}
    design = designed([0.005], WIDE, **asked)
    best, error = value(design, "sigma2")
    scan = np.geomspace(*SIGMA2, N_SCAN)
    found = np.array([
        predicted(replace(PROCESS, sigma2=float(one)), WIDE, 0.005) for one in scan
    ])  # fmt: skip
    report.table([
        {"sigma2": float(one), "log CV": float(row[0]), "error": float(row[1])}
        for one, row in zip(scan, found, strict=True)
    ])  # fmt: skip
    known = float(design.errors[0] / design.cv[0])
    lead = float(np.log(design.cv[0]) - found[:, 0].min())
    report.check("sigma2: the scan is not better, beyond errors", lead, "<",
                 known + float(found[:, 1].max()))  # fmt: skip
    lowest = int(np.clip(found[:, 0].argmin(), 2, N_SCAN - 3))
    near = slice(lowest - 2, lowest + 3)
    # A quartic through five points: a fifth of their distance is more than it errs.
    quartic = np.polynomial.Polynomial.fit(np.log(scan[near]), found[near, 0], 4)
    roots = quartic.deriv().roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    away = float(np.abs(real - np.log(best)).min())
    report.check("sigma2: distance to the lowest point of the scan", away, "<",
                 error + 0.2 * float(np.log(scan[1] / scan[0])))  # fmt: skip
    laid_as_predicted(report, "sigma2", design)
    save_figure(plot_web_design(design), "web_design_sigma2.png")
    larger = replace(PROCESS, sigma1=0.015, sigma2=0.015, noise=20.0 / np.sqrt(3.0))
    other = studies.design_web(
        larger, [0.015], spacing=3 * WIDE, titer=TITER, free=["sigma2"], n_webs=0,
        bounds={"sigma2": tuple(3 * one for one in SIGMA2)}, tolerance=TOLERANCE,
    )  # fmt: skip
    ratio = abs(value(other, "sigma2")[0] / (3 * best) - 1)
    report.check("three times as large: difference of the optimum", ratio, "<", 1e-6)


def fastest(report: Report) -> None:
    """Belt speed and titer at one spacing, where a scan crosses the bound of CV."""
    bound = 0.07
    design = designed(
        {0.01: bound}, NARROW, free=["speed_ratio", "titer"],
        bounds={"speed_ratio": SPEED, "titer": (2e-5, 1e-3)},
    )  # fmt: skip
    scan = np.geomspace(*SPEED, N_GRID)
    found = np.array([
        predicted(replace(PROCESS, speed_ratio=float(one)), NARROW, 0.01)
        for one in scan
    ])  # fmt: skip
    report.table([
        {"speed ratio": float(one), "log CV": float(row[0]), "error": float(row[1])}
        for one, row in zip(scan, found, strict=True)
    ])  # fmt: skip
    cubic = np.polynomial.Polynomial.fit(found[:, 0], np.log(scan), N_GRID - 1)
    best, error = value(design, "speed_ratio")
    away = abs(float(cubic(np.log(bound))) - np.log(best))
    # Log CV is half of log v and little more, which a cubic has to a tenth of a cent.
    report.check("fastest belt: distance to the crossing of a scan", away, "<",
                 error + 2 * float(found[:, 1].max()) + 1e-3)  # fmt: skip
    report.check("fastest belt: how far its CV is from the bound",
                 abs(float(design.cv[0]) / bound - 1), "<", 1e-4)  # fmt: skip
    laid_as_predicted(report, "fastest belt", design)


def two_parameters(report: Report) -> None:
    """Throwing range and belt speed at fixed titer, against a grid."""
    design = designed(
        [0.005], WIDE, free=["sigma2", "speed_ratio", "spacing"],
        bounds={"sigma2": SIGMA2, "speed_ratio": SPEED},
    )  # fmt: skip
    rows = []
    for sigma2 in np.geomspace(*SIGMA2, N_GRID):
        for speed in np.geomspace(*SPEED, N_GRID):
            process = replace(PROCESS, sigma2=float(sigma2), speed_ratio=float(speed))
            spacing = WIDE * PROCESS.speed_ratio / float(speed)
            log, error = predicted(process, spacing, 0.005)
            rows.append({"sigma2": float(sigma2), "speed ratio": float(speed),
                         "log CV": log, "error": error})  # fmt: skip
    report.table(rows)
    lead = float(np.log(design.cv[0])) - min(row["log CV"] for row in rows)
    known = float(design.errors[0] / design.cv[0])
    report.check("two parameters: the grid is not better, beyond errors", lead, "<",
                 known + max(row["error"] for row in rows))  # fmt: skip
    report.check("two parameters: gradient left", design.kkt_residual, "<", 2e-2)
    laid_as_predicted(report, "two parameters", design)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the fastest belt alone")
    options = parser.parse_args()
    report = Report("web_design", options.quick)
    fastest(report)
    if not options.quick:
        between_strips_and_clouds(report)
        two_parameters(report)
    report.finish()


if __name__ == "__main__":
    main()
