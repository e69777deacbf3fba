"""A spectrum as a labelled `xarray.Dataset`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, made_with, to_json

if TYPE_CHECKING:
    import xarray as xr

    from fpsolve.spectral.eigen.spectrum import Spectrum

__all__ = ["spectrum_dataset"]


def spectrum_dataset(found: Spectrum) -> xr.Dataset:
    """Return a spectrum as a Dataset over `index`, slowest first.

    Parameters
    ----------
    found : Spectrum
    """
    import xarray as xr

    values = {
        "real": (found.eigenvalues.real, "Re λ"),
        "imag": (found.eigenvalues.imag, "Im λ"),
        "error": (found.errors, "error of λ"),
        "residual": (found.residuals, "‖Lf − λf‖/‖f‖"),
        "multiplicity": (found.multiplicities, "sectors with this eigenvalue"),
    }
    variables: dict[str, Any] = {
        name: ("index", np.asarray(array), labels(meaning))
        for name, (array, meaning) in values.items()
    }
    variables["sector"] = (
        "index",
        np.array([str(one) for one in found.sectors], dtype=object),
    )
    attributes = {
        "title": "Eigenvalues of the generator",
        "equation": found.model.equation,
        "model": to_json(found.model.to_dict()),
        "gap": found.gap,
        "gap_error": found.gap_error,
        "truncation": json.dumps([int(number) for number in found.truncation]),
        **made_with(),
    }
    if found.essential is not None:
        attributes["essential"] = found.essential
    return xr.Dataset(
        variables, {"index": np.arange(len(found.eigenvalues))}, attributes
    )
