"""How often AIC and the goodness of fit choose the right model of a fibre.

Claims, beside what chance leaves once in a hundred studies: of basic fibres AIC prefers
the smooth model, of which theirs is the edge R = 0, for P(χ²₁ > 2)/2 = 8 per cent; of
smooth fibres whose R is several steps of the points it prefers the smooth model always.
The goodness of fit rejects a true model, at its level of 5 per cent, for no more than
that, and the basic model for nine of ten of these smooth fibres. What it says of fibres
in another potential, B = |ξ|⁴/4, is printed, not claimed.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from reporting import Report
from scipy.stats import binom, chi2

import fpsolve as fp
from fpsolve.studies.identification.synthetic import laid_fibres

BELT, POTENTIAL = fp.MovingBelt(0.1), fp.QuadraticPotential(1.0, 0.7)
LENGTH, DS = 200.0, 0.2
MODELS = {
    "basic": fp.LayDownModel(POTENTIAL, 1.0, BELT),
    "smooth": fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0, BELT),
}
QUARTIC = fp.SmoothLayDownModel(fp.PowerPotential(4.0), 0.5, 1.0, BELT)
N_FIBRES = {True: 4, False: 60}
# Of a parameter at its edge the likelihood ratio is half the time 0, else χ²₁.
AT_EDGE = 0.5 * float(chi2.sf(2.0, 1))
LEVEL, ONCE_IN = 0.05, 100


def fibres(name: str, n: int) -> list[fp.FibreCurve]:
    """Synthetic ones, 200 σ long."""
    n_points = round(LENGTH / DS) + 1
    if name == "quartic":
        paths = fp.sample_paths(QUARTIC, n, LENGTH + 20.0, 0.05, seed=5)
        eta = [paths.replay(k, 4).eta[-n_points:] for k in range(n)]
        return [fp.FibreCurve(one, DS, BELT, s_start=20.0) for one in eta]
    laid = laid_fibres(MODELS[name], n, n_points, DS, seed=5)
    return [fp.FibreCurve(one, DS, BELT) for one in laid]


def counted(name: str, n: int) -> dict[str, Any]:
    """How many of n fibres are said to be what."""
    compared = [fp.compare_models(one, seed=k) for k, one in enumerate(fibres(name, n))]
    rejected = [one.rejected(LEVEL) for one in compared]
    return {
        "fibres": name, "number": n,
        "AIC smooth": sum(one.preferred == "smooth" for one in compared),
        "basic rejected": sum("basic" in one for one in rejected),
        "smooth rejected": sum("smooth" in one for one in rejected),
        "median difference": float(np.median([one.aic_difference for one in compared])),
    }  # fmt: skip


def at_most(share: float, n: int) -> float:
    """The count that chance exceeds once in a hundred studies, of n with this share."""
    return float(binom.isf(1 / ONCE_IN, n, share))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few fibres")
    parser.add_argument("--fibres", type=int, help="fewer than 60 of each")
    options = parser.parse_args()
    report = Report("identification_models", options.quick)
    n = options.fibres or N_FIBRES[options.quick]
    rows = {}
    for name in (*MODELS, *([] if options.quick else ["quartic"])):
        rows[name] = counted(name, n if name in MODELS else max(1, n // 5))
        report.table([rows[name]])
    basic, smooth = rows["basic"], rows["smooth"]
    report.check("basic fibres for which AIC prefers the smooth model",
                 basic["AIC smooth"], "<=", at_most(AT_EDGE, n))  # fmt: skip
    report.check("smooth fibres for which AIC prefers the basic model",
                 n - smooth["AIC smooth"], "<=", 0)  # fmt: skip
    for row, name in ((basic, "basic"), (smooth, "smooth")):
        report.check(f"{name} fibres of which their own model is rejected",
                     row[f"{name} rejected"], "<=", at_most(LEVEL, n))  # fmt: skip
    report.check("smooth fibres of which the basic model is not rejected",
                 n - smooth["basic rejected"], "<=", at_most(0.1, n))  # fmt: skip
    report.finish()


if __name__ == "__main__":
    main()
