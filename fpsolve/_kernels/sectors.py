"""The forward equation (9) in one sector of the angular index, and its series.

For isotropic quadratic B on a belt at rest p/p_S = Σ c[k, a, b] e_ab(ξ) e^{ikα}, e_ab
the circular Hermite function of the angular index a − b, splits by M = a − b + k into
sectors, each with real coefficients for the complex c. A sector is c[part, row, 1 + m]
with the parts ℜ and ℑ, k = row − K − 1 for 2K + 3 rows of which the first and last are
empty, and m = min(a, b); counts[row] of them are kept, whole registers, and everything
else is zero.
"""

from typing import NamedTuple

import numpy as np

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, fused, put, spread, take

# Terms between two looks at whether the series has converged.
STRIDE = 4
# Terms beyond the argument of the Bessel functions that are computed: x^{1/3} times
# this reaches 1e-30 of the largest, and MORE is for small arguments.
BEYOND, MORE = 12.0, 40
LARGEST = 1e200
# Of a half axis.
PRECISION = 1e-2
# Where the ellipse is nearly a circle its polynomials grow as (half axes/focus)^n, and
# it takes this many terms per unit of half axes times arclength; where it is FLAT times
# as wide as high, those above are enough.
ROUND, FLAT = 2.2, 4.0
# Foci of the ellipse stay this share of the longer half axis from the centre.
FLATTEST = 0.35


class Equation(NamedTuple):
    """What the equation in a sector needs.

    Attributes
    ----------
    scale : float
        1/(√2 σ).
    diffusivity : float
        A²/2.
    roots : ndarray
        √n, n = 0, 1, …
    """

    scale: float
    diffusivity: float
    roots: np.ndarray


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def apply_sector(c, counts, index, equation, recurrence, previous, weights, total):
    """previous ← f L*c + g c + e previous; then total += weights · (c, previous).

    c, previous, total (2, R, W), counts (R,), index M, recurrence (f, g, e). The total
    is left alone where both weights are zero. With a = m + (l)₊, b = m + (−l)₊,
    l = M − k and s = 1/(√2 σ),

        (L*c)[k, a, b] = s (1 + k) √a c[k+1, a−1, b] + s k √(b+1) c[k+1, a, b+1]
                       + s (1 − k) √b c[k−1, a, b−1] − s k √(a+1) c[k−1, a+1, b]
                       − (A²/2) k² c[k, a, b].
    """
    scale, diffusivity, roots = equation
    f, g, e = recurrence
    kept, before, share = spread(e), spread(weights[0]), spread(weights[1])
    adds = weights[0] != 0.0 or weights[1] != 0.0
    harmonics = (counts.size - 3) // 2
    for row in range(1, counts.size - 1):
        k = row - 1 - harmonics
        turns = index - k
        up, down = max(turns, 0), max(-turns, 0)
        # Where the neighbours stand: by the sign of the angular index.
        first = 0 if turns > 0 else -1
        third = -1 if turns >= 0 else 0
        rise, fall = spread(f * scale * (1 + k)), spread(f * scale * k)
        sink = spread(f * scale * (1 - k))
        here = spread(g - f * diffusivity * k * k)
        for m in range(0, counts[row], LANES):
            one = rise * take(roots, (m + up,))
            two = fall * take(roots, (m + down + 1,))
            three = sink * take(roots, (m + down,))
            four = fall * take(roots, (m + up + 1,))
            for part in range(2):
                at = part, row, m + 1
                own = take(c, at)
                value = fused(here, own, kept * take(previous, at))
                value = fused(one, take(c, (part, row + 1, m + 1 + first)), value)
                value = fused(two, take(c, (part, row + 1, m + 2 + first)), value)
                value = fused(three, take(c, (part, row - 1, m + 1 + third)), value)
                value = value - four * take(c, (part, row - 1, m + 2 + third))
                put(previous, at, value)
                if adds:
                    sums = fused(before, own, take(total, at))
                    put(total, at, fused(share, value, sums))


