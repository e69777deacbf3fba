"""An identification with given parameters and errors; its fibre does not matter."""

import numpy as np

import fpsolve as fp
from fpsolve.studies.identification.goodness import TESTS
from fpsolve.studies.identification.identification import Identification

# Errors of 2, 3, 4 and 5 per cent, correlated.
RELATIVE = np.array([0.02, 0.03, 0.04, 0.05])
CORRELATION = np.array([
    [1.0, 0.3, -0.5, 0.0], [0.3, 1.0, 0.2, 0.1], [-0.5, 0.2, 1.0, 0.4],
    [0.0, 0.1, 0.4, 1.0],
])  # fmt: skip


def known_identification(model):
    """Of a model, as if it had been identified."""
    parameters = {
        "sigma1": model.potential.sigma1,
        "sigma2": model.potential.sigma2,
        "noise": model.noise,
    }
    if isinstance(model, fp.SmoothLayDownModel):
        parameters["curvature_noise"] = model.curvature_noise
    n = len(parameters)
    spread, between = RELATIVE[:n] * [*parameters.values()], CORRELATION[:n, :n]
    h, bands = np.ones(1), np.ones((4, 1))
    angle = 0.1 * np.arange(9)
    eta = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return Identification(
        model=model, data=fp.FibreCurve(eta, 0.1, model.curve), method="likelihood",
        parameters=parameters, covariance=spread[:, None] * between * spread,
        log_likelihood=None, history=np.zeros((0, n)), k_max=1, h=h,
        angle_bands=bands, curvature_bands=bands, p_values=dict.fromkeys(TESTS, 0.5),
    )  # fmt: skip
