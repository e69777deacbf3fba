"""Everything that determines a web before its first fibre is laid."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._kernels import raster as kernels
from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag, check_positive
from fpsolve.evolution.schedule import Schedule
from fpsolve.model.fibre import FibreModel
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.laws import EquilibriumLaw
from fpsolve.web.lengths import Lengths, lengths_of
from fpsolve.web.margins import LEG, Margins, margins_of
from fpsolve.web.motion import Motion
from fpsolve.web.nozzles import checked_phases, drawn_phases, places_of
from fpsolve.web.window import Window

__all__ = ["Plan", "plan_of"]

# Pieces of fibre that a pixel has room for are 2²⁷; it may be filled so many times
# above the mean.
_MOST_PIECES = 2.0 ** (63 - kernels.UNIT_BITS) / 32
_MOST_STEPS = 2**40
_N_DRAWN = 256


@dataclass(frozen=True, eq=False)
class Plan:
    """Fibres, window and margins, all in units of the throwing range.

    Attributes
    ----------
    ensemble : Ensemble
        The fibres as paths.
    window : Window
    places, phases : ndarray, shape (n_fibres,)
    spacing : float
    margins : Margins
    periodic : bool
    origin : float
        Where along the belt the middle of a nozzle is at s = 0.
    speed : float
        Of the belt.
    """

    ensemble: Ensemble
    window: Window
    places: Array
    phases: Array
    spacing: float
    margins: Margins
    periodic: bool
    origin: float
    speed: float

    @property
    def n_fibres(self) -> int:
        """Fibres that can reach the window."""
        return self.places.size

    @property
    def n_counted(self) -> int:
        """Steps of a fibre that are laid."""
        return self.ensemble.schedule.n_steps - self.margins.n_burn

    @property
    def motion(self) -> Motion:
        """The steps of the fibres."""
        return Motion(self.ensemble, self.phases)

    def raster(self) -> kernels.Raster:
        """The pixels as kernels see them."""
        ahead = self.motion.ahead
        return kernels.Raster(1.0 / self.window.pixel, ahead, 0, self.periodic)

    def nozzles(self, motion: Motion, first: int, n: int, step: int) -> kernels.Nozzles:
        """The nozzles of some fibres over the steps of a leg."""
        schedule = self.ensemble.schedule
        s = schedule.start + schedule.ds * np.arange(step + 1, step + LEG + 1)
        curve = motion.curve(step, LEG)
        curve[:, 0] += self.origin
        steady = self.origin - self.speed * s
        places = np.vstack([self.places, motion.weights])[:, first : first + n]
        return kernels.Nozzles(
            curve, np.ascontiguousarray(places), np.array(self.margins.reach), steady
        )

    def corners(self, motion: Motion, state: Array, first: int, step: int) -> Array:
        """The corners from which fibres are laid on, in pixels; shape (2, n)."""
        eta = motion.places(state, first, step) + motion.ahead * state[2:4]
        eta[0] += self.origin
        eta[1] += self.places[first : first + state.shape[1]]
        return np.asarray(eta / self.window.pixel)


def plan_of(
    model: FibreModel,
    window: Window,
    spacing: float | None,
    ds: float | None,
    seed: int,
    positions: Any,
    phases: Any,
    periodic: Any,
) -> Plan:
    """Check what was asked for, and complete it."""
    speed, lengths = checked_speed(model), lengths_of(model)
    phases = checked_phases(phases, model.curve)
    periodic = check_flag("periodic", periodic)
    step = lengths.step if ds is None else check_positive("ds", ds)
    pilots = ensemble_of(model, 1, step, LEG, seed)
    margins = margins_for(pilots, phases, lengths, seed)
    (low1, high1), (low2, high2) = margins.reach
    # Fibres reach as far before their nozzle as others behind it.
    span = (0.0, window.width) if periodic else (-high2, window.width - low2)
    places, d = places_of(positions, spacing, span, seed)
    if periodic:
        check_inside(places, window)
    check_counts(window, d, abs(speed), step)
    burnt = abs(speed) * margins.n_burn * step
    ends = -high1, window.length - low1
    origin = ends[1] + burnt if speed > 0 else ends[0] - burnt
    travelled = ends[1] - ends[0] + burnt
    n_steps = LEG * math.ceil(travelled / (abs(speed) * step * LEG))
    check_steps(n_steps, step)
    model.curve.check_span(0.0, n_steps * step)
    ensemble = ensemble_of(model, places.size, step, n_steps, seed)
    drawn = drawn_phases(phases, model.curve, places.size, seed)
    return Plan(
        ensemble, window, places, drawn, d, margins, periodic, origin, speed
    )  # fmt: skip


def ensemble_of(
    model: FibreModel | None, n: int, ds: float, n_steps: int, seed: int
) -> Ensemble:
    """The fibres as paths, which start by e^{-B} with a uniform angle.

    Those of a file may have no model.
    """
    schedule = Schedule(0.0, ds, n_steps, (), ())
    law = None if model is None else EquilibriumLaw(model.potential)
    return Ensemble(model, n, schedule, seed, "splitting", law, keep=False)


def margins_for(pilots: Ensemble, phases: Any, lengths: Lengths, seed: int) -> Margins:
    """The margins of a web whose phases may be known already, or not."""
    drawn = phases
    if isinstance(phases, str):
        drawn = drawn_phases(phases, pilots.model.curve, _N_DRAWN, seed)
    elif not phases.size:
        drawn = np.zeros(1)
    return margins_of(pilots, drawn, lengths.relaxation, lengths.period)


def checked_speed(model: FibreModel) -> float:
    """The belt speed; ValueError unless the belt moves."""
    speed = float(model.curve.speed)
    if not abs(speed) > 0:
        raise ValueError(
            f"`model` must have a moving belt to make a web, got {model.curve!r}; "
            "choose MovingBelt(v) or a nozzle with a speed."
        )
    return speed


def check_inside(places: Array, window: Window) -> None:
    """Raise ValueError unless the places of a periodic web lie in it."""
    inside = (places >= 0) & (places < window.width)
    if not inside.all():
        raise ValueError(
            f"`positions` must lie in [0, {window.width:g}) across a periodic web, got "
            f"{places[~inside][0]:g}."
        )


def check_counts(window: Window, d: float, speed: float, ds: float) -> None:
    """Raise ValueError if a pixel would hold more pieces than its integer."""
    pieces = window.pixel**2 / (speed * d * ds)
    if not pieces <= _MOST_PIECES:
        raise ValueError(
            f"`pixel` must hold at most {_MOST_PIECES:.3g} pieces of fibre in the "
            f"mean, got {pieces:.3g} with pixel {window.pixel:g} and steps of {ds:g}; "
            "use smaller pixels."
        )


def check_steps(n_steps: int, ds: float) -> None:
    """Raise ValueError unless the number of steps is one that can be taken."""
    if not n_steps <= _MOST_STEPS:
        raise ValueError(
            f"`ds` must leave at most {_MOST_STEPS:.2g} steps, got {ds:g} for "
            f"{n_steps:.3g} steps of every fibre; use longer steps or a shorter web."
        )
