"""Moments of an ensemble with their standard errors, from sums that can be added."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fpsolve._kernels.paths import LANES, N_POWERS, N_PRODUCTS, sum_powers
from fpsolve._support.arrays import Array
from fpsolve.paths.ensemble import KAPPA

__all__ = ["Moments", "moment_sums", "n_sums"]


# Powers (i, j) of ξ1 and ξ2 that are summed, then cos, sin and their squares; of smooth
# paths also powers of κ.
POWERS = [(i, total - i) for total in range(N_POWERS) for i in range(total, -1, -1)]
N_SUMS = N_PRODUCTS + 4
KAPPA_POWERS = (1, 2, 4)
PLACE = {power: place for place, power in enumerate(POWERS)}


def n_sums(n_state: int) -> int:
    """Number of the sums over states of a kind."""
    return N_SUMS if n_state == KAPPA else N_SUMS + len(KAPPA_POWERS)


def moment_sums(state: Array) -> Array:
    """Sums over paths of the powers of ξ and of cos α and sin α, of κ; shape (n_sums,).

    Blocks are summed one after the other, so that threads change nothing. Paths may be
    so far away that powers overflow; their moments are then infinite.
    """
    n_blocks = -(-state.shape[1] // LANES)
    sums = np.zeros((n_blocks, N_SUMS))
    sum_powers(state, sums)
    total: Array = np.cumsum(sums, axis=0)[-1]
    if len(state) == KAPPA:
        return total
    # A power may overflow, as those of ξ.
    with np.errstate(over="ignore"):
        powers = [np.sum(state[KAPPA] ** power) for power in KAPPA_POWERS]
    return np.array([*total, *powers])


@dataclass(frozen=True, eq=False)
class Moments:
    """Estimates of moments at every saved s, with standard errors.

    The names are those of the series of a `Solution` (`mean_xi1`, `variance_xi1`,
    `covariance`, `mean_cos_alpha`, …) and `mean_square`, E‖ξ‖²; of smooth paths there
    are `mean_kappa` and `mean_kappa2`, E κ and E κ². Variances are unbiased;
    the standard errors are those of independent paths, and are NaN for one path.
    ``moments["mean_xi1"]`` gives the pair of both.

    Attributes
    ----------
    s : ndarray, shape (n_saved,)
    n_paths : int
    values, standard_errors : dict of ndarray, each of shape (n_saved,)
    sums : ndarray, shape (n_saved, n_sums)
        Sums over paths from which both come.
    """

    s: Array
    n_paths: int
    sums: Array = field(repr=False)
    values: dict[str, Array] = field(init=False)
    standard_errors: dict[str, Array] = field(init=False)

    def __post_init__(self) -> None:
        estimates = _estimates(self.sums, self.n_paths)
        values = {name: value for name, (value, _) in estimates.items()}
        errors = {name: error for name, (_, error) in estimates.items()}
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "standard_errors", errors)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the moments."""
        return tuple(self.values)

    def __getitem__(self, name: str) -> tuple[Array, Array]:
        if name not in self.values:
            raise KeyError(
                f"no moment {name!r}; the moments are {', '.join(self.values)}."
            )
        return self.values[name], self.standard_errors[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)


def _estimates(sums: Array, n: int) -> dict[str, tuple[Array, Array]]:
    """Value and standard error of every moment."""
    raw = {power: sums[:, place] / n for power, place in PLACE.items()}
    mean1, mean2 = raw[1, 0], raw[0, 1]
    first, second, mixed = (_central(raw, *k) for k in ((2, 0), (0, 2), (1, 1)))
    fourth1, fourth2 = _central(raw, 4, 0), _central(raw, 0, 4)
    cosine, sine, cosine2, sine2 = (sums[:, len(POWERS) + k] / n for k in range(4))
    square = raw[2, 0] + raw[0, 2]
    fourth = raw[4, 0] + 2 * raw[2, 2] + raw[0, 4]
    # The sample variance divides by n - 1; so do the variances of the means below.
    unbiased = n / (n - 1) if n > 1 else np.nan
    return {
        "mean_xi1": (mean1, _error(first, n)),
        "mean_xi2": (mean2, _error(second, n)),
        "variance_xi1": (unbiased * first, _error(fourth1 - first**2, n)),
        "variance_xi2": (unbiased * second, _error(fourth2 - second**2, n)),
        "covariance": (
            unbiased * mixed,
            _error(_central(raw, 2, 2) - mixed**2, n),
        ),
        "mean_cos_alpha": (cosine, _error(cosine2 - cosine**2, n)),
        "mean_sin_alpha": (sine, _error(sine2 - sine**2, n)),
        "mean_square": (square, _error(fourth - square**2, n)),
        **(_of_kappa(sums[:, N_SUMS:] / n, n) if sums.shape[1] > N_SUMS else {}),
    }


def _of_kappa(raw: Array, n: int) -> dict[str, tuple[Array, Array]]:
    """The moments of the curvature."""
    mean, square, fourth = raw.T
    return {
        "mean_kappa": (mean, _error(square - mean**2, n)),
        "mean_kappa2": (square, _error(fourth - square**2, n)),
    }


def _central(raw: dict[tuple[int, int], Array], i: int, j: int) -> Array:
    """E (ξ1 - E ξ1)ⁱ (ξ2 - E ξ2)ʲ by the binomial theorem."""
    from math import comb

    mean1, mean2 = raw[1, 0], raw[0, 1]
    total = np.zeros_like(mean1)
    for k in range(i + 1):
        for m in range(j + 1):
            shifts = (-mean1) ** (i - k) * (-mean2) ** (j - m)
            total += comb(i, k) * comb(j, m) * raw[k, m] * shifts
    return total


def _error(variance: Array, n: int) -> Array:
    """Standard error of a mean of n independent terms of a variance."""
    if n < 2:
        return np.full_like(variance, np.nan)
    # Rounding may leave a little less than nothing.
    error: Array = np.sqrt(np.maximum(variance, 0.0) / (n - 1))
    return error
