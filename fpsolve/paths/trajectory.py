"""One path at every step."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.curve import Curve
from fpsolve.paths.ensemble import KAPPA, Ensemble, angle_of

__all__ = ["Trajectory", "traced", "trajectory"]


# Steps whose states are held at a time.
LEG = 512


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One path, point by point.

    Attributes
    ----------
    s : ndarray, shape (n,)
    xi : ndarray, shape (n, 2)
    alpha : ndarray, shape (n,)
        Continuous along the path.
    curve : Curve
    kappa : ndarray, shape (n,), or None
        Curvature of a smooth fibre.
    """

    s: Array
    xi: Array = field(repr=False)
    alpha: Array = field(repr=False)
    curve: Curve
    kappa: Array | None = field(default=None, repr=False)

    @property
    def eta(self) -> Array:
        """The fibre on the belt, η = ξ + γ(s); shape (n, 2)."""
        return self.xi + np.stack(self.curve.position(self.s), axis=-1)


def traced(
    ensemble: Ensemble, first: int, state: Array, sampled: Array | None
) -> Iterator[tuple[int, Array]]:
    """Number of the first step and states (n_steps, n_state, n) of paths, leg by leg.

    The first leg is the start alone. Warns if the end is not the one that was sampled.

    Parameters
    ----------
    ensemble : Ensemble
    first : int
        Number of the first of the paths.
    state : ndarray, shape (n_state, n)
        Where they start; afterwards where they end.
    sampled : ndarray, shape (n_state, n), or None
        Where they ended when they were sampled.
    """
    step, end, n = 0, ensemble.schedule.n_steps, state.shape[1]
    yield step, state[None].copy()
    while step < end:
        n_steps = min(LEG, end - step)
        trace = np.empty((n_steps, len(state), n))
        ensemble.integrator.advance(state, first, step, n_steps, trace)
        yield step + 1, trace
        step += n_steps
    if sampled is not None:
        _warn_unless_equal(state, sampled)


def _warn_unless_equal(state: Array, sampled: Array) -> None:
    if not np.array_equal(state, sampled):
        away = float(np.max(np.abs(state - sampled)[:2]))
        warnings.warn(
            f"the paths end {away:.2g} away in xi from where they ended when they were "
            "sampled: the potential or the curve computes something else now, or this "
            "machine rounds in another way",
            UserWarning,
            stacklevel=3,
        )


def trajectory(
    ensemble: Ensemble, legs: Iterable[tuple[int, Array]], every: int
) -> Trajectory:
    """One traced path at its start and after every few steps, its last one included."""
    schedule = ensemble.schedule
    states = np.concatenate([states for _, states in legs])
    steps = np.arange(schedule.n_steps + 1)
    chosen = steps % every == 0
    chosen[-1] = True
    states = states[chosen]
    return Trajectory(
        s=schedule.start + steps[chosen] * schedule.ds,
        xi=states[:, :2, 0].copy(),
        alpha=angle_of(states)[:, 0],
        curve=ensemble.model.curve,
        kappa=states[:, KAPPA, 0].copy() if states.shape[1] > KAPPA else None,
    )
