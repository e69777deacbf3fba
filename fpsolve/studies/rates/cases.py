"""The cases of a rate study: what one process computes for one noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.spectral.bases.essential import asymptotic_slope
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.gap import spectral_gap
from fpsolve.spectral.eigen.spectrum import Spectrum, spectrum
from fpsolve.spectral.evolution.evolution import spectral_solve
from fpsolve.studies.observables import Observable, equilibrium_moments
from fpsolve.studies.rates.poisson import asymptotic_variances, estimated_variances
from fpsolve.studies.rates.relaxation import relaxation_case
from fpsolve.studies.rates.relaxation_plan import plan_relaxation

__all__ = ["PARTS", "rate_case", "sectors_shown"]

# Eigenvalues of each sector: a complex pair, or two real ones.
_PER_SECTOR = 2
# Bytes for a branch, which is a few seconds; less where an essential spectrum lets
# modes reach so far out that bases grow at length.
_MEMORY, _MEMORY_ESSENTIAL = 2**26, 2**23
# Work for the gap, about a minute.
_WORK = 3e10
# Panels of the quadrature of H(s): the first, how fast they grow, nodes in each.
_FIRST_PANEL, _GROWTH, _NODES = 0.25, 1.5, 7


def rate_case(part: str, potential: Potential, **options: Any) -> dict[str, Any]:
    """One part of a rate study at one noise; see `PARTS`."""
    return dict(PARTS[part](potential, **options))


def sectors_shown(potential: Potential) -> list[Sector]:
    """The sectors whose leading branches a study follows."""
    if potential.isotropic:
        return [Sector(0, 1), Sector(0, -1), Sector(1), Sector(2)]
    return [Sector(None, across, along) for across in (1, -1) for along in (1, -1)]


def gap_case(potential: Potential, noise: float, tolerance: float) -> Mapping[str, Any]:
    """The spectral gap, over all sectors."""
    model = LayDownModel(potential, noise)
    gap = spectral_gap(model, tolerance=tolerance, work_limit=_WORK)
    return {
        "gap": float(gap),
        "gap_error": gap.error,
        "gap_frequency": abs(gap.eigenvalue.imag),
        "gap_sector": "essential" if gap.sector is None else str(gap.sector),
    }


def branches_case(
    potential: Potential, noise: float, tolerance: float
) -> Mapping[str, Any]:
    """The leading eigenvalues of every sector shown; what is not reached is NaN."""
    model = LayDownModel(potential, noise)
    sectors = sectors_shown(potential)
    values = np.full((len(sectors), _PER_SECTOR), complex(np.nan, np.nan))
    errors = np.full(values.shape, np.nan)
    essential = math.nan
    for row, sector in enumerate(sectors):
        found = _leading(model, sector, tolerance)
        if found is None:
            continue
        upper = found.eigenvalues.imag >= 0
        chosen = found.eigenvalues[upper]
        values[row, : chosen.size] = chosen
        errors[row, : chosen.size] = found.errors[upper]
        if found.essential is not None:
            essential = -found.essential
    return {
        "branch_rate": -values.real,
        "branch_frequency": values.imag,
        "branch_error": errors,
        "essential_rate": essential,
    }


def _leading(model: LayDownModel, sector: Sector, tolerance: float) -> Spectrum | None:
    """The slowest eigenvalues of a sector, fewer or none where they need too much."""
    linear = model.potential.isotropic and np.isfinite(
        asymptotic_slope(model.potential)
    )
    memory = _MEMORY_ESSENTIAL if linear else _MEMORY
    for n in (_PER_SECTOR, 1):
        try:
            return spectrum(
                model, n, tolerance=tolerance, sectors=[sector], memory_limit=memory
            )
        except (ToleranceError, MemoryLimitError):
            continue
    return None


def variance_case(
    potential: Potential,
    noise: float,
    tolerance: float,
    functions: Mapping[str, Observable],
) -> Mapping[str, Any]:
    """Asymptotic variances of averages over those of the functions.

    NaN where nothing is known; ToleranceError where that is so of all.
    """
    model = LayDownModel(potential, noise)
    found = estimated_variances(model, functions, tolerance).known_only()
    if np.isnan(found.values).all():
        found = asymptotic_variances(model, functions, tolerance=tolerance)
    scale = equilibrium_moments(potential, functions).deviation ** 2
    return {
        "asymptotic_variance": found.values / scale,
        "asymptotic_variance_error": found.errors / scale,
    }


def evolution_case(
    potential: Potential,
    noise: float,
    law: Any,
    tolerance: float,
    grid_tolerance: float,
    e_folds: float,
    s_end: float | None,
) -> Mapping[str, Any]:
    """∫₀^S H ds by `spectral_solve`, to the S of the run on a grid."""
    model = LayDownModel(potential, noise)
    end = plan_relaxation(model, grid_tolerance, e_folds, s_end).s_end
    s, weights, lower = _gauss_panels(end)
    found = spectral_solve(model, law, s, tolerance=tolerance)
    entropy, errors = found.relative_entropy, found.errors["relative_entropy"]
    total = float(entropy @ weights)
    quadrature = abs(float(entropy @ lower) - total)
    return {
        "spectral_inverse_decay_rate": total,
        "spectral_inverse_decay_rate_error": float(errors @ weights) + quadrature,
    }


def _gauss_panels(end: float) -> tuple[Array, Array, Array]:
    """Nodes and weights on [0, end], and weights of a poorer rule on the same nodes.

    The poorer rule integrates the polynomial through all nodes but the middle one.
    """
    edges = [0.0, min(_FIRST_PANEL, end)]
    while edges[-1] < end:
        edges.append(edges[-1] + _GROWTH * (edges[-1] - edges[-2]))
    scaled = np.array(edges) * (end / edges[-1])
    x, w = np.polynomial.legendre.leggauss(_NODES)
    kept = np.delete(np.arange(_NODES), _NODES // 2)
    powers = np.vander(x[kept], increasing=True).T
    moments = [(1 + (-1) ** n) / (n + 1) for n in range(kept.size)]
    poorer = np.zeros(_NODES)
    poorer[kept] = np.linalg.solve(powers, moments)
    half, middle = np.diff(scaled) / 2, (scaled[1:] + scaled[:-1]) / 2
    nodes = (middle[:, None] + half[:, None] * x).ravel()
    return nodes, np.outer(half, w).ravel(), np.outer(half, poorer).ravel()


# In the order in which they are computed: the long ones first.
PARTS: dict[str, Callable[..., Mapping[str, Any]]] = {
    "relaxation": relaxation_case,
    "evolution": evolution_case,
    "branches": branches_case,
    "gap": gap_case,
    "variance": variance_case,
}
