"""The Kalman filter of a fibre of which the angles of its chords are seen.

Chord j runs from node j to node j + 1, at the angle y_j. The state at a node is
(κ, α, m), m the error of the node's position across the chord. Over a chord

    κ ← k₀ κ + w₁ F + w₂ D + noise,      α ← α + k₁ κ + w₃ F + w₄ D + noise,
    y = α + k₂ κ + w₅ F + w₆ D + (m' - m)/ℓ + noise,

F the mean of -∇B·τ⊥ over the chord and D its change as the chord moves. The force also
changes by c for every angle that the fibre turns off its chord, and its line integral
by β times the area between both: factors and covariances are polynomials in c and β.

The force is read off the chord itself: F, D and c depend on y, and the density of y
given the chords before has the factor |1 - ∂ŷ/∂y| of the change of variables. What has
no such factor, covariances and what is of second order in the noise, is taken at the
angle that was predicted, for what depends on the noise of y itself would be biased.
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
        Change of the force times Δs for every angle that the fibre turns: c.
    drift : ndarray, shape (n, 2)
        Change of the force along the chord if the fibre does not turn.
    slopes, bending_slopes, drift_slopes : ndarray, shape (n, 2)
        Derivatives of these three with respect to the chord's own angle.
    areas : ndarray, shape (n, 2)
        What multiplies ∫(t - ½) α dt of the fibre in its mean force: β.
    """

    angles: NDArray[np.float64]
    lengths: NDArray[np.float64]
    forces: NDArray[np.float64]
    bending: NDArray[np.float64]
    drift: NDArray[np.float64]
    slopes: NDArray[np.float64]
    bending_slopes: NDArray[np.float64]
    drift_slopes: NDArray[np.float64]
    areas: NDArray[np.float64]


class ChordLaw(NamedTuple):
    """Weights and noise of a chord; see the module.

    Attributes
    ----------
    factors : ndarray, shape (15, 4)
        k₀, k₁, k₂; w₁, …, w₆; the covariance of the noise of (κ, α, y), lower triangle
        row by row: coefficients of 1, c, c² and β.
    path : ndarray, shape (10, n)
        At nodes along the chord: weights; angles for κ = 1 and for F = 1, variance of
        α by noise, all from their means; covariances of that noise with (κ, α, y) at
        the end; weights by which a force there acts on (κ, α, y).
    chord_variance : float
        Variance by which the chord's angle differs from the mean angle, beyond what
        the nodes tell.
    position_variance : float
        Of the error of a node, in each direction.
    curvature_variance : float
        Of κ at the first node.
    strength : tuple
        b = (1/σ1², 1/σ2²).
    ds : float
    """

    factors: NDArray[np.float64]
    path: NDArray[np.float64]
    chord_variance: float
    position_variance: float
    curvature_variance: float
    strength: tuple[float, float]
    ds: float


@njit(cache=True, error_model="numpy")
def set_factors(factors, c, beta, out):
    """Factors and covariances at c and β."""
    for i in range(15):
        out[i] = factors[i, 0] + c * (factors[i, 1] + c * factors[i, 2])
        out[i] += beta * factors[i, 3]


@njit(cache=True, error_model="numpy")
def own_slope(now, factors, chords, at, j):
    """∂ŷ/∂y of chord j for F, D and c that move with y.

    at (b, κ, F, D, c).
    """
    b1, b2, kappa, f, g, c = at
    dc = b1 * chords.bending_slopes[j, 0] + b2 * chords.bending_slopes[j, 1]
    df = b1 * chords.slopes[j, 0] + b2 * chords.slopes[j, 1]
    dg = b1 * chords.drift_slopes[j, 0] + b2 * chords.drift_slopes[j, 1]
    turned = kappa * (factors[2, 1] + 2.0 * c * factors[2, 2])
    turned += f * (factors[7, 1] + 2.0 * c * factors[7, 2])
    turned += g * (factors[8, 1] + 2.0 * c * factors[8, 2])
    return now[7] * df + now[8] * dg + turned * dc


@njit(cache=True, error_model="numpy")
def bend_chord(path, kappa, force, variance, now):
    """What the bend of a fibre does to the angle of its chord, to third order.

    The angle is ᾱ - ⟨β³⟩/6, β = α - ᾱ with the mean d and the variance V along the
    chord. Its mean is ᾱ - ⟨d³ + 3 d V⟩/6, which is returned, and its derivative by β is
    1 - (d² + V)/2, which changes the factors `now` of y. variance: that of κ.
    """
    mean_square = 0.0
    for k in range(path.shape[1]):
        d = path[1, k] * kappa + path[2, k] * force
        mean_square += path[0, k] * (d * d + variance * path[1, k] ** 2 + path[3, k])
    shift = 0.0
    for k in range(path.shape[1]):
        d = path[1, k] * kappa + path[2, k] * force
        V = variance * path[1, k] ** 2 + path[3, k]
        shift -= path[0, k] * d * (d * d / 6.0 + V / 2.0)
        weight = -0.5 * path[0, k] * (d * d + V - mean_square)
        now[2] += weight * path[1, k]
        now[12] += weight * path[4, k]
        now[13] += weight * path[5, k]
        now[14] += 2.0 * weight * path[6, k]
    return shift


