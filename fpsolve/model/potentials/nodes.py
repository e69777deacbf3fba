"""Places and weights of e^{-B}/Z: where its mass lies, how fine its features are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadrature import node_places, node_values, rules_for

__all__ = ["GibbsNodes", "gibbs_nodes"]

# What no mean can show is left out.
_NEGLIGIBLE = 1e-20
# Angles on a circle of an isotropic potential: enough for second moments, and for the
# mass beyond a line to 1e-3 of its distance.
_N_ANGLES = 64


@dataclass(frozen=True)
class GibbsNodes:
    """Nodes ξ_i with Σ w_i f(ξ_i) ≈ ∫ f e^{-B}/Z, from the quadrature of Z.

    Attributes
    ----------
    potential : Potential
    xi1, xi2, weight : ndarray, shape (n,)
        The weights sum to one.
    unknown : float
        Share of the mass that may lie elsewhere: beyond all nodes, or by error.
    """

    potential: Potential
    xi1: Array
    xi2: Array
    weight: Array
    unknown: float

    def mean(self) -> tuple[float, float]:
        """E ξ."""
        return float(self.weight @ self.xi1), float(self.weight @ self.xi2)

    def deviations(self) -> tuple[float, float]:
        """Standard deviations of ξ1 and ξ2."""
        mean1, mean2 = self.mean()
        variance1 = float(self.weight @ (self.xi1 - mean1) ** 2)
        variance2 = float(self.weight @ (self.xi2 - mean2) ** 2)
        return math.sqrt(variance1), math.sqrt(variance2)

    def mean_square_forces(self) -> tuple[float, float]:
        """E (∂₁B)² and E (∂₂B)²: 1/σ₁² and 1/σ₂² of a Gaussian, and of wells of it."""
        force1, force2 = self.potential.gradient(self.xi1, self.xi2)
        return float(self.weight @ force1**2), float(self.weight @ force2**2)

    def half_widths(self, lost: float) -> tuple[float, float]:
        """Half widths outside which the share `lost` lies, direction by direction."""
        return self._beyond(self.xi1, lost), self._beyond(self.xi2, lost)

    def _beyond(self, places: Array, lost: float) -> float:
        distance = np.abs(places)
        order = np.argsort(distance)[::-1]
        outside = np.cumsum(self.weight[order]) + self.unknown
        first = int(np.searchsorted(outside, lost))
        # The node before still lies inside.
        return float(distance[order[max(first - 1, 0)]])

    def outside(self, half_widths: tuple[float, float]) -> float:
        """Share of the mass outside a box."""
        half1, half2 = half_widths
        beyond = (np.abs(self.xi1) > half1) | (np.abs(self.xi2) > half2)
        return float(self.weight[beyond].sum()) + self.unknown


def gibbs_nodes(potential: Potential) -> GibbsNodes:
    """The nodes that resolve e^{-B}, whatever its wells.

    Raises
    ------
    ValueError
        If e^{-B} is not integrable, or too rough for the quadrature.
    """
    found = potential.resolved_normalisation
    if found.edges is None:
        raise ValueError(
            f"`potential` must confine, got {potential!r}; exp(-B) has no finite "
            "integral."
        )
    rules = rules_for(potential.isotropic)
    r, angle = node_places(found.edges, rules)
    values = node_values(potential.value, found.edges, rules)
    r0, r1, a0, a1 = found.edges.T[:, :, None, None]
    area = (r1 - r0) * (a1 - a0) * r
    area = area * rules[0].weights[:, None] * rules[1].weights
    with np.errstate(under="ignore"):
        weight = area * np.exp(found.lowest - values)
    weight /= weight.sum()
    r, angle = np.broadcast_arrays(r, angle)
    kept = weight > _NEGLIGIBLE
    r, angle, weight = r[kept], angle[kept], weight[kept]
    if potential.isotropic:
        r, angle, weight = _all_around(r, weight)
    return GibbsNodes(
        potential, r * np.cos(angle), r * np.sin(angle), weight,
        found.tail + found.error,
    )  # fmt: skip


def _all_around(r: Array, weight: Array) -> tuple[Array, Array, Array]:
    angles = (np.arange(_N_ANGLES) + 0.5) * (2 * math.pi / _N_ANGLES)
    return (
        np.repeat(r, _N_ANGLES),
        np.tile(angles, r.size),
        np.repeat(weight / _N_ANGLES, _N_ANGLES),
    )
