"""From a file, or a result, to the dataset that is compared, and its kind."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.declared import declared
from fpsolve._support.labels import FORMAT
from fpsolve._support.netcdf import read_dataset, reported_damage
from fpsolve.results.kinds import from_xarray, kind_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["KINDS", "dataset_of", "kind_of_dataset", "name_of"]

# What is compared, in words; solutions and paths say it in `fpsolve_kind`.
KINDS = {
    "solution": "solutions",
    "paths": "paths",
    "hydrodynamic": "solutions of the hydrodynamic limit",
    "energy": "solutions of the energy process",
    "rate": "rates against the noise",
    "large-noise": "distances to the limit of large noise",
    "small-noise": "distances to the limit of small noise",
    "small-noise-spectrum": "spectra in the limit of small noise",
    "energy-tables": "tables of the energy process",
    "spectrum": "spectra",
    "check": "checks of density against paths",
    "averages": "averages along paths",
}
# The studies say it in their title.
_TITLES = {
    "Rate of convergence against noise": "rate",
    "Distance to the limit of large noise": "large-noise",
    "Law of G: full equation against averaged equation": "small-noise",
    "Spectrum in the limit of little noise": "small-noise-spectrum",
    "energy process of fibre lay-down": "energy-tables",
    "Eigenvalues of the generator": "spectrum",
    "Density against paths": "check",
    "Averages along paths started from the equilibrium": "averages",
}


def name_of(result: Any, otherwise: str) -> str:
    """Return the name of a file, without its folder, or another word."""
    if isinstance(result, (str, os.PathLike)):
        return Path(result).name
    return otherwise


def dataset_of(result: Any, argument: str) -> xr.Dataset:
    """Return a result of any kind as a dataset.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If a file does not exist, is damaged, or holds something else.
    ValueError, TypeError
        If it is no result of fpsolve.
    """
    import xarray as xr

    if isinstance(result, (str, os.PathLike)):
        path, result = result, read_dataset(result)
        _check_layout(path, result)
    elif not isinstance(result, xr.Dataset):
        result = _made_dataset(result)
    kind_of_dataset(result, argument)
    found: xr.Dataset = result
    return found


def _check_layout(path: str | os.PathLike[str], dataset: xr.Dataset) -> None:
    """Raise FileFormatError unless `load` would read the file."""
    # Without the code of a user's potential a law of the energy cannot be loaded.
    if dataset.attrs.get("fpsolve_kind") not in ("solution", "paths", "hydrodynamic"):
        return
    with reported_damage(path, Exception), warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        from_xarray(dataset)


def kind_of_dataset(dataset: xr.Dataset, argument: str) -> str:
    """Return the key of `KINDS`; ValueError unless it is a result of fpsolve."""
    about = declared(dataset.attrs)
    kind = _TITLES.get(about.get("title", ""), "")
    if "fpsolve_format" in about:
        if about["fpsolve_format"] > FORMAT:
            raise ValueError(
                f"`{argument}` must have a layout up to {FORMAT} to be read, got "
                f"{about['fpsolve_format']}; update fpsolve."
            )
        kind = about.get("fpsolve_kind", "solution")
    if kind not in KINDS:
        raise ValueError(
            f"`{argument}` must be a result of fpsolve, got a dataset of something "
            "else; solutions, paths and studies can be compared."
        )
    return kind


def _made_dataset(result: Any) -> xr.Dataset:
    from fpsolve.spectral.eigen.dataset import spectrum_dataset
    from fpsolve.spectral.eigen.spectrum import Spectrum
    from fpsolve.studies.agreement.check import CrossCheck

    if isinstance(result, CrossCheck):
        return result.to_xarray()
    if isinstance(result, Spectrum):
        return spectrum_dataset(result)
    kind_of(result)
    found: xr.Dataset = result.to_xarray()
    return found
