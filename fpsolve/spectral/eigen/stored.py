"""What a file holds of a spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.declared import declared
from fpsolve.model.laydown import LayDownModel

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["StoredSpectrum", "stored_spectrum"]


@dataclass(frozen=True)
class StoredSpectrum:
    """What a file holds of a Spectrum: enough to draw it."""

    model: LayDownModel
    eigenvalues: NDArray[np.complex128]
    sectors: list[str]
    gap: float
    essential: float | None


def stored_spectrum(dataset: xr.Dataset) -> StoredSpectrum:
    """Return what a figure needs of the dataset of a spectrum."""
    about = declared(dataset.attrs)
    return StoredSpectrum(
        model=LayDownModel.from_dict(about["model"]),
        eigenvalues=dataset["real"].to_numpy() + 1j * dataset["imag"].to_numpy(),
        sectors=[str(sector) for sector in dataset["sector"].to_numpy()],
        gap=about["gap"],
        essential=about.get("essential"),
    )
