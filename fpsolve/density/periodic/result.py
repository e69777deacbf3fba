"""A density that comes back after every period, and how well it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.periodic.layout import PERIODIC
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.grids import diagnostics
from fpsolve.grids.smooth import AnyGrid
from fpsolve.model.fibre import FibreModel

__all__ = ["PeriodicState"]


@dataclass(frozen=True, eq=False, repr=False)
class PeriodicState(Saved):
    """A density with p(s + P) = p(s), at n phases of the period P.

    Attributes
    ----------
    s : ndarray, shape (n,)
        Arclengths j P/n of the phases, of the curve γ as the model has it.
    densities : ndarray, shape (n, n1, n2, n_alpha)
        With a curvature (n, n1, n2, n_alpha, n_kappa). Each of mass one on the grid.
    period : float
        P.
    residual : float
        ∫ |p(mP) − p(0)| dξ dα / (mP) over m whole periods: the rate at which the
        discrete equation still changes the density from period to period.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    ds : float
        The longest of three steps whose runs are combined.
    n_applications : int
        Evolutions over whole periods that it took, on all grids.
    phase_errors : ndarray, shape (n,)
        Estimate of ∫ |p − p_exact| dξ dα at every phase, that covers.
    errors : dict of float
        Its parts, each where it is largest: "step", "grid", "box" and "iteration" as
        those of `SteadyState`; of a smooth fibre "curvature" as well.
    plane_errors : ndarray, shape (3, n, n1, n2)
        The estimated errors "step", "grid" and "iteration" as fields, signed and
        integrated over the angle, for what is integrated against the density.
    moment_errors : dict of ndarray, shape (n,)
        The same estimate for every one of `moments`.
    model : LayDownModel or SmoothLayDownModel
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "periodic-state"
    layout = PERIODIC

    s: Array
    densities: Array
    period: float
    residual: float
    grid: AnyGrid
    ds: float
    n_applications: int
    phase_errors: Array
    plane_errors: Array
    errors: Mapping[str, float] = field(default_factory=dict)
    moment_errors: Mapping[str, Array] = field(default_factory=dict)
    model: FibreModel | None = None
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        parts = ", ".join(f"{name} {size:.1g}" for name, size in self.errors.items())
        return (
            f"PeriodicState({self.s.size} phases of the period {self.period:.6g}, "
            f"L1 error {self.error:.1g} ({parts}), residual {self.residual:.1g}, "
            f"grid {self.grid.shape}, ds = {self.ds:.3g})"
        )

    @property
    def error(self) -> float:
        """The largest of `phase_errors`."""
        return float(np.max(self.phase_errors))

    def marginal(self, which: str) -> Array:
        """∫ p over the others at every phase, shape (n, …); names as `SteadyState`."""
        return np.stack(
            [diagnostics.marginal(p, self.grid, which) for p in self.densities]
        )

    def moments(self) -> dict[str, Array]:
        """E ξ, covariance of ξ, E cos α, E sin α at every phase, shape (n,) each."""
        every = [diagnostics.moments(p, self.grid) for p in self.densities]
        return {name: np.array([one[name] for one in every]) for name in every[0]}
