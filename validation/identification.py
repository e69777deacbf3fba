"""Identified parameters are as far from the true ones as their errors say.

Claim: of synthetic fibres of known parameters, on belts and under rotating nozzles, the
deviations in units of the reported errors have a mean square between the bounds that
chance alone leaves once in a hundred studies, errors being those of 64 surrogates, and
95 % intervals hold the true value in 90 to 99 % of all cases (in the quick study, which
has too few for that, in 70 %). What is found of a fibre is kept as soon as it is known,
and `--resume` computes only what is not there or was found by other code.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
from pathlib import Path
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import RESULTS, Report  # noqa: E402
from scipy.special import chdtri  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.errors import ToleranceError  # noqa: E402
from fpsolve.studies.identification.coordinates import (  # noqa: E402
    FUNCTIONAL,
    interval,
)
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
] + [
    ({"sigma1": 1.0, "sigma2": 1.5, "noise": noise, **curved}, curve, length, ds)
    for noise, curved, curve, length, ds in (
        (0.3, {}, BELT, 200.0, 0.2),
        (0.3, {}, NOZZLE, 2000.0, 0.1),
        (0.3, {"curvature_noise": 0.6}, BELT, 200.0, 0.2),
        (0.3, {"curvature_noise": 0.6}, NOZZLE, 2000.0, 0.1),
        (1.0, {}, NOZZLE, 200.0, 0.2),
        (1.0, {}, BELT, 5000.0, 0.05),
        (1.0, {"curvature_noise": 2.0}, BELT, 5000.0, 0.2),
        (10.0, {}, BELT, 2000.0, 0.006),
        (10.0, {"curvature_noise": 200.0}, BELT, 5000.0, 0.02),
    )
] + [
    ({"sigma1": 1.0, "sigma2": 1.5, "noise": 0.3, "curvature_noise": 0.6}, BELT, length,
     0.1)
    for length in (300.0, 2000.0)
]  # fmt: skip
N_FIBRES = {True: 3, False: 50}
# Once in so many studies chance alone goes beyond the bounds; relative error of an
# error that comes of 64 surrogates, and of slopes.
ONCE_IN, OF_ERRORS = 100, 0.2
COVERED = {True: (0.7, 1.0), False: (0.90, 0.99)}
KEPT = RESULTS / "identification-cases" / "fibres.jsonl"
# What decides the numbers of a fibre.
MODULES = ("coordinates", "curve_search", "functional_estimate", "increments",
           "quasi_newton", "sampling_error", "second_order", "surrogate")  # fmt: skip


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
              seed: int) -> dict[str, Any]:  # fmt: skip
    """What the functional finds, as JSON keeps it; of a refusal what it says."""
    kind = "smooth" if "curvature_noise" in parameters else "basic"
    try:
        found = estimate_by_functional(data, kind, seed=seed)
    except (ToleranceError, ValueError) as refused:
        # The latter of fibres that are too short for how far they go.
        return {"refused": str(refused)}
    return {
        "parameters": found.parameters, "covariance": found.covariance.tolist(),
        "undetermined": found.undetermined,
    }  # fmt: skip


class Kept:
    """What was found of fibres by the present code, one in a line of a file."""

    def __init__(self, resume: bool) -> None:
        folder = Path(fp.__file__).parent / "studies/identification"
        sources = b"".join((folder / f"{name}.py").read_bytes() for name in MODULES)
        self.code = hashlib.sha256(sources).hexdigest()[:16]
        self.found: dict[str, Any] = {}
        if resume and KEPT.exists():
            lines = map(json.loads, KEPT.read_text().splitlines())
            self.found = {line["of"]: line["found"] for line in lines}

    def of(self, case: Any, seed: int) -> dict[str, Any]:
        """What is found of a fibre, computed if it is not there."""
        parameters, curve, length, ds = case
        key = json.dumps([self.code, parameters, repr(curve), length, ds, seed])
        if key not in self.found:
            data = fibre(parameters, curve, length, ds, 1000 + seed)
            self.found[key] = estimated(parameters, data, seed)
            KEPT.parent.mkdir(parents=True, exist_ok=True)
            with KEPT.open("a") as file:
                file.write(json.dumps({"of": key, "found": self.found[key]}) + "\n")
        return self.found[key]


def row_of(parameters: dict[str, float], found: dict[str, Any]) -> dict[str, Any]:
    """Deviations in standard errors, of 1/σ and log A, log K; which intervals hold."""
    errors = np.sqrt(np.diag(found["covariance"]))
    row: dict[str, Any] = {}
    for (name, value), error in zip(parameters.items(), errors, strict=True):
        here = found["parameters"][name]
        far = here / value - 1 if name.startswith("sigma") else np.log(here / value)
        row[name] = far * here / error
        low, high = interval(name, here, error, 1.96, FUNCTIONAL)
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
    parser.add_argument("--resume", action="store_true", help="keep what is there")
    options = parser.parse_args()
    report = Report("identification", options.quick)
    kept = Kept(options.resume)
    chosen = QUICK if options.quick else FULL
    numbers = range(len(chosen)) if options.cases is None else options.cases
    scores, held, answered, refused = [], [], 0, 0
    for number in numbers:
        parameters = chosen[number][0]
        n_fibres = options.fibres or N_FIBRES[options.quick]
        found = [kept.of(chosen[number], seed) for seed in range(n_fibres)]
        rows = [row_of(parameters, one) for one in found if "refused" not in one]
        scores += [row[name] for row in rows for name in parameters]
        held += [row[f"{name} held"] for row in rows for name in parameters]
        answered += len(rows)
        refused += n_fibres - len(rows)
        report.table([summary(number, chosen[number], rows, n_fibres - len(rows))])
    # Parameters of one fibre depend on each other: bounds of as many fibres alone.
    spread = float(np.mean(np.square(scores)))
    tails = (1 - 0.5 / ONCE_IN, 0.5 / ONCE_IN)
    low, high = (chdtri(answered, p) / answered for p in tails)
    report.check("mean square of the scores", spread, "<", high * (1 + OF_ERRORS) ** 2)
    report.check("mean square of the scores", spread, ">", low * (1 - OF_ERRORS) ** 2)
    least, most = COVERED[options.quick]
    covered = float(np.mean(held))
    report.check("part of 95 % intervals that hold", covered, ">", least)
    # All of a few hold by chance: 2.6 standard deviations of their number.
    few = 2.6 * float(np.sqrt(0.95 * 0.05 / len(held)))
    report.check("part of 95 % intervals that hold", covered, "<=", min(most + few, 1))
    report.check("fibres refused", refused / (refused + answered), "<", 0.05)
    report.finish()


if __name__ == "__main__":
    main()
