"""A rate study as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import nnls

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels, to_json
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.rates.bounds import (
    averaging_bound,
    hypocoercive_bound,
    large_noise_asymptote,
    small_noise_asymptote,
)
from fpsolve.studies.rates.cases import PARTS, sectors_shown
from fpsolve.studies.rates.modes import CLASSES
from fpsolve.studies.sweeps.study import (
    TEXT,
    Column,
    by_noise_and_part,
    outcomes,
    study_dataset,
    texts,
    variables_of,
)
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["rates_dataset", "theory_curves"]

# What the cases of every part return.
_COLUMNS: dict[str, dict[str, Column]] = {
    "relaxation": {
        "inverse_decay_rate": ("inverse decay rate I = ∫₀^S H ds", ()),
        "inverse_decay_rate_error": ("error of I: step, grid and quadrature", ()),
        "inverse_decay_rate_step_error": ("part of the error from the step", ()),
        "inverse_decay_rate_grid_error": ("part of the error from the grid", ()),
        "tail_bound": ("∫ H ds beyond S, at most, at the fitted rate", ()),
        "entropy_rate": ("asymptotic decay rate of H", ()),
        "entropy_rate_error": ("error of the rate: step, grid and subspace", ()),
        "entropy_rate_line": ("slope of −ln H over the second half of the run", ()),
        "entropy_rate_line_error": ("standard error of the slope, with its bend", ()),
        "run_rate": ("slowest decay rate of the density by symmetry", ("symmetry",)),
        "run_rate_error": ("error of the slowest rate by symmetry", ("symmetry",)),
        "quadratic_share": ("H over half the square of ‖p/p_S − 1‖ at S", ()),
        "s_end": ("end S of the run", ()),
        "ds": ("longer of the two steps of the run", ()),
        "half_width": ("half width of the box", ("axis",)),
        "cells": ("cells of the grid", ("coordinate",)),
        "entropy_start": ("H at s = 0", ()),
        "entropy_end": ("H at S", ()),
        "boundary_mass": ("largest mass at the edge of the box", ()),
        "slowest_class": TEXT,
    },
    "evolution": {
        "spectral_inverse_decay_rate": ("I = ∫₀^S H ds by spectral_solve", ()),
        "spectral_inverse_decay_rate_error": ("error of it", ()),
    },
    "branches": {
        "branch_rate": ("−Re λ of the leading eigenvalues", ("sector", "mode")),
        "branch_frequency": ("Im λ of the leading eigenvalues", ("sector", "mode")),
        "branch_error": ("error of the eigenvalue", ("sector", "mode")),
        "essential_rate": ("where the essential spectrum begins", ()),
    },
    "gap": {
        "gap": ("spectral gap", ()),
        "gap_error": ("error of the gap", ()),
        "gap_frequency": ("|Im λ| of the slowest eigenvalue", ()),
        "gap_sector": TEXT,
    },
    "variance": {
        "asymptotic_variance": ("−2⟨f, L⁻¹f⟩ over Var f", ("function",)),
        "asymptotic_variance_error": ("error of the variance", ("function",)),
    },
}


def rates_dataset(
    potential: Potential, noises: Array, cases: Sequence[Case], about: Mapping[str, Any]
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
    asked = {case.arguments["part"] for case in cases}
    parts = [part for part in PARTS if part in asked]
    placed = by_noise_and_part(cases, noises, parts)
    coordinates = _coordinates(potential, noises, parts, about["functions"])
    sizes = {name: len(values) for name, (_, values, _) in coordinates.items()}
    variables = outcomes(placed, ("noise", "part"))
    for column, part in enumerate(parts):
        own = placed[:, column]
        variables |= variables_of(own, ("noise",), _COLUMNS[part], sizes)
    variables |= {
        name: (("noise",), values, labels(meaning))
        for name, (values, meaning) in theory_curves(potential, noises).items()
    }
    if "variance" in parts:
        variables |= _shapes(noises, variables["asymptotic_variance"][1])
    used = {one for dims, *_ in variables.values() for one in dims}
    kept = {name: one for name, one in coordinates.items() if name in used}
    described = {
        "equation": "(9) of Klar, Marheineke and Wegener (2009), fixed belt",
        "p0": to_json(about["p0"].to_dict()),
        "quick": int(about["quick"]),
        "settings": to_json(about["settings"]),
    }
    title = "Rate of convergence against noise"
    return study_dataset("rate", title, potential, variables, kept, described)


def _coordinates(
    potential: Potential, noises: Array, parts: list[str], functions: list[str]
) -> dict[str, Any]:
    words = {
        "part": parts,
        "function": functions,
        "sector": map(str, sectors_shown(potential)),
        "symmetry": CLASSES if potential.isotropic else ("all",),
        "axis": ("xi1", "xi2"),
        "coordinate": ("xi1", "xi2", "alpha"),
    }
    return {
        "noise": ("noise", noises, labels("noise A")),
        "mode": ("mode", np.arange(2), {}),
        **{name: (name, texts(one), {}) for name, one in words.items()},
    }


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
        "shape_small": (("function",), coefficients[:, 0], labels("c₁c₂ of (12)")),
        "shape_large": (("function",), coefficients[:, 1], labels("c₁c₃ of (12)")),
    }
