"""With little noise the energy G of a fibre follows the averaged equation (16).

Claims, for B = |ξ|²/2 and B = |ξ| at A² s = 1 from one smooth start: the law of G by
the full equation (grid, extrapolated) tends to that by the averaged one, at order 1 in
A² once the fast modes have died, as far down as the cells can tell; on belts of speed
v = 0.3 A² too, so that the belt drops out; E G on a belt at rest is exact for every
noise; paths agree with the grid. The slowest real rates of the sectors M = 0 over A²
are those of the two families of the energy process.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from reporting import RESULTS, Report, save_figure

import fpsolve as fp
from fpsolve.plotting.small_noise import plot_small_noise, plot_small_noise_spectrum
from fpsolve.studies.limits.energy_sectors import small_noise_spectrum
from fpsolve.studies.limits.orders import fitted_order
from fpsolve.studies.limits.small_noise import small_noise_limit

# The kink of |ξ| limits the accuracy, not the step.
STEPS = {"quadratic": 0.125, "linear": 0.25}
POTENTIALS = {"quadratic": fp.QuadraticPotential(), "linear": fp.LinearPotential()}
# 12 functions in every one of up to 16 cases: |z| above 4.5 has probability 1e-3.
LARGEST_Z = 4.5


def rows_of(dataset: Any, kind: str) -> list[dict[str, Any]]:
    """One row for every belt and noise."""
    return [
        row_of(dataset.sel(belt_speed_scale=w, noise=noise), kind)
        for w in dataset.belt_speed_scale.values
        for noise in dataset.noise.values
    ]


def row_of(one: Any, kind: str) -> dict[str, Any]:
    """What one case gave."""
    still = float(one.belt_speed_scale) == 0
    return {
        "B": kind, "v/A²": float(one.belt_speed_scale), "A": float(one.noise),
        "distance": float(one.distance), "± cells": float(one.distance_error),
        "order in A²": float(one.observed_order),
        "E G": f"{float(one['mean']):.6f}",
        "exact": f"{float(one.exact_mean):.6f}" if still else "",
        "paths": float(one.paths_distance),
        "by chance": float(one.paths_distance_by_chance),
        "z": float(one.paths_z), "s": float(one.seconds),
    }  # fmt: skip


def check(report: Report, dataset: Any, kind: str) -> None:
    """Distances fall at order 1, E G is exact, paths agree."""
    failed = int((dataset.status != "finished").sum())
    report.check(f"{kind}: cases that failed", failed, "<=", 0)
    for w in dataset.belt_speed_scale.values:
        check_belt(report, dataset.sel(belt_speed_scale=w), kind)
    still = dataset.sel(belt_speed_scale=0.0)
    off = float(np.abs(still["mean"] / still.exact_mean - 1).max())
    bound = {"quadratic": 1e-3, "linear": 1e-2}[kind]
    report.check(f"{kind}: relative error of E G", off, "<", bound)


def check_belt(report: Report, one: Any, kind: str) -> None:
    """One belt speed over A²."""
    w = float(one.belt_speed_scale)
    name = f"{kind}, v = {w:g} A²"
    if not report.quick:
        # Two coarse points make no fit.
        fit = fitted_order(one.epsilon, one.distance, one.distance_error)
        claim = f"{name}: fitted order in A² ({fit.n_points} distances above 3 errors)"
        report.check(claim, fit.order, ">", 0.8)
    seen = one.observed_order.where(one.distance > one.distance_error).values
    last = float(seen[np.isfinite(seen)][-1])
    report.check(f"{name}: order at the last halving above the error", last, ">", 0.8)
    ratio = float((one.distance / one.epsilon).where(one.noise <= 0.2).max())
    claim = f"{name}: largest distance/A² for A <= 0.2"
    report.check(claim, ratio, "<", CEILINGS[kind][w])
    z = float(one.paths_z.max())
    report.check(f"{name}: largest |z| of paths", z, "<", LARGEST_Z)


# Distance over A², half as much again as measured.
CEILINGS = {
    "quadratic": {0.0: 0.07, 0.3: 0.2},
    "linear": {0.0: 0.4, 0.3: 2.4},
}


def check_spectrum(report: Report, dataset: Any, kind: str) -> None:
    """Odd family exactly 1/2; even family tends to its limit."""
    off = np.abs(dataset.rate - dataset.limit) / dataset.limit
    rows = []
    for family in dataset.family.values:
        for noise in dataset.noise.values:
            at = {"family": family, "noise": noise}
            limit = dataset.limit.sel(family=family)
            rows.append(
                {"B": kind, "family": str(family), "A": float(noise),
                 "rate/A²": f"{float(dataset.rate.sel(at)):.8f}",
                 "limit": f"{float(limit):.8f}", "off": float(off.sel(at))}
            )  # fmt: skip
    report.table(rows)
    odd = float(off.sel(family="odd").max())
    report.check(f"{kind}: gap/A² off 1/2, relative", odd, "<", 1e-5)
    even = float(off.sel(family="even")[-1])
    claim = f"{kind}: even family at the smallest noise, relative"
    report.check(claim, even, "<", 2e-3)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report = Report("small_noise_limit", quick)
    noises = (0.4, 0.2) if quick else (0.4, 0.2, 0.1, 0.05)
    studies = {}
    for kind in ("quadratic",) if quick else POTENTIALS:
        studies[kind] = small_noise_limit(
            POTENTIALS[kind], noises, quick=quick, workers=0, progress=not quick,
            ds=None if quick else STEPS[kind],
            directory=None if quick else RESULTS / "small-noise-cases",
        )  # fmt: skip
        report.table(rows_of(studies[kind], kind))
        check(report, studies[kind], kind)
    noises = (0.4,) if quick else (0.5, 0.4, 0.3)
    spectra = small_noise_spectrum(POTENTIALS["quadratic"], noises)
    check_spectrum(report, spectra, "quadratic")
    if not quick:
        linear = small_noise_spectrum(POTENTIALS["linear"], (0.4,), tolerance=1e-5)
        check_spectrum(report, linear, "linear")
    setting = "quick" if quick else "full"
    figures = {
        "small_noise": plot_small_noise(list(studies.values())),
        "small_noise_spectrum": plot_small_noise_spectrum(spectra),
    }
    for name, figure in figures.items():
        save_figure(figure, f"{name}_{setting}.png", dpi=200)
    report.finish()


if __name__ == "__main__":
    main()
