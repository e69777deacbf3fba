"""What an expansion in time leaves behind."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import told_apart
from fpsolve.evolution.call import Call
from fpsolve.evolution.evolution import WithSeries
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import index_of
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution import quadrature, rings
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.layout import SOLUTION
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion
from fpsolve.spectral.evolution.steady import SpectralSteadyState, spectral_steady_state

__all__ = ["SpectralSolution"]


@dataclass(frozen=True, eq=False)
class SpectralSolution(WithSeries, Saved):
    """H(s) and moments of p(ξ, α, s), with an error estimate for every number.

    Attributes `mass`, `relative_entropy`, `mean_xi1`, `mean_xi2`, `variance_xi1`,
    `variance_xi2`, `covariance`, `mean_cos_alpha`, `mean_sin_alpha` are the series,
    each of shape (n,) and dimensionless.

    Attributes
    ----------
    model : LayDownModel
    s : ndarray, shape (n,)
    series : dict of ndarray
    errors : dict of ndarray
        One estimate for each number of `series`. In sectors (isotropic B on a belt at
        rest) a bound from what was left out, see `spectral_solve`, and rounding.
        Otherwise the change from the next coarser truncation, which bounds the error as
        long as refinement helps, plus what rounding did to the mass. For the entropy
        that of its quadrature is added. Next to zero where a value is known in closed
        form.
    truncation : tuple of (int, int)
        Degree and largest harmonic kept at each s.
    tolerance : float
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "spectral"
    layout = SOLUTION

    model: LayDownModel
    s: Array
    series: dict[str, Array]
    errors: dict[str, Array]
    truncation: tuple[tuple[int, int], ...]
    tolerance: float
    _expansions: tuple[Expansion, ...] | tuple[SectorExpansion, ...]
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        worst = max(float(values.max()) for values in self.errors.values())
        degree, harmonics = np.max(self.truncation, axis=0)
        return (
            f"SpectralSolution(s = {self.s[0]:g} to {self.s[-1]:g} at {self.s.size} "
            f"places, degree {degree}, harmonics {harmonics}, largest error "
            f"{worst:.1e})"
        )

    def density(self, s: float, grid: PhaseSpaceGrid) -> Array:
        """p(ξ, α, s) at the cell centres of a grid; shape ``grid.shape``.

        Raises
        ------
        ValueError
            If s is not one of `s`.
        """
        place = index_of(self.s, s)
        if place is None:
            *known, got = told_apart(*self.s.tolist(), s)
            raise ValueError(f"`s` must be one of {', '.join(known)}, got {got}.")
        potential, h = quadratic(self.model), self._expansions[place]
        if isinstance(h, SectorExpansion):
            return rings.density_on(h, grid, potential.sigma1)
        return quadrature.density_on(h, grid, potential)

    @cached_property
    def steady_state(self) -> SpectralSteadyState:
        """The stationary density that p tends to, with moments and their errors."""
        found = spectral_steady_state(self.model, tolerance=self.tolerance)
        assert isinstance(found, SpectralSteadyState)
        return found
