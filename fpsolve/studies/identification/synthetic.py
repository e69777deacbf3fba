"""Fibres of a model as data: points at equal distances, with errors if wanted."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.ensemble import Ensemble, GivenStart
from fpsolve.paths.runner import stepwise
from fpsolve.paths.trajectory import traced

__all__ = ["laid_fibres"]

# Steps between points. The angle of a sampled basic fibre is constant over a step,
# which acts on the angles of chords as a white noise of variance -A²Δ/(12 m²): A is low
# by 0.18/m², less than a part in a thousand.
_N_STEPS = 16
# Angles of smooth fibres are exact without force, but kicks show where noise is small.
_N_SMOOTH_STEPS = 8
# Steps are below this share of the shortest length in which the model changes.
_SHARE = 0.1


def laid_fibres(
    model: FibreModel,
    n_fibres: int,
    n_points: int,
    ds: float,
    *,
    seed: int | Sequence[int],
    s_start: float = 0.0,
    position_error: float = 0.0,
    settle: float | None = None,
) -> Array:
    """Points η of independent fibres; shape (n_fibres, n_points, 2).

    Parameters
    ----------
    model : FibreModel
        With a quadratic potential.
    n_fibres, n_points : int
    ds : float
        Length of fibre between points.
    seed : int or sequence of int
    s_start : float
        Arclength of the first point: the phase of the reference curve.
    position_error : float
        Standard deviation of the error of every coordinate.
    settle : float, optional
        Length before the first point; by default as long as the fibre forgets.
    """
    rng = np.random.default_rng(seed)
    n_before = math.ceil((_memory(model) if settle is None else settle) / ds)
    every = _steps_between(model, ds)
    # Whole multiples of ds from the first point, so that the phase is right.
    begin = s_start - n_before * ds
    end = s_start + (n_points - 1) * ds
    ensemble = Ensemble(
        model=model,
        n_paths=n_fibres,
        schedule=stepwise(begin, end, ds / every, None),
        seed=int(rng.integers(2**62)),
        method="splitting",
        law=_start(model, n_fibres, rng),
    )
    xi = _points(ensemble, every)[n_before:]
    s = s_start + ds * np.arange(n_points)
    eta = xi.transpose(1, 0, 2) + np.stack(model.curve.position(s), axis=-1)
    return eta + position_error * rng.standard_normal(eta.shape)


def _points(ensemble: Ensemble, every: int) -> Array:
    """ξ at every few steps, (n_points, n_fibres, 2)."""
    kept = []
    start = ensemble.initial_state(0, ensemble.n_paths)
    for first, states in traced(ensemble, 0, start, None):
        kept.append(states[-first % every :: every, :2])
    return np.concatenate(kept).transpose(0, 2, 1)


def _start(model: FibreModel, n: int, rng: np.random.Generator) -> GivenStart:
    """ξ of the law on a belt at rest, any angle."""
    xi = np.array(_ranges(model)) * rng.standard_normal((n, 2))
    return GivenStart(xi, rng.uniform(0, math.tau, n))


def _ranges(model: FibreModel) -> tuple[float, float]:
    """σ1 and σ2."""
    potential = model.potential
    check_kind("potential", potential, QuadraticPotential)
    assert isinstance(potential, QuadraticPotential)
    return potential.sigma1, potential.sigma2


def _memory(model: FibreModel) -> float:
    """Several times the length in which ξ forgets: σ, 2/A² or A²σ²."""
    widest = max(_ranges(model))
    slow = model.noise**2 * widest**2
    lazy = 2 / model.noise**2 if model.noise else 0.0
    return 5 * (widest + min(lazy, 10 * widest) + slow)


def _steps_between(model: FibreModel, ds: float) -> int:
    """Steps from point to point."""
    shortest = min(_ranges(model))
    if not isinstance(model, SmoothLayDownModel):
        return max(_N_STEPS, math.ceil(ds / (_SHARE * shortest)))
    fastest = min(shortest, 2 * model.relaxation_length)
    return max(_N_SMOOTH_STEPS, math.ceil(ds / (_SHARE * fastest)))
