"""Potentials made of a user's own functions, checked when they are built."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers, check_numbers
from fpsolve.model.potentials.potential import Potential, RadialPotential
from fpsolve.model.potentials.probes import (
    check_plane_functions,
    check_radial_functions,
)
from fpsolve.model.potentials.wells import check_places

__all__ = ["CallablePotential", "IsotropicPotential"]

Places = tuple[tuple[float, float], ...]


class _OfFunctions(Potential):
    """A potential of functions, which no closed form or file can hold."""

    kind: ClassVar[str] = "callable"

    _well_places: Places

    @property
    def well_places(self) -> Places:
        """Where wells are said to be."""
        return self._well_places

    def to_dict(self) -> dict[str, Any]:
        """Return a description, which `potential_from_dict` refuses."""
        return {"kind": self.kind, "description": repr(self)}


@dataclass(frozen=True, init=False, repr=False)
class IsotropicPotential(_OfFunctions, RadialPotential):
    """B(‖ξ‖) from two functions of r, the profile and its derivative.

    The gradient at the origin is defined as 0, and `derivative` is not called there.
    Z comes from quadrature. It can be described in a file, but not read back. Equal
    when the functions are the same objects.

    Parameters
    ----------
    value, derivative : callable
        B(r) and B'(r) for an array of r >= 0, elementwise.
    well_radii : sequence of float, optional
        Radii of rings in which B is low and which are narrower than about a
        five-hundredth of their radius; see `Potential.well_places`.

    Raises
    ------
    TypeError
        If an argument is not callable, or does not return real numbers.
    ValueError
        If a function is not elementwise, not finite at the probe radii, or if
        `derivative` is not the derivative of `value` there.
    """

    _value: Callable[[Any], ArrayLike]
    _derivative: Callable[[Any], ArrayLike]
    _well_places: Places

    formula = "B(‖ξ‖)"
    latex = r"B(\|\xi\|)"

    def __init__(
        self,
        value: Callable[[Any], ArrayLike],
        derivative: Callable[[Any], ArrayLike],
        *,
        well_radii: ArrayLike = (),
    ) -> None:
        check_radial_functions(value, derivative)
        radii = check_finite_numbers("well_radii", well_radii).ravel()
        object.__setattr__(self, "_value", value)
        object.__setattr__(self, "_derivative", derivative)
        places = np.stack([radii, np.zeros_like(radii)], axis=1)
        object.__setattr__(self, "_well_places", _pairs("well_radii", places))

    def radial_value(self, r: ArrayLike) -> Array:
        """B(r)."""
        return _as_float(self._value, check_numbers("r", r))

    def radial_derivative(self, r: ArrayLike) -> Array:
        """B'(r)."""
        return _as_float(self._derivative, check_numbers("r", r))

    def __repr__(self) -> str:
        functions = f"value={_name(self._value)}, derivative={_name(self._derivative)}"
        radii = [radius for radius, _ in self._well_places]
        functions += f", well_radii={radii}" if radii else ""
        return f"IsotropicPotential({functions})"


@dataclass(frozen=True, init=False, repr=False)
class CallablePotential(_OfFunctions):
    """B(ξ1, ξ2) from two functions on the plane, the value and its gradient.

    Z comes from quadrature. It can be described in a file, but not read back. Equal
    when the functions are the same objects.

    Parameters
    ----------
    value : callable
        ``value(xi1, xi2)`` gives B, elementwise on arrays that broadcast.
    gradient : callable
        ``gradient(xi1, xi2)`` gives the pair (∂B/∂ξ1, ∂B/∂ξ2), likewise.
    well_places : sequence of pairs, optional
        (ξ1, ξ2) in wells that are narrower than about a thirtieth of their distance
        from the origin; see `Potential.well_places`.

    Raises
    ------
    TypeError
        If an argument is not callable, or does not return real numbers.
    ValueError
        If a function is not elementwise, not finite at the probe points, or if
        `gradient` is not the gradient of `value` there.
    """

    _value: Callable[[Any, Any], ArrayLike]
    _gradient: Callable[[Any, Any], tuple[ArrayLike, ArrayLike]]
    _well_places: Places

    formula = "B(ξ)"
    latex = r"B(\xi)"

    def __init__(
        self,
        value: Callable[[Any, Any], ArrayLike],
        gradient: Callable[[Any, Any], tuple[ArrayLike, ArrayLike]],
        *,
        well_places: ArrayLike = (),
    ) -> None:
        check_plane_functions(value, gradient)
        object.__setattr__(self, "_value", value)
        object.__setattr__(self, "_gradient", gradient)
        object.__setattr__(self, "_well_places", _pairs("well_places", well_places))

    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """B(ξ1, ξ2), float64, in the broadcast shape of the arguments."""
        return _as_float(self._value, *_coordinates(xi1, xi2))

    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """(∂B/∂ξ1, ∂B/∂ξ2), two float64 arrays in the broadcast shape."""
        xi1, xi2 = _coordinates(xi1, xi2)
        shape = np.broadcast_shapes(np.shape(xi1), np.shape(xi2))
        slope1, slope2 = self._gradient(*_arrays(xi1, xi2))
        return _filled(slope1, shape), _filled(slope2, shape)

    def __repr__(self) -> str:
        functions = f"value={_name(self._value)}, gradient={_name(self._gradient)}"
        places = list(self._well_places)
        functions += f", well_places={places}" if places else ""
        return f"CallablePotential({functions})"


def _coordinates(xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, ...]:
    return check_numbers("xi1", xi1), check_numbers("xi2", xi2)


def _pairs(name: str, places: ArrayLike) -> Places:
    return tuple((float(xi1), float(xi2)) for xi1, xi2 in check_places(name, places))


def _array(values: ArrayLike) -> Array:
    return np.asarray(values, dtype=np.float64)


def _arrays(*coordinates: ArrayLike) -> tuple[Array, ...]:
    # Of one shape, as when the functions were probed: one that stacks its arguments,
    # or returns ∇B as one array, works on the plane too.
    shape = np.broadcast_shapes(*map(np.shape, coordinates))
    return tuple(np.broadcast_to(_array(values), shape) for values in coordinates)


def _filled(values: ArrayLike, shape: tuple[int, ...]) -> Array:
    # A user's function may return a constant where the formula has no variable.
    return np.array(np.broadcast_to(_array(values), shape))


def _as_float(function: Callable[..., ArrayLike], *coordinates: ArrayLike) -> Array:
    shape = np.broadcast_shapes(*map(np.shape, coordinates))
    return _filled(function(*_arrays(*coordinates)), shape)


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__qualname__", repr(function))
