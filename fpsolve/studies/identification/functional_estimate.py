"""The estimator of the paper: parameters whose surrogates have the functional (24)."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.curve_search import CurveSearch
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.increments import (
    NAMES,
    check_long_enough,
    log_functional,
    usual_k_max,
)
from fpsolve.studies.identification.quasi_newton import Search, corrected
from fpsolve.studies.identification.sampling_error import bootstrap_covariance, larger

__all__ = ["FEWEST_SAMPLES", "estimate_by_functional", "undetermined_of"]

# Samples of an iteration, below which its noise is no longer small against the data's.
FEWEST_SAMPLES = 200_000
# Relative standard error of a parameter that is not determined.
WEAKEST = 0.5
MEANINGS = {
    "sigma1": "√⟨ξ₁²⟩", "sigma2": "√⟨ξ₂²⟩", "noise": "the largest Γ_α",
    "curvature_noise": "the largest Γ_κ",
}  # fmt: skip


def estimate_by_functional(
    fibre: FibreCurve,
    model: str,
    *,
    seed: int = 0,
    k_max: int | None = None,
    samples: int = FEWEST_SAMPLES,
) -> Estimate:
    """P with F(surrogate of P) = F(data), F the functional (24).

    The same finite differences act on data and surrogate, which has the Δs, the
    reference curve and the scatter of the points of the data. Iterates are averaged,
    and corrected once by the measured slopes ∂ log F/∂ log P for what is left of
    log F/F(P), with surrogates as long as the data: the bias of a finite fibre goes.
    The covariance is that of F over surrogates of the data's size, or by a block
    bootstrap of the data where that is larger, through the inverse slopes.

    At little noise smooth fibres circle, and the largest Γ_α is that of k_max whatever
    A is: F(P) folds. Where it does not answer to A, or the iterates do not settle, the
    estimate is the mean of the parameters that √⟨ξ²⟩ and Γ_α, Γ_κ at four lags up to
    k_max allow, see `curve_search`; `notes` say so.

    Parameters
    ----------
    fibre : FibreCurve
        With its reference curve.
    model : {"basic", "smooth"}
    seed : int, optional
    k_max : int, optional
        By default 3 of the larger √⟨ξ²⟩, in steps.
    samples : int, optional
        Points of surrogates in an iteration, at least 200000.

    Returns
    -------
    Estimate

    Raises
    ------
    ValueError
        If the fibre is too short or its angle cannot be unwrapped.
    ToleranceError
        If the iterates do not settle.

    References
    ----------
    [KMW09]_, section 4.1 and equation (24).
    """
    check_long_enough(fibre)
    fibre.check_turns()
    n = 3 if model == "basic" else 4
    longest = usual_k_max(fibre) if k_max is None else k_max
    samples = check_integer("samples", samples, FEWEST_SAMPLES)
    search = Search(fibre, n, longest, samples, check_integer("seed", seed, 0))
    solved = search.run()
    if solved is None:
        return _by_curves(search)
    logs, slopes = solved
    drawn = log_functional(search.replicates(logs))[:n]
    n_drawn = drawn.shape[1]
    logs = logs + corrected(slopes, search.target - drawn.mean(axis=1))
    own = bootstrap_covariance(fibre, search.lags, seed)
    spread = larger(np.cov(drawn), None if own is None else own[:n, :n])
    inverse = np.linalg.pinv(slopes, rcond=1e-6)
    # Of the data, and of the mean of as many surrogates that is put equal to it.
    relative = inverse @ (spread * (1 + 1 / n_drawn)) @ inverse.T
    notes = (f"k_max = {longest}: increments up to h = {longest * fibre.ds:g}",)
    errors = np.sqrt(np.diag(relative))
    parameters = _named(logs)
    why = undetermined_of(parameters, errors, slopes)
    return _estimate(search, logs, relative, notes, why)


def _by_curves(search: Search) -> Estimate:
    """Of Γ at several lags, where (24) has no solution that is told from others."""
    curves = CurveSearch(search)
    found = curves.run()
    lags = ", ".join(f"{h:.3g}" for h in curves.h)
    notes = (
        f"k_max = {search.k_max}: the largest Γ_α up to h = "
        f"{search.k_max * search.fibre.ds:g} do not determine the parameters; Γ at "
        f"h = {lags} were met instead",
    )
    why = {
        name: f"its standard error is {100 * error:.0f} % of it: √⟨ξ²⟩ and Γ at h = "
        f"{lags} are nearly the same for other values; take a longer fibre"
        for name, error in zip(NAMES, np.sqrt(np.diag(found.covariance)), strict=False)
        if not error <= WEAKEST
    }
    search.history += curves.history
    return _estimate(search, found.mean, found.covariance, notes, why)


def _named(logs: Array) -> dict[str, float]:
    return dict(zip(NAMES, np.exp(logs).tolist(), strict=False))


def _estimate(
    search: Search,
    logs: Array,
    relative: Array,
    notes: tuple[str, ...],
    undetermined: dict[str, str],
) -> Estimate:
    """Of logarithms and their covariance."""
    values = np.exp(logs)
    return Estimate(
        parameters=_named(logs),
        covariance=relative * np.outer(values, values),
        model=search.model(logs),
        history=np.array(search.history),
        notes=notes,
        undetermined=undetermined,
    )


def undetermined_of(
    parameters: dict[str, float], relative: Array, slopes: Array
) -> dict[str, str]:
    """Parameters with relative standard errors above a half, and why."""
    return {
        name: (
            f"its standard error is {100 * error:.0f} % of it: {MEANINGS[name]} of the "
            f"fibre changes by {slope:.2g} % where it changes by 1 %"
        )
        for name, error, slope in zip(
            parameters, relative, np.diag(slopes), strict=True
        )
        if not error <= WEAKEST
    }
