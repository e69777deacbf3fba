"""The gap of smooth fibres on belts and about unequal throwing ranges: what is reached.

Claims: errors of the gap cover the distance to the gap of a smaller tolerance, and to a
polynomial Galerkin method in ξ1, ξ2, α and κ that shares nothing with the expansion;
with v → 0 the gap tends to that of the belt at rest like v², with R → 0 to that of the
basic model like R. What is refused is printed as such.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path

from reporting import Report

import fpsolve as fp
from fpsolve.errors import MemoryLimitError, ToleranceError

sys.path.append(str(Path(__file__).parents[1] / "tests" / "support"))
from polynomial_galerkin import galerkin_rate

# (R, A, v, σ2/σ1).
QUICK = [(0.1, 3.0, 0.2, 1.0), (0.3, 1.5, 0.95, 1.0)]
FULL = [
    *QUICK,
    (0.1, 2.0, 0.2, 1.0),
    (0.1, 3.0, 0.6, 1.0),
    (0.3, 3.0, 0.2, 1.3),
    (0.3, 1.5, 0.2, 1.3),
    (1.0, 2.0, 0.1, 1.0),
    (0.3, 8.0, 0.2, 1.0),
]
COARSE, FINE = 1e-2, 1e-4


def fibre(length: float, noise: float, speed: float = 0.0, ratio: float = 1.0):
    belt = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.SmoothLayDownModel(fp.QuadraticPotential(1.0, ratio), length, noise, belt)


def measured(case: tuple[float, ...], tolerance: float) -> tuple[dict, float, float]:
    """A row of the table, the gap and its error; NaN where it is refused."""
    began, value, error, note = time.process_time(), math.nan, math.nan, ""
    try:
        gap = fp.spectral_gap(fibre(*case), tolerance=tolerance)
        value, error, note = float(gap), gap.error, str(gap.sector)
    except (ToleranceError, MemoryLimitError, ValueError) as refusal:
        note = f"refused: {str(refusal)[:60]}"
    row = dict(zip(("R", "A", "v", "σ2/σ1"), case, strict=True))
    row |= {"gap": f"{value:.6f}", "error": error, "mode": note}
    return row | {"CPU s": time.process_time() - began}, value, error


def check_coverage(report: Report, cases: list[tuple[float, ...]]) -> None:
    """The distance between two tolerances over both errors."""
    rows, shares = [], [0.0]
    for case in cases:
        row, coarse, error = measured(case, COARSE)
        rows.append(row)
        if math.isnan(coarse):
            continue
        row, fine, finer = measured(case, FINE)
        if not math.isnan(fine):
            rows.append(row)
            shares.append(abs(coarse - fine) / (error + finer))
    report.table(rows)
    report.check("distance of two tolerances / errors", max(shares), "<=", 1.0)


def check_rest(report: Report) -> None:
    """(gap(v) - gap(0))/v² of one parity at two speeds; changes are even in v."""
    at_rest = float(fp.spectral_gap(fibre(0.1, 3.0)))
    found = [fp.spectral_gap(fibre(0.1, 3.0, v), tolerance=1e-4) for v in (0.2, 0.1)]
    changes = [float(gap) - at_rest for gap in found]
    report.table([{"v": v, "gap - gap at rest": change}
                  for v, change in zip((0.2, 0.1), changes, strict=True)])  # fmt: skip
    ratio = changes[0] / changes[1]
    # 4 but for v⁴ and errors of 1e-4 of the gap, 0.6 % of the smaller change.
    report.check("v → 0: |ratio of changes / 4 − 1|", abs(ratio / 4 - 1), "<", 0.02)


def check_white_noise(report: Report) -> None:
    """Distances to the gap of the basic model at R and R/2."""
    limit = float(fp.spectral_gap(fibre(1.0, 3.0, 0.2, 1.3).white_noise_limit))
    lengths = (0.04, 0.02)
    found = [fp.spectral_gap(fibre(R, 3.0, 0.2, 1.3), tolerance=1e-4) for R in lengths]
    distances = [float(gap) - limit for gap in found]
    report.table([{"R": R, "gap - gap at R = 0": distance}
                  for R, distance in zip(lengths, distances, strict=True)])  # fmt: skip
    ratio = distances[0] / distances[1]
    # 2 but for R², R being 0.04, and errors of 1e-4.
    report.check("R → 0: |ratio of distances / 2 − 1|", abs(ratio / 2 - 1), "<", 0.15)


def check_galerkin(report: Report) -> None:
    """Against polynomials in ξ and κ times trigonometric functions of α."""
    case = (0.1, 3.0, 0.2, 1.3)
    gap = fp.spectral_gap(fibre(*case), tolerance=FINE)
    near = float(gap)
    parity = gap.sector.parity
    values = [
        galerkin_rate(case, parity, sizes, near) for sizes in ((6, 5, 5), (8, 7, 7))
    ]
    report.table([{"gap": f"{near:.6f}", "Galerkin": f"{values[-1]:.6f}"}])
    allowed = gap.error + abs(values[1] - values[0])
    report.check("distance to Galerkin / both errors", abs(near - values[1]) / allowed,
                 "<=", 1.0)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two models")
    quick = parser.parse_args().quick
    report = Report("smooth_belt_spectra", quick)
    check_galerkin(report)
    check_rest(report)
    check_white_noise(report)
    check_coverage(report, QUICK if quick else FULL)
    report.finish()


if __name__ == "__main__":
    main()
