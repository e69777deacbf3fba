"""How the full equation approaches its hydrodynamic limit as the noise grows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_finite,
    check_kind,
    check_non_negative,
    check_positive,
)
from fpsolve._support.labels import to_json
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.reduced.hydrodynamic.effective_potential import (
    EffectivePotential,
    slope_of,
)
from fpsolve.studies.arguments import chosen_parts, noises_of
from fpsolve.studies.constants.poincare import require_confining
from fpsolve.studies.limits.large_noise_cases import (
    PARTS,
    deviation_of,
    large_noise_case,
)
from fpsolve.studies.limits.large_noise_dataset import large_noise_dataset
from fpsolve.studies.limits.large_noise_settings import options_of, settings_of
from fpsolve.studies.sweeps.study import swept
from fpsolve.studies.sweeps.sweep import Case, SweepProgress

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["LARGE_NOISE_START", "large_noise_limit", "start_for"]

# Off the centre, narrower than the equilibrium, and in a direction of its own; for
# e^{−B} of deviation one.
LARGE_NOISE_START = GaussianLaw((0.8, -0.4), 0.3, 0.6, 2.0)


@recorded()
def large_noise_limit(
    potential: Potential,
    noises: Iterable[float],
    *,
    slow_length: float = 1.25,
    belt_speed_scale: float = 0.5,
    fixed_speed: float = 0.3,
    bending: float = 0.0,
    p0: GaussianLaw | None = None,
    parts: Iterable[str] | None = None,
    quick: bool = False,
    client: Any = None,
    workers: int | None = None,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> xr.Dataset:
    """‖p − 𝒫/2π‖ and more against ε = A⁻² at fixed slow time εs, with their orders.

    - "rest_uniform", "rest_directed": transients at s = slow_length/ε on a belt at
      rest, from a start uniform in α and from one with a direction;
    - "belt_uniform", "belt_directed": the same with v = wε, w = `belt_speed_scale`;
    - "stationary": the stationary density with v = wε (with v = 0 it is exact);
    - "fixed_speed": E ξ1 at v = `fixed_speed`, against A²v and against the von Mises
      balance (quadratic B);
    - "gap": gap·A² against Λ and against Λ(1 + cε²) (isotropic or quadratic B).

    The full equation is solved by `drift_kick`, extrapolated in ds, and by
    `steady_state`; the limit is exact for quadratic B and by
    `HydrodynamicLimit.solve` otherwise. docs/limits.md derives the orders, for smooth
    B. A part that fails at one noise leaves NaN and a message there, nothing else.

    Parameters
    ----------
    potential : Potential
        Confining.
    noises : iterable of float
        Noise amplitudes A, positive. Steps of a run grow like A⁴.
    slow_length : float
        εs of the transients. The layer leaves e^{−slow_length/2ε²}.
    belt_speed_scale : float
        w; 0 leaves the parts with a belt out.
    fixed_speed : float
        Between 0 and 1.
    bending : float
        a = A²R/2 of smooth fibres, the same at every noise; 0 for the basic model. The
        orders are the same, but e^{−B} is not stationary at rest: "stationary" is there
        without a belt, too, and "fixed_speed" and "gap" are not.
    p0 : GaussianLaw, optional
        Start of the transients, with a concentration; by default mean (0.8, −0.4) d,
        variance 0.3 d², d the smaller deviation of e^{−B}, angle 0.6 with
        concentration 2. Uniform starts share its plane density.
    parts : iterable of str, optional
        By default all that the potential allows.
    quick : bool
        Coarser, for a look.
    client, workers, directory, progress
        See `sweep`.

    Returns
    -------
    xarray.Dataset
        Over `noise` (with `epsilon`) and `quantity`, "part/measure": `distance`;
        `distance_error`, its change on coarser cells with longer steps, an upper
        estimate of what the solver adds; `observed_order` between neighbours;
        `expected_order`, NaN for what is exact; `fitted_order` and its standard error
        over all distances above three times their errors. `status`, `message` and
        `seconds` by noise and part. Attributes repeat the study.

    Raises
    ------
    ValueError, TypeError
        If the potential does not confine, on the belt either, or an option is
        unknown or not positive.
    RunInterrupted
        After Ctrl-C; `solution` is the Dataset of what was finished.

    References
    ----------
    [KMW09]_, section 3.1.2; [BGKMW08]_.
    """
    amplitudes = checked_noises(potential, noises)
    pull = checked_pull(potential, belt_speed_scale, amplitudes)
    curved = check_non_negative("bending", bending)
    possible = possible_parts(potential, pull, curved)
    chosen = chosen_parts(parts, possible, "potential and belt")
    law: GaussianLaw = start_for(potential) if p0 is None else p0
    check_law(law)
    options = options_of(
        potential,
        pull,
        law,
        check_positive("slow_length", slow_length),
        checked_speed(fixed_speed),
        settings_of(quick, curved),
        curved,
    )
    cases = [
        {"part": part, "potential": potential, "noise": float(noise), **options[part]}
        for part in chosen
        for noise in amplitudes[::-1]
    ]
    about = {
        "slow_length": float(slow_length), "belt_speed_scale": pull,
        "fixed_speed": float(fixed_speed), "bending": curved,
        "p0": to_json(law.to_dict()), "quick": int(quick),
    }  # fmt: skip

    def dataset(found: list[Case]) -> xr.Dataset:
        return large_noise_dataset(potential, amplitudes, chosen, found, about)

    return swept(
        large_noise_case, cases, dataset,
        client=client, workers=workers, directory=directory, progress=progress,
    )  # fmt: skip


def start_for(potential: Potential) -> GaussianLaw:
    """`LARGE_NOISE_START` in units of the smaller deviation of e^{−B}."""
    unit = deviation_of(potential)
    mean1, mean2 = (unit * component for component in LARGE_NOISE_START.mean)
    variance = unit**2 * np.array(LARGE_NOISE_START.variance)
    return replace(LARGE_NOISE_START, mean=(mean1, mean2), variance=variance)


def checked_noises(potential: Potential, noises: Iterable[float]) -> Array:
    """The noises, ascending; the potential must have an equilibrium at all."""
    # Says what is wrong with a potential that is none.
    LayDownModel(potential, 1.0)
    require_confining(potential)
    return np.unique(noises_of(noises))


def checked_pull(potential: Potential, scale: Any, amplitudes: Array) -> float:
    """w = v/ε, if every speed wε is below one and e^{−B + wξ1} confines."""
    pull = check_finite("belt_speed_scale", scale)
    largest = float(amplitudes[0] ** 2)
    if not abs(pull) < largest:
        raise ValueError(
            f"`belt_speed_scale` must be below A² = {largest:g} of the least noise, so "
            f"that |v| < 1, got {pull:g}."
        )
    if pull and not EffectivePotential(potential, pull).normalisable:
        slope = slope_of(potential)
        limit = "" if slope is None else f", below K = {slope:g}"
        raise ValueError(
            "`belt_speed_scale` must be small enough for exp(-B + wξ1) to be "
            f"integrable{limit}, got {pull:g}."
        )
    return pull


def checked_speed(speed: Any) -> float:
    """The fixed speed, between 0 and 1."""
    number = check_positive("fixed_speed", speed)
    if not number < 1:
        raise ValueError(
            f"`fixed_speed` must be below 1, got {number:g}; a faster belt tears the "
            "fibre."
        )
    return number


def check_law(p0: GaussianLaw) -> None:
    """Raise unless the start has a direction, for the parts that are about it."""
    check_kind("p0", p0, GaussianLaw, "both sides start from its formula")
    if not p0.concentration > 0:
        raise ValueError(
            "`p0` must have a positive concentration, got 0; the parts with a uniform "
            "start leave it out by themselves."
        )


def possible_parts(potential: Potential, pull: float, bending: float) -> list[str]:
    """The parts of a study that potential, belt and curvature allow."""
    quadratic = isinstance(potential, QuadraticPotential)
    return [
        part
        for part in PARTS
        if (pull or part not in ("belt_directed", "belt_uniform"))
        # Without belt and curvature it is that of the limit.
        and (pull or bending or part != "stationary")
        and ((quadratic and not bending) or part != "fixed_speed")
        and (((quadratic or potential.isotropic) and not bending) or part != "gap")
    ]
