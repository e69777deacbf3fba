"""How a spectrum is stored: over `index`, slowest first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
)
from fpsolve.evolution.parts import Model
from fpsolve.spectral.bases.choice import discretisation_for
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.eigen.survey import Mode

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SPECTRUM"]

_INDEX = ("index",)


class _Eigenvalues(Part):
    """Eigenvalues, in two parts."""

    needed = ("real", "imag")

    def write(self, result: Any) -> Stored:
        values = result.eigenvalues
        return {
            "index": ("index", np.arange(len(values))),
            "real": (_INDEX, values.real, labels("Re λ")),
            "imag": (_INDEX, values.imag, labels("Im λ")),
        }

    def read(self, source: Source) -> dict[str, Any]:
        return {"eigenvalues": joined(source.dataset)}


class _Sectors(Part):
    """Where each eigenvalue belongs, in words and as JSON; one for each of them."""

    needed = ("sector", "sectors")

    def write(self, result: Any) -> Stored:
        words = np.array([str(one) for one in result.sectors], dtype=object)
        described = to_json([one.to_dict() for one in result.sectors])
        return {"sector": (_INDEX, words), "sectors": described}

    def read(self, source: Source) -> dict[str, Any]:
        sectors = [Sector(**one) for one in source.about["sectors"]]
        n = source.dataset.sizes["index"]
        check_counts("sectors", len(sectors), n, "`index`")
        return {"sectors": sectors}


class _Modes(Part):
    """Coefficients of all eigenfunctions, one behind the other.

    Without a model there is no basis, and no eigenfunction.
    """

    needed = ("mode_degree", "mode_harmonics", "mode_size", "mode_real", "mode_imag")

    def write(self, result: Any) -> Stored:
        modes = result._modes
        vectors = np.concatenate(
            [np.zeros(0, complex), *(mode.vector for mode in modes)]
        )
        sizes = np.array([mode.truncation for mode in modes], np.int64).reshape(-1, 3)
        lengths = np.array([mode.vector.size for mode in modes], np.int64)
        of, coefficient = "coefficients of the eigenfunction", ("coefficient",)
        stored: Stored = {
            "mode_degree": (_INDEX, sizes[:, 0], labels("degree of its basis")),
            "mode_harmonics": (_INDEX, sizes[:, 1],
                               labels("largest harmonic of its basis")),
            "mode_size": (_INDEX, lengths, labels(of)),
            "mode_real": (coefficient, vectors.real, labels("Re of coefficients")),
            "mode_imag": (coefficient, vectors.imag, labels("Im of coefficients")),
        }  # fmt: skip
        if sizes[:, 2].any():
            words = labels("degree in κ of its basis")
            stored["mode_curvature"] = _INDEX, sizes[:, 2], words
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        model, sectors = source.fields["model"], source.fields["sectors"]
        if model is None:
            return {"_modes": [], "_discretisation": None}
        modes = list(modes_of(source.dataset, source.fields["eigenvalues"], sectors))
        return {"_modes": modes, "_discretisation": discretisation_for(model)}


def joined(dataset: xr.Dataset, prefix: str = "") -> Any:
    """Complex numbers from two variables."""
    real, imag = (dataset[prefix + part].to_numpy() for part in ("real", "imag"))
    # Not by a sum, which would lose the sign of a zero.
    values = np.empty(np.shape(real), complex)
    values.real, values.imag = real, imag
    return values


def modes_of(
    dataset: xr.Dataset, eigenvalues: Any, sectors: Sequence[Sector]
) -> Iterator[Mode]:
    """Every mode with its own coefficients."""
    vectors = joined(dataset, "mode_")
    degrees, harmonics, sizes = (dataset[name].to_numpy() for name in _Modes.needed[:3])
    curvatures = np.zeros_like(degrees)
    if "mode_curvature" in dataset:
        curvatures = dataset["mode_curvature"].to_numpy()
    check_counts("mode_size", int(sizes.sum()), vectors.size, "`mode_real`")
    parts = np.split(vectors, np.cumsum(sizes)[:-1])
    for place, sector in enumerate(sectors):
        limits = degrees[place], harmonics[place], curvatures[place]
        truncation = Truncation(*map(int, limits))
        yield Mode(complex(eigenvalues[place]), parts[place], sector, truncation)


SPECTRUM = Layout(
    "Eigenvalues of the generator",
    Model(),
    _Eigenvalues(),
    Variable("error", _INDEX, "error of λ", "errors"),
    Variable("residual", _INDEX, "‖Lf − λf‖/‖f‖", "residuals"),
    Variable("multiplicity", _INDEX, "sectors with this eigenvalue",
             values=lambda found: found.multiplicities),
    _Sectors(),
    _Modes(),
    Attribute("gap", values=lambda found: found.gap),
    Attribute("gap_error", values=lambda found: found.gap_error),
    Attribute("truncation", write_as=lambda sizes: to_json([int(one) for one in sizes]),
              read_as=lambda sizes: Truncation(*sizes)),
    Attribute("essential", optional=True),
)  # fmt: skip
