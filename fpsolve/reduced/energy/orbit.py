"""One orbit of the motion without noise, over a period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.reduced.energy.well import Well

__all__ = ["Orbit", "orbit_of"]


_TOLERANCE = 1e-12


@dataclass(frozen=True, eq=False)
class Orbit:
    """(r, β, φ) along one period of (13), begun at r_min with φ = 0.

    Attributes
    ----------
    g : float
        Energy, G = r exp(-B(r)) sin β along the whole orbit.
    s : ndarray, shape (n,)
        Arclength, from 0 to the period, equidistant.
    r, beta, phi : ndarray, shape (n,)
        Distance, angle between fibre and radius, and polar angle, in radians. With
        g > 0 the fibre runs counter-clockwise, 0 < β < π.
    """

    g: float
    s: Array
    r: Array
    beta: Array
    phi: Array

    @property
    def xi(self) -> Array:
        """(ξ1, ξ2), shape (n, 2): the rosette of the fibre on a belt at rest."""
        direction = np.column_stack([np.cos(self.phi), np.sin(self.phi)])
        return np.asarray(self.r[:, None] * direction)

    @property
    def alpha(self) -> Array:
        """Angle of the fibre, β + φ, in radians and not wrapped."""
        return self.beta + self.phi


def orbit_of(well: Well, g: float, period: float, n_points: int) -> Orbit:
    """Integrate (13) in the canonical coordinates ln r and z = ln tan(β/2).

    In them no right-hand side is singular: dr/ds = -tanh z, dz/ds = B'(r) - 1/r,
    dφ/ds = 1/(r cosh z). Order 8, relative tolerance 1e-12.
    """
    from scipy.integrate import solve_ivp

    def velocity(s: float, state: Array) -> list[float]:
        r, z = np.exp(state[0]), state[1]
        pull = float(well.potential.radial_derivative(r))
        return [-np.tanh(z) / r, pull - 1.0 / r, 1.0 / (r * np.cosh(z))]

    sign = 1.0 if g > 0 else -1.0
    s = np.linspace(0.0, period, n_points)
    if abs(g) >= well.g_max:
        # Nothing moves but φ, and an adaptive step would have no scale.
        still = np.ones(n_points)
        r, beta = well.radius * still, sign * np.pi / 2 * still
        return Orbit(g, s, r, beta, sign * s / well.radius)
    left, _ = well.turning_points(-np.log(np.array([abs(g)])))
    with np.errstate(over="ignore"):
        found = solve_ivp(
            velocity, (0.0, period), [left[0], 0.0, 0.0], method="DOP853", t_eval=s,
            rtol=_TOLERANCE, atol=_TOLERANCE,
        )  # fmt: skip
    beta = 2.0 * np.arctan(np.exp(found.y[1]))
    return Orbit(g, s, np.exp(found.y[0]), sign * beta, sign * found.y[2])
