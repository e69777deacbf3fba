"""Identified parameters are as far from the true ones as their errors say.

Claim: of synthetic fibres of known parameters, on belts and under rotating nozzles, the
deviations in units of the reported errors have a mean square between the bounds that
chance alone leaves once in a hundred studies, errors being those of 64 surrogates, and
95 % intervals hold the true value in 90 to 99 % of all cases (in the quick study, which
has too few for that, in 70 %).
"""

from __future__ import annotations

import argparse
import os
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report  # noqa: E402
from scipy.special import chdtri  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.errors import ToleranceError  # noqa: E402
from fpsolve.studies.identification.coordinates import (  # noqa: E402
    logarithmic_interval,
)
from fpsolve.studies.identification.estimate import Estimate  # noqa: E402
from fpsolve.studies.identification.functional_estimate import (  # noqa: E402
    estimate_by_functional,
)
from fpsolve.studies.identification.surrogate import model_of  # noqa: E402

BELT, NOZZLE = fp.MovingBelt(0.1), fp.RotatingNozzle(0.1, 2.0, 0.2)
# Parameters, reference curve, length of the fibre, Δs.
QUICK = [
    ({"sigma1": 1.0, "sigma2": 1.5, "noise": 1.0}, BELT, 600.0, 0.1),
    ({"sigma1": 1.0, "sigma2": 1.5, "noise": 1.0, "curvature_noise": 2.0}, BELT, 600.0,
     0.1),
]  # fmt: skip
FULL = [
    ({"sigma1": 1.0, "sigma2": 1.5, "noise": noise, **curved}, curve, length, ds)
    for noise, ds in ((0.5, 0.1), (1.0, 0.1), (3.0, 0.02))
    for curved in ({}, {"curvature_noise": 2.0 * noise})
    for curve in (BELT, NOZZLE)
    for length in (300.0, 2000.0)
]
N_FIBRES = {True: 3, False: 50}
# Once in so many studies chance alone goes beyond the bounds; relative error of an
# error that comes of 64 surrogates, and of slopes.
ONCE_IN, OF_ERRORS = 100, 0.2
COVERED = {True: (0.7, 1.0), False: (0.90, 0.99)}


def fibre(parameters: dict[str, float], curve: Any, length: float, ds: float,
          seed: int) -> fp.FibreCurve:  # fmt: skip
    """A synthetic fibre, laid in steps that are not those of the surrogates."""
    model = model_of(parameters, curve)
    n = round(length / ds) + 1
    paths = fp.sample_paths(
        model, 1, ds * (n - 1), ds / 5, seed=seed, save_at=ds * np.arange(n),
        initial=fp.paths.EquilibriumLaw(model.potential),
    )  # fmt: skip
    return fp.FibreCurve.from_paths(paths)


def estimated(parameters: dict[str, float], data: fp.FibreCurve,
              seed: int) -> Estimate | None:  # fmt: skip
    """What the functional finds; None where it refuses."""
    kind = "smooth" if "curvature_noise" in parameters else "basic"
    try:
        return estimate_by_functional(data, kind, seed=seed)
    except ToleranceError:
        return None


def row_of(parameters: dict[str, float], found: Estimate) -> dict[str, Any]:
    """Deviations in standard errors of the logarithms, and which intervals hold."""
    errors = np.sqrt(np.diag(found.covariance))
    row: dict[str, Any] = {}
    for (name, value), error in zip(parameters.items(), errors, strict=True):
        here = found.parameters[name]
        row[name] = np.log(here / value) * here / error
        low, high = logarithmic_interval(here, error, 1.96)
        row[f"{name} held"] = low <= value <= high
    return row


def summary(number: int, case: Any, rows: list[dict[str, Any]],
            refused: int) -> dict[str, Any]:  # fmt: skip
    """Means over the fibres of a case."""
    parameters, curve, length, ds = case
    return {
        "case": number, **parameters, "curve": type(curve).__name__, "length": length,
        "ds": ds, "fibres": len(rows) + refused, "refused": refused,
        "mean z": listed([np.mean([row[name] for row in rows]) for name in parameters]),
        "spread of z": listed([np.std([row[name] for row in rows], ddof=1)
                               for name in parameters]),
        "held": listed([np.sum([row[f"{name} held"] for row in rows])
                        for name in parameters], "g"),
    }  # fmt: skip


def listed(values: list[Any], form: str = ".2f") -> str:
    return " ".join(f"{value:{form}}" for value in values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cases, few fibres")
    parser.add_argument("--cases", type=int, nargs="*", help="some of the full ones")
    parser.add_argument("--fibres", type=int, help="fewer than 50 of each")
    options = parser.parse_args()
    report = Report("identification", options.quick)
    chosen = QUICK if options.quick else FULL
    numbers = range(len(chosen)) if options.cases is None else options.cases
    scores, held, refused = [], [], 0
    for number in numbers:
        parameters, curve, length, ds = chosen[number]
        n_fibres = options.fibres or N_FIBRES[options.quick]
        found = [
            estimated(parameters, fibre(parameters, curve, length, ds, 1000 + seed),
                      seed)
            for seed in range(n_fibres)
        ]  # fmt: skip
        rows = [row_of(parameters, one) for one in found if one is not None]
        scores += [row[name] for row in rows for name in parameters]
        held += [row[f"{name} held"] for row in rows for name in parameters]
        refused += n_fibres - len(rows)
        report.table([summary(number, chosen[number], rows, n_fibres - len(rows))])
    # Parameters of one fibre depend on each other: bounds of as many fibres alone.
    n = len(scores) // 4
    spread = float(np.mean(np.square(scores)))
    low, high = (chdtri(n, p) / n for p in (1 - 0.5 / ONCE_IN, 0.5 / ONCE_IN))
    report.check("mean square of the scores", spread, "<", high * (1 + OF_ERRORS) ** 2)
    report.check("mean square of the scores", spread, ">", low * (1 - OF_ERRORS) ** 2)
    least, most = COVERED[options.quick]
    covered = float(np.mean(held))
    report.check("part of 95 % intervals that hold", covered, ">", least)
    report.check("part of 95 % intervals that hold", covered, "<=", most)
    report.check("fibres refused", refused / (refused + n / 4), "<", 0.05)
    report.finish()


if __name__ == "__main__":
    main()
