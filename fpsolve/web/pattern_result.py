"""The mean pattern of a web: its waves along and across the belt, with their errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_integer, check_non_negative
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.web.pattern_harmonics import Complex
from fpsolve.web.pattern_layout import PATTERN

__all__ = ["MeanPattern"]

# Points of the pattern for every wave that is resolved.
POINTS = 2
# Waves may go either way.
FARTHEST = -(2**31)


@dataclass(frozen=True, eq=False, repr=False)
class MeanPattern(Saved):
    """Expected length of fibre per area, E m(x) = Σ c_nm e^{i(k₁x₁ + k₂x₂)}/(v d).

    x₁ goes along the belt and with it, x₂ across it, with the first nozzle at 0. The
    pattern is repeated with the period L = 2π|v/ω| along the belt and with the distance
    of nozzles of the same phase across it: k₁ = 2πn/L, k₂ = 2πm/width.

    Attributes
    ----------
    width, length : float
        Of one cell of the pattern, across and along the belt.
    spacing : float
        d.
    mean : float
        1/(|v| d).
    coefficients : ndarray of complex, shape (2 n1 + 1, 2 n2 + 1)
        c_nm for −n1 ≤ n ≤ n1, −n2 ≤ m ≤ n2: those that the cells of the state resolve.
        c_00 = 1.
    errors : ndarray, shape (2 n1 + 1, 2 n2 + 1)
        What |c_nm| may be off.
    phases : str or tuple of float
        As asked for.
    call : Call or None
        How it was made, and how the state was of which it is.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "mean-pattern"
    layout = PATTERN

    length: float
    width: float
    spacing: float
    mean: float
    coefficients: Complex = field(repr=False)
    errors: Array = field(repr=False)
    phases: str | tuple[float, ...]
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        waves = (
            (self.machine_amplitudes, self.machine_errors),
            (self.cross_amplitudes, self.cross_errors),
        )
        along, across = (
            f"{sizes.max():.3g} ± {errors[sizes.argmax()]:.1g}"
            if sizes.size
            else "none"
            for sizes, errors in waves
        )
        return (
            f"MeanPattern({self.length:.6g} × {self.width:.6g}, largest wave along the "
            f"belt {along}, across it {across})"
        )

    def amplitude(self, n: int, m: int) -> tuple[float, float]:
        """2|c_nm|, of the wave e^{i(k₁x₁ + k₂x₂)} relative to the mean; its error.

        Parameters
        ----------
        n, m : int
            Waves per cell along and across the belt, not both 0.

        Raises
        ------
        ValueError
            If the cells of the state do not resolve such a wave.
        """
        n, m = (
            int(check_integer(name, one, FARTHEST))
            for name, one in (("n", n), ("m", m))
        )
        middle1, middle2 = (size // 2 for size in self.coefficients.shape)
        if abs(n) > middle1 or abs(m) > middle2 or n == m == 0:
            raise ValueError(
                f"`n` and `m` must be at most {middle1} and {middle2} in size and not "
                f"both 0, got {n} and {m}; the cells of a finer grid resolve more."
            )
        at = (middle1 + n, middle2 + m)
        return 2.0 * float(np.abs(self.coefficients[at])), 2.0 * float(self.errors[at])

    @property
    def machine_amplitudes(self) -> Array:
        """2|c_n0|, n = 1, 2, …: waves along the belt, alike at every x₂."""
        return np.asarray(2.0 * np.abs(along_the_belt(self.coefficients)))

    @property
    def machine_errors(self) -> Array:
        """Errors of `machine_amplitudes`."""
        return np.asarray(2.0 * along_the_belt(self.errors))

    @property
    def cross_amplitudes(self) -> Array:
        """2|c_0m|, m = 1, 2, …: strips along the belt, waves of the cross profile."""
        return np.asarray(2.0 * np.abs(across_the_belt(self.coefficients)))

    @property
    def cross_errors(self) -> Array:
        """Errors of `cross_amplitudes`."""
        return np.asarray(2.0 * across_the_belt(self.errors))

    @property
    def cross_shares(self) -> Array:
        """|c_0m|²/Σ|c_0m|²: share of every strip in the CV² of the mean cross profile.

        NaN where no strip is larger than its error.
        """
        squares: Array = self.cross_amplitudes**2
        if not np.any(self.cross_amplitudes > self.cross_errors):
            return np.full(squares.shape, np.nan)
        return np.asarray(squares / squares.sum())

    def coefficient_of_variation(self, zone: float = 0.0) -> tuple[float, float]:
        """√(Σ |c_nm|² sinc²(k₁x/2) sinc²(k₂x/2)) of square zones of side x; its error.

        Of the mean pattern alone: the fibres vary about it.

        Parameters
        ----------
        zone : float
            x; 0 for points.
        """
        zone = check_non_negative("zone", zone)
        weights = self._weights(zone)
        variance = float((np.abs(self.coefficients) ** 2 * weights).sum())
        spread = math.sqrt(float((self.errors**2 * weights).sum()))
        return math.sqrt(variance), spread

    @property
    def x1(self) -> Array:
        """Points along the belt, from 0 to `length`."""
        return self._points(0, self.length)

    @property
    def x2(self) -> Array:
        """Points across the belt, from 0 to `width`."""
        return self._points(1, self.width)

    @property
    def length_density(self) -> Array:
        """E m at the points (x2, x1), cross direction × machine direction.

        In L1 over the cell it is off by no more than the density of the state is, and
        by the waves that its cells do not resolve.
        """
        return self.mean * self.relative_at(self.x1, self.x2)

    def relative_at(self, x1: Any, x2: Any) -> Array:
        """E m relative to the mean at every pair of points, shape (n_x2, n_x1)."""
        n1, n2 = (size // 2 for size in self.coefficients.shape)
        x1, x2 = (check_finite_numbers(name, x) for name, x in (("x1", x1), ("x2", x2)))
        along = np.arange(-n1, n1 + 1) * (2j * math.pi / self.length)
        across = np.arange(-n2, n2 + 1) * (2j * math.pi / self.width)
        first = np.exp(np.multiply.outer(np.ravel(x1), along))
        second = np.exp(np.multiply.outer(np.ravel(x2), across))
        return np.asarray((second @ self.coefficients.T @ first.T).real)

    def _points(self, axis: int, period: float) -> Array:
        n = POINTS * self.coefficients.shape[axis] + 1
        return np.asarray(np.arange(n) * (period / n), dtype=np.float64)

    def _weights(self, zone: float) -> Array:
        """sinc² of both directions; 0 for the mean."""
        n1, n2 = (size // 2 for size in self.coefficients.shape)
        first = np.sinc(np.arange(-n1, n1 + 1) * (zone / self.length)) ** 2
        second = np.sinc(np.arange(-n2, n2 + 1) * (zone / self.width)) ** 2
        weights: Array = np.asarray(np.multiply.outer(first, second))
        weights[n1, n2] = 0.0
        return weights


def along_the_belt(coefficients: Any) -> Any:
    """Those of (n, 0), n = 1, 2, …."""
    return coefficients[coefficients.shape[0] // 2 + 1 :, coefficients.shape[1] // 2]


def across_the_belt(coefficients: Any) -> Any:
    """Those of (0, m), m = 1, 2, …."""
    return coefficients[coefficients.shape[0] // 2, coefficients.shape[1] // 2 + 1 :]
