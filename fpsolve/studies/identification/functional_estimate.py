"""The estimator of the paper: parameters whose surrogates have the functional (24)."""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.paths.fibres.fibre_curve import FibreCurve
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
    logs, slopes = search.run()
    drawn = log_functional(search.replicates(logs))[:n]
    n_drawn = drawn.shape[1]
    logs = logs + corrected(slopes, search.target - drawn.mean(axis=1))
    own = bootstrap_covariance(fibre, search.lags, seed)
    spread = larger(np.cov(drawn), None if own is None else own[:n, :n])
    inverse = np.linalg.pinv(slopes, rcond=1e-6)
    # Of the data, and of the mean of as many surrogates that is put equal to it.
    relative = inverse @ (spread * (1 + 1 / n_drawn)) @ inverse.T
    values = np.exp(logs)
    parameters = dict(zip(NAMES, values.tolist(), strict=False))
    return Estimate(
        parameters=parameters,
        covariance=relative * np.outer(values, values),
        model=search.model(logs),
        history=np.array(search.history),
        notes=(f"k_max = {longest}: increments up to h = {longest * fibre.ds:g}",),
        undetermined=undetermined_of(parameters, np.sqrt(np.diag(relative)), slopes),
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
