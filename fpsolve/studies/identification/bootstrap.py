"""Standard errors from fibres of the model that was found: the parametric bootstrap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer, check_kind
from fpsolve.errors import ToleranceError
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.synthetic import laid_fibres
from fpsolve.studies.sweeps.executors import executor_for, finished_tasks

__all__ = ["bootstrapped", "replicas"]

# Fewer do not give a covariance: its relative error is 1/√(2n).
_FEWEST = 10


def bootstrapped(
    estimate: Estimate,
    curve: FibreCurve,
    estimator: Callable[[FibreCurve], Estimate],
    n: int,
    *,
    seed: int,
    workers: int | None = 0,
) -> Estimate:
    """The estimate with the covariance of n estimates from fibres of its own model.

    The fibres have the lengths, the distances and the errors of the points of `curve`.
    A covariance from n of them has standard errors that are good to 1/√(2n) of
    themselves. Where the mean of the n is away from the parameters by more than chance
    (3 standard errors of the mean) a note tells the bias.

    Parameters
    ----------
    estimate : Estimate
    curve : FibreCurve
        From which it was.
    estimator : callable
        `estimate_basic` or `estimate_smooth`.
    n : int
        At least 10.
    seed : int
    workers : int or None
        Processes; 0 for this one, None for all cores.

    Raises
    ------
    ValueError, TypeError
        Bad arguments.
    ToleranceError
        If more than a tenth of the fibres give no estimate.
    """
    check_kind("curve", curve, FibreCurve)
    n = check_integer("n", n, _FEWEST)
    found = _estimates(replicas(estimate, curve, n, seed), estimator, workers)
    if not len(found) >= 0.9 * n:
        remedy = (
            f"of {n} fibres of the model that was found only {len(found)} give an "
            "estimate; take a longer fibre"
        )
        raise ToleranceError(np.inf, 0.1, remedy)
    spread = np.cov(found.T)
    notes = (
        *estimate.notes,
        *_told_bias(estimate, found, np.sqrt(np.diagonal(spread))),
    )
    return replace(estimate, covariance=spread, notes=notes)


def replicas(
    estimate: Estimate, curve: FibreCurve, n: int, seed: int
) -> list[FibreCurve]:
    """Curves as long as the data, of the model that was found."""
    lengths, starts = curve.lengths, curve.s_start
    pieces = [
        laid_fibres(
            estimate.model, n, int(lengths[k]), curve.ds, seed=(seed, k),
            s_start=float(starts[k]), position_error=curve.position_error,
        )
        for k in range(len(lengths))
    ]  # fmt: skip
    return [
        replace(curve, eta=np.concatenate(one), call=None, provenance={})
        for one in zip(*pieces, strict=True)
    ]


def _estimates(
    curves: list[FibreCurve], estimator: Callable[..., Estimate], workers: int | None
) -> Array:
    """Parameters of those curves from which there are any, (n, n_parameters)."""
    tasks: dict[int, Any] = {
        k: (_tried, estimator, one) for k, one in enumerate(curves)
    }
    found: dict[int, Estimate | None] = {}
    with executor_for(None, workers, len(tasks)) as executor:
        if executor is None:
            found = {key: _tried(*task[1:]) for key, task in tasks.items()}
        else:
            for key, result, error in finished_tasks(executor, tasks):
                if error is not None:
                    raise error
                found[key] = result
    kept = (found[key] for key in sorted(found))
    return np.array([list(one.parameters.values()) for one in kept if one is not None])


def _tried(estimator: Callable[..., Estimate], curve: FibreCurve) -> Estimate | None:
    try:
        return estimator(curve)
    except (ValueError, ToleranceError):
        return None


def _told_bias(estimate: Estimate, found: Array, spread: Array) -> list[str]:
    """What the mean of the replicas says of the estimator."""
    bias = found.mean(axis=0) - list(estimate.parameters.values())
    seen = np.abs(bias) > 3 * spread / np.sqrt(len(found))
    return [
        f"{name} is found too {'large' if off > 0 else 'small'} by {abs(off):.2g} on "
        f"average in {len(found)} fibres of the model that was found"
        for name, off, tell in zip(estimate.parameters, bias, seen, strict=True)
        if tell
    ]
