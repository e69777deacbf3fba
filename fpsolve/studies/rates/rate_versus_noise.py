"""How fast the density converges, as a function of the noise: figure 5 and more."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_flag, check_kind, check_positive
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.spectral.eigen.settings import check_tolerance
from fpsolve.studies.arguments import chosen_parts, noises_of
from fpsolve.studies.constants.poincare import poincare_constant, require_confining
from fpsolve.studies.observables import Observable, functions_of
from fpsolve.studies.rates.bounds import NO_DECAY
from fpsolve.studies.rates.cases import PARTS, rate_case
from fpsolve.studies.rates.dataset import rates_dataset
from fpsolve.studies.sweeps.study import swept
from fpsolve.studies.sweeps.sweep import Case, SweepProgress

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["DEFAULT_START", "Settings", "rate_versus_noise"]

# The start of the examples: off the centre, half as wide as the equilibrium, upwards.
DEFAULT_START = GaussianLaw((1.5, 0.0), 0.25, np.pi / 2, 4.0)
# H of a winding density needs ever larger bases below this noise.
_EVOLUTION_NOISE = 0.5


@dataclass(frozen=True)
class Settings:
    """How accurate a study is.

    Attributes
    ----------
    run : float
        L1 error that cells and steps of the runs aim at, before extrapolation.
    e_folds : float
        The runs go on until H has fallen by about exp(-e_folds).
    gap, branches, variance : float
        Relative tolerances of spectral gaps, of the other eigenvalues, and of
        asymptotic variances.
    evolution : float
        Tolerance of `spectral_solve`.
    """

    run: float = 2e-2
    e_folds: float = 14.0
    gap: float = 1e-8
    branches: float = 1e-3
    variance: float = 1e-6
    evolution: float = 1e-3


QUICK = Settings(
    run=1e-1, e_folds=9.0, gap=1e-6, branches=1e-2, variance=1e-3, evolution=1e-2
)


@recorded()
def rate_versus_noise(
    potential: Potential,
    noises: Iterable[float],
    *,
    p0: GaussianLaw | None = None,
    quick: bool = False,
    parts: Iterable[str] | None = None,
    functions: Mapping[str, Observable] | None = None,
    tolerance: float | None = None,
    s_end: float | None = None,
    client: Any = None,
    workers: int | None = None,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> xr.Dataset:
    """Decay rate of the density against the noise A, measured, computed and bounded.

    For every noise, on a fixed belt:

    - "relaxation": ∫₀^S H ds of figure 5 and the asymptotic decay rate of H, from
      extrapolated runs of `drift_kick`;
    - "evolution": the same integral by `spectral_solve` (quadratic B, A ≥ 0.5);
    - "gap" and "branches": the spectral gap, and the leading eigenvalues by sector;
    - "variance": −2⟨f, L⁻¹f⟩ of averages, over Var f;
    - the bounds and asymptotes of `fpsolve.studies.rates.bounds`.

    A part that fails at one noise leaves NaN and a message there, nothing else.

    Parameters
    ----------
    potential : Potential
        Isotropic or quadratic, with normalisable exp(-B).
    noises : iterable of float
        Noise amplitudes A, positive.
    p0 : GaussianLaw, optional
        Start of the runs; by default mean (1.5, 0), variance 1/4, angle π/2 with
        concentration 4. It changes the integral, not the rate.
    quick : bool
        Coarser and shorter: seconds instead of minutes.
    parts : iterable of str, optional
        By default all.
    functions : mapping of str to callable, optional
        f(xi1, xi2, alpha) to average; by default `default_observables`.
    tolerance : float, optional
        Relative tolerance of the spectral gap, instead of 1e-8 (quick 1e-6).
    s_end : float, optional
        S of the integral; by default as long as H takes to fall by e^{−14} (quick
        e^{−9}) at a rate expected from the asymptotes.
    client, workers, directory, progress
        See `sweep`.

    Returns
    -------
    xarray.Dataset
        Over `noise`, and with `function`, `sector` and `mode` where needed. `status`,
        `message` and `seconds` by noise and part. Attributes repeat the study.

    Raises
    ------
    ValueError, TypeError
        If the potential does not confine or has no basis, a noise is not positive, or
        an option is unknown.
    RunInterrupted
        After Ctrl-C; `solution` is the Dataset of what was finished.

    References
    ----------
    [KMW09]_, section 3.1.1, figure 5 and theorem 3.3.
    """
    amplitudes = _checked(potential, noises)
    quick = check_flag("quick", quick)
    if s_end is not None:
        s_end = check_positive("s_end", s_end)
    functions = functions_of(functions, potential)
    p0 = DEFAULT_START if p0 is None else p0
    check_kind("p0", p0, GaussianLaw, "every noise has its own grid")
    settings = QUICK if quick else Settings()
    gap = settings.gap if tolerance is None else check_tolerance(tolerance)
    chosen = chosen_parts(parts, possible_parts(potential), "potential")
    options = _options(p0, functions, settings, gap, s_end)
    cases = [
        {"part": part, "potential": potential, "noise": float(noise), **options[part]}
        for part in chosen
        for noise in amplitudes
        if part != "evolution" or noise >= _EVOLUTION_NOISE
    ]
    about = {
        "p0": p0, "quick": quick, "settings": vars(settings) | {"gap": gap},
        "functions": list(functions),
    }  # fmt: skip

    def dataset(found: list[Case]) -> xr.Dataset:
        return rates_dataset(potential, amplitudes, found, about)

    return swept(
        rate_case, cases, dataset,
        client=client, workers=workers, directory=directory, progress=progress,
    )  # fmt: skip


def _options(
    law: GaussianLaw,
    functions: dict[str, Observable],
    settings: Settings,
    gap: float,
    s_end: float | None,
) -> dict[str, dict[str, Any]]:
    """Arguments of every part besides potential and noise."""
    run = {"law": law, "e_folds": settings.e_folds, "s_end": s_end}
    return {
        "relaxation": {**run, "tolerance": settings.run},
        "evolution": {
            **run, "tolerance": settings.evolution, "grid_tolerance": settings.run,
        },
        "branches": {"tolerance": settings.branches},
        "gap": {"tolerance": gap},
        "variance": {"tolerance": settings.variance, "functions": functions},
    }  # fmt: skip


def _checked(potential: Potential, noises: Iterable[float]) -> Array:
    """The noises, ascending; the potential must have a rate at all."""
    # Says what is wrong with a potential that is none.
    LayDownModel(potential, 1.0)
    require_confining(potential)
    poincare_constant(potential)
    return np.unique(noises_of(noises, NO_DECAY))


def possible_parts(potential: Potential) -> list[str]:
    """The parts of a study; a density evolves in a basis for quadratic B only."""
    quadratic = isinstance(potential, QuadraticPotential)
    return [part for part in PARTS if part != "evolution" or quadratic]
