"""The density that a stride leaves unchanged, and what step and iteration miss."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.stationary.acceleration import Acceleration
from fpsolve.density.stationary.correction import Correction
from fpsolve.density.stationary.strides import STRIDE, Strides
from fpsolve.errors import SteadyStateError
from fpsolve.grids import diagnostics

__all__ = ["Stationary", "settled", "stationary"]


MOST_CORRECTIONS = 30
# How accurately a correction is computed, and the error of the step.
CORRECTION, STEP_ERROR = 0.05, 0.1
# Share of the tolerance that the iteration may leave.
ITERATION_SHARE = 0.03
# Reduction assumed of the first correction; and of any at worst, where what is left
# is extrapolated from two corrections in a row.
FIRST, SLOWEST = 0.3, 0.9
# No two densities are further apart.
DIVERGED = 2.0
# Corrections within which they must become half as large.
PATIENCE = 8
# Halvings of the step on one grid. One that gains less than this is the last: what
# is left is not the step's.
HALVINGS, GAIN = 4, 0.5
# Halvings after which corrections that do not converge are given up.
RETRIES = 2


@dataclass(frozen=True)
class Stationary:
    """A density that does not change over a stride, and fields like its errors.

    Attributes
    ----------
    density : ndarray, shape (n1, n2, n_alpha)
        Of mass one, as a run would record it.
    evolved : ndarray, shape (n1, n2, n_alpha)
        What steps go on from; another where the scheme corrects what is read.
    step : ndarray, shape (n1, n2, n_alpha)
        Difference to the density of another combination of step lengths.
    iteration : ndarray, shape (n1, n2, n_alpha)
        The last correction, scaled to what is left to correct.
    splitting : ndarray, shape (n1, n2, n_alpha)
        Difference of the density of ds alone to that of all step lengths.
    residual : float
        ∫ |p_{s+σ} − p_s| dξ dα / σ over the stride σ.
    ds : float
    n_applications : int
    """

    density: Array
    evolved: Array
    step: Array
    iteration: Array
    splitting: Array
    residual: float
    ds: float
    n_applications: int


def settled(
    scheme: DriftKick, ds: float, start: Array, goal: float, residual: float = np.inf,
    length: float = STRIDE,
) -> Stationary:  # fmt: skip
    """The extrapolated density with an error of the step below `goal`, if possible.

    The step is halved until then, or until that gains less than half.

    Raises
    ------
    SteadyStateError
        If no step is short enough for the corrections to converge.
    """
    found = None
    for halvings in range(HALVINGS + 1):
        try:
            step = ds / 2**halvings
            finer = stationary(scheme, step, start, goal, residual, length=length)
        except SteadyStateError:
            if found is None and halvings < RETRIES:
                continue
            if found is None:
                raise
            break
        error = size_of(finer.step, scheme)
        before = np.inf if found is None else size_of(found.step, scheme)
        if error < before:
            found, start = finer, finer.evolved
        if error <= goal or not error < GAIN * before:
            break
    assert found is not None
    return found


def stationary(
    scheme: DriftKick,
    ds: float,
    start: Array,
    goal: float,
    residual: float = np.inf,
    extrapolate: bool = True,
    length: float = STRIDE,
) -> Stationary:
    """The density that a stride of this length reproduces.

    The answer of all step lengths tells what is wrong, that of ds alone what to do
    about it: p ← p + (I − E_ds)⁻¹ (E p − p), until the corrections that would follow
    sum up to a small share of `goal`, and the residual is at most `residual`.

    Raises
    ------
    SteadyStateError
        If that is not reached.
    """
    strides = Strides(scheme, ds, extrapolate, length)
    p = start / diagnostics.mass(start, scheme.grid)
    images = strides(p)
    correct = Correction(strides.longest, p, images[0])
    accelerate, before = Acceleration(), np.inf
    sizes = [np.inf] * PATIENCE
    for _ in range(MOST_CORRECTIONS):
        defect = strides.answer(images) - p
        if not size_of(defect, scheme) < np.inf:
            raise SteadyStateError(np.nan, ITERATION_SHARE * goal)
        correction = correct(defect, CORRECTION)
        p = accelerate(p, correction)
        p /= diagnostics.mass(p, scheme.grid)
        size = size_of(correction, scheme)
        share = left_share(size, before, size_of(defect, scheme), correct.amplification)
        images = strides(p)
        rate = size_of(strides.answer(images) - p, scheme) / strides.longest.stride
        if share * size <= ITERATION_SHARE * goal and rate <= residual:
            step = correct(strides.step_error(images), STEP_ERROR)
            one = correct(strides.splitting(images), STEP_ERROR)
            left, applied = share * correction, strides.n_applications
            found = Stationary(p, p, step, left, one, rate, ds, applied)
            return as_read(found, strides, images)
        sizes.append(size)
        if not size <= DIVERGED or sizes[-1] > 0.5 * sizes[-PATIENCE:][0]:
            break
        before = size
    raise SteadyStateError(rate, min(residual, ITERATION_SHARE * goal))


def as_read(found: Stationary, strides: Strides, images: Sequence[Array]) -> Stationary:
    """The same with what the scheme adds where a density is read.

    What that adds to the fields like errors depends on the step lengths, as they do.
    """
    added = strides.readings(images)
    if added is None:
        return found
    p = found.evolved + strides.answer(added)
    return replace(
        found, density=p / diagnostics.mass(p, strides.longest.scheme.grid),
        step=found.step + strides.step_error(added),
        splitting=found.splitting + strides.splitting(added),
    )  # fmt: skip


def left_share(
    size: float, before: float, defect: float, amplification: float
) -> float:
    """What is left after a correction, relative to it.

    A geometric series with the ratio of this to the last; slow directions that a
    correction has hardly touched are covered by the defect, of which a correction
    leaves this ratio, amplified as much as anything was.
    """
    if not size > 0:
        return 1.0
    ratio = min(size / before, SLOWEST) if np.isfinite(before) else FIRST
    largest = max(1.0, amplification * defect / size)
    return largest * ratio / (1.0 - ratio)


def size_of(difference: Array, scheme: DriftKick) -> float:
    """∫ |d| dξ dα."""
    return float(np.abs(difference).sum()) * scheme.grid.cell_volume