@njit(cache=True, error_model="numpy")
def norm_squared(c):
    """Σ |c|²."""
    total = 0.0
    for part in range(c.shape[0]):
        for row in range(c.shape[1]):
            for m in range(c.shape[2]):
                total += c[part, row, m] ** 2
    return total


@njit(cache=True, error_model="numpy")
def couplings(counts, index, equation):
    """Bounds of the norms of the blocks of L* between k and k + 1, all k in turn."""
    harmonics = (counts.size - 3) // 2
    found = np.zeros(counts.size - 1)
    for row in range(1, counts.size - 2):
        k = row - 1 - harmonics
        turns = index - k
        m = min(counts[row], counts[row + 1] + LANES)
        if m > 0:
            up, down = m + max(turns, 0), m + max(-turns, 0)
            found[row] = equation.scale * (
                abs(1 + k) * np.sqrt(up) + abs(k) * np.sqrt(down + 1.0)
            )
    return found


@njit(cache=True, error_model="numpy")
def largest_eigenvalue(beside):
    """Of a symmetric tridiagonal matrix with no diagonal, by bisection from above."""
    high = 0.0
    for i in range(1, beside.size):
        high = max(high, beside[i - 1] + beside[i])
    low = 0.5 * high
    while high - low > PRECISION * high:
        middle, pivot, inside = 0.5 * (low + high), 1.0, True
        for i in range(beside.size):
            pivot = middle - (beside[i] ** 2 / pivot if i else beside[0] ** 2 / middle)
            if pivot <= 0.0:
                inside = False
                break
        if inside:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True, error_model="numpy")
def half_axes(counts, index, equation):
    """Half widths of a box around the numerical range: along ℜ, along ℑ.

    L* is −(A²/2) k² and a skew matrix of blocks between neighbouring k, whose norm is
    at most that of the matrix of their norms.
    """
    harmonics = (counts.size - 3) // 2
    last = 0
    for row in range(1, counts.size - 1):
        if counts[row] > 0:
            last = max(last, abs(row - 1 - harmonics))
    imaginary = largest_eigenvalue(couplings(counts, index, equation))
    return 0.5 * equation.diffusivity * last * last, max(imaginary, 1e-3)


@njit(cache=True, error_model="numpy")
def chebyshev_coefficients(shift, argument, sign, least):
    """e^{shift} (2 − δ_n0) I_n(argument), or J_n for sign −1, by Miller's recurrence.

    For n up to where they are negligible, and up to `least`.

    Backwards from where they are negligible, and normalised by the sums
    I₀ + 2 Σ I_n = e^x or J₀ + 2 Σ J_2n = 1.
    """
    n_terms = int(max(argument + BEYOND * argument ** (1.0 / 3.0), least)) + MORE
    values = np.zeros(n_terms + 1)
    above, here, total = 0.0, 1e-200, 0.0
    for n in range(n_terms, -1, -1):
        values[n] = here
        if n == 0:
            total += here
        elif sign > 0 or n % 2 == 0:
            total += 2.0 * here
        above, here = here, 2.0 * n / argument * here + sign * above
        if abs(here) > LARGEST:
            for later in range(n, n_terms + 1):
                values[later] /= LARGEST
            above, here, total = above / LARGEST, here / LARGEST, total / LARGEST
    factor = np.exp(shift + argument if sign > 0 else shift) / total
    for n in range(n_terms + 1):
        values[n] *= factor if n == 0 else 2.0 * factor
    return values


