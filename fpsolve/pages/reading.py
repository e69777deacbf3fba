"""From a file, or a result, to the section of a page about it."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete
from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.errors import FileFormatError
from fpsolve.pages.blocks import Section
from fpsolve.results.kinds import from_xarray, kind_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["existing_file", "section_of"]

# What a damaged or tampered file makes those raise who read what is in it.
_DAMAGE = (ValueError, KeyError, TypeError, IndexError)


class Study(NamedTuple):
    """Who writes about a study, and what its dataset must hold."""

    module: str
    function: str
    variables: tuple[str, ...]
    attributes: tuple[str, ...]


_CASES = ("noise", "status", "message")
_POTENTIAL = ("potential", "formula", "versions")
# By the title that each study gives to its dataset.
_STUDIES = {
    "Rate of convergence against noise": Study(
        "rates", "section", (*_CASES, "part"),
        (*_POTENTIAL, "p0", "settings", "quick"),
    ),
    "Distance to the limit of large noise": Study(
        "limits", "large_section",
        (*_CASES, "quantity", "meaning", "distance", "distance_error",
         "expected_order", "fitted_order"),
        (*_POTENTIAL, "p0", "slow_length", "belt_speed_scale", "fixed_speed", "quick"),
    ),
    "Law of G: full equation against averaged equation": Study(
        "limits", "small_section", (*_CASES, "belt_speed_scale", "distance"),
        (*_POTENTIAL, "options"),
    ),
    "energy process of fibre lay-down": Study(
        "energy", "section", ("g", "r_min", "eigenvalue", "eigenvalue_error"),
        (*_POTENTIAL, "noise", "radius", "g_max"),
    ),
    "Eigenvalues of the generator": Study(
        "spectrum", "section", ("real", "imag", "error", "residual", "sector"),
        ("model", "gap", "gap_error", "truncation", "versions"),
    ),
}  # fmt: skip
# Who writes about what `load` returns.
_RESULTS = {
    "solution": ("solution", "section"),
    "paths": ("paths", "section"),
    "hydrodynamic": ("limit_solutions", "hydrodynamic_section"),
    "energy": ("limit_solutions", "energy_section"),
}
_CROSS_CHECK = "Density against paths"


def section_of(result: Any) -> Section:
    """Return the section about a file or a result of any kind.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If a file does not exist, is damaged, or holds something else.
    TypeError
        If the result is of no known kind.
    """
    if isinstance(result, (str, os.PathLike)):
        return _section_of_file(existing_file(result))
    kind = _kind_of(result)
    if kind is not None:
        return _written(*_RESULTS[kind], result, "")
    return _section_of_study(result)


def _kind_of(result: Any) -> str | None:
    """Return the key of `_RESULTS`; None for a study."""
    try:
        return kind_of(result)
    except TypeError:
        return None


def existing_file(path: str | os.PathLike[str]) -> Path:
    """Return the file that holds the numbers: for the JSON of a check its netCDF.

    Both come from `fpsolve check`; the JSON holds a part of the other.
    """
    path = Path(path)
    if path.suffix != ".json" or not path.is_file():
        return path
    numbers = path.with_suffix(".nc")
    if not numbers.is_file():
        raise FileFormatError(path, f"the numbers are in `{numbers}`, which is missing")
    return numbers


def _section_of_file(path: Path) -> Section:
    dataset = read_dataset(path)
    with reported_damage(path, *_DAMAGE):
        if "fpsolve_format" not in dataset.attrs:
            return _section_of_dataset(dataset, path.name)
        result = from_xarray(dataset)
        return _written(*_RESULTS[kind_of(result)], result, path.name)


def _section_of_study(result: Any) -> Section:
    """Return the section about a study, as a dataset or as what makes one."""
    import xarray as xr

    if isinstance(result, xr.Dataset):
        return _section_of_dataset(result, "")
    from fpsolve.reduced.energy.process import EnergyProcess
    from fpsolve.spectral.eigen.dataset import spectrum_dataset
    from fpsolve.spectral.eigen.spectrum import Spectrum
    from fpsolve.studies.agreement.check import CrossCheck
    from fpsolve.studies.energy_tables import tables_dataset

    if isinstance(result, CrossCheck):
        return _section_of_dataset(result.to_xarray(), "")
    if isinstance(result, Spectrum):
        return _section_of_dataset(spectrum_dataset(result), "")
    if isinstance(result, EnergyProcess):
        return _section_of_dataset(tables_dataset(result, 10, 4), "")
    raise TypeError(
        "`results` must be files, solutions, paths, studies or spectra, got "
        f"{type(result).__name__}."
    )


def _section_of_dataset(dataset: xr.Dataset, source: str) -> Section:
    title = declared(dataset.attrs).get("title", "")
    if title == _CROSS_CHECK:
        from fpsolve.pages.studies import origin_of
        from fpsolve.studies.agreement.reading import from_xarray as read_check

        return _written(
            "cross_check", "section", read_check(dataset), source, origin_of(dataset)
        )
    if title not in _STUDIES:
        raise ValueError(
            "it is not a result of fpsolve that a report can be written about"
        )
    study = _STUDIES[title]
    check_complete(dataset, study.variables, study.attributes)
    return _written(study.module, study.function, dataset, source)


def _written(module: str, function: str, *arguments: Any) -> Section:
    """Call a function of a module that is loaded only now."""
    home = importlib.import_module(f"fpsolve.pages.{module}")
    section: Section = getattr(home, function)(*arguments)
    return section
