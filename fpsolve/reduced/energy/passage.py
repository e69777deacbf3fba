"""Expected times until the energy reaches a target, and what happens on the way."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebpts1, chebvander
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.checks import check_energies

__all__ = ["Passage"]

Function = Callable[[Array], Array]

# Intervals that shrink to both ends by this ratio, down to 1e-14 of g_max, and the
# degree on each.
_RATIO, _N_INTERVALS, _DEGREE = 0.25, 23, 24
_NODES = chebpts1(_DEGREE + 1)
# From values at the nodes to Chebyshev coefficients.
_TO_COEFFICIENTS = np.linalg.inv(chebvander(_NODES, _DEGREE)).T


class Passage:
    """τ, the first arclength at which |G| equals a target, from (15).

    V(g) = E_g ∫ f(G) ds up to τ solves (A²/2S)(J V')' = -f with V(target) = 0, so that
    V = (2/A²) ∫ J⁻¹ ∫ f S: from 0 upwards when the fibre starts below the target (no
    flux at 0), from g_max downwards when it starts above (the circle is never
    reached). Relative errors are about 1e-11 where f is smooth.

    Parameters
    ----------
    averages : OrbitAverages
    noise : float
        A > 0.
    target : float
        0 <= target <= g_max. The time to reach g_max is infinite; reaching 0 means
        that the loops change their direction.

    Raises
    ------
    ValueError
        If the target lies outside.

    Notes
    -----
    Backward Kolmogorov equation of (15) with the closed form of its coefficients;
    [KMW09]_, section 3.1.2, names such functionals.
    """

    def __init__(self, averages: OrbitAverages, noise: float, target: float) -> None:
        self.averages, self.noise = averages, noise
        target = check_real("target", target)
        self.target = float(check_energies("target", target, averages.well.g_max))

    def mean(self, g: ArrayLike) -> Array:
        """E τ from energies g in [0, g_max]; scales like A⁻²."""
        return self._evaluate(lambda: self._mean, g)

    def variance(self, g: ArrayLike) -> Array:
        """Var τ from energies g: the second moment solves the same with f = 2 E τ.

        Infinite where the mean is.
        """
        second, mean = self._evaluate(lambda: self._second, g), self.mean(g)
        finite = np.isfinite(mean)
        return np.asarray(second - np.where(finite, mean, 0.0) ** 2)

    def expected(self, f: Function, g: ArrayLike) -> Array:
        """E ∫ f(G) ds up to τ; infinite from below the target g_max.

        Parameters
        ----------
        f : callable
            Of an array of energies in [0, g_max], elementwise, smooth.
        g : array_like
            Energies at the start.
        """
        return self._evaluate(lambda: self._solved(f), g)

    def occupation(self, low: float, high: float, g: ArrayLike) -> Array:
        """Expected length with low < |G| < high before τ.

        Raises
        ------
        ValueError
            If the interval is not one in [0, g_max].
        """
        ends = check_energies("interval", [low, high], self.averages.well.g_max)
        if not ends[0] < ends[1]:
            raise ValueError(
                f"`low` must be below `high`, got {low:g} and {high:g}; swap them."
            )

        def inside(x: Array) -> Array:
            return np.asarray((ends[0] < x) & (x < ends[1]), dtype=np.float64)

        breaks = float(ends[0]), float(ends[1])
        return self._evaluate(lambda: self._solved(inside, breaks), g)

    def _evaluate(
        self, solve: Callable[[], tuple[Piecewise, Piecewise]], g: ArrayLike
    ) -> Array:
        energies = check_energies("g", g, self.averages.well.g_max)
        if self.target == self.averages.well.g_max:
            return np.asarray(np.where(energies < self.target, math.inf, 0.0))
        below, above = solve()
        out = np.where(energies < self.target, below(energies), above(energies))
        return np.asarray(np.where(energies == self.target, 0.0, out))

    @cached_property
    def _mean(self) -> tuple[Piecewise, Piecewise]:
        return self._solved(np.ones_like)

    @cached_property
    def _second(self) -> tuple[Piecewise, Piecewise]:
        return self._solved(lambda g: 2.0 * self.mean(g))

    def _solved(
        self, f: Function, breaks: tuple[float, ...] = ()
    ) -> tuple[Piecewise, Piecewise]:
        """V below and above the target."""
        g_max = self.averages.well.g_max
        faces = np.unique([*_both_ends(g_max), self.target, *breaks])
        below, above = faces[faces <= self.target], faces[faces >= self.target]
        return self._side(f, below, upwards=True), self._side(f, above, upwards=False)

    def _side(self, f: Function, faces: Array, upwards: bool) -> Piecewise:
        def weighted(g: Array) -> Array:
            return np.asarray(f(g) * self.averages.period(g))

        if len(faces) < 2:
            return Piecewise(faces, [])
        content = Piecewise.integral(weighted, faces, from_left=upwards)

        def slope(g: Array) -> Array:
            # Both vanish at g_max, where their ratio tends to f/g_max.
            action, top = self.averages.action(g), f(g) / self.averages.well.g_max
            return np.divide(content(g), action, out=top, where=action > 0)

        rise = Piecewise.integral(slope, faces, from_left=not upwards)
        return rise.scaled(2.0 / self.noise**2)


class Piecewise:
    """A continuous function of polynomials between faces."""

    def __init__(self, faces: Array, pieces: list[Chebyshev]) -> None:
        self.faces, self.pieces = faces, pieces

    @classmethod
    def integral(cls, f: Function, faces: Array, from_left: bool) -> Piecewise:
        """∫ f from the left end to g, or from g to the right end."""
        low, high = faces[:-1, None], faces[1:, None]
        values = f((low + (high - low) * (_NODES + 1.0) / 2).ravel())
        coefficients = values.reshape(-1, _DEGREE + 1) @ _TO_COEFFICIENTS
        pieces = [
            Chebyshev(c, domain=ends)
            for c, ends in zip(coefficients, pairwise(faces), strict=True)
        ]
        return cls(faces, _joined(pieces, from_left))

    def scaled(self, factor: float) -> Piecewise:
        """The function times a number."""
        return Piecewise(self.faces, [factor * piece for piece in self.pieces])

    def __call__(self, g: Array) -> Array:
        """Values at g; NaN outside the faces."""
        out = np.full(np.shape(g), math.nan)
        for (low, high), piece in zip(pairwise(self.faces), self.pieces, strict=True):
            here = (low <= g) & (g <= high)
            out[here] = piece(np.asarray(g)[here])
        return out


def _joined(pieces: list[Chebyshev], from_left: bool) -> list[Chebyshev]:
    """Antiderivatives that continue each other, zero at the end they begin with."""
    joined: list[Chebyshev] = []
    total = 0.0
    for piece in pieces if from_left else reversed(pieces):
        low, high = piece.domain
        grown = piece.integ(lbnd=low) if from_left else -piece.integ(lbnd=high)
        joined.append(grown + total)
        total = float(joined[-1](high if from_left else low))
    return joined if from_left else joined[::-1]


def _both_ends(g_max: float) -> Array:
    """Faces in [0, g_max] that crowd at 0 and at g_max."""
    share = 0.5 * _RATIO ** np.arange(_N_INTERVALS)
    return g_max * np.concatenate([[0.0], share[::-1], 1.0 - share[1:], [1.0]])
