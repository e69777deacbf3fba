"""H decays at twice the spectral gap: runs on grids against the spectrum.

Claims, at noises of all three regimes (the gap is A²/2; a complex pair; Λ/A² with a
correction): the asymptotic decay rate of H in a run of `drift_kick` is twice the
spectral gap, and ∫H ds is that of `spectral_solve`, both within the errors that the
run reports; these errors are small. Runs and spectra share no code but the model.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from reporting import Report, save_figure

import fpsolve as fp
from fpsolve.plotting.rates import plot_inverse_decay_rate, plot_rates
from fpsolve.studies.rates.rate_versus_noise import rate_versus_noise

# Runs at the coarse settings of `quick` are meant to be right, not sharp.
LARGEST_ERROR = {True: 2e-2, False: 1e-2}


def rows_of(dataset: Any) -> list[dict[str, Any]]:
    """One row for every noise."""
    return [row_of(dataset.isel(noise=place)) for place in range(dataset.noise.size)]


def row_of(one: Any) -> dict[str, Any]:
    """What one noise gave."""
    rate, error = float(one["entropy_rate"]), float(one["entropy_rate_error"])
    expected = 2 * float(one["gap"])
    return {
        "B": one.attrs["formula"], "A": float(one["noise"]),
        "slowest": str(one["gap_sector"].item()), "rate of H": f"{rate:.6f}",
        "±": error, "2 gap": f"{expected:.6f}",
        "deviation / error": (rate - expected) / error,
        "slope of ln H": float(one["entropy_rate_line"]),
        "∫ H ds": f"{float(one['inverse_decay_rate']):.4f}",
        "± ": float(one["inverse_decay_rate_error"]),
    }  # fmt: skip


def check(report: Report, dataset: Any, name: str) -> None:
    """The rate within its error, and the error small."""
    rate, error = dataset["entropy_rate"], dataset["entropy_rate_error"]
    off = np.abs(rate - 2 * dataset["gap"]) / (error + 2 * dataset["gap_error"])
    report.check(
        f"{name}: |rate of H − 2 gap| / reported error, {rate.size} noises",
        float(off.max()), "<=", 1.0,
    )  # fmt: skip
    if "²" in name:
        # That of |ξ| is larger: its modes reach the edge of every box.
        report.check(
            f"{name}: reported error of the rate, relative, at most",
            float((error / rate).max()), "<", LARGEST_ERROR[report.quick],
        )  # fmt: skip


def check_integrals(report: Report, dataset: Any) -> None:
    """∫H ds of runs and of the spectral solver, where it was asked for."""
    run, spectral = (
        dataset[f"{which}inverse_decay_rate"] for which in ("", "spectral_")
    )
    error = dataset["inverse_decay_rate_error"]
    error = error + dataset["spectral_inverse_decay_rate_error"]
    report.check(
        "B = |ξ|²/2: |∫H ds of runs − of spectral_solve| / reported errors",
        float((np.abs(run - spectral) / error).max()), "<=", 1.0,
    )  # fmt: skip
    report.check(
        "B = |ξ|²/2: reported error of ∫H ds, relative, at most",
        float((dataset["inverse_decay_rate_error"] / run).max()), "<", 1e-2,
    )  # fmt: skip
    least = int(np.argmin(run.to_numpy()))
    report.check(
        "B = |ξ|²/2: ∫H ds is least inside the range of noises",
        min(least, run.size - 1 - least), ">", 0,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="coarser, no linear B")
    quick = parser.parse_args().quick
    report = Report("decay_rate_is_the_gap", quick)
    setting = "quick" if quick else "full"
    noises = [0.45, 0.65, 0.9, 1.2, 1.8, 2.6, 3.6]
    parts = ["relaxation", "gap"]
    if not quick:
        noises = [0.25, 0.35, *noises, 5.0]
        parts += ["branches", "evolution"]
    quadratic = rate_versus_noise(
        fp.QuadraticPotential(), noises, quick=quick, parts=parts
    )
    rows = rows_of(quadratic)
    report.check(
        "number of eigenvalue branches that are slowest at some noise",
        len({row["slowest"] for row in rows}), ">", 2,
    )  # fmt: skip
    check(report, quadratic, "B = |ξ|²/2")
    if not quick:
        check_integrals(report, quadratic)
        linear = rate_versus_noise(
            fp.LinearPotential(), [0.4, 0.6, 2.0], parts=["relaxation", "gap"]
        )
        check(report, linear, "B = |ξ|")
        rows += rows_of(linear)
        figure = plot_inverse_decay_rate([quadratic, linear])
        save_figure(figure, f"inverse_decay_rate_{setting}.png")
        save_figure(plot_rates(quadratic), f"decay_rate_{setting}.png")
    report.table(rows)
    report.finish()


if __name__ == "__main__":
    main()
