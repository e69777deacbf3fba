"""The full equation tends to its hydrodynamic limit with the orders that are derived.

Claims, ε = A⁻², at fixed slow time εs, v = 0 and v = wε (docs/limits.md has the
derivation): plane densities, E ξ, E|ξ|² and the entropy at order 2, the joint density
at order 1 and with εp₁ at order 2, the mean direction at order 3 with εp₁; after a
start with a direction at order 1 unless the start is displaced by the initial layer.
With v fixed A²v stays off, the von Mises balance tends to the mean at order 2. gap·A²
tends to Λ at order 2 and to Λ(1 + cε²) at order 4. Densities on grids agree with
expansions, which share no code with them, and p_S of a belt at rest is that of the
limit at every noise. For smooth fibres at fixed a = A²R/2 the orders are the same.
"""

from __future__ import annotations

import argparse
import math
import os
from typing import Any

# Small matrices and small grids: waiting for a second thread costs more than it does.
# To be set before BLAS and numba are loaded, here and in the processes of the sweep.
for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve.paths import GaussianLaw  # noqa: E402
from fpsolve.plotting import plot_large_noise  # noqa: E402
from fpsolve.studies.constants.poincare import (  # noqa: E402
    next_gap_term,
    poincare_constant,
)
from fpsolve.studies.limits.distances import distances  # noqa: E402
from fpsolve.studies.limits.large_noise import LARGE_NOISE_START  # noqa: E402
from fpsolve.studies.limits.plane_limit import (  # noqa: E402
    stationary_limit,
    transient_limit,
)

HALVINGS = 2.0 ** np.array([1.0, 1.5, 2.0, 2.5])  # ε = 1/4 … 1/32
SLOW_LENGTH, PULL = 1.25, 0.5
# Each order is reached only in the limit. What is missing is of relative size ε² or
# ε times powers of the slow time; 4ε, ε the larger of two neighbours, allows for it:
# 1, 1/2, 1/4. From the second halving on no other integer order passes.
BAND = 4.0
# A distance that passes through zero near this slow time, so that its order shows
# later: what the mean and what p₁ add to H have opposite signs.
LATE = {"rest_directed/entropy"}
QUADRATIC, QUARTIC = fp.QuadraticPotential(), fp.PowerPotential(4.0)
# Compared with expansions.
MEASURES = ("joint", "joint_p1", "marginal", "mean", "entropy", "direction_p1")
# With other potentials second moments and directions pass through zero.
PLAIN = ("joint", "joint_p1", "marginal", "mean", "entropy", "gap")
QUICK_PARTS = ["stationary", "belt_directed", "rest_uniform", "fixed_speed", "gap"]


def check_orders(report: Report, dataset: Any, symbol: str) -> None:
    """The order of every distance at every halving."""
    quadratic = symbol == "|ξ|²/2"
    rows, worst = [], {}
    epsilon = dataset["epsilon"].to_numpy()
    for name in dataset["quantity"].to_numpy():
        one = dataset.sel(quantity=name)
        expected = float(one["expected_order"])
        if not math.isfinite(expected):
            continue
        share = (one["distance_error"] / one["distance"]).to_numpy()
        observed = one["observed_order"].to_numpy()[1:]
        deviation = np.abs(observed - expected) / (BAND * epsilon[:-1])
        # The order is as uncertain as both distances.
        deviation -= (share[1:] + share[:-1]) / math.log(2) / (BAND * epsilon[:-1])
        rows.append({
            "B": symbol, "distance": str(name), "order": expected,
            **{f"{e:g}": f"{d:.2e}" for e, d in zip(epsilon, one["distance"].to_numpy(),
                                                    strict=True)},
            "observed": ", ".join(f"{order:.2f}" for order in observed),
            "error share": float(share[-1]),
        })  # fmt: skip
        measure = str(name).split("/")[1].removesuffix("_uncorrected")
        if name not in LATE and (quadratic or measure in PLAIN):
            key = f"order {expected:g}"
            worst[key] = max(worst.get(key, -np.inf), float(np.max(deviation)))
        elif name in LATE and observed.size > 2:
            late = abs(float(observed[-1]) - expected)
            report.check(f"{name}: deviation at the last halving", late, "<", 0.4)
    report.table(rows)
    for key, value in sorted(worst.items()):
        report.check(
            f"B = {symbol}: largest deviation from {key} over {BAND:g}ε, every halving",
            value, "<", 1.0,
        )  # fmt: skip


