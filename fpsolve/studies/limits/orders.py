"""The power of a small parameter at which an error falls."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import linregress

from fpsolve._support.arrays import Array, check_finite_numbers, check_numbers

__all__ = ["FittedOrder", "fitted_order", "observed_orders"]

# An error is used while it exceeds its own uncertainty so many times.
_ABOVE_FLOOR = 3.0


@dataclass(frozen=True)
class FittedOrder:
    """q and C of error ≈ C ε^q, by least squares on logarithms.

    Attributes
    ----------
    order, standard_error : float
        q and the standard error of the slope; NaN unless two (for the latter three)
        points can be used. Errors of a study are no independent measurements: it says
        how straight the line is.
    constant : float
        C.
    n_points : int
        Points that were used.
    """

    order: float
    standard_error: float
    constant: float
    n_points: int

    def __str__(self) -> str:
        """Return "2.01 ± 0.02"."""
        return f"{self.order:.2f} ± {self.standard_error:.2f}"


def observed_orders(epsilon: ArrayLike, error: ArrayLike) -> Array:
    """q_i = ln(e_i/e_{i−1}) / ln(ε_i/ε_{i−1}) between neighbours; NaN first.

    Parameters
    ----------
    epsilon : array_like, shape (n,)
        Small parameter, positive; neighbours differ.
    error : array_like, shape (n,)
        Where it or its neighbour before is not positive, the order is NaN.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    ValueError
        If the shapes differ or a parameter is not positive.
    """
    epsilon, logarithm = _logarithms(epsilon, error)
    orders = np.full(epsilon.size, np.nan)
    if not (np.diff(epsilon) != 0).all():
        raise ValueError("`epsilon` must change between neighbours, got equal ones.")
    orders[1:] = np.diff(logarithm) / np.diff(epsilon)
    return orders


def fitted_order(
    epsilon: ArrayLike, error: ArrayLike, error_floor: ArrayLike | None = None
) -> FittedOrder:
    """q and C of error ≈ C ε^q over all points that can be used.

    Parameters
    ----------
    epsilon, error : array_like, shape (n,)
        As in `observed_orders`.
    error_floor : array_like, optional
        What the error cannot be told from, one number or one for each point: points
        below three times it are left out.

    Returns
    -------
    FittedOrder

    Raises
    ------
    ValueError
        If the shapes differ or a parameter is not positive.
    """
    logarithm_of_epsilon, logarithm = _logarithms(epsilon, error)
    floor = check_numbers("error_floor", 0.0 if error_floor is None else error_floor)
    if floor.shape not in ((), logarithm.shape):
        raise ValueError(
            "`error_floor` must be one number or one for each of the "
            f"{logarithm.size} points, got shape {floor.shape}."
        )
    usable = np.isfinite(logarithm) & (
        np.asarray(error, dtype=np.float64) > _ABOVE_FLOOR * floor
    )
    n = int(np.count_nonzero(usable))
    x, y = logarithm_of_epsilon[usable], logarithm[usable]
    if n < 2 or not np.ptp(x) > 0:
        return FittedOrder(math.nan, math.nan, math.nan, n)
    line = linregress(x, y)
    spread = float(line.stderr) if n > 2 else math.nan
    return FittedOrder(float(line.slope), spread, math.exp(line.intercept), n)


def _logarithms(epsilon: ArrayLike, error: ArrayLike) -> tuple[Array, Array]:
    """ln ε and ln error, NaN where an error is not positive."""
    epsilon = check_finite_numbers("epsilon", epsilon)
    values = check_numbers("error", error)
    if epsilon.ndim != 1 or epsilon.shape != values.shape:
        raise ValueError(
            "`epsilon` and `error` must be sequences of the same length, got shapes "
            f"{epsilon.shape} and {values.shape}."
        )
    if not (epsilon > 0).all():
        raise ValueError(f"`epsilon` must be positive, got {epsilon.min():g}.")
    positive = np.where(values > 0, values, np.nan)
    return np.log(epsilon), np.log(positive)
