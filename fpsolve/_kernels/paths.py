"""Steps of many paths at once: random numbers, forces, integrators of both models.

Paths are taken in blocks of `LANES`. The numbers of a block lie in one flat work
array `w`, each quantity in a row of its own, so that the compiler sees that no two
loops overlap and turns every loop into vector instructions. Random numbers lie in an
array of their own, for a row whose number is not known beforehand could be any of `w`.
A block is always worked through as a whole, its unused lanes too: a path is then
bitwise the same whatever its neighbours are.

A step of length h of a smooth path starts at (ξ, α, κ) and takes the force at the point
that half a step along the tangent leads to. Without it, (κ, α, ∫α) at the end of the
step are Gaussian with a covariance in closed form; their noise is drawn together. Then

    ⟨τ⟩* = exp(-V/2h) τ(ᾱ*), with the mean angle ᾱ* of the step without force,
    ⟨τ⟩ = ⟨τ⟩* turned as far as -∇B·⟨τ⊥⟩* turns the mean angle,
    f = -∇B·τ⊥(α) and f̄ = -∇B·⟨τ⊥⟩, the drift at the start and in the mean,

and κ and α end where a drift leads them that changes linearly, from f, with the mean f̄;
ξ moves by h⟨τ⟩. Here V is what is expected of ∫ (α(u) - ᾱ)² du. Noise and force act
through the same mean tangent: for R → 0 the stationary law is kept to leading order in
the force for A²h of any size.
"""

import math
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numba import prange

from fpsolve._kernels.bits import bits_of, number_of
from fpsolve._kernels.compiling import njit

LANES = 64
# Rows of the work array: position, tangent, full turns of the angle.
XI1, XI2, COSINE, SINE, TURNS = (LANES * row for row in range(5))
ANGLE, FORCE1, FORCE2 = (LANES * row for row in range(5, 8))
KEPT1, KEPT2, KEPT3, KEPT4, KEPT5 = (LANES * row for row in range(8, 13))
# Weights of what the nozzle of a path moves otherwise than γ.
WEIGHT1, WEIGHT2 = 13 * LANES, 14 * LANES
N_ROWS = 15
N_STATE = 5
# Further rows for smooth paths: the curvature, noise of κ, of α and of ᾱ.
KAPPA, NOISE1, NOISE2, NOISE3 = (LANES * row for row in range(15, 19))
N_SMOOTH_ROWS = N_ROWS + 4
N_SMOOTH_STATE = N_STATE + 1
# Steps served by one group of random numbers, and normal numbers of a smooth step.
N_STEPS, N_NUMBERS = 4, 3
# Powers 0 to 4 of each component of ξ, and their products of at most that degree.
N_POWERS, N_PRODUCTS = 5, 15

FREE, QUADRATIC, LINEAR, EVEN_POWER, POWER = range(5)
SPLITTING, EULER_MARUYAMA, HEUN = range(3)

MASK = 0xFFFFFFFF
MULTIPLIER0, MULTIPLIER1 = 0xD2511F53, 0xCD9E8D57
WEYL0, WEYL1 = 0x9E3779B9, 0xBB67AE85
UNIT = 2.0**-32
# Bits of sqrt(1/2), and where the exponent of a double begins.
ROOT_HALF, EXPONENT = 0x3FE6A09E667F3BCD, 52
# A whole number below 2³² in the last bits of 2⁵² makes 2⁵² more of it; one of either
# sign, added to the bits of 3·2⁵¹, makes 3·2⁵¹ more of it.
WHOLE, SIGNED_WHOLE = 2.0**52, 1.5 * 2.0**52
BITS_OF_WHOLE, BITS_OF_SIGNED_WHOLE = 0x4330000000000000, 0x4338000000000000
LN2, TURN, QUARTER_TURN = math.log(2.0), 2.0 * math.pi, 0.5 * math.pi
# tanh(16) is one to 3e-14; beyond, the force is cut to this without effect.
FARTHEST = 16.0
# e^{-x} is more than this part of cosh x up to twice `FARTHEST`.
LEAST = 1e-28
# Below this distance the direction of a force ξ/|ξ| fades out; |ξ|² must not underflow.
NEAREST = 1e-150


class Noise(NamedTuple):
    """Numbers of the first path and of the first step, which count; key; A √ds."""

    path: int
    step: int
    key: tuple[int, int]
    scale: float


