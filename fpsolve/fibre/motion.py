"""A fibre in motion."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.fibre.layouts import MOTION
from fpsolve.fibre.string import String

__all__ = ["Motion"]


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Saved):
    """What a fibre did: series at every step, positions and velocities where saved.

    Attributes
    ----------
    string : String
    t : ndarray, shape (n_steps + 1,)
        Times of the steps in s.
    kinetic, potential : ndarray, shape (n_steps + 1,)
        Energies of motion, and of bending and weight, in J.
    largest_tension : ndarray, shape (n_steps + 1,)
        Largest |T| in N of the step that ends there; NaN before the first.
    stretched : ndarray, shape (n_steps + 1,)
        Largest relative deviation of an edge from its length.
    iterations : ndarray of int, shape (n_steps + 1,)
        Of Newton's method; 0 before the first step.
    saved : ndarray, shape (n_saved,)
        Times at which positions were kept.
    r, v : ndarray, shape (n_saved, n_edges + 1, 3)
        Positions in m and velocities in m/s.
    position_error : float
        Bound of the error of the last positions in m from the length of the steps: the
        distance to those of half as many, three times the error at order 2; with θ > ½,
        of order 1, twice the distance; twice that with a tolerance. Infinite for an odd
        number of steps, or if not asked for. In turbulence both are driven by the same
        noise, of which the motion is one answer, and it is twice the distance: white
        noise leaves order 1 once the swings that it excites are resolved, and less
        before.
    end_tension : ndarray, shape (n_steps + 1, 2)
        T(0) and T(L) in N in the step that ends there, θ of it after its beginning;
        with a tolerance in the last of its parts. NaN before the first. Of order 2 in
        the edges.
    end_tension_error : ndarray, shape (2,)
        Bounds of the errors of the last ones from the length of the steps, found as
        `position_error` is; in white noise, whose pull has no value at a time, of their
        mean over the last two steps.
    call : Call or None
        How the result was made.
    provenance : dict
        By which versions, where and when.
    """

    kind: ClassVar[str] = "fibre-motion"
    layout = MOTION

    string: String
    t: Array
    kinetic: Array
    potential: Array
    largest_tension: Array
    stretched: Array
    iterations: NDArray[np.int64]
    saved: Array
    r: Array
    v: Array
    end_tension: Array
    position_error: float = np.inf
    end_tension_error: Array = field(default_factory=lambda: np.full(2, np.inf))
    call: Call | None = field(default=None, kw_only=True)
    provenance: dict[str, Any] = field(default_factory=dict, kw_only=True)

    @property
    def energy(self) -> Array:
        """Kinetic and potential energy in J."""
        return np.asarray(self.kinetic + self.potential)

    def __repr__(self) -> str:
        return (
            f"Motion({self.string.n_edges} edges, {self.t.size - 1} steps to t = "
            f"{self.t[-1]:g} s)"
        )
