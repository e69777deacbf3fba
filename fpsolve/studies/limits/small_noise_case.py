"""One noise: the law of G by full solver, paths and averaged equation."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.grids import initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.paths.sampling import sample_paths
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.studies.limits.energy_law import SmoothedLaw, energy_masses

__all__ = ["half_width_for", "small_noise_case"]

# The box leaves this share of e^{-B} outside.
_OUTSIDE = 3e-5
# The averaged equation is solved to about 1e-6 of what it is compared with.
_N_ENERGY_CELLS, _N_STEPS = 800, 200
_N_ANGLES = 40
# A second grid with cells this much wider tells the error of the grid.
_COARSER = 4 / 3
# Steps between two records: moving half steps merge in between.
_RECORDS = 8


def small_noise_case(
    potential: Potential,
    noise: float,
    law: GaussianLaw,
    slow_length: float,
    belt_speed_scale: float,
    spacing: float,
    ds: float,
    n_paths: int,
    seed: int,
) -> dict[str, Any]:
    """Laws of G at A² s = slow_length, smoothed, and their distances.

    Parameters
    ----------
    potential : Potential
    noise : float
    law : GaussianLaw
    slow_length : float
        A² s.
    belt_speed_scale : float
        v/A².
    spacing : float
        Width of the ξ cells in units of the radius of the circle.
    ds : float
        Longer step of the extrapolated run; the sampler takes it too.
    n_paths : int
        Paths; none with 0.
    seed : int
    """
    speed = belt_speed_scale * noise**2
    curve = MovingBelt(speed) if speed else FixedBelt()
    model = LayDownModel(potential, noise, curve)
    process = EnergyProcess(potential, noise)
    smoothed = SmoothedLaw(process)
    s_end = slow_length / noise**2
    step = s_end / math.ceil(s_end / ds)
    averaged = _averaged(process, smoothed, law, s_end)
    fine = _by_solver(model, smoothed, law, s_end, step, spacing)
    coarse = _by_solver(model, smoothed, law, s_end, step, _COARSER * spacing)
    values = {
        "averaged_law": averaged["law"],
        "start_law": averaged["start"],
        "solver_law": fine["law"],
        "distance": _distance(fine["law"], averaged["law"]),
        "distance_error": _distance(fine["law"], coarse["law"]),
        "mean": fine["mean"],
        "exact_mean": fine["mean_at_start"] * math.exp(-0.5 * slow_length),
        "second_moment": fine["second_moment"],
        "averaged_second_moment": averaged["second_moment"],
        "boundary_mass": fine["boundary_mass"],
        "cells": fine["cells"],
        "s_end": s_end,
    }
    if n_paths:
        found = _by_paths(model, smoothed, law, s_end, step, n_paths, seed)
        values |= _compared(found, fine["law"], averaged["law"])
    return values


def half_width_for(potential: Potential, process: EnergyProcess) -> float:
    """L with all but 3e-5 of e^{-B} inside the circle of radius L."""
    from scipy.integrate import quad
    from scipy.optimize import brentq

    normalisation = potential.normalisation

    def weight(r: float) -> float:
        return r * math.exp(normalisation.lowest - float(potential.radial_value(r)))

    total = normalisation.integral / (2 * math.pi)

    def excess(width: float) -> float:
        return float(quad(weight, width, math.inf)[0]) / total - _OUTSIDE

    low = high = process.radius
    while excess(high) > 0:
        high *= 1.5
    return float(brentq(excess, low, high, xtol=1e-6))


def _averaged(
    process: EnergyProcess, smoothed: SmoothedLaw, law: GaussianLaw, s_end: float
) -> dict[str, Any]:
    grid = process.grid(_N_ENERGY_CELLS, signed=True)
    start = energy_masses(law, process, grid)
    solution = process.solve(
        start, (0.0, s_end), s_end / _N_STEPS, grid=grid, method="sdirk2",
        extrapolate=True, record_every=_N_STEPS,
    )  # fmt: skip
    masses = solution.masses[-1]
    return {
        "law": smoothed.of_masses(masses, grid),
        "start": smoothed.of_masses(start, grid),
        "second_moment": float(masses @ grid.centres**2),
    }


def _by_solver(
    model: LayDownModel,
    smoothed: SmoothedLaw,
    law: GaussianLaw,
    s_end: float,
    ds: float,
    spacing: float,
) -> dict[str, Any]:
    process = smoothed.process
    half_width = half_width_for(model.potential, process)
    n_cells = 2 * math.ceil(half_width / (spacing * process.radius))
    grid = PhaseSpaceGrid(half_width, (n_cells, n_cells, _N_ANGLES))
    p0 = initial.gaussian(grid, law.mean, law.variance, law.angle, law.concentration)
    n_steps = round(s_end / ds)
    solution = solve(
        drift_kick(model, grid, balanced=True), p0, (0.0, s_end), ds,
        extrapolate=True, record_every=max(1, n_steps // _RECORDS),
    )  # fmt: skip
    energies = process.energy(*grid.mesh())
    share = solution.final / solution.final.sum()
    return {
        "law": smoothed.of_density(solution.final, grid),
        "mean": float((share * energies).sum()),
        "mean_at_start": float((p0 * energies).sum() / p0.sum()),
        "second_moment": float((share * energies**2).sum()),
        "boundary_mass": float(solution.boundary_mass.max()),
        "cells": np.array(grid.shape),
    }


def _by_paths(
    model: LayDownModel,
    smoothed: SmoothedLaw,
    law: GaussianLaw,
    s_end: float,
    ds: float,
    n_paths: int,
    seed: int,
) -> tuple[Array, Array]:
    paths = sample_paths(
        model, n_paths=n_paths, s_end=s_end, ds=ds, seed=seed, initial=law
    )
    xi1, xi2 = paths.xi[-1].T
    return smoothed.of_energies(smoothed.process.energy(xi1, xi2, paths.alpha[-1]))


def _compared(
    found: tuple[Array, Array], solver: Array, averaged: Array
) -> dict[str, Any]:
    """Distances of the paths, what chance alone makes of them, and the largest z."""
    mean, error = found
    return {
        "paths_law": mean,
        "paths_error": error,
        "paths_distance": _distance(mean, averaged),
        "paths_distance_by_chance": float(error.sum() * math.sqrt(2 / math.pi)),
        "paths_z": float(np.abs((mean - solver) / error).max()),
    }


def _distance(one: Array, other: Array) -> float:
    return float(np.abs(one - other).sum())
