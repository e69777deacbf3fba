"""The tension at the ends of a fibre, from the pull of its edges."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fpsolve._kernels.chain import Chain
from fpsolve._support.arrays import Array
from fpsolve.fibre.ends import Clamped, End, Free, Nozzle
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.string import String

__all__ = ["EndTensions", "nozzle_tension"]


@dataclass(frozen=True)
class EndTensions:
    """T(0) and T(L) from n = T ∂_s r − ∂_s(EI ∂_ss r), T = n·∂_s r − EI |∂_ss r|².

    What the two parts of a fibre pull at each other with is known in the middle of
    every edge, n_{i+½} = T_i e_i/h plus the bending forces on one side, and goes on
    linearly to the end: exactly if load and acceleration are the same everywhere. There
    the tangent is that of the clamp, or goes on linearly as well, and the curvature
    that of the clamp, (e/h − τ)/(h/2), or none. At a free end T vanishes. Of order 2 in
    the edges.

    Attributes
    ----------
    string : String
    """

    string: String

    @cached_property
    def _forces(self) -> Forces:
        return Forces(self.string)

    def __call__(self, r: Array, tension: Array) -> Array:
        """T(0) and T(L) in N, shape (2,), of these positions and tensions of edges."""
        string, forces = self.string, self._forces
        weight = string.masses[:, None] * np.array(string.gravity)
        bending = forces.constant - weight - forces.bending @ r
        tangents = np.diff(r, axis=0) / string.edge
        pull = tension[:, None] * tangents + np.cumsum(bending, axis=0)[:-1]
        return np.array([
            self._at(string.start, pull[:2], tangents[:2]),
            self._at(string.end, pull[:-3:-1], tangents[:-3:-1]),
        ])  # fmt: skip

    def _at(self, end: End, pull: Array, tangents: Array) -> float:
        """From the nearest edge and the next; the clamp's direction is the fibre's."""
        if isinstance(end, Free):
            return 0.0
        bent = 0.0
        if isinstance(end, Clamped):
            tangent = np.array(end.direction)
            bend = 2 / self.string.edge * (tangents[0] - tangent)
            bent = self.string.bending_stiffness * float(bend @ bend)
        else:
            tangent = 1.5 * tangents[0] - 0.5 * tangents[1]
            tangent = tangent / np.linalg.norm(tangent)
        return float((1.5 * pull[0] - 0.5 * pull[1]) @ tangent) - bent


def nozzle_tension(
    string: String, numbers: Chain, r: Array, tension: Array, out: float
) -> float:
    """T in N where a fibre leaves its nozzle, `out` m before its first node.

    As `EndTensions` finds it, but that the clamp of a nozzle bends a whole edge.
    """
    assert isinstance(string.start, Nozzle)
    h, tangent = string.edge, np.array(string.start.direction)
    tangents = np.diff(r[:3], axis=0) / h
    weight = numbers.masses[:2, None] * np.array(string.gravity)
    bending = numbers.constant[:2] - weight
    for i in range(2):
        bending[i] -= numbers.bending[i, 2 - i :] @ r[: 3 + i]
    pull = tension[:2, None] * tangents + np.cumsum(bending, axis=0)
    bend = (tangents[0] - tangent) / h
    there = pull[0] + (0.5 + out / h) * (pull[0] - pull[1])
    return float(there @ tangent - string.bending_stiffness * (bend @ bend))
