"""Which basis discretises the generator of a model."""

from __future__ import annotations

import math

import numpy as np

from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import check_model
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Discretisation
from fpsolve.spectral.bases.smooth import SmoothDiscretisation
from fpsolve.spectral.bases.tensor import TensorDiscretisation
from fpsolve.spectral.bases.weights import quadratic

__all__ = ["check_resolved", "discretisation_for", "orbit_radius"]

# A √R, R the radius of the circular orbit. Below it rates are lost in the rounding of
# the frequencies, above it the other way round, and no basis that fits helps.
QUIETEST, LOUDEST = 1e-3, 1e6
# a = A²R/2 of a smooth fibre: its curvature needs a functions more.
LARGEST_LOUDNESS = 200.0
# Radii at which a circular orbit is looked for: first, and in units far from usual.
_USUAL, _SHORTEST = (1e-9, 1e9), 1e-76


def discretisation_for(model: FibreModel) -> Discretisation:
    """The basis for the generator of a model.

    Raises
    ------
    TypeError
        If `model` is neither a LayDownModel nor a SmoothLayDownModel.
    ValueError
        If the model has no gap (no noise, no confinement, no autonomous curve) or no
        basis (a potential neither isotropic nor quadratic, a belt under another).
    """
    if isinstance(model, SmoothLayDownModel):
        return smooth_discretisation_for(model)
    check(model)
    potential, noise = model.potential, model.noise
    if isinstance(potential, QuadraticPotential):
        if potential.isotropic and model.curve.fixed:
            return HermiteDiscretisation(potential.sigma1, noise)
        belt_speed = -float(model.curve.velocity(0.0)[0])
        return TensorDiscretisation(
            potential.sigma1, potential.sigma2, noise, belt_speed
        )
    if not potential.isotropic:
        raise ValueError(
            f"`potential` must be isotropic or quadratic, got {potential!r}; for "
            "others fit the decay of a run of `solve`."
        )
    if not model.curve.fixed:
        raise ValueError(
            f"`potential` must be quadratic on a moving belt, got {potential!r}; for "
            "others fit the decay of a run of `solve`."
        )
    from fpsolve.spectral.bases.radial import RadialDiscretisation

    return RadialDiscretisation(potential, noise)


def smooth_discretisation_for(model: SmoothLayDownModel) -> SmoothDiscretisation:
    """The basis for the generator of (23); ValueError where there is none."""
    from fpsolve.spectral.bases.body_frame import BodyFrameDiscretisation

    check(model)
    potential = quadratic(model)
    a = Persistence.of(model).bending
    if not a <= LARGEST_LOUDNESS:
        highest = math.sqrt(2 * LARGEST_LOUDNESS / model.relaxation_length)
        raise ValueError(
            f"`noise` must be at most {highest:.3g} for the spectrum of a fibre with "
            f"this relaxation length, got {model.noise:g}: A²R/2 is {a:.3g}, and the "
            "fibre circles. The limit of large noise is near, HydrodynamicLimit."
        )
    if potential.isotropic and model.curve.fixed:
        return BodyFrameDiscretisation(model)
    from fpsolve.spectral.bases.placing import coupled_discretisation

    return coupled_discretisation(model)


def check(model: FibreModel) -> None:
    """Raise unless the model has a stationary density that it forgets its start for."""
    if not isinstance(model, SmoothLayDownModel):
        check_model(model)
    if not model.noise > 0:
        raise ValueError(
            "`noise` must be positive, got 0; without noise the orbits of different "
            "energy never mix and there is no gap."
        )
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}: exp(-B) has no "
            "finite integral."
        )
    if not (model.curve.autonomous and model.curve.velocity(0.0)[1] == 0):
        raise ValueError(
            "`curve` must be a belt at rest or at constant speed, got "
            f"{model.curve!r}; under a moving nozzle there is no spectrum to speak of."
        )


def check_resolved(model: FibreModel) -> None:
    """Raise ValueError where rates and frequencies differ by more than rounding."""
    radius = orbit_radius(model.potential)
    scaled = model.noise * math.sqrt(radius)
    if math.isfinite(radius) and not scaled >= QUIETEST:
        raise ValueError(
            f"`noise` must be at least {QUIETEST / math.sqrt(radius):.3g} for the "
            f"spectrum of this potential, got {model.noise:g}; its rates are lost in "
            "the rounding of the frequencies of the orbits. See EnergyProcess."
        )
    exact = isinstance(model.potential, QuadraticPotential) and model.curve.fixed
    if math.isfinite(radius) and not (scaled <= LOUDEST or exact):
        raise ValueError(
            f"`noise` must be at most {LOUDEST / math.sqrt(radius):.3g} for the "
            f"spectrum of this potential, got {model.noise:g}; its rates are lost in "
            "the rounding of those of the angle. See HydrodynamicLimit."
        )


def orbit_radius(potential: Potential) -> float:
    """Radius of the circular orbit, r B'(r) = 1: the length scale of the model.

    For a quadratic potential the smaller throwing range.
    """
    if isinstance(potential, QuadraticPotential):
        return min(potential.sigma1, potential.sigma2)
    radius = _first_turning(potential, *_USUAL)
    if radius == _USUAL[0]:
        return _first_turning(potential, _SHORTEST, _USUAL[0])
    if math.isinf(radius):
        return _first_turning(potential, _USUAL[1], 1 / _SHORTEST)
    return radius


def _first_turning(potential: Potential, shortest: float, longest: float) -> float:
    """The first of two hundred radii a decade with r B'(r) ≥ 1."""
    n = round(200 * math.log10(longest / shortest)) + 1
    radii = np.geomspace(shortest, longest, n)
    with np.errstate(over="ignore", invalid="ignore"):
        turning = radii * potential.radial_derivative(radii)
    beyond = np.flatnonzero(~(turning < 1))
    return float(radii[beyond[0]]) if beyond.size else math.inf
