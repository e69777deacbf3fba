"""The error laws behind `suggest_step` and `suggest_grid`, measured and asserted.

Claims: (1) one run with Strang splitting has ‖p − p_exact‖₁ ≤ C ds² with
C = 0.4 (1 + κ) + 0.18 A²; (2) with the suggested grid and step the error is below the
tolerance; (3) Richardson extrapolation lowers it at the same ds, except where B has
a kink. Reference: the same
model on a finer grid with a quarter of the step, extrapolated.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from reporting import Report, restricted

import fpsolve as fp
from fpsolve.density import error_laws
from fpsolve.model.potentials.nodes import gibbs_nodes


@dataclass(frozen=True)
class Case:
    name: str
    potential: fp.QuadraticPotential | fp.PowerPotential | fp.LinearPotential
    noise: float
    belt_speed: float = 0.0

    @property
    def model(self) -> fp.LayDownModel:
        curve = fp.MovingBelt(self.belt_speed) if self.belt_speed else fp.FixedBelt()
        return fp.LayDownModel(self.potential, self.noise, curve)


CASES = [
    Case("quadratic, A = 1", fp.QuadraticPotential(), 1.0),
    Case("quadratic, A = 1, v = 0.1", fp.QuadraticPotential(), 1.0, 0.1),
    Case("quadratic, A = 0.3", fp.QuadraticPotential(), 0.3),
    Case("quadratic, A = 3", fp.QuadraticPotential(), 3.0),
    Case("anisotropic 1:0.5, A = 1", fp.QuadraticPotential(1.0, 0.5), 1.0),
    Case("quartic, A = 1", fp.PowerPotential(4.0), 1.0),
    Case("linear, A = 1", fp.LinearPotential(), 1.0),
]
QUICK = CASES[:2]


def start(grid: fp.PhaseSpaceGrid, potential: object) -> np.ndarray:
    """Half as wide as the equilibrium, off centre, pointing across."""
    deviation1, deviation2 = gibbs_nodes(potential).deviations()
    return fp.initial.gaussian(
        grid,
        mean=(deviation1, 0.0),
        variance=(deviation1**2 / 4, deviation2**2 / 4),
        angle=np.pi / 2,
        concentration=4.0,
    )


def evolve(case: Case, grid, ds: float, s_end: float, **options) -> np.ndarray:
    scheme = fp.drift_kick(case.model, grid, **options.pop("scheme", {}))
    solution = fp.solve(
        scheme, start(grid, case.potential), (0.0, s_end), ds,
        record_every=10**6, boundary_tolerance=0.05, **options,
    )  # fmt: skip
    return solution.final


def measure(case: Case, tolerance: float, s_end: float, refinement: float) -> dict:
    grid = fp.suggest_grid(case.model, tolerance)
    step = fp.suggest_step(case.model, grid, tolerance)
    n1, n2, n_alpha = (8 * round(refinement * n / 8) for n in grid.shape)
    fine = fp.PhaseSpaceGrid(grid.half_widths, (n1, n2, n_alpha))
    reference = evolve(
        case, fine, step / 4, s_end, extrapolate=True,
        scheme={"interpolation_order": 12},
    )  # fmt: skip
    reference = restricted(reference, fine, grid)

    def error(p: np.ndarray) -> float:
        return fp.diagnostics.l1_distance(p, reference, grid)

    plain = error(evolve(case, grid, float(step), s_end))
    halved = error(evolve(case, grid, step / 2, s_end))
    extrapolated = error(evolve(case, grid, float(step), s_end, extrapolate=True))
    return {
        "case": case.name,
        "tolerance": tolerance,
        "grid": list(grid.shape),
        "half_width": list(grid.half_widths),
        "ds": float(step),
        "error": plain,
        "error at ds/2": halved,
        "error extrapolated": extrapolated,
        "error / law": plain / (law(case, grid) * float(step) ** 2),
    }


def law(case: Case, grid) -> float:
    force = error_laws.mean_square_force(case.model, grid)
    return error_laws.splitting_coefficient(case.model, force)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two cases, s to 1")
    quick = parser.parse_args().quick
    report = Report("error_laws", quick)
    rows = [
        measure(case, 1e-2, 1.0 if quick else 3.0, 1.25 if quick else 1.5)
        for case in (QUICK if quick else CASES)
    ]
    report.table(rows)
    for row in rows:
        report.check(f"{row['case']}: error below tolerance", row["error"], "<", 1e-2)
        report.check(f"{row['case']}: error below law", row["error / law"], "<", 1.0)
        if not row["case"].startswith("linear"):
            report.check(
                f"{row['case']}: extrapolation gains",
                row["error extrapolated"], "<", row["error"],
            )  # fmt: skip
    report.finish()


if __name__ == "__main__":
    main()
