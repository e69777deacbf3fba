"""The palindrome K½ T½ R½ O R½ T½ K½ for the density of a smooth fibre."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.density.schemes.form import State
from fpsolve.density.schemes.rotation_table import LARGEST_TABLE
from fpsolve.density.smooth.curvature_modes import CurvatureModes
from fpsolve.density.smooth.relaxation import Relaxation
from fpsolve.density.smooth.translation import SmoothTranslation
from fpsolve.density.smooth.turn import Kick, Rotation
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid, check_smooth_grid
from fpsolve.model.potentials.at_points import gradient_at
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["SmoothDriftKick", "split_force"]

# Unknown and scratch of two passes, and copies in the order that products want.
ALIVE = 9.0
# Mass errors that are rounding, and worth a factor.
SEEN, ROUNDING = 2e-14, 1e-12
# Correction of κ beyond which a first order says nothing.
LARGEST = 0.5
# Below this share of 2R, x − tanh x from its series: the rest is below rounding.
_SHORT = 0.02


class SmoothDriftKick:
    """p ← K½ T½ R½ O R½ T½ K½ p: equation (23), every sub-step exact in time.

    T moves ξ, O is the whole flow of (α, κ) without a force, and the force F is split
    into a kick of the curvature by b F, b = tanh(ds/2R), and a rotation of the angle
    that follows F over the length a = ds/2 - R b: for a force that does not change both
    together are exact for every ds/R. Where ds is short against R it is the splitting
    of Langevin equations, a = O(ds³); for R → 0 it becomes the palindrome of the
    basic model (`drift_kick`), at the same ds. The order is 2 in ds for fixed R, and in
    the marginal of (ξ, α) for all R. What is said about κ given both is corrected where
    it is read, and lags behind by a small share O(R) where ds is not short against R,
    which the errors of extrapolated runs contain.
    `interpolation_order` in Δξ, spectral in α and κ. Conserves: mass, to rounding. Not
    kept: the sign; the negative mass is recorded. Build it with
    `fpsolve.smooth_drift_kick`.

    Parameters
    ----------
    model : SmoothLayDownModel
    grid : SmoothPhaseSpaceGrid
        n_alpha even, cells in κ no wider than √(A²/(2R)).
    interpolation_order : int
        Points of the translation in each direction, even.

    Raises
    ------
    TypeError, ValueError
        If an argument is none of these, or the cells do not resolve the curvature.

    References
    ----------
    [KMW09]_, section 3.2, equation (23); composed as in [Str68]_.
    """

    name = "smooth_drift_kick"
    order = 2
    correction_limit = 0.02

    def __init__(
        self,
        model: SmoothLayDownModel,
        grid: SmoothPhaseSpaceGrid,
        *,
        interpolation_order: int = 8,
    ) -> None:
        remedy = "make one by SmoothLayDownModel(potential, relaxation_length, noise)"
        check_kind("model", model, SmoothLayDownModel, remedy)
        check_smooth_grid(grid)
        check_resolution(model, grid)
        self.model, self.grid = model, grid
        self.interpolation_order = interpolation_order
        self.modes = CurvatureModes(grid)
        self.translate = SmoothTranslation(model, grid, interpolation_order)
        self.kick, self.rotate = Kick(model, grid), Rotation(model, grid)
        self.relax = Relaxation(model, grid)
        self.bend = bend_of(model, grid)

    @property
    def options(self) -> dict[str, Any]:
        """Keyword arguments that build this scheme again."""
        return {"interpolation_order": self.interpolation_order}

    @property
    def n_arrays(self) -> float:
        """Densities alive during a run, as measured, and two tables of rotations."""
        table = self.grid.shape[2] / (4 * self.grid.shape[3])
        return ALIVE + 2.0 * min(LARGEST_TABLE, table)

    def start(self, p0: Array) -> State:
        """State of a run that begins at p0."""
        values = self.modes.of(self.grid.check(p0, "p0"))
        return State(values, np.empty_like(values), self._mass(values))

    def density(self, state: State) -> Array:
        """The density of a state; a view that the next step overwrites.

        p + δ ∂_κ(κ p) of what is evolved, with δ = c ∂F/∂α and the length c of
        `correction`: the force, which changes with the angle while the curvature
        relaxes, makes that vary less, to first order by this.
        """
        p = self.evolved(state)
        if state.n_steps:
            p += self._corrected(state.values, state.scratch)
        return p

    def correction_of(self, p: Array, ds: float) -> Array:
        """What `density` adds to p where steps of ds have led to it.

        A density that steps leave as it is, `steady_state` looks for one, is recorded
        with this.
        """
        return self._corrected(self.modes.of(p), ds)

    def _corrected(self, values: Array, ds: float) -> Array:
        share = correction(ds, self.model.relaxation_length)
        stretched = np.empty(self.grid.shape)
        self.modes.apply(self.modes.stretching, values, stretched)
        stretched *= np.clip(share * self.bend, -LARGEST, LARGEST)[..., None]
        return stretched

    def evolved(self, state: State) -> Array:
        """The density that steps go on from; a view that the next step overwrites."""
        p = state.work.reshape(self.grid.shape)
        self.modes.apply(self.modes.backward, state.values, p)
        return p

    def advance(self, state: State, s: float, ds: float, n_steps: int = 1) -> None:
        """Advance by n_steps from s; the kicks of neighbouring steps are one."""
        kicked, turned = split_force(ds, self.model.relaxation_length)
        self.kick(state.values, s, kicked, state.values)
        for step in range(n_steps):
            at = s + step * ds
            for operator, begin, length in (
                (self.translate, 0.0, ds / 2), (self.rotate, 0.0, turned),
                (self.relax, 0.0, ds), (self.rotate, 0.5, turned),
                (self.translate, 0.5, ds / 2),
            ):  # fmt: skip
                operator(state.values, at + begin * ds, length, state.work)
                state.swap()
            ends = 1 if step == n_steps - 1 else 2
            self.kick(state.values, at + ds, ends * kicked, state.values)
        state.n_steps += n_steps
        state.scratch = ds
        self._restore_mass(state)

    def _mass(self, values: Array) -> float:
        return float(values[:, :, 0].sum()) * self.grid.cell_volume

    def _restore_mass(self, state: State) -> None:
        # As in the basic scheme: rounding of one sign is taken out, and nothing else.
        mass = self._mass(state.values)
        error = mass / state.target_mass - 1.0
        state.correction = 0.0
        if SEEN < abs(error) < ROUNDING:
            state.correction = error
            state.values *= state.target_mass / mass


def split_force(ds: float, relaxation_length: float) -> tuple[float, float]:
    """b = tanh(ds/2R) of the kick and a = ds/2 - R b of the rotation, both odd in ds.

    The answer of (κ, α) to a force F from s to s + ds is
    ((1 - e^{−ds/R}) F, (ds - R(1 - e^{−ds/R})) F); a and b give it, half of the force
    at each end.
    """
    share = ds / (2 * relaxation_length)
    if abs(share) > _SHORT:
        rest = share - math.tanh(share)
    else:
        rest = share**3 / 3 - 2 * share**5 / 15 + 17 * share**7 / 315
    return math.tanh(share), relaxation_length * rest


def correction(ds: float, relaxation_length: float) -> float:
    """R tanh(x²/6)/2, x = ds/R: what to shrink κ by at the end of a step, over ∂F/∂α.

    For F = λα the palindrome of (κ, α) leaves the variance of κ too large, to first
    order in λ, by twice a length that rises from ds²/(12R) for short steps to R/2 for
    long ones. This one has the same ends, and is off by an eighth of it in between; it
    is even in ds, as all errors are.
    """
    share = ds / relaxation_length
    return 0.5 * relaxation_length * math.tanh(share * share / 6.0)


def bend_of(model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid) -> Array:
    """∂F/∂α = ∇B·τ, F = -∇B·τ⊥; shape (n1, n2, n_alpha)."""
    force1, force2 = gradient_at(model.potential, *grid.plane())
    along = np.cos(grid.alpha), np.sin(grid.alpha)
    return force1[..., None] * along[0] + force2[..., None] * along[1]


def check_resolution(model: SmoothLayDownModel, grid: SmoothPhaseSpaceGrid) -> None:
    """Raise ValueError unless cells in κ resolve the Gaussian of the noise."""
    deviation, width = math.sqrt(model.curvature_variance), grid.spacing[3]
    if not deviation > 0:
        raise ValueError(
            "`noise` must be positive for a density of the curvature, got 0: without "
            "noise κ is a function of the path; follow it with `sample_paths`."
        )
    if not width <= deviation:
        fewest = math.ceil(3 * grid.kappa_half_width / deviation)
        raise ValueError(
            "`grid` must have cells in κ no wider than √(A²/2R) = "
            f"{deviation:.3g}, got {width:.3g}; with `kappa_half_width` = "
            f"{grid.kappa_half_width:g} take {fewest} of them."
        )
