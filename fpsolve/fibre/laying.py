"""A fibre that is spun from a nozzle and laid on a belt."""

from __future__ import annotations

import math
import os
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_flag,
    check_integer,
    check_kind,
    check_path,
    check_positive,
    check_real,
    shown,
)
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.evolution.call import Call, recorded
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.edge_turns import EdgeTurns
from fpsolve.fibre.ends import Belt, Free, Nozzle
from fpsolve.fibre.fed_chain import FedChain, FedStep
from fpsolve.fibre.fed_noise import FedDraws
from fpsolve.fibre.laid import LayDown
from fpsolve.fibre.lay_keeper import Keeper
from fpsolve.fibre.lay_run import LayRun, Record
from fpsolve.fibre.random_force import StochasticForce, checked_law
from fpsolve.fibre.rest import equilibrium
from fpsolve.fibre.rubbing import RubbingStep
from fpsolve.fibre.shapes import checked_shape, checked_vectors
from fpsolve.fibre.string import String

__all__ = ["lay_down"]

# Of an edge: a fibre that is nowhere further from a vertical line is straight.
STRAIGHT = 1e-9
# Errors in distances to twice as long a step: 1 at order 1, and what higher orders add;
# in 72 motions with tolerances from 1e-4 to 1e-7 m up to 2.8, as steps are halves.
SAFE, SAFE_OF_HALVES = 2.0, 4.0


@recorded()
def lay_down(
    string: String,
    t_end: float,
    n_steps: int,
    *,
    belt: Belt | None = None,
    shape: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    theta: float = 0.6,
    air: AirFlow | None = None,
    turbulence: StochasticForce | None = None,
    seed: int | None = None,
    tolerance: float | None = None,
    save_every: int | None = None,
    estimate_error: bool = True,
    progress: bool | ProgressCallback = False,
    checkpoint: str | os.PathLike[str] | None = None,
) -> LayDown:
    """ρA ∂_tt r = ∂_s(T ∂_s r − ∂_s(EI ∂_ss r)) + ρA g + a, fed at v_in, z ≥ height.

    The fibre is spun out of the nozzle that is the string's start: edges of the fixed
    length h follow each other with the velocity of the nozzle and v_in along its
    direction, and are let go as they leave it, so that neither their momentum nor their
    bending jumps, and v_in t of fibre have come out at time t. Nodes that reach the
    belt stick to it, or rub on it by Coulomb's law if it has a `friction`. Between both
    the motion is that of `simulate`: edges keep their length to 1e-12. Of order 1 in
    the step, in which a node lands sooner or later, and in the edges. Loops that meet
    do not notice each other.

    A step that Newton's method does not find, as where a fibre buckles, is taken in two
    halves, and these again, so that it depends on nothing but the arguments.

    Parameters
    ----------
    string : String
        The fibre that hangs from the nozzle at the beginning: its start is a `Nozzle`,
        its end free.
    t_end : float
        In s; the motion begins at 0.
    n_steps : int
    belt : Belt, optional
        On which it is laid; by default none, and the fibre becomes longer and longer.
    shape : array_like, shape (n_edges + 1, 3), optional
        Positions at the beginning; by default those at rest. Nodes at the height of the
        belt lie on it, and none is below.
    velocity : array_like, shape (n_edges + 1, 3) or (3,), optional
        At the beginning, in m/s; by default that of the nozzle and of what comes out of
        it. What would stretch an edge is taken from it as by a plastic impact.
    theta : float
        From ½ to 1; ½ adds no damping, and with a belt what an impact excites stays.
    air : AirFlow, optional
        What pulls at it with the force a per length.
    turbulence : RandomForce or TurbulentForce, optional
        A of A·dw_{s,t}, noise that is the same for the whole of each of the given
        steps, also where these are taken in halves. Noise that turns edges in one step
        by more than 0.5 rad is warned of.
    seed : int, optional
        Of `turbulence`: the same seed and steps repeat the fibre bit by bit.
    tolerance : float, optional
        Largest distance in m of the positions after a step and after two of half its
        length, which are kept; longer steps are taken in halves. Steps in which a node
        lands have no order and are not judged. By default steps are as they are given.
    save_every : int, optional
        Keep the fibre in the air at every so-many-th step, and at the last; by default
        at the first and the last.
    estimate_error : bool
        Repeat the motion with half of the steps, for `position_error`; in turbulence
        driven by the same noise.
    progress : bool or callable
        A bar, or a function of (steps done, steps in all, time).
    checkpoint : path, optional
        File in which the run is kept every minute and where Ctrl-C or an error ends it.
        The same call goes on from there, to the bits of a run that never stopped, and
        removes it at the end.

    Returns
    -------
    LayDown

    Raises
    ------
    ValueError
        If a number is out of its range, the start is no nozzle, the shape does not fit
        the fibre, lies below the belt, or hangs so straight that it could buckle to any
        side.
    TypeError
        If an argument is of another kind.
    FlowRangeError
        If the fibre leaves the table of the air.
    ToleranceError
        If the tolerance is not reached by steps of 1/4096 of the given ones.
    RunInterrupted
        By Ctrl-C; its `solution` is the fibre until then.
    EdgeLengthError
        If Newton's method does not converge, however short the step is, as for a belt
        that pulls at a straight fibre faster than it is spun. Its `solution` is the
        fibre until then.
    FrictionError
        Likewise if it is not settled what sticks and what slides, or if what was left
        behind on the belt would slide.
    NoiseStrengthError
        If the noise of a step turns edges by more than 2 rad; it says how many steps
        are enough. Its `solution` is the fibre until then.
    FileFormatError
        If the checkpoint is damaged, or no fibre.

    Warns
    -----
    UserWarning
        If the noise of a step turns edges by more than 0.5 rad.

    References
    ----------
    [KMW09]_, section 2.2.
    """
    given = dict(locals())
    t_end = check_positive("t_end", t_end)
    n_steps = check_integer("n_steps", n_steps, 1)
    every = n_steps
    if save_every is not None:
        every = check_integer("save_every", save_every, 1)
    step = _checked_step(string, belt, theta, air)
    draws = _checked_draws(turbulence, seed, step, t_end, n_steps)
    first = _first_chain(step, shape, velocity)
    if belt is not None:
        _check_height(step, first.r, draws is not None)
    estimate_error = check_flag("estimate_error", estimate_error)
    allowed = np.inf
    if tolerance is not None:
        allowed = check_positive("tolerance", tolerance)
    t = np.linspace(0.0, t_end, n_steps + 1)
    keeper = part = None
    if checkpoint is not None:
        path = check_path("checkpoint", checkpoint)
        keeper = Keeper(path, Call.of("lay_down", given))
        part = keeper.found()
    record = Record.first(t, first) if part is None else Record.of(part, t, every)
    with reporting(progress) as report:
        found = LayRun(step, every, allowed, draws).result(record, report, keeper)
    if estimate_error and n_steps % 2 == 0:
        # Of steps twice as long, whose errors are four times as large.
        if draws is not None:
            draws = replace(draws, dt=2 * draws.dt, pieces=2, turns=None)
        run, half = (
            LayRun(step, n_steps, 4 * allowed, draws),
            Record.first(t[::2], first),
        )
        other = run.result(half, lambda *_: None)
        safe = SAFE if tolerance is None else SAFE_OF_HALVES
        found = replace(found, position_error=safe * found.distance(other))
    if keeper is not None:
        keeper.remove()
    return found


