"""Asymptotic variances −2⟨f, L⁻¹f⟩ for B = |ξ|²/2, by an expansion without sampling.

In the frame of the fibre, X = ξ·τ and Y = ξ·τ⊥ are standard normal and independent
under the equilibrium, and L acts on u(X, Y) e^{imα} as

    L u = ∂_X u − Y R u + (A²/2) R² u,   R = Y ∂_X − X ∂_Y + i m.

Normalised Hermite polynomials in X and Y make this a sparse matrix.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import minimize_scalar
from scipy.sparse.linalg import spsolve

DEGREE = 50


@dataclass(frozen=True)
class Function:
    """Re u(X, Y) e^{imα}."""

    u: Callable[[np.ndarray, np.ndarray], np.ndarray]
    sector: int = 0


FUNCTIONS = {
    "position": Function(lambda x, y: x + 1j * y, 1),
    "square": Function(lambda x, y: x**2 + y**2),
    "core": Function(lambda x, y: np.exp(-(x**2 + y**2) / 2)),
    "direction": Function(
        lambda x, y: np.ones(np.broadcast_shapes(x.shape, y.shape)), 1
    ),
    "circulation": Function(lambda x, y: -y * np.exp(-(x**2 + y**2) / 2)),
}


def asymptotic_variance(f: Function, noise: float, degree: int = DEGREE) -> float:
    """Limit of s times the squared error of averages of f along a path."""
    lower = sparse.diags(np.sqrt(np.arange(1, degree + 1)), 1)
    identity = sparse.eye(degree + 1)
    d_x, d_y = sparse.kron(lower, identity), sparse.kron(identity, lower)
    rotation = d_y.T @ d_x - d_x.T @ d_y + 1j * f.sector * sparse.eye(d_x.shape[0])
    generator = (
        d_x - (d_y + d_y.T) @ rotation + noise**2 / 2 * (rotation @ rotation)
    ).tocsc()
    total = np.add.outer(np.arange(degree + 1), np.arange(degree + 1)).ravel()
    # Constants are the kernel of L, and f − E f has no part in it.
    used = np.flatnonzero((total <= degree) & ((total > 0) | (f.sector != 0)))
    right = coefficients(f, degree)[used]
    solution = spsolve(generator[used][:, used], right)
    share = 1.0 if f.sector == 0 else 0.5
    return float(-2 * share * np.vdot(right, solution).real)


def coefficients(f: Function, degree: int) -> np.ndarray:
    """⟨h_m(X) h_n(Y), u⟩ by Gauss-Hermite quadrature, flattened."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(degree + 40)
    rows = [np.ones_like(nodes), nodes]
    for n in range(2, degree + 1):
        rows.append((nodes * rows[-1] - math.sqrt(n - 1) * rows[-2]) / math.sqrt(n))
    weighted = np.array(rows) * (weights / weights.sum())
    return (weighted @ f.u(nodes[:, None], nodes[None, :]) @ weighted.T).ravel()


def least_noise(f: Function, low: float, high: float) -> float:
    """Noise between `low` and `high` at which the asymptotic variance is least."""
    found = minimize_scalar(
        lambda logarithm: asymptotic_variance(f, math.exp(logarithm)),
        bounds=(math.log(low), math.log(high)),
        method="bounded",
        options={"xatol": 1e-5},
    )
    return float(np.exp(found.x))
