"""What is evolved, p or h = p/p_S, as planes of constant α on the device."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.arrays.library import Foreign, Library, on_host
from fpsolve.density.schemes.form import DensityForm, State

__all__ = ["ArrayForm", "DeviceDensity"]


class ArrayForm:
    """A `DensityForm` whose unknown is an array (n_alpha, n1, n2) of a library.

    Angles come first: a plane is then what a translation multiplies.

    Parameters
    ----------
    form : DensityForm
    library : Library
    """

    def __init__(self, form: DensityForm, library: Library) -> None:
        self.form, self.library, self.grid = form, library, form.grid
        self.weight = None if form.weight is None else library.array(form.weight)
        self.sum = library.compiled(weighted_sum)

    def start(self, p0: Array) -> State:
        """State of a run that begins at the density p0, which lies on the host."""
        state = self.form.start(p0)
        # No step writes into the arrays of another: there is no scratch.
        state.work = np.empty(0)
        state.values = self.library.array(state.values.transpose(2, 0, 1))
        return state

    def density(self, state: State) -> Any:
        """The density p of a state."""
        values: Foreign = state.values
        weighted = values if self.weight is None else values * self.weight
        return DeviceDensity(weighted, self.library)

    def mass(self, values: Foreign) -> float:
        """∫ w u dξ dα by the midpoint rule."""
        return float(self.sum(values, self.weight)) * self.grid.cell_volume

    def rescale(self, state: State, factor: float) -> None:
        """u ← factor · u."""
        state.values = state.values * float(factor)


class DeviceDensity:
    """A density on the device, of which the host takes what it asks for.

    Parameters
    ----------
    planes : array, shape (n_alpha, n1, n2)
    library : Library
    """

    def __init__(self, planes: Foreign, library: Library) -> None:
        self.planes, self.library = planes, library
        self._copy: Array | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """(n1, n2, n_alpha), as on the host."""
        n_alpha, n1, n2 = self.planes.shape
        return n1, n2, n_alpha

    def sum(self) -> float:
        """Σ over all cells."""
        return float(self.library.xp.sum(self.planes))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        """The density on the host, copied once."""
        if self._copy is None:
            host = on_host(self.planes).transpose(1, 2, 0)
            self._copy = np.ascontiguousarray(host)
        return self._copy if dtype is None else self._copy.astype(dtype, copy=False)


def weighted_sum(xp: Any, values: Foreign, weight: Foreign) -> Foreign:
    """Σ w u, over the angles first."""
    sums = xp.sum(values, axis=0)
    return xp.sum(sums if weight is None else sums * weight)
