"""Numbers with their standard errors, one and many."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_finite

__all__ = ["Estimate", "Estimates"]


class Estimate(float):
    """θ̂ ± standard error: a float that knows how well it is known.

    The value describes the web at hand. The standard error says how far it lies from
    what an endless web of the same process has; NaN, with a reason, where the web is
    too small to say.

    Parameters
    ----------
    value : float
        The number.
    standard_error : float
        Root of the variance and of the squared bias, both from independent blocks.
    n_blocks : int
        Independent blocks behind the standard error.
    n_samples : int
        Zones, pixels or wave vectors behind the value.
    reason : str
        Why the standard error is NaN, else empty.
    """

    standard_error: float
    n_blocks: int
    n_samples: int
    reason: str

    def __new__(
        cls,
        value: float,
        standard_error: float,
        n_blocks: int = 0,
        n_samples: int = 0,
        reason: str = "",
    ) -> Estimate:
        """A float with attributes."""
        made = super().__new__(cls, value)
        made.standard_error, made.reason = float(standard_error), reason
        made.n_blocks, made.n_samples = int(n_blocks), int(n_samples)
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        error = self.standard_error
        return float(self), error, self.n_blocks, self.n_samples, self.reason

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """θ̂ ± t(n - 1) standard errors, t the quantile of Student for n blocks.

        Parameters
        ----------
        level : float
            Probability that the interval covers, 0 < level < 1.

        Returns
        -------
        tuple of float
            Lower and upper end; NaN where the standard error is.

        Raises
        ------
        ValueError
            If the level is no probability between 0 and 1.
        """
        from scipy.special import stdtrit

        level = check_finite("level", level)
        if not 0 < level < 1:
            raise ValueError(f"`level` must lie between 0 and 1, got {level:g}.")
        if math.isnan(self.standard_error):
            return math.nan, math.nan
        half = stdtrit(max(self.n_blocks - 1, 1), 0.5 + level / 2) * self.standard_error
        return float(self - half), float(self + half)

    def __repr__(self) -> str:
        return f"{float(self):.6g} ± {self.standard_error:.2g}"


@dataclass(frozen=True, eq=False)
class Estimates:
    """θ̂(x) ± standard errors over a coordinate x: an array of estimates.

    Parameters
    ----------
    coordinate : array
        Sides of zones, wave numbers, angles.
    values, standard_errors : array
        As `Estimate`, one each per coordinate.
    n_blocks, n_samples : array of int
        Independent blocks, and zones, pixels or wave vectors behind each.
    reasons : tuple of str
        Why a standard error is NaN, else empty.
    """

    coordinate: Array
    values: Array
    standard_errors: Array
    n_blocks: NDArray[np.int64]
    n_samples: NDArray[np.int64]
    reasons: tuple[str, ...]

    @classmethod
    def of(cls, coordinate: Any, estimates: list[Estimate]) -> Estimates:
        """From one estimate for each entry of the coordinate."""
        return cls(
            np.asarray(coordinate, dtype=np.float64),
            np.array([float(one) for one in estimates]),
            np.array([one.standard_error for one in estimates]),
            np.array([one.n_blocks for one in estimates]),
            np.array([one.n_samples for one in estimates]),
            tuple(one.reason for one in estimates),
        )

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, place: int) -> Estimate:
        return Estimate(
            self.values[place], self.standard_errors[place],
            self.n_blocks[place], self.n_samples[place], self.reasons[place],
        )  # fmt: skip

    def __iter__(self) -> Iterator[Estimate]:
        return (self[place] for place in range(len(self)))
