"""A rate study as a labelled `xarray.Dataset`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from fpsolve._support.labels import labels, made_with, marked, to_json
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.rates.bounds import (
    averaging_bound,
    hypocoercive_bound,
    large_noise_asymptote,
    small_noise_asymptote,
)
from fpsolve.studies.rates.cases import PARTS, sectors_shown
from fpsolve.studies.rates.modes import CLASSES
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr


__all__ = ["rates_dataset", "theory_curves"]

Array = NDArray[np.float64]

# Name: (dimensions after noise, meaning), by part.
_NUMBERS: dict[str, dict[str, tuple[tuple[str, ...], str]]] = {
    "relaxation": {
        "inverse_decay_rate": ((), "inverse decay rate I = ∫₀^S H ds"),
        "inverse_decay_rate_error": ((), "error of I: step, grid and quadrature"),
        "inverse_decay_rate_step_error": ((), "part of the error from the step"),
        "inverse_decay_rate_grid_error": ((), "part of the error from the grid"),
        "tail_bound": ((), "∫ H ds beyond S, at most, at the fitted rate"),
        "entropy_rate": ((), "asymptotic decay rate of H"),
        "entropy_rate_error": ((), "error of the rate: step, grid and subspace"),
        "entropy_rate_line": ((), "slope of −ln H over the second half of the run"),
        "entropy_rate_line_error": ((), "standard error of the slope, with its bend"),
        "run_rate": (("symmetry",), "slowest decay rate of the density by symmetry"),
        "run_rate_error": (("symmetry",), "error of the slowest rate by symmetry"),
        "quadratic_share": ((), "H over half the square of ‖p/p_S − 1‖ at S"),
        "s_end": ((), "end S of the run"),
        "ds": ((), "longer of the two steps of the run"),
        "half_width": (("axis",), "half width of the box"),
        "cells": (("coordinate",), "cells of the grid"),
        "entropy_start": ((), "H at s = 0"),
        "entropy_end": ((), "H at S"),
        "boundary_mass": ((), "largest mass at the edge of the box"),
    },
    "evolution": {
        "spectral_inverse_decay_rate": ((), "I = ∫₀^S H ds by spectral_solve"),
        "spectral_inverse_decay_rate_error": ((), "error of it"),
    },
    "branches": {
        "branch_rate": (("sector", "mode"), "−Re λ of the leading eigenvalues"),
        "branch_frequency": (("sector", "mode"), "Im λ of the leading eigenvalues"),
        "branch_error": (("sector", "mode"), "error of the eigenvalue"),
        "essential_rate": ((), "where the essential spectrum begins"),
    },
    "gap": {
        "gap": ((), "spectral gap"),
        "gap_error": ((), "error of the gap"),
        "gap_frequency": ((), "|Im λ| of the slowest eigenvalue"),
    },
    "variance": {
        "asymptotic_variance": (("function",), "−2⟨f, L⁻¹f⟩ over Var f"),
        "asymptotic_variance_error": (("function",), "error of the variance"),
    },
}
_TEXTS = {"relaxation": ("slowest_class",), "gap": ("gap_sector",)}


def rates_dataset(
    potential: Potential,
    noises: Array,
    cases: Sequence[Case],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """Arrange the cases of a study by noise; NaN where there is none.

    Parameters
    ----------
    potential : Potential
    noises : ndarray, shape (n,)
        Ascending.
    cases : sequence of Case
    about : mapping
        What repeats the study.
    """
    import xarray as xr

    by_place = {
        (case.arguments["part"], case.arguments["noise"]): case for case in cases
    }
    parts = [part for part in PARTS if any(key[0] == part for key in by_place)]
    coordinates = _coordinates(potential, noises, parts, about["functions"])
    sizes = {name: len(values) for name, (_, values, _) in coordinates.items()}
    variables: dict[str, Any] = _statuses(by_place, parts, noises)
    for part in parts:
        own = [by_place.get((part, float(noise))) for noise in noises]
        for name, (dims, meaning) in _NUMBERS[part].items():
            values = _stacked(own, name, tuple(sizes[dim] for dim in dims))
            variables[name] = (("noise", *dims), values, labels(meaning))
        for name in _TEXTS.get(part, ()):
            texts = [str(case.values[name]) if case and case.values else ""
                     for case in own]  # fmt: skip
            variables[name] = ("noise", np.array(texts, dtype=object))
    variables |= {
        name: ("noise", values, labels(meaning))
        for name, (values, meaning) in theory_curves(potential, noises).items()
    }
    if "variance" in parts:
        variables |= _shapes(noises, variables["asymptotic_variance"][1])
    dataset = xr.Dataset(
        variables,
        {name: one for name, one in coordinates.items()
         if name == "noise" or any(name in _dims(v) for v in variables.values())},
        {
            "title": "Rate of convergence against noise",
            "equation": "(9) of Klar, Marheineke and Wegener (2009), fixed belt",
            "potential": to_json(potential_to_dict(potential)),
            "formula": potential.formula,
            "p0": to_json(about["p0"].to_dict()),
            "quick": int(about["quick"]),
            "settings": json.dumps(about["settings"]),
            **made_with(),
        },
    )  # fmt: skip
    return marked(dataset, "rate")


def _dims(variable: Any) -> tuple[str, ...]:
    dims = variable[0]
    return (dims,) if isinstance(dims, str) else tuple(dims)


def _coordinates(
    potential: Potential, noises: Array, parts: list[str], functions: list[str]
) -> dict[str, Any]:
    symmetries = CLASSES if potential.isotropic else ("all",)
    sectors = [str(sector) for sector in sectors_shown(potential)]
    return {
        "noise": ("noise", noises, labels("noise A")),
        "part": ("part", _names(parts), {}),
        "function": ("function", _names(functions), {}),
        "sector": ("sector", _names(sectors), {}),
        "mode": ("mode", np.arange(2), {}),
        "symmetry": ("symmetry", _names(symmetries), {}),
        "axis": ("axis", _names(("xi1", "xi2")), {}),
        "coordinate": ("coordinate", _names(("xi1", "xi2", "alpha")), {}),
    }


def _names(names: Sequence[str]) -> NDArray[Any]:
    return np.array(list(names), dtype=object)


def _statuses(
    cases: Mapping[tuple[str, float], Case], parts: list[str], noises: Array
) -> dict[str, Any]:
    """Status, message and seconds by noise and part."""

    def table(read: Callable[[Case], Any], missing: Any, kind: Any) -> Any:
        found = [
            [cases.get((part, float(noise))) for part in parts] for noise in noises
        ]
        rows = [[missing if one is None else read(one) for one in row] for row in found]
        return np.array(rows, dtype=kind)

    dims = ("noise", "part")
    seconds = table(lambda case: case.seconds, np.nan, float)
    return {
        "status": (dims, table(lambda case: case.status, "not asked for", object)),
        "message": (dims, table(lambda case: case.message, "", object)),
        "seconds": (dims, seconds, {"long_name": "wall time", "units": "s"}),
    }


def _stacked(cases: Sequence[Case | None], name: str, shape: tuple[int, ...]) -> Array:
    values = np.full((len(cases), *shape), np.nan)
    for row, case in enumerate(cases):
        if case is not None and name in case.values:
            values[row] = case.values[name]
    return values


def theory_curves(potential: Potential, noises: Array) -> dict[str, tuple[Array, str]]:
    """Return bounds and asymptotes with what they mean; NaN where not known."""

    def proven(name: str) -> Array:
        return _each(
            lambda noise: getattr(hypocoercive_bound(potential, noise), name), noises
        )

    small = small_noise_asymptote(potential, noises)
    large = large_noise_asymptote(potential, noises)
    averaging = _each(lambda noise: averaging_bound(potential, noise), noises)
    return {
        "small_noise_asymptote": (small, "exact eigenvalue A²/2"),
        "large_noise_asymptote": (large, "Λ/A², with the next order if known"),
        "hypocoercive_bound": (proven("rate"), "proven lower bound of the gap"),
        "hypocoercive_factor": (proven("factor"), "factor before the proven decay"),
        "averaging_bound": (
            averaging, "theorem 3.3 as a rate, its unknown constant least",
        ),
    }  # fmt: skip


def _each(bound: Callable[[float], float], noises: Array) -> Array:
    try:
        return np.array([bound(float(noise)) for noise in noises])
    except ValueError:
        # Constants are known for some potentials only.
        return np.full(noises.shape, np.nan)


def _shapes(noises: Array, variances: Array) -> dict[str, Any]:
    """√v ≈ c₁c₂/A + c₁c₃A for every function, least relative squares."""
    coefficients = np.full((variances.shape[1], 2), np.nan)
    for column, variance in enumerate(variances.T):
        usable = np.isfinite(variance) & (variance > 0)
        # A variance that vanishes (a derivative along the path) has no shape.
        if np.count_nonzero(usable) < 2 or np.nanmax(variance) < 1e-8:
            continue
        root = np.sqrt(variance[usable])
        terms = np.stack([1 / noises[usable], noises[usable]], axis=1) / root[:, None]
        coefficients[column] = nnls(terms, np.ones(root.size))[0]
    return {
        "shape_small": ("function", coefficients[:, 0], labels("c₁c₂ of (12)")),
        "shape_large": ("function", coefficients[:, 1], labels("c₁c₃ of (12)")),
    }
