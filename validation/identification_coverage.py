"""Parameters identified by likelihood from synthetic fibres, against the true ones.

Claims: over many fibres of basic and smooth models, on belts and under rotating
nozzles, the 95 % intervals cover the true parameters in 90 to 99 % of the cases; the
mean of (found - true)/(standard error) is below what chance or a bias of a quarter of a
standard error would make it; the spread is what the standard errors say. Fibres with
errors in their points are among them. Where the estimator notes that the points are too
far apart for its errors, the mean of A and of K is within what it notes. What other
potentials do is printed, not claimed.
"""

from __future__ import annotations

import argparse
import math
import time
from typing import NamedTuple

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.studies.identification.coordinates import interval, named
from fpsolve.studies.identification.determined import chord_bias
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.likelihood_basic import estimate_basic
from fpsolve.studies.identification.likelihood_smooth import (
    estimate_smooth,
    smooth_maximum,
)
from fpsolve.studies.identification.synthetic import laid_fibres

BELT, NOZZLE = fp.MovingBelt(0.3), fp.RotatingNozzle(0.1, 0.5, 0.4)


class Case(NamedTuple):
    """Fibres of one kind; the basic model where the relaxation length is 0."""

    noise: float
    relaxation_length: float
    sigma2: float
    curve: fp.Curve
    length: float
    ds: float
    n_fibres: int
    position_error: float = 0.0


QUICK = [
    Case(1.0, 0.0, 0.7, BELT, 200.0, 0.2, 20),
    Case(1.0, 0.5, 0.7, NOZZLE, 200.0, 0.2, 20),
]
FULL = [
    Case(0.3, 0.0, 0.7, BELT, 200.0, 0.1, 100),
    Case(1.0, 0.0, 0.7, BELT, 1000.0, 0.1, 60),
    Case(1.0, 0.0, 0.7, NOZZLE, 1000.0, 0.2, 60),
    Case(3.0, 0.0, 0.7, NOZZLE, 1000.0, 0.05, 30),
    Case(10.0, 0.0, 1.0, BELT, 2000.0, 0.006, 8),
    Case(0.3, 1.0, 0.7, BELT, 200.0, 0.2, 100),
    Case(1.0, 0.5, 0.7, BELT, 200.0, 0.1, 60),
    Case(1.0, 0.5, 0.7, NOZZLE, 1000.0, 0.2, 40),
    Case(1.0, 0.5, 0.7, BELT, 1000.0, 0.2, 40, 0.002),
    Case(3.0, 0.2, 1.0, NOZZLE, 1000.0, 0.1, 40),
    Case(10.0, 0.05, 1.0, BELT, 5000.0, 0.02, 8),
]


def model_of(case: Case) -> fp.LayDownModel | fp.SmoothLayDownModel:
    potential = fp.QuadraticPotential(1.0, case.sigma2)
    if not case.relaxation_length:
        return fp.LayDownModel(potential, case.noise, case.curve)
    return fp.SmoothLayDownModel(
        potential, case.relaxation_length, case.noise, case.curve
    )


def true_parameters(case: Case) -> dict[str, float]:
    found = {"sigma1": 1.0, "sigma2": case.sigma2, "noise": case.noise}
    if case.relaxation_length:
        found["curvature_noise"] = case.noise / case.relaxation_length
    return found


def fibres(case: Case, seed: int) -> list[fp.FibreCurve]:
    n_points = round(case.length / case.ds) + 1
    eta = laid_fibres(
        model_of(case), case.n_fibres, n_points, case.ds,
        seed=seed, position_error=case.position_error,
    )  # fmt: skip
    error = case.position_error
    return [
        fp.FibreCurve(one, case.ds, case.curve, position_error=error) for one in eta
    ]


def even(name: str, value: float) -> float:
    """The coordinate in which the likelihood is nearly a parabola."""
    return value**-2 if name.startswith("sigma") else math.log(value)


