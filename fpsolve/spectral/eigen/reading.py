"""A spectrum from the labelled `xarray.Dataset` that describes it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_counts
from fpsolve.model.stored import read_model
from fpsolve.spectral.bases.choice import discretisation_for
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.eigen.spectrum import Spectrum
from fpsolve.spectral.eigen.survey import Mode

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED = ("real", "imag", "error", "residual", "sector", "mode_degree",
           "mode_harmonics", "mode_size", "mode_real", "mode_imag")  # fmt: skip
_NEEDED_ATTRIBUTES = ("model", "truncation", "sectors", "provenance")


def from_xarray(dataset: xr.Dataset) -> Spectrum:
    """Return the spectrum that `to_xarray` turned into `dataset`, bit for bit.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.

    Warns
    -----
    UserWarning
        If the model was made of a user's own functions; `model` is None then, and
        there are no eigenfunctions.
    """
    check_complete(dataset, _NEEDED, _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    provenance = read_provenance(about)
    model: Any = read_model(about, provenance)
    sectors = [Sector(**one) for one in about["sectors"]]
    check_counts("sectors", len(sectors), dataset.sizes["index"], "`index`")
    real, imag = (dataset[name].to_numpy() for name in ("real", "imag"))
    return Spectrum(
        model=model,
        eigenvalues=_complex(real, imag),
        errors=dataset["error"].to_numpy(),
        residuals=dataset["residual"].to_numpy(),
        sectors=sectors,
        essential=about.get("essential"),
        truncation=Truncation(*about["truncation"]),
        _modes=[] if model is None else list(_modes(dataset, sectors)),
        _discretisation=None if model is None else discretisation_for(model),
        call=Call.from_xarray(dataset),
        provenance=provenance,
    )


def _complex(real: Any, imag: Any) -> Any:
    # Not by a sum, which would lose the sign of a zero.
    values = np.empty(np.shape(real), complex)
    values.real, values.imag = real, imag
    return values


def _modes(dataset: xr.Dataset, sectors: list[Sector]) -> Iterator[Mode]:
    values = _complex(*(dataset[name].to_numpy() for name in ("real", "imag")))
    vectors = _complex(*(dataset[f"mode_{part}"].to_numpy() for part in
                         ("real", "imag")))  # fmt: skip
    sizes = dataset["mode_size"].to_numpy()
    check_counts("mode_size", int(sizes.sum()), vectors.size, "`mode_real`")
    degrees, harmonics = (dataset[f"mode_{name}"].to_numpy() for name in
                          ("degree", "harmonics"))  # fmt: skip
    parts = np.split(vectors, np.cumsum(sizes)[:-1])
    for place, sector in enumerate(sectors):
        truncation = Truncation(int(degrees[place]), int(harmonics[place]))
        yield Mode(complex(values[place]), parts[place], sector, truncation)
