"""From a fibre curve to the parameters of a lay-down model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fpsolve._support.checks import check_integer, check_one_of
from fpsolve.evolution.call import recorded
from fpsolve.model.curves.curve import Curve
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.paths.result import Paths
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.functional_estimate import estimate_by_functional
from fpsolve.studies.identification.goodness import compare_with_surrogate
from fpsolve.studies.identification.identification import Identification
from fpsolve.studies.identification.increments import (
    check_long_enough,
    checked_k_max,
    lags_up_to,
    usual_k_max,
)
from fpsolve.studies.identification.likelihood_basic import estimate_basic
from fpsolve.studies.identification.likelihood_smooth import estimate_smooth

__all__ = ["described_fibre", "fibre_of", "identify", "said_by_fibre"]

MODELS = ("basic", "smooth")


def estimate_by_likelihood(
    fibre: FibreCurve, model: str, *, k_max: int, seed: int
) -> Estimate:
    """The most likely parameters, for which nothing is drawn and no lag counts."""
    return estimate_basic(fibre) if model == "basic" else estimate_smooth(fibre)


# What a method is called, and what estimates by it.
ESTIMATORS: dict[str, Callable[..., Estimate]] = {
    "likelihood": estimate_by_likelihood,
    "functional": estimate_by_functional,
}


def described_fibre(value: Any, bound: Mapping[str, Any]) -> Any:
    """The fibre of a call; its points are those of the result."""
    fibre = fibre_of(value, bound.get("ds"), bound.get("curve"))
    about = fibre.parts("data.eta", "data.lengths", "data.s_start")
    return {"$fibre_curve": about}


def said_by_fibre(value: Any, bound: Mapping[str, Any]) -> None:
    """The fibre says it."""


@recorded(curve_or_eta=described_fibre, ds=said_by_fibre, curve=said_by_fibre)
def identify(
    curve_or_eta: Any,
    *,
    ds: float | None = None,
    curve: Curve | None = None,
    model: str = "smooth",
    method: str = "likelihood",
    k_max: int | None = None,
    seed: int = 0,
) -> Identification:
    """Parameters of the basic or the smooth model whose fibres are like the given one.

    The potential is quadratic, B = (ξ₁²/σ₁² + ξ₂²/σ₂²)/2, and the reference curve is
    known. "likelihood" finds the most likely parameters of the chord angles, see
    `studies.identification.likelihood_smooth`: the smallest errors where the model is
    true. "functional" is the method of the paper: the surrogate's functional (24) is
    made equal to that of the data by a relaxed quasi-Newton method, see
    `studies.identification.functional_estimate`.

    With the parameters come standard errors, intervals, what the fibre cannot
    determine, and p-values of the goodness of fit: whether fibres of the model, as long
    as the given one and cut into chords like it, have its increments, its moments and
    its laws.

    Parameters
    ----------
    curve_or_eta : FibreCurve, Paths or array_like
        The fibre, or its points, shape (n, 2).
    ds : float, optional
        Length of fibre between points, where points are given.
    curve : Curve, optional
        Reference curve γ, where the fibre has none.
    model : {"smooth", "basic"}
    method : {"likelihood", "functional"}
    k_max : int, optional
        Longest lag of increments in steps; by default 3 of the larger √⟨ξ²⟩.
    seed : int, optional
        Of the surrogates.

    Returns
    -------
    Identification

    Raises
    ------
    ValueError
        If the fibre is too short, its angle cannot be unwrapped, its reference curve is
        unknown, or an argument is none of those above.
    ToleranceError
        If the parameters do not settle.

    References
    ----------
    [KMW09]_, section 4.1.
    """
    fibre = fibre_of(curve_or_eta, ds, curve)
    check_one_of("model", model, MODELS)
    check_one_of("method", method, ESTIMATORS)
    check_integer("seed", seed, 0)
    check_long_enough(fibre)
    longest = checked_k_max(fibre, usual_k_max(fibre) if k_max is None else k_max)
    found = ESTIMATORS[method](fibre, model, k_max=longest, seed=seed)
    lags = lags_up_to(longest)
    # Fresh noise: not that of which the estimate was made.
    compared = compare_with_surrogate(fibre, found, lags, seed + 1)
    return Identification(
        model=found.model,
        data=fibre,
        method=method,
        parameters=found.parameters,
        covariance=found.covariance,
        log_likelihood=found.log_likelihood,
        history=found.history,
        k_max=longest,
        h=np.asarray(lags * fibre.ds, dtype=np.float64),
        angle_bands=compared.bands("angle"),
        curvature_bands=compared.bands("curvature"),
        p_values=compared.p_values,
        undetermined=found.undetermined,
        notes=found.notes,
    )


def fibre_of(given: Any, ds: float | None, curve: Curve | None) -> FibreCurve:
    """The fibre, from any of the ways to give it."""
    if isinstance(given, Paths):
        given = FibreCurve.from_paths(given)
    if not isinstance(given, FibreCurve):
        if ds is None:
            raise ValueError(
                "`ds` must be given with points, got None; it is the length of fibre "
                "between neighbouring points."
            )
        return FibreCurve(given, ds, curve)
    if ds is not None:
        raise ValueError(
            "`ds` must not be given with a fibre, which has its own; resample it by "
            "`FibreCurve.resampled`."
        )
    return given if curve is None else given.with_curve(curve)
