"""What a scheme evolves: the density p itself, or the ratio h with p = e^{−B} h."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.functionals import row_sums, scale_rows
from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import value_at

# e^{−600} = 1e−261: cells beyond carry no mass, and dividing by less would overflow.
DEEPEST = 600.0
# Interpolating h across such a range leaves errors that outgrow the density where
# the mass is; B = r⁴/4 on a box of half width 4 is an example.
LARGEST_CONTRAST = 1e8


@dataclass
class State:
    """A run's unknown and its scratch array; a scheme owns what is in them.

    Attributes
    ----------
    values, work : ndarray, shape grid.shape
        Unknown (p or h) and scratch; they change places during a step.
    target_mass : float
        Mass the corrections restore: that of the initial density.
    correction : float
        Relative mass error removed in the last `advance`, signed.
    report : dict of float
        What the scheme tells of the last `advance` besides, each a series of the
        solution if it is there from the start on: `theta`, the smallest weight of the
        adjusted advection.
    n_steps : int
        Steps made since the start.
    scratch : object
        What the scheme needs besides and writes again at every step. It belongs to
        the run, not to the scheme, which several runs may share at the same time.
    """

    values: Array
    work: Array
    target_mass: float
    correction: float = 0.0
    n_steps: int = 0
    scratch: Any = None
    report: dict[str, float] = field(default_factory=dict)

    def swap(self) -> None:
        """Exchange unknown and scratch."""
        self.values, self.work = self.work, self.values


@dataclass(frozen=True)
class DensityForm:
    """p = w u, with a weight w(ξ) that does not depend on α.

    Parameters
    ----------
    grid : PhaseSpaceGrid
    weight : ndarray, shape (n1, n2), or None
        e^{−B} (up to a factor) for the balanced form; None for p itself.
    nearest : pair of ndarray of int, shape (n1, n2), or None
        Where e^{−B} is beyond numbers in some cells: for every cell the nearest in
        which it is not.
    """

    grid: PhaseSpaceGrid
    weight: Array | None
    nearest: tuple[NDArray[np.intp], NDArray[np.intp]] | None = None

    def start(self, p0: Array) -> State:
        """State of a run that begins at the density p0."""
        p0 = self.grid.check(p0, "p0")
        values = self._divided(p0)
        if self.nearest is not None:
            # No mass is there, but its neighbours are interpolated from it: a constant
            # h must be one there too.
            values = values[self.nearest]
        if self.weight is not None:
            self._check_contrast(values, self.weight)
        mass = self._sums(p0).sum() * self.grid.cell_volume
        return State(values, np.empty_like(p0), mass)

    def _divided(self, p0: Array) -> Array:
        """A copy of p0, over the weight if there is one."""
        if self.weight is None:
            return p0.copy()
        values = np.empty_like(p0)
        scale_rows(p0, 1.0 / self.weight, values)
        return values

    def _sums(self, values: Array) -> Array:
        sums = np.empty(self.grid.shape[:2])
        row_sums(values, sums)
        return sums

    def _check_contrast(self, values: Array, weight: Array) -> None:
        mean = self.mass(values) / (weight.sum() * self.grid.cell_volume)
        contrast = float(values.max()) / (mean / self.grid.shape[2])
        if contrast > LARGEST_CONTRAST:
            raise ValueError(
                "`p0` must fall off like exp(-B) to be evolved as h = p/p_S, got "
                f"p0/p_S up to {contrast:.1g} times its mean; evolve p itself "
                '(`balanced=False`, or `form="p"`), or shrink `half_width`.'
            )

    def density(self, state: State) -> Array:
        """The density p of a state; a view that the next step overwrites."""
        if self.weight is None:
            return state.values
        scale_rows(state.values, self.weight, state.work)
        return state.work

    def mass(self, values: Array) -> float:
        """∫ w u dξ dα by the midpoint rule."""
        sums = self._sums(values)
        weighted = sums if self.weight is None else sums * self.weight
        return float(weighted.sum()) * self.grid.cell_volume

    def rescale(self, state: State, factor: float) -> None:
        """u ← factor · u."""
        factors = np.full(self.grid.shape[:2], factor)
        scale_rows(state.values, factors, state.values)


def plain_form(grid: PhaseSpaceGrid) -> DensityForm:
    """The density itself."""
    return DensityForm(grid, None)


def balanced_form(model: LayDownModel, grid: PhaseSpaceGrid) -> DensityForm:
    """p = e^{−B} h: the equilibrium is h = const, kept to rounding when v = 0."""
    potential = value_at(model.potential, *grid.plane())
    depth = potential - potential.min()
    weight, too_deep = np.exp(-np.minimum(depth, DEEPEST)), depth > DEEPEST
    if not too_deep.any():
        return DensityForm(grid, weight)
    from scipy.ndimage import distance_transform_edt

    row, column = distance_transform_edt(
        too_deep, return_distances=False, return_indices=True
    )
    return DensityForm(grid, weight, (row, column))
