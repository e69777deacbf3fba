"""How much of the variation of a web lies in clouds of a given size."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import shown
from fpsolve.web.statistics.estimate import Estimate, Estimates
from fpsolve.web.statistics.fields import check_density
from fpsolve.web.statistics.jackknife import estimate

__all__ = ["cloudiness"]


def cloudiness(
    length_density: Any, pixel: float, band: Any, *, block: float | None = None
) -> Estimate | Estimates:
    """C(λ₁, λ₂) = Σ_{λ₁ ≤ λ < λ₂} |c_jl|²: the part of CV² with wavelengths in a band.

    c_jl are the orthonormal cosine coefficients of (m - ⟨m⟩)/⟨m⟩ over the web, divided
    by the root of the number of pixels; its waves have k = π (j/width, l/length) and
    λ = 2π/‖k‖. Bands that share out 0 ≤ λ ≤ ∞ add up to CV² of the pixels, to rounding.
    Cosines continue the web as a mirror does: an edge is no jump, which sines and
    cosines over a web that is not periodic would take for short waves.

    A narrow band has few waves, which reach over many blocks. The standard error is
    the larger one of that of the blocks, which fibres in clumps widen, and that of
    independent normal coefficients.

    Parameters
    ----------
    length_density, pixel
        As for `coefficient_of_variation`.
    band : pair of float, or sequence of pairs
        Shortest and longest wavelength, 0 ≤ λ₁ < λ₂ ≤ ∞.
    block : float, optional
        Side of the blocks; by default at least λ₂, and as `coefficient_of_variation`.

    Returns
    -------
    Estimate or Estimates
        For a sequence of bands over their shortest wavelengths. `n_samples` are pixels.

    Raises
    ------
    TypeError, ValueError
        As for `coefficient_of_variation`, and where a band is none.

    References
    ----------
    [DCL02]_.
    """
    density, pixel = check_density(length_density, pixel)
    bands = check_numbers("band", band)
    if bands.ndim not in (1, 2) or bands.shape[-1] != 2 or bands.size == 0:
        raise ValueError(
            "`band` must be a shortest and a longest wavelength, or a list of such "
            f"pairs, got {shown(band)}."
        )
    found = _Waves(density, pixel)
    made = [found.power(_checked(one), block) for one in np.atleast_2d(bands)]
    return made[0] if bands.ndim == 1 else Estimates.of(bands[:, 0], made)


class _Waves:
    """Cosine coefficients of a density, with the wavelength of each."""

    def __init__(self, density: Array, pixel: float) -> None:
        from scipy.fft import dctn

        self.density, self.pixel = density, pixel
        self.coefficients = dctn(density - density.mean(), norm="ortho")
        # Cycles per length: half a wave over the web is the first.
        cross, machine = (np.arange(n) / (2.0 * n * pixel) for n in density.shape)
        frequency = np.hypot(cross[:, None], machine)
        # The mean is no wave.
        frequency[0, 0] = np.nan
        self.wavelength = 1.0 / frequency

    def power(self, band: tuple[float, float], block: float | None) -> Estimate:
        """Return ⟨f²⟩/⟨m⟩², f the part of the density that lies in the band."""
        from scipy.fft import idctn

        shortest, longest = band
        inside = (self.wavelength >= shortest) & (self.wavelength < longest)
        waves = np.where(inside, self.coefficients, 0.0)
        part = idctn(waves, norm="ortho")
        # No wave is longer than twice the web.
        longest = min(longest, 2.0 * self.pixel * max(self.density.shape))
        fields = [part**2, self.density]
        found = estimate(_relative_power, fields, self.pixel, block, longest)
        scale = self.density.size * self.density.mean() ** 2
        return _at_least(found, _gaussian_error(waves) / scale)


def _gaussian_error(waves: Array) -> float:
    """Return the standard error of Σ c² for normal c: 2 c⁴/3 estimates 2 σ⁴."""
    return math.sqrt(2.0 / 3.0 * float(np.sum(waves**4)))


def _at_least(found: Estimate, error: float) -> Estimate:
    """Return the estimate with a standard error of at least that; NaN stays."""
    largest = float(np.maximum(found.standard_error, error))
    return Estimate(
        float(found), largest, found.n_blocks, found.n_samples, found.reason
    )


def _relative_power(means: Array) -> Array:
    return np.asarray(means[..., 0] / means[..., 1] ** 2)


def _checked(band: Array) -> tuple[float, float]:
    """Return the ends of a band; ValueError unless 0 ≤ λ₁ < λ₂."""
    shortest, longest = float(band[0]), float(band[1])
    if not 0 <= shortest < longest <= math.inf:
        raise ValueError(
            "`band` must be a shortest and a longest wavelength with 0 ≤ λ₁ < λ₂, got "
            f"({shortest:g}, {longest:g})."
        )
    return shortest, longest