@njit(cache=True, error_model="numpy")
def advance_sector(c, counts, index, equation, ds, tolerance):
    """e^{ds L*} c within the counts, to `tolerance`, and how many terms it took.

    Σ a_n U_n with U_{n+1} = 2 X U_n − sign U_{n−1}, X = (L* − centre)/focus: see
    `ForwardOperator`. The mass stays what it was. 0 terms where the series has not
    converged.
    """
    real, imaginary = half_axes(counts, index, equation)
    square = real**2 - imaginary**2
    focus = np.sqrt(max(abs(square), (FLATTEST * max(real, imaginary)) ** 2))
    sign = 1.0 if square > 0 else -1.0
    least = ROUND * (real + imaginary) * ds if real < FLAT * imaginary else 0.0
    factors = chebyshev_coefficients(-real * ds, focus * ds, sign, least)
    gain, centre = 1.0 / focus, -real
    older, newer, total = c.copy(), np.zeros_like(c), np.zeros_like(c)
    first = gain, -gain * centre, 0.0
    weights = factors[0], factors[1]
    apply_sector(older, counts, index, equation, first, newer, weights, total)
    following = 2.0 * gain, -2.0 * gain * centre, -sign
    for n in range(2, factors.size):
        # Two terms at a time: the sum is what is read and written most.
        odd = n % 2 == 1
        weights = (factors[n - 1], factors[n]) if odd else (0.0, 0.0)
        apply_sector(newer, counts, index, equation, following, older, weights, total)
        older, newer = newer, older
        # While the terms still grow, small ones say nothing of those to come.
        if n % STRIDE == STRIDE - 1 and n >= imaginary * ds:
            ahead = 0.0
            for later in range(n + 1, min(n + 1 + STRIDE, factors.size)):
                ahead = max(ahead, abs(factors[later]))
            size = np.sqrt(norm_squared(older)) + np.sqrt(norm_squared(newer))
            if ahead * size < tolerance:
                if index == 0:
                    middle = counts.size // 2
                    total[:, middle, 1] = c[:, middle, 1]
                return total, n
    return total, 0


@njit(cache=True, error_model="numpy")
def within(c, counts, new_counts):
    """The same sector in new counts, of 2K' + 3 rows; what they lack is left out."""
    shift = (new_counts.size - counts.size) // 2
    out = np.zeros((2, new_counts.size, new_counts.max() + LANES))
    for row in range(1, counts.size - 1):
        target = row + shift
        if 0 < target < new_counts.size - 1:
            for part in range(2):
                for m in range(1, min(counts[row], new_counts[target]) + 1):
                    out[part, target, m] = c[part, row, m]
    return out


@njit(cache=True, error_model="numpy")
def norm_between(c, inner, outer):
    """Norm of the coefficients in the outer counts and not in the inner."""
    shift = (outer.size - inner.size) // 2
    total = 0.0
    for row in range(1, outer.size - 1):
        other = row - shift
        kept = inner[other] if 0 < other < inner.size - 1 else 0
        for part in range(2):
            for m in range(kept + 1, outer[row] + 1):
                total += c[part, row, m] ** 2
    return np.sqrt(total)


@njit(cache=True, error_model="numpy")
def distance(c, counts, other, other_counts):
    """Norm of what two expansions of one sector differ by."""
    n = max(counts.size, other_counts.size)
    total = 0.0
    for row in range(n):
        one, two = row - (n - counts.size) // 2, row - (n - other_counts.size) // 2
        width = counts[one] if 0 <= one < counts.size else 0
        width_of_other = other_counts[two] if 0 <= two < other_counts.size else 0
        for part in range(2):
            for m in range(1, max(width, width_of_other) + 1):
                value = c[part, one, m] if m <= width else 0.0
                if m <= width_of_other:
                    value -= other[part, two, m]
                total += value**2
    return np.sqrt(total)


@njit(cache=True, error_model="numpy")
def flux(c, counts, index, equation):
    """‖edge‖ ‖(1 − P) L* c‖, P the projection on the counts.

    The edge are the last LANES of every row, and all that lies beside an empty place.
    """
    n = counts.size
    wider, inner = np.zeros(n + 2, np.int64), np.zeros(n, np.int64)
    for row in range(1, n - 1):
        if counts[row] > 0:
            for target in range(row, row + 3):
                wider[target] = max(wider[target], counts[row] + LANES)
            beside = min(counts[row - 1], counts[row + 1])
            inner[row] = max(min(counts[row], beside) - LANES, 0)
    larger = within(c, counts, wider)
    image = np.zeros_like(larger)
    alone = 1.0, 0.0, 0.0
    apply_sector(larger, wider, index, equation, alone, image, (0.0, 0.0), image)
    return norm_between(c, inner, counts) * norm_between(image, counts, wider)
