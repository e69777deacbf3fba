"""The paper's scheme: adjusted characteristics and implicit angular diffusion."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag, check_one_of
from fpsolve.density.schemes.adjusted_advection import AdjustedAdvection
from fpsolve.density.schemes.diffusion import ImplicitDiffusion
from fpsolve.density.schemes.form import State, balanced_form, plain_form
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.laydown import LayDownModel, check_model

ORDERS = {"lie": 1, "strang": 2}
# θ of the implicit step: backward Euler, Crank-Nicolson.
IMPLICITNESS = {"backward_euler": 1.0, "crank_nicolson": 0.5}


class SemiLagrangian:
    """p ← D½ A D½ (Strang) or D A (Lie): characteristics and implicit α-diffusion.

    A is transport along the characteristics of (7) with its mass restored by
    adjusted advection, D the implicit diffusion in α. Strang with Crank-Nicolson is
    of order 2 in ds, every other pairing of order 1; interpolation is of order
    `interpolation_order`. The default evolves h = p/p_S, which is stable for every
    noise and keeps the equilibrium on a fixed belt to rounding; `form="p"` is the
    historical variant, which blows up at low noise. Build it with
    `fpsolve.semi_lagrangian`.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    form : str
        What is evolved, "h" = p/p_S or "p".
    splitting : str
        "strang" or "lie".
    diffusion : str
        "crank_nicolson" or "backward_euler".
    interpolation_order : int
        Points of the interpolation at the feet in each direction, 4 or 6.
    limited : bool
        Hold each interpolated value within those of the cells around its foot.
    perturbation : float
        η of the moved feet, between 0 and 1.
    adjusted : bool
        Restore the mass by adjusted advection.
    compact : bool
        Second differences of order 4 in Δα instead of 2.

    Raises
    ------
    TypeError, ValueError
        If an argument is none of these.

    References
    ----------
    [KRS09]_; feet as in [DR82]_, mass as in [DHP99]_; [KMW09]_, section 3.1.1.
    """

    name = "semi_lagrangian"
    # 2: moved feet to first order; 1: values interpolated there.
    revision = 2

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        *,
        form: str = "h",
        splitting: str = "strang",
        diffusion: str = "crank_nicolson",
        interpolation_order: int = 4,
        limited: bool = False,
        perturbation: float = 0.5,
        adjusted: bool = True,
        compact: bool = True,
    ) -> None:
        check_model(model)
        check_grid(grid)
        check_one_of("form", form, ("h", "p"))
        check_one_of("splitting", splitting, ORDERS)
        check_one_of("diffusion", diffusion, IMPLICITNESS)
        self.model, self.grid = model, grid
        self.options: dict[str, Any] = {
            "form": form,
            "splitting": splitting,
            "diffusion": diffusion,
            "interpolation_order": interpolation_order,
            "limited": check_flag("limited", limited),
            "perturbation": perturbation,
            "adjusted": check_flag("adjusted", adjusted),
            "compact": check_flag("compact", compact),
        }
        self.balanced = form == "h"
        self.form = balanced_form(model, grid) if self.balanced else plain_form(grid)
        self.splitting = splitting
        self.order = min(ORDERS[splitting], 2 if diffusion == "crank_nicolson" else 1)
        self.diffuse = ImplicitDiffusion(model, grid, IMPLICITNESS[diffusion], compact)
        self.transport = AdjustedAdvection(
            model, grid, self.form, interpolation_order=interpolation_order,
            limited=limited, perturbation=perturbation, adjusted=adjusted,
        )  # fmt: skip
        self.correction_limit = 0.02 if adjusted else np.inf

    @property
    def n_arrays(self) -> float:
        """Densities alive during a run."""
        return 2.0 + self.transport.n_arrays

    def start(self, p0: Array) -> State:
        """State of a run that begins at p0."""
        state = self.form.start(p0)
        state.report["theta"] = 1.0
        return state

    def density(self, state: State) -> Array:
        """The density of a state; a view that the next step overwrites."""
        return self.form.density(state)

    def advance(self, state: State, s: float, ds: float, n_steps: int = 1) -> None:
        """Advance by n_steps from s; the state keeps the smallest θ and the
        largest correction.
        """
        corrections, weights = [], []
        for step in range(n_steps):
            state.report["theta"] = 1.0
            self._step(state, s + step * ds, ds)
            corrections.append(state.correction)
            weights.append(state.report["theta"])
        state.correction = max(corrections, key=abs)
        state.report["theta"] = min(weights)

    def _step(self, state: State, s: float, ds: float) -> None:
        if self.splitting == "lie":
            self.transport(state, s, ds)
            self.diffuse(state.values, s, ds, state.values)
        else:
            self.diffuse(state.values, s, ds / 2, state.values)
            self.transport(state, s, ds)
            self.diffuse(state.values, s + ds / 2, ds / 2, state.values)
        state.n_steps += 1
