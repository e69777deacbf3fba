"""What an estimator returns, whichever it is."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.fibre import FibreModel

__all__ = ["Estimate"]


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters of a model with what is known of their errors.

    Attributes
    ----------
    parameters : dict of float
        σ1, σ2 and A as "sigma1", "sigma2", "noise"; of the smooth model also K as
        "curvature_noise".
    covariance : ndarray, shape (n, n)
        In the order of the parameters.
    model : FibreModel
        With these parameters and the reference curve.
    log_likelihood : float or None
        At the estimate, where the method has one.
    history : ndarray, shape (n_iterations, n)
        Parameters of every iteration.
    notes : tuple of str
        What a user should know of how it went.
    undetermined : dict of str
        Parameters that the data cannot determine, and why.
    """

    parameters: dict[str, float]
    covariance: Array
    model: FibreModel
    log_likelihood: float | None = None
    history: Array = field(default_factory=lambda: np.empty((0, 0)))
    notes: tuple[str, ...] = ()
    undetermined: dict[str, str] = field(default_factory=dict)
