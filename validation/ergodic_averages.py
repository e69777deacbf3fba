"""Averages along paths converge as theorem 3.3 says, fastest at a finite noise.

Claims, for B = |ξ|²/2 and paths started from the equilibrium: the averages of the
eigenfunction G and of cos α have their exact variances; the errors of the others
decay as s^{−1/2}, with the asymptotic variances of an expansion in Hermite functions;
for ‖ξ‖² and exp(−‖ξ‖²/2) these are least at a noise in between, where the expansion
has its minimum; (12) has their shape; its A term holds with the theorem's own constant.
The same minimum exists for B = |ξ|.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from hermite_poisson import FUNCTIONS, asymptotic_variance, least_noise
from reporting import Report, save_figure

import fpsolve as fp
from fpsolve.plotting.ergodicity import plot_ergodic_averages
from fpsolve.studies.ergodicity.averages import (
    ErgodicFit,
    ergodic_averages,
    fit_ergodic_error,
)

SEED = 20080611
# Poincaré constant c of ½∫|∇f|²e^{−B} for B = |ξ|²/2, see theorem 3.3.
POINCARE = 0.5
# Largest of about 200 deviations in units of standard errors from 40 batches.
LARGEST_DEVIATION = 5.0


def units(dataset: Any, variable: str, exact: np.ndarray) -> np.ndarray:
    """Deviation from the exact value over the standard error."""
    error = dataset[f"{variable}_standard_error"].to_numpy()
    return (dataset[variable].to_numpy() - exact) / error


def check_exact_laws(report: Report, dataset: Any) -> None:
    """The averages of G at every A and s, and the slope of those of cos α."""
    s, noise = dataset["s"].to_numpy(), dataset["noise"].to_numpy()[:, None]
    rate = noise**2 / 2
    exact = 2 * (s / rate - (1 - np.exp(-rate * s)) / rate**2) / s
    circulation = dataset.sel(function="circulation")
    variance = float(circulation["deviation"]) ** 2
    found = units(circulation, "scaled_variance", variance * exact)
    report.check(
        "averages of G have their exact variance, largest deviation / standard error",
        float(np.abs(found).max()), "<", LARGEST_DEVIATION,
    )  # fmt: skip
    direction = settled(dataset).sel(function="direction")
    found = units(direction, "asymptotic_variance", np.zeros(direction["noise"].size))
    report.check(
        "averages of cos α have no s^(-1/2) part, largest deviation / standard error",
        float(np.abs(found).max()), "<", LARGEST_DEVIATION,
    )  # fmt: skip


def check_asymptotic_variances(report: Report, dataset: Any) -> None:
    """Against the expansion, where the longest average allows the limit."""
    rows, worst = [], 0.0
    for noise in settled(dataset)["noise"].to_numpy():
        row: dict[str, Any] = {"A": float(noise)}
        for name, function in FUNCTIONS.items():
            if name == "direction":
                continue
            exact = asymptotic_variance(function, float(noise))
            one = dataset.sel(noise=noise, function=name)
            deviation = float(units(one, "asymptotic_variance", np.array(exact)))
            measured = float(one["asymptotic_variance"])
            row |= {f"{name}, paths": measured, f"{name}, exact": exact}
            worst = max(worst, abs(deviation))
        rows.append(row)
    report.table(rows)
    report.check(
        "asymptotic variances of the expansion, largest deviation / standard error",
        worst, "<", LARGEST_DEVIATION,
    )  # fmt: skip


def settled(dataset: Any) -> Any:
    """The noises at which a quarter of the longest average is long enough.

    What a start from equilibrium leaves decays like the slowest mode, at about A²/2
    when the noise is small and A^{−2} when it is large; it has to be below 1 % there.
    """
    noise = dataset["noise"]
    rate = np.minimum(noise**2 / 2, noise**-2.0)
    return dataset.isel(noise=np.flatnonzero(rate * dataset["s"][-1] / 4 > 5.0))


def check_decay(report: Report, dataset: Any) -> None:
    """Slope of ln(error) against ln(s) over the last factor of four, A near 1."""
    noises = dataset["noise"].to_numpy()
    noise = noises[np.argmin(np.abs(np.log(noises)))]
    late = dataset["s"] >= dataset["s"][-1] / 4
    for name in ("position", "square", "core"):
        error = dataset["error"].sel(noise=noise, function=name)[late.to_numpy()]
        slope = np.polyfit(np.log(error["s"]), np.log(error), 1)[0]
        report.check(
            f"|slope + 1/2| of ln error, {name}", abs(float(slope) + 0.5), "<", 0.06
        )


def check_best_noise(report: Report, fit: ErgodicFit) -> None:
    """Interior minima where the expansion has them."""
    rows = []
    for name, (low, high) in {"square": (0.4, 1.2), "core": (0.3, 1.0)}.items():
        shape, exact = fit[name], least_noise(FUNCTIONS[name], low, high)
        measured = shape.measured
        rows.append({
            "function": name, "best A, expansion": exact,
            "paths": measured.noise, "±": measured.standard_error,
            "shape of (12)": shape.best_noise, "misfit of the shape": shape.misfit,
        })  # fmt: skip
        report.check(
            f"best noise for {name}, deviation / standard error",
            abs(measured.noise - exact) / measured.standard_error, "<", 4.0,
        )  # fmt: skip
        report.check(f"misfit of the shape of (12), {name}", shape.misfit, "<", 0.1)
    report.table(rows)
    falling = fit["circulation"].measured.trend == "falling"
    report.check("G converges fastest at the largest noise", falling, ">", 0)
    rising = fit["position"].measured.trend == "rising"
    report.check("ξ₁ converges fastest at the smallest noise", rising, ">", 0)
    report.check(
        "worst function: fastest in between",
        fit.worst.measured.trend == "interior", ">", 0,
    )  # fmt: skip


def check_theorem(report: Report, dataset: Any) -> None:
    """(12) with the constants of theorem 3.3, its unknown one as small as possible.

    error / ‖f − E f‖ ≤ c^{−1/2} (2/s + s^{−1/2} (b/A + (1 + 1/√2) A)), where
    b = β₁ c^{1/2} + β₂ c^{−1/2} is not known.
    """
    relative = (dataset["error"] / dataset["deviation"]).max("function").to_numpy()
    s, noise = dataset["s"].to_numpy(), dataset["noise"].to_numpy()[:, None]
    known = (2 / s + (1 + 0.5**0.5) * noise / np.sqrt(s)) / POINCARE**0.5
    needed = (relative - known) * POINCARE**0.5 * noise * np.sqrt(s)
    large = noise[:, 0] >= 1.2
    report.check(
        "b needed at A ≥ 1.2: the 2/s and A terms are enough",
        float(needed[large].max()), "<=", 0.0,
    )  # fmt: skip
    # For G alone: 2/A ≤ √2 b/A + 2.41 A, so that b → √2 as A → 0.
    report.check(
        "b needed by all functions, noises and s", float(needed.max()), "<", 2**0.5
    )


def check_linear(report: Report, n_paths: int, n_noises: int, s_end: float) -> None:
    """B = |ξ|, the other potential of figure 5: a best noise for the width."""
    dataset = ergodic_averages(
        fp.LinearPotential(), np.geomspace(0.3, 2.4, n_noises), s_end=s_end,
        n_paths=n_paths, seed=SEED,
    )  # fmt: skip
    fit = fit_ergodic_error(dataset)
    report.console.print(f"B = |ξ|\n{fit}")
    shape = fit["square"]
    report.table([{
        "potential": "|ξ|", "best A, paths": shape.measured.noise,
        "±": shape.measured.standard_error, "shape of (12)": shape.best_noise,
        "misfit of the shape": shape.misfit,
    }])  # fmt: skip
    report.check(
        "B = |ξ|: ‖ξ‖² converges fastest in between",
        shape.measured.trend == "interior", ">", 0,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer paths and noises")
    quick = parser.parse_args().quick
    report = Report("ergodic_averages", quick)
    n_paths, n_noises, s_end = (1200, 7, 80.0) if quick else (12000, 13, 400.0)
    noises = np.geomspace(0.25, 4.0, n_noises)
    dataset = ergodic_averages(
        fp.QuadraticPotential(), noises, s_end=s_end, n_paths=n_paths, seed=SEED
    )
    fit = fit_ergodic_error(dataset)
    report.console.print(str(fit))
    check_exact_laws(report, dataset)
    check_asymptotic_variances(report, dataset)
    check_decay(report, dataset)
    check_best_noise(report, fit)
    check_theorem(report, dataset)
    check_linear(report, n_paths, 5 if quick else 9, s_end)
    setting = "quick" if quick else "full"
    figure = plot_ergodic_averages(dataset, fit=fit)
    save_figure(figure, f"ergodic_averages_{setting}.png")
    report.finish()


if __name__ == "__main__":
    main()
