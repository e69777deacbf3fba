"""The palindrome T½ R½ D R½ T½ of exact sub-flows."""

from __future__ import annotations

from typing import Any

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag
from fpsolve.density.schemes.form import State, balanced_form, plain_form
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.translation import Translation
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.laydown import LayDownModel, check_model

# Mass errors of the plain form that are rounding, and worth a factor.
SEEN, ROUNDING = 2e-14, 1e-12


class DriftKick:
    """p ← T½ (R½ D R½) T½ p: translation, rotation, diffusion, each exact in time.

    Order 2 in ds (the composition is symmetric), `interpolation_order` in Δξ,
    spectral in α. Between two records the half translations of neighbouring steps
    merge into one. Mass: kept to rounding in the plain form; in the balanced form
    restored by a factor after every recorded step, the size of which is recorded.
    Equilibrium: kept to rounding in the balanced form on a fixed belt. Sign: kept to
    rounding with `positive`. Build it with `fpsolve.drift_kick`.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    positive : bool
        Never below zero: clamped fluxes, limited rows.
    balanced : bool
        Evolve h = p/p_S.
    interpolation_order : int
        Points of the translation in each direction, even.

    Raises
    ------
    TypeError, ValueError
        If an argument is none of these.

    References
    ----------
    Composed as in [Str68]_; `positive` after [ZS10]_. The equation is (7) of [KMW09]_.
    """

    name = "drift_kick"
    order = 2
    # A relative mass error above this in one record is not the rounding-off of a
    # good step but a step that is wrong.
    correction_limit = 0.02

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        *,
        positive: bool = False,
        balanced: bool = False,
        interpolation_order: int = 8,
    ) -> None:
        check_model(model)
        check_grid(grid)
        self.model, self.grid = model, grid
        self.positive = check_flag("positive", positive)
        self.balanced = check_flag("balanced", balanced)
        self.interpolation_order = interpolation_order
        self.form = balanced_form(model, grid) if balanced else plain_form(grid)
        self.translate = Translation(model, grid, interpolation_order, self.positive)
        self.kick = RotationDiffusion(model, grid, self.balanced, self.positive)

    @property
    def options(self) -> dict[str, Any]:
        """Keyword arguments that build this scheme again."""
        return {
            "positive": self.positive,
            "balanced": self.balanced,
            "interpolation_order": self.interpolation_order,
        }

    @property
    def n_arrays(self) -> float:
        """Densities alive during a run: unknown, scratch, and the angle step's."""
        return 2.0 + self.kick.n_arrays

    def start(self, p0: Array) -> State:
        """State of a run that begins at p0."""
        return self.form.start(p0)

    def density(self, state: State) -> Array:
        """The density of a state; a view that the next step overwrites."""
        return self.form.density(state)

    def advance(self, state: State, s: float, ds: float, n_steps: int = 1) -> None:
        """Advance by n_steps from s: T½ (K T)ⁿ⁻¹ K T½ with K = R½ D R½."""
        self._apply(self.translate, state, s, ds / 2)
        for step in range(n_steps):
            at = s + step * ds
            last = step == n_steps - 1
            self._apply(self.kick, state, at, ds)
            self._apply(self.translate, state, at + ds / 2, ds / 2 if last else ds)
        state.n_steps += n_steps
        self._restore_mass(state)

    def _apply(
        self, operator: Translation | RotationDiffusion, state: State, s: float,
        ds: float,
    ) -> None:  # fmt: skip
        operator(state.values, s, ds, state.work)
        state.swap()

    def _restore_mass(self, state: State) -> None:
        # Every sub-step is homogeneous in the unknown, so one factor at the end is
        # the same as one after every step.
        mass = self.form.mass(state.values)
        error = mass / state.target_mass - 1.0
        state.correction = 0.0
        # The plain form keeps mass but for rounding, 1e-16 a step and of one sign.
        # Only that is taken out; anything larger is left for the run to see.
        if self.balanced or SEEN < abs(error) < ROUNDING:
            state.correction = error
            if mass > 0.0:
                self.form.rescale(state, state.target_mass / mass)