@njit(cache=True, error_model="numpy")
def bend_force(path, of_kappa, variance, out):
    """What noise along the chord makes of a force that is a sine of the angle.

    f(ᾱ + β) = f + f'(ᾱ) β - f β²/2, and ᾱ and β are correlated: means of what acts on
    (κ, α, y) for f = -1/Δs. of_kappa: covariance of κ and y; variance: that of κ.
    """
    out[0] = out[1] = out[2] = 0.0
    for k in range(path.shape[1]):
        p = path[1, k]
        both = path[6, k] + p * of_kappa + 0.5 * (path[3, k] + variance * p * p)
        for i in range(3):
            out[i] += path[7 + i, k] * both


@njit(cache=True, error_model="numpy")
def joint_covariance(P, now, law, length, out):
    """Covariance of (κ, α, m', y) after a chord, from P of (κ, α, m) before it.

    P (3, 3), out (4, 4), both symmetric; now as `set_factors` leaves it.
    """
    c0, c1, c2 = now[0], now[1], now[2]
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
    p = law.position_variance
    out[0, 0] += now[9]
    out[1, 0] += now[10]
    out[1, 1] += now[11]
    out[2, 2] += p
    out[3, 0] += now[12]
    out[3, 1] += now[13]
    out[3, 2] += p / length
    out[3, 3] += now[14] + law.chord_variance + p / length**2
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
def predict_chord(chords, law, j, mean, P, now, ahead):
    """Prediction of chord j: `now` the factors, ahead (κ, α, y) after it.

    mean, P of the state before it. Returns ∂ŷ/∂y.
    """
    b1, b2 = law.strength
    c = b1 * chords.bending[j, 0] + b2 * chords.bending[j, 1]
    beta = b1 * chords.areas[j, 0] + b2 * chords.areas[j, 1]
    f = b1 * chords.forces[j, 0] + b2 * chords.forces[j, 1]
    g = b1 * chords.drift[j, 0] + b2 * chords.drift[j, 1]
    length = chords.lengths[j]
    set_factors(law.factors, c, beta, now)
    slope = own_slope(now, law.factors, chords, (b1, b2, mean[0], f, g, c), j)
    ahead[0] = now[0] * mean[0] + now[3] * f + now[4] * g
    ahead[1] = mean[1] + now[1] * mean[0] + now[5] * f + now[6] * g
    ahead[2] = mean[1] + now[2] * mean[0] + now[7] * f + now[8] * g - mean[2] / length
    # The angle that is expected, and F and c there: what follows does not know y.
    back = (ahead[2] - chords.angles[j]) / (1.0 - slope) if j > 0 else 0.0
    sine, cosine = np.sin(back), np.cos(back)
    expected = cosine * f + sine * c / law.ds
    of_kappa = P[0, 1] + now[2] * P[0, 0] - P[0, 2] / length
    if j > 0:
        shifts = np.empty(3)
        bend_force(law.path, of_kappa, P[0, 0], shifts)
        for i in range(3):
            ahead[i] -= law.ds * expected * shifts[i]
    # E c(ᾱ)(ᾱ - E ᾱ)² = c exp(-3V/2) V to second order.
    V = P[1, 1] + now[2] * (P[0, 1] + of_kappa) + now[14]
    fading = np.exp(-1.5 * V) if j > 0 else 0.0
    c = fading * (cosine * c - sine * law.ds * f)
    set_factors(law.factors, c, beta, now)
    if j > 0:
        ahead[2] += bend_chord(law.path, mean[0], expected, P[0, 0], now)
    return slope


@njit(cache=True, error_model="numpy")
def chord_densities(chords, law, out):
    """out[0] = innovations in standard deviations, out[1] = ln p(y_j | y_0 … y_{j-1}).

    chords Chords of n chords; law ChordLaw; out (2, n). The first chord, before which
    nothing is known, has 0 in both.
    """
    angles, lengths = chords.angles, chords.lengths
    mean, P, joint = np.zeros(3), np.zeros((3, 3)), np.zeros((4, 4))
    now, ahead = np.empty(15), np.empty(3)
    mean[1] = angles[0]
    P[0, 0], P[1, 1], P[2, 2] = law.curvature_variance, _UNKNOWN, law.position_variance
    for j in range(angles.shape[0]):
        slope = predict_chord(chords, law, j, mean, P, now, ahead)
        joint_covariance(P, now, law, lengths[j], joint)
        spread = joint[3, 3]
        innovation = angles[j] - ahead[2]
        # What the errors of both nodes do to the angle is no force.
        own = 1.0 - (P[2, 2] + law.position_variance) / (lengths[j] ** 2 * spread)
        out[0, j] = innovation / np.sqrt(spread)
        out[1, j] = -0.5 * (np.log(2 * np.pi * spread) + innovation**2 / spread)
        out[1, j] += own * np.log(abs(1.0 - slope))
        ratio = innovation / spread
        mean[0] = ahead[0] + joint[0, 3] * ratio
        mean[1] = ahead[1] + joint[1, 3] * ratio
        mean[2] = joint[2, 3] * ratio
        for i in range(3):
            for k in range(3):
                P[i, k] = joint[i, k] - joint[i, 3] * joint[k, 3] / spread
        if j + 1 < angles.shape[0]:
            cosine = np.cos(angles[j + 1] - angles[j])
            turn_error(cosine, law.position_variance, mean, P)
    out[0, 0] = out[1, 0] = 0.0
