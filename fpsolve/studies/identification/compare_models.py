"""One call that identifies both models of a fibre and compares them."""

from __future__ import annotations

from typing import Any

from fpsolve.evolution.call import recorded
from fpsolve.model.curves.curve import Curve
from fpsolve.studies.identification.comparison import IdentificationComparison
from fpsolve.studies.identification.comparison_layout import MODELS
from fpsolve.studies.identification.identify import (
    described_fibre,
    fibre_of,
    identify,
    said_by_fibre,
)

__all__ = ["compare_models"]


@recorded(curve_or_eta=described_fibre, ds=said_by_fibre, curve=said_by_fibre)
def compare_models(
    curve_or_eta: Any,
    *,
    ds: float | None = None,
    curve: Curve | None = None,
    method: str = "likelihood",
    k_max: int | None = None,
    seed: int = 0,
) -> IdentificationComparison:
    """Identify the basic and the smooth model of a fibre, and say which is better.

    Both see the same chords, so that AIC = 2 n - 2 ln L compares them; the basic model
    is the smooth one with R = 0, at the edge of its parameters, so that AIC prefers the
    smooth model for P(χ²₁ > 2)/2 = 8 per cent of basic fibres. Whether a model is like
    the fibre at all says the goodness of fit, which may reject one, both or neither.

    Parameters
    ----------
    curve_or_eta : FibreCurve, Paths or array_like
        The fibre, or its points, shape (n, 2).
    ds : float, optional
        Length of fibre between points, where points are given.
    curve : Curve, optional
        Reference curve γ, where the fibre has none.
    method : {"likelihood", "functional"}
    k_max : int, optional
        Longest lag of increments in steps; by default 3 of the larger √⟨ξ²⟩.
    seed : int, optional
        Of the surrogates.

    Returns
    -------
    IdentificationComparison

    Raises
    ------
    ValueError, ToleranceError
        As `identify` does for one of the models.

    References
    ----------
    [KMW09]_, section 4.1; [Aka74]_; [SL87]_ on the edge.
    """
    fibre = fibre_of(curve_or_eta, ds, curve)
    basic, smooth = (
        identify(fibre, model=model, method=method, k_max=k_max, seed=seed)
        for model in MODELS
    )
    return IdentificationComparison(basic, smooth)