class Shifts(NamedTuple):
    """Displacements of γ, and of what every nozzle adds to it.

    Attributes
    ----------
    common : ndarray, shape (n_steps, 2, 2)
        γ over the first and second half of every step.
    own : ndarray, shape (n_steps, 2, 2, 2)
        Two motions over the same halves, on the last axis.
    weights : ndarray, shape (2, n_paths) or (2, 0)
        By which each path multiplies and adds them; none where all move as γ.
    """

    common: Any
    own: Any
    weights: Any


class SmoothStep(NamedTuple):
    """What a step of the smooth model multiplies with.

    Attributes
    ----------
    ds : float
    weights : tuple
        Of κ, f and Δ in κ(h), of κ, f and Δ in α(h) - α, and of κ and f in the mean
        angle of the step; Δ is the change of f over the step.
    noise : tuple
        The lower triangle, row by row, that makes the noise of κ, of α and of the mean
        angle of three standard normal numbers.
    spread : (float, float)
        Half the mean of (α(u) - ᾱ)² over the step: by noise, and by κ, as a multiple
        of κ².
    """

    ds: float
    weights: tuple[float, ...]
    noise: tuple[float, ...]
    spread: tuple[float, float]


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def philox_round(c0, c1, c2, c3, k0, k1):
    """One round of Philox: two 32 by 32 bit products, crossed and mixed with keys."""
    p0 = MULTIPLIER0 * c0
    p1 = MULTIPLIER1 * c2
    high0, high1 = (p0 >> 32) & MASK, (p1 >> 32) & MASK
    return high1 ^ c1 ^ k0, p1 & MASK, high0 ^ c3 ^ k1, p0 & MASK


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def philox(c0, c1, c2, c3, k0, k1):
    """Philox 4x32-10: four random 32-bit words of a counter under a key.

    The rounds are written out: a loop would keep the one over lanes from being
    turned into vector instructions.
    """
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    c0, c1, c2, c3 = philox_round(c0, c1, c2, c3, k0, k1)
    k0, k1 = (k0 + WEYL0) & MASK, (k1 + WEYL1) & MASK
    return philox_round(c0, c1, c2, c3, k0, k1)


def _near_best(term, degree, end):
    """Coefficients of the polynomial through Σ term(k) yᵏ at Chebyshev points.

    On [0, end] it comes within a small factor of the best one. Divided differences in
    rational numbers: only the coefficients are rounded.
    """
    turns = [(2 * i + 1) / (4 * degree + 4) for i in range(degree + 1)]
    nodes = [
        Fraction(round(2**24 * end * math.sin(math.pi * t) ** 2), 2**24) for t in turns
    ]
    table = [sum(Fraction(term(k)) * y**k for k in range(14)) for y in nodes]
    for order in range(1, degree + 1):
        for i in range(degree, order - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - order])
    polynomial = [Fraction(0)]
    for value, node in zip(reversed(table), reversed(nodes), strict=True):
        shifted = [Fraction(0), *polynomial]
        polynomial = [
            a - node * b for a, b in zip(shifted, [*polynomial, 0], strict=True)
        ]
        polynomial[0] += value
    return tuple(float(coefficient) for coefficient in polynomial[: degree + 1])


# cos x = 1 + y C(y), sin x = x (1 + y S(y)) and artanh x = x (1 + y L(y)), y = x²: to
# rounding for |x| <= π/4, and for the x of a mantissa between √½ and √2.
C0, C1, C2, C3, C4, C5, C6 = _near_best(
    lambda k: Fraction(-((-1) ** k), math.factorial(2 * k + 2)), 6, (math.pi / 4) ** 2
)
S0, S1, S2, S3, S4, S5 = _near_best(
    lambda k: Fraction(-((-1) ** k), math.factorial(2 * k + 3)), 5, (math.pi / 4) ** 2
)
L0, L1, L2, L3, L4, L5, L6 = _near_best(
    lambda k: Fraction(1, 2 * k + 3), 6, (3 - 2 * math.sqrt(2)) ** 2
)
# -4 artanh x = x M(y).
M0, M1, M2, M3, M4, M5, M6, M7 = (-4 * c for c in (1, L0, L1, L2, L3, L4, L5, L6))
# The first two without the leading terms written out, for |x| <= π/2: cos x = D(y) and
# sin x = x E(y).
D0, D1, D2, D3, D4, D5, D6, D7, D8, D9 = _near_best(
    lambda k: Fraction((-1) ** k, math.factorial(2 * k)), 9, QUARTER_TURN**2
)
E0, E1, E2, E3, E4, E5, E6, E7, E8 = _near_best(
    lambda k: Fraction((-1) ** k, math.factorial(2 * k + 1)), 8, QUARTER_TURN**2
)


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def cosine_sine(angle):
    """cos and sin of an angle in [-π, π], of a quarter of it and doubled twice."""
    x = 0.25 * angle
    y = x * x
    c = C2 + y * (C3 + y * (C4 + y * (C5 + y * C6)))
    c = 1 + y * (C0 + y * (C1 + y * c))
    s = x * (1 + y * (S0 + y * (S1 + y * (S2 + y * (S3 + y * (S4 + y * S5))))))
    c, s = (c - s) * (c + s), 2 * c * s
    return (c - s) * (c + s), 2 * c * s


