"""An estimate from the maximum of a likelihood."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.belts import FixedBelt
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.coordinates import covariance_of, model_at, named
from fpsolve.studies.identification.determined import (
    check_confined,
    coarse_points,
    loose_strengths,
    with_chord_bias,
)
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.maximum import Maximum

__all__ = ["estimate_of"]


def estimate_of(
    curve: FibreCurve,
    found: Maximum,
    covariance: Array,
    undetermined: Mapping[str, str],
) -> Estimate:
    """The parameters at a maximum with their errors.

    Parameters
    ----------
    curve : FibreCurve
        With its reference curve.
    found : Maximum
    covariance : ndarray
        Of the coordinates of the maximum.
    undetermined : mapping
        What is known to be left open beside throwing ranges.

    Raises
    ------
    ValueError
        If a 1/σ² is not positive.
    """
    strength, errors = found.at[:2], np.sqrt(np.diagonal(covariance))[:2]
    check_confined(strength, errors, curve.length)
    notes = coarse_points(curve, covariance)
    if notes:
        covariance = with_chord_bias(curve, covariance)
    return Estimate(
        parameters=named(found.at),
        covariance=covariance_of(found.at, covariance),
        model=model_at(found.at, curve.curve or FixedBelt()),
        log_likelihood=found.value,
        history=np.array([list(named(at).values()) for at in found.history]),
        notes=notes,
        undetermined={
            **loose_strengths(strength, errors, curve.length),
            **undetermined,
        },
    )
