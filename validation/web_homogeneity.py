"""Laid webs vary as `predict_web` says, at every zone, speed, noise and distance.

Claim: the largest |z| of a study, the difference of CV² laid and predicted over its
error, stays below what Student's distribution of as many scores exceeds once in a
hundred studies. Webs are independent, and their steps so short that the polygons bend
as the fibres do: (A² ds)² / 48, by which a persistence length of steps is too long, is
0.5 % at most, where the standard errors are larger.
"""

from __future__ import annotations

import argparse
import os
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402
from scipy.special import stdtrit  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve import studies  # noqa: E402
from fpsolve.plotting import plot_web_homogeneity  # noqa: E402

UNIT = fp.QuadraticPotential()
ZONES = (0.1, 0.3, 1.0, 3.0, 10.0)
# Noises, belt speeds, distances, positions, relaxation length.
QUICK = [
    ((1.0,), (0.3,), (1.0,), "regular", None),
    ((3.0,), (0.3,), (1.0,), "regular", 0.1),
]
FULL = [
    ((1.0,), (0.02, 0.1, 0.3), (0.1, 1.0, 4.0), "regular", None),
    ((10.0,), (0.1, 0.3), (1.0, 4.0), "regular", None),
    ((1.0,), (0.1,), (0.1, 1.0, 4.0), "random", None),
    ((1.0,), (0.1, 0.3), (0.1, 1.0, 4.0), "regular", 0.1),
    ((10.0,), (0.1, 0.3), (1.0, 4.0), "regular", 0.1),
    ((3.0,), (0.1,), (0.1, 1.0, 4.0), "random", 0.5),
]
# Once in so many studies chance alone goes beyond the bound.
ONCE_IN = 100


def check(report: Report, dataset: Any) -> None:
    """A row for every score, and whether they are those of chance."""
    z = dataset["z"].to_numpy()
    rows = []
    for place in np.ndindex(z.shape):
        one = dataset.isel(dict(zip(dataset["z"].dims, place, strict=True)))
        rows.append({
            "A": float(one["noise"]), "R": dataset.attrs.get("relaxation_length", 0.0),
            "v": float(one["belt_speed"]),
            "d": float(one["spacing"]), "positions": dataset.attrs["positions"],
            "side": float(one["zone"]), "predicted": float(one["predicted"]),
            "error": float(one["predicted_error"]), "laid": float(one["simulated"]),
            "standard error": float(one["standard_error"]), "z": float(one["z"]),
        })  # fmt: skip
    report.table(rows)
    n_webs = int(dataset.attrs["n_webs"])
    bound = float(stdtrit(n_webs - 1, 1 - 0.5 / (ONCE_IN * z.size)))
    noise = float(dataset["noise"][0])
    about = f"A = {noise:g}, R = {dataset.attrs.get('relaxation_length', 0.0):g}"
    name = f"{about}, {dataset.attrs['positions']} positions: largest |z|"
    # The largest of what holds a NaN is NaN, which fails.
    report.check(name, float(np.abs(z).max()), "<", bound)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one case, fewer zones")
    parser.add_argument("--directory", help="keep finished cases here")
    parser.add_argument("--cases", type=int, nargs="+", help="some of the full ones")
    options = parser.parse_args()
    report = Report("web_homogeneity", options.quick)
    cases = QUICK if options.quick else FULL
    if options.cases:
        cases = [FULL[number] for number in options.cases]
    for noises, speeds, spacings, positions, length in cases:
        dataset = studies.web_homogeneity(
            UNIT, noises, speeds, spacings, positions=positions, workers=0,
            relaxation_length=length,
            zones=ZONES[:4] if options.quick else ZONES,
            directory=options.directory,
        )  # fmt: skip
        check(report, dataset)
        if not options.quick:
            kind = "basic" if length is None else "smooth"
            name = f"web_homogeneity_{kind}_{positions}_{noises[0]:g}.png"
            save_figure(plot_web_homogeneity(dataset), name)
    report.finish()


if __name__ == "__main__":
    main()
