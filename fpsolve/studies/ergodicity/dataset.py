"""Errors of averages along paths as a labelled `xarray.Dataset`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.ergodicity.asymptotic_variance import settled_slope
from fpsolve.studies.observables import EquilibriumMoments
from fpsolve.studies.sweeps.study import study_dataset, texts

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["averages_dataset"]


def averages_dataset(
    squared: Array,
    noises: Array,
    saved: Array,
    names: list[str],
    moments: EquilibriumMoments,
    potential: Potential,
    about: Mapping[str, Any],
) -> xr.Dataset:
    """Label squared errors, and what follows from them.

    Parameters
    ----------
    squared : ndarray, shape (n_batches, n_noises, n_functions, n_saved)
        Squared errors of the averages within each batch of paths.
    noises : ndarray, shape (n_noises,)
    saved : ndarray, shape (n_saved,)
        Arclengths s.
    names : list of str
        Of the functions.
    moments : EquilibriumMoments
        Of the functions, in their order.
    potential : Potential
    about : mapping
        Further attributes.
    """
    numbers = _numbers(squared, saved, moments)
    variables = {
        name: (where, values, labels(meaning))
        for name, (where, values, meaning) in numbers.items()
    }
    coordinates = {
        "noise": ("noise", noises, labels("noise A")),
        "function": ("function", texts(names)),
        "s": ("s", saved, labels("arclength s")),
    }
    title = "Averages along paths started from the equilibrium"
    return study_dataset("averages", title, potential, variables, coordinates, about)


def _numbers(
    squared: Array, saved: Array, moments: EquilibriumMoments
) -> dict[str, tuple[tuple[str, ...], Array, str]]:
    """Dimensions, values and meaning of every variable."""
    dims = ("noise", "function", "s")
    mean = squared.mean(axis=0)
    error = np.sqrt(mean)
    # The standard error of a square root, from that of what is under it.
    spread = _standard_error(squared)
    error_spread = spread / (2 * np.maximum(error, np.finfo(float).tiny))
    slopes = settled_slope(saved, squared)
    return {
        "error": (dims, error, "L² error of the average"),
        "error_standard_error": (dims, error_spread, "standard error of `error`"),
        "scaled_variance": (dims, saved * mean, "s times squared error"),
        "scaled_variance_standard_error": (
            dims, saved * spread, "standard error of `scaled_variance`",
        ),
        "asymptotic_variance": (
            dims[:2], slopes.mean(axis=0), "limit of s times squared error",
        ),
        "asymptotic_variance_standard_error": (
            dims[:2], _standard_error(slopes), "standard error of the limit",
        ),
        "squared_error": (("batch", *dims), squared, "squared error within a batch"),
        "expectation": (("function",), moments.mean, "E f, by quadrature"),
        "deviation": (("function",), moments.deviation, "‖f − E f‖, by quadrature"),
    }  # fmt: skip


def _standard_error(batches: Array) -> Array:
    """Of the mean over batches."""
    return np.asarray(batches.std(axis=0, ddof=1) / math.sqrt(len(batches)))
