"""Functions on phase space to average along a path, and their exact mean under μ."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import cubature

from fpsolve._support.arrays import Array
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.arguments import check_functions

__all__ = [
    "Circulation",
    "EquilibriumMoments",
    "Observable",
    "core",
    "default_observables",
    "direction",
    "equilibrium_moments",
    "functions_of",
    "position",
    "square",
]

# f(xi1, xi2, alpha), elementwise.
Observable = Callable[..., Any]

# Angles of the periodic trapezoidal rule, and what the adaptive rule in ξ aims at and
# must reach, relative to E f²; a jump in f stops it early.
_N_ANGLES = 64
_ERROR_AIMED_AT = 1e-9
_ERROR_ALLOWED = 1e-5
_N_SUBDIVISIONS = 500
_QUADRANTS = ((1, 1), (-1, 1), (1, -1), (-1, -1))
# Below this share of E f² a variance is rounding: f is constant.
_CONSTANT = 1e-12


def position(xi1: Array, xi2: Array, alpha: Array) -> Array:
    """ξ₁: odd, so that its average also sees whether the pattern lies centred."""
    return xi1


def square(xi1: Array, xi2: Array, alpha: Array) -> Array:
    """‖ξ‖², the width of the pattern."""
    return np.asarray(xi1 * xi1 + xi2 * xi2)


def core(xi1: Array, xi2: Array, alpha: Array) -> Array:
    """exp(−‖ξ‖²/2), a smooth indicator of the middle of the pattern."""
    return np.asarray(np.exp(-0.5 * (xi1 * xi1 + xi2 * xi2)))


def direction(xi1: Array, xi2: Array, alpha: Array) -> Array:
    """cos α = dξ₁/ds, so that its average is (ξ₁(s) − ξ₁(0))/s exactly."""
    return np.asarray(np.cos(alpha))


@dataclass(frozen=True)
class Circulation:
    """G(ξ, α) = e^{−B(ξ)} (ξ₁ sin α − ξ₂ cos α), B counted from its lowest value.

    For isotropic B an eigenfunction, L G = −(A²/2) G: the autocorrelation of G along
    a path from μ is Var(G) e^{−A²s/2}, whatever the potential.
    """

    potential: Potential

    def __call__(self, xi1: Array, xi2: Array, alpha: Array) -> Array:
        """Return G, elementwise."""
        moment = xi1 * np.sin(alpha) - xi2 * np.cos(alpha)
        lowest = self.potential.normalisation.lowest
        return np.asarray(np.exp(lowest - self.potential.value(xi1, xi2)) * moment)


def default_observables(potential: Potential) -> dict[str, Observable]:
    """ξ₁, ‖ξ‖², exp(−‖ξ‖²/2), cos α and the circulation G, by name."""
    return {
        "position": position,
        "square": square,
        "core": core,
        "direction": direction,
        "circulation": Circulation(potential),
    }


def functions_of(functions: Any, potential: Potential) -> dict[str, Observable]:
    """The functions by name, checked; `default_observables` for None."""
    if functions is None:
        return default_observables(potential)
    return check_functions(functions)


@dataclass(frozen=True)
class EquilibriumMoments:
    """Mean and standard deviation under μ of each function, in their order."""

    mean: Array
    deviation: Array


def equilibrium_moments(
    potential: Potential, functions: Mapping[str, Observable]
) -> EquilibriumMoments:
    """E f and ‖f − E f‖ under μ = e^{−B}/(2π Z) by quadrature, not from a sample.

    The trapezoidal rule with 64 angles in α, exact for trigonometric polynomials, and
    adaptive Gauss-Kronrod rules in the four quadrants of the ξ plane.

    Parameters
    ----------
    potential : Potential
        With normalisable exp(-B).
    functions : mapping of str to callable
        f(xi1, xi2, alpha), elementwise.

    Raises
    ------
    ValueError
        If a function is not elementwise, not finite, constant, or too rough for the
        quadrature.
    """
    integrals = _integrals(potential, functions)
    normalisation = integrals[0]
    mean, mean_square = integrals[1:].reshape(-1, 2).T / normalisation
    variance = mean_square - mean**2
    for name, value, scale in zip(functions, variance, mean_square, strict=True):
        if not value > _CONSTANT * scale:
            raise ValueError(
                f"`functions['{name}']` must vary over phase space, got a variance of "
                f"{value:.3g}."
            )
    return EquilibriumMoments(mean, np.sqrt(variance))


def _integrals(potential: Potential, functions: Mapping[str, Observable]) -> Array:
    """∫ e^{−B} (1, f, f², …)/Z over the plane, the mean over α."""
    # The rules for infinite ranges expect lengths of about one.
    normalisation = potential.normalisation
    length = math.sqrt(normalisation.integral / math.tau)
    angles = (np.arange(_N_ANGLES) + 0.5) * (math.tau / _N_ANGLES)

    def quadrant(xi1: Array, xi2: Array) -> Array:
        columns = [np.ones(len(xi1))]
        for name, function in functions.items():
            values = _elementwise(name, function(xi1, xi2, angles), len(xi1))
            columns += [values.mean(axis=1), np.square(values).mean(axis=1)]
            _require_finite(name, columns[-1])
        with np.errstate(under="ignore"):
            # Integrals are then relative to Z, as length² 2π is the integral.
            weight = np.exp(normalisation.lowest - potential.value(xi1, xi2)) / math.tau
            return np.asarray(weight * np.stack(columns, axis=1))

    def integrand(points: Array) -> Array:
        xi1, xi2 = length * points[:, :1], length * points[:, 1:]
        # Potentials often have a kink on the axes, where the plane is folded here.
        # (scipy 1.17 also integrates (−∞, 0] as if it were [0, ∞).)
        return sum(
            (quadrant(sign1 * xi1, sign2 * xi2) for sign1, sign2 in _QUADRANTS),
            start=np.zeros(1),
        )

    found = cubature(
        integrand, [0.0, 0.0], [math.inf, math.inf], rtol=_ERROR_AIMED_AT,
        atol=_ERROR_AIMED_AT, max_subdivisions=_N_SUBDIVISIONS,
    )  # fmt: skip
    _require_whole(potential, float(found.estimate[0]))
    _require_accurate(functions, found.estimate, found.error)
    return np.asarray(found.estimate)


def _elementwise(name: str, values: Any, n_points: int) -> Array:
    """Values at all points and angles."""
    shape = (n_points, _N_ANGLES)
    try:
        return np.broadcast_to(np.asarray(values, dtype=np.float64), shape)
    except ValueError:
        raise ValueError(
            f"`functions['{name}']` must work elementwise, got shape "
            f"{np.shape(values)} for arguments that broadcast to {shape}."
        ) from None


def _require_finite(name: str, squares: Array) -> None:
    if not np.all(np.isfinite(squares)):
        raise ValueError(
            f"`functions['{name}']` must be finite on all of phase space, got "
            f"{squares[~np.isfinite(squares)][0]:g} for its square."
        )


def _require_whole(potential: Potential, total: float) -> None:
    """The nodes are placed around the origin; wells far out may lie between them."""
    if not abs(total - 1.0) <= _ERROR_ALLOWED:
        raise ValueError(
            f"`potential` must have its wells near the origin to be integrated, got "
            f"{total:.6g} of exp(-B)/Z with {potential!r}; move the origin."
        )


def _require_accurate(
    functions: Mapping[str, Observable], total: Array, error: Array
) -> None:
    scale = np.maximum(np.abs(total[2::2]), np.finfo(float).tiny)
    worst = np.maximum(error[2::2], error[1::2] ** 2 / total[0]) / scale
    for name, relative in zip(functions, worst, strict=True):
        if not relative <= _ERROR_ALLOWED:
            raise ValueError(
                f"`functions['{name}']` must allow to integrate its square against "
                f"exp(-B), got a relative error of {relative:.2g}; smooth its jumps."
            )
