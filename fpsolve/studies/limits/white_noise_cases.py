"""The cases of the white-noise study: what one process computes for one R."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.grids import diagnostics, initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.limits.coupled_paths import coupled_distances
from fpsolve.studies.limits.distances import second_moment
from fpsolve.studies.limits.smooth_runs import smooth_marginal
from fpsolve.studies.limits.white_noise_rates import gap_case, variance_case

__all__ = ["PARTS", "WhiteNoiseResolution", "possible_parts", "white_noise_case"]

# The comparison has fewer cells by a sixth and steps longer by a half.
_FEWER, _LONGER = 5 / 6, 1.5
# Steps for every relaxation length of the coupled paths, and of their comparison.
_STEPS, _COARSE_STEPS = 4.0, 2.0
Numbers = dict[str, float]


@dataclass(frozen=True)
class WhiteNoiseResolution:
    """Cells and longest step of both densities; the cells in κ follow from R.

    Attributes
    ----------
    grid : PhaseSpaceGrid
    ds : float
        Longer of the two steps of an extrapolated run, at most.
    """

    grid: PhaseSpaceGrid
    ds: float

    def coarser(self) -> WhiteNoiseResolution:
        """The discretisation that a run is compared with."""
        n1, n2, n_alpha = (2 * math.ceil(_FEWER * n / 2) for n in self.grid.shape)
        grid = PhaseSpaceGrid(self.grid.half_width, (n1, n2, n_alpha))
        return WhiteNoiseResolution(grid, _LONGER * self.ds)


def white_noise_case(
    part: str,
    potential: Potential,
    noise: float,
    relaxation_length: float,
    belt_speed: float,
    **options: Any,
) -> Numbers:
    """One part of a study at one R; see `PARTS`."""
    curve = MovingBelt(belt_speed) if belt_speed else FixedBelt()
    model = SmoothLayDownModel(potential, relaxation_length, noise, curve)
    return dict(PARTS[part](model, **options))


def density_case(
    model: SmoothLayDownModel,
    law: GaussianLaw,
    s_end: float,
    resolution: WhiteNoiseResolution,
) -> Numbers:
    """Distances of the densities of (ξ, α) from one start, κ from its Gaussian."""
    fine, coarse = (
        _densities(model, law, s_end, one) for one in (resolution, resolution.coarser())
    )
    errors = {f"{name}_error": abs(one - coarse[name]) for name, one in fine.items()}
    return {**fine, **errors}


def _densities(
    model: SmoothLayDownModel,
    law: GaussianLaw,
    s_end: float,
    resolution: WhiteNoiseResolution,
) -> Numbers:
    grid = resolution.grid
    p0 = initial.gaussian(grid, law.mean, law.variance, law.angle, law.concentration)
    n_steps = math.ceil(s_end / resolution.ds)
    limit = solve(
        drift_kick(model.white_noise_limit, grid), p0, (0.0, s_end), s_end / n_steps,
        extrapolate=True, record_every=n_steps,
    ).final  # fmt: skip
    return _apart(smooth_marginal(model, grid, p0, s_end, n_steps), limit, grid)


def _apart(p: Array, limit: Array, grid: PhaseSpaceGrid) -> Numbers:
    """L1 norms of densities, absolute differences of moments."""
    away = np.abs(p - limit).sum() * grid.cell_volume
    numbers = {"joint": float(away)}
    for name, axes in (("marginal", "xi"), ("angle", "alpha")):
        one, other = (diagnostics.marginal(q, grid, axes) for q in (p, limit))
        cell = grid.cell_area if axes == "xi" else grid.spacing[2]
        numbers[name] = float(np.abs(one - other).sum()) * cell
    full, reduced = (diagnostics.moments(q, grid) for q in (p, limit))
    differences = {name: full[name] - reduced[name] for name in full}
    numbers["mean"] = math.hypot(differences["mean_xi1"], differences["mean_xi2"])
    numbers["direction"] = math.hypot(
        differences["mean_cos_alpha"], differences["mean_sin_alpha"]
    )
    numbers["second_moment"] = abs(second_moment(full) - second_moment(reduced))
    return numbers


def paths_case(
    model: SmoothLayDownModel, law: GaussianLaw, s_end: float, n_paths: int, seed: int
) -> Numbers:
    """Mean distances of paths with the same Wiener process."""
    fine, coarse = (
        coupled_distances(model, law, s_end, steps, n_paths, seed)
        for steps in (_STEPS, _COARSE_STEPS)
    )
    numbers: Numbers = {}
    for name in ("angle", "position", "corrected"):
        # Chance of both, and what the steps of one change.
        change = abs(fine[name] - coarse[name])
        numbers[name] = fine[name]
        numbers[f"{name}_error"] = change + fine[f"{name}_error"]
    return numbers


# In the order in which they are computed: the long ones first.
PARTS: dict[str, Callable[..., Mapping[str, float]]] = {
    "density": density_case,
    "paths": paths_case,
    "gap": gap_case,
    "variance": variance_case,
}


def possible_parts(potential: Potential, belt_speed: float) -> list[str]:
    """The parts of a study that potential and belt allow.

    Gap and variance are expanded for isotropic quadratic B on a belt at rest.
    """
    isotropic = isinstance(potential, QuadraticPotential) and potential.isotropic
    expanded = isotropic and not belt_speed
    return [part for part in PARTS if expanded or part not in ("gap", "variance")]
