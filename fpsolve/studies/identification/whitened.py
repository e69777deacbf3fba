"""Generalised least squares: where the search for the maximum starts.

For a given R the innovations of the filter are linear in (1/σ1², 1/σ2²), and A only
scales them: the filter is the square root of the inverse covariance, and least squares
of what it leaves are the generalised ones. They leave out that the force contains the
noise of its own chord, which the likelihood does not.
"""

from __future__ import annotations

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.studies.identification.chord_law import Parameters
from fpsolve.studies.identification.likelihood import Likelihood

__all__ = ["least_squares"]


def least_squares(likelihood: Likelihood, relaxation_length: float) -> Parameters:
    """(1/σ1², 1/σ2²) and A for a given R, by generalised least squares.

    NaN where the innovations of a trial overflow.
    """
    strengths = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    unforced, *forced = (
        likelihood.densities(Parameters(b, 1.0, relaxation_length), exact_points=True)[
            0
        ]
        for b in strengths
    )
    columns: Array = np.stack([unforced - one for one in forced], axis=1)
    if not (np.isfinite(columns).all() and np.isfinite(unforced).all()):
        return Parameters((np.nan, np.nan), np.nan, relaxation_length)
    b, *_ = np.linalg.lstsq(columns, unforced, rcond=None)
    noise = float(np.sqrt(np.mean((unforced - columns @ b) ** 2)))
    return Parameters((float(b[0]), float(b[1])), noise, relaxation_length)
