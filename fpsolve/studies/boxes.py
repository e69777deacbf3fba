"""Boxes that hold the law of (ξ, α), checked on the law itself.

At rest the law is e^{-B}/Z, whose mass outside a box is summed. Where the belt or the
nozzle moves, a run starts elsewhere or the fibre has a curvature, the law is not known
and paths are sampled: one ensemble tells how far they get, a second one checks the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive
from fpsolve.model.curves.table import TabulatedCurve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.nodes import GibbsNodes
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import EquilibriumLaw
from fpsolve.paths.sampling import sample_paths

__all__ = ["Travel", "box_for_travel", "rounded_up"]

_N_PATHS = 8192
_SEEDS = (20090901, 20091002)
# Positions are looked at this often in the beginning and as often up to the end, in so
# many groups each.
_N_LOOKS, _N_GROUPS = 12, 2
# Lengths in throwing ranges: a step, the beginning, the shortest and the longest run.
_STEP, _BEGINNING, _SHORTEST, _LONGEST = 0.2, 10.0, 20.0, 600.0
_MOST_STEPS = 10_000
# Relaxation lengths after which a law that settles has settled.
_RELAXATIONS = 4.0
# Radians that the nozzle turns in a step.
_TURN = 0.2
# The tail beyond this share is taken to fall at least exponentially; exceedances of an
# exponential law have a deviation of one mean.
_TAIL, _HEAVY = 0.01, 1.25
# A law that still spreads by this factor at the end has no box.
_SPREADS = 1.15
_N_TRIES, _WIDER = 4, 1.2
# Of 8192 paths 0.4 are outside where 5e-5 of the law are, and five or more at one of
# two dozen looks once in a thousand checks.
_MOST_AT_ONCE = 4


@dataclass(frozen=True)
class Travel:
    """How far paths get: the box they need and what a second ensemble found.

    Attributes
    ----------
    half_widths : (float, float)
    s_end : float
        How far they were followed.
    outside, positions : int
        Positions of the second ensemble outside the box, and in all.
    curvature : float
        Largest √E κ² of the first; 0 for the basic model, which has none.
    """

    half_widths: tuple[float, float]
    s_end: float
    outside: int
    positions: int
    curvature: float

    @property
    def text(self) -> str:
        """What was checked, in words."""
        return (
            f"of {self.positions} positions on {_N_PATHS} paths up to s = "
            f"{self.s_end:.3g}, {self.outside} lie outside"
        )


def box_for_travel(
    model: FibreModel,
    nodes: GibbsNodes,
    least: tuple[float, float],
    lost: float,
    initial: Any,
    s_end: float | None,
) -> Travel:
    """A box of at least some half widths that all but a share of the paths stay in.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
    nodes : GibbsNodes
        Of its potential.
    least : (float, float)
        Half widths that the box has at least.
    lost : float
        Share of the law, at every s, that may be outside.
    initial : law, or None
        Of the start, from `fpsolve.paths`; e^{-B}/Z by default.
    s_end : float or None
        Length of the run; by default long enough for the law to settle.

    Raises
    ------
    ValueError
        If the law does not settle, or its tail is too heavy for any box.
    """
    plan = _Plan.of(model, nodes, s_end)
    law = EquilibriumLaw(model.potential) if initial is None else initial
    paths = plan.sampled(model, law, _SEEDS[0])
    first = np.asarray(paths.xi)
    wanted = [
        max(half, _reach(np.abs(first[:, :, axis]), lost, model, plan.settles))
        for axis, half in enumerate(least)
    ]
    curvature = 0.0
    if isinstance(model, SmoothLayDownModel):
        curvature = math.sqrt((paths.kappa**2).mean(axis=1).max())
    second = np.asarray(plan.sampled(model, law, _SEEDS[1]).xi)
    for _ in range(_N_TRIES):
        half_widths = rounded_up(wanted[0]), rounded_up(wanted[1])
        beyond = (np.abs(second) > half_widths).any(axis=2)
        n_outside, n = int(beyond.sum()), beyond.size
        at_once = int(beyond.sum(axis=1).max())
        if n_outside <= lost * n and at_once <= _MOST_AT_ONCE:
            length = plan.s_end - plan.s_start
            return Travel(half_widths, length, n_outside, n, curvature)
        wanted = [_WIDER * half for half in wanted]
    raise ValueError(
        f"`model` must keep its paths together to suggest a box, got {n_outside} of "
        f"{n} positions outside half widths of {half_widths[0]:g} and "
        f"{half_widths[1]:g}; choose a box by hand."
    )


@dataclass(frozen=True)
class _Plan:
    """Where paths begin and end, their step, and when they are looked at.

    `settles` says that the run goes on for longer, so that the law has to settle.
    """

    s_start: float
    s_end: float
    ds: float
    looks: tuple[float, ...]
    settles: bool

    @classmethod
    def of(cls, model: FibreModel, nodes: GibbsNodes, s_end: float | None) -> _Plan:
        deviations = nodes.deviations()
        length = max(deviations)
        forces = nodes.mean_square_forces()
        finest = min(1.0 / math.sqrt(max(*forces)), *deviations)
        start, end = _span(model)
        step = _STEP * finest
        if model.noise > 0:
            step = min(step, 1.0 / model.noise**2)
        swing = abs(getattr(model.curve, "angular_speed", 0.0))
        if swing > 0:
            step = min(step, _TURN / swing)
        if s_end is not None:
            end = min(end, start + check_positive("s_end", s_end))
        span = max(_settling_length(model.noise, length), _SHORTEST * length)
        span = min(span, _LONGEST * length, _MOST_STEPS * step)
        settles = end > start + span
        end = min(end, start + span)
        n_steps = math.ceil((end - start) / step)
        beginning = min(n_steps, math.ceil(_BEGINNING * length / step))
        early = np.linspace(0, beginning, _N_LOOKS)
        late = np.linspace(beginning, n_steps, _N_LOOKS)
        places = np.unique(np.rint(np.concatenate([early, late])).astype(np.int64))
        ds = (end - start) / n_steps
        return cls(start, end, ds, tuple((start + places * ds).tolist()), settles)

    def sampled(self, model: FibreModel, law: Any, seed: int) -> Any:
        """The paths, which have ξ at every look; shape (n_looks, n_paths, 2)."""
        looks = (*self.looks[:-1], self.s_end)
        return sample_paths(
            model, _N_PATHS, self.s_end, self.ds,
            seed=seed, initial=law, save_at=looks, s_start=self.s_start,
        )  # fmt: skip


def _span(model: FibreModel) -> tuple[float, float]:
    """Where the curve begins and ends."""
    curve = model.curve
    if isinstance(curve, TabulatedCurve):
        return curve.s[0], curve.s[-1]
    return 0.0, math.inf


def _settling_length(noise: float, length: float) -> float:
    """A few times 2/A² + A² R², which interpolates the relaxation of both limits."""
    square = max(noise * noise, 1e-12 / length)
    return _RELAXATIONS * (2.0 / square + square * length * length)


def _reach(distance: Array, lost: float, model: FibreModel, settles: bool) -> float:
    """Distance that all but a share of the paths keep, in every group of looks."""
    groups = np.array_split(distance, min(2 * _N_GROUPS, len(distance)))
    share = lost if model.curve.autonomous else lost / (len(distance) / len(groups))
    reaches = [_exponential_quantile(group.ravel(), share, model) for group in groups]
    middle = len(reaches) - 2
    if settles and reaches[-1] > _SPREADS * max(reaches[: middle + 1]):
        raise ValueError(
            f"`model` must settle for a box to be suggested, got paths that reach "
            f"{reaches[middle]:.3g} and then {reaches[-1]:.3g} with {model.curve!r}; "
            "slow the belt, or choose a box by hand for the length of the run."
        )
    return max(reaches)


def _exponential_quantile(distance: Array, share: float, model: FibreModel) -> float:
    """Where the share is beyond, if the tail beyond a hundredth falls exponentially."""
    threshold = float(np.quantile(distance, 1 - _TAIL))
    excess = distance[distance > threshold] - threshold
    if excess.size == 0:
        return threshold
    mean = float(excess.mean())
    # A deterministic start has no tail, only rounding.
    if excess.std() > _HEAVY * mean and mean > 1e-6 * threshold:
        raise ValueError(
            "`model` must keep its paths together to suggest a box, got a tail that "
            f"falls more slowly than an exponential with {model.potential!r}; choose "
            "a box by hand."
        )
    return threshold + mean * math.log(_TAIL / share)


def rounded_up(half_width: float) -> float:
    """To the next eighth of the power of two below: 4.1 becomes 4.5, 0.041 0.0469."""
    step = 2.0 ** (math.floor(math.log2(half_width)) - 3)
    return math.ceil(half_width / step) * step
