"""Drag of the air on pieces of a thin cylinder, and its slope in the velocity."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.compiling import njit

__all__ = [
    "CREEPING",
    "FAST",
    "OSEEN",
    "Drag",
    "drag_slopes",
    "many_resistances",
    "oseen",
    "oseen_slopes",
    "pull_chain",
    "shaking",
]

# Reynolds numbers up to which Oseen's expansion holds, and from which the boundary
# layer decides.
CREEPING, FAST = 0.1, 100.0
# ½ − γ + ln 8, as [MW11]_ gives it.
OSEEN = 2.0022
# Squares of speeds are divided by, of air at rest too.
SMALLEST = 1e-300


class Drag(NamedTuple):
    """f = ρν (r_n(w) v_n + r_τ(w) v_τ), w = (d/ν)|v_n|.

    Attributes
    ----------
    between : ndarray, shape (2, 4)
        Of ln c_n and ln c_τ in powers of ln w, between both ends.
    joined : float
        w₀ below which a cubic leads to Stokes's limit.
    joint : ndarray, shape (2, 3)
        Values at w₀, at 0, and slopes at w₀, of r_n and r_τ.
    reynolds : float
        d/ν.
    scale : float
        ρν.
    """

    between: NDArray[np.float64]
    joined: float
    joint: NDArray[np.float64]
    reynolds: float
    scale: float


@njit(cache=True, error_model="numpy")
def oseen(w):
    """(w c_n, w c_τ) of the creeping flow."""
    s = OSEEN - np.log(w)
    twice = 2 * s - 1
    normal = 4 * np.pi / s * (1 - w**2 * (s**2 - s / 2 + 5 / 16) / (32 * s))
    along = 1 - w**2 * (2 * s**2 - 2 * s + 1) / (16 * twice)
    return normal, 4 * np.pi / twice * along


@njit(cache=True, error_model="numpy", forceinline=True)
def _resistances(w, between, joined, joint):
    """(w c_n, w c_τ) for w ≥ 0; see `Drag`."""
    if w < joined:
        x = w / joined
        for_normal, for_along = joint
        return _rising(x, for_normal, joined), _rising(x, for_along, joined)
    if w < CREEPING:
        return oseen(w)
    if w > FAST:
        root = 2 * np.sqrt(w)
        return root + 0.5 * w, root
    x = np.log(w)
    normal, along = between
    return (
        w * np.exp(normal[0] + x * (normal[1] + x * (normal[2] + x * normal[3]))),
        w * np.exp(along[0] + x * (along[1] + x * (along[2] + x * along[3]))),
    )


@njit(cache=True, error_model="numpy")
def _rising(x, values, joined):
    """The cubic from Stokes's limit, where it has no slope, to the joint at x = 1."""
    end, start, slope = values
    rise, last = end - start, slope * joined
    return start + x**2 * (3 * rise - last + x * (last - 2 * rise))


@njit(cache=True, error_model="numpy")
def many_resistances(w, between, joined, joint, out):
    """(w c_n, w c_τ) for w ≥ 0 (n,), out (2, n); see `Drag`."""
    for i in range(w.size):
        out[0, i], out[1, i] = _resistances(w[i], between, joined, joint)


@njit(cache=True, error_model="numpy")
def oseen_slopes(w):
    """d/dw of `oseen`, of its exact derivative."""
    s = OSEEN - np.log(w)
    twice, square = 2 * s - 1, 2 * s**2 - 2 * s + 1
    # Of r = a(S) − w² b(S), dS/dw = −1/w.
    normal = 4 / (w * s**2) - w / 4 * (s**2 - s / 2 + 5 / 16) / s**2
    normal += w / 8 * (1 / (2 * s**2) - 5 / (8 * s**3))
    along = 8 / (w * twice**2) - w / 2 * square / twice**2
    along += w / 4 * ((4 * s - 2) / twice**2 - 4 * square / twice**3)
    return np.pi * normal, np.pi * along


@njit(cache=True, error_model="numpy", forceinline=True)
def _resistances_and_rises(w, between, joined, joint):
    """(r_n, w ∂_w r_n), (r_τ, w ∂_w r_τ) for w ≥ 0; see `Drag`."""
    normal, along = _resistances(w, between, joined, joint)
    if w < joined:
        x = w / joined
        return (
            (normal, _rise(x, joint[0], joined)), (along, _rise(x, joint[1], joined))
        )  # fmt: skip
    if w < CREEPING:
        steep, less_steep = oseen_slopes(w)
        return (normal, w * steep), (along, w * less_steep)
    if w > FAST:
        return (normal, 0.5 * (along + w)), (along, 0.5 * along)
    x, one, other = np.log(w), between[0], between[1]
    return (
        (normal, normal * (1 + one[1] + x * (2 * one[2] + 3 * x * one[3]))),
        (along, along * (1 + other[1] + x * (2 * other[2] + 3 * x * other[3]))),
    )