def _pade_of_tanh(n):
    """Coefficients in x² of the Padé approximants P, Q with tanh x = x P(x²)/Q(x²).

    They are the odd and the even part of the diagonal approximant of exp(2x).
    """
    f = math.factorial
    terms = [f(2 * n - k) * 2**k / (f(k) * f(n - k)) for k in range(n + 1)]
    odd, even = terms[1::2], terms[::2]
    return tuple(t / odd[0] for t in odd), tuple(t / even[0] for t in even)


_P, _Q = _pade_of_tanh(8)
P1, P2, P3 = _P[1:]
Q1, Q2, Q3, Q4 = _Q[1:]
# tan(πr/2) = r F(r²)/G(r²): the same at an imaginary argument.
F0, F1, F2, F3 = (
    QUARTER_TURN * p * (-(QUARTER_TURN**2)) ** k for k, p in enumerate(_P)
)
G1, G2, G3, G4 = (q * (-(QUARTER_TURN**2)) ** k for k, q in enumerate(_Q) if k > 0)


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def hyperbolic(y):
    """Multiples of cosh x, of 1 and of sinh(x)/x, for y = (x/8)².

    To rounding, and to 5e-15 of cosh x for x up to twice `FARTHEST`. The approximant
    of tanh(x/8) gives them for x/4, from where x is doubled twice.
    """
    n = 1 + y * (P1 + y * (P2 + y * P3))
    d = 1 + y * (Q1 + y * (Q2 + y * (Q3 + y * Q4)))
    square, other = d * d, y * n * n
    cosh, one, sinh = square + other, square - other, n * d
    square = one * one
    cosh, one, sinh = (cosh + cosh) * cosh - square, square, cosh * sinh
    square = one * one
    return (cosh + cosh) * cosh - square, square, cosh * sinh


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def half_angle(turn):
    """Multiples of cos(π turn) and sin(π turn) for -1/2 <= turn <= 1/2."""
    y = turn * turn
    n = turn * (F0 + y * (F1 + y * (F2 + y * F3)))
    d = 1 + y * (G1 + y * (G2 + y * (G3 + y * G4)))
    return (d - n) * (d + n), (n + n) * d


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def cosine_sine_of_quarter(x):
    """cos and sin of an angle in [-π/2, π/2]."""
    y = x * x
    c = D4 + y * (D5 + y * (D6 + y * (D7 + y * (D8 + y * D9))))
    s = E4 + y * (E5 + y * (E6 + y * (E7 + y * E8)))
    c = D0 + y * (D1 + y * (D2 + y * (D3 + y * c)))
    return c, x * (E0 + y * (E1 + y * (E2 + y * (E3 + y * s))))


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def minus_twice_logarithm(number, n_halvings):
    """-2 ln of a positive normal number after so many halvings."""
    bits = bits_of(number)
    whole = (bits - ROOT_HALF) >> EXPONENT
    # The mantissa m lies in [√½, √2): ln m = 2 artanh((m - 1)/(m + 1)).
    m = number_of(bits - (whole << EXPONENT))
    exponent = number_of(BITS_OF_SIGNED_WHOLE + whole) - (SIGNED_WHOLE + n_halvings)
    x = (m - 1) / (m + 1)
    y = x * x
    series = M4 + y * (M5 + y * (M6 + y * M7))
    series = M0 + y * (M1 + y * (M2 + y * (M3 + y * series)))
    return exponent * (-2 * LN2) + x * series


