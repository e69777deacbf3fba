"""The Kalman filter of a fibre of which the angles of its chords are seen.

Chord j runs from node j to node j + 1, at the angle y_j. The state at a node is
(κ, α, m), m the error of the node's position across the chord. Over a chord

    κ ← φ₀ κ + w₁ f + w₂ g + noise,      α ← α + a κ + w₃ f + w₄ g + noise,
    y = α + b κ + w₅ f + w₆ g + noise + (m' - m)/ℓ + noise of the chord,

f the mean of -∇B·τ⊥ over the chord and g its change along it. The force is read off
the chord itself: f and g depend on y, by f' and g'. The density of y given the
chords before has therefore the factor |1 - w₅ f' - w₆ g'| of the change of variables.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.compiling import njit

__all__ = ["ChordLaw", "Chords", "chord_densities"]

# Variance of the first angle of all, about which nothing is known.
_UNKNOWN = 1e5


class Chords(NamedTuple):
    """Chords of one fibre and what the force on them is made of.

    The mean force over a chord is b·`forces`, b = (1/σ1², 1/σ2²); the arrays of two
    columns are multiplied with b in the same way.

    Attributes
    ----------
    angles : ndarray, shape (n,)
        Unwrapped.
    lengths : ndarray, shape (n,)
    forces : ndarray, shape (n, 2)
        Means of -∇B·τ⊥.
    bending : ndarray, shape (n, 2)
        Change of the force along the chord, as a multiple of κ.
    drift : ndarray, shape (n, 2)
        Change of the force along the chord without κ.
    slopes, bending_slopes, drift_slopes : ndarray, shape (n, 2)
        Derivatives of these three with respect to the chord's own angle.
    """

    angles: NDArray[np.float64]
    lengths: NDArray[np.float64]
    forces: NDArray[np.float64]
    bending: NDArray[np.float64]
    drift: NDArray[np.float64]
    slopes: NDArray[np.float64]
    bending_slopes: NDArray[np.float64]
    drift_slopes: NDArray[np.float64]


class ChordLaw(NamedTuple):
    """Weights and noise of a chord; see the module.

    Attributes
    ----------
    kappa : tuple
        Factors of κ in the next κ, in α and in y: φ₀, a, b.
    weights : tuple
        w₁, …, w₆.
    noise : tuple
        Covariance of the noise of (κ, α, y), lower triangle row by row.
    chord_variance : float
        Variance by which the chord's angle differs from the mean angle.
    position_variance : float
        Of the error of a node, in each direction.
    curvature_variance : float
        Of κ at the first node.
    strength : tuple
        b = (1/σ1², 1/σ2²).
    """

    kappa: tuple[float, float, float]
    weights: tuple[float, float, float, float, float, float]
    noise: tuple[float, float, float, float, float, float]
    chord_variance: float
    position_variance: float
    curvature_variance: float
    strength: tuple[float, float]


@njit(cache=True, error_model="numpy")
def joint_covariance(P, law, length, out):
    """Covariance of (κ, α, m', y) after a chord, from P of (κ, α, m) before it.

    P (3, 3), out (4, 4), both symmetric.
    """
    c0, c1, c2 = law.kappa
    # Covariances of κ, α and m with what becomes of α and of y.
    of_kappa = P[0, 1] + c1 * P[0, 0], P[0, 1] + c2 * P[0, 0] - P[0, 2] / length
    of_alpha = P[1, 1] + c1 * P[1, 0], P[1, 1] + c2 * P[1, 0] - P[1, 2] / length
    of_error = P[2, 1] + c2 * P[2, 0] - P[2, 2] / length
    out[0, 0] = c0 * c0 * P[0, 0]
    out[1, 0] = c0 * of_kappa[0]
    out[1, 1] = of_alpha[0] + c1 * of_kappa[0]
    out[2, 0] = out[2, 1] = out[2, 2] = 0.0
    out[3, 0] = c0 * of_kappa[1]
    out[3, 1] = of_alpha[1] + c1 * of_kappa[1]
    out[3, 2] = 0.0
    out[3, 3] = of_alpha[1] + c2 * of_kappa[1] - of_error / length
    n11, n21, n22, n31, n32, n33 = law.noise
    p = law.position_variance
    out[0, 0] += n11
    out[1, 0] += n21
    out[1, 1] += n22
    out[2, 2] += p
    out[3, 0] += n31
    out[3, 1] += n32
    out[3, 2] += p / length
    out[3, 3] += n33 + law.chord_variance + p / length**2
    for i in range(4):
        for j in range(i):
            out[j, i] = out[i, j]


@njit(cache=True, error_model="numpy")
def turn_error(cosine, position_variance, mean, P):
    """The error of a node across the next chord, which is turned against the last."""
    mean[2] *= cosine
    for i in range(3):
        P[2, i] *= cosine
        P[i, 2] *= cosine
    P[2, 2] += (1.0 - cosine * cosine) * position_variance


@njit(cache=True, error_model="numpy")
def chord_densities(chords, law, out):
    """out[0] = innovations in standard deviations, out[1] = ln p(y_j | y_0 … y_{j-1}).

    chords Chords of n chords; law ChordLaw; out (2, n). The first chord, before which
    nothing is known, has 0 in both.
    """
    angles, lengths = chords.angles, chords.lengths
    b1, b2 = law.strength
    w1, w2, w3, w4, w5, w6 = law.weights
    faded, turned, ahead = law.kappa
    mean, P, joint = np.zeros(3), np.zeros((3, 3)), np.zeros((4, 4))
    mean[1] = angles[0]
    P[0, 0], P[1, 1], P[2, 2] = law.curvature_variance, _UNKNOWN, law.position_variance
    for j in range(angles.shape[0]):
        f = b1 * chords.forces[j, 0] + b2 * chords.forces[j, 1]
        g = b1 * (chords.bending[j, 0] * mean[0] + chords.drift[j, 0])
        g += b2 * (chords.bending[j, 1] * mean[0] + chords.drift[j, 1])
        joint_covariance(P, law, lengths[j], joint)
        spread = joint[3, 3]
        seen = mean[1] + ahead * mean[0] - mean[2] / lengths[j] + w5 * f + w6 * g
        innovation = angles[j] - seen
        # What the errors of both nodes do to the angle is no force.
        own = 1.0 - (P[2, 2] + law.position_variance) / (lengths[j] ** 2 * spread)
        df = b1 * chords.slopes[j, 0] + b2 * chords.slopes[j, 1]
        dg = b1 * (chords.bending_slopes[j, 0] * mean[0] + chords.drift_slopes[j, 0])
        dg += b2 * (chords.bending_slopes[j, 1] * mean[0] + chords.drift_slopes[j, 1])
        out[0, j] = innovation / np.sqrt(spread)
        out[1, j] = -0.5 * (np.log(2 * np.pi * spread) + innovation**2 / spread)
        out[1, j] += own * np.log(abs(1.0 - w5 * df - w6 * dg))
        ratio = innovation / spread
        moved = mean[1] + turned * mean[0] + w3 * f + w4 * g
        mean[0] = faded * mean[0] + w1 * f + w2 * g + joint[0, 3] * ratio
        mean[1] = moved + joint[1, 3] * ratio
        mean[2] = joint[2, 3] * ratio
        for i in range(3):
            for k in range(3):
                P[i, k] = joint[i, k] - joint[i, 3] * joint[k, 3] / spread
        if j + 1 < angles.shape[0]:
            cosine = np.cos(angles[j + 1] - angles[j])
            turn_error(cosine, law.position_variance, mean, P)
    out[0, 0] = out[1, 0] = 0.0