@njit(cache=True, error_model="numpy")
def _rise(x, values, joined):
    """x ∂_x of `_rising`."""
    end, start, slope = values
    rise, last = end - start, slope * joined
    return x**2 * (2 * (3 * rise - last) + 3 * x * (last - 2 * rise))


@njit(cache=True, error_model="numpy", forceinline=True)
def _pull(drag, v, tangent, force, slope):
    """Force per length and −∂f/∂v of one place; the arguments are rows."""
    moving = v[0] * tangent[0] + v[1] * tangent[1] + v[2] * tangent[2]
    square = 0.0
    for c in range(3):
        across = v[c] - moving * tangent[c]
        square += across * across
    w = drag.reynolds * np.sqrt(square)
    (r_n, risen), (r_t, followed) = _resistances_and_rises(
        w, drag.between, drag.joined, drag.joint
    )
    # Resistances grow with the speed across: ∂w/∂v = w v_n/|v_n|².
    steep = 1.0 / max(square, SMALLEST)
    for c in range(3):
        along = moving * tangent[c]
        across = v[c] - along
        force[c] = drag.scale * (r_n * across + r_t * along)
        grown = steep * (risen * across + followed * along)
        for d in range(3):
            found = (r_t - r_n) * tangent[c] * tangent[d]
            if c == d:
                found += r_n
            found += grown * (v[d] - moving * tangent[d])
            slope[c, d] = drag.scale * found


@njit(cache=True, error_model="numpy")
def drag_slopes(drag, velocity, tangent, force, slope):
    """f and ∂f/∂v for velocities of the air past the fibre, (n, 3) and (n, 3, 3)."""
    for i in range(velocity.shape[0]):
        _pull(drag, velocity[i], tangent[i], force[i], slope[i])


@njit(cache=True, error_model="numpy")
def shaking(drag, velocity, tangent, strengths, out):
    """L D (n, 3, 3): L = ∂f/∂v, and D of three strengths (3, n) of fluctuations.

    These are along the fibre, along the velocity across it, and along the normal of
    both; of air that does not pass the last holds for both directions across.
    """
    force, slope, drawn = np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    for i in range(velocity.shape[0]):
        v, t = velocity[i], tangent[i]
        _pull(drag, v, t, force, slope)
        moving = v[0] * t[0] + v[1] * t[1] + v[2] * t[2]
        square = 0.0
        for c in range(3):
            square += (v[c] - moving * t[c]) ** 2
        normal = strengths[2, i]
        along = strengths[0, i] - normal
        flow = (strengths[1, i] - normal) / max(square, SMALLEST)
        for c in range(3):
            for d in range(3):
                across = (v[c] - moving * t[c]) * (v[d] - moving * t[d])
                drawn[c, d] = along * t[c] * t[d] + flow * across
            drawn[c, c] += normal
        for c in range(3):
            for d in range(3):
                out[i, c, d] = (
                    slope[c, 0] * drawn[0, d] + slope[c, 1] * drawn[1, d]
                ) + slope[c, 2] * drawn[2, d]


@njit(cache=True, error_model="numpy")
def pull_chain(drag, middle, rate, wind, lengths, force, slope):
    """Force on every node of a chain, and its slope in the velocity of the node.

    middle, rate, wind (n + 1, 3) positions, velocities, and those of the air; lengths
    (n + 1,) of the fibre at every node.
    """
    last = middle.shape[0] - 1
    tangent, relative = np.empty(3), np.empty(3)
    for i in range(last + 1):
        # Of half of both neighbours; an end has one.
        before, after = max(i - 1, 0), min(i + 1, last)
        square = 0.0
        for c in range(3):
            tangent[c] = middle[after, c] - middle[before, c]
            square += tangent[c] * tangent[c]
            relative[c] = wind[i, c] - rate[i, c]
        size = np.sqrt(square)
        for c in range(3):
            tangent[c] /= size
        _pull(drag, relative, tangent, force[i], slope[i])
        for c in range(3):
            force[i, c] *= lengths[i]
            for d in range(3):
                slope[i, c, d] *= lengths[i]
