"""Cells of energy, graded to the singular ends, and the generator on them."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag, check_integer
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.checks import check_energies

__all__ = ["EnergyGrid"]


# With more cells the smallest lose their digits: masses and first moments of a cell are
# differences of N and J. The error of order 2 is 1e-7 there.
_FEWEST_CELLS, _MOST_CELLS = 4, 4000


class EnergyGrid:
    """Cells of |G| on [0, g_max], or of signed G on [-g_max, g_max].

    The faces are g_max sin²(π t/2) for equidistant t, finest at the ends of (0, g_max):
    at 0 the density has a logarithm, at g_max the process looks like the square of a
    planar Brownian motion, for which √(g_max - g) is the natural coordinate.

    Parameters
    ----------
    averages : OrbitAverages
    n_cells : int
        From 4 to 4000; even when signed, so that 0 is a face.
    signed : bool
        Whether G keeps its sign.

    Raises
    ------
    ValueError
        If there are fewer than 4 cells, more than 4000, or a signed grid has an odd
        number.
    """

    def __init__(
        self, averages: OrbitAverages, n_cells: int, signed: bool = False
    ) -> None:
        n_cells = check_integer("n_cells", n_cells, at_least=_FEWEST_CELLS)
        if n_cells > _MOST_CELLS:
            raise ValueError(
                f"`n_cells` must be at most {_MOST_CELLS}, got {n_cells}: more cells "
                "have smaller masses at the ends than rounding allows."
            )
        signed = check_flag("signed", signed)
        if signed and n_cells % 2:
            raise ValueError(
                f"`n_cells` must be even on a signed grid, got {n_cells}: zero must be "
                "a face."
            )
        self.averages: Any = averages
        self.n_cells, self.signed = n_cells, signed

    _recorded: ClassVar[str] = "energy_grid"

    def _recorded_parts(self) -> dict[str, Any]:
        # The process whose cells they are is another argument.
        return {"n_cells": self.n_cells, "signed": self.signed}

    @classmethod
    def of_cells(
        cls, faces: Array, centres: Array, equilibrium: Array, signed: bool
    ) -> EnergyGrid:
        """Return cells as a file holds them, without their process.

        They have no generator: nothing can be solved on them.
        """
        made = cls.__new__(cls)
        made.averages, made.n_cells, made.signed = None, centres.size, signed
        vars(made).update(faces=faces, centres=centres, equilibrium=equilibrium)
        return made

    @property
    def g_max(self) -> float:
        """Energy of the circle."""
        return float(self.faces[-1])

    @cached_property
    def faces(self) -> Array:
        """Ends of the cells, ascending, shape (n_cells + 1,)."""
        n_upper = self.n_cells // 2 if self.signed else self.n_cells
        upper = (
            self.averages.well.g_max
            * np.sin(np.pi / 2 * np.linspace(0.0, 1.0, n_upper + 1)) ** 2
        )
        return np.concatenate([-upper[:0:-1], upper]) if self.signed else upper

    @property
    def widths(self) -> Array:
        """Widths of the cells."""
        return np.diff(self.faces)

    @cached_property
    def equilibrium(self) -> Array:
        """Cell masses of the stationary law, from N(g) exactly; they sum to one."""
        beyond = self.averages.measure(np.abs(self.faces))
        below = np.sign(self.faces) * (self.averages.total - beyond)
        return np.asarray(np.diff(below) / (below[-1] - below[0]))

    @cached_property
    def centres(self) -> Array:
        """Mean energy of each cell in the stationary law, ∫ g S/∫ S; J' = -g S."""
        return np.asarray(-np.diff(self._action) / (self.total * self.equilibrium))

    @property
    def total(self) -> float:
        """∫ S over the grid."""
        return float(self.averages.total) * (2 if self.signed else 1)

    @property
    def _action(self) -> Array:
        return np.asarray(self.averages.action(np.abs(self.faces)))

    def generator(self, noise: float) -> Any:
        """Q of dm/ds = Q m for the cell masses m, a tridiagonal sparse array.

        The flux between neighbours is (A²/2) J (u_i - u_{i+1})/(c_{i+1} - c_i) with
        u = m/equilibrium, J at the face and c the centres. Columns sum to zero, rates
        are non-negative, and detailed balance holds, so that mass, positivity and
        equilibrium are kept. On a signed grid the centres themselves are an
        eigenvector: Σ c_i m_i decays at A²/2 exactly, as E G does. Order 2.

        Parameters
        ----------
        noise : float
            A > 0.

        References
        ----------
        [CC70]_, fluxes weighted such that a known stationary state is one of the cells.
        """
        from scipy.sparse import diags_array

        flux = 0.5 * noise**2 * self._action[1:-1] / np.diff(self.centres) / self.total
        forwards, backwards = flux / self.equilibrium[:-1], flux / self.equilibrium[1:]
        leaving = np.zeros(self.n_cells)
        leaving[:-1] += forwards
        leaving[1:] += backwards
        return diags_array([backwards, -leaving, forwards], offsets=[1, 0, -1])

    def histogram(self, g: ArrayLike) -> Array:
        """Share of some energies in each cell; on an unsigned grid of their |g|.

        Raises
        ------
        ValueError
            If an energy lies outside [-g_max, g_max].
        """
        energies = check_energies("g", g, self.g_max, signed=True).ravel()
        energies = energies if self.signed else np.abs(energies)
        counts, _ = np.histogram(energies, bins=self.faces)
        return counts / energies.size

    def __repr__(self) -> str:
        lowest = -self.g_max if self.signed else 0.0
        return f"EnergyGrid({self.n_cells} cells on [{lowest:.6g}, {self.g_max:.6g}])"
