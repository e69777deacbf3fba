"""Gradients of predicted CV against differences, against finer ones, and their cost.

Claims: central differences of `predict_web` at a tighter tolerance lie within errors
of the gradient, in every parameter; so do gradients at a tighter tolerance; and a
prediction with gradients takes less than two and a half times as long as one without,
and gives the same CV. That differences converge with the order two at every halving
needs the same nodes and truncations: tests/web/test_web_gradient_orders.py.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from reporting import Report

import fpsolve as fp

# Noise, belt speed, σ2, spacing, positions.
QUICK = [(2.0, 0.2, 0.8, 1.5, "regular")]
FULL = [
    (2.0, 0.3, 0.7, 3.0, "regular"),
    (2.0, 0.2, 1.3, 1.0, "random"),
    (5.0, 0.1, 1.0, 0.2, "regular"),
    (10.0, 0.05, 0.8, 0.5, "random"),
]
ZONES = (0.2, 1.0, 5.0)
# Relative step of differences. They leave h²/6 of the third derivative, up to 2 % where
# strips are strong: steps of half the size are combined with them to order four.
STEP = 0.05
# Tolerances of the gradient, of the finer one, and of predictions that are subtracted:
# their nodes move with σ, and what that changes of CV is divided by the step.
LOOSE, TIGHT, TIGHTEST = 2e-2, 5e-3, 5e-4


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


def check_case(
    report: Report, numbers: np.ndarray, positions: str, parameters: tuple[int, ...]
) -> None:
    """Cost, coverage of gradients at a tighter tolerance, and of differences."""
    label = f"A = {numbers[0]:g}, v = {numbers[1]:g}, {positions}"
    began = time.process_time()
    plain = predicted(numbers, positions, tolerance=LOOSE)
    seconds = time.process_time() - began
    began = time.process_time()
    web = predicted(numbers, positions, gradients=True, tolerance=LOOSE)
    ratio = (time.process_time() - began) / seconds
    relative = float((np.abs(numbers)[:, None] * web.gradient_errors / web.cv).max())
    report.table([{"A": numbers[0], "seconds of CV": seconds, "ratio": ratio,
                   "largest error of ∂ log CV": relative}])  # fmt: skip
    report.check(f"{label}: seconds over those of CV alone", ratio, "<", 2.5)
    report.check(f"{label}: error of ∂ log CV", relative, "<", 0.1)
    report.check(
        f"{label}: CV differs", float(np.abs(web.cv - plain.cv).max()), "<=", 0
    )
    fine = predicted(numbers, positions, gradients=True, tolerance=TIGHT)
    covered = np.abs(web.gradient - fine.gradient)
    covered = covered / (web.gradient_errors + fine.gradient_errors)
    report.check(f"{label}: distance of finer ones", float(covered.max()), "<", 1.0)
    check_differences(report, numbers, positions, parameters, web)


def check_differences(
    report: Report,
    numbers: np.ndarray,
    positions: str,
    parameters: tuple[int, ...],
    web: fp.WebPrediction,
) -> None:
    """Distance over error of differences of predictions, extrapolated to order 4."""
    for parameter in parameters:
        name = web.parameters[parameter]
        wide, half = (
            central(numbers, positions, parameter, step) for step in (STEP, STEP / 2)
        )
        slope = (4 * half - wide) / 3
        error = web.gradient_errors[parameter]
        rows = [
            {"A": numbers[0], "parameter": name, "zone": zone,
             "gradient": web.gradient[parameter, place], "error": error[place],
             "difference": slope[place]}
            for place, zone in enumerate(ZONES)
        ]  # fmt: skip
        report.table(rows)
        away = float(np.max(np.abs(slope - web.gradient[parameter]) / error))
        label = f"A = {numbers[0]:g}, {positions}: distance over error by {name}"
        report.check(label, away, "<", 1.0)


def central(
    numbers: np.ndarray, positions: str, parameter: int, step: float
) -> np.ndarray:
    """Central difference of CV of every zone, at the tightest tolerance."""
    there, back = (
        predicted(changed(numbers, parameter, share), positions, tolerance=TIGHTEST).cv
        for share in (step, -step)
    )
    return np.asarray((there - back) / (2 * step * numbers[parameter]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--quick", action="store_true", help="one model, three parameters"
    )
    parser.add_argument("--cases", type=int, nargs="+", help="some of the full ones")
    options = parser.parse_args()
    quick = options.quick
    report = Report("web_gradients", quick)
    cases = QUICK if quick else FULL
    if options.cases:
        cases = [FULL[number] for number in options.cases]
    for noise, speed, sigma2, spacing, positions in cases:
        numbers = np.array([noise, speed, 1.0, sigma2, spacing])
        check_case(report, numbers, positions, (0, 1, 3) if quick else (0, 1, 2, 3, 4))
    report.finish()


if __name__ == "__main__":
    main()
