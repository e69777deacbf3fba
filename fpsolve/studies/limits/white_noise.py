"""How smooth fibres approach the basic model as their relaxation length falls."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_integer,
    check_kind,
    check_positive,
    check_real,
)
from fpsolve._support.labels import to_json
from fpsolve.evolution.call import recorded
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves.belts import MovingBelt
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.smooth import SmoothLayDownModel, check_relaxation_length
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.arguments import chosen_parts, series_of
from fpsolve.studies.constants.poincare import require_confining
from fpsolve.studies.limits.large_noise import start_for
from fpsolve.studies.limits.large_noise_cases import resolution_for
from fpsolve.studies.limits.white_noise_cases import (
    WhiteNoiseResolution,
    possible_parts,
    white_noise_case,
)
from fpsolve.studies.limits.white_noise_dataset import white_noise_dataset
from fpsolve.studies.sweeps.study import swept
from fpsolve.studies.sweeps.sweep import Case, SweepProgress

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["white_noise_limit"]

# Half widths over those of e^{−B}.
_WIDER = 1.3


@dataclass(frozen=True)
class Settings:
    """How well both equations are resolved.

    Attributes
    ----------
    cell : float
        Cell width over that of the features, half the deviation of e^{−B}.
    n_alpha : int
        Angles.
    ds : float
        Longer step of the extrapolated runs.
    n_paths : int
    """

    cell: float = 0.8
    n_alpha: int = 16
    ds: float = 0.125
    n_paths: int = 20_000


QUICK = Settings(cell=1.0, n_alpha=12, ds=0.1875, n_paths=4_000)


@recorded()
def white_noise_limit(
    potential: Potential,
    noise: float,
    relaxation_lengths: Iterable[float],
    *,
    s_end: float = 1.5,
    belt_speed: float = 0.0,
    p0: GaussianLaw | None = None,
    n_paths: int | None = None,
    seed: int = 1,
    parts: Iterable[str] | None = None,
    quick: bool = False,
    client: Any = None,
    workers: int | None = None,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> xr.Dataset:
    """‖p − p_0‖, E‖ξ − ξ_0‖ and more against R at fixed A = RK, with their orders.

    - "density": p of (ξ, α) at s_end by `smooth_drift_kick`, against p_0 of the basic
      model by `drift_kick`, from one start, with κ from its Gaussian; all of order 1;
    - "paths": smooth and basic paths with the same Wiener process and κ = 0 at the
      start. β = α + Rκ obeys the basic equation but for the place of its force, so that
      ξ and β are of order 1, and α, which is off by Rκ, of order 1/2;
    - "gap", "variance": the spectral gap and the stationary Var ξ₁ against gap_0 and
      σ², of order 1, and what is left after R times their derivatives `gap_slope` and
      `variance_slope` (`next_term`), of order 2. For B = ‖ξ‖²/(2σ²) on a belt at rest.

    docs/limits.md derives the orders, for smooth B. A part that fails at one R leaves
    NaN and a message there, nothing else.

    Parameters
    ----------
    potential : Potential
        Confining.
    noise : float
        A = RK, the same for all R.
    relaxation_lengths : iterable of float
        R, positive.
    s_end : float
        Arclength at which both are compared, long against every R.
    belt_speed : float
        v.
    p0 : GaussianLaw, optional
        Start in (ξ, α); by default as in `large_noise_limit`.
    n_paths : int, optional
        By default 20 000, quick 4 000.
    seed : int
    parts : iterable of str, optional
        By default all that the model allows.
    quick : bool
        Coarser, for a look.
    client, workers, directory, progress
        See `sweep`.

    Returns
    -------
    xarray.Dataset
        Over `relaxation_length` and `quantity`, "part/measure": `distance`;
        `distance_error`, its change on coarser cells or with longer steps, and the
        standard error of paths; `observed_order` between neighbours;
        `expected_order`; `fitted_order` and its standard error over all distances above
        three times their errors. `status`, `message` and `seconds` by R and part.
        Attributes repeat the study.

    Raises
    ------
    ValueError, TypeError
        If the potential does not confine, or an option is unknown or out of range.
    RunInterrupted
        After Ctrl-C; `solution` is the Dataset of what was finished.

    References
    ----------
    [KMW09]_, section 3.2.
    """
    settings = QUICK if quick else Settings()
    amplitude = check_positive("noise", noise)
    lengths = checked_lengths(potential, relaxation_lengths)
    end = check_positive("s_end", s_end)
    speed = checked_speed(potential, amplitude, belt_speed)
    law: GaussianLaw = start_for(potential) if p0 is None else p0
    check_kind("p0", law, GaussianLaw, "both sides start from its formula")
    many = settings.n_paths if n_paths is None else n_paths
    n_paths = check_integer("n_paths", many, at_least=2)
    chosen = chosen_parts(parts, possible_parts(potential, speed), "study")
    resolution = resolution_of(potential, amplitude**2 * speed, law, settings)
    options: dict[str, dict[str, Any]] = {
        "density": {"law": law, "s_end": end, "resolution": resolution},
        "paths": {"law": law, "s_end": end, "n_paths": n_paths,
                  "seed": check_integer("seed", seed, at_least=0)},
        "gap": {}, "variance": {},
    }  # fmt: skip
    shared = {"potential": potential, "noise": amplitude, "belt_speed": speed}
    cases = [
        {"part": part, "relaxation_length": float(length), **shared, **options[part]}
        for part in chosen
        for length in lengths
    ]
    about = {
        "noise": amplitude, "s_end": end, "belt_speed": speed, "n_paths": n_paths,
        "seed": str(seed), "p0": to_json(law.to_dict()), "quick": int(quick),
    }  # fmt: skip

    def dataset(found: list[Case]) -> xr.Dataset:
        return white_noise_dataset(potential, lengths, chosen, found, about)

    return swept(
        white_noise_case, cases, dataset,
        client=client, workers=workers, directory=directory, progress=progress,
    )  # fmt: skip


def resolution_of(
    potential: Potential, pull: float, law: GaussianLaw, settings: Settings
) -> WhiteNoiseResolution:
    """A box that also holds a start which leaves e^{−B}, and fibres that do."""
    found = resolution_for(potential, pull, law, settings.cell, settings.n_alpha, 1.0)
    half1, half2 = found.grid.half_widths
    n1, n2 = (4 * math.ceil(_WIDER * n / 4) for n in found.grid.shape[:2])
    half_widths = _WIDER * half1, _WIDER * half2
    grid = PhaseSpaceGrid(half_widths, (n1, n2, settings.n_alpha))
    return WhiteNoiseResolution(grid, settings.ds)


def checked_lengths(potential: Potential, lengths: Any) -> Array:
    """The relaxation lengths, ascending; the potential must confine."""
    listed = [
        check_relaxation_length(one) for one in series_of(lengths, "relaxation_lengths")
    ]
    if not listed:
        raise ValueError("`relaxation_lengths` must hold at least one, got none.")
    # Says what is wrong with a potential that is none.
    SmoothLayDownModel(potential, listed[0], 1.0)
    require_confining(potential)
    return np.unique(listed)


def checked_speed(potential: Potential, noise: float, speed: Any) -> float:
    """v, if the fibre holds and stays on such a belt."""
    number = check_real("belt_speed", speed)
    if number:
        MovingBelt(number)
    SmoothLayDownModel(potential, 1.0, noise)
    return number
