"""The schemes of this package as solvers of py-pde."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from pde.solvers import SolverBase

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive
from fpsolve.density.recorder import Recorder
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.scheme import Scheme, checked_start
from fpsolve.density.schemes.semi_lagrangian import SemiLagrangian
from fpsolve.density.tolerances import Tolerances, check_finite, check_record
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.interop.fields import from_pde_field
from fpsolve.interop.pypde import FokkerPlanckPDE, expect_grid

__all__ = ["DriftKickSolver", "SchemeSolverBase", "SemiLagrangianSolver"]


class SchemeSolverBase(SolverBase):  # type: ignore[misc]
    """A scheme of this package behind py-pde's interface of a solver.

    Steps are all of the length dt, as with py-pde's own solvers of fixed step: a
    tracker sees the density after the whole number of steps that comes closest to
    its time, and the result does not depend on which trackers watch. Where dt divides
    the span of the run and the times of the trackers, it equals `fpsolve.solve` with
    records at the same times; otherwise the run ends at the first whole step beyond
    t_end − dt/2, and ``diagnostics["controller"]["t_final"]`` says where. A tracker
    that changes the field restarts the scheme from what it left.

    The checks of `fpsolve.solve` are made whenever a tracker is due and at the end.

    Parameters
    ----------
    pde : FokkerPlanckPDE
        The equation itself: a subclass may say something else than the scheme solves.
    backend : str, optional
        Ignored: the schemes bring their own compiled kernels.
    mass_tolerance, boundary_tolerance, negative_tolerance : float, optional
    entropy_tolerance, circulation_tolerance : float, optional
        As in `fpsolve.solve`.
    **options
        Keyword arguments of the scheme.

    Raises
    ------
    TypeError
        If `pde` is another equation, or an option unknown to the scheme.
    ValueError
        If dt is missing or not positive.
    NonFiniteDensityError, MassDriftError, NegativeDensityError, DomainTooSmallError
    EntropyRiseError, CirculationError
        During the run.
    """

    scheme: ClassVar[Callable[..., Scheme]]

    def __init__(
        self,
        pde: FokkerPlanckPDE,
        *,
        backend: Any = "auto",
        mass_tolerance: float = 1e-10,
        boundary_tolerance: float = 1e-3,
        negative_tolerance: float = 0.2,
        entropy_tolerance: float = 0.1,
        circulation_tolerance: float = 0.05,
        **options: Any,
    ) -> None:
        check_equation(pde, FokkerPlanckPDE, self.name)
        super().__init__(pde, backend="numpy")
        self.tolerances = Tolerances(
            mass_tolerance, boundary_tolerance, negative_tolerance, entropy_tolerance,
            circulation_tolerance,
        )  # fmt: skip
        self.options = options

    def make_stepper(
        self, state: Any, dt: float | None = None
    ) -> Callable[[Any, float, float], float]:
        """The function that advances a field from t_start to about t_end."""
        dt = checked_step(dt, self.name, "fpsolve.suggest_step proposes one")
        grid = expect_grid(from_pde_field(state)[1], PhaseSpaceGrid, "HydrodynamicPDE")
        scheme = type(self).scheme(self.pde.model, grid, **self.options)
        self.info |= described(dt, scheme.order, dict(scheme.options))
        return Stepper(scheme, dt, self.tolerances, self.info)


class SemiLagrangianSolver(SchemeSolverBase):
    """``solver="semi-lagrangian"``: the paper's scheme, `fpsolve.semi_lagrangian`."""

    name = "semi-lagrangian"
    scheme = SemiLagrangian


class DriftKickSolver(SchemeSolverBase):
    """``solver="drift-kick"``: exact sub-flows, `fpsolve.drift_kick`."""

    name = "drift-kick"
    scheme = DriftKick


class Stepper:
    """Whole steps of a scheme, continued across the visits of trackers."""

    def __init__(
        self, scheme: Scheme, dt: float, tolerances: Tolerances, info: dict[str, Any]
    ) -> None:
        self.scheme, self.dt = scheme, dt
        self.tolerances, self.info = tolerances, info
        self.shown: Array | None = None
        self.reached = math.nan

    def __call__(self, field: Any, t_start: float, t_end: float) -> float:
        """Advance the field from t_start by whole steps to about t_end."""
        if not self._continues(field, t_start):
            self._restart(field, t_start)
        n_steps = steps_between(t_start, t_end, self.dt)
        self.scheme.model.curve.check_span(t_start, t_start + n_steps * self.dt)
        self.scheme.advance(self.state, t_start, self.dt, n_steps)
        self.n_steps += n_steps
        self.info["steps"] += n_steps
        self.reached = self.origin + self.n_steps * self.dt
        self._show(field)
        return self.reached

    def _continues(self, field: Any, t_start: float) -> bool:
        # Going over the density instead would round it, and forget the initial mass.
        return (
            self.shown is not None
            and t_start == self.reached
            and np.array_equal(field.data, self.shown)
        )

    def _restart(self, field: Any, t_start: float) -> None:
        p0 = checked_start(self.scheme, np.array(field.data, order="C"))
        self.state = self.scheme.start(p0)
        self.origin, self.n_steps = t_start, 0
        self.recorder = Recorder(self.scheme.model, self.scheme.grid)
        self.recorder.record(p0, t_start)

    def _show(self, field: Any) -> None:
        p = self.scheme.density(self.state)
        check_finite(p, self.reached)
        values, mass = (
            self.recorder.record(p, self.reached),
            self.recorder.first["mass"],
        )
        check_record(values, mass, self.scheme, self.state, self.tolerances)
        del self.recorder.numbers[:]
        self.info |= {"mass_correction": self.state.correction, **self.state.report}
        field.data[...] = p
        self.shown = p.copy()


def check_equation(pde: Any, kind: type, name: str) -> None:
    """Raise unless the equation is the very one that a solver solves."""
    if type(pde) is not kind:
        raise TypeError(
            f'`pde` must be a {kind.__name__} for solver="{name}", got '
            f"{type(pde).__name__}; write {kind.__name__}(model).solve(...), or choose "
            "a solver of py-pde."
        )


def checked_step(dt: Any, name: str, remedy: str) -> float:
    """The step as a float, if it was given and is positive."""
    if dt is None:
        raise ValueError(f'`dt` must be given for solver="{name}", got None; {remedy}.')
    return check_positive("dt", dt)


def described(dt: float, order: int, options: dict[str, Any]) -> dict[str, Any]:
    """What a solver says of itself."""
    fixed = {"steps": 0, "dt_adaptive": False, "stochastic": False}
    return {"dt": dt, **fixed, "backend": "fpsolve", "order": order, "options": options}


def steps_between(t_start: float, t_end: float, dt: float) -> int:
    """The whole number of steps, at least one, that comes closest to a span."""
    return max(1, round((t_end - t_start) / dt))
