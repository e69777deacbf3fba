"""The modified method of characteristics with adjusted advection."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve._kernels.characteristics import Displacement, interpolate_at_feet
from fpsolve._kernels.combining import add_weighted
from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve.density.schemes.characteristics import Characteristics, Feet
from fpsolve.density.schemes.form import DensityForm, State
from fpsolve.errors import MassCorrectionError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at

# Below this a mass error is rounding of the sums: a factor removes it, since moving the
# feet changes an almost constant h by no more than rounding either.
ROUNDING = 1e-13
POINTS = (4, 6)


@dataclass
class Scratch:
    """What one run needs besides its unknown: feet, and what moving them changes."""

    feet: Feet | None = None
    changes: Array | None = None


class AdjustedAdvection:
    """Transport along characteristics, its mass restored by moving the feet.

    The value at a cell is that of the interpolant at the foot x* of its
    characteristic. If the mass Q* of these values u* misses the target Q, a second set
    is taken at moved feet x* ± δ, δ = η b ds², the larger of the two where Q* ≤ Q, the
    smaller otherwise: u♯ = u* ± |δ·∇u|, to first order in δ, with the slope of the
    interpolant from the values that were read for u*. Its mass Q♯ lies on the other
    side of Q* for certain, and the result θ u* + (1 − θ) u♯ with
    θ = (Q − Q♯)/(Q* − Q♯) has the mass Q to rounding. A weight outside [0, 1]
    would extrapolate, so it is refused. In the balanced form it is the density
    p = e^{−B} h that is taken at the moved feet: a correction is then possible for a
    constant h too, which a moving belt needs. The correction changes p by no more
    than the mass error it repairs, spread over the cells: it does not lower the
    order of the scheme. η and the unit of ds cancel in the result; they decide how much
    can be restored before θ leaves [0, 1].

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    form : DensityForm
    interpolation_order : int
        4 (cubic) or 6 (quintic).
    limited : bool
        Hold values within those of the eight nodes around the foot, those at the moved
        feet too, and the correction within the value.
    perturbation : float
        η, with 0 < η < 1.
    adjusted : bool
        Restore the mass at all; without it mass drifts by the interpolation error.

    Raises
    ------
    MassCorrectionError
        If no weight in [0, 1] restores the mass.

    References
    ----------
    [DHP99]_; [KMW09]_, section 3.1.1 (numerical result).
    """

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        form: DensityForm,
        *,
        interpolation_order: int = 4,
        limited: bool = False,
        perturbation: float = 0.5,
        adjusted: bool = True,
    ) -> None:
        if interpolation_order not in POINTS:
            raise ValueError(
                f"`interpolation_order` must be 4 or 6, got {interpolation_order!r}; "
                "4 interpolates with cubics, 6 with quintics."
            )
        perturbation = check_real("perturbation", perturbation)
        if not 0 < perturbation < 1:
            raise ValueError(
                f"`perturbation` must lie between 0 and 1, got {perturbation:g}; "
                "0.5 suits most runs."
            )
        self.model, self.grid, self.form = model, grid, form
        self.points, self.limited = interpolation_order, bool(limited)
        self.perturbation, self.adjusted = perturbation, bool(adjusted)
        self.characteristics = Characteristics(model, grid, form.weight is not None)
        self.force = gradient_at(model.potential, *grid.plane())

    @property
    def n_arrays(self) -> float:
        """Densities held: feet, growth, and what moving the feet changes."""
        return self.characteristics.n_arrays + (1.0 if self.adjusted else 0.0)

    def __call__(self, state: State, s: float, ds: float) -> None:
        """Advance the state by ds; its correction and weight are left in it."""
        own = state.scratch = state.scratch or Scratch()
        own.feet = feet = self.characteristics.feet(s, ds, own.feet)
        if own.changes is None:
            own.changes = np.empty(self.grid.shape if self.adjusted else (0, 0, 0))
        interpolate_at_feet(
            state.values, feet.places, feet.growth, self._displacement(s + ds, ds),
            self.points, self.limited, own.changes, state.work,
        )  # fmt: skip
        mass = self.form.mass(state.work)
        state.correction = mass / state.target_mass - 1.0
        # A mass that is not a number is left for the run's own check.
        if self.adjusted and math.isfinite(mass):
            self._restore(state, own.changes, mass, s)
        state.swap()

    def _restore(self, state: State, changes: Array, mass: float, s: float) -> None:
        target = state.target_mass
        if abs(mass - target) <= ROUNDING * target:
            state.work *= target / mass
            return
        reach = self.form.mass(changes)
        part = (target - mass) / reach if reach > 0.0 else math.inf
        theta = 1.0 - abs(part)
        state.report["theta"] = theta
        if not 0.0 <= theta <= 1.0:
            raise MassCorrectionError(s, theta, state.n_steps)
        add_weighted(
            changes.reshape(-1), np.array([part]), state.work.reshape(1, -1), False
        )

    def _displacement(self, s: float, ds: float) -> Displacement:
        """δ = η b ds² at s."""
        speed1, speed2 = self.model.curve.velocity(s)
        cosine, sine = np.cos(self.grid.alpha), np.sin(self.grid.alpha)
        d1, d2, d_alpha = self.grid.spacing
        reach = self.perturbation * ds**2
        velocity1, velocity2 = reach * (cosine - speed1), reach * (sine - speed2)
        weighted = 0.0 if self.form.weight is None else 1.0
        return Displacement(
            velocity1 / d1, velocity2 / d2, *self.force, cosine, sine, reach / d_alpha,
            weighted * velocity1, weighted * velocity2,
        )  # fmt: skip