def row_of(
    case: Case, seed: int
) -> tuple[dict[str, object], np.ndarray, np.ndarray, float]:
    """What is printed, scores (n_fibres, n_parameters) and whether intervals cover.

    Last, the mean of A and K beside what is noted of them, 0 where nothing is.
    """
    curves, truth = fibres(case, seed), true_parameters(case)
    estimate = estimate_smooth if case.relaxation_length else estimate_basic
    began, scores, covers, open_ = time.perf_counter(), [], [], 0
    noted, away_of, allowed = 0, [], []
    for curve in curves:
        try:
            found = estimate(curve)
        except ValueError:
            # 1/σ² is found negative, which no interval covers.
            covers.append([False] * len(truth))
            continue
        open_ += bool(found.undetermined)
        noted += bool(found.notes)
        errors = np.sqrt(np.diagonal(found.covariance))
        values = np.array(list(found.parameters.values()))
        away_of.append(np.log(values / list(truth.values()))[2:])
        chance = 3.5 * (errors / values)[2:] / math.sqrt(case.n_fibres)
        allowed.append(chord_bias(curve)[1] + chance)
        scores.append([]), covers.append([])
        for (name, value), error in zip(found.parameters.items(), errors, strict=True):
            low, high = interval(name, value, error, 1.96)
            steep = 2 * value**-3 if name.startswith("sigma") else 1 / value
            away = even(name, value) - even(name, truth[name])
            scores[-1].append(away / (steep * error))
            covers[-1].append(low <= truth[name] <= high)
    z, covered = np.array(scores), np.array(covers)
    each = (time.perf_counter() - began) / case.n_fibres
    row = {
        "A": case.noise, "R": case.relaxation_length, "sigma2": case.sigma2,
        "curve": type(case.curve).__name__, "length": case.length, "ds": case.ds,
        "error": case.position_error, "fibres": case.n_fibres,
        "mean z": listed(z.mean(axis=0)), "spread of z": listed(z.std(axis=0, ddof=1)),
        "covered": listed(covered.mean(axis=0)), "open": open_,
        "refused": len(curves) - len(z), "noted": noted,
        "A, K off by %": listed(100 * np.mean(away_of, axis=0)),
        "s each": round(each, 2),
    }  # fmt: skip
    beside = np.abs(np.mean(away_of, axis=0)) / np.mean(allowed, axis=0)
    return row, z, covered, float(beside.max()) if noted else 0.0


def listed(values: np.ndarray) -> str:
    return " ".join(f"{value:.2f}" for value in values)


def check_cases(report: Report, cases: list[Case], seed: int) -> None:
    """Intervals of all cases together, means and spreads case by case."""
    covered, means, spreads = [], [], []
    for number, case in enumerate(cases):
        row, z, covers, beside = row_of(case, seed + number)
        report.table([row])
        if beside:
            label = f"A = {case.noise:g}, R = {case.relaxation_length:g}: A, K off"
            report.check(f"{label} over what is noted", beside, "<", 1.0)
            continue
        covered += list(covers.ravel())
        n = case.n_fibres
        means.append(np.abs(z.mean(axis=0)).max() / (0.25 + 3.5 / math.sqrt(n)))
        spreads.append(
            np.abs(z.std(axis=0, ddof=1) - 1).max() / (3.5 / math.sqrt(2 * n))
        )
    if not covered:
        return
    report.check("largest mean of z over its bound", max(means), "<", 1.0)
    report.check("largest |spread of z - 1| over its bound", max(spreads), "<", 1.0)
    # Few intervals cover by chance less often than 0.95 says.
    slack = 2.6 * math.sqrt(0.95 * 0.05 / len(covered))
    share = float(np.mean(covered))
    report.check("95 % intervals that cover", share, ">", 0.90 - slack)
    report.check("95 % intervals that cover", share, "<", min(0.99 + slack, 1.0001))


def show_misspecified(report: Report) -> None:
    """What is found of a fibre in B = |ξ|⁴/4, and of scattered points."""
    model = fp.SmoothLayDownModel(fp.PowerPotential(4.0), 0.5, 1.0, BELT)
    paths = fp.sample_paths(model, 1, 520.0, 0.05, seed=3)
    path = paths.replay(0, 4)
    inside = path.s >= 20.0 - 1e-9
    curve = fp.FibreCurve(path.eta[inside], 0.2, BELT, s_start=20.0)
    spread = np.std(path.xi[inside], axis=0)
    exact = Case(1.0, 0.5, 1.0, BELT, 500.0, 0.2, 1)
    scattered = fibres(exact._replace(position_error=0.005), 4)[0]
    quarter = f"B = r⁴/4, spread of ξ {listed(spread)}"
    for name, one in ((quarter, curve), ("errors of 0.005, told", scattered)):
        smooth, basic = estimate_smooth(one), estimate_basic(one)
        report.table([{
            "fibre": name,
            **{key: round(value, 4) for key, value in smooth.parameters.items()},
            "ln L - basic": round(smooth.log_likelihood - basic.log_likelihood, 1),
        }])  # fmt: skip
    # A curve with chords longer than Δs is refused; the likelihood alone does not know.
    chords = Likelihood.of(scattered).fibres
    untold = smooth_maximum(Likelihood(chords, scattered.ds))
    report.table([{"fibre": "errors of 0.005, not told", **{
        key: round(value, 4) for key, value in named(untold.at).items()
    }}])  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="2 cases of 11")
    parser.add_argument("--cases", type=int, nargs="*", help="some of the full ones")
    parser.add_argument("--misspecified", action="store_true",
                        help="only fibres that are not of the model")  # fmt: skip
    options = parser.parse_args()
    report = Report("identification_coverage", options.quick)
    if options.misspecified:
        show_misspecified(report)
        return
    cases = QUICK if options.quick else FULL
    if options.cases:
        cases = [FULL[number] for number in options.cases]
    check_cases(report, cases, seed=1)
    if not options.quick and not options.cases:
        show_misspecified(report)
    report.finish()


if __name__ == "__main__":
    main()
