"""Stationary bias of the three integrators of paths against the step.

On a belt at rest E‖ξ‖² = 2 for B = |ξ|²/2, whatever the noise. Ensembles start from
the stationary law, forget it, and are averaged over many nearly independent
arclengths; what is left of the difference is the bias of the step.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.paths import EquilibriumLaw

NOISES = (0.3, 1.0, 3.0)
STEPS = (0.4, 0.2, 0.1, 0.05)
METHODS = ("splitting", "heun", "euler_maruyama")
# Arclengths between two looks: E‖ξ‖² forgets half and more of itself over each.
LAG = 4.0


def bias(method: str, noise: float, ds: float, n_paths: int, n_looks: int):
    """Stationary E‖ξ‖² - 2 and its standard error."""
    model = fp.LayDownModel(fp.QuadraticPotential(), noise)
    settling = 40.0 if noise < 2 else 120.0
    looks = settling + LAG * np.arange(n_looks)
    paths = fp.sample_paths(
        model, n_paths, looks[-1], ds, seed=2008, save_at=looks, keep=True,
        method=method, initial=EquilibriumLaw(model.potential),
    )  # fmt: skip
    # The mean along each path is one observation: paths are independent, looks not.
    squares = (paths.xi**2).sum(axis=2).mean(axis=0)
    error = squares.std(ddof=1) / math.sqrt(n_paths)
    return float(squares.mean() - 2.0), float(error)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report = Report("path_bias", quick)
    n_paths, n_looks = (8192, 20) if quick else (65536, 60)
    steps = STEPS[:2] if quick else STEPS
    rows, found = [], {}
    for method in METHODS:
        for noise in NOISES:
            for ds in steps:
                value, error = bias(method, noise, ds, n_paths, n_looks)
                found[method, noise, ds] = value, error
                rows.append({"method": method, "A": noise, "ds": ds, "bias": value,
                             "standard error": error})  # fmt: skip
    report.table(rows)
    for noise in NOISES:
        splitting, error = found["splitting", noise, 0.2]
        euler, _ = found["euler_maruyama", noise, 0.2]
        claim = f"A = {noise:g}, ds = 0.2: |bias| of the splitting less 4 errors"
        report.check(claim, abs(splitting) - 4 * error, "<", 0.2 * 0.2**2)
        report.check(f"A = {noise:g}, ds = 0.2: of Euler-Maruyama", euler, ">", 0.1)
    report.finish()


if __name__ == "__main__":
    main()
