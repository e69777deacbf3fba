"""Smooth fibres tend to the basic model with the orders in R that are derived.

Claims, at fixed A = RK (docs/limits.md has the derivation): densities of (ξ, α), of ξ
and of α, E ξ, E‖ξ‖² and E τ at order 1; with one Wiener process ξ and α + Rκ at order 1
and α at order 1/2, off by √(A²R/π) in the mean. For |ξ|²/2 at rest the gap and the
stationary variance are of order 1, and of order 2 after their derivatives at R = 0. The
orders are reached in the limit: what is missing at R, the larger of two neighbours, is
below a multiple of R that is the same for all measures.
"""

from __future__ import annotations

import argparse
import os
from typing import Any

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.plotting import plot_white_noise  # noqa: E402

NOISE = 1.5
QUADRATIC, QUARTIC = fp.QuadraticPotential(), fp.PowerPotential(4.0)
# Noise of the gap and the variance: near 1.5 the second derivative of the gap vanishes.
EXPANDED = 2.0
# Missing from the order per R, as measured for the directions, which relax over 2/A².
BAND = 12.0


def check_orders(report: Report, dataset: Any, symbol: str) -> None:
    """The order of every distance at every halving, and its table."""
    rows, worst = [], {}
    lengths = dataset["relaxation_length"].to_numpy()
    for name in dataset["quantity"].to_numpy():
        one = dataset.sel(quantity=name)
        expected, distance = float(one["expected_order"]), one["distance"].to_numpy()
        observed = one["observed_order"].to_numpy()[1:]
        share = (one["distance_error"] / one["distance"]).to_numpy()
        unknown = (share[1:] + share[:-1]) / np.log(2)
        missing = (np.abs(observed - expected) - unknown) / (BAND * lengths[1:])
        key = f"order {expected:g}"
        worst[key] = max(worst.get(key, -np.inf), float(missing.max()))
        numbers = zip(lengths, distance, strict=True)
        rows.append({
            "B": symbol, "distance": str(name), "order": expected,
            **{f"{length:g}": f"{number:.2e}" for length, number in numbers},
            "observed": ", ".join(f"{order:.2f}" for order in observed),
            "error share": float(share[0]),
        })  # fmt: skip
    report.table(rows)
    for key, value in sorted(worst.items()):
        report.check(
            f"B = {symbol}: largest deviation from {key} over {BAND:g}R, every halving",
            value, "<", 1.0,
        )  # fmt: skip


def check_angle(report: Report, dataset: Any, symbol: str) -> None:
    """α is off by R κ, whose variance is known."""
    least = dataset.isel(relaxation_length=0)
    distance = float(least["distance"].sel(quantity="paths/angle"))
    error = float(least["distance_error"].sel(quantity="paths/angle"))
    length = float(least["relaxation_length"])
    excess = abs(distance / (NOISE * np.sqrt(length / np.pi)) - 1)
    share = error / distance
    # The rest is the O(R) of β, a share of √R.
    report.check(
        f"B = {symbol}: E|α − α_0| over √(A²R/π), less 1, smallest R",
        excess, "<", np.sqrt(length) + 3 * share,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer R, coarser")
    parser.add_argument("--workers", type=int, help="processes; one for each CPU")
    arguments = parser.parse_args()
    report = Report("white_noise_limit", arguments.quick)
    lengths = 0.1 * 0.5 ** np.arange(3 if arguments.quick else 5)
    cases = (("|ξ|²/2", QUADRATIC, 0.0), ("|ξ|²/2, v = 0.2", QUADRATIC, 0.2),
             ("|ξ|⁴/4", QUARTIC, 0.0))  # fmt: skip
    for symbol, potential, speed in cases[: 1 if arguments.quick else None]:
        dataset = fp.studies.white_noise_limit(
            potential, NOISE, lengths, belt_speed=speed, quick=arguments.quick,
            parts=["density", "paths"], workers=arguments.workers,
        )  # fmt: skip
        n_failed = float((dataset["status"] != "finished").sum())
        report.check(f"B = {symbol}: cases that failed", n_failed, "<", 1)
        check_orders(report, dataset, symbol)
        check_angle(report, dataset, symbol)
        setting = "quick" if arguments.quick else "full"
        if potential is QUADRATIC and not speed:
            save_figure(plot_white_noise(dataset), f"white_noise_limit_{setting}.png")
    dataset = fp.studies.white_noise_limit(
        QUADRATIC, EXPANDED, lengths, parts=["gap", "variance"],
        workers=arguments.workers,
    )  # fmt: skip
    check_orders(report, dataset, f"|ξ|²/2, A = {EXPANDED:g}")
    report.finish()


if __name__ == "__main__":
    main()
