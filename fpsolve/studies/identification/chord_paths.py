"""Angles along a chord: of what is known, of noise, and what forces there do.

α responds to a force after a length τ h by g₁(τ), after a force that lasts by g₂(τ):
gₖ(t) = x tᵏ φₖ(xt), x = h/R, and t^{k-1}/(k-1)! for the basic model, x = ∞. Nothing
here depends on what a likelihood varies most, the noise and the force, and is kept.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.paths.smooth_step import phi

__all__ = [
    "NODES",
    "WEIGHTS",
    "along_chord",
    "grown",
    "kicks_along_chord",
    "pulls_along_chord",
]


def _gauss(n: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss on (0, 1)."""
    t, weights = np.polynomial.legendre.leggauss(n)
    return 0.5 * (1 + t), 0.5 * weights


# Nodes along a chord: paths are polynomials of degree five between them.
_N = 6
NODES, WEIGHTS = _gauss(_N)
_LAGRANGE = np.linalg.inv(np.vander(NODES, increasing=True))
_FACTORIALS = np.array([float(math.factorial(j)) for j in range(_N)])
_CENTRED = np.eye(_N) - WEIGHTS
# Relaxation lengths of which laws are kept: those of a gradient and of a Hessian.
_KEPT = 32
# Those of integrals from the start of a chord to a node.
_INNER, _INNER_WEIGHTS = _gauss(16)


def grown(k: int, x: float, t: ArrayLike) -> Array:
    """gₖ(t) = x tᵏ φₖ(xt)."""
    t = np.asarray(t, dtype=np.float64)
    if math.isinf(x):
        return np.asarray(t ** (k - 1) / math.factorial(k - 1))
    return np.asarray(x * t**k * phi(k, x * t))


@lru_cache(maxsize=_KEPT)
def along_chord(x: float, h: float) -> Array:
    """α at the nodes for κ = 1, F = 1 and D = 1; (3, n)."""
    of_kappa = 0.0 * NODES if math.isinf(x) else NODES * phi(1, x * NODES)
    second, third = grown(2, x, NODES), grown(3, x, NODES)
    return h * np.array([of_kappa, second, third - 0.5 * second])


@lru_cache(maxsize=_KEPT)
def kicks_along_chord(x: float, h: float) -> tuple[Array, Array]:
    """Covariances for A = 1 of the noise of α at the nodes.

    Among each other, (n, n), and with (κ, α, ᾱ) at the end, (3, n).
    """
    w = NODES[:, None] * _INNER
    weights = grown(1, x, w) * NODES[:, None] * _INNER_WEIGHTS
    left = 1 - NODES[:, None] + w
    later = np.maximum(NODES - NODES[:, None], 0.0)[:, :, None] + w[:, None, :]
    among = np.triu((weights[:, None, :] * grown(1, x, later)).sum(axis=2))
    faded = 0.0 * NODES if math.isinf(x) else np.exp(-x * (1 - NODES))
    at_end = [
        0.5 * faded * grown(1, x, NODES) ** 2 / h,
        (weights * grown(1, x, left)).sum(axis=1),
        (weights * grown(2, x, left)).sum(axis=1),
    ]
    return h * (among + np.triu(among, 1).T), h * np.array(at_end)


@lru_cache(maxsize=_KEPT)
def pulls_along_chord(x: float, h: float) -> tuple[Array, Array]:
    """What a force α - ᾱ, times c/h, does to (κ, α, ᾱ) at the end; (3, n) each.

    Weights of α at the nodes, of first and second order in c: of the force of the path,
    and of that of the path which the force has changed.
    """
    grown_to_end = np.array([float(grown(k, x, 1.0)) for k in range(1, _N + 3)])
    # ∫ vʲ g₁(1 - v) dv = j! g_{j+2}(1), and so on: exact for polynomials.
    moments = np.array([_FACTORIALS * grown_to_end[k : k + _N] for k in range(3)])
    moments[0] /= h
    first = moments @ _LAGRANGE @ _CENTRED
    on_path = np.stack(
        [_FACTORIALS[j] * grown(j + 2, x, NODES) for j in range(_N)], axis=1
    )
    return first, first @ on_path @ _LAGRANGE @ _CENTRED
