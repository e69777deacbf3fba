"""The spectral gap alone."""

from __future__ import annotations

from typing import Any

from fpsolve.model.fibre import FibreModel
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.spectrum import Spectrum, spectrum

__all__ = ["SpectralGap", "spectral_gap"]


class SpectralGap(float):
    """-max Re λ over the spectrum of L without 0, a float with its error.

    Parameters
    ----------
    rate : float
        The gap.

    Attributes
    ----------
    error : float
        Estimated error, see `Spectrum.errors`.
    sector : Sector or None
        Where the eigenvalue belongs; None when the essential spectrum is the slowest.
    eigenvalue : complex
        The eigenvalue itself, with imaginary part >= 0.
    """

    error: float
    sector: Sector | None
    eigenvalue: complex

    def __new__(
        cls, rate: float, error: float, sector: Sector | None, eigenvalue: complex
    ) -> SpectralGap:
        """A float with attributes."""
        gap = super().__new__(cls, rate)
        gap.error, gap.sector, gap.eigenvalue = error, sector, eigenvalue
        return gap

    @classmethod
    def of(cls, found: Spectrum) -> SpectralGap:
        """From a spectrum."""
        if not found.is_isolated:
            return cls(found.gap, found.gap_error, None, complex(-found.gap))
        value = complex(found.eigenvalues[0])
        return cls(found.gap, found.gap_error, found.sectors[0], value)

    def __getnewargs__(self) -> tuple[Any, ...]:
        return float(self), self.error, self.sector, self.eigenvalue


def spectral_gap(
    model: FibreModel,
    *,
    tolerance: float | None = None,
    memory_limit: int | None = None,
    work_limit: float | None = None,
) -> SpectralGap:
    """-max {Re λ : λ ≠ 0 in the spectrum of L}: the asymptotic rate of convergence.

    ‖p_s/p_S - 1‖ in L²(μ) decays like exp(-gap s), relative entropy twice as fast; at a
    double eigenvalue times 1 + s. For a quadratic potential gap(σ, A) =
    gap(1, √σ A)/σ.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        As for `spectrum`.
    tolerance : float, optional
        Largest error relative to the gap; by default as for `spectrum`.
    memory_limit : int, optional
        As for `spectrum`.
    work_limit : float, optional
        As for `spectrum`.

    Returns
    -------
    SpectralGap
        A float with `error`, `sector` and `eigenvalue`.

    Raises
    ------
    ValueError, MemoryLimitError, ToleranceError
        As for `spectrum`.

    References
    ----------
    [KMW09]_, section 3.1.1; that there is a gap: [DKMS13]_.
    """
    found = spectrum(
        model, 1, tolerance=tolerance, memory_limit=memory_limit, work_limit=work_limit
    )
    return SpectralGap.of(found)
