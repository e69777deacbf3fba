"""An identification with given parameters and errors; its fibre does not matter."""

import numpy as np

import fpsolve as fp
from fpsolve.studies.identification.goodness import TESTS
from fpsolve.studies.identification.identification import Identification

# Errors of 2, 3 and 4 per cent, correlated.
RELATIVE = np.array([0.02, 0.03, 0.04])
CORRELATION = np.array([[1.0, 0.3, -0.5], [0.3, 1.0, 0.2], [-0.5, 0.2, 1.0]])


def known_identification(model):
    """Of the basic model, as if it had been identified."""
    parameters = {
        "sigma1": model.potential.sigma1,
        "sigma2": model.potential.sigma2,
        "noise": model.noise,
    }
    spread = RELATIVE * [*parameters.values()]
    h, bands = np.ones(1), np.ones((4, 1))
    angle = 0.1 * np.arange(9)
    eta = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return Identification(
        model=model, data=fp.FibreCurve(eta, 0.1, model.curve), method="likelihood",
        parameters=parameters, covariance=spread[:, None] * CORRELATION * spread,
        log_likelihood=None, history=np.zeros((0, 3)), k_max=1, h=h,
        angle_bands=bands, curvature_bands=bands, p_values=dict.fromkeys(TESTS, 0.5),
    )  # fmt: skip
