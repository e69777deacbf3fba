"""The finite volumes of the hydrodynamic limit as a solver of py-pde."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pde.solvers import SolverBase

from fpsolve._support.checks import check_one_of, check_positive
from fpsolve.errors import DomainTooSmallError
from fpsolve.grids import diagnostics
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop.fields import from_pde_field
from fpsolve.interop.pypde import HydrodynamicPDE, expect_grid
from fpsolve.interop.solvers import (
    check_equation,
    checked_step,
    described,
    steps_between,
)
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.reduced.implicit import METHODS, Method

__all__ = ["ScharfetterGummelSolver"]


class ScharfetterGummelSolver(SolverBase):  # type: ignore[misc]
    """``solver="scharfetter-gummel"``: what `HydrodynamicLimit.solve` does.

    Implicit, so that no step is too long to be stable; mass and 𝒫_S are exact; of
    order two in the cells, and in dt one with "backward_euler", two with "sdirk2".
    Steps are all of the length dt: trackers see the density after the whole number of
    steps that comes closest to their time, and the run ends at the whole step closest
    to t_end.

    Parameters
    ----------
    pde : HydrodynamicPDE
    backend : str, optional
        Ignored: a step solves a sparse system with scipy.
    method : {"backward_euler", "sdirk2"}, optional
        As in `HydrodynamicLimit.solve`.
    boundary_tolerance : float, optional
        Largest share of mass in the outermost cells.

    Raises
    ------
    TypeError
        If `pde` is another equation.
    ValueError
        If dt is missing or not positive, or `method` unknown.
    DomainTooSmallError
        During the run.

    References
    ----------
    [SG69]_, [KMW09]_ section 3.1.2.
    """

    name = "scharfetter-gummel"

    def __init__(
        self,
        pde: HydrodynamicPDE,
        *,
        backend: Any = "auto",
        method: str = "backward_euler",
        boundary_tolerance: float = 1e-3,
    ) -> None:
        check_equation(pde, HydrodynamicPDE, self.name)
        check_one_of("method", method, METHODS)
        super().__init__(pde, backend="numpy")
        self.method = method
        self.tolerance = check_positive("boundary_tolerance", boundary_tolerance)

    def make_stepper(
        self, state: Any, dt: float | None = None
    ) -> Callable[[Any, float, float], float]:
        """The function that advances a field from t_start to about t_end."""
        dt = checked_step(dt, self.name, "compare with half of it")
        grid = expect_grid(from_pde_field(state)[1], PlaneGrid, "FokkerPlanckPDE")
        generator = HydrodynamicLimit(self.pde.model).generator(grid)
        take_step: Method = METHODS[self.method](generator, dt)
        self.info |= described(dt, take_step.order, {"method": self.method})

        def advance(field: Any, t_start: float, t_end: float) -> float:
            n_steps = steps_between(t_start, t_end, dt)
            # The equation is linear, so that densities do for masses.
            density = field.data.ravel()
            for _ in range(n_steps):
                density = take_step(density)
            field.data[...] = density.reshape(grid.shape)
            self.info["steps"] += n_steps
            t, share = t_start + n_steps * dt, diagnostics.ring_share(field.data)
            if not share <= self.tolerance:
                raise DomainTooSmallError(share, grid.half_width, t, self.tolerance)
            return t

        return advance
