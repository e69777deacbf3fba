"""Eigenvalues of the full generator over A² against those of the energy process."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.labels import labels
from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.spectral.bases.choice import discretisation_for
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.spectrum import spectrum
from fpsolve.studies.arguments import noises_of
from fpsolve.studies.sweeps.study import study_dataset, texts

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["small_noise_spectrum"]

FAMILIES = ("even", "odd")
# Eigenvalues asked for, more and more, until a real one is among them.
_COUNTS = (3, 5, 9)
_REAL = 1e-8


@recorded()
def small_noise_spectrum(
    potential: Potential, noises: Iterable[float], *, tolerance: float = 1e-6
) -> xr.Dataset:
    """Slowest real rates of the sectors M = 0, even and odd, over A².

    Functions of G live in the angular index M = 0. Reflection maps G to -G, so that the
    even sector tends to the even family of the energy process (functions of |G|) and
    the odd sector to the odd one. The odd one holds the slowest rate of all, A²/2
    exactly; whoever restricts β to [0, π] sees the even family only and finds a gap
    2.7 times as large for B = |ξ|²/2.

    Parameters
    ----------
    potential : Potential
        Isotropic, with a single well.
    noises : iterable of float
        Noise amplitudes A, positive. Below about 0.25 the even sector needs bases of
        gigabytes.
    tolerance : float
        Relative tolerance of the eigenvalues.

    Returns
    -------
    xarray.Dataset
        `rate`, `rate_error` (both over A²) over (family, noise), NaN where a basis does
        not fit into memory, `limit` and `limit_error` over family.

    Raises
    ------
    ValueError, TypeError
        If the potential has no energy process or a noise is not positive.

    References
    ----------
    [KMW09]_, equations (15) and (16).
    """
    process = EnergyProcess(potential, 1.0)
    amplitudes = np.unique(noises_of(noises))[::-1]
    found = {family: process.spectrum(2, family) for family in FAMILIES}
    # The even family begins with the constants, which do not decay.
    places = {"even": 1, "odd": 0}
    rows = [
        [_slowest(potential, noise, family, tolerance) for noise in amplitudes]
        for family in FAMILIES
    ]
    rates, errors = np.moveaxis(np.array(rows), -1, 0)
    limits = [found[family].eigenvalues[places[family]] for family in FAMILIES]
    uncertain = [found[family].errors[places[family]] for family in FAMILIES]
    over = ("family", "noise")
    variables = {
        "rate": (over, rates, labels("slowest real rate of the sector M = 0 over A²")),
        "rate_error": (over, errors, labels("truncation error of the rate over A²")),
        "limit": ("family", limits, labels("rate of the energy process for A = 1")),
        "limit_error": ("family", uncertain, labels("error of the limit")),
    }
    coordinates = {
        "family": ("family", texts(FAMILIES)),
        "noise": ("noise", amplitudes, labels("noise amplitude A")),
    }
    kind, title = "small-noise-spectrum", "Spectrum in the limit of little noise"
    about = {"tolerance": tolerance}
    return study_dataset(kind, title, potential, variables, coordinates, about)


def _slowest(
    potential: Potential, noise: float, family: str, tolerance: float
) -> tuple[float, float]:
    """Smallest real rate of a sector and its error, over A²."""
    model = LayDownModel(potential, noise)
    try:
        for count in _COUNTS:
            found = spectrum(
                model, count, tolerance=tolerance, sectors=[_sector(model, family)]
            )
            real = np.abs(found.eigenvalues.imag) <= _REAL * noise**2
            if real.any():
                place = int(np.flatnonzero(real)[0])
                rate = -float(found.eigenvalues[place].real)
                return rate / noise**2, float(found.errors[place]) / noise**2
    except (MemoryLimitError, ToleranceError):
        pass
    return math.nan, math.nan


def _sector(model: LayDownModel, family: str) -> Sector:
    """M = 0 even or M = 0 odd, the first two sectors of an isotropic potential."""
    first = islice(discretisation_for(model).sectors(), len(FAMILIES))
    return next(sector for sector in first if str(sector) == f"M = 0 {family}")
