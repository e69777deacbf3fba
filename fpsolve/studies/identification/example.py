"""The packaged fibre: synthetic points as a camera over a spunbond belt measures them.

``python -m fpsolve.studies.identification.example fpsolve/examples/fibre.csv``
writes it again, the same bits.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.belts import MovingBelt
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.studies.identification.synthetic import laid_fibres

__all__ = [
    "BELT_SPEED",
    "POSITION_ERROR",
    "SEED",
    "SPACING",
    "example_points",
    "example_text",
]

# In metres: throwing ranges, relaxation length; the noise in m^-1/2.
SIGMA1, SIGMA2, RELAXATION_LENGTH, NOISE, BELT_SPEED = 5e-3, 4e-3, 2e-3, 15.0, 0.1
SPACING, POSITION_ERROR, N_POINTS, SEED = 1e-3, 1e-5, 1201, 41


def example_points() -> Array:
    """Points η in metres, (n, 2), each with the error of a camera."""
    model = SmoothLayDownModel(
        QuadraticPotential(1.0, SIGMA2 / SIGMA1),
        RELAXATION_LENGTH / SIGMA1,
        SIGMA1**0.5 * NOISE,
        MovingBelt(BELT_SPEED),
    )
    eta = laid_fibres(
        model, 1, N_POINTS, SPACING / SIGMA1, seed=SEED,
        position_error=POSITION_ERROR / SIGMA1,
    )  # fmt: skip
    return np.asarray(SIGMA1 * eta[0])


def example_text() -> str:
    """The table: metres to the micrometre, and how it was made."""
    head = (
        "# Points of a synthetic fibre of the smooth model on a belt, in metres.",
        f"# sigma1 = {SIGMA1:g} m, sigma2 = {SIGMA2:g} m, A = {NOISE:g} m^-1/2, "
        f"R = {RELAXATION_LENGTH:g} m, v = {BELT_SPEED:g}, seed {SEED};",
        f"# every {SPACING:g} m of fibre, with errors of {POSITION_ERROR:g} m.",
        "eta1,eta2",
    )
    rows = (f"{x:.6f},{y:.6f}" for x, y in example_points().tolist())
    return "\n".join([*head, *rows, ""])


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(example_text(), encoding="utf-8")
