"""A curve known at some points only."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import told_apart
from fpsolve.model.curves.curve import Curve, check_speed

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

__all__ = ["TabulatedCurve"]

# How far outside the table, relative to its length, counts as rounding of its ends.
_ROUNDING = 1e-9


@dataclass(frozen=True, repr=False)
class TabulatedCurve(Curve):
    """γ(s) through given points, a cubic spline (not-a-knot) between them.

    The error of the spline is of fourth order in the spacing of the table, that of
    its velocity of third. `speed` is the mean belt speed
    (γ1(s_0) - γ1(s_n))/(s_n - s_0).

    Parameters
    ----------
    s : array_like, shape (n,)
        Arclengths, strictly increasing, at least two.
    gamma1, gamma2 : array_like, shape (n,)
        Positions along and across the belt.

    Raises
    ------
    ValueError
        If the table is ragged, too short, not finite or not increasing, or if its mean
        speed is not below one; later, when the curve is asked outside the table.
        `solve` and `sample_paths` refuse a run that leaves it before they begin.
    """

    s: tuple[float, ...]
    gamma1: tuple[float, ...]
    gamma2: tuple[float, ...]
    speed: float = field(init=False, compare=False)

    kind: ClassVar[str] = "tabulated_curve"

    def __init__(self, s: ArrayLike, gamma1: ArrayLike, gamma2: ArrayLike) -> None:
        columns = {"s": s, "gamma1": gamma1, "gamma2": gamma2}
        for name, column in _checked_columns(columns).items():
            # Tuples make equality, hashing and JSON work as for the other curves.
            object.__setattr__(self, name, tuple(column.tolist()))
        travelled = self.gamma1[0] - self.gamma1[-1]
        speed = check_speed("speed", travelled / (self.s[-1] - self.s[0]))
        object.__setattr__(self, "speed", speed)

    def position(self, s: ArrayLike) -> tuple[Array, Array]:
        """(γ1(s), γ2(s)) of the spline."""
        return self._components(self._spline, s)

    def velocity(self, s: ArrayLike) -> tuple[Array, Array]:
        """(γ1'(s), γ2'(s)) of the spline; 0 for every s if all points are the same."""
        if self.fixed:
            return np.zeros(np.shape(s)), np.zeros(np.shape(s))
        return self._components(self._spline_derivative, s)

    def displacement(self, s0: float, s1: float) -> tuple[float, float]:
        """γ(s1) - γ(s0), exact to the rounding of the tabulated positions.

        0 for every s if all points are the same.
        """
        if self.fixed:
            return 0.0, 0.0
        (begin1, begin2), (end1, end2) = self.position(s0), self.position(s1)
        return float(end1 - begin1), float(end2 - begin2)

    def check_span(self, start: float, end: float) -> None:
        """Raise ValueError unless the table covers [start, end], up to rounding."""
        if not np.all(self._covered(np.array([start, end]))):
            first, last, *run = told_apart(self.s[0], self.s[-1], start, end)
            raise ValueError(
                f"`curve` must be known from s = {run[0]} to {run[1]}, where the run "
                f"goes, got a table from {first} to {last}; extend the table, or move "
                "the run into it."
            )

    @property
    def autonomous(self) -> bool:
        """Whether all points are the same; a straight line is not recognised."""
        return self.fixed

    @property
    def fixed(self) -> bool:
        """Whether all points are the same."""
        return self._still

    @property
    def formula(self) -> str:
        """γ(s) as plain text."""
        return f"cubic spline through {len(self.s)} points"

    @property
    def latex(self) -> str:
        """γ(s) as LaTeX."""
        return rf"\text{{{self.formula}}}"

    def to_dict(self) -> dict[str, Any]:
        """Return `kind` and the table as a JSON-able dictionary."""
        table = {"s": self.s, "gamma1": self.gamma1, "gamma2": self.gamma2}
        return {"kind": self.kind, **{name: list(c) for name, c in table.items()}}

    def __repr__(self) -> str:
        ends = f"s from {self.s[0]:g} to {self.s[-1]:g}"
        return f"TabulatedCurve(<{len(self.s)} points, {ends}>)"

    @cached_property
    def _still(self) -> bool:
        return len(set(self.gamma1)) == 1 and len(set(self.gamma2)) == 1

    @cached_property
    def _spline(self) -> CubicSpline:
        from scipy.interpolate import CubicSpline

        points = np.column_stack([self.gamma1, self.gamma2])
        return CubicSpline(self.s, points)

    @cached_property
    def _spline_derivative(self) -> Any:
        return self._spline.derivative()

    def _components(self, spline: Any, s: ArrayLike) -> tuple[Array, Array]:
        values = spline(self._checked_arclength(s))
        return np.array(values[..., 0]), np.array(values[..., 1])

    def _checked_arclength(self, s: ArrayLike) -> Array:
        arclength = check_numbers("s", s)
        inside = self._covered(arclength)
        if not np.all(inside):
            outside = float(arclength[~inside].flat[0])
            first, last, got = told_apart(self.s[0], self.s[-1], outside)
            raise ValueError(
                f"`s` must lie in the table, which covers [{first}, {last}], got "
                f"{got}; extend the table."
            )
        return arclength

    def _covered(self, s: Array) -> NDArray[np.bool_]:
        first, last = self.s[0], self.s[-1]
        slack = _ROUNDING * (last - first)
        return (s >= first - slack) & (s <= last + slack)


def _checked_columns(columns: dict[str, ArrayLike]) -> dict[str, Array]:
    arrays = {name: check_numbers(name, c) for name, c in columns.items()}
    n = arrays["s"].size
    for name, array in arrays.items():
        if array.shape != (n,) or n < 2:
            raise ValueError(
                f"`{name}` must have the shape (n,) of `s` with n >= 2, got "
                f"{array.shape}."
            )
        if not np.all(np.isfinite(array)):
            raise ValueError(f"`{name}` must be finite, got NaN or infinity in it.")
    if not np.all(np.diff(arrays["s"]) > 0):
        raise ValueError("`s` must be strictly increasing, got a table that is not.")
    return arrays
