"""Coefficients of the averaged equation, and the orbits they are averages over."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_call, check_integer, check_noise, check_real
from fpsolve.model.potentials.potential import Potential
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.checks import check_energies
from fpsolve.reduced.energy.orbit import Orbit, orbit_of
from fpsolve.reduced.energy.well import Well

__all__ = ["Coefficients"]


_MOST_POINTS = 10**7


class Coefficients:
    """a(g) = -A²g/2, σ²(g) = A² J(g)/S(g) and the stationary density S(g)/∫S.

    What `EnergyProcess` knows in closed form, integrals over an orbit aside.

    Parameters
    ----------
    potential : Potential
    noise : float

    References
    ----------
    [KMW09]_, section 3.1.2, equations (13) to (15).
    """

    def __init__(self, potential: Potential, noise: float) -> None:
        self.noise = check_noise(
            "noise", noise, "; without noise the energy does not change"
        )
        self._averages = OrbitAverages(Well(potential))

    @property
    def potential(self) -> Potential:
        """Buckling potential B."""
        return self._averages.well.potential

    @property
    def radius(self) -> float:
        """Radius of the circle, where r B'(r) = 1."""
        return self._averages.well.radius

    @property
    def g_max(self) -> float:
        """Largest |G|, r exp(-B(r)) at the circle; exp(-B(1)) when B'(1) = 1."""
        return self._averages.well.g_max

    def energy(self, xi1: ArrayLike, xi2: ArrayLike, alpha: ArrayLike) -> Array:
        """G(ξ, α) = exp(-B(ξ)) (ξ1 sin α - ξ2 cos α), in the broadcast shape."""
        x, y = np.asarray(xi1, dtype=np.float64), np.asarray(xi2, dtype=np.float64)
        weight = np.exp(-self.potential.value(x, y))
        return np.asarray(weight * (x * np.sin(alpha) - y * np.cos(alpha)))

    def turning_points(self, g: ArrayLike) -> tuple[Array, Array]:
        """r_min(g) and r_max(g), the roots of r exp(-B) = |g|; 0 and ∞ for g = 0.

        Raises
        ------
        ValueError
            If an energy lies outside [-g_max, g_max].
        """
        size = np.abs(check_energies("g", g, self.g_max, signed=True))
        inner, outer = np.zeros(np.shape(size)), np.full(np.shape(size), math.inf)
        top, inside = size >= self.g_max, (size > 0) & (size < self.g_max)
        inner[top] = outer[top] = self.radius
        ends = self._averages.well.turning_points(-np.log(size[inside]))
        inner[inside], outer[inside] = np.exp(ends[0]), np.exp(ends[1])
        return inner, outer

    def orbit(self, g: float, n_points: int = 201) -> Orbit:
        """The orbit (13) of energy g over one period, equidistant in s.

        Raises
        ------
        ValueError
            If g = 0, whose orbit goes to infinity and never comes back, or g lies
            outside [-g_max, g_max].
        """
        n_points = check_integer("n_points", n_points, 2, _MOST_POINTS)
        energy = float(check_energies("g", check_real("g", g), self.g_max, signed=True))
        if energy == 0:
            raise ValueError(
                "`g` must not be 0 for an orbit, got 0: the fibre runs straight out "
                "through the origin; choose an energy between 0 and `g_max`."
            )
        period = float(self.period(energy))
        return orbit_of(self._averages.well, energy, period, n_points)

    def orbit_average(
        self, f: Callable[[Array, Array], ArrayLike], g: ArrayLike
    ) -> Array:
        """⟨f⟩(g): the average of f(r, β) over the arclength of the orbit of energy g.

        Parameters
        ----------
        f : callable
            f(r, β), elementwise on arrays of one shape, smooth.
        g : array_like
            Energies, 0 < |g| < g_max.

        Raises
        ------
        ValueError
            If an energy is 0, or lies outside (-g_max, g_max).

        References
        ----------
        [KMW09]_, below equation (15).
        """
        energies = check_energies("g", g, self.g_max, signed=True)
        size = np.abs(energies)
        if not ((size > 0) & (size < self.g_max)).all():
            raise ValueError(
                "`g` must be neither 0 nor ±g_max for an average over an orbit, got "
                f"{energies[(size == 0) | (size >= self.g_max)].flat[0]:g}; at ±g_max "
                "the orbit is one point (r, β)."
            )
        check_call("f", f, "f(r, beta)")
        means = self._averages.mean(f, energies.ravel())
        return means.reshape(energies.shape)

    def period(self, g: ArrayLike) -> Array:
        """S(g) = 2 ∫ w/√(w² - g²) dr, w = r exp(-B): arclength of one orbit.

        Even in g. S(0) is infinite (it grows like the largest distance, slower than
        any power where B grows faster than a logarithm), S(±g_max) is
        2π R/√(1 + R² B''(R)) at the circle. Relative error about 1e-12 for smooth B.

        Raises
        ------
        ValueError
            If an energy lies outside [-g_max, g_max].
        """
        return self._even(self._averages.period, g)

    def action(self, g: ArrayLike) -> Array:
        """J(g) = 2 ∫ w √(w² - g²) dr = g² ∮ cot²β ds, with J' = -g S.

        Even in g; J(0) = 2 ∫ w² dr, J(±g_max) = 0. Relative error about 1e-12; next
        to g_max that of g_max - |g|. ValueError as for `period`.
        """
        return self._even(self._averages.action, g)

    def variance(self, g: ArrayLike) -> Array:
        """σ²(g) = A² J(g)/S(g) = A² g² ⟨cot²β⟩, per unit of s.

        Even in g; at most A² (g_max² - g²), zero at 0, like 1/S, and at ±g_max,
        linearly. ValueError as for `period`.
        """
        return np.asarray(self.noise**2 * self.action(g) / self.period(g))

    def drift(self, g: ArrayLike) -> Array:
        """-(A²/2) g, per unit of s, exactly. ValueError as for `period`."""
        energies = check_energies("g", g, self.g_max, signed=True)
        return np.asarray(-0.5 * self.noise**2 * energies)

    def stationary_density(self, g: ArrayLike, signed: bool = False) -> Array:
        """S(g)/∫S on (0, g_max), or half of that on (-g_max, g_max).

        ∫ S = π ∫ r exp(-B) dr from 0 to ∞, which is π when B is |ξ| or |ξ|²/2.
        Independent of A. ValueError as for `period`.
        """
        energies = check_energies("g", g, self.g_max, signed=signed)
        total = self._averages.total * (2 if signed else 1)
        return np.asarray(self.period(energies) / total)

    def stationary_distribution(self, g: ArrayLike, signed: bool = False) -> Array:
        """P(|G| <= g) in the stationary law, or P(G <= g). ValueError as before."""
        energies = check_energies("g", g, self.g_max, signed=signed)
        below = 1.0 - self._averages.measure(np.abs(energies)) / self._averages.total
        return np.asarray(0.5 + 0.5 * np.sign(energies) * below if signed else below)

    def _even(self, function: Callable[[Array], Array], g: ArrayLike) -> Array:
        energies = check_energies("g", g, self.g_max, signed=True)
        return np.asarray(function(np.asarray(np.abs(energies))))