@njit(cache=True, forceinline=True, fastmath={"contract"}, error_model="numpy")
def turns_taken(before, after, direction):
    """Full turns in a rotation by at most π towards `direction`: -1, 0 or 1.

    The angle has made one when the tangent passes the negative ξ1 axis; the signs of
    its second component, before and after, tell.
    """
    first, last = math.copysign(0.5, before), math.copysign(0.5, after)
    return first + math.copysign(0.5, direction) if first != last else 0.0


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def standard_normals(path, group, key0, key1, words, normals):
    """Four standard normal numbers for every lane, by Box and Muller's method.

    The counter is (path, group); one group serves four steps. `words` is for whole
    numbers, of the shape (4, LANES) of `normals`.
    """
    for i in range(LANES):
        low, high = (path + i) & MASK, ((path + i) >> 32) & MASK
        c0, c1, c2, c3 = philox(low, high, group, 0, key0, key1)
        words[0, i], words[1, i] = c0 | BITS_OF_WHOLE, c1 | BITS_OF_WHOLE
        words[2, i], words[3, i] = c2 | BITS_OF_WHOLE, c3 | BITS_OF_WHOLE
    for pair in (0, 2):
        for i in range(LANES):
            # Uniform in (0, 1) is (c + 1/2)/2³², for the length and for the angle.
            uniform, centred = number_of(words[pair, i]), number_of(words[pair + 1, i])
            radius = math.sqrt(minus_twice_logarithm(uniform - (WHOLE - 0.5), 32.0))
            angle = (centred - (WHOLE + 0.5 / UNIT)) * (TURN * UNIT) + 0.5 * TURN * UNIT
            # In [-π, π]: its cosine is the sine of this, its sine has its sign.
            c, s = cosine_sine_of_quarter(QUARTER_TURN - abs(angle))
            normals[pair, i] = radius * s
            normals[pair + 1, i] = math.copysign(radius, angle) * c


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def translate_block(half, shift1, shift2, w):
    """ξ ← ξ + half · τ - shift."""
    for i in range(LANES):
        w[XI1 + i] += half * w[COSINE + i] - shift1
        w[XI2 + i] += half * w[SINE + i] - shift2


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def load_weights(weights, start, n_lanes, w):
    """Weights of the paths into the work array; unused lanes keep the last path."""
    for i in range(LANES):
        w[WEIGHT1 + i] = weights[0, start + min(i, n_lanes - 1)]
        w[WEIGHT2 + i] = weights[1, start + min(i, n_lanes - 1)]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def displace_block(own, w):
    """ξ ← ξ - (the two motions in the columns of `own`, weighted for every path)."""
    a1, b1, a2, b2 = own[0, 0], own[0, 1], own[1, 0], own[1, 1]
    for i in range(LANES):
        w[XI1 + i] -= a1 * w[WEIGHT1 + i] + b1 * w[WEIGHT2 + i]
        w[XI2 + i] -= a2 * w[WEIGHT1 + i] + b2 * w[WEIGHT2 + i]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def force_block(kind, first, second, w):
    """∇B at ξ: kind and the two parameters of the potential."""
    if kind == QUADRATIC:
        for i in range(LANES):
            w[FORCE1 + i] = first * w[XI1 + i]
            w[FORCE2 + i] = second * w[XI2 + i]
    elif kind == LINEAR:
        for i in range(LANES):
            radius = math.sqrt(w[XI1 + i] * w[XI1 + i] + w[XI2 + i] * w[XI2 + i])
            slope = first / max(radius, NEAREST)
            w[FORCE1 + i] = slope * w[XI1 + i]
            w[FORCE2 + i] = slope * w[XI2 + i]
    elif kind == EVEN_POWER:
        for i in range(LANES):
            slope = first
            square = w[XI1 + i] * w[XI1 + i] + w[XI2 + i] * w[XI2 + i]
            for _ in range(int(second) // 2 - 1):
                slope *= square
            w[FORCE1 + i] = slope * w[XI1 + i]
            w[FORCE2 + i] = slope * w[XI2 + i]
    elif kind == POWER:
        for i in range(LANES):
            square = w[XI1 + i] * w[XI1 + i] + w[XI2 + i] * w[XI2 + i]
            slope = first * max(square, NEAREST * NEAREST) ** (0.5 * second - 1)
            w[FORCE1 + i] = slope * w[XI1 + i]
            w[FORCE2 + i] = slope * w[XI2 + i]
    else:
        for i in range(LANES):
            w[FORCE1 + i] = 0.0
            w[FORCE2 + i] = 0.0


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def limit_force(quarter, w):
    """Cut |∇B| to `FARTHEST`/quarter, beyond which tanh is one anyway."""
    n_far = 0
    for i in range(LANES):
        square = w[FORCE1 + i] * w[FORCE1 + i] + w[FORCE2 + i] * w[FORCE2 + i]
        n_far += 1 if square * quarter * quarter > FARTHEST * FARTHEST else 0
    if n_far == 0:
        return
    for i in range(LANES):
        size = quarter * math.hypot(w[FORCE1 + i], w[FORCE2 + i])
        if size == math.inf:
            # A length can overflow where the components do not: without this the
            # force would become zero. One that is infinite itself becomes NaN.
            w[FORCE1 + i] *= 1e-100
            w[FORCE2 + i] *= 1e-100
            size = quarter * math.hypot(w[FORCE1 + i], w[FORCE2 + i])
        if size > FARTHEST:
            w[FORCE1 + i] *= FARTHEST / size
            w[FORCE2 + i] *= FARTHEST / size


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def kick_block(quarter, scale, number, normals, w):
    """R½ D R½ at fixed ξ, D by `scale` times a row of normal numbers.

    With w = u ∇B, u = tanh(|∇B| ds/4)/|∇B|, R½ is τ ← (τ - w)/(1 - w̄τ) of complex τ,
    and D turns by θ. The product of the three is τ ← (aτ + b)/(b̄τ + ā), which turns τ
    by twice the argument of a + bτ̄. With X = |∇B| ds/2 this is a multiple of

        cos(θ/2) (cosh X - sinh(X)/|∇B| ∇B·τ)
        + i (sin(θ/2) - cos(θ/2) sinh(X)/|∇B| ∇B·τ⊥) ,

    of which only the direction matters. Full turns of θ apart, the real part is not
    negative: the angle that τ turns by has the sign of the imaginary part, and is at
    most π.
    """
    eighth, fraction = 0.25 * quarter, scale / TURN
    for i in range(LANES):
        c, s, f1, f2 = w[COSINE + i], w[SINE + i], w[FORCE1 + i], w[FORCE2 + i]
        cosh, one, sinh = hyperbolic((f1 * f1 + f2 * f2) * (eighth * eighth))
        sinh *= 2 * quarter
        angle = fraction * normals[number, i]
        turns = math.floor(angle + 0.5)
        half_c, half_s = half_angle(angle - turns)
        x = half_c * max(cosh - sinh * (f1 * c + f2 * s), LEAST)
        y = half_s * one + half_c * sinh * (f1 * s - f2 * c)
        # Rounding moves the tangent off the circle; one Newton step brings it back.
        length = (1.5 - 0.5 * (c * c + s * s)) / (x * x + y * y)
        p, q = length * ((x - y) * (x + y)), length * ((x + x) * y)
        c1, s1 = c * p - s * q, s * p + c * q
        w[COSINE + i], w[SINE + i] = c1, s1
        w[TURNS + i] += turns + turns_taken(s, s1, y)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def rotate_block(w):
    """τ turned by the angles of the row `ANGLE`, of any size."""
    for i in range(LANES):
        turns = math.floor(w[ANGLE + i] / TURN + 0.5)
        x, y = cosine_sine(w[ANGLE + i] - turns * TURN)
        c, s = w[COSINE + i], w[SINE + i]
        c1, s1 = c * x - s * y, s * x + c * y
        # Rounding moves the tangent off the circle; one Newton step brings it back.
        length = 1.5 - 0.5 * (c1 * c1 + s1 * s1)
        w[COSINE + i], w[SINE + i] = length * c1, length * s1
        w[TURNS + i] += turns + turns_taken(s, s1, y)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def splitting_step(ds, potential, shifts, scale, number, normals, w):
    """T½ R½ D R½ T½."""
    translate_block(0.5 * ds, shifts[0, 0], shifts[0, 1], w)
    force_block(*potential, w)
    limit_force(0.25 * ds, w)
    kick_block(0.25 * ds, scale, number, normals, w)
    translate_block(0.5 * ds, shifts[1, 0], shifts[1, 1], w)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def euler_step(ds, potential, shifts, scale, number, normals, w):
    """Euler-Maruyama: both drifts at the beginning of the step."""
    force_block(*potential, w)
    for i in range(LANES):
        drift = w[FORCE1 + i] * w[SINE + i] - w[FORCE2 + i] * w[COSINE + i]
        w[ANGLE + i] = scale * normals[number, i] + ds * drift
    translate_block(ds, shifts[0, 0] + shifts[1, 0], shifts[0, 1] + shifts[1, 1], w)
    rotate_block(w)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def heun_step(ds, potential, shifts, scale, number, normals, w):
    """Stochastic Heun: mean of the drifts at both ends of an Euler-Maruyama step."""
    for i in range(LANES):
        w[KEPT1 + i], w[KEPT2 + i] = w[COSINE + i], w[SINE + i]
        w[KEPT3 + i], w[KEPT4 + i] = scale * normals[number, i], w[TURNS + i]
    half = 0.5 * ds
    shift1, shift2 = shifts[0, 0] + shifts[1, 0], shifts[0, 1] + shifts[1, 1]
    force_block(*potential, w)
    for i in range(LANES):
        drift = w[FORCE1 + i] * w[SINE + i] - w[FORCE2 + i] * w[COSINE + i]
        w[KEPT5 + i] = half * drift
        w[ANGLE + i] = w[KEPT3 + i] + ds * drift
    translate_block(ds, shift1, shift2, w)
    rotate_block(w)
    force_block(*potential, w)
    for i in range(LANES):
        c, s = w[COSINE + i], w[SINE + i]
        drift = w[FORCE1 + i] * s - w[FORCE2 + i] * c
        w[ANGLE + i] = w[KEPT3 + i] + w[KEPT5 + i] + half * drift
        w[XI1 + i] += half * (c - w[KEPT1 + i])
        w[XI2 + i] += half * (s - w[KEPT2 + i])
        w[COSINE + i], w[SINE + i] = w[KEPT1 + i], w[KEPT2 + i]
        w[TURNS + i] = w[KEPT4 + i]
    rotate_block(w)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def load_block(state, start, n_lanes, w):
    """Columns of the state into the work array; unused lanes keep the last path."""
    for row in range(N_STATE):
        for i in range(LANES):
            w[row * LANES + i] = state[row, start + min(i, n_lanes - 1)]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def store_block(w, start, n_lanes, state):
    """The used lanes of the work array back into the state."""
    for row in range(N_STATE):
        for i in range(n_lanes):
            state[row, start + i] = w[row * LANES + i]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def advance_paths(noise, ds, potential, shifts, method, trace, state):
    """Advance every path by as many steps as there are pairs of shifts.

    Parameters
    ----------
    noise : Noise
    ds : float
    potential : (int, float, float)
        Kind and its two parameters.
    shifts : Shifts
        What a nozzle adds is taken before and behind the force.
    method : int
    trace : ndarray, shape (n_steps, 5, n_paths) or (0, 5, 0)
        Receives the state after every step, if it has room.
    state : ndarray, shape (5, n_paths)
        ξ1, ξ2, cos α, sin α and full turns; changed in place.
    """
    path, step, key, scale = noise
    common, own, weights = shifts
    n_paths, n_steps, phased = state.shape[1], common.shape[0], weights.shape[1] > 0
    for block in prange((n_paths + LANES - 1) // LANES):
        w, normals = np.zeros(N_ROWS * LANES), np.zeros((N_STEPS, LANES))
        words = np.zeros((N_STEPS, LANES), np.int64)
        start = block * LANES
        n_lanes = min(LANES, n_paths - start)
        load_block(state, start, n_lanes, w)
        if phased:
            load_weights(weights, start, n_lanes, w)
        for j in range(n_steps):
            number = (step + j) & 3
            if j == 0 or number == 0:
                group = (step + j) >> 2
                standard_normals(path + start, group, *key, words, normals)
            if phased:
                displace_block(own[j, 0], w)
            if method == SPLITTING:
                splitting_step(ds, potential, common[j], scale, number, normals, w)
            elif method == EULER_MARUYAMA:
                euler_step(ds, potential, common[j], scale, number, normals, w)
            else:
                heun_step(ds, potential, common[j], scale, number, normals, w)
            if phased:
                displace_block(own[j, 1], w)
            if trace.shape[0] > 0:
                store_block(w, start, n_lanes, trace[j])
        store_block(w, start, n_lanes, state)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def fill_normals(path, group, key, filled):
    """Noise of the four steps of a group: standard normal, one column a path.

    Parameters
    ----------
    path, group : int
    key : (int, int)
    filled : ndarray, shape (4, n_paths)
    """
    n_paths = filled.shape[1]
    for block in prange((n_paths + LANES - 1) // LANES):
        normals = np.zeros((N_STEPS, LANES))
        words = np.zeros((N_STEPS, LANES), np.int64)
        start = block * LANES
        standard_normals(path + start, group, *key, words, normals)
        for number in range(N_STEPS):
            for i in range(min(LANES, n_paths - start)):
                filled[number, start + i] = normals[number, i]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def kick_paths(quarter, angles, forces, state):
    """R½ D R½ of every path with given noise and given ∇B.

    Parameters
    ----------
    quarter : float
        ds/4.
    angles : ndarray, shape (n_paths,)
    forces : ndarray, shape (2, n_paths)
    state : ndarray, shape (5, n_paths)
    """
    n_paths = state.shape[1]
    for block in prange((n_paths + LANES - 1) // LANES):
        w, given = np.zeros(N_ROWS * LANES), np.zeros((1, LANES))
        start = block * LANES
        n_lanes = min(LANES, n_paths - start)
        load_block(state, start, n_lanes, w)
        for i in range(n_lanes):
            given[0, i] = angles[start + i]
            w[FORCE1 + i] = forces[0, start + i]
            w[FORCE2 + i] = forces[1, start + i]
        limit_force(quarter, w)
        kick_block(quarter, 1.0, 0, given, w)
        store_block(w, start, n_lanes, state)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def rotate_paths(angles, state):
    """The tangent of every path turned by its own angle, of any size.

    Parameters
    ----------
    angles : ndarray, shape (n_paths,)
    state : ndarray, shape (5, n_paths)
    """
    n_paths = state.shape[1]
    for block in prange((n_paths + LANES - 1) // LANES):
        w = np.zeros(N_ROWS * LANES)
        start = block * LANES
        n_lanes = min(LANES, n_paths - start)
        load_block(state, start, n_lanes, w)
        for i in range(n_lanes):
            w[ANGLE + i] = angles[start + i]
        rotate_block(w)
        store_block(w, start, n_lanes, state)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def sum_powers(state, sums):
    """Sums over blocks of paths of the powers ξ1ⁱ ξ2ʲ, i + j <= 4, and of cos, sin.

    The powers come in the order of i + j and then of falling i; after them cos α,
    sin α, cos² α and sin² α.

    Parameters
    ----------
    state : ndarray, shape (5, n_paths)
    sums : ndarray, shape (n_blocks, 19)
        Zeros before; n_blocks times `LANES` is at least n_paths.
    """
    for block in prange(sums.shape[0]):
        start = block * LANES
        for i in range(start, min(start + LANES, state.shape[1])):
            power1 = 1.0
            for power in range(N_POWERS):
                entry = power1
                for other in range(N_POWERS - power):
                    total = power + other
                    sums[block, total * (total + 1) // 2 + other] += entry
                    entry *= state[1, i]
                power1 *= state[0, i]
            cosine, sine = state[2, i], state[3, i]
            sums[block, N_PRODUCTS] += cosine
            sums[block, N_PRODUCTS + 1] += sine
            sums[block, N_PRODUCTS + 2] += cosine * cosine
            sums[block, N_PRODUCTS + 3] += sine * sine


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def numbers_of_four_steps(path, group, key0, key1, words, numbers):
    """Twelve standard normal numbers for every lane, three for each step of a group."""
    for part in range(N_NUMBERS):
        counter = N_NUMBERS * group + part
        rows = numbers[N_STEPS * part : N_STEPS * (part + 1)]
        standard_normals(path, counter, key0, key1, words, rows)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def noise_block(noise, number, numbers, w):
    """Noise of κ, α and ᾱ, of the three rows of `numbers` for the step `number`."""
    n11, n21, n22, n31, n32, n33 = noise
    row = N_NUMBERS * number
    for i in range(LANES):
        z1, z2, z3 = numbers[row, i], numbers[row + 1, i], numbers[row + 2, i]
        w[NOISE1 + i] = n11 * z1
        w[NOISE2 + i] = n21 * z1 + n22 * z2
        w[NOISE3 + i] = n31 * z1 + n32 * z2 + n33 * z3


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def turn_block(ds, weights, spread, shift1, shift2, w):
    """κ and the angle by which τ turns; ξ from where the force was taken to the end."""
    k0, k1, k2, a0, a1, a2, m0, m1 = weights
    spread_of_noise, spread_of_kappa = spread
    for i in range(LANES):
        c, s, kappa = w[COSINE + i], w[SINE + i], w[KAPPA + i]
        # Half the mean of (α(u) - ᾱ)² over the step, and exp(-x) of it to third order.
        x = spread_of_noise + spread_of_kappa * kappa * kappa
        straight = 1 / (1 + x * (1 + 0.5 * x))
        mean = m0 * kappa + w[NOISE3 + i]
        x, y = cosine_sine(mean - TURN * math.floor(mean / TURN + 0.5))
        free_c, free_s = straight * (c * x - s * y), straight * (s * x + c * y)
        # Turned by 2 arctan q for 2q, which differs at the third order only.
        q = 0.5 * m1 * (w[FORCE1 + i] * free_s - w[FORCE2 + i] * free_c)
        scale = 1 / (1 + q * q)
        x, y = (1 - q * q) * scale, 2 * q * scale
        mean_c, mean_s = free_c * x - free_s * y, free_s * x + free_c * y

        f = w[FORCE1 + i] * s - w[FORCE2 + i] * c
        change = 2 * (w[FORCE1 + i] * mean_s - w[FORCE2 + i] * mean_c - f)
        w[ANGLE + i] = a0 * kappa + a1 * f + a2 * change + w[NOISE2 + i]
        w[KAPPA + i] = k0 * kappa + k1 * f + k2 * change + w[NOISE1 + i]
        w[XI1 + i] += ds * (mean_c - 0.5 * c) - shift1
        w[XI2 + i] += ds * (mean_s - 0.5 * s) - shift2


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def load_smooth_block(state, start, n_lanes, w):
    """As `load_block`, with the curvature."""
    load_block(state, start, n_lanes, w)
    for i in range(LANES):
        w[KAPPA + i] = state[N_STATE, start + min(i, n_lanes - 1)]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def store_smooth_block(w, start, n_lanes, state):
    """As `store_block`, with the curvature."""
    store_block(w, start, n_lanes, state)
    for i in range(n_lanes):
        state[N_STATE, start + i] = w[KAPPA + i]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def advance_smooth_paths(path, step, key, law, potential, shifts, trace, state):
    """Advance every path by as many steps as there are pairs of shifts.

    Parameters
    ----------
    path, step : int
        Numbers of the first path and of the first step: the counters of the noise.
    key : (int, int)
    law : SmoothStep
        As `fpsolve.paths.smooth_step` computes it.
    potential : (int, float, float)
        Kind and its two parameters.
    shifts : Shifts
        What a nozzle adds is taken before and behind the force.
    trace : ndarray, shape (n_steps, 6, n_paths) or (0, 6, 0)
        Receives the state after every step, if it has room.
    state : ndarray, shape (6, n_paths)
        ξ1, ξ2, cos α, sin α, full turns and κ; changed in place.
    """
    ds, turning, noise, spread = law
    kind, first, second = potential
    common, own, weights = shifts
    n_paths, n_steps, phased = state.shape[1], common.shape[0], weights.shape[1] > 0
    for block in prange((n_paths + LANES - 1) // LANES):
        w = np.zeros(N_SMOOTH_ROWS * LANES)
        numbers = np.zeros((N_NUMBERS * N_STEPS, LANES))
        words = np.zeros((N_STEPS, LANES), np.int64)
        start = block * LANES
        n_lanes = min(LANES, n_paths - start)
        load_smooth_block(state, start, n_lanes, w)
        if phased:
            load_weights(weights, start, n_lanes, w)
        for j in range(n_steps):
            number = (step + j) & 3
            if j == 0 or number == 0:
                group = (step + j) >> 2
                numbers_of_four_steps(path + start, group, *key, words, numbers)
            if phased:
                displace_block(own[j, 0], w)
            translate_block(0.5 * ds, common[j, 0, 0], common[j, 0, 1], w)
            force_block(kind, first, second, w)
            limit_force(0.25 * ds, w)
            noise_block(noise, number, numbers, w)
            turn_block(ds, turning, spread, common[j, 1, 0], common[j, 1, 1], w)
            rotate_block(w)
            if phased:
                displace_block(own[j, 1], w)
            if trace.shape[0] > 0:
                store_smooth_block(w, start, n_lanes, trace[j])
        store_smooth_block(w, start, n_lanes, state)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def turn_paths(law, numbers, forces, shift, state):
    """The second half of a step of every path, with given noise and given ∇B.

    Parameters
    ----------
    law : SmoothStep
    numbers : ndarray, shape (3, n_paths)
        Standard normal.
    forces : ndarray, shape (2, n_paths)
        ∇B where half a step along the tangent leads to, at which ξ is.
    shift : ndarray, shape (2,)
        γ over the second half of the step.
    state : ndarray, shape (6, n_paths)
    """
    ds, weights, noise, spread = law
    n_paths = state.shape[1]
    for block in prange((n_paths + LANES - 1) // LANES):
        w, given = np.zeros(N_SMOOTH_ROWS * LANES), np.zeros((N_NUMBERS, LANES))
        start = block * LANES
        n_lanes = min(LANES, n_paths - start)
        load_smooth_block(state, start, n_lanes, w)
        for i in range(n_lanes):
            w[FORCE1 + i] = forces[0, start + i]
            w[FORCE2 + i] = forces[1, start + i]
            for number in range(N_NUMBERS):
                given[number, i] = numbers[number, start + i]
        limit_force(0.25 * ds, w)
        noise_block(noise, 0, given, w)
        turn_block(ds, weights, spread, shift[0], shift[1], w)
        rotate_block(w)
        store_smooth_block(w, start, n_lanes, state)
