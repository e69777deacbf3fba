"""How far the noise of one step turns the edges of a fibre."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels.drag import shaking
from fpsolve._support.arrays import Array
from fpsolve.errors import NoiseStrengthError
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.random_force import StochasticForce, node_tangents
from fpsolve.fibre.string import String

__all__ = ["EdgeTurns", "edge_turn"]

# In rad, on average over directions: from there on a warning, and an error.
LARGE, TOO_LARGE = 0.5, 2.0
# 2 − 2 cos q of waves on the chain; the mean over them of smooth functions is exact to
# rounding where neighbours a few edges apart no longer feel each other.
WAVES = 2 - 2 * np.cos((np.arange(64) + 0.5) * np.pi / 64)
# Between numbers of steps that are tried, and how many of these.
RATIO, MOST_TRIALS = 1.05, 5000


def edge_turn(
    string: String,
    dt: float,
    theta: float,
    amplitudes: Array,
    drag: Array,
    correlation_time: float = 0.0,
) -> float:
    """S = √2 A (Δ/h)^{3/2} / ρA in rad, less what stiffness and air hold back.

    The noise of a step gives every node the velocity A √(Δ/h)/ρA, so that the edge
    between two turns at √2/h times it, by S in the time Δ. A wave e^{iqn} of the nodes
    n moves less, by 1 + (θΔ L + θ²Δ² EI λ²/h⁴)/ρA with λ = 2 − 2 cos q, L the
    slope of the air's force in the velocity: S² is the mean over q of 2A²(Δ/h)³/(ρA)²
    times λ/2 over the square of that. Exact for a long straight fibre without tension
    and S ≪ 1; tension holds back, too.

    Parameters
    ----------
    string : String
    dt, theta : float
    amplitudes, drag : ndarray, shape (n,)
        A in N s^½/m^½ and L in N s/m² at nodes; S is the root of the mean square.
    correlation_time : float
        τ: the mean of the noise over a step has the part
        1 − (τ/Δ)(1 − e^{−Δ/τ}) of the variance of white noise.

    Returns
    -------
    float

    References
    ----------
    [KMW09]_, equation (5).
    """
    h, mass = string.edge, string.line_density
    stiffness = string.bending_stiffness * (theta * dt) ** 2 / h**4
    held = 1 + (theta * dt * drag[:, None] + stiffness * WAVES**2) / mass
    moved = (0.5 * WAVES / held**2).mean(axis=1)
    kept = 1.0
    if correlation_time:
        kept += correlation_time / dt * math.expm1(-dt / correlation_time)
    square = np.mean((amplitudes / mass) ** 2 * moved)
    return math.sqrt(2 * max(kept, 0.0) * float(square) * (dt / h) ** 3)


@dataclass(eq=False)
class EdgeTurns:
    """Warns of noise that is strong for the steps of a run, and refuses more.

    Attributes
    ----------
    law : StochasticForce
    string : String
    air : AirFlow or None
    theta : float
    t_end : float
    n_steps : int
    """

    law: StochasticForce
    string: String
    air: AirFlow | None
    theta: float
    t_end: float
    n_steps: int
    _warned: bool = field(default=False, init=False)

    def check(
        self, amplitudes: Array, r: Array, v: Array, t: float, free: NDArray[np.bool_]
    ) -> None:
        """Of the step from t on, with A of shape (n, 3, 3); `free` is in the air.

        Raises
        ------
        NoiseStrengthError
            If edges turn by more than 2 rad.
        """
        # Means over three directions.
        strengths = np.sqrt((amplitudes[free] ** 2).sum(axis=(1, 2)) / 3)
        drag, dt = np.zeros(strengths.size), self.t_end / self.n_steps
        turn = self._turn(dt, strengths, drag)
        if turn <= LARGE:
            return
        if self.air is not None:
            drag = self._drag(r, v, t)[free]
            turn = self._turn(dt, strengths, drag)
        if turn <= LARGE or (self._warned and turn <= TOO_LARGE):
            return
        amplitude = float(np.sqrt(np.mean(strengths**2)))
        enough = self._enough(strengths, drag)
        if not turn <= TOO_LARGE:
            raise NoiseStrengthError(t, dt, amplitude, turn, enough)
        self._warned = True
        warnings.warn(
            f"`turbulence` of {amplitude:.3g} N s^½/m^½ turns edges by {turn:.2g} rad "
            f"in a step of {dt:.3g} s from t = {t:.3g} s on (steps resolve noise up to "
            f"{LARGE:g}); take at least {enough} `n_steps`",
            UserWarning,
            stacklevel=10,
        )

    def _turn(self, dt: float, strengths: Array, drag: Array) -> float:
        time = self.law.correlation_time
        return edge_turn(self.string, dt, self.theta, strengths, drag, time)

    def _drag(self, r: Array, v: Array, t: float) -> Array:
        """Slope of the air's force in the velocity, the mean over directions."""
        assert self.air is not None
        slope, even = np.empty((*r.shape, 3)), np.ones((3, len(r)))
        drag = self.air.drag(self.string.diameter)
        shaking(drag, self.air.at(r, t) - v, node_tangents(r), even, slope)
        return np.asarray(np.trace(slope, axis1=1, axis2=2) / 3)

    def _enough(self, strengths: Array, drag: Array) -> int:
        """Tried from few steps on: in which edges turn by no more than ½."""
        number = float(self.n_steps)
        for _ in range(MOST_TRIALS):
            number *= RATIO
            if self._turn(self.t_end / number, strengths, drag) <= LARGE:
                break
        return math.ceil(number)
