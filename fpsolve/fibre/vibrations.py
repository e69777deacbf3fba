"""Small vibrations of a fibre about where it rests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, qr

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer, shown
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.rest import Equilibrium, coarser

__all__ = ["Modes", "modes"]

# Dense matrices of so many rows are taken apart in half a minute.
MOST_EDGES = 512


@dataclass(frozen=True, eq=False)
class Modes:
    """The slowest small vibrations r + ε u cos ωt of a fibre at rest.

    Attributes
    ----------
    equilibrium : Equilibrium
    squares : ndarray, shape (n,)
        ω² in rad²/s², in rising order; negative where the fibre falls away from its
        position instead of swinging about it.
    errors : ndarray, shape (n,)
        Bounds of the errors of `squares` from the length of the edges: the changes from
        half as many, three times the errors at order 2. Infinite where these do not
        exist.
    displacements : ndarray, shape (n, n_edges + 1, 3)
        u, of ∫ ρA |u|² ds = 1.
    """

    equilibrium: Equilibrium
    squares: Array
    errors: Array
    displacements: Array

    @property
    def angular_frequencies(self) -> Array:
        """ω in rad/s; NaN for what does not swing."""
        return np.sqrt(np.where(self.squares >= 0, self.squares, np.nan))

    @property
    def frequencies(self) -> Array:
        """ω/2π in Hz; NaN for what does not swing."""
        return np.asarray(self.angular_frequencies / (2 * np.pi))

    @property
    def stable(self) -> bool:
        """Whether no displacement grows: all ω² are positive."""
        return bool(self.squares[0] > 0)

    def __repr__(self) -> str:
        slowest = ", ".join(f"{one:.4g}" for one in self.frequencies)
        return f"Modes({slowest} Hz)"


def modes(equilibrium: Equilibrium, n: int = 6) -> Modes:
    """ω² ρA u = −∂_s(δT ∂_s r + T ∂_s u − EI ∂_sss u), ∂_s r·∂_s u = 0.

    Vibrations of the chain that keep the lengths of its edges: the eigenvalues of the
    stiffness in the null space of the constraints, all of them found at once. Their
    error is of order 2 in the length of an edge; the multiplicity is counted, so that a
    straight fibre has each frequency twice.

    Parameters
    ----------
    equilibrium : Equilibrium
        Of at most 512 edges.
    n : int
        How many, the slowest.

    Returns
    -------
    Modes

    Raises
    ------
    TypeError
        If it is no `Equilibrium`.
    ValueError
        If there are not so many modes, or the edges are too many for dense matrices.

    References
    ----------
    [KMW09]_, equation (4).
    """
    if not isinstance(equilibrium, Equilibrium):
        raise TypeError(
            f"`equilibrium` must be an `Equilibrium`, got {shown(equilibrium)}; "
            "`fpsolve.fibre.equilibrium(string)` makes one."
        )
    string = equilibrium.string
    if string.n_edges > MOST_EDGES:
        raise ValueError(
            f"`equilibrium` must have at most {MOST_EDGES} edges, got {string.n_edges}."
        )
    squares, displacements = _slowest(equilibrium, n)
    half = coarser(equilibrium)
    errors = np.full(squares.size, np.inf)
    if half is not None:
        known, _ = _slowest(half, min(n, 2 * half.string.moving.size))
        errors[: known.size] = np.abs(squares[: known.size] - known)
    return Modes(equilibrium, squares, errors, displacements)


def _slowest(rest: Equilibrium, n: int) -> tuple[Array, Array]:
    """The n smallest eigenvalues among displacements that keep lengths, with these."""
    string, forces = rest.string, Forces(rest.string)
    places = (3 * string.moving[:, None] + np.arange(3)).ravel()
    inner = forces.constraint(rest.r)[:, places].toarray()
    allowed = qr(inner.T)[0][:, string.n_edges :]
    n = check_integer("n", n, 1, allowed.shape[1])
    stiffness = forces.stiffness(rest.tension)[places][:, places]
    masses = np.repeat(string.masses, 3)[places]
    squares, found = eigh(
        allowed.T @ (stiffness @ allowed),
        allowed.T @ (masses[:, None] * allowed),
        subset_by_index=[0, n - 1],
    )
    displacements = np.zeros((n, 3 * (string.n_edges + 1)))
    displacements[:, places] = (allowed @ found).T
    return squares, displacements.reshape(n, -1, 3)
