"""Whether laid webs vary as much as it is predicted without laying one."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_integer,
    check_one_of,
    check_positive,
    check_real,
)
from fpsolve.evolution.call import recorded
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.spectral.resolvent.fibre import check_fibre, scales_of
from fpsolve.studies.arguments import noises_of, series_of
from fpsolve.studies.sweeps.study import swept
from fpsolve.studies.sweeps.sweep import Case, SweepProgress
from fpsolve.studies.webs.homogeneity_case import Laid, homogeneity_case, model_of
from fpsolve.studies.webs.homogeneity_dataset import homogeneity_dataset
from fpsolve.web.predict import checked_zones
from fpsolve.web.prediction import POSITIONS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["web_homogeneity"]

ZONES = (0.1, 0.3, 1.0, 3.0, 10.0)
# Relative; what rounding makes of a multiple of the pixel.
_ROUNDING = 1e-9


@recorded()
def web_homogeneity(
    potential: QuadraticPotential,
    noises: Iterable[float],
    belt_speeds: Iterable[float],
    spacings: Iterable[float],
    *,
    relaxation_length: float | None = None,
    zones: Iterable[float] = ZONES,
    positions: str = "regular",
    n_webs: int = 12,
    pixel: float | None = None,
    ds: float | None = None,
    seed: int = 1,
    tolerance: float = 5e-3,
    client: Any = None,
    workers: int | None = None,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> xr.Dataset:
    """CV(x) of laid webs beside CV(x) = √(v d ∫ Ŝ|ŵ|² d²k/(2π)² + coherent part).

    For every noise, belt speed and spacing `lay_web` lays independent webs, periodic
    across the belt, and `predict_web` predicts their variation. Of a web it is
    ⟨(v d m − 1)²⟩ over all zones of the side x that begin at a pixel; 1/(v d) is the
    exact mean of the length density m, so that the average over webs has no bias but
    that of the step of their fibres. Webs are four of the largest zones long, and so
    wide that a fibre does not meet itself around them: the largest zone, ten throwing
    ranges and 32 positions at least.

    Parameters
    ----------
    potential : QuadraticPotential
    noises, belt_speeds, spacings : iterable of float
        A, v and d; every combination is one case. v must not vanish, d is a multiple
        of the pixel.
    relaxation_length : float, optional
        R of the smooth model; the basic model without it.
    zones : iterable of float
        Sides x of square zones, multiples of the pixel.
    positions : {"regular", "random"}
        Of the spinning positions.
    n_webs : int
        Independent webs of a case.
    pixel : float, optional
        By default the smallest zone.
    ds : float, optional
        Step of the fibres, as in `lay_web`.
    seed : int
    tolerance : float
        Of the prediction, relative.
    client, workers, directory, progress
        See `sweep`.

    Returns
    -------
    xarray.Dataset
        Over `noise`, `belt_speed`, `spacing` and `zone`: `predicted` and
        `predicted_error`, a bound; `simulated` and `standard_error` from the spread
        of the webs; `z`, the difference of both CV² over the root of the sum of their
        squared errors, which has Student's distribution with `n_webs` − 1 degrees
        of freedom where the prediction is exact and a web holds many zones. `status`,
        `message` and `seconds` by case. Attributes repeat the study.

    Raises
    ------
    ValueError, TypeError
        As `predict_web`, or if a zone or a spacing is no multiple of the pixel.
    RunInterrupted
        After Ctrl-C; `solution` is the Dataset of what was finished.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    axes = {
        "noise": np.unique(noises_of(noises)),
        "belt_speed": checked_speeds(belt_speeds),
        "spacing": checked_lengths("spacings", spacings),
    }
    for noise, speed in itertools.product(axes["noise"], axes["belt_speed"]):
        model = model_of(potential, float(noise), float(speed), relaxation_length)
        check_fibre(model)
    wide = max(scales_of(model))
    sides = np.unique(checked_zones(list(series_of(zones, "zones")), wide))
    check_one_of("positions", positions, POSITIONS)
    side = check_positive("pixel", float(sides[0]) if pixel is None else pixel)
    check_multiples("zones", sides, side)
    check_multiples("spacings", axes["spacing"], side)
    laid = Laid(
        tuple(map(float, sides)), positions,
        check_integer("n_webs", n_webs, at_least=2), side,
        None if ds is None else check_positive("ds", ds),
        check_integer("seed", seed, at_least=0), checked_tolerance(tolerance),
    )  # fmt: skip
    smooth = {}
    if relaxation_length is not None:
        length = check_positive("relaxation_length", relaxation_length)
        smooth = {"relaxation_length": length}
    cases = [
        {"potential": potential, "laid": laid, **smooth,
         **dict(zip(axes, map(float, place), strict=True))}
        for place in itertools.product(*axes.values())
    ]  # fmt: skip
    about = {
        "positions": positions, "n_webs": laid.n_webs, "pixel": side,
        "seed": str(laid.seed),
        "tolerance": laid.tolerance, **smooth,
        **({} if laid.ds is None else {"ds": laid.ds}),
    }  # fmt: skip

    def dataset(found: list[Case]) -> xr.Dataset:
        return homogeneity_dataset(potential, axes, sides, found, about)

    return swept(
        homogeneity_case, cases, dataset,
        client=client, workers=workers, directory=directory, progress=progress,
    )  # fmt: skip


def checked_speeds(speeds: Any) -> Array:
    """The belt speeds, ascending; ValueError unless all move."""
    listed = [check_real("belt_speeds", v) for v in series_of(speeds, "belt_speeds")]
    if not listed or not all(abs(speed) > 0 for speed in listed):
        raise ValueError(
            f"`belt_speeds` must hold speeds other than 0, got {listed}; on a belt at "
            "rest there is no web."
        )
    return np.unique(listed)


def checked_lengths(name: str, lengths: Any) -> Array:
    """Lengths, ascending; ValueError unless there are some, all positive."""
    listed = [check_positive(name, one) for one in series_of(lengths, name)]
    if not listed:
        raise ValueError(f"`{name}` must hold at least one, got none.")
    return np.unique(listed)


def check_multiples(name: str, lengths: Array, pixel: float) -> None:
    """ValueError unless every length is a whole number of pixels."""
    numbers = lengths / pixel
    whole = np.maximum(np.round(numbers), 1.0)
    wrong = ~(np.abs(numbers - whole) <= _ROUNDING * whole)
    if wrong.any():
        raise ValueError(
            f"`{name}` must be multiples of `pixel` = {pixel:g}, got "
            f"{lengths[wrong][0]:g}; choose other ones or smaller pixels."
        )
