"""Evidence that the references are converged: what moves them, and by how much.

    python validation/performance/reference_evidence.py            # 15 minutes
    python validation/performance/reference_evidence.py --noises 1

Each is solved again in a smaller box, with fewer points in ξ and in α and with a
tolerance 100 times larger; the code is compared with an exact solution, and the
reference with fpsolve's Galerkin method by sectors, with which it shares nothing. At
A = 0.1 and 10, where solutions take minutes, there is one variation, of all at once.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from fourier import FourierCollocation
from problem import (
    ANGLE,
    CONCENTRATION,
    MEAN,
    VARIANCE,
    Problem,
    cell_centres,
    open_mesh,
    torque,
)
from reference import FINE, Reference, compute, load_all, settings
from results import add_options, run_record, write_part
from timing import Stopwatch

# Arclengths at which the reference is used.
S_VALUES = {1.0: (1.0, 2.0, 5.0, 10.0)}
TOLERANCES = (1e-9, 1e-6, 1e-3)
# Little noise folds the density: a call takes seconds.
TOLERANCES_AT = {0.1: (1e-5, 1e-3)}
# Beyond the default, which refuses little noise.
WORK = 1e12
ALL_AT_ONCE = (0.1, 10.0)


def l1_difference(one: Reference, other: Reference) -> float:
    """∫|p − q| over the smaller box, on the midpoint grid of the common comparison."""
    half_width = min(one.half_width, other.half_width)
    axes = cell_centres(half_width, (90, 90, 60))
    volume = np.prod([axis[1] - axis[0] for axis in axes])
    return float(np.abs(one(*axes) - other(*axes)).sum() * volume)


def exact_solution_error(
    noise: float, s_end: float, setting: dict[str, Any], q: float = 1.0
) -> float:
    """L1 error on the exact solution p = e^{−B} (1 + q e^{−A²s/2} G)/(4π²) of (9).

    G = e^{−B}(ξ₁ sin α − ξ₂ cos α) is an eigenfunction for every isotropic potential;
    p is a density for |q| ≤ e^{1/2}.
    """
    diffusivity = Problem(noise).diffusivity
    code = FourierCollocation(setting["half_width"], setting["shape"], diffusivity)
    mesh = open_mesh(*code.axes)
    weight = np.exp(-(mesh[0] ** 2 + mesh[1] ** 2) / 2)
    momentum = -weight * torque(*mesh)

    def exact(s: float) -> np.ndarray:
        decay = np.exp(-diffusivity * s)
        return weight * (1 + q * decay * momentum) / (4 * np.pi**2)

    (computed,) = code.solve(exact(0.0), (s_end,), setting["rtol"])
    volume = np.prod([axis[1] - axis[0] for axis in code.axes])
    return float(np.abs(computed - exact(s_end)).sum() * volume)


def galerkin_differences(
    noise: float, s_values: tuple[float, ...], references: list[Reference]
) -> list[float] | None:
    """∫|p − q|, q by `fpsolve.spectral_solve` to the first tolerance that it reaches.

    None if it reaches none: little noise folds the density.
    """
    import fpsolve as fp
    from fpsolve.errors import MemoryLimitError, ToleranceError
    from fpsolve.paths import GaussianLaw

    model = fp.LayDownModel(fp.QuadraticPotential(), noise=noise)
    start = GaussianLaw(MEAN, VARIANCE, ANGLE, CONCENTRATION)
    grid = fp.PhaseSpaceGrid(half_width=6.0, shape=(90, 90, 60))
    axes = (grid.xi1, grid.xi2, grid.alpha)
    for tolerance in TOLERANCES_AT.get(noise, TOLERANCES):
        try:
            found = fp.spectral_solve(
                model, start, s_values, tolerance=tolerance, work_limit=WORK
            )
        except (ToleranceError, MemoryLimitError) as error:
            print(f"Galerkin, {tolerance:g}: {error}")
            continue
        return [
            float(
                np.abs(found.density(s, grid) - exact(*axes)).sum() * grid.cell_volume
            )
            for s, exact in zip(s_values, references, strict=True)
        ]
    return None


def variations(setting: dict[str, Any], noise: float) -> dict[str, dict[str, Any]]:
    """What is changed, one at a time where there is time for it."""
    n1, n2, n_alpha = setting["shape"]
    angles = n_alpha - (16 if n_alpha > 32 else 4)
    if noise in ALL_AT_ONCE:
        fewer = (n1 - 16, n2 - 16, angles)
        change = {"half_width": setting["half_width"] - 0.25, "shape": fewer}
        return {"all coarser": {**change, "rtol": setting["rtol"] * 10}}
    return {
        "smaller box": {"half_width": setting["half_width"] - 0.5},
        "fewer points in ξ": {"shape": (n1 - 16, n2 - 16, n_alpha)},
        "fewer points in α": {"shape": (n1, n2, angles)},
        "larger tolerance": {"rtol": setting["rtol"] * 100},
    }


def evidence(noise: float, *, quick: bool = False) -> list[dict[str, Any]]:
    """L1 differences to the variations at the first s, to Galerkin at every s."""
    setting, s_values = settings(noise, quick=quick), S_VALUES.get(noise, (1.0,))
    references = load_all(noise, s_values, quick=quick)
    rows: list[dict[str, Any]] = [{"noise": noise, "s": s, **setting} for s in s_values]
    for name, change in variations(setting, noise).items():
        with Stopwatch() as watch:
            (varied,) = compute(noise, s_values[:1], **{**setting, **change})
        rows[0][name] = l1_difference(references[0], varied)
        print(f"  {name} [{watch.cpu:.0f} CPU s]: {rows[0][name]:.1e}", flush=True)
    if noise not in ALL_AT_ONCE:
        rows[0]["exact solution"] = exact_solution_error(noise, s_values[0], setting)
    with Stopwatch() as watch:
        found = galerkin_differences(noise, s_values, references)
    print(f"  Galerkin [{watch.cpu:.0f} CPU s]: {found}", flush=True)
    for row, difference in zip(rows, found or [None] * len(rows), strict=True):
        row["Galerkin"] = difference
    return rows


def main() -> None:
    """Print and keep the evidence."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--noises", type=float, nargs="+", default=list(FINE))
    add_options(parser)
    arguments = parser.parse_args()
    for noise in arguments.noises:
        print(f"A = {noise:g}")
        rows = evidence(noise, quick=arguments.quick)
        write_part(f"reference-{noise:g}", run_record() | {"rows": rows}, arguments)


if __name__ == "__main__":
    main()
