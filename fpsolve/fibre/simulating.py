"""A fibre that is moved by its weight, its stiffness and the air."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_flag,
    check_integer,
    check_non_negative,
    check_positive,
    check_real,
    shown,
)
from fpsolve.evolution.call import recorded
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.end_tensions import EndTensions
from fpsolve.fibre.ends import Nozzle
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.motion import Motion
from fpsolve.fibre.random_force import Draws, StochasticForce, checked_law
from fpsolve.fibre.shapes import checked_shape, checked_vectors, first_shape
from fpsolve.fibre.string import String
from fpsolve.fibre.theta_step import HalvedStep, ThetaStep

__all__ = ["simulate"]

# Of the largest velocity: parts of a given one that would stretch an edge.
RIGID = 1e-9


@recorded()
def simulate(
    string: String,
    t_end: float,
    n_steps: int,
    *,
    shape: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    theta: float = 0.5,
    damping: float = 0.0,
    air: AirFlow | None = None,
    turbulence: StochasticForce | None = None,
    seed: int | None = None,
    tolerance: float | None = None,
    save_every: int | None = None,
    estimate_error: bool = True,
) -> Motion:
    """ρA ∂_tt r = ∂_s(T ∂_s r − ∂_s(EI ∂_ss r)) + ρA g + a − c ∂_t r, |∂_s r| = 1.

    By the θ-scheme, whose tension is one more unknown of every step: edges have their
    length to 1e-12 after each, for any step. With θ = ½ it is of order 2 and keeps the
    energy of a fibre without damping to the residual of Newton's method; with θ = 1 it
    is of order 1 and damps what swings faster than 1/Δt. Of order 2 in the edges.

    Parameters
    ----------
    string : String
    t_end : float
        In s; the motion begins at 0.
    n_steps : int
    shape : array_like, shape (n_edges + 1, 3), optional
        Positions at the beginning; by default straight, or an arc between two held
        ends.
    velocity : array_like, shape (n_edges + 1, 3) or (3,), optional
        At the beginning, in m/s; it must not stretch the fibre. By default at rest.
    theta : float
        From ½ to 1.
    damping : float
        c in N s/m² on every piece of the fibre.
    air : AirFlow, optional
        What pulls at it with the force a per length, taken at the middle of every step.
    turbulence : RandomForce or TurbulentForce, optional
        A of A·dw_{s,t}, white noise in s and t (Itô) or correlated noise in its place.
        Small vibrations have the right law at every step if θ = ½, so that, other than
        in `lay_down`, its strength is not judged by the step.
    seed : int, optional
        Of `turbulence`: the same seed and step repeat the motion bit by bit.
    tolerance : float, optional
        Largest distance in m of the positions after a step and after two of half its
        length, which are kept; longer steps, and those that are not found, are taken in
        halves. By default steps are as they are given.
    save_every : int, optional
        Keep positions of every so-many-th step, and of the last; by default of the
        first and the last.
    estimate_error : bool
        Repeat the motion with half of the steps, for `position_error`.

    Returns
    -------
    Motion

    Raises
    ------
    ValueError
        If a number is out of its range, the shape does not fit the fibre, the velocity
        would stretch it, or that of the air is no finite number.
    TypeError
        If `air` is no `AirFlow`.
    FlowRangeError
        If the fibre leaves the table of the air.
    ToleranceError
        If the tolerance is not reached by steps of 1/4096 of the given ones.
    EdgeLengthError
        If Newton's method does not converge, as for steps in which an edge turns
        around.

    References
    ----------
    [KMW09]_, equation (4).
    """
    t_end = check_positive("t_end", t_end)
    n_steps = check_integer("n_steps", n_steps, 1)
    every = (
        n_steps if save_every is None else check_integer("save_every", save_every, 1)
    )
    theta = check_real("theta", theta)
    if not 0.5 <= theta <= 1:
        raise ValueError(
            f"`theta` must lie between 0.5 and 1, got {theta:g}; 0.5 keeps the energy, "
            "below it steps grow."
        )
    damping = check_non_negative("damping", damping)
    r = first_shape(string) if shape is None else checked_shape(string, shape)
    v = _checked_velocity(string, r, velocity)
    estimate_error = check_flag("estimate_error", estimate_error)
    if isinstance(string.start, Nozzle) or isinstance(string.end, Nozzle):
        raise ValueError(
            "`string` must not be held by a nozzle, which moves and spins; `lay_down` "
            "is for that."
        )
    if not (air is None or isinstance(air, AirFlow)):
        raise TypeError(f"`air` must be an `AirFlow`, got {shown(air)}.")
    step = ThetaStep(string, t_end / n_steps, theta, damping, air)
    draws = _checked_draws(turbulence, seed, step)
    if tolerance is not None:
        tolerance = check_positive("tolerance", tolerance)
    motion = _motion(step, r, v, n_steps, every, draws, tolerance)
    if not estimate_error or n_steps % 2:
        return motion
    half, second = n_steps // 2, theta == 0.5 and draws is None
    step = replace(step, dt=2 * step.dt)
    bound = 1 if second else 2
    if tolerance is not None:
        # Of steps twice as long; these are powers of ½, and their ratio is another.
        tolerance *= 8 if second else 4
        bound *= 2
    if draws is not None:
        draws = Draws(draws.law, string, air, step.dt, draws.seed, pieces=2)
    other = _motion(step, r, v, half, half, draws, tolerance)
    away = float(np.linalg.norm(other.r[-1] - motion.r[-1], axis=1).max())
    # Where their last step has its tension, between our last two.
    between = np.array([1 - theta, theta]) @ motion.end_tension[-2:]
    pulled = np.abs(between - other.end_tension[-1])
    return replace(
        motion, position_error=bound * away, end_tension_error=bound * pulled
    )


def _motion(
    step: ThetaStep,
    r: Array,
    v: Array,
    n_steps: int,
    every: int,
    draws: Draws | None,
    tolerance: float | None,
) -> Motion:
    string, forces = step.string, Forces(step.string)
    ends, pulls = EndTensions(string), np.full((n_steps + 1, 2), np.nan)
    advanced = step if tolerance is None else HalvedStep(step, tolerance)
    t: Array = np.arange(n_steps + 1.0) * step.dt
    series = np.zeros((5, n_steps + 1))
    saves = sorted({*range(0, n_steps + 1, every), n_steps})
    saving = frozenset(saves)
    kept = []
    tension, iterations = np.zeros(string.n_edges), 0
    for number in range(n_steps + 1):
        if number:
            began, force, before = t[number - 1], None, r
            if draws is not None:
                force = draws.value(number, r, v, began)
            r, v, tension, iterations = advanced(r, v, tension, began, force)
            middle = before + step.theta * (r - before)
            if isinstance(advanced, HalvedStep):
                middle = advanced.middle
            pulls[number] = ends(middle, tension)
        series[:, number] = (
            0.5 * string.masses @ (v**2).sum(axis=1),
            forces.energy(r),
            np.abs(tension).max() if number else np.nan,
            np.abs(forces.stretched(r)).max() / string.edge,
            iterations,
        )
        if number in saving:
            kept.append((r, v))
    positions, velocities = (np.array(one) for one in zip(*kept, strict=True))
    kinetic, potential, largest, stretched, counted = series
    return Motion(
        string, t, kinetic, potential, largest, stretched, counted.astype(np.int64),
        t[saves], positions, velocities, pulls,
    )  # fmt: skip


def _checked_draws(
    turbulence: StochasticForce | None, seed: int | None, step: ThetaStep
) -> Draws | None:
    """What is drawn at every step; TypeError unless there is a seed for it."""
    drawn = checked_law(turbulence, seed)
    if drawn is None:
        return None
    law, seed = drawn
    return Draws(law, step.string, step.air, step.dt, seed)


def _checked_velocity(string: String, r: Array, velocity: ArrayLike | None) -> Array:
    """As an array of all nodes; ValueError if an edge or a held end would move."""
    if velocity is None:
        return np.zeros(r.shape)
    v = checked_vectors("velocity", velocity, r.shape)
    held = np.setdiff1d(np.arange(r.shape[0]), string.moving)
    size = np.abs(v).max()
    if np.abs(v[held]).max(initial=0.0) > 0:
        raise ValueError("`velocity` must vanish at an end that is held.")
    along = (np.diff(v, axis=0) * np.diff(r, axis=0)).sum(axis=1) / string.edge
    if not (np.abs(along) <= RIGID * size).all():
        raise ValueError(
            f"`velocity` must not stretch the fibre, got {np.abs(along).max():.2g} m/s "
            "along an edge; neighbours move across the edge between them only."
        )
    return v
