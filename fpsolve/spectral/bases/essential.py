"""Where the essential spectrum of the generator begins, for B that grows linearly."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import mathieu_a

from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential

__all__ = ["asymptotic_slope", "essential_threshold"]

# B' is compared at these radii; a slope that changes by less than one per cent between
# them has a limit (that of r^1.001 changes by 1.4 %).
_FAR = np.exp2([20.0, 40.0])
_SAME = 0.01


def asymptotic_slope(potential: Potential) -> float:
    """lim B'(r) as r → ∞ of an isotropic potential: 0 <= K <= inf.

    Known for the linear potential. For others judged from B' at r = 2^20 and 2^40: a
    slope that has settled there is the limit, one that grows is taken as unbounded and
    one that falls as 0.

    Parameters
    ----------
    potential : Potential
        Isotropic.
    """
    if isinstance(potential, LinearPotential):
        return potential.slope
    with np.errstate(over="ignore", invalid="ignore"):
        near, far = map(float, potential.radial_derivative(_FAR))
    if not math.isfinite(far) or far > (1 + _SAME) * near:
        return math.inf
    return far if far >= (1 - _SAME) * near else 0.0


def essential_threshold(
    slope: float, noise: float, parity: int | None = None
) -> float | None:
    """-(A²/2) [a₀(q) + 2q], q = K²/(4A⁴): top of the essential spectrum, or None.

    Where B' → K, far out the generator acts in polar coordinates, β = α - φ, as
    cos β ∂_r + K sin β ∂_β + (A²/2) ∂_ββ, for every angular index. Waves exp(κ r) with
    Re κ = K/2, at the edge of L²(r exp(-K r) dr), give approximate eigenfunctions for
    the eigenvalues of

        C(κ) = κ cos β + K sin β ∂_β + (A²/2) ∂_ββ   on the circle,

    which therefore belong to the spectrum. By the formula of Feynman and Kac their real
    parts are largest for real κ. There C is symmetric for the weight
    exp(-(2K/A²) cos β), and multiplied by the root of the weight it becomes for
    κ = K/2 the operator of Mathieu,

        (A²/2) ∂_ββ - (K²/2A²) sin²β,

    whose top eigenvalue is the number above, a₀ the characteristic value. On functions
    odd in β, the sector M = 0 odd, a₁ takes the place of a₀. Large noise:
    -(K²/4A²) + K⁴/(64A⁶); small noise: -K/2 + A²/8.

    Parameters
    ----------
    slope : float
        K = lim B'. None is returned for K = ∞: then there is no essential spectrum.
        For K = 0 it reaches 0 and there is no gap.
    noise : float
        A > 0.
    parity : int, optional
        -1 for the sector M = 0 odd.

    References
    ----------
    [DLMF]_, section 28.2.
    """
    if math.isinf(slope):
        return None
    q = 0.25 * slope**2 / noise**4
    order = 1 if parity == -1 else 0
    # 0.0 - keeps a threshold of zero from printing as -0.
    return 0.0 - 0.5 * noise**2 * (float(mathieu_a(order, q)) + 2 * q)
