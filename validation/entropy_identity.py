"""The entropy a run records falls by the dissipation it records, to order 2 in ds.

Claims: dH/ds = −(A²/2)∫p(∂_α ln(p/p_S))² for both schemes at low, middle and high
noise, the defect of the integrated identity falling by at least 3 at every halving;
the entropy never rises; equilibrium is reached to rounding in the balanced forms.
"""

from __future__ import annotations

import argparse
from itertools import pairwise

import numpy as np
from reporting import Report
from scipy.integrate import simpson

import fpsolve as fp

SCHEMES = {
    "drift_kick, balanced": lambda m, g: fp.drift_kick(
        m, g, balanced=True, interpolation_order=12
    ),
    "semi_lagrangian": lambda m, g: fp.semi_lagrangian(m, g, interpolation_order=6),
}


def defect(make, noise: float, ds: float, shape: tuple[int, int, int]) -> dict:
    """Largest |H(s) − H(0) + ∫ dissipation| at even steps, and the largest rise."""
    model = fp.LayDownModel(fp.QuadraticPotential(), noise)
    grid = fp.PhaseSpaceGrid(5.0, shape)
    p0 = fp.initial.gaussian(
        grid, mean=(1.0, 0.0), variance=0.5, angle=np.pi / 2, concentration=1.0
    )
    solution = fp.solve(make(model, grid), p0, (0.0, 2.0), ds)
    entropy, lost = solution.relative_entropy, solution.entropy_dissipation
    lengths = range(3, entropy.size + 1, 2)
    spent = np.array([simpson(lost[:n], dx=ds) for n in lengths])
    left = np.array([entropy[n - 1] for n in lengths])
    return {
        "defect": float(np.abs(left - entropy[0] + spent).max()),
        "rise": float(np.diff(entropy).max()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one noise, coarser grid")
    quick = parser.parse_args().quick
    report = Report("entropy_identity", quick)
    shape = (40, 40, 32) if quick else (80, 80, 48)
    steps = (0.25, 0.125, 0.0625)
    for name, make in SCHEMES.items():
        rows = []
        for noise in (1.0,) if quick else (0.5, 1.0, 2.0):
            found = [defect(make, noise, ds, shape) for ds in steps]
            row = {"scheme": name, "A": noise}
            for ds, one in zip(steps, found, strict=True):
                row[f"defect, ds = {ds}"] = one["defect"]
            rows.append(row)
            for coarse, fine in pairwise(found):
                gain = coarse["defect"] / fine["defect"]
                report.check(f"{name}, A = {noise}: gain of a halving", gain, ">", 3.0)
            rise = max(one["rise"] for one in found)
            report.check(f"{name}, A = {noise}: largest rise of H", rise, "<", 1e-14)
        report.table(rows)
    report.finish()


if __name__ == "__main__":
    main()
