"""One step of a fibre in time, its edges kept at their length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

from fpsolve._support.arrays import Array
from fpsolve.errors import EdgeLengthError
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.string import String

__all__ = ["ThetaStep"]

# Bandwidth of unknowns (r_i, T_i) side by side: bending reaches two nodes far.
REACH = 8
# Of an edge: deviations of its length that Newton's method leaves.
KEPT = 1e-12
MOST_ITERATIONS = 25


@dataclass(frozen=True, eq=False)
class ThetaStep:
    """M (v¹ − v⁰)/Δ = F(r^θ, T) + D(u − v^θ), r¹ = r⁰ + Δ v^θ, |e_i(r¹)| = h.

    r^θ = θ r¹ + (1 − θ) r⁰, v^θ likewise, M the masses. D is the force of the air
    on half of the neighbouring edges, or minus `damping` times v^θ and their length.
    Newton's method neglects how the force of the air changes with the place and the
    direction of the fibre, which costs an iteration. The tension acts along the edges
    of r^θ and is one more unknown, so that the lengths at the end of the step are
    exact. With θ = ½ it does no
    work, as |e¹|² − |e⁰|² = 2 e^½·(e¹ − e⁰) = 0, bending and weight do theirs exactly,
    and the energy is kept to the residual of Newton's method; with θ > ½ fast waves are
    damped.

    Attributes
    ----------
    string : String
    dt, theta, damping : float
    air : AirFlow or None
    """

    string: String
    dt: float
    theta: float
    damping: float
    air: AirFlow | None = None

    @cached_property
    def _forces(self) -> Forces:
        return Forces(self.string)

    @cached_property
    def _held(self) -> NDArray[np.int64]:
        nodes = np.arange(self.string.n_edges + 1)
        return np.setdiff1d(nodes, self.string.moving)

    @cached_property
    def _inertia(self) -> tuple[Array, Array]:
        """Of every node what multiplies r¹ − r⁰ and v⁰."""
        masses = self.string.masses
        drag = self.damping * masses / self.string.line_density
        by_mass = masses / (self.theta * self.dt)
        return by_mass / self.dt + drag / self.dt, by_mass

    @cached_property
    def _constant(self) -> Array:
        """The part of the matrix that no iteration changes, shape (17, n + 1, 4)."""
        n = self.string.n_edges
        banded = np.zeros((2 * REACH + 1, n + 1, 4))
        bending = self._forces.bending
        for apart in (-2, -1, 0, 1, 2):
            diagonal = self.theta * bending.diagonal(apart)
            # Row i, column i + apart.
            columns = slice(max(apart, 0), n + 1 + min(apart, 0))
            banded[REACH - 4 * apart, columns, :3] = diagonal[:, None]
        banded[REACH, :, :3] += self._inertia[0][:, None]
        return banded

    @cached_property
    def _rows_held(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Places of the rows of nodes that are held, in the banded matrix."""
        rows = (4 * self._held[:, None] + np.arange(3)).ravel()
        columns = rows[:, None] + np.arange(-REACH, REACH + 1)
        diagonals = REACH + rows[:, None] - columns
        inside = (columns >= 0) & (columns < 4 * (self.string.n_edges + 1))
        return diagonals[inside], columns[inside]

    def __call__(
        self, r: Array, v: Array, tension: Array, t: float
    ) -> tuple[Array, Array, Array, int]:
        """r, v, T at the end of the step that begins at time t, and the iterations.

        Raises
        ------
        EdgeLengthError
            If Newton's method does not converge.
        """
        string, theta = self.string, self.theta
        moved = self.dt * v
        moved[self._held] = 0.0
        allowed = KEPT * string.edge
        change = np.inf
        for iteration in range(MOST_ITERATIONS):
            stretched = self._forces.stretched(r + moved)
            left = np.abs(stretched).max()
            if change <= 1e3 * allowed and left <= allowed:
                rate = moved / self.dt
                return r + moved, v + (rate - v) / theta, tension, iteration
            if not np.isfinite(left):
                break
            middle = r + theta * moved
            balance = self._inertia[0][:, None] * moved - self._inertia[1][:, None] * v
            balance -= self._forces.total(middle, tension)
            slope = None
            if self.air is not None:
                force, slope = self._pulled(middle, moved / self.dt, t)
                balance -= force
            balance[self._held] = 0.0
            banded = self._matrix(middle, r + moved, tension, slope)
            solved = self._solve(banded, balance, stretched)
            moved = moved + solved[:, :3]
            tension = tension + solved[:-1, 3]
            change = np.abs(solved[:, :3]).max()
        raise EdgeLengthError(t, self.dt, float(left / string.edge))

    def _pulled(self, middle: Array, rate: Array, t: float) -> tuple[Array, Array]:
        """Force of the air on every node, and what multiplies −(r¹ − r⁰) in it."""
        air = self.air
        assert air is not None
        # Of half of both neighbours; an end has one.
        edges = np.diff(middle, axis=0)
        tangent = np.concatenate([edges[:1], edges[1:] + edges[:-1], edges[-1:]])
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        wind = air.at(middle, t + self.theta * self.dt) - rate
        force, slope = air.pull(self.string.diameter, wind, tangent)
        lengths = self.string.masses / self.string.line_density
        return lengths[:, None] * force, (lengths / self.dt)[:, None, None] * slope

    def _matrix(
        self, middle: Array, end: Array, tension: Array, slope: Array | None
    ) -> Array:
        """The banded matrix of Newton's method, shape (17, 4 (n + 1))."""
        h, banded = self.string.edge, self._constant.copy()
        pulled = (self.theta / h * tension)[:, None]
        banded[REACH, :-1, :3] += pulled
        banded[REACH, 1:, :3] += pulled
        banded[REACH + 4, :-1, :3] -= pulled
        banded[REACH - 4, 1:, :3] -= pulled
        if slope is not None:
            for row in range(3):
                for column in range(3):
                    banded[REACH + row - column, :, column] += slope[:, row, column]
        # Columns of the tensions, along the edges in the middle of the step …
        edges = np.diff(middle, axis=0) / h
        banded[REACH - 3 : REACH, :-1, 3] = -edges.T
        banded[REACH + 1 : REACH + 4, :-1, 3] = edges.T
        flat = banded.reshape(2 * REACH + 1, -1)
        flat[self._rows_held] = 0.0
        flat[REACH, (4 * self._held[:, None] + np.arange(3)).ravel()] = 1.0
        # … and rows of the lengths, at its end.
        edges = np.diff(end, axis=0) / h
        for axis in range(3):
            banded[REACH + 3 - axis, :-1, axis] = -edges[:, axis]
            banded[REACH - 1 - axis, 1:, axis] = edges[:, axis]
        return flat

    def _solve(self, banded: Array, balance: Array, stretched: Array) -> Array:
        """Changes (r_i, T_i) of Newton's method, shape (n + 1, 4)."""
        n = self.string.n_edges
        known = np.zeros((n + 1, 4))
        known[:, :3] = -balance
        known[:-1, 3] = -stretched
        # The last node has no edge behind it.
        size = 4 * n + 3
        solved = np.zeros(4 * (n + 1))
        solved[:size] = solve_banded(
            (REACH, REACH), banded[:, :size], known.ravel()[:size], check_finite=False
        )
        return solved.reshape(n + 1, 4)
