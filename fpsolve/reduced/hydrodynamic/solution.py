"""What the limit equation gives: densities 𝒫(ξ, s) with their series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.grids.plane import PlaneGrid
from fpsolve.reduced.hydrodynamic.equation import LimitEquation
from fpsolve.reduced.hydrodynamic.layout import SOLUTION
from fpsolve.reduced.relaxed import Relaxed

__all__ = ["HydrodynamicSolution", "HydrodynamicSteadyState"]


@dataclass(frozen=True, eq=False, repr=False)
class HydrodynamicSteadyState:
    """𝒫_S = c exp(−B + v ξ1/ε) on a grid, and how well it is stationary there.

    Attributes
    ----------
    density : ndarray, shape (n1, n2)
        exp(−Φ) at the cell centres, normalised on the grid: the exact stationary
        density of the discrete equation.
    residual : float
        Σ |Q m|, m the cell masses: the rate per unit of s at which the discrete
        equation still changes it, in L¹; rounding only.
    boundary_mass : float
        Share of mass in the outermost cells.
    grid : PlaneGrid
    error : float
        Estimate of ∫ |𝒫 − 𝒫_S| dξ over the plane: twice what the box leaves out, and
        what the midpoint rule misses of the mass inside, by half the cells.
    """

    density: Array
    residual: float
    boundary_mass: float
    grid: PlaneGrid
    error: float = np.nan

    def __repr__(self) -> str:
        return (
            f"HydrodynamicSteadyState(L1 error {self.error:.1g}, residual "
            f"{self.residual:.1g}, boundary mass {self.boundary_mass:.1g}, grid "
            f"{self.grid.shape})"
        )


@dataclass(frozen=True, eq=False, repr=False)
class HydrodynamicSolution(Relaxed):
    """The densities 𝒫(ξ, s) that were saved, and series over every recorded step.

    Every series is an attribute: `solution.s`, `mass`, `relative_entropy` (to the
    discrete 𝒫_S), `entropy_dissipation`, `minimum`, `boundary_mass`, `mean_xi1`,
    `mean_xi2`, `variance_xi1`, `variance_xi2`, `covariance`; all of shape
    (n_recorded,) and dimensionless.

    Attributes
    ----------
    limit : HydrodynamicLimit or None
        None for a file whose potential was the user's own code.
    grid : PlaneGrid
    method : str
    ds : float
        Step; with extrapolation the longer of the two.
    series : dict of ndarray
    saved_s : ndarray, shape (n_saved,)
    densities : ndarray, shape (n_saved, n1, n2)
    errors : dict of ndarray, or None
        Richardson estimates in ds: "density_l1" (n_saved,) and one array for each
        series that depends on ds. The error of the grid comes in addition.
    provenance : dict
        Versions, date, times, number of steps.
    initial_density : ndarray, shape (n1, n2), or None
        𝒫0, from which the run began.
    status : str
        "finished", "interrupted" or "failed".
    call : Call or None
        How it was called.
    """

    kind: ClassVar[str] = "hydrodynamic"
    layout = SOLUTION

    limit: LimitEquation | None
    grid: PlaneGrid
    method: str
    ds: float
    series: Mapping[str, Array]
    saved_s: Array
    densities: Array
    errors: Mapping[str, Array] | None = None
    provenance: dict[str, Any] = field(default_factory=dict)
    initial_density: Array | None = None
    status: str = "finished"
    call: Call | None = None

    def __repr__(self) -> str:
        return (
            f"HydrodynamicSolution(to s = {self.series['s'][-1]:g}, {self.method}, "
            f"ds = {self.ds:g}, grid {self.grid.shape}, {len(self.saved_s)} saved "
            "densities)"
        )
