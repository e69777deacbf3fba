"""What a run leaves behind."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.netcdf import write_dataset
from fpsolve.density.dataset import stored_parts, to_xarray
from fpsolve.density.error_laws import mean_square_force, slope_at_origin
from fpsolve.evolution.call import Call
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.evolution.schedule import saved_index
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

if TYPE_CHECKING:
    import xarray

__all__ = ["Solution"]

Array = NDArray[np.float64]

# Error of a decay rate relative to it, over (A⁴ + ⟨|∇B|²⟩) ds²: 1/48 at most for
# drift_kick, quadratic, linear and quartic B, 0.3 ≤ A ≤ 5; and what others have more.
RATE_ERROR, OTHER_SCHEMES = 1 / 40, 3.0
# The same over (B'(0) cell)², where B has a kink: 0.37 for |ξ| and A = 0.3.
KINK_ERROR = 0.4


@dataclass(frozen=True, eq=False)
class Solution:
    """The densities p(ξ, α, s) that were saved, and series over every recorded step.

    Every series is an attribute: `solution.s`, `mass`, `relative_entropy`,
    `entropy_dissipation`, `minimum`, `negative_mass`, `boundary_mass`,
    `mass_correction`, the moments `mean_xi1`, `mean_xi2`, `variance_xi1`,
    `variance_xi2`, `covariance`, `mean_cos_alpha`, `mean_sin_alpha`, and `theta` for
    the semi-Lagrangian scheme.
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
        After a run with checkpoints `LazyDensities`, which are read from the disk one
        by one; `numpy.asarray` makes an array of them.
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

    def __getattr__(self, name: str) -> Array:
        # Only called for names that are not fields; guards against half-built
        # objects, as pickle and copy make them.
        series: Mapping[str, Array] = self.__dict__.get("series", {})
        if name in series:
            found: Array = series[name]
            return found
        raise AttributeError(
            f"Solution has no attribute {name!r}; its series are {', '.join(series)}."
        )

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.series]

    def __repr__(self) -> str:
        reached = self.series["s"][-1] if len(self.series["s"]) else float("nan")
        return (
            f"Solution({self.status} at s = {reached:g}, {self.scheme['name']}, "
            f"ds = {self.ds:g}, grid {self.grid.shape}, "
            f"{len(self.saved_s)} saved densities)"
        )

    def density(self, s: float) -> Array:
        """Saved density p at s; shape (n1, n2, n_alpha).

        Raises
        ------
        ValueError
            If no density was saved at s.
        """
        found: Array = self.densities[saved_index(self.saved_s, s, self.ds)]
        return found

    @property
    def final(self) -> Array:
        """Last saved density; shape (n1, n2, n_alpha)."""
        return self.density(self.saved_s[-1] if self.saved_s.size else np.nan)

    def marginal(self, which: str, s: float) -> Array:
        """∫ p at s over the other variables: "xi", "alpha", "xi1" or "xi2"."""
        return diagnostics.marginal(self.density(s), self.grid, which)

    def entropy_rate(self, window: tuple[float, float] | None = None) -> DecayRate:
        """Rate λ of H − floor ~ e^{−λs}, fitted on a window of s; see `fit_decay`.

        Its error contains that of the step: from `errors` if there are any, else by
        the law (A⁴ + ⟨|∇B|²⟩) ds²/40, relative, measured on `drift_kick`; three times
        that for other schemes, and its root for those of order one. Of the cells it
        contains what a kink of B costs, 0.4 (B'(0) cell)² relative, and nothing else.
        Where the rate is not resolved, `advice` says what helps.
        """
        known = (self.errors or {}).get("relative_entropy")
        resolution = self._kink_error()
        if known is None or not np.isfinite(known).all():
            known = None
            resolution += self._step_error()
        return fit_decay(
            self.series["s"],
            self.series["relative_entropy"] - self.entropy_floor,
            window,
            errors=known,
            step_error=resolution,
        )

    def _kink_error(self) -> float:
        """Relative error of a decay rate from cells about a kink of B."""
        if self.model is None:
            return 0.0
        # A box holds four deviations or more.
        length = min(self.grid.half_widths) / 4
        slope = slope_at_origin(self.model.potential, length)
        return KINK_ERROR * (slope * max(self.grid.spacing[:2])) ** 2

    def _step_error(self) -> float:
        """Relative error of a decay rate from the step; 0 without a model."""
        if self.model is None:
            return 0.0
        force = mean_square_force(self.model, self.grid)
        error = (self.model.noise**4 + force) * self.ds**2 * RATE_ERROR
        if self.scheme["name"] != "drift_kick":
            error *= OTHER_SCHEMES
        return error if self.scheme["order"] > 1 else math.sqrt(error)

    def to_xarray(self) -> xarray.Dataset:
        """Labelled Dataset: densities (s, xi1, xi2, alpha), series over step."""
        return to_xarray(self)

    def save(self, path: str | Path, engine: str | None = None) -> Path:
        """Write the solution to netCDF, or to zarr for a path that ends in .zarr."""
        dataset, streamed = stored_parts(self)
        return write_dataset(dataset, path, engine, streamed)
