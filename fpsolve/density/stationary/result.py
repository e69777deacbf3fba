"""A stationary density and how well it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.stationary.layout import STATIONARY
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["SteadyState"]


@dataclass(frozen=True, eq=False, repr=False)
class SteadyState(Saved):
    """A density with L* p = 0, and how well it is known.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha)
        With a curvature (n1, n2, n_alpha, n_kappa). Normalised to mass one on the grid.
    residual : float
        ∫ |p_{s+σ} − p_s| dξ dα / σ over a stride σ of about one: the rate at which the
        discrete equation still changes the density.
    grid : PhaseSpaceGrid
    ds : float
        Step of the scheme; with `extrapolated` the longest of several.
    n_applications : int
        Evolutions over the stride that it took, on all grids.
    error : float
        Estimate of ∫ |p − p_exact| dξ dα that covers: the sum of `errors`.
    errors : dict of float
        Its parts. "step": the splitting, from another combination of step lengths.
        "grid": cells and angles, from the same density with three quarters of them.
        "box": what the box cuts off, from the density along its edge. "iteration":
        what further corrections would change; of a smooth fibre "curvature": what κ
        lags behind, where steps are not short against R.
    moment_errors : dict of float
        The same estimate for every one of `moments`.
    splitting : dict of float
        Estimated difference of the density ("density", in L1) and of every moment that
        one run with `ds` alone would have; paths with that step have the same.
    extrapolated : bool
        Whether several step lengths were combined.
    model : LayDownModel
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "steady-state"
    layout = STATIONARY

    density: Array
    residual: float
    grid: PhaseSpaceGrid
    ds: float
    n_applications: int
    error: float = np.nan
    errors: Mapping[str, float] = field(default_factory=dict)
    moment_errors: Mapping[str, float] = field(default_factory=dict)
    splitting: Mapping[str, float] = field(default_factory=dict)
    extrapolated: bool = False
    model: LayDownModel | None = None
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        moments, known = self.moments(), self.moment_errors
        means = "".join(
            f"E ξ{axis} = {moments[name]:.6g} ± {known.get(name, np.nan):.1g}, "
            for axis, name in enumerate(("mean_xi1", "mean_xi2"), start=1)
        )
        parts = ", ".join(f"{name} {size:.1g}" for name, size in self.errors.items())
        return (
            f"SteadyState({means}L1 error {self.error:.1g} ({parts}), "
            f"residual {self.residual:.1g}, grid {self.grid.shape}, ds = {self.ds:.3g})"
        )

    def marginal(self, which: str) -> Array:
        """∫ p over the others: "xi", "alpha", "xi1", "xi2"; "kappa", "xi_alpha"."""
        return diagnostics.marginal(self.density, self.grid, which)

    def moments(self) -> dict[str, float]:
        """E ξ, covariance of ξ, E cos α (−v for every potential), E sin α (0)."""
        return diagnostics.moments(self.density, self.grid)
