"""Models that differ in their noise alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.choice import discretisation_for, orbit_radius
from fpsolve.spectral.bases.sectors import Discretisation
from fpsolve.spectral.eigen.settings import essential_of

__all__ = ["Family"]


@dataclass(frozen=True)
class Family:
    """A ↦ the model with noise A, on a fixed belt.

    Parameters
    ----------
    potential : Potential
    relaxation_length : float, optional
        R of smooth fibres; basic ones without it.
    """

    potential: Potential
    relaxation_length: float | None = None

    def model(self, noise: float) -> FibreModel:
        """The model with noise A."""
        if self.relaxation_length is None:
            return LayDownModel(self.potential, noise)
        return SmoothLayDownModel(self.potential, self.relaxation_length, noise)

    def basis(self, noise: float) -> Discretisation:
        """What discretises its generator."""
        return discretisation_for(self.model(noise))

    def essential(self, noise: float) -> float | None:
        """Right end of the essential spectrum, None without one."""
        return essential_of(self.model(noise))

    @property
    def smooth(self) -> bool:
        """Whether the fibres have a relaxation length."""
        return self.relaxation_length is not None

    @property
    def unit(self) -> float:
        """The noise for which the circular orbit has radius 1: 1/√r."""
        return 1 / math.sqrt(orbit_radius(self.potential))