def _checked_step(
    string: String, belt: Belt | None, theta: float, air: AirFlow | None
) -> FedStep:
    """ValueError or TypeError unless these may go together."""
    check_kind("string", string, String, "String(length, …, start=Nozzle(…)) is one")
    if not isinstance(string.start, Nozzle) or not isinstance(string.end, Free):
        raise ValueError(
            "`string` must have a `Nozzle` as its start and a free end, got "
            f"{shown(string.start)} and {shown(string.end)}."
        )
    theta = check_real("theta", theta)
    if not 0.5 <= theta <= 1:
        raise ValueError(f"`theta` must lie between 0.5 and 1, got {theta:g}.")
    if belt is not None:
        check_kind("belt", belt, Belt, "Belt(speed) is one")
    if air is not None:
        check_kind("air", air, AirFlow, "AirFlow(velocity) is one")
    if belt is not None and not math.isinf(belt.friction):
        return RubbingStep(string, belt, theta, air)
    return FedStep(string, belt, theta, air)


def _checked_draws(
    turbulence: StochasticForce | None,
    seed: int | None,
    step: FedStep,
    t_end: float,
    n_steps: int,
) -> FedDraws | None:
    """What is drawn at every step; TypeError unless there is a seed for it."""
    drawn = checked_law(turbulence, seed)
    if drawn is None:
        return None
    law, seed = drawn
    string = step.string
    n_nodes = string.n_edges + 2 + math.ceil(step.nozzle.speed * t_end / string.edge)
    turns = EdgeTurns(law, string, step.air, step.theta, t_end, n_steps)
    return FedDraws(law, string, step.air, t_end / n_steps, seed, n_nodes, turns=turns)


def _first_chain(
    step: FedStep, shape: ArrayLike | None, velocity: ArrayLike | None
) -> FedChain:
    """The fibre at the beginning; ValueError unless it may be laid from there."""
    string, n = step.string, step.string.n_edges
    r = equilibrium(string).r if shape is None else checked_shape(string, shape)
    laid, on_belt = np.zeros(n + 1, dtype=bool), np.full((n + 1, 3), np.nan)
    v = np.empty((n + 1, 3))
    v[:] = step.nozzle.at(0.0)[1]
    if velocity is not None:
        v[1:] = checked_vectors("velocity", velocity, v.shape)[1:]
    if step.belt is not None:
        laid[1:] = r[1:, 2] == step.belt.height
        on_belt[laid] = r[laid] * [1.0, 1.0, 0.0]
        v[laid] = [step.belt.speed, 0.0, 0.0]
    return FedChain(
        np.array(r), step.arrested(r, v, laid), np.zeros(n), laid, on_belt, n
    )


def _check_height(step: FedStep, r: Array, shaken: bool) -> None:
    """ValueError if the fibre is below the belt, or may buckle to any side."""
    assert step.belt is not None
    lowest, height = float(r[:, 2].min()), step.belt.height
    if not (lowest >= height and r[0, 2] > height):
        raise ValueError(
            f"`shape` must not be below the belt at {height:g} m, nor the nozzle on "
            f"it, got a height of {lowest:g}; shorten the fibre or raise the nozzle."
        )
    aside = np.ptp(r[:, :2], axis=0).max()
    still = not any(step.nozzle.radii) and step.air is None and not shaken
    if still and not aside > STRAIGHT * step.string.edge:
        raise ValueError(
            "`string` must not hang straight above the belt, where nothing says to "
            "which side it buckles; tilt the `direction` of its nozzle a little."
        )
