"""Gradients of predicted CV against differences, against finer ones, and their cost.

Claims: central differences of the variance of zones, of spectra between the same nodes,
converge to the gradient with the order two at every halving, in every parameter;
extrapolated differences of `predict_web` at a tighter tolerance lie within the errors
of the gradient; so do gradients at a tighter tolerance; and a prediction with gradients
takes less than two and a half times as long as one without, and gives the same CV.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.web.table import Source, SpectrumTable
from fpsolve.web.zone_variance import zone_variance

# Noise, belt speed, σ2, spacing, positions.
QUICK = [(2.0, 0.2, 0.8, 1.5, "regular")]
FULL = [
    (1.5, 0.1, 1.0, 0.5, "regular"),
    (2.0, 0.3, 0.7, 3.0, "regular"),
    (2.0, 0.2, 1.3, 1.0, "random"),
    (5.0, 0.1, 1.0, 0.2, "regular"),
    (10.0, 0.05, 0.8, 0.5, "random"),
]
ZONES = (0.2, 1.0, 5.0)
# Relative steps of differences between the same nodes, and of predictions, which have
# nodes of their own.
STEPS, WIDE = (0.08, 0.04, 0.02), 0.05
TIGHT = 2e-3


@dataclass(eq=False)
class Kept(Ladder):
    """A ladder that chooses the wave vectors and truncations of another model."""

    kept: tuple[float, float] = (1.0, 1.0)

    @property
    def scales(self) -> tuple[float, float]:
        return self.kept


def belt(numbers: np.ndarray) -> fp.LayDownModel:
    noise, speed, sigma1, sigma2 = numbers[:4]
    potential = fp.QuadraticPotential(sigma1, sigma2)
    return fp.LayDownModel(potential, noise, fp.MovingBelt(speed))


def predicted(numbers: np.ndarray, positions: str, **options) -> fp.WebPrediction:
    return fp.predict_web(
        belt(numbers), spacing=numbers[4], zones=ZONES, positions=positions, **options
    )


def changed(numbers: np.ndarray, parameter: int, share: float) -> np.ndarray:
    return numbers * (1 + share * np.eye(numbers.size)[parameter])


def check_orders(report: Report, numbers: np.ndarray) -> None:
    """∂ of the variance of zones in A, v, σ1, σ2, of a table that keeps its nodes."""
    tolerance = 1e-6
    ladder = Ladder(belt(numbers))
    table = SpectrumTable.of(ladder, tolerance, gradients=True)
    rows = []
    for parameter, name in enumerate(Generator.parameters):
        exact = zone_variance(table.derivative(parameter), 1.0, table)[0]
        errors = []
        for share in STEPS:
            pair = []
            for sign in (1, -1):
                model = belt(changed(numbers, parameter, sign * share))
                source = Source(Kept(model, ladder.scales), tolerance)
                pair.append(zone_variance(SpectrumTable(source, table.nodes), 1.0)[0])
            step = 2 * share * numbers[parameter]
            errors.append(abs((pair[0] - pair[1]) / step - exact))
        orders = [math.log2(a / b) for a, b in pairwise(errors)]
        away = max(abs(order - 2) for order in orders)
        rows.append({"parameter": name, "derivative": exact, "last error": errors[-1],
                     "orders": ", ".join(f"{one:.2f}" for one in orders)})  # fmt: skip
        report.check(f"{name}: |order - 2|", away, "<", 0.2)
    report.table(rows)


def check_differences(report: Report, numbers: np.ndarray, positions: str) -> None:
    """Distance over error of extrapolated differences, finer gradients, and Euler's."""
    label = f"A = {numbers[0]:g}, v = {numbers[1]:g}, {positions}"
    began = time.process_time()
    plain = predicted(numbers, positions)
    plain_seconds = time.process_time() - began
    began = time.process_time()
    web = predicted(numbers, positions, gradients=True)
    ratio = (time.process_time() - began) / plain_seconds
    fine = predicted(numbers, positions, gradients=True, tolerance=TIGHT)
    rows, shares = [], []
    for parameter, name in enumerate(web.parameters):
        slopes = []
        for share in (WIDE, 0.5 * WIDE):
            there, back = (
                predicted(changed(numbers, parameter, s), positions, tolerance=TIGHT)
                for s in (share, -share)
            )
            slopes.append((there.cv - back.cv) / (2 * share * numbers[parameter]))
        slope = (4 * slopes[1] - slopes[0]) / 3
        error = web.gradient_errors[parameter]
        shares.append(np.max(np.abs(slope - web.gradient[parameter]) / error))
        for place, zone in enumerate(ZONES):
            rows.append({
                "A": numbers[0], "parameter": name, "zone": zone,
                "gradient": web.gradient[parameter, place],
                "error": error[place], "difference": slope[place],
                "at tighter tolerance": fine.gradient[parameter, place],
            })  # fmt: skip
    report.table(rows)
    report.check(f"{label}: distance of differences over error", max(shares), "<", 1.0)
    covered = np.abs(web.gradient - fine.gradient)
    covered = covered / (web.gradient_errors + fine.gradient_errors)
    report.check(f"{label}: distance of finer ones", float(covered.max()), "<", 1.0)
    relative = np.abs(numbers)[:, None] * web.gradient_errors / web.cv
    report.check(f"{label}: error of ∂ log CV", float(relative.max()), "<", 0.25)
    report.check(f"{label}: seconds over those of CV alone", ratio, "<", 2.5)
    report.table([{"A": numbers[0], "seconds of CV": plain_seconds, "ratio": ratio,
                   "largest error of ∂ log CV": float(relative.max())}])  # fmt: skip
    report.check(
        f"{label}: CV differs", float(np.abs(web.cv - plain.cv).max()), "<=", 0
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one model")
    quick = parser.parse_args().quick
    report = Report("web_gradients", quick)
    cases = QUICK if quick else FULL
    check_orders(report, np.array([2.0, 0.2, 1.0, 0.8]))
    for noise, speed, sigma2, spacing, positions in cases:
        numbers = np.array([noise, speed, 1.0, sigma2, spacing])
        check_differences(report, numbers, positions)
    report.finish()


if __name__ == "__main__":
    main()
