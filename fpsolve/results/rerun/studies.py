"""Repeat a study from the arguments in its dataset."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fpsolve._support.checks import shown
from fpsolve.errors import NotRepeatableError
from fpsolve.results.rerun.costs import check_study
from fpsolve.results.rerun.missing import own_code, unrecorded
from fpsolve.studies.recipe import RECIPE, UserCodeError, read_recipe, recipe

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.studies.agreement.check import CrossCheck

__all__ = ["repeat_check", "repeat_study"]

_STUDIES = (
    "rate_versus_noise", "large_noise_limit", "small_noise_limit",
    "small_noise_spectrum", "ergodic_averages", "cross_check",
)  # fmt: skip
# What the command line adds.
NOTES = ("command", "configuration")


def repeat_check(check: CrossCheck, overrides: dict[str, Any]) -> CrossCheck:
    """Call `cross_check` as it was called, with the overrides."""
    found: CrossCheck = _repeated(check.to_xarray(), overrides)
    return found


def repeat_study(dataset: xr.Dataset, overrides: dict[str, Any]) -> xr.Dataset:
    """Call the function of a study as it was called, with the overrides."""
    result = _repeated(dataset, overrides)
    found: xr.Dataset = result.to_xarray() if _is_check(result) else result
    if overrides.keys() - {"progress", "workers", "client", "directory"}:
        return found
    notes = {name: dataset.attrs[name] for name in NOTES if name in dataset.attrs}
    return found.assign_attrs(notes)


def _is_check(result: Any) -> bool:
    from fpsolve.studies.agreement.check import CrossCheck

    return isinstance(result, CrossCheck)


def _repeated(dataset: xr.Dataset, overrides: dict[str, Any]) -> Any:
    if RECIPE not in dataset.attrs:
        raise unrecorded("how it was computed", "the function of the study")
    try:
        name, arguments = read_recipe(dataset.attrs[RECIPE], overrides)
    except UserCodeError as error:
        raise own_code(error.argument, error.description) from None
    function = _function(name)
    _check_names(function, arguments, overrides)
    check_study(name, arguments, dataset, overrides)
    if name == "cross_check":
        arguments = _with_start(dataset, arguments)
    return function(**arguments)


def _check_names(
    function: Callable[..., Any], arguments: dict[str, Any], given: dict[str, Any]
) -> None:
    """Raise NotRepeatableError if the recipe names what the function does not have."""
    known = inspect.signature(function).parameters
    kinds = {one.kind for one in known.values()}
    unknown = arguments.keys() - known.keys() - given.keys()
    if unknown and inspect.Parameter.VAR_KEYWORD not in kinds:
        raise NotRepeatableError(
            f"the result must be made with the arguments {', '.join(known)} to be "
            f"repeated, got {shown(sorted(unknown)[0])}; update fpsolve."
        )


def _function(name: str) -> Callable[..., Any]:
    if name == "energy_tables":
        return _energy_tables
    if name == "spectrum":
        return _spectrum
    if name in _STUDIES:
        from fpsolve import studies

        found: Callable[..., Any] = getattr(studies, name)
        return found
    known = ", ".join((*_STUDIES, "energy_tables", "spectrum"))
    raise NotRepeatableError(
        f"the result must be made by one of {known} to be repeated, got {name!r}; "
        "update fpsolve."
    )


def _energy_tables(
    potential: Any, noise: float, n_energies: int, n_eigenvalues: int
) -> xr.Dataset:
    from fpsolve.reduced.energy.process import EnergyProcess
    from fpsolve.studies.energy_tables import tables_dataset

    return tables_dataset(EnergyProcess(potential, noise), n_energies, n_eigenvalues)


def _spectrum(**arguments: Any) -> xr.Dataset:
    from fpsolve.spectral.eigen.dataset import spectrum_dataset
    from fpsolve.spectral.eigen.spectrum import spectrum

    dataset = spectrum_dataset(spectrum(**arguments))
    return dataset.assign_attrs(recipe("spectrum", arguments))


def _with_start(dataset: xr.Dataset, arguments: dict[str, Any]) -> dict[str, Any]:
    """Arguments of `cross_check` with the density p0 and the scheme."""
    from fpsolve.density.schemes.dictionaries import scheme_from_dict

    known = dict(arguments)
    if "p0" not in known and "initial_density" in dataset:
        known["p0"] = dataset["initial_density"].to_numpy()
    if isinstance(known["scheme"], dict):
        try:
            scheme = scheme_from_dict(known["scheme"], known["model"], known["grid"])
        except (KeyError, ValueError):
            raise own_code("scheme", str(known["scheme"].get("name"))) from None
        known["scheme"] = scheme
    return known
