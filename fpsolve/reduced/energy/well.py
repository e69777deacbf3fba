"""The well of the motion without noise: circle, greatest energy, turning points."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.potential import Potential

__all__ = ["Well"]


# Radii between e^-60 and e^60 are searched for circles, twenty to a factor of e.
_REACH = 60.0
_N_PROBES = 2401
# Squares of energies down to e^{-300} are still numbers.
_DEEPEST = 300.0
# Turning points of so many energies at once are kept.
_MOST_KEPT = 10_000


class Well:
    """w(r) = r exp(-B(r)), which rises to g_max at the circle r B'(r) = 1 and falls.

    The deterministic motion (13) keeps G = w(r) sin β. In y = ln r its energy (14) is
    E = B(e^y) - y - ln sin β, so that the orbit of energy g lies where
    B(e^y) - y <= -ln g: between two turning points when that function has one minimum.

    Parameters
    ----------
    potential : Potential
        Isotropic.

    Raises
    ------
    TypeError
        If `potential` is not a Potential.
    ValueError
        If it is not isotropic, not normalisable, r B'(r) = 1 does not have exactly
        one solution, or energies are beyond the range of floats.

    References
    ----------
    [KMW09]_, equations (13) and (14).
    """

    def __init__(self, potential: Potential) -> None:
        if not isinstance(potential, Potential):
            raise TypeError(
                f"`potential` must be a Potential, got {potential!r}; wrap functions "
                "of r in IsotropicPotential."
            )
        if not potential.isotropic:
            raise ValueError(
                "`potential` must be isotropic for an energy process, got "
                f"{potential!r}; without symmetry the motion (13) does not close in "
                "(r, β)."
            )
        self.potential = potential
        self._bracket = self._only_crossing()
        if not potential.normalisable:
            raise ValueError(
                f"`potential` must be normalisable for an energy process, got "
                f"{potential!r}; choose one that grows with the distance."
            )
        if not abs(self.bottom) <= _DEEPEST:
            raise ValueError(
                "`potential` must be near zero at its minimum for an energy process, "
                f"got exp({-self.bottom:.4g}) for the largest energy r exp(-B); "
                "subtract the minimum of B."
            )

    def depth(self, y: Array) -> Array:
        """-ln w = B(e^y) - y."""
        return np.asarray(self.potential.radial_value(np.exp(y)) - y)

    def slope(self, y: Array) -> Array:
        """D(-ln w)/dy = r B'(r) - 1."""
        r = np.exp(y)
        return np.asarray(r * self.potential.radial_derivative(r) - 1.0)

    @cached_property
    def centre(self) -> float:
        """ln r of the circle."""
        from scipy.optimize.elementwise import find_root

        return float(find_root(self.slope, self._bracket).x)

    @property
    def radius(self) -> float:
        """R at which r B'(r) = 1, the fixed point of (13)."""
        return math.exp(self.centre)

    @cached_property
    def bottom(self) -> float:
        """-ln g_max, the least energy E."""
        return float(self.depth(np.array(self.centre)))

    @property
    def g_max(self) -> float:
        """W(r) at the circle, the largest |G|."""
        return math.exp(-self.bottom)

    def turning_points(self, e: Array) -> tuple[Array, Array]:
        """The two y with B(e^y) - y = e, left and right of the circle; e > bottom."""
        if e.size > _MOST_KEPT:
            return self._turning_points(e)
        return _kept_turning_points(self, e.shape, e.tobytes())

    def _turning_points(self, e: Array) -> tuple[Array, Array]:
        from scipy.optimize.elementwise import bracket_root, find_root

        def excess(y: Array, e: Array) -> Array:
            return self.depth(y) - e

        y = self.centre
        middle = np.full_like(e, y)
        # A steep wall overflows on the way to the bracket, to the right sign.
        with np.errstate(over="ignore"):
            before = bracket_root(excess, y - 0.1, middle, xmax=y, args=(e,)).bracket
            beyond = bracket_root(excess, middle, y + 0.1, xmin=y, args=(e,)).bracket
            ends = [find_root(excess, ends, args=(e,)).x for ends in (before, beyond)]
        return np.asarray(ends[0]), np.asarray(ends[1])

    def _only_crossing(self) -> tuple[float, float]:
        """Neighbouring probes between which r B' - 1 turns positive, for good."""
        y = np.linspace(-_REACH, _REACH, _N_PROBES)
        with np.errstate(over="ignore", invalid="ignore"):
            slope = self.slope(y)
        # Beyond the range of floats B only grows further.
        sign = np.where(np.isnan(slope), 1.0, np.sign(slope))
        turns = np.flatnonzero(np.diff(sign > 0))
        if len(turns) != 1 or sign[0] > 0:
            radii = ", ".join(f"{math.exp(y[i]):.3g}" for i in turns) or "none"
            raise ValueError(
                "`potential` must have a single well, r B'(r) = 1 at exactly one "
                f"radius, got {self.potential!r} with {radii}; the energy process "
                "needs orbits around one circle."
            )
        return float(y[turns[0]]), float(y[turns[0] + 1])


# Most of what an average over orbits costs; several averages are taken at the same
# energies, each the same for every noise.
@lru_cache(maxsize=64)
def _kept_turning_points(
    well: Well, shape: tuple[int, ...], energies: bytes
) -> tuple[Array, Array]:
    found = well._turning_points(np.frombuffer(energies).reshape(shape))
    for one in found:
        one.flags.writeable = False
    return found
