"""What the likelihood sees of a fibre: its chords and the force on each.

With ξ = η - γ known at the nodes, the turn that the potential
B = (ξ1²/σ1² + ξ2²/σ2²)/2 asks for along a chord is a line integral over the fibre,
∫ -∇B·τ⊥ ds = σ1⁻² ∫ ξ1 dη2 - σ2⁻² ∫ ξ2 dη1, here by the trapezoidal rule between the
nodes. It is linear in (1/σ1², 1/σ2²), and holds the fibre's own chord: a fibre that
winds about inside a step does not enter by its angle, only by where it went.
"""

from __future__ import annotations

import numpy as np

from fpsolve._kernels.chord_filter import Chords
from fpsolve._support.arrays import Array

__all__ = ["chords_of"]


def chords_of(eta: Array, gamma: Array, ds: float) -> Chords:
    """Chords of the nodes η, shape (n + 1, 2), over arclengths ds.

    Parameters
    ----------
    eta, gamma : ndarray, shape (n + 1, 2)
        Fibre and reference curve at the nodes.
    ds : float
        Arclength between nodes.
    """
    chord, moved = np.diff(eta, axis=0), np.diff(gamma, axis=0)
    xi = eta - gamma
    angles = np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))
    middle = 0.5 * (xi[1:] + xi[:-1])
    # sin α, -cos α times the length, and the derivatives of cos α, sin α by α; a chord
    # that turns moves its own end, and half of that the middle.
    bow = np.diff(gamma, 2, axis=0)
    bow = np.concatenate([bow[:1], bow]) + np.concatenate([bow, bow[-1:]])
    deviation = np.diff(xi, axis=0)
    crossed, across = chord[:, ::-1] * (1.0, -1.0), chord[:, ::-1] * (-1.0, 1.0)
    return Chords(
        angles=angles,
        lengths=np.hypot(chord[:, 0], chord[:, 1]),
        forces=(middle + bow / 24) * crossed / ds,
        bending=middle * chord,
        drift=(chord - moved) * crossed / ds,
        slopes=(middle * chord + 0.5 * across * crossed) / ds,
        bending_slopes=middle * across + 0.5 * across * chord,
        drift_slopes=((chord - moved) * chord + across * crossed) / ds,
        areas=np.stack(
            [
                chord[:, 0] * deviation[:, 0] + chord[:, 1] ** 2,
                chord[:, 0] ** 2 + chord[:, 1] * deviation[:, 1],
            ],
            axis=1,
        )
        / ds,
    )
