"""The shape of (12) fitted to measured errors of averages along paths."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import nnls

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive
from fpsolve.studies.ergodicity.asymptotic_variance import (
    SETTLED,
    Minimum,
    all_but_one,
    jackknife_error,
    least_noise,
    settled_slope,
)

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ErgodicFit", "ErrorShape", "fit_ergodic_error"]

_TRENDS = {
    "rising": "fastest at the smallest noise",
    "falling": "fastest at the largest noise",
    "vanishing": "no s^(-1/2) part that can be told from zero at every noise",
}


@dataclass(frozen=True)
class ErrorShape:
    """error ≈ (c₁/s + s^{−1/2} (c₁c₂/A + c₁c₃ A)) ‖f − E f‖ for one function.

    Attributes
    ----------
    name : str
    coefficients : tuple of float
        c₁, c₁c₂, c₁c₃, each non-negative. From a stationary start c₁ is often 0, since
        error² = v/s − w/s² + … with w > 0: then only the products have a meaning.
    standard_errors : tuple of float
        Statistical, by the jackknife over batches of paths.
    misfit, largest_misfit : float
        Root mean square and largest relative deviation of the measured errors from
        the shape, where it was fitted: what the standard errors do not contain.
    bound_factor : float
        Smallest factor that lifts the shape above every measured error, at all s.
    best_noise, best_noise_error : float
        A = √(c₂/c₃), where the fitted shape is least at large s; 0 or infinite when
        one of both is zero, NaN when both are.
    measured : Minimum
        Where the measured asymptotic variance is least, without the shape.
    """

    name: str
    coefficients: tuple[float, float, float]
    standard_errors: tuple[float, float, float]
    misfit: float
    largest_misfit: float
    bound_factor: float
    best_noise: float
    best_noise_error: float
    measured: Minimum

    def error(self, noise: ArrayLike, s: ArrayLike) -> Array:
        """Fitted error over ‖f − E f‖, broadcast over noise and s."""
        return np.asarray(sum(_terms(noise, s, self.coefficients)))

    def variance(self, noise: ArrayLike) -> Array:
        """Limit of s error² over ‖f − E f‖² of the fitted shape."""
        _, small, large = self.coefficients
        return np.square(small / np.asarray(noise) + large * np.asarray(noise))

    def __str__(self) -> str:
        """Return the fit, how well it holds, and the best noise."""
        first, small, large = (
            f"{value:.3g} ± {error:.1g}"
            for value, error in zip(
                self.coefficients, self.standard_errors, strict=True
            )
        )
        return (
            f"{self.name}: ({first})/s + s^(-1/2) [({small})/A + ({large}) A], off by "
            f"{self.misfit:.0%} rms and {self.largest_misfit:.0%} at most, a bound "
            f"when multiplied by {self.bound_factor:.2f}; {self._place()}"
        )

    def _place(self) -> str:
        if self.measured.trend != "interior":
            return _TRENDS[self.measured.trend]
        place, error = self.measured.noise, self.measured.standard_error
        return (
            f"fastest at A = {self.best_noise:.2g} ± {self.best_noise_error:.1g} by "
            f"the shape, {place:.2g} ± {error:.1g} as measured"
        )


@dataclass(frozen=True)
class ErgodicFit:
    """The shape of (12) for every function, and for the worst of them.

    Attributes
    ----------
    functions : mapping of str to ErrorShape
    worst : ErrorShape
        For the largest error over ‖f − E f‖ among the functions at each A and s: the
        theorem has one set of constants for all functions.
    s_from : float
        Smallest s that was fitted.
    """

    functions: Mapping[str, ErrorShape]
    worst: ErrorShape
    s_from: float

    def __getitem__(self, name: str) -> ErrorShape:
        """Return the fit for one function."""
        return self.functions[name]

    def __str__(self) -> str:
        """Return one line for each function."""
        lines = [str(shape) for shape in (*self.functions.values(), self.worst)]
        return "\n".join([f"error / ‖f − E f‖ from s = {self.s_from:g} on:", *lines])


def fit_ergodic_error(dataset: xr.Dataset, s_from: float | None = None) -> ErgodicFit:
    """c₁ (1/s + s^{−1/2} (c₂/A + c₃ A)) ‖f − E f‖, (12), by least squares.

    Non-negative least squares in the products c₁, c₁c₂, c₁c₃, weighted with the
    standard errors. As the theorem is a bound, its shape need not describe the error
    of any function: `misfit` says how well it does. For a single function both limits
    may differ from it: the average of an eigenfunction of L has an asymptotic variance
    ∝ 1/A² at every A, and of a derivative along the path (cos α) none at all.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `ergodic_averages`.
    s_from : float, optional
        Smallest s to fit; by default a quarter of the longest average.

    Returns
    -------
    ErgodicFit

    Raises
    ------
    ValueError
        If fewer than two noises, or two s from `s_from` on, can be fitted.

    References
    ----------
    [KMW09]_, equation (12) and theorem 3.3.
    """
    dataset = dataset.sortby("noise")
    s, noises = dataset["s"].to_numpy(), dataset["noise"].to_numpy()
    s_from = SETTLED * s[-1] if s_from is None else check_positive("s_from", s_from)
    n_fitted = int(np.count_nonzero(s >= s_from))
    if n_fitted < 2 or noises.size < 2:
        raise ValueError(
            "`dataset` must hold at least two noises, and two s from `s_from` = "
            f"{s_from:g} on, got {noises.size} and {n_fitted}."
        )
    variance = np.square(dataset["deviation"].to_numpy())
    # Over (function, batch, noise, s), in units of ‖f − E f‖².
    relative = np.moveaxis(dataset["squared_error"].to_numpy(), 2, 0)
    relative = relative / variance[:, None, None, None]
    names = [str(name) for name in dataset["function"].to_numpy()]
    shapes = {
        name: _fit(name, noises, s, s_from, batches)
        for name, batches in zip(names, relative, strict=True)
    }
    # At every noise and s the batches of that function whose error is largest there.
    largest = np.argmax(relative.mean(axis=1), axis=0)[None, None]
    worst = np.take_along_axis(relative, largest, axis=0)[0]
    return ErgodicFit(shapes, _fit("worst", noises, s, s_from, worst), float(s_from))


def _fit(
    name: str, noises: Array, s: Array, s_from: float, batches: Array
) -> ErrorShape:
    """Fit squared errors over (batch, noise, s) in units of ‖f − E f‖²."""
    fitted = s >= s_from
    used = batches[:, :, fitted]
    mean = used.mean(axis=0)
    # Relative standard errors of the squared errors, twice those of the errors.
    weights = mean * math.sqrt(len(used)) / used.std(axis=0, ddof=1)
    one = np.ones(3)
    terms = _terms(noises[:, None], s[fitted], one)

    def coefficients(squared: Array) -> Array:
        scale = weights / np.sqrt(squared)
        design = np.stack([np.ravel(term * scale) for term in terms], axis=1)
        return np.asarray(nnls(design, np.ravel(np.sqrt(squared) * scale))[0])

    found = coefficients(mean)
    left_out = np.array([coefficients(squared) for squared in all_but_one(used)])
    best = np.array([_best_noise(one) for one in left_out])
    deviation = np.sqrt(mean) / sum(_terms(noises[:, None], s[fitted], found)) - 1
    everywhere = np.sqrt(batches.mean(axis=0))
    shape = sum(_terms(noises[:, None], s, found))
    return ErrorShape(
        name=name,
        coefficients=_triple(found),
        standard_errors=_triple(jackknife_error(left_out)),
        misfit=float(np.sqrt(np.mean(np.square(deviation)))),
        largest_misfit=float(np.max(np.abs(deviation))),
        bound_factor=float(np.max(everywhere / shape)),
        best_noise=_best_noise(found),
        best_noise_error=_error_of_best(best),
        measured=least_noise(noises, settled_slope(s, batches)),
    )


def _terms(noise: ArrayLike, s: ArrayLike, factors: ArrayLike) -> list[Array]:
    """The three terms of (12), broadcast over noise and s."""
    noise, s = np.broadcast_arrays(
        np.asarray(noise, dtype=float), np.asarray(s, dtype=float)
    )
    first, small, large = np.asarray(factors)
    root = np.sqrt(s)
    return [first / s, small / (noise * root), large * noise / root]


def _best_noise(coefficients: Array) -> float:
    _, small, large = coefficients
    if large > 0:
        return math.sqrt(small / large)
    return math.inf if small > 0 else math.nan


def _error_of_best(left_out: Array) -> float:
    """Jackknife error; NaN where one of the limits of the shape is missing."""
    if not np.all(np.isfinite(left_out) & (left_out > 0)):
        return math.nan
    return float(jackknife_error(left_out))


def _triple(values: Array) -> tuple[float, float, float]:
    first, small, large = (float(value) for value in values)
    return first, small, large
