"""All that is measured on a web, as its methods."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.web.statistics.cloudiness import cloudiness
from fpsolve.web.statistics.estimate import Estimate, Estimates
from fpsolve.web.statistics.formation import formation_number
from fpsolve.web.statistics.orientation import (
    machine_cross_ratio,
    mean_orientation,
    orientation_rose,
)
from fpsolve.web.statistics.spectrum import PowerSpectrum, power_spectrum
from fpsolve.web.statistics.strips import Strips, strips
from fpsolve.web.statistics.zones import coefficient_of_variation, mean_density

__all__ = ["Measured"]


class Measured(ABC):
    """Methods of what has a `length_density`, a `pixel` and an `orientation`.

    Lengths are in the unit of the pixel. Every number has a `standard_error` from
    independent blocks of the web.
    """

    length_density: Array

    @property
    @abstractmethod
    def pixel(self) -> float:
        """Side of a pixel."""

    @property
    @abstractmethod
    def orientation(self) -> Array:
        """⟨τ⊗τ⟩ of every pixel."""

    def mean_length_density(self, *, block: float | None = None) -> Estimate:
        """⟨m⟩, mean laid length per area; 1/(v d) is expected.

        Parameters
        ----------
        block : float, optional
            Side of the blocks.

        Returns
        -------
        Estimate
        """
        return mean_density(self.length_density, self.pixel, block=block)

    def coefficient_of_variation(
        self, zone: Any, *, block: float | None = None
    ) -> Estimate | Estimates:
        """CV(x) = (⟨m²⟩ - ⟨m⟩²)^½ / ⟨m⟩ over square zones of side x.

        Parameters
        ----------
        zone : float or sequence of float
            Side of a zone, or many; at least the pixel, at most the web.
        block : float, optional
            Side of the blocks; by default two correlation lengths, or more.

        Returns
        -------
        Estimate or Estimates

        Raises
        ------
        TypeError, ValueError
            As `fpsolve.web.statistics.zones.coefficient_of_variation`.
        """
        return coefficient_of_variation(
            self.length_density, self.pixel, zone, block=block
        )

    def formation_number(self, zone: float, *, block: float | None = None) -> Estimate:
        """CV²(x) over that of random straight fibres, 0.946402/(⟨m⟩ x).

        Parameters
        ----------
        zone : float
            Side x of the zones.
        block : float, optional
            Side of the blocks.

        Returns
        -------
        Estimate
        """
        return formation_number(self.length_density, self.pixel, zone, block=block)

    def cloudiness(
        self, band: Any, *, block: float | None = None
    ) -> Estimate | Estimates:
        """The part of CV² whose wavelengths lie in a band; all bands add up to CV².

        Parameters
        ----------
        band : pair of float, or sequence of pairs
            Shortest and longest wavelength.
        block : float, optional
            Side of the blocks.

        Returns
        -------
        Estimate or Estimates
        """
        return cloudiness(self.length_density, self.pixel, band, block=block)

    @property
    def mean_orientation(self) -> Array:
        """⟨τ⊗τ⟩ over laid length, trace 1; first index the machine direction."""
        return mean_orientation(self.length_density, self.pixel, self.orientation)

    def machine_cross_ratio(self, *, block: float | None = None) -> Estimate:
        """MD/CD = ⟨τ₁²⟩/⟨τ₂²⟩ over laid length.

        Parameters
        ----------
        block : float, optional
            Side of the blocks.

        Returns
        -------
        Estimate
        """
        return machine_cross_ratio(
            self.length_density, self.pixel, self.orientation, block=block
        )

    def orientation_rose(
        self, *, n_bins: int = 36, block: float | None = None
    ) -> Estimates:
        """The density of laid length over the angle to the machine direction.

        Parameters
        ----------
        n_bins : int
            Bins of a half turn.
        block : float, optional
            Side of the blocks.

        Returns
        -------
        Estimates
        """
        return orientation_rose(
            self.length_density, self.pixel, self.orientation,
            n_bins=n_bins, block=block,
        )  # fmt: skip

    def power_spectrum(
        self, *, block: float | None = None, window: str = "hann"
    ) -> PowerSpectrum:
        """P(k) of the density, with its sections and means over rings.

        Parameters
        ----------
        block : float, optional
            Side of the blocks, to which the resolution belongs.
        window : {"hann", "none"}
            That of the blocks.

        Returns
        -------
        PowerSpectrum
        """
        return power_spectrum(
            self.length_density, self.pixel, block=block, window=window
        )

    def strips(
        self,
        *,
        direction: str = "machine",
        period: float | None = None,
        block: float | None = None,
    ) -> Strips:
        """The strongest wave of the mean profile, held against noise.

        Parameters
        ----------
        direction : {"machine", "cross"}
            Along which the strips run.
        period : float, optional
            The period, if it is known.
        block : float, optional
            Length of the stretches that are compared.

        Returns
        -------
        Strips
        """
        return strips(
            self.length_density, self.pixel,
            direction=direction, period=period, block=block,
        )  # fmt: skip
