"""Margins with which a window sees a web that has no edge and no beginning.

Along the belt fibres start so long before the window that they have forgotten how; the
lay-down begins before any of it can reach the window and ends when none can any more.
Across the belt spinning positions go on beyond the window as far as fibres are thrown.
How far that is, a pilot ensemble tells that is laid as the web is, with its step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.schedule import Schedule
from fpsolve.paths.ensemble import Ensemble
from fpsolve.web.motion import Motion

__all__ = ["LEG", "Margins", "margins_of"]

# Steps that are taken at once; a fibre begins to count on a multiple of it.
LEG = 64
# Numbers of the pilots' paths, where no web has any.
_FIRST_PILOT, _N_PILOTS = 1 << 62, 256
# Of the start e^{-9.2} = 1e-4 is left.
_RELAXATIONS = math.log(1e4)
# The pilots' extremes are about 3.5 deviations of a Gaussian.
_WIDER = 1.3
_FEWEST_LOOKS = 16


@dataclass(frozen=True)
class Margins:
    """How far before and beside the window a web begins.

    Attributes
    ----------
    n_burn : int
        Steps before any fibre counts; a multiple of `LEG`.
    remainder : float
        What is left of the start after them, relative to it.
    relaxation : float
        Length over which a fibre forgets.
    reach : tuple
        Lowest and highest deviation of the fibre from the middle of its nozzle, along
        and across the belt.
    """

    n_burn: int
    remainder: float
    relaxation: float
    reach: tuple[tuple[float, float], tuple[float, float]]


def margins_of(
    ensemble: Ensemble, phases: Array, relaxation: float, period: float
) -> Margins:
    """The margins of a web.

    Parameters
    ----------
    ensemble : Ensemble
        Any number of paths, whose model, step and seed are those of the web.
    phases : ndarray
        Phases of some nozzles, from which those of the pilots are taken.
    relaxation : float
    period : float
        Of the motion of the nozzles, over which the pilots are followed; 0 for none.
    """
    ds = ensemble.schedule.ds
    n_burn = LEG * math.ceil(_RELAXATIONS * relaxation / (LEG * ds))
    n_more = max(n_burn // 2, LEG * _FEWEST_LOOKS, math.ceil(period / ds))
    reach = _reach(ensemble, phases, n_burn, LEG * math.ceil(n_more / LEG))
    remainder = math.exp(-n_burn * ds / relaxation)
    return Margins(n_burn, remainder, relaxation, reach)


def _reach(
    ensemble: Ensemble, phases: Array, n_burn: int, n_more: int
) -> tuple[tuple[float, float], tuple[float, float]]:
    """How far pilots are found from the middle of their nozzles, and a third more."""
    schedule = Schedule(0.0, ensemble.schedule.ds, n_burn + n_more, (), ())
    pilots = replace(ensemble, n_paths=_N_PILOTS, schedule=schedule)
    state = pilots.initial_state(_FIRST_PILOT, _N_PILOTS)
    motion = Motion(pilots, np.resize(phases, _N_PILOTS), _FIRST_PILOT)
    found = []
    for step in range(0, n_burn + n_more, LEG):
        motion.advance(state, 0, step, LEG, None)
        if step >= n_burn:
            deviation = motion.places(state, 0, step + LEG)
            deviation[0] += ensemble.model.curve.speed * schedule.s(step + LEG)
            found.append(deviation)
    places = np.concatenate(found, axis=1)
    mean = places.mean(axis=1)
    low = mean - _WIDER * (mean - places.min(axis=1))
    high = mean + _WIDER * (places.max(axis=1) - mean)
    return (float(low[0]), float(high[0])), (float(low[1]), float(high[1]))
