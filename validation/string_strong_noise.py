"""A fibre in strong white noise, laid in fewer and fewer steps.

S is the angle by which the noise of a step turns the edges in the air. Means over
fibres of different seeds show from which S on a run in noise is no longer that of short
steps: `lay_down` warns above ½ and refuses above 2.
"""

from __future__ import annotations

import argparse
import os
import warnings

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report  # noqa: E402

from fpsolve.fibre import (  # noqa: E402
    Belt,
    Free,
    LayDown,
    Nozzle,
    RandomForce,
    String,
    lay_down,
)
from fpsolve.fibre.edge_turns import edge_turn  # noqa: E402

SPUN = String(
    0.2,
    2e-4,
    1000.0,
    1e8,
    Nozzle((0, 0, 0.3), (0.1, 0.03, -1), 1.0),
    Free(),
    n_edges=20,
)
AMPLITUDE, T_END, THETA = 4e-4, 0.5, 0.6
STEPS = (160, 216, 343, 545, 866)


def fibre_of(n_steps: int, seed: int) -> LayDown:
    with warnings.catch_warnings():
        # What is studied here.
        warnings.filterwarnings("ignore", "`turbulence` of", UserWarning)
        return lay_down(
            SPUN, T_END, n_steps, belt=Belt(0.3), theta=THETA, seed=seed,
            turbulence=RandomForce(AMPLITUDE), estimate_error=False,
        )  # fmt: skip


def row_of(n_steps: int, n_fibres: int) -> dict[str, float]:
    """Means over fibres and the later three quarters of their time."""
    fibres = [fibre_of(n_steps, seed) for seed in range(n_fibres)]
    kinetic = 1e3 * np.array([one.kinetic[n_steps // 4 :].mean() for one in fibres])
    given = np.full(1, AMPLITUDE)
    return {
        "steps": n_steps,
        "S / rad": edge_turn(SPUN, T_END / n_steps, THETA, given, np.zeros(1)),
        "halvings a step": np.mean([one.rejected.sum() / n_steps for one in fibres]),
        "iterations a step": np.mean([one.iterations[1:].mean() for one in fibres]),
        "kinetic energy / mJ": kinetic.mean(),
        "±": kinetic.std(ddof=1) / np.sqrt(n_fibres),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few fibres")
    options = parser.parse_args()
    report = Report("string_strong_noise", options.quick)
    rows = [row_of(n_steps, 4 if options.quick else 64) for n_steps in STEPS]
    report.table(rows)
    quiet = [one["halvings a step"] for one in rows if one["S / rad"] <= 0.5]
    report.check("halvings a step where there is no warning", max(quiet), "<", 0.15)
    longest, shortest = rows[0], rows[-1]
    lost = 1 - longest["kinetic energy / mJ"] / shortest["kinetic energy / mJ"]
    error = np.hypot(longest["±"], shortest["±"]) / shortest["kinetic energy / mJ"]
    if not options.quick:
        report.check(
            "part of the kinetic energy lost near 2 rad, without 3 errors",
            lost - 3 * error, ">", 0.1,
        )  # fmt: skip
    report.finish()


if __name__ == "__main__":
    main()
