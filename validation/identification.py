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


def case(parameters: dict[str, float], found: fp.Identification) -> dict[str, Any]:
    """Deviations in standard errors of the logarithms, and which intervals hold."""
    errors, intervals = found.standard_errors, found.interval(0.95)
    row: dict[str, Any] = {}
    for name, value in parameters.items():
        here = found.parameters[name]
        row[name] = np.log(here / value) * here / errors[name]
        low, high = intervals[name]
        row[f"{name} held"] = low <= value <= high
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cases, few fibres")
    options = parser.parse_args()
    report = Report("identification", options.quick)
    scores, held = [], []
    for parameters, curve, length, ds in QUICK if options.quick else FULL:
        kind = "smooth" if "curvature_noise" in parameters else "basic"
        rows = []
        for seed in range(N_FIBRES[options.quick]):
            data = fibre(parameters, curve, length, ds, 1000 + seed)
            found = fp.identify(data, model=kind, method="functional", seed=seed)
            rows.append(case(parameters, found))
        scores += [row[name] for row in rows for name in parameters]
        held += [row[f"{name} held"] for row in rows for name in parameters]
        report.table([{"model": kind, "A": parameters["noise"], "length": length, **row}
                      for row in rows])  # fmt: skip
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
    report.finish()


if __name__ == "__main__":
    main()
