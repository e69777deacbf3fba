"""The small-noise limit: law of G under the full equation and under (16)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import (
    check_finite,
    check_integer,
    check_kind,
    check_positive,
)
from fpsolve.evolution.call import recorded
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.studies.arguments import noises_of, series_of
from fpsolve.studies.limits.small_noise_case import small_noise_case
from fpsolve.studies.limits.small_noise_dataset import small_noise_dataset
from fpsolve.studies.sweeps.study import swept
from fpsolve.studies.sweeps.sweep import Case, SweepProgress

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["small_noise_limit"]

# Errors of a cell accumulate over a length of order A⁻² and fall with its eighth
# power.
_REFERENCE_NOISE, _POWER = 0.2, 0.25


@dataclass(frozen=True)
class Settings:
    """How accurate a study is.

    Attributes
    ----------
    cell : float
        Width of the ξ cells over the radius of the circle at A = 0.2.
    ds : float
        Longer step of the extrapolated runs.
    n_paths : int
    """

    cell: float = 0.12
    ds: float = 0.125
    n_paths: int = 1_000_000

    def spacing(self, noise: float) -> float:
        """Width of the cells at a noise."""
        finer: float = min(1.0, noise / _REFERENCE_NOISE) ** _POWER
        return self.cell * finer


QUICK = Settings(cell=0.16, ds=0.25, n_paths=100_000)


@recorded()
def small_noise_limit(
    potential: Potential,
    noises: Iterable[float],
    *,
    slow_length: float = 1.0,
    belt_speed_scales: Iterable[float] = (0.0, 0.3),
    p0: GaussianLaw | None = None,
    quick: bool = False,
    ds: float | None = None,
    n_paths: int | None = None,
    seed: int = 1,
    client: Any = None,
    workers: int | None = 0,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> xr.Dataset:
    """Distance between the law of G at A² s = const. and that of the averaged (16).

    For every noise and every v = w A²: the full equation by `drift_kick`, extrapolated
    in the step and on two grids; paths, with their standard errors; the averaged
    equation by finite volumes, begun with the law of G of the same start. Laws are
    compared through twelve B-splines (`SmoothedLaw`).

    The distance falls like ε = A²: the first correction to a function of G solves a
    problem on the orbit, and is averaged over the start. It is odd under β → π - β, so
    that a start which is symmetric under it sees the next order only. Modes that
    oscillate with the orbits decay at 0.128 per unit of s at A = 0.4 and at 0.142 at
    A = 0.3 (quadratic B): at A² s = 1 they are gone from A = 0.2 on, not before.

    Parameters
    ----------
    potential : Potential
        Isotropic, with a single well.
    noises : iterable of float
        Noise amplitudes A, positive.
    slow_length : float
        A² s, at which the laws are compared.
    belt_speed_scales : iterable of float
        w = v/A². The limit does not depend on it.
    p0 : GaussianLaw, optional
        Start; by default one beside the circle, heading outwards at π/4.
    quick : bool
        Coarser cells, fewer paths.
    ds : float, optional
        Longer step of the extrapolated runs; by default 1/8, quick 1/4.
    n_paths : int, optional
        Paths for every case; 0 for none. By default a million, quick 100 000.
    seed : int
    client, workers, directory, progress
        See `fpsolve.studies.sweep`; by default in this process.

    Returns
    -------
    xarray.Dataset
        Over `belt_speed_scale`, `noise` and `function`. `distance` and its
        `observed_order` in ε, `distance_error` (of the cells), `mean` and `exact_mean`
        of G, `paths_distance` beside what chance makes of it, `paths_z` (largest
        deviation of paths from the solver in standard errors).

    Raises
    ------
    ValueError, TypeError
        If the potential has no energy process, or an option does not fit.
    RunInterrupted
        After Ctrl-C; `solution` is the Dataset of what was finished.

    References
    ----------
    [KMW09]_, section 3.1.2, equations (13) to (16).
    """
    # Says what is wrong with a potential that has no orbits.
    EnergyProcess(potential, 1.0)
    # Descending: the limit is at the end.
    amplitudes = np.unique(noises_of(noises))[::-1]
    speeds = series_of(belt_speed_scales, "belt_speed_scales")
    scales = np.array([check_finite("belt_speed_scales", w) for w in speeds])
    p0 = _default_start(potential) if p0 is None else p0
    check_kind("p0", p0, GaussianLaw, "its law of G is computed along the orbits")
    settings = QUICK if quick else Settings()
    ds = settings.ds if ds is None else ds
    n_paths = settings.n_paths if n_paths is None else n_paths
    options = {
        "law": p0,
        "slow_length": check_positive("slow_length", slow_length),
        "ds": check_positive("ds", ds),
        "n_paths": check_integer("n_paths", n_paths, at_least=0),
        "seed": check_integer("seed", seed, at_least=0),
    }
    cases = [
        {
            "potential": potential, "noise": float(noise), "belt_speed_scale": float(w),
            "spacing": settings.spacing(float(noise)), **options,
        }
        for w in scales
        for noise in amplitudes
    ]  # fmt: skip

    def dataset(found: list[Case]) -> xr.Dataset:
        return small_noise_dataset(potential, scales, amplitudes, found, options)

    return swept(
        small_noise_case, cases, dataset,
        client=client, workers=workers, directory=directory, progress=progress,
    )  # fmt: skip


def _default_start(potential: Potential) -> GaussianLaw:
    radius = EnergyProcess(potential, 1.0).radius
    return GaussianLaw((radius, 0.0), 0.3 * radius**2, np.pi / 4, 2.0)
