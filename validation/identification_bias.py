"""What the distance of points costs identified parameters: the same fibres, thinned.

Claims: of synthetic fibres, of which every point, every second and every fourth is
taken, A and K at the largest distance differ from those at the smallest by less than
0.007 (κ_rms Δs)², which the standard errors hold where it shows, and 1/σ² by less than
half of a standard error of a fibre; both beside 3.5 standard errors of the difference.
Rows tell in per cent by how much the mean over the fibres is off the true parameters.
"""

from __future__ import annotations

import argparse
import math
from typing import Any, NamedTuple

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.studies.identification import synthetic
from fpsolve.studies.identification.determined import chord_bias
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.likelihood_basic import basic_maximum
from fpsolve.studies.identification.likelihood_smooth import smooth_maximum

BELT, NOZZLE = fp.MovingBelt(0.3), fp.RotatingNozzle(0.1, 0.5, 0.4)
NARROW, ROUND = fp.QuadraticPotential(1.0, 0.7), fp.QuadraticPotential()
LENGTH, SETTLE = 1000.0, 60.0
# Steps between two points: twice what the coverage study takes.
synthetic._N_STEPS, synthetic._N_SMOOTH_STEPS = 32, 16


class Case(NamedTuple):
    """Fibres of a model, with points at ds, 2 ds and 4 ds."""

    model: Any
    n_fibres: int
    ds: float
    settle: float = SETTLE


CASES = [
    Case(fp.LayDownModel(NARROW, 0.3, NOZZLE), 40, 0.05),
    Case(fp.SmoothLayDownModel(NARROW, 1.0, 0.3, BELT), 30, 0.05),
    Case(fp.SmoothLayDownModel(ROUND, 0.2, 3.0, NOZZLE), 20, 0.025),
    Case(fp.SmoothLayDownModel(ROUND, 0.05, 10.0, BELT), 8, 0.005, 300.0),
    Case(fp.LayDownModel(ROUND, 10.0, BELT), 8, 0.0015, 300.0),
]


def found(model: Any, eta: np.ndarray, ds: float) -> tuple[np.ndarray, np.ndarray]:
    """Relative distances from the truth of (1/σ1², 1/σ2², A, K), and their errors."""
    smooth = isinstance(model, fp.SmoothLayDownModel)
    curve = fp.FibreCurve(eta, ds, model.curve)
    top = (smooth_maximum if smooth else basic_maximum)(Likelihood.of(curve))
    ranges = np.array([model.potential.sigma1, model.potential.sigma2]) ** 2
    away = [*(top.at[:2] * ranges - 1), top.at[2] - math.log(model.noise)]
    covariance = top.covariance()
    errors = [*(np.sqrt(np.diagonal(covariance)[:2]) * ranges), covariance[2, 2] ** 0.5]
    if smooth:
        away.append(away[2] - top.at[3] + math.log(model.relaxation_length))
        errors.append(float(np.array([1, -1]) @ covariance[2:, 2:] @ [1, -1]) ** 0.5)
    return np.array(away), np.array(errors)


def check_case(report: Report, case: Case, n_fibres: int) -> None:
    """Rows of a case at three distances, and what the largest costs."""
    model = case.model
    fibres = synthetic.laid_fibres(
        model, n_fibres, round(LENGTH / case.ds) + 1, case.ds, seed=77,
        settle=case.settle,
    )  # fmt: skip
    all_, errors = {}, {}
    for thin in (4, 2, 1):
        ds = thin * case.ds
        pairs = [found(model, eta[::thin], ds) for eta in fibres]
        all_[thin] = np.array([away for away, _ in pairs])
        errors[thin] = np.mean([error for _, error in pairs], axis=0)
        report.table([{
            "A": model.noise, "R": getattr(model, "relaxation_length", 0.0),
            "ds": ds, "fibres": n_fibres,
            "off by %": listed(100 * all_[thin].mean(axis=0)),
            "±": listed(100 * all_[thin].std(axis=0, ddof=1) / math.sqrt(n_fibres)),
            "one fibre ±": listed(100 * errors[thin]),
        }])  # fmt: skip
    change = all_[4] - all_[1]
    chance = 3.5 * change.std(axis=0, ddof=1) / math.sqrt(n_fibres)
    curves = [fp.FibreCurve(eta[::4], 4 * case.ds, model.curve) for eta in fibres]
    noted = np.mean([chord_bias(curve)[1] for curve in curves])
    report.table([{
        "A": model.noise, "4 ds less ds %": listed(100 * change.mean(axis=0)),
        "±": listed(100 * chance / 3.5), "noted %": f"{100 * noted:.3f}",
    }])  # fmt: skip
    away = np.abs(change.mean(axis=0))
    label = f"A = {model.noise:g}: "
    of_noises = (away[2:] / (noted + chance[2:])).max()
    of_ranges = (away[:2] / (0.5 * errors[4][:2] + chance[:2])).max()
    report.check(label + "A, K over what is noted", of_noises, "<", 1.0)
    report.check(label + "1/σ² over half an error", of_ranges, "<", 1.0)


def listed(values: np.ndarray) -> str:
    return " ".join(f"{value:.3f}" for value in values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="3 cases of 5, 4 fibres")
    parser.add_argument("--cases", type=int, nargs="*", help="some of them")
    options = parser.parse_args()
    report = Report("identification_bias", options.quick)
    chosen = CASES[:3] if options.quick else CASES
    if options.cases:
        chosen = [CASES[number] for number in options.cases]
    for case in chosen:
        check_case(report, case, 4 if options.quick else case.n_fibres)
    report.finish()


if __name__ == "__main__":
    main()
