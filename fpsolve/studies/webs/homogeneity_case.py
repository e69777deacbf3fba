"""One case of the homogeneity study: webs that are laid, and their prediction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.belts import MovingBelt
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.resolvent.fibre import scales_of
from fpsolve.web.lay_web import lay_web
from fpsolve.web.predict import predict_web

__all__ = ["Laid", "homogeneity_case", "model_of", "zone_squares"]

# Throwing ranges beside the largest zone, beyond which a fibre is as good as never
# (the law of a difference of two ξ2 has the deviation √2 σ2: 2e-12 lies beyond),
# positions, with which the number of random ones is nearly Gaussian, and largest zones
# along the belt.
_AROUND, _FEWEST, _LONG = 10.0, 32, 4


@dataclass(frozen=True)
class Laid:
    """What all cases of a study lay, and how well they predict.

    Attributes
    ----------
    zones : tuple of float
    positions : {"regular", "random"}
    n_webs : int
    pixel : float
    ds : float or None
    seed : int
    tolerance : float
    """

    zones: tuple[float, ...]
    positions: str
    n_webs: int
    pixel: float
    ds: float | None
    seed: int
    tolerance: float


def homogeneity_case(
    potential: QuadraticPotential,
    noise: float,
    belt_speed: float,
    spacing: float,
    laid: Laid,
    relaxation_length: float | None = None,
) -> dict[str, Array]:
    """CV predicted and of laid webs, by zone, with their errors and the score."""
    model = model_of(potential, noise, belt_speed, relaxation_length)
    prediction = predict_web(
        model, spacing=spacing, zones=laid.zones, positions=laid.positions,
        tolerance=laid.tolerance,
    )  # fmt: skip
    squares = np.array([
        web_squares(model, spacing, laid, source)
        for source in seeds_of(laid, noise, belt_speed, spacing)
    ])  # fmt: skip
    mean = squares.mean(axis=0)
    error = squares.std(axis=0, ddof=1) / math.sqrt(laid.n_webs)
    # CV² is wrong by twice the product of CV and its error.
    bound = 2 * prediction.cv * prediction.errors
    return {
        "predicted": prediction.cv,
        "predicted_error": prediction.errors,
        "simulated": np.sqrt(mean),
        "standard_error": error / (2 * np.sqrt(mean)),
        "z": (mean - prediction.cv**2) / np.hypot(error, bound),
    }


def model_of(
    potential: QuadraticPotential,
    noise: float,
    belt_speed: float,
    relaxation_length: float | None,
) -> FibreModel:
    """The basic model, or the smooth one with a relaxation length."""
    belt = MovingBelt(belt_speed)
    if relaxation_length is None:
        return LayDownModel(potential, noise, belt)
    return SmoothLayDownModel(potential, relaxation_length, noise, belt)


def seeds_of(laid: Laid, *case: float) -> list[np.random.SeedSequence]:
    """Seeds of the webs of a case, others for every case and whatever the order."""
    words = np.array(case).view(np.uint32).tolist()
    return np.random.SeedSequence([laid.seed, *words]).spawn(laid.n_webs)


def web_squares(
    model: FibreModel, spacing: float, laid: Laid, seed: np.random.SeedSequence
) -> Array:
    """⟨(v d m − 1)²⟩ of one web, by zone."""
    widest = laid.zones[-1]
    # A smooth fibre lies as wide as one with the range √F σ at large noise.
    sigma = scales_of(model)[1] * math.sqrt(Persistence.of(model).factor)
    cells = max(_FEWEST, math.ceil((widest + _AROUND * sigma) / spacing))
    columns = _LONG * round(widest / laid.pixel)
    web = lay_web(
        model, spacing=spacing, positions=laid.positions, pixel=laid.pixel,
        width=cells * round(spacing / laid.pixel) * laid.pixel,
        length=columns * laid.pixel, ds=laid.ds, seed=seed, periodic=True,
    )  # fmt: skip
    deviation = web.length_density / web.expected_density - 1.0
    return np.array(
        [zone_squares(deviation, round(x / laid.pixel)) for x in laid.zones]
    )


def zone_squares(deviation: Array, n: int) -> float:
    """Mean square over all squares of n × n pixels, around the web across the belt.

    Parameters
    ----------
    deviation : ndarray, shape (n_cross, n_machine)
        Periodic in its first direction.
    n : int
        Pixels along the side of a zone.
    """
    around = np.concatenate([deviation, deviation[: n - 1]])
    sums = np.pad(around, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    zones = sums[n:, n:] - sums[:-n, n:] - sums[n:, :-n] + sums[:-n, :-n]
    return float(np.mean((zones / n**2) ** 2))
