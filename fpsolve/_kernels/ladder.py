"""The forward equation (9) in the ladder basis: one pass over the coefficients.

p/p_S = Σ i^j d[i, j, k] He_i(ξ₁/σ₁) He_j(ξ₂/σ₂) e^{ikα}, normalised in L²(μ). The
factor i^j makes the equation real; only k ≥ 0 is kept, because p is real:
d[i, j, −k] = (−1)^j conj d[i, j, k]. Arrays are (n + 2, n + 2, 2 m + 4) for degrees
i + j ≤ n and harmonics k ≤ m, real and imaginary parts side by side; limit[i + j] is
the last harmonic kept at a degree, and everything outside is zero.
"""

import numpy as np

from fpsolve._kernels.compiling import njit


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def apply_ladder(c, limit, numbers, recurrence, previous, weight, total):
    """previous ← a L*c + b c + e previous; then total += weight · previous.

    The operator is truncated to `limit`; numbers (1/σ₁, 1/σ₂, diffusivity, belt);
    recurrence (a, b, e).
    """
    scale1, scale2, diffusivity, belt = numbers
    a, b, e = recurrence
    degree = limit.shape[0] - 1
    harmonic = np.empty(c.shape[2])
    for m in range(c.shape[2]):
        harmonic[m] = m // 2
    for i in range(degree + 1):
        up1, down1 = scale1 * np.sqrt(i + 1.0), scale1 * np.sqrt(i * 1.0)
        low1 = max(i - 1, 0)
        for j in range(degree + 1 - i):
            last = limit[i + j]
            if last < 0:
                continue
            up2, down2 = scale2 * np.sqrt(j + 1.0), scale2 * np.sqrt(j * 1.0)
            here, out, sums = c[i, j], previous[i, j], total[i, j]
            high1, high2 = c[i + 1, j], c[i, j + 1]
            less1, less2 = c[low1, j], c[i, max(j - 1, 0)]
            drift = belt * down1
            # No harmonic: real for even j, imaginary for odd j.
            m = j % 2
            change = down1 * less1[m + 2] + down2 * less2[m + 2] + drift * less1[m]
            out[m] = a * change + b * here[m] + e * out[m]
            sums[m] += weight * out[m]
            for m in range(2, 2 * last + 2):
                k = harmonic[m]
                change = (
                    up1 * k * (high1[m + 2] - high1[m - 2])
                    - up2 * k * (high2[m - 2] + high2[m + 2])
                    + (k + 1.0) * (down1 * less1[m + 2] + down2 * less2[m + 2])
                    - (k - 1.0) * (down1 * less1[m - 2] - down2 * less2[m - 2])
                )
                rest = drift * less1[m] - diffusivity * k * k * here[m]
                value = a * (0.5 * change + rest) + b * here[m] + e * out[m]
                out[m] = value
                sums[m] += weight * value


@njit(cache=True, error_model="numpy")
def shell_energies(c, limit, out):
    """out[n, k] = Σ_{i+j=n} |d[i, j, ±k]|²; out (n + 1, m + 1)."""
    degree = limit.shape[0] - 1
    for n in range(degree + 1):
        for k in range(out.shape[1]):
            out[n, k] = 0.0
        for i in range(n + 1):
            row = c[i, n - i]
            for k in range(limit[n] + 1):
                share = 1.0 if k == 0 else 2.0
                out[n, k] += share * (row[2 * k] ** 2 + row[2 * k + 1] ** 2)
