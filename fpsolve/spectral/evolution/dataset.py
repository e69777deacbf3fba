"""Expansions, in time and stationary, as labelled `xarray.Dataset`s."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, origin
from fpsolve.evolution.saved import described_as
from fpsolve.evolution.series import long_name
from fpsolve.model.stored import describe_model
from fpsolve.spectral.evolution.expansion import Expansion

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["solution_dataset", "steady_dataset"]


def solution_dataset(solution: Any) -> xr.Dataset:
    """H and moments over `s` with their errors, and the coefficients of p/p_S.

    Parameters
    ----------
    solution : SpectralSolution
    """
    import xarray as xr

    variables: dict[str, Any] = {}
    for name, values in solution.series.items():
        variables[name] = ("s", values, labels(long_name(name)))
    for name, values in solution.errors.items():
        meaning = f"estimated error of: {long_name(name)}"
        variables[f"{name}_error"] = ("s", values, labels(meaning))
    variables |= _truncations(solution.truncation, "s")
    variables |= _coefficients(solution._expansions, "s")
    coordinates = {"s": ("s", solution.s, labels("arclength s"))}
    attributes = {
        "title": "Expansion of the fibre lay-down density in time",
        **_about(solution),
        "tolerance": solution.tolerance,
    }
    return described_as(xr.Dataset(variables, coordinates, attributes), solution)


def steady_dataset(result: Any) -> xr.Dataset:
    """Moments with their errors, and the coefficients of two truncations.

    Parameters
    ----------
    result : SpectralSteadyState
    """
    import xarray as xr

    variables: dict[str, Any] = {
        "residual": ((), result.residual, labels("‖L* h‖/‖h‖ in L²(μ)"))
    }
    for name, value in result.moments.items():
        variables[name] = ((), value, labels(long_name(name)))
    for name, value in result.errors.items():
        meaning = labels(f"estimated error of: {long_name(name)}")
        variables[f"{name}_error"] = ((), value, meaning)
    both = (result._expansion, result._coarser)
    variables |= _truncations([(h.degree, h.harmonics) for h in both], "expansion")
    variables |= _coefficients(both, "expansion")
    names = np.array(["fine", "coarse"], dtype=object)
    attributes = {
        "title": "Stationary fibre lay-down density by expansion",
        **_about(result),
    }
    coordinates = {"expansion": ("expansion", names)}
    return described_as(xr.Dataset(variables, coordinates, attributes), result)


def _about(result: Any) -> dict[str, Any]:
    described = describe_model(result.model, result.model.equation, result.provenance)
    return {**described, **origin(result.provenance)}


def _truncations(truncation: Iterable[tuple[int, int]], over: str) -> dict[str, Any]:
    kept = np.array(list(truncation), np.int64).reshape(-1, 2)
    return {
        "degree": (over, kept[:, 0], labels("largest degree")),
        "harmonics": (over, kept[:, 1], labels("largest harmonic")),
    }


def _coefficients(expansions: Iterable[Expansion], over: str) -> dict[str, Any]:
    """Those within the limits, of all expansions one behind the other."""
    listed = list(expansions)
    limits = np.concatenate([one.limits for one in listed])
    values = np.concatenate([one.packed() for one in listed])
    sizes = np.array([one.limits.size for one in listed], np.int64)
    return {
        "n_limits": (over, sizes, labels("degrees held")),
        "limit": ("held_degree", limits, labels("last harmonic held at a degree")),
        "coefficient": ("held", values, labels("Re and Im of coefficients of p/p_S")),
    }
