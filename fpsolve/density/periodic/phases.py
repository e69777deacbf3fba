"""A density at every phase of a period, from its density at the first."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._kernels.threads import threads_worth_their_wait
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.stationary.iteration import Stationary
from fpsolve.density.stationary.strides import DIVISORS
from fpsolve.evolution.richardson import weights_of
from fpsolve.grids import diagnostics

__all__ = ["Phases", "at_phases", "through_phases"]

# Size of the field that is carried along by its difference, relative to the density.
DISTURBANCE = 0.1


@dataclass(frozen=True)
class Phases:
    """Densities at the phases s_j = j P/n, and fields like their errors.

    Attributes
    ----------
    densities : ndarray, shape (n, n1, n2, n_alpha)
        Of mass one each.
    step, iteration : ndarray, shape (n, n1, n2, n_alpha)
        As those of `Stationary`, at every phase.
    """

    densities: Array
    step: Array
    iteration: Array


def at_phases(scheme: Any, found: Stationary, period: float, n: int) -> Phases:
    """The densities at n phases, extrapolated from three step lengths as at the first.

    The error of the first is carried along, that of the steps in between is added.

    Parameters
    ----------
    scheme : DriftKick or SmoothDriftKick
    found : Stationary
        At s = 0.
    period : float
    n : int
    """
    p, apart = found.evolved, period / n
    n_steps = max(1, math.ceil(apart / found.ds * (1 - 1e-9)))
    runs = [
        through_phases(scheme, p, apart, j * n_steps, n) for j in DIVISORS
    ]  # fmt: skip
    densities = sum(w * one for w, one in zip(weights_of(DIVISORS), runs, strict=True))
    other = sum(
        w * one for w, one in zip(weights_of(DIVISORS[1:]), runs[1:], strict=True)
    )
    assert isinstance(densities, np.ndarray)
    carried = [
        _carried_along(scheme, p, runs[0], field, apart, n_steps)
        for field in (found.step, found.iteration)
    ]
    step = densities - other + carried[0]
    densities[0] = found.density
    for one in densities:
        one /= diagnostics.mass(one, scheme.grid)
    return Phases(densities, step, carried[1])


def through_phases(
    scheme: Scheme, p: Array, apart: float, n_steps: int, n: int
) -> Array:
    """p at s = 0, and what is read after every stretch `apart` of n_steps each."""
    found = np.empty((n, *p.shape))
    found[0] = p
    with threads_worth_their_wait(p.size):
        state = scheme.start(p)
        for j in range(1, n):
            scheme.advance(state, (j - 1) * apart, apart / n_steps, n_steps)
            found[j] = scheme.density(state)
    return found


def _carried_along(
    scheme: Scheme, p: Array, run: Array, field: Array, apart: float, n_steps: int
) -> Array:
    """A field as the equation moves it, which is linear."""
    size = float(np.abs(field).sum())
    if size == 0.0:
        return np.zeros_like(run)
    scale = DISTURBANCE * float(np.abs(p).sum()) / size
    moved = through_phases(scheme, p + scale * field, apart, n_steps, run.shape[0])
    along: Array = (moved - run) / scale
    return along
