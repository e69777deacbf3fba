"""The full equation (7) and its hydrodynamic limit as `pde.PDEBase`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pde

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop.differences import (
    phase_space_rate,
    phase_space_rate_bound,
    plane_rate,
    plane_rate_bound,
)
from fpsolve.interop.fields import from_pde_field, own_grid
from fpsolve.model.curves.curve import Curve
from fpsolve.model.laydown import LayDownModel, check_model

__all__ = ["FokkerPlanckPDE", "HydrodynamicPDE", "expect_grid"]

Rate = Callable[[Array, float], Array]

# The half disc of this radius left of the imaginary axis is stable for the classical
# Runge-Kutta method of order four.
RUNGE_KUTTA_RADIUS = 2.6


class _LayDownPDE(pde.PDEBase):  # type: ignore[misc]
    """What both equations share: a model, a rate on a grid, its two back ends."""

    def __init__(self, model: LayDownModel) -> None:
        check_model(model)
        super().__init__()
        self.model = model
        self._last: tuple[Any, Rate] | None = None

    def evolution_rate(self, state: Any, t: float = 0) -> Any:
        """∂ₛp of a field, as a field.

        Raises
        ------
        TypeError, ValueError
            If the field lives on another kind of grid; see `from_pde_field`.
        """
        last = self._last
        if last is None or last[0] is not state.grid:
            from_pde_field(state)
            # As a whole: a thread with another grid may be using this equation too.
            last = self._last = state.grid, self._make_rate(own_grid(state.grid), None)
        values = last[1](state.data, t)
        return pde.ScalarField(state.grid, values, label="evolution rate")

    def make_evolution_rate(self, state: Any, backend: Any) -> Rate:
        """∂ₛp as a function (array, s) of the numba back end.

        Raises
        ------
        NotImplementedError
            For other back ends, on which ``backend="auto"`` then falls back to NumPy.
        """
        if backend.name != "numba":
            raise NotImplementedError(
                f"`backend` must be 'numpy' or 'numba', got {backend.name!r}."
            )
        from_pde_field(state)
        return self._make_rate(own_grid(state.grid), backend)

    def _make_rate(self, grid: Any, backend: Any) -> Rate:
        """The rate on a grid, compiled by `backend` unless it is None."""
        raise NotImplementedError

    def __getstate__(self) -> dict[str, Any]:
        # Closures cannot be pickled, and are quickly made again.
        state: dict[str, Any] = super().__getstate__()
        return {**state, "_last": None}


class FokkerPlanckPDE(_LayDownPDE):
    """∂ₛp = −(τ(α) − γ′(s))·∇p + ∂_α(∇B·τ⊥ p) + (A²/2) ∂_αα p, equation (7), t = s.

    Central fluxes of second order through the cells of a periodic box
    (`differences.phase_space_rate`). Exact: the mass, for every solver of py-pde that
    combines rates linearly, and on a fixed belt the equilibrium; there no mode grows
    at any noise. On a moving belt modes may grow slowly where the noise is too little
    for the cells. Not positive: a front thinner than a few cells makes it oscillate.
    Nothing of the schemes of this package is used, which makes py-pde's solution an
    independent check of theirs.

    An explicit solver needs dt ≤ 2.6/R, R a bound on the eigenvalues, for the
    classical Runge-Kutta method (`explicit_step`); on fine cells R is about
    1/Δξ₁ + 1/Δξ₂ + max|∇B|/Δα + 2A²/Δα². For potentials so steep that |∇B| Δξ/2 > 1
    in the corners of the box it grows like exp(|∇B| Δξ/2): choose the box no larger
    than needed. The explicit Euler method needs much shorter steps at little noise and
    has none without. py-pde's Crank-Nicolson iterates to a fixed point, which converges
    for dt < 2/R only.

    Works with ``backend="numpy"``, and with ``backend="numba"`` for curves of constant
    velocity (belts); other curves need Python at every step.

    Parameters
    ----------
    model : LayDownModel

    Raises
    ------
    TypeError
        If `model` is of another kind.

    References
    ----------
    [KMW09]_, equations (7) and (9).
    """

    def __init__(self, model: LayDownModel) -> None:
        super().__init__(model)
        self.explicit_time_dependence = not model.curve.autonomous

    @property
    def expression(self) -> str:
        """The equation as plain text with the actual parameters."""
        return self.model.equation

    def explicit_step(self, grid: PhaseSpaceGrid, s: float = 0.0) -> float:
        """2.6/R: a step at which the classical Runge-Kutta method is stable.

        Parameters
        ----------
        grid : PhaseSpaceGrid
        s : float, optional
            Arclength at which the velocity of the curve is taken.
        """
        velocity = _velocity(self.model.curve, s)
        return RUNGE_KUTTA_RADIUS / phase_space_rate_bound(self.model, grid, velocity)

    def _make_rate(self, grid: Any, backend: Any) -> Rate:
        grid = expect_grid(grid, PhaseSpaceGrid, "HydrodynamicPDE")
        rate = phase_space_rate(self.model, grid)
        curve = self.model.curve
        if not curve.autonomous:
            if backend is not None:
                raise NotImplementedError(
                    "`backend` must be 'numpy' for a curve of varying velocity, got "
                    f"{backend.name!r} with {curve!r}."
                )
            return lambda p, s: rate(p, *_velocity(curve, s))
        velocity1, velocity2 = _velocity(curve, 0.0)
        compiled = rate if backend is None else backend.compile_function(rate)
        return lambda p, s: compiled(p, velocity1, velocity2)


class HydrodynamicPDE(_LayDownPDE):
    """∂ₛ𝒫 = ∇·(ε∇ + ε∇B − v e₁)𝒫, ε = A⁻²: the limit of much noise, t = s.

    Central fluxes of second order through the faces of a closed box: the mass is kept
    to rounding. Not positive where a cell is wider than 2/|∇B − A²v e₁|. The stationary
    density is 𝒫_S ∝ exp(−B + A²v ξ₁); [KMW09]_ prints the other sign, against its own
    Remark 3.7.

    An explicit solver needs dt ≤ 2.6/R, R about 4ε(1/Δξ₁² + 1/Δξ₂²) plus drift over
    spacing, for the classical Runge-Kutta method (`explicit_step`) and dt ≤ 2/R for
    Euler's.

    Parameters
    ----------
    model : LayDownModel
        With positive noise and a belt, at rest or moving.

    Raises
    ------
    TypeError
        If `model` is of another kind.
    ValueError
        If the noise is zero or the velocity of the curve not constant.

    References
    ----------
    [KMW09]_, section 3.4 and Remark 3.7.
    """

    explicit_time_dependence = False

    def __init__(self, model: LayDownModel) -> None:
        super().__init__(model)
        if not model.noise > 0:
            raise ValueError(
                f"`noise` must be positive for the limit of much noise, got "
                f"{model.noise:g}; use FokkerPlanckPDE."
            )
        if not model.curve.autonomous:
            raise ValueError(
                "`curve` must be a fixed or a moving belt in the hydrodynamic limit, "
                f"got {model.curve!r}; use FokkerPlanckPDE."
            )

    @property
    def expression(self) -> str:
        """The equation as plain text with the actual parameters."""
        strength, speed = self.model.noise**-2, self.model.belt_speed
        return (
            f"∂ₛ𝒫 = ∇·({strength:g} ∇𝒫 + ({strength:g} ∇B - {speed:g} e₁) 𝒫), "
            f"B = {self.model.potential.formula}"
        )

    def explicit_step(self, grid: PlaneGrid) -> float:
        """2.6/R: a step at which the classical Runge-Kutta method is stable."""
        return RUNGE_KUTTA_RADIUS / plane_rate_bound(self.model, grid)

    def _make_rate(self, grid: Any, backend: Any) -> Rate:
        grid = expect_grid(grid, PlaneGrid, "FokkerPlanckPDE")
        return plane_rate(self.model, grid)


def _velocity(curve: Curve, s: float) -> tuple[float, float]:
    velocity1, velocity2 = curve.velocity(s)
    return float(velocity1), float(velocity2)


def expect_grid(grid: Any, kind: type, other: str) -> Any:
    """The grid, if it is of the kind an equation lives on; `other` has the other."""
    if not isinstance(grid, kind):
        raise ValueError(
            f"`state` must live on the cells of a {kind.__name__} for this equation, "
            f"got those of a {type(grid).__name__}; that is for {other}."
        )
    return grid
