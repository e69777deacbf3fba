"""H(s) of both grid schemes against the expansion in Hermite polynomials, by order.

Claims: the expansion's own estimate is below 1e-8; the entropies of `drift_kick` and
`semi_lagrangian` approach it with order 2 in ds at every halving; extrapolated
entropies and moments of `drift_kick` lie within their own estimates; on a moving belt
the mean of the stationary density is that of the grid solver.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.paths import GaussianLaw
from fpsolve.spectral.evolution.evolution import spectral_solve
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.evolution.steady import spectral_steady_state

SCHEMES = {
    "drift_kick": lambda m, g: fp.drift_kick(
        m, g, balanced=True, interpolation_order=12
    ),
    "semi_lagrangian": lambda m, g: fp.semi_lagrangian(m, g, interpolation_order=6),
}
START = GaussianLaw((1.0, 0.0), 0.5, np.pi / 2, 1.0)
STOPS = np.array([0.5, 1.0, 2.0])
# What box and interpolation leave, below the smallest error in ds by ten.
FLOOR = 3e-6


def start_on(grid: fp.PhaseSpaceGrid) -> np.ndarray:
    return fp.initial.gaussian(
        grid, START.mean, START.variance, START.angle, START.concentration
    )


def largest_error(scheme, exact: SpectralSolution, ds: float) -> float:
    """Largest |H − H_exact| at the stops."""
    run = fp.solve(scheme, start_on(scheme.grid), (0.0, STOPS[-1]), ds)
    steps = np.searchsorted(run.s, STOPS - 1e-9)
    return float(np.abs(run.relative_entropy[steps] - exact.relative_entropy).max())


def check_orders(
    report: Report, exact: SpectralSolution, shape: tuple[int, int, int], finest: int
) -> None:
    """Orders of both schemes at one noise."""
    noise = exact.model.noise
    grid = fp.PhaseSpaceGrid(6.0, shape)
    lengths = [1 / n for n in (4, 8, 16, 32) if n <= finest]
    for name, make in SCHEMES.items():
        errors = [largest_error(make(exact.model, grid), exact, ds) for ds in lengths]
        orders = [float(np.log2(coarse / fine)) for coarse, fine in pairwise(errors)]
        row = {"scheme": name, "A": noise}
        for ds, error in zip(lengths, errors, strict=True):
            row[f"error, ds = 1/{round(1 / ds)}"] = error
        report.table([row | {"orders": ", ".join(f"{order:.2f}" for order in orders)}])
        worst = max(abs(order - 2) for order in orders)
        report.check(
            f"{name}, A = {noise}: |order − 2| at every halving", worst, "<", 0.3
        )


def check_extrapolated(
    report: Report, exact: SpectralSolution, shape: tuple[int, int, int]
) -> None:
    """Largest part of the estimate that an extrapolated number uses up."""
    grid = fp.PhaseSpaceGrid(6.0, shape)
    scheme = SCHEMES["drift_kick"](exact.model, grid)
    run = fp.solve(scheme, start_on(grid), (0.0, STOPS[-1]), 1 / 8, extrapolate=True)
    steps = np.searchsorted(run.s, STOPS - 1e-9)
    shares = []
    for name in ("relative_entropy", *MOMENTS):
        away = np.abs(run.series[name][steps] - exact.series[name])
        shares.append(float(np.max(away / (run.errors[name][steps] + FLOOR))))
    report.check(
        f"A = {exact.model.noise}: error over estimate, extrapolated",
        max(shares), "<", 1.0,
    )  # fmt: skip


def check_belt(report: Report, shape: tuple[int, int, int]) -> None:
    """The stationary mean on a belt, by both."""
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
    found = spectral_steady_state(model)
    grid = fp.PhaseSpaceGrid(6.0, shape)
    run = fp.steady_state(model, grid, ds=0.1, extrapolate=True, tolerance=1e-8)
    away = abs(run.moments()["mean_xi1"] - found.moments["mean_xi1"])
    report.check("belt 0.1, A = 1: E ξ1 of both", away, "<", 1e-5)
    report.check(
        "belt 0.1, A = 1: |E cos α + v|", abs(found.moments["mean_cos_alpha"] + 0.1),
        "<", 1e-12,
    )  # fmt: skip
    report.check("belt: estimated error", max(found.errors.values()), "<", 1e-8)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one noise, coarser grid")
    quick = parser.parse_args().quick
    report = Report("spectral_reference", quick)
    shape = (48, 48, 32) if quick else (72, 72, 48)
    for noise in (1.0,) if quick else (0.5, 1.0, 2.0):
        model = fp.LayDownModel(fp.QuadraticPotential(), noise)
        began = time.process_time()
        exact = spectral_solve(model, START, STOPS)
        seconds = time.process_time() - began
        row = {"A": noise, "CPU seconds": seconds}
        for s, entropy in zip(STOPS, exact.relative_entropy, strict=True):
            row[f"H({s:g})"] = f"{entropy:.10f}"
        report.table([row])
        worst = max(float(values.max()) for values in exact.errors.values())
        report.check(
            f"A = {noise}: estimated error of the expansion", worst, "<=", 1e-8
        )
        check_orders(report, exact, shape, 16 if quick else 32)
        check_extrapolated(report, exact, shape)
    check_belt(report, (40, 40, 24))
    report.finish()


if __name__ == "__main__":
    main()
