"""Radial functions suited to a potential, and the generator between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.dictionaries import KINDS
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.potentials.samples import digest_of_profile
from fpsolve.spectral.bases.essential import asymptotic_slope
from fpsolve.spectral.bases.orthogonal import (
    OrthonormalFamily,
    Shape,
    radial_rule,
    support,
)

__all__ = ["RadialBasis", "radial_basis", "shape_for", "smooth_in_square"]

SMOOTH = Shape(exponent=2.0)
KINKED = Shape(exponent=0.5)
# Eigenfunctions of a linear potential near the threshold grow like exp(B/2);
# polynomials times exp(0.4 B) then converge fast, and still do for those that decay.
GROWING = Shape(exponent=0.5, growth=0.4)
# Rules are made for degrees that are multiples of this one and used for all below.
STRIDE = 24
# Chebyshev coefficients of an analytic function have fallen to rounding by this degree.
CHEBYSHEV_DEGREE = 96
CHEBYSHEV_TAIL = 1e-12
# By how many functions of √r the harmonic 0 has fewer than the others.
MARGIN = 2


def shape_for(potential: Potential) -> Shape:
    """The kind of radial functions in which eigenfunctions converge fastest.

    Powers of r² where B is smooth on the plane, else powers of √r, which resolve what
    a kink of B leaves at the origin (terms like r ln r for B = ‖ξ‖); times exp(0.4 B)
    where B' is bounded.
    """
    if asymptotic_slope(potential) < np.inf:
        return GROWING
    return SMOOTH if smooth_in_square(potential) else KINKED


def smooth_in_square(potential: Potential) -> bool:
    """Whether B is a smooth function of r², so that it is smooth at the origin too.

    Known for powers; for a user's potential judged from the Chebyshev coefficients of
    B as a function of r² over half the radius of the support of exp(-B).
    """
    if isinstance(potential, QuadraticPotential):
        return True
    if isinstance(potential, PowerPotential):
        return potential.exponent % 2 == 0
    end = (0.5 * support(potential.radial_value, 0.0, 0)) ** 2

    def profile(x: Array) -> Array:
        return potential.radial_value(np.sqrt(0.5 * end * (1 + x)))

    coefficients = np.abs(Chebyshev.interpolate(profile, CHEBYSHEV_DEGREE).coef)
    tail = coefficients[3 * CHEBYSHEV_DEGREE // 4 :]
    return bool(np.max(tail) <= CHEBYSHEV_TAIL * np.max(coefficients))


class RadialBasis:
    """Orthonormal g_l,j(r) in L²(r exp(-B) dr), and L from the harmonic k to k + 1.

    Smooth B: r^|l| p(r²), degree at most N in r, as for Hermite functions. Others:
    r^min(|l|, 1) exp(θ B) p(√r), with 2N + 1 functions for l = 0 and 2N for others.
    Bases of lower degree are the first functions of those of higher degree.

    Parameters
    ----------
    potential : Potential
        Isotropic.
    degree : int
        Largest degree N that will be asked for.

    Raises
    ------
    ValueError
        If the potential grows more slowly than linearly.
    """

    def __init__(self, potential: Potential, degree: int) -> None:
        self.potential, self.degree = potential, degree
        self.shape = shape_for(potential)
        n = self.count(1, 0, degree)
        self.rule = radial_rule(
            potential.radial_value, potential.radial_derivative, self.shape, degree, n
        )
        self._families: dict[int, OrthonormalFamily] = {}
        self._products: dict[tuple[int, int], tuple[Array, Array, Array]] = {}

    @property
    def smooth(self) -> bool:
        """Whether the functions are r^|l| times polynomials in r²."""
        return self.shape.exponent == 2

    def power(self, angular: int) -> int:
        """m, the functions of the angular index l beginning like r^m."""
        return abs(angular) if self.smooth else min(abs(angular), 1)

    def count(self, k: int, angular: int, degree: int) -> int:
        """Number of functions of the harmonic k and the angular index l.

        Nothing damps the harmonic 0 but its coupling to the harmonics ±1. A function of
        it that the discrete coupling hardly sees would give a spurious eigenvalue near
        0. Derivatives of smooth functions are among the functions of the neighbours;
        those of functions of √r are not all, and the harmonic 0 is given fewer.
        """
        if self.smooth:
            return max(degree - abs(angular) + 2, 0) // 2
        return 2 * degree + (angular == 0) - (MARGIN if k == 0 else 0)

    def family(self, angular: int) -> OrthonormalFamily:
        """The functions of the angular index l."""
        power = self.power(angular)
        if power not in self._families:
            n = max(self.count(1, angular, self.degree), 1)
            self._families[power] = OrthonormalFamily(self.rule, self.shape, power, n)
        return self._families[power]

    def weighted(self, angular: int, degree: int) -> tuple[Array, Array]:
        """√weight g_l,j and √weight g_l,j' at the nodes of the rule."""
        family, n = self.family(angular), self.count(1, angular, degree)
        return family.values[:n], family.derivatives[:n]

    def evaluate(self, r: ArrayLike, angular: int, degree: int) -> tuple[Array, Array]:
        """g_l,j(r) and g_l,j'(r), each of shape (n, len(r)), for r > 0."""
        potential, n = self.potential, self.count(1, angular, degree)
        value, derivative = potential.radial_value, potential.radial_derivative
        return self.family(angular).evaluate(r, value, derivative, n)

    def raising(self, k: int, angular: int, degree: int) -> Array:
        """Matrix of g → ½ [g' + (l/r) g + k B' g] from (k, l) to (k + 1, l - 1).

        Shape (functions of l - 1, functions of l). The way back, ½ [g' - (l-1)/r g -
        (k+1) B' g], is its negative transpose, by integration by parts.
        """
        rows = self.count(k + 1, angular - 1, degree)
        columns = self.count(k, angular, degree)
        derivative, inverse, slope = self._product(angular)
        total = derivative + angular * inverse + k * slope
        return np.asarray(0.5 * total[:rows, :columns])

    def _product(self, angular: int) -> tuple[Array, Array, Array]:
        """⟨g_{l-1}, g_l'⟩, ⟨g_{l-1}, g_l/r⟩ and ⟨g_{l-1}, B' g_l⟩."""
        key = self.power(angular - 1), self.power(angular)
        if key not in self._products:
            image, source = self.family(angular - 1).values, self.family(angular)
            factors = (
                source.derivatives,
                source.values / self.rule.r,
                source.values * self.rule.slope,
            )
            first, second, third = (image @ factor.T for factor in factors)
            self._products[key] = first, second, third
        return self._products[key]


def radial_basis(potential: Potential, degree: int) -> RadialBasis:
    """The basis of a potential, shared by all noises and truncations.

    A user's potential is asked again whether it still computes the same: its functions
    may be the same objects, and what they refer to may have changed.

    Parameters
    ----------
    potential : Potential
        Isotropic.
    degree : int
        Degree that it must offer.
    """
    rounded = STRIDE * -(-max(degree, 1) // STRIDE)
    own = type(potential) not in KINDS.values()
    computes = digest_of_profile(potential) if own else ""
    return _shared_basis(_Key(potential, computes), rounded)


@dataclass(frozen=True)
class _Key:
    """A potential, and what it computes; hashable whatever the potential is."""

    potential: Potential
    computes: str

    def __hash__(self) -> int:
        return hash((type(self.potential), self.computes or self.potential))


@lru_cache(maxsize=6)
def _shared_basis(key: _Key, degree: int) -> RadialBasis:
    return RadialBasis(key.potential, degree)