def check_accuracy(report: Report, dataset: Any, symbol: str, share: float) -> None:
    """The solver is far more accurate than the limit, at the smallest ε too."""
    last = dataset.isel(noise=-1)
    exact = ~np.isfinite(last["expected_order"])
    ratio = (last["distance_error"] / last["distance"]).where(~exact)
    bulk = [
        name for name in ratio["quantity"].to_numpy()
        if name not in LATE and "second" not in name and "direction" not in name
    ]  # fmt: skip
    report.check(f"B = {symbol}: numerical error over distance, smallest ε",
                 float(ratio.sel(quantity=bulk).max()), "<", share)  # fmt: skip


def check_stationary(report: Report, dataset: Any) -> None:
    """Ceilings, and what is exact."""
    last = dataset.isel(noise=-1)
    epsilon, distance = float(last["epsilon"]), last["distance"]
    for measure, power, ceiling in (
        ("joint", 1, 0.66), ("joint_p1", 2, 0.36), ("marginal", 2, 0.26),
        ("mean", 2, 0.34), ("mean_balance", 2, 0.27),
    ):  # fmt: skip
        value = float(distance.sel(quantity=f"stationary/{measure}")) / epsilon**power
        report.check(f"stationary {measure} over ε^{power}, smallest ε", value,
                     "<", ceiling)  # fmt: skip
    direction = dataset["distance"].sel(quantity="stationary/direction_p1")
    report.check("stationary E τ with p₁, every noise (exact)", float(direction.max()),
                 "<", 2e-5)  # fmt: skip
    linear = float(distance.sel(quantity="fixed_speed/mean_linear"))
    balance = float(distance.sel(quantity="fixed_speed/mean_balance"))
    report.check("v = 0.3: A²v is off by v²/2 and more for ever", linear, ">", 0.045)
    report.check("v = 0.3: the von Mises balance over ε²", balance / epsilon**2,
                 "<", 0.5)  # fmt: skip


def check_against_expansions(report: Report, dataset: Any) -> None:
    """Distances from grids and from spectral solutions differ by less than they say."""
    noise = float(HALVINGS[1])
    s = SLOW_LENGTH * noise**2
    still = fp.LayDownModel(QUADRATIC, noise)
    moving = fp.LayDownModel(QUADRATIC, noise, fp.MovingBelt(PULL / noise**2))
    grid = fp.PhaseSpaceGrid((6.0, 5.5), (64, 56, 16))
    law = GaussianLaw(LARGE_NOISE_START.mean, LARGE_NOISE_START.variance)
    evolved = fp.spectral_solve(still, law, [s], tolerance=1e-6).density(s, grid)
    steady = fp.spectral_steady_state(moving, tolerance=1e-9).density(grid)
    cases = {
        "rest_uniform": (
            still, evolved, transient_limit(still, grid, law, s, corrected=True)
        ),
        "stationary": (moving, steady, stationary_limit(moving, grid)),
    }  # fmt: skip
    rows, shares = [], []
    for part, (model, p, limit) in cases.items():
        found = distances(p, limit, grid, model)
        for measure in MEASURES:
            one = dataset.sel(quantity=f"{part}/{measure}", noise=noise)
            if not math.isfinite(float(one["expected_order"])):
                continue
            value = float(one["distance"])
            # 2e-5 is what another grid changes in the sums of a norm.
            allowed = float(one["distance_error"]) + 2e-5
            shares.append(abs(value - found[measure]) / allowed)
            rows.append({"distance": f"{part}/{measure}", "grid": value,
                         "expansion": found[measure], "difference over error":
                         shares[-1]})  # fmt: skip
    report.table(rows)
    report.check("grid against expansion, over the error", max(shares), "<", 1.0)


