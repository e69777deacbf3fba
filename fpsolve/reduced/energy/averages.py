"""Integrals over the orbit of energy g: period, action and enclosed measure."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_answers, check_finite_numbers
from fpsolve.reduced.energy.well import Well

__all__ = ["OrbitAverages"]

Function = Callable[[Array], Array]
# Of w = r exp(-B), g/w and √(1 - g²/w²).
Integrand = Callable[[Array, Array, Array], Array]
# Of r and β.
OfOrbit = Callable[[Array, Array], ArrayLike]

# Gauss points on either side of the circle: doubling them changes no integral by more
# than 1e-12 (tests/reduced/test_energy_process.py).
_N_POINTS = 96
# δ, in units of ln r: how closely the points look at the circle.
_SCALE = 0.1
# Left of the circle every integrand carries a factor r: what lies this far in ln r is
# below rounding.
_NEGLIGIBLE_DEPTH = 45.0
# e^-700 is the smallest g whose orbit is told from that of g = 0.
_LARGEST_ENERGY = 700.0
_SMALLEST = 1e-300
# On orbits less deep than this, energy differences are integrals of the slope: the
# difference of two energies of order one loses the digits of a short orbit.
_SHALLOW = 0.25
_N_SLOPES = 16
# Next to the circle, for u = 1 - g/g_max below this, even the slope loses its digits,
# and the period is read off an interpolating polynomial in u: it is analytic there. The
# degree grows until the last coefficients are as small as rounding at the nodes; 7 is
# enough but for wells that are nearly flat.
_NEAR_THE_CIRCLE = 2e-3
_DEGREES = (7, 15, 31, 63, 127)
_LAST_COEFFICIENT = 1e-11

_FRACTIONS = (leggauss(_N_SLOPES)[0] + 1.0) / 2
_FRACTION_WEIGHTS = leggauss(_N_SLOPES)[1] / 2


class OrbitAverages:
    """S(g), J(g), N(g) of the orbits inside one well, to about 1e-12.

    With w = r exp(-B) and r between the turning points,
    S = 2 ∫ w/√(w² - g²) dr (period), J = 2 ∫ w √(w² - g²) dr (action),
    N = 2 ∫ w arccos(g/w) dr (measure of the orbits of greater energy), so that
    J' = -g S and N' = -S. The substitution ln r = ln R ± δ sinh(κ cos θ) on either
    side of the circle R, 0 < θ < π/2, removes the singularities at the turning points
    (θ = 0) and crowds points at the circle when a side is much longer than δ. The
    accuracy is that of Gauss points on a smooth integrand, for a smooth potential.

    Parameters
    ----------
    well : Well
    n_points : int
        Gauss points on either side of the circle.
    """

    def __init__(self, well: Well, n_points: int = _N_POINTS) -> None:
        self.well = well
        nodes, weights = leggauss(n_points)
        self._theta = (nodes + 1.0) * (math.pi / 4)
        self._weights = weights * (math.pi / 4)

    def period(self, g: Array) -> Array:
        """S(g) for 0 <= g <= g_max; infinite at 0, finite at the circle."""
        return self._piecewise(g, self._period_near_circle, self._period)

    def action(self, g: Array) -> Array:
        """J(g) for 0 <= g <= g_max; 0 at the circle, with full relative accuracy."""
        return self._piecewise(g, self._action_near_circle, self._action)

    def measure(self, g: Array) -> Array:
        """N(g) = ∫ S from g to g_max; N(0) = π ∫ r exp(-B) dr."""
        return self._piecewise(g, self._measure_near_circle, self._measure)

    def mean(self, f: OfOrbit, g: Array) -> Array:
        """⟨f⟩(g), the average of f(r, β) over ds for 0 < |g| < g_max, shape (n,).

        ds = dr/cos β = r dy/√(1 - g²/w²); the orbit passes every r twice, on its way
        out (cos β > 0) and back.
        """
        e = -np.log(np.abs(g))
        left, right = self.well.turning_points(e)
        start = np.maximum(left, self.well.centre - _NEGLIGIBLE_DEPTH)
        total, period = np.zeros(g.shape), np.zeros(g.shape)
        for end in (start, right):
            y, _, ratio, root, weights = self._nodes(e, end)
            r, sine = np.exp(y), np.sign(g)[:, None] * ratio
            out, back = (
                observed(f, r, np.arctan2(sine, cosine)) for cosine in (root, -root)
            )
            ds = weights * r / root
            total += (0.5 * (out + back) * ds).sum(axis=1)
            period += ds.sum(axis=1)
        return np.asarray(total / period)

    @cached_property
    def total(self) -> float:
        """N(0), the measure of all orbits with g > 0."""
        return float(self.measure(np.array(0.0)))

    @property
    def steepness(self) -> int:
        """How often the degree of S next to the circle was doubled; 0 is usual."""
        return _DEGREES.index(self._period_near_circle.degree())

    def _piecewise(self, g: Array, near: Function, far: Function) -> Array:
        u = 1.0 - g / self.well.g_max
        out = np.empty(np.shape(g))
        close = u <= _NEAR_THE_CIRCLE
        out[close] = near(u[close])
        out[~close] = far(g[~close])
        return out

    # -- away from the circle ------------------------------------------------------

    def _period(self, g: Array) -> Array:
        total = np.full(g.shape, math.inf)
        total[g > 0] = self._integral(g[g > 0], lambda w, ratio, root: 1.0 / root)
        return total

    def _action(self, g: Array) -> Array:
        return self._integral(g, lambda w, ratio, root: w**2 * root)

    def _measure(self, g: Array) -> Array:
        # arccos(g/w) as an arctangent, which keeps its digits at both ends.
        return self._integral(g, lambda w, ratio, root: w * np.arctan2(root, ratio))

    def _integral(self, g: Array, integrand: Integrand) -> Array:
        """2 ∫ f(w, g/w, √(1 - g²/w²)) r dy over both sides of the circle."""
        with np.errstate(divide="ignore"):
            e = np.minimum(-np.log(g), _LARGEST_ENERGY)
        left, right = self.well.turning_points(e)
        start = np.maximum(left, self.well.centre - _NEGLIGIBLE_DEPTH)
        return 2.0 * (self._side(e, start, integrand) + self._side(e, right, integrand))

    def _side(self, e: Array, end: Array, integrand: Integrand) -> Array:
        """∫ f r dy between one turning point and the circle."""
        y, depth, ratio, root, weights = self._nodes(e, end)
        values = integrand(np.exp(-depth), ratio, root) * np.exp(y)
        return np.asarray((values * weights).sum(axis=1))

    def _nodes(self, e: Array, end: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Ln r, -ln w, g/w, √(1 - g²/w²) at the nodes of one side, and dy."""
        length, way, weights = self._points(end)
        y = end[:, None] + length * way
        depth = self.well.depth(y)
        difference = e[:, None] - depth
        shallow = e < self.well.bottom + _SHALLOW
        difference[shallow] = self._rise(y[shallow], -(length * way)[shallow])
        # Rounding can make the difference vanish next to the end.
        difference = np.maximum(difference, _SMALLEST)
        ratio, root = np.exp(-difference), np.sqrt(-np.expm1(-2.0 * difference))
        return y, depth, ratio, root, weights

    def _rise(self, y: Array, way: Array) -> Array:
        """Energy at y + way minus that at y, by the mean of the slope in between."""
        places = y[..., None] + way[..., None] * _FRACTIONS
        return np.asarray(way * (self.well.slope(places) @ _FRACTION_WEIGHTS))

    def _points(self, end: Array) -> tuple[Array, Array, Array]:
        """Length from the ends to the circle, shares of it at the nodes, weights."""
        length = (self.well.centre - end)[:, None]
        bend = np.maximum(np.arcsinh(np.abs(length) / _SCALE), _SMALLEST)
        cosine = np.cos(self._theta)
        # (sinh κ - sinh(κ cos θ))/sinh κ, without the difference.
        rise = np.sinh(bend * np.sin(self._theta / 2) ** 2)
        way = 2.0 * np.cosh(bend * (1.0 + cosine) / 2) * rise / np.sinh(bend)
        slope = bend * np.sin(self._theta) * np.cosh(bend * cosine) / np.sinh(bend)
        return length, way, np.abs(length) * slope * self._weights

    # -- next to the circle --------------------------------------------------------

    @cached_property
    def _period_near_circle(self) -> Chebyshev:
        """S as a polynomial in u = 1 - g/g_max."""
        g_max = self.well.g_max
        for degree in _DEGREES:
            found = _interpolated(lambda u: self._period(g_max * (1.0 - u)), degree)
            size = np.abs(found.coef)
            if size[-2:].max() < _LAST_COEFFICIENT * size[0]:
                break
        return found

    def _measure_near_circle(self, u: Array) -> Array:
        return np.asarray(self.well.g_max * u * self._mean_period(u))

    def _action_near_circle(self, u: Array) -> Array:
        return np.asarray(self.well.g_max**2 * u * self._mean_of_energy_times_period(u))

    @cached_property
    def _mean_period(self) -> Chebyshev:
        return _running_mean(self._period_near_circle)

    @cached_property
    def _mean_of_energy_times_period(self) -> Chebyshev:
        # g/g_max = 1 - u on the same domain.
        half = _NEAR_THE_CIRCLE / 2
        energy = Chebyshev([1.0 - half, -half], domain=[0.0, _NEAR_THE_CIRCLE])
        return _running_mean(energy * self._period_near_circle)


def _running_mean(f: Chebyshev) -> Chebyshev:
    """(1/u) ∫ f from 0 to u, which keeps the digits of the integral next to 0."""
    integral = f.integ(lbnd=0.0)
    return _interpolated(lambda u: integral(u) / u, f.degree())


def _interpolated(f: Function, degree: int) -> Chebyshev:
    return Chebyshev.interpolate(f, degree, domain=[0.0, _NEAR_THE_CIRCLE])


def observed(f: OfOrbit, r: Array, beta: Array) -> Array:
    """Values of f on the orbits; ValueError unless elementwise and finite."""
    values = check_finite_numbers("f", check_answers("f", f(r, beta)))
    if values.shape not in ((), r.shape):
        raise ValueError(
            f"`f` must work elementwise, got shape {values.shape} for arguments of "
            f"shape {r.shape}."
        )
    return values
