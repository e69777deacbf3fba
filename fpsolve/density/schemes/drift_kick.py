"""The palindrome T½ R½ D R½ T½ of exact sub-flows."""

from __future__ import annotations

from typing import Any, Literal

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag, shown
from fpsolve.density.schemes.form import State, balanced_form, plain_form
from fpsolve.density.schemes.fourier_translation import FourierTranslation
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.translation import Translation
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.laydown import LayDownModel, check_model

Interpolant = Literal["lagrange", "fourier"]
# Points of the piecewise interpolation, where none are asked for.
POINTS = 8
# Mass errors of the plain form that are rounding, and worth a factor.
SEEN, ROUNDING = 2e-14, 1e-12


class DriftKick:
    """p ← T½ (R½ D R½) T½ p: translation, rotation, diffusion, each exact in time.

    Order 2 in ds (the composition is symmetric, so that its error has even powers of
    ds only), `interpolation_order` in Δξ or spectral, spectral in α. Between two
    records the half translations of neighbouring steps merge into one. Mass: kept to
    rounding in the plain form; in the balanced form restored by a factor after every
    recorded step, the size of which is recorded.
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
    translation : {"lagrange", "fourier"}
        By piecewise polynomials, or exactly for the trigonometric interpolant on the
        periodic box: for smooth densities on few cells, with several levels of
        `extrapolate` in `solve`. Not positive: what the cells do not resolve, and an
        h = p/p_S that is not periodic, oscillate over the whole box.

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
        interpolation_order: int = POINTS,
        translation: Interpolant = "lagrange",
    ) -> None:
        check_model(model)
        check_grid(grid)
        self.model, self.grid = model, grid
        self.positive = check_flag("positive", positive)
        self.balanced = check_flag("balanced", balanced)
        self.interpolation_order, self.translation = interpolation_order, translation
        self.form = balanced_form(model, grid) if balanced else plain_form(grid)
        self.translate = self._translation()
        self.kick = RotationDiffusion(model, grid, self.balanced, self.positive)

    @property
    def options(self) -> dict[str, Any]:
        """Keyword arguments that build this scheme again."""
        options: dict[str, Any] = {
            "positive": self.positive,
            "balanced": self.balanced,
            "interpolation_order": self.interpolation_order,
        }
        # Runs that were made when there was one translation only are still the same.
        fourier = self.translation == "fourier"
        return {**options, "translation": "fourier"} if fourier else options

    @property
    def symmetric(self) -> bool:
        """Whether the error has even powers of ds only; limiters have none."""
        return not self.positive

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

    def _translation(self) -> Translation:
        """The translation that was asked for."""
        if self.translation == "lagrange":
            order = self.interpolation_order
            return Translation(self.model, self.grid, order, self.positive)
        if self.translation != "fourier":
            raise ValueError(
                '`translation` must be "lagrange" or "fourier", got '
                f"{shown(self.translation)}."
            )
        if self.positive:
            raise ValueError(
                '`positive` must be False with `translation="fourier"`, got True: a '
                "trigonometric interpolant is not positive; choose one of the two."
            )
        if self.interpolation_order != POINTS:
            raise ValueError(
                '`interpolation_order` must be left out with `translation="fourier"`, '
                f"got {self.interpolation_order!r}: the interpolant is that of all "
                "cells."
            )
        return FourierTranslation(self.model, self.grid)

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