def check_rest(report: Report) -> None:
    """At rest e^{−B}/2π is stationary for both, at every noise."""
    worst = 0.0
    for noise in (0.5, 2.0, 4.0):
        model = fp.LayDownModel(QUADRATIC, noise)
        grid = fp.PhaseSpaceGrid(5.5, (48, 48, 16))
        # Not the balanced form, which keeps it by construction.
        scheme = fp.drift_kick(model, grid)
        start = fp.initial.equilibrium(grid, QUADRATIC)
        n_steps = math.ceil(4 * max(1.0, noise**2))
        run = fp.solve(scheme, start, (0.0, 2.0), 2.0 / n_steps, extrapolate=True)
        found = distances(run.final, stationary_limit(model, grid), grid, model)
        worst = max(worst, found["joint_p1"])
    report.check("v = 0: e^{−B} kept in L¹, A = 0.5, 2, 4 (exact)", worst, "<", 1e-3)


def check_gap(report: Report) -> None:
    """The term after Λ, for potentials whose c is derived."""
    rows, worst = [], 0.0
    for potential in (QUADRATIC, fp.QuadraticPotential(1.0, 0.7), fp.LinearPotential()):
        poincare, noise = poincare_constant(potential), 16.0
        gap = float(fp.spectral_gap(fp.LayDownModel(potential, noise), tolerance=1e-12))
        measured = (gap * noise**2 / poincare - 1) * noise**4
        derived = next_gap_term(potential)
        worst = max(worst, abs(measured / derived - 1))
        rows.append({"B": potential.formula, "c measured at A = 16": measured,
                     "derived": derived})  # fmt: skip
    report.table(rows)
    # The next term is of relative size ε² = 1.5e-5, with a factor of at most 30.
    report.check("c of Λ(1 + cε²), relative error", worst, "<", 5e-4)


def check_smooth(report: Report, workers: int | None) -> None:
    """Smooth fibres at fixed a = A²R/2: the same orders, with F in the limit."""
    dataset = fp.studies.large_noise_limit(
        QUADRATIC, HALVINGS[:3], bending=0.5, parts=["stationary", "rest_uniform"],
        quick=True, workers=workers,
    )  # fmt: skip
    check_orders(report, dataset, "|ξ|²/2, a = 0.5")
    direction = dataset["distance"].sel(quantity="stationary/direction_p1")
    report.check("a = 0.5: stationary E τ with p₁, every noise (exact)",
                 float(direction.max()), "<", 2e-5)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="to ε = 1/16, coarser")
    parser.add_argument("--workers", type=int, help="processes; one for each CPU")
    arguments = parser.parse_args()
    quick = arguments.quick
    report = Report("large_noise_limit", quick)
    options = {
        "slow_length": SLOW_LENGTH, "belt_speed_scale": PULL, "quick": quick,
        "workers": arguments.workers,
    }  # fmt: skip
    dataset = fp.studies.large_noise_limit(
        QUADRATIC,
        HALVINGS[: 3 if quick else 4],
        parts=QUICK_PARTS if quick else None,
        **options,
    )
    check_orders(report, dataset, "|ξ|²/2")
    check_accuracy(report, dataset, "|ξ|²/2", 0.2)
    check_stationary(report, dataset)
    check_against_expansions(report, dataset)
    check_rest(report)
    check_gap(report)
    setting = "quick" if quick else "full"
    save_figure(plot_large_noise(dataset), f"large_noise_limit_{setting}.png")
    if not quick:
        check_smooth(report, arguments.workers)
        quartic = fp.studies.large_noise_limit(
            QUARTIC, HALVINGS[:3],
            parts=["stationary", "belt_directed", "rest_uniform", "gap"], **options,
        )  # fmt: skip
        check_orders(report, quartic, "|ξ|⁴/4")
        check_accuracy(report, quartic, "|ξ|⁴/4", 0.2)
        save_figure(plot_large_noise(quartic), "large_noise_limit_quartic.png")
    report.finish()


if __name__ == "__main__":
    main()
