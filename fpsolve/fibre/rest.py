"""Where a fibre comes to rest."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from fpsolve._support.arrays import Array
from fpsolve.errors import EquilibriumError
from fpsolve.fibre.end_tensions import EndTensions
from fpsolve.fibre.ends import Free
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.shapes import checked_shape, first_shape
from fpsolve.fibre.string import FEWEST_EDGES, String

__all__ = ["Equilibrium", "coarser", "equilibrium"]

# Of the weight and EI/L²: forces on a node that count as none.
AT_REST = 1e-10
MOST_STEPS = 1000
# Growth of the artificial time step while forces fall, and its reduction.
GROWTH, REDUCTION = 4.0, 8.0
# Edges may turn by that much in a step, in radians.
LARGEST_TURN = 0.5


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Where a fibre is at rest, and the tension that holds it there.

    Attributes
    ----------
    string : String
    r : ndarray, shape (n_edges + 1, 3)
        Positions of the nodes in m.
    tension : ndarray, shape (n_edges,)
        Of the edges in N, positive where the fibre is pulled.
    residual : float
        Largest force left on a node, relative to weight and EI/L².
    position_error : float
        Bound of the error of a position in m from the length of the edges: the distance
        to the shape of half as many, three times the error at order 2. Infinite for
        fewer than 8 edges or an odd number of them.
    end_tension : ndarray, shape (2,)
        T(0) and T(L) in N; `tension` is that in the middle of the edges. Of order 2.
    end_tension_error : ndarray, shape (2,)
        Bounds of their errors, likewise from half of the edges.
    """

    string: String
    r: Array
    tension: Array
    residual: float
    position_error: float
    end_tension: Array
    end_tension_error: Array

    @property
    def s(self) -> Array:
        """Arclength of the nodes in m."""
        return self.string.s

    @property
    def curvature(self) -> Array:
        """|∂_ss r| at the inner nodes in 1/m, shape (n_edges − 1,)."""
        bent = np.diff(self.r, n=2, axis=0) / self.string.edge**2
        return np.asarray(np.linalg.norm(bent, axis=1))


def equilibrium(string: String, *, shape: ArrayLike | None = None) -> Equilibrium:
    """0 = ∂_s(T ∂_s r − ∂_s(EI ∂_ss r)) + ρA g, |∂_s r| = 1.

    Found by Newton's method with an artificial inertia that vanishes as the forces do:
    the fibre creeps from its first shape to rest, so that of several positions it takes
    one it can reach. Whether that is stable `modes` tells. Edges keep their lengths to
    1e-12.

    Parameters
    ----------
    string : String
    shape : array_like, shape (n_edges + 1, 3), optional
        Positions to start from; by default straight, or an arc between two held ends.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ValueError
        If no end is held, or the shape does not fit the fibre.
    EquilibriumError
        If forces remain.

    References
    ----------
    [KMW09]_, equation (4).
    """
    if isinstance(string.start, Free) and isinstance(string.end, Free):
        raise ValueError(
            "`start` and `end` must not both be free: nothing holds the fibre."
        )
    first = first_shape(string) if shape is None else checked_shape(string, shape)
    rest = _at_rest(string, first)
    half = coarser(rest)
    if half is None:
        return rest
    error = float(np.linalg.norm(half.r - rest.r[::2], axis=1).max())
    pulled = np.abs(half.end_tension - rest.end_tension)
    return replace(rest, position_error=error, end_tension_error=pulled)


def coarser(rest: Equilibrium) -> Equilibrium | None:
    """The same position of half as many edges; None if they are too few or odd."""
    n_edges = rest.string.n_edges
    if n_edges < 2 * FEWEST_EDGES or n_edges % 2:
        return None
    string = rest.string.coarser()
    return _at_rest(string, _coarser(string, rest.r))


def _at_rest(string: String, first: Array) -> Equilibrium:
    r, tension, residual = _Rest(string).found(first)
    ends, unknown = EndTensions(string)(r, tension), np.full(2, np.inf)
    return Equilibrium(string, r, tension, residual, np.inf, ends, unknown)


def _coarser(string: String, r: Array) -> Array:
    """Every second node, its edges stretched to their length from a held end on."""
    edges = np.diff(r[::2], axis=0)
    edges *= string.edge / np.linalg.norm(edges, axis=1, keepdims=True)
    if isinstance(string.start, Free):
        return np.asarray(
            r[-1]
            - np.concatenate([np.cumsum(edges[::-1], axis=0)[::-1], np.zeros((1, 3))])
        )
    found = r[0] + np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])
    if not isinstance(string.end, Free):
        # Longer edges reach further than the place that holds them.
        found[-1] = r[-1]
    return np.asarray(found)


@dataclass
class _Rest:
    """The search for a position of rest."""

    string: String
    forces: Forces = field(init=False)
    places: NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        self.forces = Forces(self.string)
        moving = self.string.moving
        self.places = (3 * moving[:, None] + np.arange(3)).ravel()

    @property
    def scale(self) -> float:
        """Weight and EI/L², in N."""
        string = self.string
        weight = string.masses.sum() * np.linalg.norm(string.gravity)
        return float(weight + string.bending_stiffness / string.length**2)

    def found(self, r: Array) -> tuple[Array, Array, float]:
        """Positions and tensions at rest, and the force that is left."""
        string = self.string
        r, tension = r.copy(), np.zeros(string.n_edges)
        inertia = 100 * self.scale / (string.masses.sum() * string.length)
        left = self._left(r, tension)
        for _ in range(MOST_STEPS):
            moved, pulled = self._step(r, tension, inertia)
            turn = np.abs(np.diff(moved, axis=0)).max() / string.edge
            if not turn <= LARGEST_TURN:
                inertia *= REDUCTION
                continue
            r, tension = r + moved, pulled
            before, left = left, self._left(r, tension)
            if left <= AT_REST and np.abs(self.forces.stretched(r)).max() <= (
                1e-13 * string.edge
            ):
                return r, tension, left
            inertia /= min(GROWTH, max(1.0, before / left)) * 1.1
        raise EquilibriumError(left, AT_REST)

    def _left(self, r: Array, tension: Array) -> float:
        force = self.forces.total(r, tension)[self.string.moving]
        return float(np.abs(force).max() / self.scale)

    def _step(self, r: Array, tension: Array, inertia: float) -> tuple[Array, Array]:
        """Changes of r and the new tensions of one step of Newton's method."""
        inner, places = self.forces.constraint(r)[:, self.places], self.places
        masses = np.repeat(self.string.masses, 3)[places]
        matrix = self.forces.stiffness(tension)[places][:, places]
        matrix = matrix + sparse.diags_array(inertia * masses)
        whole = sparse.block_array([[matrix, inner.T], [inner, None]], format="csc")
        known = np.concatenate(
            [self.forces.total(r, tension).ravel()[places], -self.forces.stretched(r)]
        )
        solved = splu(whole).solve(known)
        moved = np.zeros(r.size)
        moved[places] = solved[: places.size]
        return moved.reshape(r.shape), tension + solved[places.size :]
