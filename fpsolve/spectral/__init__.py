"""Spectra of the generator of (9): decay rates to many digits, independent of grids."""

from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.gap import SpectralGap, spectral_gap
from fpsolve.spectral.eigen.optimal import OptimalNoise, optimal_noise
from fpsolve.spectral.eigen.spectrum import Spectrum, spectrum

__all__ = [
    "OptimalNoise",
    "Sector",
    "SpectralGap",
    "Spectrum",
    "optimal_noise",
    "spectral_gap",
    "spectrum",
]
