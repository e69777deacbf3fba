"""A spectrum as a labelled `xarray.Dataset`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, marked, origin, to_json
from fpsolve.model.stored import describe_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["spectrum_dataset"]


def spectrum_dataset(found: Any) -> xr.Dataset:
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
    numbers = {"index": np.arange(len(found.eigenvalues))}
    dataset = xr.Dataset({**variables, **_modes(found)}, numbers, _attributes(found))
    dataset = dataset if found.call is None else found.call.on(dataset)
    return marked(dataset, "spectrum")


def _modes(found: Any) -> dict[str, Any]:
    """Coefficients of all eigenfunctions, one behind the other."""
    modes = found._modes
    vectors = np.concatenate([np.zeros(0, complex), *(mode.vector for mode in modes)])
    sizes = np.array([mode.truncation for mode in modes], np.int64).reshape(-1, 2)
    degrees, harmonics = "degree of its basis", "largest harmonic of its basis"
    lengths = np.array([mode.vector.size for mode in modes], np.int64)
    return {
        "mode_degree": ("index", sizes[:, 0], labels(degrees)),
        "mode_harmonics": ("index", sizes[:, 1], labels(harmonics)),
        "mode_size": ("index", lengths, labels("coefficients of the eigenfunction")),
        "mode_real": ("coefficient", vectors.real, labels("Re of coefficients")),
        "mode_imag": ("coefficient", vectors.imag, labels("Im of coefficients")),
    }


def _attributes(found: Any) -> dict[str, Any]:
    model, provenance = found.model, found.provenance
    about = {
        "title": "Eigenvalues of the generator",
        **describe_model(model, None if model is None else model.equation, provenance),
        "gap": found.gap,
        "gap_error": found.gap_error,
        "truncation": to_json([int(number) for number in found.truncation]),
        "sectors": to_json([sector.to_dict() for sector in found.sectors]),
        **origin(provenance),
    }
    return about if found.essential is None else {**about, "essential": found.essential}
