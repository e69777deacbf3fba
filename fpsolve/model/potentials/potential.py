"""What every potential offers, and what follows from a radial profile alone."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import fields
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_positive
from fpsolve.model.potentials.claims import check_isotropy
from fpsolve.model.potentials.partition import Normalisation, normalisation_of
from fpsolve.model.potentials.wells import check_places

__all__ = ["Potential", "RadialPotential", "check_length"]

# Relative error that the quadrature may have where B is rough, and a user's digits.
_AGREES = 1e-6
# e^{±700} is about the range of floats.
_SMALLEST_LOGARITHM, _LARGEST_LOGARITHM = -700.0, 700.0
# Squares of lengths are areas, and their products with others still numbers.
_SHORTEST, _LONGEST = 1e-75, 1e75
# What must agree with the closed forms of a class: of Z, spectra, samples and limits.
_COMPUTED = ("value", "gradient", "radial_value", "radial_derivative")


def _has_closed_forms(kind: type) -> bool:
    """Whether a class is one of fpsolve that knows its Z."""
    own = kind.__module__.startswith("fpsolve.") and kind.__name__ != "Potential"
    return own and "partition_function" in vars(kind)


def _defines_z(kind: type) -> type:
    """The class of which Z is: itself or a parent."""
    return next(one for one in kind.__mro__ if "partition_function" in vars(one))


class Potential(ABC):
    """A buckling potential B(ξ) on the plane.

    B enters the model through -∇B(ξ)·τ⊥(α), equation (6), which turns the fibre back
    to the reference curve, and through the stationary density exp(-B)/(2π Z),
    equation (10). Everything is dimensionless.

    A new potential is a frozen dataclass that defines `value`, `gradient`, `formula`
    and `latex`, and `kind` if it is to be stored; `partition_function` then comes from
    quadrature, unless it is defined too. Quadrature finds wells that are wide enough,
    or that B leads to; `well_places` tells it of others. A class that is derived from
    one with closed forms, such as `QuadraticPotential`, and has other values raises
    TypeError when it is defined.

    References
    ----------
    [KMW09]_, section 3.1, equations (6) and (10).
    """

    kind: ClassVar[str] = "custom"

    def __init_subclass__(cls, **options: Any) -> None:
        """Refuse other values under the closed forms of a class of fpsolve."""
        super().__init_subclass__(**options)
        own = [name for name in _COMPUTED if name in vars(cls)]
        parent = next((one for one in cls.__mro__[1:] if _has_closed_forms(one)), None)
        if own and parent is not None:
            raise TypeError(
                f"`{cls.__name__}` must be derived from Potential to have its own "
                f"`{own[0]}`, got {parent.__name__} as its parent, whose closed forms "
                "would be used with it."
            )

    @abstractmethod
    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """B(ξ1, ξ2), float64, in the broadcast shape of the arguments."""

    @abstractmethod
    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """(∂B/∂ξ1, ∂B/∂ξ2), two float64 arrays in the broadcast shape."""

    @property
    @abstractmethod
    def formula(self) -> str:
        """B as plain text with the actual parameters, for instance "(ξ₁² + ξ₂²)/2"."""

    @property
    @abstractmethod
    def latex(self) -> str:
        """B as LaTeX with the actual parameters, without dollar signs."""

    @property
    def isotropic(self) -> bool:
        """Whether B depends on ‖ξ‖ only."""
        return False

    @property
    def well_places(self) -> ArrayLike:
        """Places [(ξ1, ξ2), ...] of wells that are too narrow to be found; none.

        To be defined where a well in flat surroundings is narrower than about a
        thirtieth of its distance from the origin: Z is then too small without it. The
        place may miss its lowest point by a few widths, as long as B is below its
        surroundings there.
        """
        return ()

    def radial_value(self, r: ArrayLike) -> Array:
        """B(r) of an isotropic potential, r >= 0; ValueError when it is not one."""
        self._require_isotropic()
        return self.value(r, 0.0)

    def radial_derivative(self, r: ArrayLike) -> Array:
        """B'(r) of an isotropic potential, r >= 0; ValueError when it is not one."""
        self._require_isotropic()
        return self.gradient(r, 0.0)[0]

    @cached_property
    def partition_function(self) -> float:
        """Z = ∫ exp(-B(ξ)) dξ over the plane; `math.inf` when it does not exist.

        ValueError when it exists but is too large or too small for a float: B is then
        far from zero at its minimum, and `log_partition_function` tells.
        """
        if not self.normalisable:
            return math.inf
        logarithm = self.log_partition_function
        if not _SMALLEST_LOGARITHM <= logarithm <= _LARGEST_LOGARITHM:
            raise ValueError(
                "`partition_function` must be within the range of floats, got "
                f"exp({logarithm:g}); subtract the minimum of B, or use "
                "`log_partition_function`."
            )
        return math.exp(logarithm)

    @property
    def log_partition_function(self) -> float:
        """ln Z, which no constant added to B can make overflow."""
        return self.normalisation.log_value

    @cached_property
    def normalisation(self) -> Normalisation:
        """Z = e^{-lowest} · integral with its relative error; see `Normalisation`.

        What is computed from e^{-B} uses e^{lowest - B} over the integral.

        Raises
        ------
        ValueError
            If B is NaN somewhere, or too rough for the quadrature, or if a class that
            is not one of fpsolve defines a `partition_function` that is another, or
            says that it is isotropic and is not.
        """
        if self.has_closed_form:
            found = Normalisation(0.0, self.partition_function)
            if not _defines_z(type(self)).__module__.startswith("fpsolve."):
                self._check_own_integral(found.integral)
        else:
            found = self.resolved_normalisation
        if self.isotropic and not self.of_fpsolve:
            finite = math.isfinite(found.integral)
            check_isotropy(self.value, math.sqrt(found.integral) if finite else 1.0)
        return found

    def _check_own_integral(self, given: float) -> None:
        """Raise ValueError unless Z as defined by a user's class is that of its B."""
        if given != math.inf:
            check_positive("partition_function", given)
        try:
            found = self._by_quadrature(given)
        except ValueError:
            # Too rough for the quadrature, which has no opinion then.
            return
        away = abs(math.log(given) - found.log_value)
        if math.isfinite(found.integral) and not away <= _AGREES + found.error:
            raise ValueError(
                f"`partition_function` must be the integral of exp(-B), got {given:g} "
                f"where quadrature gives exp({found.log_value:.10g}); leave it to the "
                "quadrature, or define `well_places` if that misses a narrow well."
            )

    @cached_property
    def resolved_normalisation(self) -> Normalisation:
        """The same by quadrature, with the cells that resolve e^{-B}."""
        if not self.has_closed_form or not self.normalisable:
            return self._by_quadrature(math.inf)
        return self._by_quadrature(self.normalisation.integral)

    def _by_quadrature(self, area: float) -> Normalisation:
        """Z and its cells, in units in which the known size of the pattern is one."""
        if not 0 < area < math.inf:
            return normalisation_of(self.value, self.isotropic, self._places())
        # The size of the pattern is known, however small or large.
        length = math.sqrt(area / (2 * math.pi))

        def value(xi1: ArrayLike, xi2: ArrayLike) -> Array:
            return self.value(np.multiply(length, xi1), np.multiply(length, xi2))

        places = self._places() / length
        return normalisation_of(value, self.isotropic, places).scaled(length)

    def _places(self) -> Array:
        return check_places("well_places", self.well_places)

    @property
    def of_fpsolve(self) -> bool:
        """Whether the class is one of fpsolve, not a user's."""
        return type(self).__module__.startswith("fpsolve.")

    @property
    def has_closed_form(self) -> bool:
        """Whether the class defines Z, which is then not looked for."""
        return type(self).partition_function is not Potential.partition_function

    @property
    def normalisable(self) -> bool:
        """Whether exp(-B) is integrable over the plane."""
        return math.isfinite(self.normalisation.integral)

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the parameters as a JSON-able dictionary."""
        parameters = {
            field.name: getattr(self, field.name)
            for field in fields(self)  # type: ignore[arg-type]
        }
        return {"kind": self.kind, **parameters}

    def _repr_latex_(self) -> str:
        return f"$B(\\xi) = {self.latex}$"

    def _require_isotropic(self) -> None:
        if not self.isotropic:
            raise ValueError(
                f"`potential` must be isotropic to have a radial profile, got {self!r}."
            )


class RadialPotential(Potential):
    """An isotropic potential B(‖ξ‖), given by its radial profile.

    Subclasses define `radial_value` and `radial_derivative`. The gradient is
    B'(r) ξ/r; at the origin, where ξ/r has no limit, it is defined as 0.
    """

    @property
    def isotropic(self) -> bool:
        """True."""
        return True

    @abstractmethod
    def radial_value(self, r: ArrayLike) -> Array:
        """B(r), r >= 0."""

    @abstractmethod
    def radial_derivative(self, r: ArrayLike) -> Array:
        """B'(r), r >= 0; at 0 the limit from the right."""

    def value(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """B(‖ξ‖), float64, in the broadcast shape of the arguments."""
        xi1, xi2 = check_numbers("xi1", xi1), check_numbers("xi2", xi2)
        return self.radial_value(np.hypot(xi1, xi2))

    def gradient(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """B'(r) ξ/r, and 0 at the origin; two arrays in the broadcast shape."""
        xi1, xi2 = check_numbers("xi1", xi1), check_numbers("xi2", xi2)
        r = np.hypot(xi1, xi2)
        # A profile may be singular at 0, so it is not asked there at all.
        safe_r = np.where(r > 0, r, 1.0)
        ratio = np.where(r > 0, self.radial_derivative(safe_r) / safe_r, 0.0)
        return np.asarray(ratio * xi1), np.asarray(ratio * xi2)


def check_length(name: str, value: Any) -> float:
    """Return a length (or its inverse) as a float; ValueError unless of some size."""
    length = check_positive(name, value)
    if not _SHORTEST <= length <= _LONGEST:
        raise ValueError(
            f"`{name}` must lie between {_SHORTEST:g} and {_LONGEST:g}, got "
            f"{length:g}; lengths are in units of the throwing range."
        )
    return length
