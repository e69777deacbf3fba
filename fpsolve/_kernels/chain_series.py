"""Numbers of a chain at one time, for the series of a run."""

import numpy as np

from fpsolve._kernels.compiling import njit

__all__ = ["chain_numbers"]


@njit(cache=True, error_model="numpy")
def chain_numbers(r, v, tension, masses, laid, edge):
    """Of n edges: kinetic energy of nodes not laid, max |T|, stretch, length not laid.

    The stretch is the largest | |e_i|/h − 1 |; an edge is laid with both of its nodes.
    """
    kinetic, largest, stretched, free = 0.0, 0.0, 0.0, 0
    for i in range(masses.size):
        if not laid[i]:
            kinetic += 0.5 * masses[i] * (v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2)
    for i in range(tension.size):
        largest = max(largest, abs(tension[i]))
        square = 0.0
        for c in range(3):
            square += (r[i + 1, c] - r[i, c]) ** 2
        stretched = max(stretched, abs(np.sqrt(square) / edge - 1))
        free += not (laid[i] and laid[i + 1])
    return kinetic, largest, stretched, edge * free
