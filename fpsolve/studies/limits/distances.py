"""How far a density of the full equation is from what the limit says about it."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.persistence import Persistence
from fpsolve.reduced.hydrodynamic.effective_potential import EffectivePotential
from fpsolve.studies.limits.plane_limit import Approximation

__all__ = ["distances", "second_moment"]

# Angles of a norm for every angle of the grid.
_FINER = 4


def distances(
    p: Array,
    approximation: Approximation,
    grid: PhaseSpaceGrid,
    model: FibreModel,
    layer: Array | None = None,
) -> dict[str, float]:
    """L1 norms of densities, absolute differences of numbers.

    - marginal: ‖∫p dα − 𝒫‖₁;
    - joint, joint_p1: ‖p − 𝒫/2π‖₁ and ‖p − 𝒫/2π − εp₁‖₁;
    - mean, second_moment: of E ξ (Euclidean norm) and of E‖ξ‖²;
    - entropy: of H(p | e^{−B}/2πZ), without p₁; e^{−B/F} for smooth fibres;
    - direction, direction_p1: of E τ, without and with p₁.

    Parameters
    ----------
    p : ndarray, shape ``grid.shape``
    approximation : Approximation
    grid : PhaseSpaceGrid
    model : LayDownModel or SmoothLayDownModel
    layer : ndarray, optional
        Initial layer, added to everything but 𝒫/2π.
    """
    corrected = approximation.joint if layer is None else approximation.joint + layer
    uniform = np.ascontiguousarray(approximation.uniform)
    plane = diagnostics.marginal(corrected, grid, "xi")
    marginal = diagnostics.marginal(p, grid, "xi")
    reference = _at_rest(model, grid)
    entropies = [diagnostics.relative_entropy(q, grid, reference) for q in (p, uniform)]
    full, reduced = (diagnostics.moments(q, grid) for q in (p, corrected))
    return {
        "marginal": float(np.abs(marginal - plane).sum()) * grid.cell_area,
        "joint": _l1_norm(p - uniform, grid),
        "joint_p1": _l1_norm(p - corrected, grid),
        "mean": _apart(full, reduced, "mean_xi1", "mean_xi2"),
        "second_moment": abs(second_moment(full) - second_moment(reduced)),
        "entropy": abs(entropies[0] - entropies[1]),
        "direction": math.hypot(full["mean_cos_alpha"], full["mean_sin_alpha"]),
        "direction_p1": _apart(full, reduced, "mean_cos_alpha", "mean_sin_alpha"),
    }


def _at_rest(model: FibreModel, grid: PhaseSpaceGrid) -> Array:
    """e^{−B/F}/2πZ: what is stationary on a belt at rest, in the limit at least."""
    if isinstance(model, LayDownModel):
        return model.equilibrium(*grid.plane())
    factor = Persistence.of(model).factor
    phi = EffectivePotential(model.potential, 0.0, factor)
    return phi.density(*grid.plane()) / math.tau


def _l1_norm(difference: Array, grid: PhaseSpaceGrid) -> float:
    """∫ |f| dξ dα, f interpolated between the angles: |cos α| has kinks, f has not."""
    n_alpha = _FINER * grid.shape[2]
    waves = np.fft.rfft(difference, axis=2)
    between = np.fft.irfft(waves, n=n_alpha, axis=2) * _FINER
    return float(np.abs(between).sum()) * grid.cell_volume / _FINER


def _apart(one: dict[str, float], other: dict[str, float], *names: str) -> float:
    return math.hypot(*(one[name] - other[name] for name in names))


def second_moment(moments: dict[str, float]) -> float:
    """E‖ξ‖²."""
    spread = moments["variance_xi1"] + moments["variance_xi2"]
    return spread + moments["mean_xi1"] ** 2 + moments["mean_xi2"] ** 2
