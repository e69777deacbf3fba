"""Implicit steps of dm/ds = Q m, by one sparse factorisation."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from fpsolve._support.arrays import Array

__all__ = ["METHODS", "BackwardEuler", "Method", "Sdirk2"]


class Method(Protocol):
    """One step m → m(s + ds) for a fixed ds."""

    order: int

    def __call__(self, mass: Array) -> Array:
        """Take a step."""


class BackwardEuler:
    """(1 − ds Q) m_{n+1} = m_n.

    Order 1. For every ds > 0 the mass is kept, positive masses stay positive and the
    relative entropy falls: the inverse is a Markov matrix with the stationary law of
    Q. The matrix is an M-matrix that is diagonally dominant by columns, so its LU
    factors need no pivoting and the substitutions subtract nothing: each cell mass
    comes out accurate relative to itself, however small.
    """

    order = 1

    def __init__(self, generator: Any, ds: float) -> None:
        self.solve = factorised(generator, ds)

    def __call__(self, mass: Array) -> Array:
        """Take a step."""
        return np.asarray(self.solve(mass))


class Sdirk2:
    """(1 − γ ds Q) k = m_n, (1 − γ ds Q) m_{n+1} = m_n + (1/γ − 1)(k − m_n).

    γ = 1 − 1/√2: L-stable, of order 2, with one factorisation for both stages. The
    mass is kept. Positivity is not promised: a start that is rough on the scale of
    √ds can undershoot.
    """

    order = 2
    gamma = 1.0 - 0.5**0.5

    def __init__(self, generator: Any, ds: float) -> None:
        self.solve = factorised(generator, self.gamma * ds)

    def __call__(self, mass: Array) -> Array:
        """Take a step."""
        stage = self.solve(mass)
        ahead = mass + (1.0 / self.gamma - 1.0) * (stage - mass)
        return np.asarray(self.solve(ahead))


METHODS: dict[str, Any] = {"backward_euler": BackwardEuler, "sdirk2": Sdirk2}


def factorised(generator: Any, ds: float) -> Any:
    """The solver of (1 − ds Q) x = b by one sparse factorisation, without pivoting.

    A tridiagonal matrix stays in its order; others are ordered by minimum degree,
    whose fill-in on a grid is half that of a column ordering.
    """
    from scipy.sparse import csc_array, eye_array
    from scipy.sparse.linalg import splu

    matrix = csc_array(eye_array(generator.shape[0]) - ds * generator)
    rows, columns = matrix.nonzero()
    tridiagonal = int(np.abs(rows - columns).max()) <= 1
    ordering = "NATURAL" if tridiagonal else "MMD_AT_PLUS_A"
    factors = splu(
        matrix, ordering, diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    return factors.solve
