"""The modified method of characteristics with adjusted advection."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve._kernels.characteristics import (
    Displacement,
    blend,
    interpolate_at_feet,
    interpolate_at_perturbed_feet,
)
from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve.density.schemes.characteristics import Characteristics, Feet
from fpsolve.density.schemes.form import DensityForm, State
from fpsolve.errors import MassCorrectionError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at

# Below this a mass error is rounding of the sums: a factor removes it, since the
# perturbed feet of an almost constant h differ by no more than rounding either.
ROUNDING = 1e-13
POINTS = (4, 6)


@dataclass
class Scratch:
    """What one run needs besides its unknown: feet, and the second set of values."""

    feet: Feet | None = None
    spare: Array | None = None


class AdjustedAdvection:
    """Transport along characteristics, its mass restored by moving the feet.

    The value at a cell is that of the interpolant at the foot x* of its
    characteristic. If the mass Q* of these values misses the target Q, a second set
    is taken at feet x* ± η b ds², the larger of the two where Q* ≤ Q, the smaller
    otherwise; with its mass Q♯ the result is θ u* + (1 − θ) u♯ with
    θ = (Q − Q♯)/(Q* − Q♯), which has the mass Q to rounding. A weight outside [0, 1]
    would extrapolate, so it is refused. In the balanced form it is the density
    p = e^{−B} h that is taken at the moved feet: a correction is then possible for a
    constant h too, which a moving belt needs. The correction changes p by no more
    than the mass error it repairs, spread over the cells: it does not lower the
    order of the scheme. ds² has a unit: ξ and s are meant in throwing ranges, and in
    others the same mass is restored by feet moved by other parts of a cell.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    form : DensityForm
    interpolation_order : int
        4 (cubic) or 6 (quintic).
    limited : bool
        Hold values within those of the eight nodes around the foot.
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
        """Densities held: feet, growth, and the second set of values."""
        return self.characteristics.n_arrays + (1.0 if self.adjusted else 0.0)

    def __call__(self, state: State, s: float, ds: float) -> None:
        """Advance the state by ds; its correction and weight are left in it."""
        own = state.scratch = state.scratch or Scratch()
        own.feet = feet = self.characteristics.feet(s, ds, own.feet)
        interpolate_at_feet(
            state.values, feet.places, feet.growth, self.points, self.limited,
            state.work,
        )  # fmt: skip
        mass = self.form.mass(state.work)
        state.correction = mass / state.target_mass - 1.0
        # A mass that is not a number is left for the run's own check.
        if self.adjusted and math.isfinite(mass):
            self._restore(state, feet, mass, s, ds)
        state.swap()

    def _restore(
        self, state: State, feet: Feet, mass: float, s: float, ds: float
    ) -> None:
        target = state.target_mass
        if abs(mass - target) <= ROUNDING * target:
            state.work *= target / mass
            return
        spare = self._perturbed_values(state, feet, mass <= target, s, ds)
        other = self.form.mass(spare)
        possible = math.isfinite(other) and mass != other
        theta = (target - other) / (mass - other) if possible else math.inf
        state.report["theta"] = theta
        if not 0.0 <= theta <= 1.0:
            raise MassCorrectionError(s, theta, state.n_steps)
        blend(state.work, spare, theta, state.work)

    def _perturbed_values(
        self, state: State, feet: Feet, upper: bool, s: float, ds: float
    ) -> Array:
        if state.scratch.spare is None:
            state.scratch.spare = np.empty(self.grid.shape)
        spare: Array = state.scratch.spare
        speed1, speed2 = self.model.curve.velocity(s + ds)
        cosine, sine = np.cos(self.grid.alpha), np.sin(self.grid.alpha)
        d1, d2, d_alpha = self.grid.spacing
        reach = self.perturbation * ds**2
        velocity1, velocity2 = reach * (cosine - speed1), reach * (sine - speed2)
        weighted = 0.0 if self.form.weight is None else 1.0
        displacement = Displacement(
            velocity1 / d1, velocity2 / d2, *self.force, cosine, sine, reach / d_alpha,
            weighted * velocity1, weighted * velocity2,
        )  # fmt: skip
        interpolate_at_perturbed_feet(
            state.values, feet.places, feet.growth, displacement,
            self.points, self.limited, upper, spare,
        )  # fmt: skip
        return spare
