"""How long it takes to identify a fibre of 2000 throwing ranges, 40001 points.

Claims, in CPU seconds of one thread: by likelihood less than 20, by the functional less
than 60, the goodness of fit less than 30.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from reporting import Report  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.studies.identification.functional_estimate import (  # noqa: E402
    estimate_by_functional,
)
from fpsolve.studies.identification.goodness import compare_with_surrogate  # noqa: E402
from fpsolve.studies.identification.increments import (  # noqa: E402
    lags_up_to,
    usual_k_max,
)
from fpsolve.studies.identification.likelihood_smooth import (  # noqa: E402
    estimate_smooth,
)
from fpsolve.studies.identification.synthetic import laid_fibres  # noqa: E402

BELT, DS = fp.MovingBelt(0.3), 0.05
MODEL = fp.SmoothLayDownModel(fp.QuadraticPotential(1.0, 0.7), 0.5, 1.0, BELT)
# CPU seconds that each may take, several times what it does.
BOUNDS = {"likelihood": 20.0, "functional": 60.0, "goodness of fit": 30.0}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the fibre")
    options = parser.parse_args()
    report = Report("performance_identification", options.quick)
    n_points = 4001 if options.quick else 40001
    (eta,) = laid_fibres(MODEL, 1, n_points, DS, seed=1)
    curve = fp.FibreCurve(eta, DS, BELT)
    short = fp.FibreCurve(eta[:3001], DS, BELT)
    lags = lags_up_to(usual_k_max(curve))
    # Also compiles.
    found = estimate_smooth(short)
    timed: dict[str, Callable[[], object]] = {
        "likelihood": lambda: estimate_smooth(curve),
        "functional": lambda: estimate_by_functional(curve, "smooth"),
        "goodness of fit": lambda: compare_with_surrogate(curve, found, lags, 1),
    }
    for name, compute in timed.items():
        began = time.process_time()
        compute()
        taken = time.process_time() - began
        report.table([{"part": name, "points": n_points, "CPU s": round(taken, 2)}])
        report.check(f"CPU seconds of the {name}", taken, "<", BOUNDS[name])
    report.finish()


if __name__ == "__main__":
    main()
