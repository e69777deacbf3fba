"""The cases of the large-noise study: what one process computes for one noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fpsolve._support.arrays import Array
from fpsolve.density.error_laws import feature_width_of
from fpsolve.density.schemes import drift_kick
from fpsolve.density.smooth.marginal import without_curvature
from fpsolve.density.solve import solve
from fpsolve.density.steady_state import steady_state
from fpsolve.grids import diagnostics, initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.nodes import gibbs_nodes
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import GaussianLaw
from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit
from fpsolve.spectral.eigen.gap import spectral_gap
from fpsolve.spectral.evolution.steady import spectral_steady_state
from fpsolve.studies.constants.poincare import next_gap_term, poincare_constant
from fpsolve.studies.explained_grid import box_half_widths
from fpsolve.studies.limits.balance import balanced_force
from fpsolve.studies.limits.distances import distances
from fpsolve.studies.limits.plane_limit import stationary_limit, transient_limit
from fpsolve.studies.limits.smooth_runs import curved_grid, smooth_marginal

__all__ = ["PARTS", "Resolution", "deviation_of", "large_noise_case", "resolution_for"]

# A part of e^{−B} that no distance of this study can see.
_LOST = 1e-7
# Deviations of a Gaussian start that the box holds.
_DEVIATIONS = 5.5
# The comparison: cells and angles fewer by a quarter, steps longer by a half. Its
# error is several times that of the run, so that the difference bounds the latter.
_COARSER, _LONGER = 0.75, 1.5
# Relative accuracy of spectral gaps.
_GAP_TOLERANCE = 1e-11
# No two densities are further apart in L1.
_ANY_ERROR = 2.0
# Largest p0/p_S that is evolved as such.
_CONTRAST = 1e4
Numbers = dict[str, float]


@dataclass(frozen=True)
class Resolution:
    """Cells and step of the solver of the full equation.

    Attributes
    ----------
    grid : PhaseSpaceGrid
    turn : float
        A² ds: the square of the angle that the noise turns in a step.
    """

    grid: PhaseSpaceGrid
    turn: float

    def ds(self, noise: float) -> float:
        """ds = turn/A²: with it the steps to a slow time grow like A⁴."""
        return self.turn / noise**2

    def coarser(self) -> Resolution:
        """The discretisation that a run is compared with."""
        n1, n2, n_alpha = (4 * math.ceil(_COARSER * n / 4) for n in self.grid.shape)
        grid = PhaseSpaceGrid(self.grid.half_width, (n1, n2, n_alpha))
        return Resolution(grid, _LONGER * self.turn)


def resolution_for(
    potential: Potential,
    pull: float,
    law: GaussianLaw,
    cell: float,
    n_alpha: int,
    turn: float,
    factor: float = 1.0,
) -> Resolution:
    """A box for e^{−B} moved by the belt and for a start, with cells for its features.

    Parameters
    ----------
    potential : Potential
    pull : float
        w = v/ε; the belt is a force of this size.
    law : GaussianLaw
        Of the start.
    cell : float
        Cell width over that of the features, half the deviation of e^{−B}.
    n_alpha : int
    turn : float
    factor : float
        F, by which smooth fibres spread farther.
    """
    half1, half2 = (
        max(
            math.sqrt(factor) * half,
            abs(mean) + _DEVIATIONS * math.sqrt(law.variance[axis][axis]),
        )
        for axis, (half, mean) in enumerate(
            zip(_half_widths(potential, pull), law.mean, strict=True)
        )
    )
    width = cell * deviation_of(potential) / 2
    n1, n2 = (4 * math.ceil(half / (2 * width)) for half in (half1, half2))
    return Resolution(PhaseSpaceGrid((half1, half2), (n1, n2, n_alpha)), turn)


def deviation_of(potential: Potential) -> float:
    """The smaller standard deviation of e^{−B} along the axes."""
    if isinstance(potential, QuadraticPotential):
        return min(potential.sigma1, potential.sigma2)
    # Features are half as wide, with this much noise.
    return 2 * feature_width_of(gibbs_nodes(potential), 1.0)


def _half_widths(potential: Potential, pull: float) -> tuple[float, float]:
    """Where e^{−B + w|ξ1|} has fallen as far as e^{−B} at the edge of its box."""
    half1, half2 = box_half_widths(potential, _LOST)
    # On a belt B is tilted by wξ1, so that the box has to be longer along it.
    enough, reach = float(potential.value(half1, 0.0)), half1
    while float(potential.value(reach, 0.0)) - abs(pull) * reach < enough:
        reach *= 1.02
    return reach, half2


def large_noise_case(part: str, potential: Potential, **options: Any) -> Numbers:
    """One part of a study at one noise; see `PARTS`."""
    return dict(PARTS[part](potential, **options))


def transient_case(
    potential: Potential,
    noise: float,
    pull: float,
    law: GaussianLaw,
    slow_length: float,
    resolution: Resolution,
    bending: float = 0.0,
) -> Numbers:
    """Distances at s = slow_length/ε from a law, with the start corrected and not."""
    model = _model(potential, noise, pull, bending)
    fine, coarse = (
        _transient(model, law, slow_length * noise**2, one)
        for one in (resolution, resolution.coarser())
    )
    return _with_errors(fine, coarse)


def _transient(
    model: FibreModel, law: GaussianLaw, s: float, resolution: Resolution
) -> Numbers:
    grid = resolution.grid
    p0 = initial.gaussian(grid, law.mean, law.variance, law.angle, law.concentration)
    n_steps = math.ceil(s / resolution.ds(model.noise))
    p = _evolved(model, grid, p0, s, n_steps)
    limit = transient_limit(model, grid, law, s, corrected=True)
    if not law.concentration:
        return distances(p, limit, grid, model)
    layer = HydrodynamicLimit(model).initial_layer(p0, grid).density(s)
    as_given = transient_limit(model, grid, law, s, corrected=False)
    uncorrected = distances(p, as_given, grid, model)
    return {
        **distances(p, limit, grid, model, layer),
        **{f"{name}_uncorrected": one for name, one in uncorrected.items()},
    }


def _evolved(
    model: Any, grid: PhaseSpaceGrid, p0: Array, s: float, n_steps: int
) -> Array:
    """p(ξ, α) at s under the full equation."""
    if isinstance(model, SmoothLayDownModel):
        return smooth_marginal(model, grid, p0, s, n_steps)
    scheme = drift_kick(model, grid, balanced=_falls_like_equilibrium(p0, model, grid))
    return solve(
        scheme, p0, (0.0, s), s / n_steps, extrapolate=True, record_every=n_steps
    ).final


def _falls_like_equilibrium(
    p0: Array, model: LayDownModel, grid: PhaseSpaceGrid
) -> bool:
    """Whether p0/p_S is bounded well enough to be evolved; not for steep potentials."""
    reference = model.equilibrium(*grid.plane())
    return bool((p0.max(axis=2) <= _CONTRAST * reference).all())


def stationary_case(
    potential: Potential,
    noise: float,
    pull: float,
    resolution: Resolution,
    bending: float = 0.0,
) -> Numbers:
    """Distances of the stationary density on a belt with v = wε."""
    model = _model(potential, noise, pull, bending)
    fine, coarse = (
        _stationary(model, one) for one in (resolution, resolution.coarser())
    )
    return _with_errors(fine, coarse)


def _stationary(model: Any, resolution: Resolution) -> Numbers:
    grid, smooth = resolution.grid, isinstance(model, SmoothLayDownModel)
    found = steady_state(
        # A residual r leaves an error of about r over the gap, which is ~ ε. That of
        # the whole is told by the coarser resolution, distance by distance.
        model, curved_grid(model, grid) if smooth else grid,
        ds=resolution.ds(model.noise), extrapolate=True,
        tolerance=2e-6 * model.noise**-2, error_tolerance=_ANY_ERROR,
    )  # fmt: skip
    limit, p = stationary_limit(model, grid), without_curvature(found).density
    numbers = distances(p, limit, grid, model)
    if isinstance(model.potential, QuadraticPotential):
        balanced = balanced_force(model.belt_speed, model.noise)
        mean = diagnostics.moments(p, grid)["mean_xi1"]
        numbers["mean_balance"] = abs(mean - balanced * model.potential.sigma1**2)
    return numbers


def fixed_speed_case(
    potential: QuadraticPotential, noise: float, speed: float, tolerance: float
) -> Numbers:
    """E ξ1 at a speed that does not fall with the noise, by `spectral_steady_state`."""
    model = LayDownModel(potential, noise, MovingBelt(speed))
    found = spectral_steady_state(model, tolerance=tolerance)
    mean, error = found.moments["mean_xi1"], found.errors["mean_xi1"]
    linear = noise**2 * speed * potential.sigma1**2
    balanced = balanced_force(speed, noise) * potential.sigma1**2
    relative = error / abs(mean)
    return {
        "mean_linear": abs(linear / mean - 1),
        "mean_linear_error": relative,
        "mean_balance": abs(balanced / mean - 1),
        "mean_balance_error": relative,
        "value": mean,
    }


def gap_case(potential: Potential, noise: float) -> Numbers:
    """gap·A²/Λ against 1 and against 1 + cε²."""
    gap = spectral_gap(LayDownModel(potential, noise), tolerance=_GAP_TOLERANCE)
    poincare = poincare_constant(potential)
    excess = float(gap) * noise**2 / poincare - 1
    error = gap.error * noise**2 / poincare
    return {
        "gap": abs(excess),
        "gap_error": error,
        "next_term": abs(excess - next_gap_term(potential) * noise**-4),
        "next_term_error": error,
        "value": float(gap),
    }


def _model(
    potential: Potential, noise: float, pull: float, bending: float
) -> FibreModel:
    """The model with v = wε, a smooth one with R = 2aε for a > 0."""
    curve: Curve = MovingBelt(pull * noise**-2) if pull else FixedBelt()
    if bending:
        return SmoothLayDownModel(potential, 2 * bending * noise**-2, noise, curve)
    return LayDownModel(potential, noise, curve)


def _with_errors(fine: Numbers, coarse: Numbers) -> Numbers:
    """Every number, and as its error the change from the coarser discretisation."""
    errors = {f"{name}_error": abs(one - coarse[name]) for name, one in fine.items()}
    return {**fine, **errors}


# In the order in which they are computed: the long ones first.
PARTS: dict[str, Callable[..., Mapping[str, float]]] = {
    "stationary": stationary_case,
    "belt_directed": transient_case,
    "belt_uniform": transient_case,
    "rest_directed": transient_case,
    "rest_uniform": transient_case,
    "fixed_speed": fixed_speed_case,
    "gap": gap_case,
}
