"""How fast averages along a path converge to those of the equilibrium."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_integer, check_kind, check_positive
from fpsolve._support.labels import labels, to_json
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.laws import EquilibriumLaw
from fpsolve.paths.sampling import sample_paths
from fpsolve.studies.arguments import noises_of, series_of
from fpsolve.studies.ergodicity.asymptotic_variance import SETTLED
from fpsolve.studies.ergodicity.dataset import averages_dataset
from fpsolve.studies.ergodicity.fit import ErgodicFit, fit_ergodic_error
from fpsolve.studies.observables import Observable, equilibrium_moments, functions_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ErgodicFit", "ergodic_averages", "fit_ergodic_error"]

# Paths are averaged in this many batches, whose scatter gives every uncertainty.
N_BATCHES = 40
# Arclengths to save at are multiples of about this, so that all noises share them.
_SAVING_STEP = 0.5
# Every path is averaged at each of them.
_MOST_SAVED = 100_000
# Steps of all paths: hours on one core.
_MOST_PATH_STEPS = 1e12
# The default step: the splitting is of weak order 2, with an error that grows with the
# angle A √ds by which noise turns the fibre in a step.
_LONGEST_STEP, _LARGEST_TURN = 0.1, 0.5


class Client(Protocol):
    """Runs tasks elsewhere: a dask client or an executor."""

    def submit(self, function: Any, *args: Any) -> Any:
        """Return a future with `result()`."""


@dataclass(frozen=True)
class _Task:
    """One noise: everything a worker needs."""

    potential: Potential
    noise: float
    ds: float
    saved: Array
    n_paths: int
    seed: np.random.SeedSequence
    functions: dict[str, Observable]
    means: Array


@recorded()
def ergodic_averages(
    potential: Potential,
    noises: Iterable[float],
    *,
    s_end: float,
    ds: float | None = None,
    n_paths: int,
    seed: int | np.random.SeedSequence,
    functions: Mapping[str, Observable] | None = None,
    n_saved: int = 24,
    client: Client | None = None,
    progress: bool | ProgressCallback = False,
) -> xr.Dataset:
    """‖s⁻¹∫₀ˢ f dt − E f‖ in L²(P_μ), the left side of (12), against s and A.

    An ensemble of paths started from the equilibrium μ on a fixed belt, for every
    noise. E f comes from quadrature, not from the sample, so that the error of an
    average counts in full. The step error of the sampler, of order ds², is part of
    the result.

    Parameters
    ----------
    potential : Potential
        With normalisable exp(-B).
    noises : iterable of float
        Noise amplitudes A, positive: without noise the process is not ergodic.
    s_end : float
        Longest average. Asymptotic variances need several correlation lengths, the
        inverse of the spectral gap, in a quarter of it; the gap is at most A²/2.
    ds : float, optional
        Step of the sampler; must divide `s_end`. By default at most 0.1 and at most
        1/(2A²), for each noise its own.
    n_paths : int
        Paths for each noise, at least 40. The relative standard error of an L² error
        is about 0.7/√n_paths.
    seed : int or numpy.random.SeedSequence
        Every noise gets a stream of its own.
    functions : mapping of str to callable, optional
        f(xi1, xi2, alpha), elementwise, by name; see `default_observables`.
    n_saved : int
        About how many arclengths to record, evenly spaced in ln s.
    client : optional
        Anything with ``submit(function, *args)``: one task for each noise.
    progress : bool or callable
        A bar, or a callback(n_done, n_total, s) in path-steps.

    Returns
    -------
    xarray.Dataset
        Over (noise, function, s): `error`, and `scaled_variance` = s error²; over
        (noise, function): `asymptotic_variance`, the slope of s² error² against s from
        a quarter of `s_end` on. Each with `..._standard_error`. Over (function): the
        exact `expectation` and `deviation` ‖f − E f‖. `squared_error` has a leading
        dimension `batch`: the same from forty batches of paths, which are
        independent, while errors at different s come from the same paths.

    Raises
    ------
    ValueError
        If exp(-B) is not normalisable, a noise is not positive, `n_paths` is below 40,
        `ds` does not divide `s_end`, a function cannot be integrated, or the default
        step would take more than 1e12 steps.

    References
    ----------
    [KMW09]_, equation (12) and theorem 3.3.
    """
    sequence = _own_sequence(seed)
    noises = series_of(noises)
    check_kind("potential", potential, Potential, "for instance QuadraticPotential()")
    functions = functions_of(functions, potential)
    _check(potential, n_paths, n_saved)
    s_end = check_positive("s_end", s_end)
    amplitudes = np.array(noises_of(noises))
    moments = equilibrium_moments(potential, functions)
    saved, steps = _arclengths(amplitudes, s_end, ds, n_saved)
    if ds is None:
        _check_time(amplitudes, n_paths * s_end / steps)
    tasks = [
        _Task(potential, noise, step, saved, n_paths, child, functions, moments.mean)
        for noise, step, child in zip(
            amplitudes, steps, sequence.spawn(len(steps)), strict=True
        )
    ]
    squared = np.stack(list(_run(tasks, client, progress)), axis=1)
    about = {
        "equation": "(12) of Klar, Marheineke and Wegener (2009)",
        "n_paths": n_paths,
        "seed": to_json([sequence.entropy, *sequence.spawn_key]),
    }
    dataset = averages_dataset(
        squared, amplitudes, saved, list(functions), moments, potential, about
    )
    return dataset.assign(ds=("noise", steps, labels("step ds")))


def _check(potential: Potential, n_paths: int, n_saved: int) -> None:
    if not potential.normalisable:
        raise ValueError(
            f"`potential` must have a normalisable exp(-B), got {potential!r}; without "
            "an equilibrium there is nothing to converge to."
        )
    check_integer("n_paths", n_paths, N_BATCHES)
    check_integer("n_saved", n_saved, 8, _MOST_SAVED)


def _check_time(noises: Array, path_steps: Array) -> None:
    """Raise if the default steps are so short that the study would not end."""
    worst = int(np.argmax(path_steps))
    if not path_steps[worst] <= _MOST_PATH_STEPS:
        raise ValueError(
            f"`noises` must leave steps that can be taken, got {noises[worst]:g} and "
            f"with it {path_steps[worst]:.1g} steps of 1/(2 A^2) on all paths; choose "
            "`ds`, a shorter `s_end` or fewer paths."
        )


def _own_sequence(seed: int | np.random.SeedSequence) -> np.random.SeedSequence:
    """Return a sequence that spawns the same streams however often it is used."""
    if isinstance(seed, np.random.SeedSequence):
        return np.random.SeedSequence(seed.entropy, spawn_key=seed.spawn_key)
    return np.random.SeedSequence(check_integer("seed", seed, 0))


def _arclengths(
    noises: Array, s_end: float, ds: float | None, n_saved: int
) -> tuple[Array, Array]:
    """Arclengths to save at, evenly spaced in ln s, and the step for each noise."""
    if ds is None:
        unit = s_end / math.ceil(s_end / _SAVING_STEP)
        longest = np.minimum(_LONGEST_STEP, _LARGEST_TURN / noises**2)
        steps = unit / np.ceil(unit / longest)
    else:
        unit = check_positive("ds", ds)
        steps = np.full(noises.shape, unit)
    n_units = round(s_end / unit)
    if not abs(n_units * unit - s_end) <= 1e-9 * s_end or n_units < 4:
        raise ValueError(
            f"`ds` must divide `s_end` = {s_end:g} into at least 4 steps, got "
            f"{unit:g}; try {s_end / max(math.ceil(s_end / unit), 4):g}."
        )
    chosen = np.geomspace(max(1, n_units // 200), n_units, n_saved)
    multiples = np.unique(np.append(np.round(chosen), np.ceil(SETTLED * n_units)))
    return multiples * unit, steps


def _run(
    tasks: list[_Task], client: Client | None, progress: bool | ProgressCallback
) -> Iterator[Array]:
    """Squared errors of every task, in order, wherever they are computed."""
    path_steps = [task.n_paths * round(task.saved[-1] / task.ds) for task in tasks]
    futures = [client.submit(_squared_errors, task) for task in tasks] if client else []
    with reporting(progress) as report:
        for index, task in enumerate(tasks):
            yield futures[index].result() if client else _squared_errors(task)
            n_done = sum(path_steps[: index + 1])
            report(n_done, sum(path_steps), float(task.saved[-1]))


@one_blas_thread()
def _squared_errors(task: _Task) -> Array:
    """E|s⁻¹∫f − E f|² within each batch; shape (batch, function, s)."""
    paths = sample_paths(
        LayDownModel(task.potential, task.noise),
        task.n_paths,
        float(task.saved[-1]),
        task.ds,
        seed=task.seed,
        initial=EquilibriumLaw(task.potential),
        save_at=task.saved,
        keep=False,
    )
    averages = paths.time_averages(list(task.functions.values()))
    squares = np.square(averages - task.means[:, None, None])
    batches = np.array_split(squares, N_BATCHES, axis=2)
    return np.stack([batch.mean(axis=2) for batch in batches])
