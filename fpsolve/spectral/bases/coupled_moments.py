"""Integrals of a density in the frame of a smooth fibre against observables."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.smooth_sums import SMOOTH_MOMENTS
from fpsolve.spectral.bases.coupled_states import CoupledStates
from fpsolve.spectral.bases.placement import Placement

__all__ = ["coupled_moments", "coupled_one", "mean_cos2_alpha"]

# Degrees of the observables: squares.
HIGHEST = 2


def coupled_moments(
    states: CoupledStates, vector: Array, placement: Placement
) -> dict[str, float]:
    """∫ p, and E ξ, the covariance of ξ, E cos α, E sin α, E κ and E κ².

    Of a density that is even under (ξ2, α, κ) → -(ξ2, α, κ): what is odd vanishes. The
    density need not have mass one.

    An observable f is no member of the basis, whose functions decay, but has
    coefficients ∫ f q in it for every density q of the dual basis. Those of 1 follow
    from ∂_w 1 = 0 and ∂_κ 1 = 0, term by term; w times f and κ times f from them.
    """
    one = _Observables(states, placement)
    flat, kappa2 = one.curvature(0), one.curvature(2)
    mass = one.integral(vector, {0: one.plane()}, flat)
    integrals = {
        "x1": one.integral(vector, {1: math.sqrt(0.5) * one.plane(w=1)}, flat),
        "square": one.integral(vector, {0: 2.0 * one.plane(w=1, bar=1)}, flat),
        "turned": one.integral(vector, {2: one.plane(w=2)}, flat),
        "cos": one.integral(vector, {1: 0.5 * one.plane()}, flat),
        "kappa2": one.integral(vector, {0: one.plane()}, kappa2),
    }
    mean = {name: value / mass for name, value in integrals.items()}
    width1, width2 = placement.widths
    # For z = x1 + i x2: x1² and x2² are (|z|² ± Re z²)/2.
    square1 = 0.5 * (mean["square"] + mean["turned"])
    square2 = 0.5 * (mean["square"] - mean["turned"])
    values = {
        "mean_xi1": placement.centre + width1 * mean["x1"],
        "variance_xi1": width1**2 * (square1 - mean["x1"] ** 2),
        "variance_xi2": width2**2 * square2,
        "mean_cos_alpha": mean["cos"],
        "mean_kappa2": mean["kappa2"],
    }
    moments = {name: float(values.get(name, 0.0)) + 0.0 for name in SMOOTH_MOMENTS}
    return {"mass": mass, **moments}


def mean_cos2_alpha(
    states: CoupledStates, vector: Array, placement: Placement
) -> float:
    """E cos²α, which the exact E κ² needs."""
    one = _Observables(states, placement)
    flat, plane = one.curvature(0), one.plane()
    square = one.integral(vector, {0: 0.5 * plane, 2: 0.25 * plane}, flat)
    return square / one.integral(vector, {0: plane}, flat)


def coupled_one(states: CoupledStates, placement: Placement) -> Array:
    """Coefficients of 1, even and of M = 0: those pair with p to ∫ p."""
    one, plain = _Observables(states, placement), states.plain
    values = one.plane()[plain.m, plain.n] * one.curvature(0)[plain.j]
    result = np.zeros(states.size)
    result[: states.offsets[1]] = states.folding.T @ values
    return result


class _Observables:
    """Coefficients of polynomials in w, w̄ and κ in the basis of observables."""

    def __init__(self, states: CoupledStates, placement: Placement) -> None:
        self.states, self.placement = states, placement

    def plane(self, w: int = 0, bar: int = 0) -> Array:
        """Of wᵐ w̄ⁿ, indexed [n_a, n_b]."""
        theta, degree = self.placement.exponent, self.states.plain.degree
        size = degree + HIGHEST + 2
        table = np.diag(((1 - theta) / theta) ** np.arange(size) / theta)
        for _ in range(w):
            table = multiplied(table)
        for _ in range(bar):
            table = multiplied(table.T).T
        return table[: degree + 1, : degree + 1]

    def curvature(self, power: int) -> Array:
        """Of a power of κ, in the real basis e_j = iʲ he_j: even powers only."""
        weight, last = self.placement.curvature, self.states.plain.curvature
        theta = weight.exponent
        t = np.zeros(last + HIGHEST + 3)
        t[0] = 1 / math.sqrt(theta)
        for j in range(1, t.size - 1, 2):
            t[j + 1] = (1 - theta) / theta * math.sqrt(j / (j + 1)) * t[j - 1]
        root = np.sqrt(np.arange(1.0, t.size))
        for _ in range(power):
            t = np.append(root * t[1:], 0.0) + np.insert(root * t[:-1], 0, 0.0)
            t *= math.sqrt(weight.variance)
        # i⁻ʲ of even j.
        phases = np.cos(0.5 * math.pi * np.arange(last + 1)).round()
        return np.asarray(t[: last + 1] * phases)

    def integral(self, vector: Array, planes: dict[int, Array], kappa: Array) -> float:
        """∫ f p for f = Σ_M e^{iMα} plane_M times kappa, and its conjugate part."""
        total, plain = 0.0, self.states.plain
        for index, part in self.states.slices():
            if index not in planes:
                continue
            values = planes[index][plain.m, plain.n] * kappa[plain.j]
            if index == 0:
                total += float((self.states.folding.T @ values) @ vector[part])
            else:
                total += math.sqrt(2.0) * float(values @ vector[part])
        return total


def multiplied(table: Array) -> Array:
    """w = a† + b on coefficients [n_a, n_b]; the last row and column are lost."""
    root = np.sqrt(np.arange(1.0, table.shape[0]))
    result = np.zeros_like(table)
    result[1:] = root[:, None] * table[:-1]
    result[:, :-1] += root * table[:, 1:]
    return result
