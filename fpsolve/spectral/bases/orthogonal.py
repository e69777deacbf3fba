"""Orthonormal functions of r for the weight r exp(-B), by discretised Stieltjes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array

__all__ = ["OrthonormalFamily", "RadialRule", "Shape", "radial_rule", "support"]

Profile = Callable[[Any], Array]

# Where r^(2 degree) times the weight has fallen by exp(-DROP), a polynomial of that
# degree has fallen by at least half of it: below 1e-17 of its largest value.
DROP = 80.0
# Radii that are tried: sixteen to the octave, over the range of lengths that potentials
# can have, 1e-75 to 1e75.
_RADII = np.exp2(np.arange(-256 * 16, 256 * 16) / 16)
# Gauss-Legendre nodes of a panel; 20 integrate polynomials of degree 39 exactly.
_PANEL = 20


@dataclass(frozen=True)
class Shape:
    """Functions w(r) p(r^γ), p a polynomial and w = r^m exp(θ B).

    Parameters
    ----------
    exponent : float
        γ: 2 for even functions (times r^m), ½ for those with a kink at the origin.
    growth : float
        θ, below ½: how the functions grow outwards where they do so exponentially.
    """

    exponent: float
    growth: float = 0.0


@dataclass(frozen=True)
class RadialRule:
    """∫ f r exp(-B) dr / ∫ r exp(-B) dr ≈ Σ weight f: composite Gauss-Legendre.

    Attributes
    ----------
    r : ndarray, shape (m,)
        Nodes, denser towards the origin like those of Gauss and Jacobi.
    log_weight : ndarray, shape (m,)
        Logarithms, because weights underflow where the functions do not.
    value, slope : ndarray, shape (m,)
        B and B' at the nodes.
    """

    r: Array
    log_weight: Array
    value: Array
    slope: Array


def support(value: Profile, growth: float, degree: int) -> float:
    """Radius beyond which w p with w = exp(θ B) and p of this degree is negligible.

    Raises
    ------
    ValueError
        If exp(-B) does not fall off fast enough for polynomials of this degree.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        envelope = (2 * degree + 2) * np.log(_RADII) - (1 - 2 * growth) * value(_RADII)
    envelope = np.where(np.isnan(envelope), -math.inf, envelope)
    # A factor 4 in the size of r^degree against that of the orthonormal polynomial.
    drop = DROP + 2 * math.log(4) * degree
    heavy = np.flatnonzero(envelope > np.max(envelope) - drop)
    if heavy[-1] + 1 == len(_RADII):
        raise ValueError(
            "`potential` must grow at least in proportion to ‖ξ‖ for a gap to exist "
            "and for polynomials to span the space; its exp(-B) falls off too slowly."
        )
    return float(_RADII[heavy[-1] + 1])


def radial_rule(
    value: Profile, derivative: Profile, shape: Shape, degree: int, n: int
) -> RadialRule:
    """A rule for products of n functions up to a degree in r.

    Panels in t = √r if that is the variable of the polynomials, else in r, graded
    like the zeros of orthogonal polynomials at a hard edge.
    """
    stretch = min(shape.exponent, 1.0)
    end = support(value, shape.growth, degree) ** stretch
    n_panels = 12 + n // 5
    edges = end * (1 - np.cos(0.5 * math.pi * np.linspace(0, 1, n_panels + 1)))
    x, w = leggauss(_PANEL)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    t = (middle[:, None] + half[:, None] * x).ravel()
    r = t ** (1 / stretch)
    log_weight = np.log((half[:, None] * w).ravel()) + (2 / stretch - 1) * np.log(t)
    log_weight = log_weight - value(r)
    shift = np.max(log_weight)
    log_weight -= shift + math.log(np.sum(np.exp(log_weight - shift)))
    return RadialRule(r, log_weight, value(r), derivative(r))


class OrthonormalFamily:
    """φ_j(r) = r^m exp(θ B) p_j(r^γ), orthonormal for the weight r exp(-B).

    The polynomials come from the three-term recurrence of the discrete measure of a
    rule (Stieltjes), which loses nothing as long as the rule has several times more
    nodes than functions are asked for; orthonormality is tested to 1e-12.

    Parameters
    ----------
    rule : RadialRule
    shape : Shape
    power : int
        m >= 0.
    n : int
        Number of functions.

    Attributes
    ----------
    values, derivatives : ndarray, shape (n, nodes)
        √weight φ_j and √weight φ_j' at the nodes of the rule: products of rows are
        integrals.

    References
    ----------
    [Gautschi04]_, sections 2.2 and 2.1.8.
    """

    def __init__(self, rule: RadialRule, shape: Shape, power: int, n: int) -> None:
        self.shape, self.power = shape, power
        r = rule.r
        exponent = shape.growth * rule.value + power * np.log(r)
        start = exponent + 0.5 * rule.log_weight
        self.log_norm = float(np.max(start))
        first = np.exp(start - self.log_norm)
        size = math.sqrt(float(first @ first))
        self.log_norm += math.log(size)
        # In units of the largest radius the recurrence is of order one.
        self.unit = float(r[-1])
        slope = shape.growth * rule.slope + power / r
        self.diagonal, self.lower = np.zeros(n), np.zeros(n)
        self.values, self.derivatives = np.zeros((2, n, len(r)))
        self.values[0], self.derivatives[0] = first / size, slope * first / size
        x = (r / self.unit) ** shape.exponent
        self._stieltjes(x, shape.exponent * x / r)

    def _stieltjes(self, x: Array, x_slope: Array) -> None:
        """Fill the recurrence and the functions, one after the other."""
        values, derivatives = self.values, self.derivatives
        for j in range(len(values) - 1):
            self.diagonal[j] = (x * values[j]) @ values[j]
            centred = x - self.diagonal[j]
            value = centred * values[j]
            derivative = centred * derivatives[j] + x_slope * values[j]
            if j:
                value -= self.lower[j] * values[j - 1]
                derivative -= self.lower[j] * derivatives[j - 1]
            self.lower[j + 1] = math.sqrt(float(value @ value))
            values[j + 1] = value / self.lower[j + 1]
            derivatives[j + 1] = derivative / self.lower[j + 1]

    def evaluate(
        self, r: ArrayLike, value: Profile, derivative: Profile, n: int
    ) -> tuple[Array, Array]:
        """φ_j and φ_j' for j < n at radii r > 0, shape (n, len(r)).

        Parameters
        ----------
        r : array_like, shape (m,)
        value, derivative : callable
            B and B'.
        n : int
            At most the number of functions of the family.
        """
        r = np.asarray(r, dtype=np.float64)
        log_first = self.power * np.log(r) - self.log_norm
        slope = self.power / r
        if self.shape.growth:
            log_first = log_first + self.shape.growth * value(r)
            slope = slope + self.shape.growth * derivative(r)
        x = (r / self.unit) ** self.shape.exponent
        x_slope = self.shape.exponent * x / r
        values, derivatives = np.zeros((2, max(n, 1), len(r)))
        values[0] = np.exp(log_first)
        derivatives[0] = slope * values[0]
        for j in range(n - 1):
            centred, scale = x - self.diagonal[j], 1 / self.lower[j + 1]
            values[j + 1] = scale * centred * values[j]
            derivatives[j + 1] = scale * (
                centred * derivatives[j] + x_slope * values[j]
            )
            if j:
                back = scale * self.lower[j]
                values[j + 1] -= back * values[j - 1]
                derivatives[j + 1] -= back * derivatives[j - 1]
        return values[:n], derivatives[:n]
