"""Spread of identified parameters against the bound of Cramér and Rao.

Of a fibre of length L that is known at every point the turns are dα = f ds + A dW, or
R dκ = (f - κ) ds + A dW, with a force that is linear in 1/σ²: the Fisher information
of 1/σ1² is ∫ (ξ1 sin α)² ds/A², whether the fibre is smooth or not; of a basic fibre on
a belt at rest L σ1²/2A², so that no unbiased estimate spreads less than A √(2/L)/σ1.
The noise of a basic fibre is the scale of n Gaussian numbers: ln A spreads by 1/√(2n)
at least.

Claims: the likelihood of the chords attains both within chance and a tenth. What the
functional reports of one fibre is printed beside the bound, not claimed.
"""

from __future__ import annotations

import argparse
import math
from typing import Any, NamedTuple

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.studies.identification.functional_estimate import estimate_by_functional
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.likelihood_basic import basic_maximum
from fpsolve.studies.identification.likelihood_smooth import smooth_maximum
from fpsolve.studies.identification.synthetic import laid_fibres

POTENTIAL, LENGTH = fp.QuadraticPotential(), 500.0
N_FIBRES = {True: 10, False: 60}
# How far above the bound chords of a step of this size may be, beside chance.
ABOVE, DEVIATIONS = 1.1, 3.5


class Case(NamedTuple):
    """Fibres of a model on a belt at rest, and whether the functional is tried."""

    model: Any
    ds: float
    functional: bool = False


CASES = [
    Case(fp.LayDownModel(POTENTIAL, 0.3), 0.1),
    Case(fp.LayDownModel(POTENTIAL, 1.0), 0.1, True),
    Case(fp.LayDownModel(POTENTIAL, 3.0), 0.03),
    Case(fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0), 0.1, True),
]


def check_case(report: Report, case: Case, n_fibres: int) -> None:
    """The spread of 1/σ² and ln A over fibres, in units of their bounds."""
    model, n = case.model, round(LENGTH / case.ds)
    basic = isinstance(model, fp.LayDownModel)
    maximum = basic_maximum if basic else smooth_maximum
    fibres = [
        fp.FibreCurve(eta, case.ds, model.curve)
        for eta in laid_fibres(model, n_fibres, n + 1, case.ds, seed=11)
    ]
    found = np.array([maximum(Likelihood.of(fibre)).at[:3] for fibre in fibres])
    away = found - [1.0, 1.0, math.log(model.noise)]
    spread = np.sqrt(np.mean(away**2, axis=0))
    information = np.mean([fisher_information(fibre) for fibre in fibres], axis=0)
    bounds = np.append(model.noise / np.sqrt(information), 1 / math.sqrt(2 * n))
    ratios = spread / bounds
    of_sigma = float(np.sqrt(np.mean(ratios[:2] ** 2)))
    row = {
        "A": model.noise, "R": getattr(model, "relaxation_length", 0.0), "ds": case.ds,
        "fibres": n_fibres, "1/σ² over bound": of_sigma,
        "ln A over bound": float(ratios[2]) if basic else math.nan,
        "functional": functional_over_bound(fibres[0], basic, bounds[0])
        if case.functional else math.nan,
    }  # fmt: skip
    report.table([row])
    label = f"A = {model.noise:g}, R = {row['R']:g}"
    # Two throwing ranges of a fibre are independent.
    chance = DEVIATIONS / math.sqrt(2 * 2 * n_fibres)
    report.check(f"{label}: 1/σ² over its bound", of_sigma, "<", ABOVE + chance)
    report.check(f"{label}: 1/σ² over its bound", of_sigma, ">", 1 - chance)
    if basic:
        chance = DEVIATIONS / math.sqrt(2 * n_fibres)
        report.check(f"{label}: ln A over its bound", ratios[2], "<", ABOVE + chance)
        report.check(f"{label}: ln A over its bound", ratios[2], ">", 1 - chance)


def fisher_information(fibre: fp.FibreCurve) -> np.ndarray:
    """∫ (ξ1 sin α)² ds and ∫ (ξ2 cos α)² ds, by the middles of chords."""
    (alpha,), (xi,) = fibre.angles, fibre.deviations
    middle = 0.5 * (xi[1:] + xi[:-1])
    forces = middle * np.stack([np.sin(alpha), np.cos(alpha)], axis=-1)
    return fibre.ds * np.sum(forces**2, axis=0)


def functional_over_bound(fibre: fp.FibreCurve, basic: bool, bound: float) -> float:
    """The error of σ1 that the functional reports, as one of 1/σ1², over the bound."""
    found = estimate_by_functional(fibre, "basic" if basic else "smooth")
    error, value = math.sqrt(found.covariance[0, 0]), found.parameters["sigma1"]
    return 2 * error / value**3 / bound


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few fibres of two models")
    parser.add_argument("--fibres", type=int, help="fewer than 60 of each")
    options = parser.parse_args()
    report = Report("identification_efficiency", options.quick)
    for case in CASES[1::2] if options.quick else CASES:
        chosen = case._replace(functional=False) if options.quick else case
        check_case(report, chosen, options.fibres or N_FIBRES[options.quick])
    report.finish()


if __name__ == "__main__":
    main()
