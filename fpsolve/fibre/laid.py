"""What has been laid down, and what still hangs in the air."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_non_negative
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.fibre.ends import Belt, Nozzle
from fpsolve.fibre.fed_chain import FedChain
from fpsolve.fibre.layouts import LAY_DOWN
from fpsolve.fibre.string import String
from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.nozzles import EllipticNozzle
from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = ["LayDown"]


@dataclass(frozen=True, eq=False, repr=False)
class LayDown(Saved):
    """A fibre on the belt and in the air: series at every step, and where it lies.

    Attributes
    ----------
    string : String
    belt : Belt or None
    t : ndarray, shape (n_steps + 1,)
        Times of the steps in s.
    kinetic : ndarray, shape (n_steps + 1,)
        Energy of motion in the air, in J.
    largest_tension : ndarray, shape (n_steps + 1,)
        Largest |T| in N of the step that ends there; 0 before the first.
    nozzle_tension : ndarray, shape (n_steps + 1,)
        T in N where the fibre leaves the nozzle, θ of the step before its end, or of
        the last of its parts; 0 before the first. Nodes that come and land one by one
        make it scatter, nearly at order 1 in the edges: take means over many nodes.
    stretched : ndarray, shape (n_steps + 1,)
        Largest relative deviation of an edge from its length.
    free_length : ndarray, shape (n_steps + 1,)
        Of the fibre that does not lie, from the nozzle on, in m.
    iterations, rejected : ndarray of int, shape (n_steps + 1,)
        Of Newton's method; steps that were taken in halves.
    landed : ndarray, shape (n_landed, 2)
        Where nodes lie in the frame of the belt, in m, from the end of the fibre on;
        of loops that stand, what is under them.
    landing_times : ndarray, shape (n_landed,)
        Since when, in s.
    saved : ndarray, shape (n_saved,)
        Times at which the fibre in the air was kept.
    r : tuple of ndarray, shape (n, 3) each
        Its positions in m, from the nozzle on.
    last : FedChain
        The end of the run: r, v, tension, from the nozzle to the nodes on the belt that
        the part in the air still bends against.
    position_error : float
        Bound of the error of the last positions, in the air and on the belt, from the
        length of the steps: twice the distance to those of half as many, for order 1;
        four times that distance where a tolerance takes steps in halves.
        Infinite for an odd number of steps, or if not asked for. Where loops form by
        buckling, small changes grow, and it is as large as they are.
    status : str
        "finished"; "interrupted" or "failed" of a run that is not at its end.
    call : Call or None
        How the result was made.
    provenance : dict
        By which versions, where and when.
    """

    kind: ClassVar[str] = "fibre-lay-down"
    layout = LAY_DOWN

    string: String
    belt: Belt | None
    t: Array
    kinetic: Array
    largest_tension: Array
    nozzle_tension: Array
    stretched: Array
    free_length: Array
    iterations: NDArray[np.int64]
    rejected: NDArray[np.int64]
    landed: Array
    landing_times: Array
    saved: Array
    r: tuple[Array, ...]
    last: FedChain
    position_error: float = np.inf
    status: str = "finished"
    call: Call | None = field(default=None, kw_only=True)
    provenance: dict[str, Any] = field(default_factory=dict, kw_only=True)

    @property
    def fed(self) -> float:
        """v_in t, the length of fibre that has come out since the beginning, in m."""
        return float(self.nozzle.speed * self.t[-1])

    @property
    def nozzle(self) -> Nozzle:
        """That of the string."""
        assert isinstance(self.string.start, Nozzle)
        return self.string.start

    @property
    def reference_curve(self) -> Curve:
        """γ(s), where the nozzle is in the frame of the belt when s has come out.

        Raises
        ------
        ValueError
            If the belt is as fast as the fibre is spun, or faster.
        """
        nozzle = self.nozzle
        speed = 0.0 if self.belt is None else self.belt.speed / nozzle.speed
        if any(nozzle.radii) and nozzle.angular_speed:
            return EllipticNozzle(
                speed, *nozzle.radii, nozzle.angular_speed / nozzle.speed, nozzle.phase
            )
        return MovingBelt(speed) if speed else FixedBelt()

    def laid_curve(self, *, skip: float = 0.0) -> FibreCurve:
        """η(s) on the belt, with the reference curve γ about which it lies.

        A point lies where the nozzle was when it landed, more or less: s of a point is
        the length that had come out at that time, on average over the curve. The origin
        is the mean of η − γ, as identification takes it for centred.

        Parameters
        ----------
        skip : float
            Length of fibre to leave out at its beginning, in m.

        Returns
        -------
        FibreCurve
            In m, with Δs the length of an edge.

        Raises
        ------
        ValueError
            If fewer than five nodes lie there, the belt is as fast as
            the fibre is spun, or the fibre turns too much from edge to edge.
        """
        skip, ds = check_non_negative("skip", skip), self.string.edge
        first = int(np.ceil(skip / ds - 1e-9))
        if len(self.landed) < first + 5:
            raise ValueError(
                f"`skip` must leave five nodes on the belt, got {skip:g} m of "
                f"{len(self.landed)} nodes; lengthen the run."
            )
        eta, times = self.landed[first:], self.landing_times[first:]
        numbers = np.arange(first, len(self.landed))
        start = float(np.mean(self.nozzle.speed * times - ds * numbers)) + ds * first
        curve = self.reference_curve
        gamma = np.stack(curve.position(start + ds * np.arange(len(eta))), axis=-1)
        centred = eta - (eta - gamma).mean(axis=0)
        return FibreCurve(centred, ds, curve, s_start=start)

    def distance(self, other: LayDown) -> float:
        """Largest distance of nodes of the same number at the end, in m."""
        mine, its = self._places(), other._places()
        n = min(len(mine), len(its))
        return float(np.linalg.norm(mine[:n] - its[:n], axis=1).max())

    def _places(self) -> Array:
        """Of all nodes at the end, from the end of the fibre on, shape (n, 3)."""
        last = self.last
        behind = last.newest + 1 - len(last.r)
        lying = np.zeros((behind, 3))
        lying[:, :2] = self.landed[:behind]
        if self.belt is not None:
            lying += [self.belt.speed * self.t[-1], 0.0, self.belt.height]
        return np.concatenate([lying, last.r[::-1]])

    def __repr__(self) -> str:
        lying = self.string.edge * max(len(self.landed) - 1, 0)
        return (
            f"LayDown({lying:g} m on the belt, {self.free_length[-1]:g} m in the air, "
            f"{self.t.size - 1} steps to t = {self.t[-1]:g} s)"
        )
