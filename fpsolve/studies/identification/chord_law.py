"""The Gaussian law of a chord: over a step, for a smooth fibre or a basic one.

A smooth fibre between two nodes is the linear equation dα = κ ds,
dκ = (f - κ)/R ds + K dW; R → 0 at fixed A = RK is the basic model. With t = s/h from 0
to 1 along a chord of length h, the force is

    f = F + D (t - ½) + (c/h)(α - ᾱ),

F its mean, which is known but for β∫(t - ½) α dt, the area between fibre and chord.
Without c and β, (κ, α, ᾱ) has factors and a covariance in closed form. With them the
path is the one without and integrals of its own α - ᾱ: to order c² and β.

The angle of a chord is not the mean of α along it but arg ∫ e^{iα} du
= ᾱ - ⟨(α - ᾱ)³⟩/6 + …; nodes along the chord tell the filter what α - ᾱ is, given κ
and F at its start. For R = 0 and F = 0 the variance of that angle is
q/3 + q²/360 + 19 q³/45360 + 31 q⁴/362880 + …, q = A²h.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fpsolve._kernels.chord_filter import ChordLaw
from fpsolve._support.arrays import Array
from fpsolve.paths.smooth_step import phi, smooth_step
from fpsolve.studies.identification.chord_paths import (
    NODES,
    WEIGHTS,
    along_chord,
    grown,
    kicks_along_chord,
    pulls_along_chord,
)

__all__ = ["Parameters", "chord_law"]

# Coefficients of q³ and q⁴, which the third order in α - ᾱ does not give.
_CHORD_SERIES = (19 / 45360, 31 / 362880)


@dataclass(frozen=True)
class Parameters:
    """What a likelihood is a function of.

    Attributes
    ----------
    strength : (float, float)
        (1/σ1², 1/σ2²), of either sign.
    noise : float
        A.
    relaxation_length : float
        R; 0 for the basic model.
    """

    strength: tuple[float, float]
    noise: float
    relaxation_length: float = 0.0


def chord_law(at: Parameters, ds: float, position_error: float = 0.0) -> ChordLaw:
    """Weights and noise of a chord of length `ds`."""
    length = at.relaxation_length
    x = ds / length if length else math.inf
    # E κ² = K²R/2 + E cos²α/σ1² + E sin²α/σ2² - v²/σ1² of a stationary fibre.
    bent = 0.5 * at.noise**2 / length + max(0.0, *at.strength) if length else 0.0
    free, covariance = _free_factors(x, ds), at.noise**2 * _covariance(length, ds)
    paths, pulls = along_chord(x, ds), pulls_along_chord(x, ds)
    among, kicks = kicks_along_chord(x, ds)
    among, kicks = at.noise**2 * among, at.noise**2 * kicks
    wander = np.diagonal(among) - 2 * kicks[2] + covariance[2, 2]
    q = 6 * float(WEIGHTS @ wander)
    bowed = np.outer(free[:, 1], WEIGHTS * (NODES - 0.5))
    first, second, third = pulls[0] @ kicks.T, pulls[1] @ kicks.T, bowed @ kicks.T
    squares = pulls[0] @ among @ pulls[0].T
    factors = np.stack(
        [free, pulls[0] @ paths.T, pulls[1] @ paths.T, bowed @ paths.T], axis=-1
    )
    noise = np.stack(
        [covariance, first + first.T, second + second.T + squares, third + third.T],
        axis=-1,
    )
    centred = paths[:2] - (paths[:2] @ WEIGHTS)[:, None]
    return ChordLaw(
        factors=np.concatenate(
            [factors[:, 0], factors[:, 1:].reshape(6, 4), noise[np.tril_indices(3)]]
        ),
        path=np.concatenate([[WEIGHTS], centred, [wander], kicks, pulls[0]]),
        chord_variance=_CHORD_SERIES[0] * q**3 + _CHORD_SERIES[1] * q**4,
        position_variance=position_error**2,
        curvature_variance=bent,
        strength=at.strength,
        ds=ds,
    )


@lru_cache(maxsize=32)
def _free_factors(x: float, h: float) -> Array:
    """What (κ, α - α₀, ᾱ - α₀) after a chord are for κ = 1, F = 1 and D = 1."""
    p1, p2 = (0.0 if math.isinf(x) else float(phi(k, x)) for k in (1, 2))
    g1, g2, g3, g4 = (float(grown(k, x, 1.0)) for k in range(1, 5))
    return np.array(
        [
            [1 - g1, g1, g2 - g1 / 2],
            [h * p1, h * g2, h * (g3 - g2 / 2)],
            [h * p2, h * g3, h * (g4 - g3 / 2)],
        ]
    )


@lru_cache(maxsize=32)
def _covariance(relaxation_length: float, h: float) -> Array:
    """Covariance of the noise of (κ, α, ᾱ) for A = 1."""
    if not relaxation_length:
        # κ of the basic model is the force.
        unit = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 1 / 2], [0.0, 1 / 2, 1 / 3]])
        return np.asarray(h * unit)
    n11, n21, n22, n31, n32, n33 = smooth_step(relaxation_length, 1.0, h).noise
    root = np.array([[n11, 0.0, 0.0], [n21, n22, 0.0], [n31, n32, n33]])
    return np.asarray(root @ root.T)
