"""What the limit equation gives: densities 𝒫(ξ, s) with their series."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.netcdf import write_dataset
from fpsolve.evolution.call import Call
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.evolution.schedule import saved_index
from fpsolve.grids.plane import PlaneGrid
from fpsolve.reduced.hydrodynamic.dataset import to_xarray
from fpsolve.reduced.hydrodynamic.equation import LimitEquation

if TYPE_CHECKING:
    import xarray


__all__ = ["HydrodynamicSolution", "HydrodynamicSteadyState"]

Array = NDArray[np.float64]


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


@dataclass(frozen=True, eq=False)
class HydrodynamicSolution:
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

    def __getattr__(self, name: str) -> Array:
        # Only called for names that are not fields; guards against half-built
        # objects, as pickle and copy make them.
        series: Mapping[str, Array] = self.__dict__.get("series", {})
        if name in series:
            found: Array = series[name]
            return found
        raise AttributeError(
            f"HydrodynamicSolution has no attribute {name!r}; its series are "
            f"{', '.join(series)}."
        )

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.series]

    def __repr__(self) -> str:
        return (
            f"HydrodynamicSolution(to s = {self.series['s'][-1]:g}, {self.method}, "
            f"ds = {self.ds:g}, grid {self.grid.shape}, {len(self.saved_s)} saved "
            "densities)"
        )

    def density(self, s: float) -> Array:
        """Saved density 𝒫 at s; shape (n1, n2).

        Raises
        ------
        ValueError
            If no density was saved at s.
        """
        found: Array = self.densities[saved_index(self.saved_s, s, self.ds)]
        return found

    def entropy_rate(self, window: tuple[float, float] | None = None) -> DecayRate:
        """Rate λ of H ~ e^{−λs}, fitted on a window of s; tends to twice the gap.

        Twice that of the grid: its error contains that of the step, from `errors` if
        there are any, and nothing of the cells. An implicit step of length h takes a
        mode e^{−λs/2} by a factor of which the rate is short by the share λh/4
        (backward_euler) or (λh)²/40 (sdirk2).
        """
        s, entropy = self.series["s"], self.series["relative_entropy"]
        known = (self.errors or {}).get("relative_entropy")
        if known is not None:
            return fit_decay(s, entropy, window, errors=known)
        turn = fit_decay(s, entropy, window).rate * self.ds
        first_order = self.method == "backward_euler"
        return fit_decay(
            s, entropy, window, step_error=turn / 4 if first_order else turn**2 / 40
        )

    def to_xarray(self) -> xarray.Dataset:
        """Labelled Dataset: densities (s, xi1, xi2), series over the steps."""
        return to_xarray(self)

    def save(self, path: str | Path, engine: str | None = None) -> Path:
        """Write the solution to netCDF, or to zarr for a path that ends in .zarr."""
        return write_dataset(self.to_xarray(), path, engine)
