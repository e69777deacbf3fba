"""One run of the limit equation: from arguments to a solution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.progress import ProgressCallback
from fpsolve._support.provenance import Stopwatch
from fpsolve.errors import DomainTooSmallError
from fpsolve.evolution.schedule import Schedule
from fpsolve.grids.plane import PlaneGrid
from fpsolve.reduced.hydrodynamic.equation import LimitEquation
from fpsolve.reduced.hydrodynamic.scharfetter_gummel import gibbs_masses
from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution
from fpsolve.reduced.relaxation import Relaxation, completed

__all__ = ["check_box", "checked_start", "solve"]


_MOMENTS = ("xi1", "xi2", "xi1_xi1", "xi2_xi2", "xi1_xi2")


def checked_start(given: Any, plane: PlaneGrid) -> Array:
    """The density at the start on the grid, finite and with mass."""
    if callable(given):
        density = plane.evaluate(given)
        density = density / (density.sum() * plane.cell_area)
    else:
        density = plane.check(given, "P0")
    if not np.isfinite(density).all():
        raise ValueError("`P0` must be finite, got NaN or infinity.")
    if not density.sum() > 0:
        raise ValueError(f"`P0` must have positive mass, got {density.sum():g}.")
    return density


def solve(
    limit: LimitEquation,
    plane: PlaneGrid,
    start: Array,
    schedule: Schedule,
    *,
    method: str,
    extrapolate: bool,
    progress: bool | ProgressCallback,
) -> HydrodynamicSolution:
    """Relax the cell masses and read densities and series off them."""
    watch = Stopwatch()

    def solution(
        found: Relaxation, errors: Mapping[str, Array] | None, status: str
    ) -> HydrodynamicSolution:
        n_steps = schedule.n_steps * (1 + 2 * (errors is not None))
        return HydrodynamicSolution(
            limit=limit,
            grid=plane,
            method=method,
            ds=schedule.ds,
            series=series_of(found, plane),
            saved_s=found.saved_s,
            densities=found.saved.reshape(-1, *plane.shape) / plane.cell_area,
            errors=None if errors is None else errors_of(found, errors),
            provenance=watch.provenance(n_steps),
            initial_density=start,
            status=status,
        )

    masses = start.ravel() * plane.cell_area
    stationary = gibbs_masses(limit.effective_potential(*plane.mesh())).ravel()
    solved: HydrodynamicSolution = completed(
        solution, limit.generator(plane), masses, stationary, schedule,
        method=method, observables=observables(plane), extrapolate=extrapolate,
        progress=progress,
    )  # fmt: skip
    return solved


def observables(plane: PlaneGrid) -> dict[str, Array]:
    """Functions of the cell whose averages make the series."""
    xi1, xi2 = (x.ravel() for x in np.broadcast_arrays(*plane.mesh()))
    ring = np.ones(plane.shape)
    ring[1:-1, 1:-1] = 0.0
    values = xi1, xi2, xi1**2, xi2**2, xi1 * xi2
    return {**dict(zip(_MOMENTS, values, strict=True)), "ring": ring.ravel()}


def series_of(relaxation: Relaxation, plane: PlaneGrid) -> dict[str, Array]:
    """Series of the density from those of the cell masses."""
    mass, mean = relaxation.mass, relaxation.series
    mean1, mean2 = mean["xi1"] / mass, mean["xi2"] / mass
    return {
        "s": relaxation.s,
        "mass": mass,
        "relative_entropy": relaxation.relative_entropy,
        "entropy_dissipation": relaxation.entropy_dissipation,
        "minimum": relaxation.minimum / plane.cell_area,
        "boundary_mass": mean["ring"] / mass,
        "mean_xi1": mean1,
        "mean_xi2": mean2,
        "variance_xi1": mean["xi1_xi1"] / mass - mean1**2,
        "variance_xi2": mean["xi2_xi2"] / mass - mean2**2,
        "covariance": mean["xi1_xi2"] / mass - mean1 * mean2,
    }


def errors_of(relaxation: Relaxation, errors: Mapping[str, Array]) -> dict[str, Array]:
    """Estimates under the names of the series.

    Those of averages add up in the variances, which are differences of them.
    """
    mass = relaxation.mass
    mean1, mean2 = (np.abs(relaxation.series[name] / mass) for name in _MOMENTS[:2])
    of = {name: errors[name] / mass for name in (*_MOMENTS, "ring")}
    error1, error2 = of["xi1"], of["xi2"]
    return {
        "relative_entropy": errors["relative_entropy"],
        "entropy_dissipation": errors["entropy_dissipation"],
        "boundary_mass": of["ring"],
        "mean_xi1": error1,
        "mean_xi2": error2,
        "variance_xi1": of["xi1_xi1"] + (2 * mean1 + error1) * error1,
        "variance_xi2": of["xi2_xi2"] + (2 * mean2 + error2) * error2,
        "covariance": (
            of["xi1_xi2"] + mean1 * error2 + mean2 * error1 + error1 * error2
        ),
        "density_l1": errors["saved_l1"],
    }


def check_box(solution: HydrodynamicSolution, tolerance: float) -> None:
    """Raise if mass has reached the walls; the finished run goes with the error."""
    share = solution.series["boundary_mass"]
    bad = np.flatnonzero(~(share <= tolerance))
    if bad.size:
        error = DomainTooSmallError(
            float(share[bad[0]]),
            solution.grid.half_width,
            float(solution.series["s"][bad[0]]),
            tolerance,
        )
        error.solution = replace(solution, status="failed")
        raise error
