"""Spectra of the generator of (9): decay rates to many digits, independent of grids."""

from fpsolve.spectral.gap import SpectralGap, spectral_gap
from fpsolve.spectral.optimal import OptimalNoise, optimal_noise
from fpsolve.spectral.sectors import Sector
from fpsolve.spectral.spectrum import Spectrum, spectrum

__all__ = [
    "OptimalNoise",
    "Sector",
    "SpectralGap",
    "Spectrum",
    "optimal_noise",
    "spectral_gap",
    "spectrum",
]
