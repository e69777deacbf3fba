"""What a run leaves behind."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.netcdf import write_dataset
from fpsolve._support.streaming import Streamed
from fpsolve.density.error_laws import mean_square_force, slope_at_origin
from fpsolve.density.layout import SOLUTION, is_saved
from fpsolve.evolution.call import Call
from fpsolve.evolution.decay import DecayRate
from fpsolve.evolution.evolution import Evolution
from fpsolve.evolution.stored import LazyDensities
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["Solution"]


# Error of a decay rate relative to it, over (A⁴ + ⟨|∇B|²⟩) ds²: 1/48 at most for
# drift_kick, quadratic, linear and quartic B, 0.3 ≤ A ≤ 5; and what others have more.
RATE_ERROR, OTHER_SCHEMES = 1 / 40, 3.0
# The same over (B'(0) cell)², where B has a kink: 0.37 for |ξ| and A = 0.3.
KINK_ERROR = 0.4


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Evolution):
    """The densities p(ξ, α, s) that were saved, and series over every recorded step.

    Every series is an attribute: `solution.s`, `mass`, `relative_entropy`,
    `entropy_dissipation`, `minimum`, `negative_mass`, `boundary_mass`,
    `mass_correction`, the moments `mean_xi1`, `mean_xi2`, `variance_xi1`,
    `variance_xi2`, `covariance`, `mean_cos_alpha`, `mean_sin_alpha`, and `theta` for
    the semi-Lagrangian scheme, `mean_kappa`, `mean_kappa2`, `kappa_boundary_mass` for
    smooth fibres.
    All of shape (n_recorded,) and dimensionless.

    Attributes
    ----------
    model : LayDownModel or None
        None for a file whose potential or curve was the user's own code.
    grid : PhaseSpaceGrid
    scheme : dict
        Name, order and options of the scheme.
    ds : float
        Step; with extrapolation the longer of the two.
    series : dict of ndarray
    saved_s : ndarray, shape (n_saved,)
    densities : ndarray, shape (n_saved, n1, n2, n_alpha)
        Of a smooth fibre with n_kappa besides. After a run with checkpoints
        `LazyDensities`, which are read from the disk one by one; `numpy.asarray` makes
        an array of them.
    entropy_floor : float
        Value H tends to on this grid; see `diagnostics.entropy_floor`.
    status : str
        "finished", "interrupted" or "failed".
    message : str
        Why the run ended.
    errors : dict of ndarray, or None
        Richardson estimates: "density_l1" (n_saved,) and one array per series.
    provenance : dict
        Versions, date, times, number of steps.
    initial_density : ndarray, shape (n1, n2, n_alpha), or None
        p0, from which the run began; None for a file that does not hold it.
    reference : ndarray or None
        What the entropy is relative to, if it was given.
    call : Call or None
        How `solve` was called.
    """

    kind: ClassVar[str] = "solution"
    layout = SOLUTION

    model: LayDownModel | None
    grid: PhaseSpaceGrid
    scheme: dict[str, Any]
    ds: float
    series: Mapping[str, Array]
    saved_s: Array
    densities: Array
    entropy_floor: float
    status: str = "finished"
    message: str = ""
    errors: Mapping[str, Array] | None = None
    provenance: dict[str, Any] = field(default_factory=dict)
    initial_density: Array | None = None
    reference: Array | None = None
    call: Call | None = None

    def __repr__(self) -> str:
        reached = self.series["s"][-1] if len(self.series["s"]) else float("nan")
        return (
            f"Solution({self.status} at s = {reached:g}, {self.scheme['name']}, "
            f"ds = {self.ds:g}, grid {self.grid.shape}, "
            f"{len(self.saved_s)} saved densities)"
        )

    def marginal(self, which: str, s: float) -> Array:
        """∫ p at s over the other variables; `which` as for `diagnostics.marginal`."""
        return diagnostics.marginal(self.density(s), self.grid, which)

    def entropy_rate(self, window: tuple[float, float] | None = None) -> DecayRate:
        """Rate λ of H − floor ~ e^{−λs}, fitted on a window of s; see `fit_decay`.

        Its error contains that of the step: from `errors` if there are any, else by
        the law (A⁴ + ⟨|∇B|²⟩) ds²/40, relative, measured on `drift_kick`; three times
        that for other schemes, and its root for those of order one. Of the cells it
        contains what a kink of B costs, 0.4 (B'(0) cell)² relative, and nothing else.
        Where the rate is not resolved, `advice` says what helps.
        """
        return super().entropy_rate(window)

    def _above_floor(self) -> Array:
        return self.series["relative_entropy"] - self.entropy_floor

    def _of_cells(self) -> float:
        """Relative error of a decay rate from cells about a kink of B."""
        if self.model is None:
            return 0.0
        # A box holds four deviations or more.
        length = min(self.grid.half_widths) / 4
        slope = slope_at_origin(self.model.potential, length)
        return KINK_ERROR * (slope * max(self.grid.spacing[:2])) ** 2

    def _of_step(self, above: Array, window: tuple[float, float] | None) -> float:
        """Relative error of a decay rate from the step; 0 without a model."""
        if self.model is None:
            return 0.0
        force = mean_square_force(self.model, self.grid)
        error = (self.model.noise**4 + force) * self.ds**2 * RATE_ERROR
        if self.scheme["name"] != "drift_kick":
            error *= OTHER_SCHEMES
        return error if self.scheme["order"] > 1 else math.sqrt(error)

    def save(self, path: str | Path, engine: str | None = None) -> Path:
        """Write the solution to netCDF, or to zarr for a path that ends in .zarr.

        Densities that are on the disk are read one by one.
        """
        densities: Any = self.densities
        if not isinstance(densities, LazyDensities):
            return super().save(path, engine)
        # One number in the place of all, which takes no memory.
        nothing = np.broadcast_to(np.float64(0.0), densities.shape)
        start = None if is_saved(self) else self.initial_density
        rest = replace(self, densities=nothing, initial_density=start).to_xarray()
        about = rest["density"]
        dims = tuple(map(str, about.dims))
        streamed = Streamed("density", dims, densities.shape, densities.dtype,
                            densities, about.attrs)  # fmt: skip
        return write_dataset(rest.drop_vars("density"), path, engine, [streamed])
