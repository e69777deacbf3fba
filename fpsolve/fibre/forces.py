"""Forces of a chain of edges and how they change: bending, weight, tension."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from fpsolve._support.arrays import Array
from fpsolve.fibre.ends import Clamped, Nozzle
from fpsolve.fibre.string import String

__all__ = ["Forces"]


@dataclass(frozen=True)
class Forces:
    """F(r, T) = −K r + f − ∇φ(r)^T T, φ_i = (|e_i|² − h²)/(2h) = 0.

    K is the matrix of the bending energy, f = m g and what clamped directions add. Its
    potential energy is ½ r·K r − f·r + const, of which −K r + f is the exact gradient.

    Attributes
    ----------
    string : String
    """

    string: String

    @cached_property
    def _curvature(self) -> tuple[sparse.csr_array, Array, Array]:
        """C, c, w of curvatures C r − c at places of weight w in s."""
        string, h = self.string, self.string.edge
        n = string.n_edges
        inner = sparse.diags_array(
            [1.0, -2.0, 1.0], offsets=[0, 1, 2], shape=(n - 1, n + 1)
        )
        rows, known, weights = [inner / h**2], [np.zeros((n - 1, 3))], [h] * (n - 1)
        for held, near, sign in ((string.start, 0, 1.0), (string.end, n, -1.0)):
            if isinstance(held, Clamped):
                # (τ of the edge − direction)/(h/2) over half an edge; a nozzle holds
                # the edge before, too, so that the bend has a whole one.
                over = h if isinstance(held, Nozzle) else h / 2
                slope = 1 / (h * over)
                edge = sparse.csr_array(
                    ([-slope, slope], ([0, 0], [near, near + int(sign)])),
                    shape=(1, n + 1),
                )
                rows.append(edge)
                known.append(sign / over * np.array([held.direction]))
                weights.append(over)
        return sparse.vstack(rows, "csr"), np.concatenate(known), np.array(weights)

    @cached_property
    def bending(self) -> sparse.csr_array:
        """K, shape (n + 1, n + 1), the same for every component."""
        curvature, _, weights = self._curvature
        weighted = sparse.diags_array(self.string.bending_stiffness * weights)
        return sparse.csr_array(curvature.T @ weighted @ curvature)

    @cached_property
    def constant(self) -> Array:
        """f, shape (n + 1, 3)."""
        curvature, known, weights = self._curvature
        weighted = self.string.bending_stiffness * weights[:, None] * known
        weight = self.string.masses[:, None] * np.array(self.string.gravity)
        return np.asarray(curvature.T @ weighted + weight)

    def energy(self, r: Array) -> float:
        """Potential energy of bending and weight in J; 0 if straight at height 0."""
        curvature, known, weights = self._curvature
        bent = ((curvature @ r - known) ** 2).sum(axis=1) @ weights
        weight = self.string.masses @ (r @ np.array(self.string.gravity))
        return float(0.5 * self.string.bending_stiffness * bent - weight)

    def total(self, r: Array, tension: Array) -> Array:
        """F, shape (n + 1, 3)."""
        pulled = tension[:, None] * np.diff(r, axis=0) / self.string.edge
        force = self.constant - self.bending @ r
        force[:-1] += pulled
        force[1:] -= pulled
        return np.asarray(force)

    def stretched(self, r: Array) -> Array:
        """φ, shape (n,)."""
        h = self.string.edge
        return np.asarray(((np.diff(r, axis=0) ** 2).sum(axis=1) - h**2) / (2 * h))

    def constraint(self, r: Array) -> sparse.csr_array:
        """∂φ/∂r, shape (n, 3 (n + 1)), components of a node side by side."""
        n = self.string.n_edges
        edges = np.diff(r, axis=0) / self.string.edge
        row = np.repeat(np.arange(n), 3)
        place = np.arange(3 * n)
        values = np.concatenate([-edges.ravel(), edges.ravel()])
        where = np.concatenate([row, row]), np.concatenate([place, place + 3])
        return sparse.csr_array((values, where), shape=(n, 3 * (n + 1)))

    def stiffness(self, tension: Array) -> sparse.csr_array:
        """−∂F/∂r, shape (3 (n + 1), 3 (n + 1))."""
        n = self.string.n_edges
        step = sparse.diags_array([-1.0, 1.0], offsets=[0, 1], shape=(n, n + 1))
        pulled = step.T @ sparse.diags_array(tension / self.string.edge) @ step
        return sparse.kron(self.bending + pulled, sparse.eye_array(3), "csr")
