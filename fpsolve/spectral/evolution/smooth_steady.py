"""The stationary density of a smooth fibre: a null vector of the transposed matrix."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.evolution.call import Call
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid, check_smooth_grid
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.choice import smooth_discretisation_for
from fpsolve.spectral.bases.coupled import CoupledDiscretisation
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.bases.smooth import SmoothDiscretisation
from fpsolve.spectral.bases.weights import quadratic
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse
from fpsolve.spectral.eigen.following import slowness
from fpsolve.spectral.evolution.coupled_steady import REMEDY, Refinement
from fpsolve.spectral.evolution.smooth_layout import SMOOTH_STEADY
from fpsolve.spectral.evolution.stationary_density import StationaryDensity
from fpsolve.spectral.work import DEFAULT_WORK, Work

__all__ = ["SmoothSpectralSteadyState", "smooth_steady_state"]

# Beside the eigenvalue 0, relative to 1/σ1, so that the matrix is not singular.
SHIFT = 1e-8
# Steps of inverse iteration: each leaves 1e-8 of the other modes, or in a truncation
# with an eigenvalue ε instead of 0 the share ε of them.
STEPS = 4
# Changes may pass through 0 where convergence alternates: this share of the one before
# counts, too.
BEFORE = 0.25
ROUNDING = 1e-14
# Where no tolerance is given: what is aimed at, and on belts, where it may cost too
# much, what must be reached.
TOLERANCE, LARGEST = 1e-8, 1e-3
# Bytes for every entry that `factor_entries` expects in ±M: M = 0 has half of them, and
# what is left, 5 on 2100 to 80 000 functions, holds room to find them.
BYTES = 6.5


@dataclass(frozen=True, eq=False)
class SmoothSpectralSteadyState(StationaryDensity):
    """A density of (ξ, α, κ) with L* p = 0, its moments and how well they are known.

    It is no product: e^{-B} times a Gaussian in κ is *not* stationary. On a belt at
    rest E κ² = A²/(2R) + 1/σ² and E (ξ·τ⊥)κ = -1 exactly, and Var ξ is larger than
    that of the basic model.

    Attributes
    ----------
    model : SmoothLayDownModel
    moments : dict of float
        E ξ, the covariance of ξ, E cos α, E sin α, E κ and E κ².
    errors : dict of float
        Of each moment, from its changes in the last three truncations.
    residual : float
        ‖L* p‖/‖p‖ in the space of coefficients, in the next larger basis, which holds
        L* p exactly. The moments are known far better.
    truncation : Truncation
        Degree in ξ, largest harmonic of α and degree in κ.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "smooth-spectral-steady-state"
    layout = SMOOTH_STEADY

    model: SmoothLayDownModel
    moments: dict[str, float]
    errors: dict[str, float]
    residual: float
    truncation: Truncation
    _vector: Array = field(repr=False)
    _coarser: tuple[Array, Truncation] = field(repr=False)
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        variance, square = self.moments["variance_xi1"], self.moments["mean_kappa2"]
        return (
            f"SmoothSpectralSteadyState(Var ξ1 = {variance:.6g}, E κ² = {square:.6g}, "
            f"largest error {max(self.errors.values()):.1e}, residual "
            f"{self.residual:.1e}, degree {self.truncation.degree} in ξ and "
            f"{self.truncation.curvature} in κ)"
        )

    def _density_and_error(self, grid: SmoothPhaseSpaceGrid) -> tuple[Array, float]:
        check_smooth_grid(grid)
        basis = smooth_discretisation_for(self.model)
        both = (self._vector, self.truncation), self._coarser
        p, q = (
            basis.dual_values(vector, basis.stationary_sector, truncation, grid).real
            for vector, truncation in both
        )
        error = float(np.abs(p - q).sum()) * grid.cell_volume
        return np.ascontiguousarray(p), error + ROUNDING


@dataclass(frozen=True)
class Estimate:
    """The stationary density in one truncation, of mass one."""

    truncation: Truncation
    vector: Array
    moments: dict[str, float]

    @classmethod
    def of(cls, basis: SmoothDiscretisation, truncation: Truncation) -> Estimate:
        """The null vector by inverse iteration."""
        vector = null_vector(basis, truncation)
        moments = basis.stationary_moments(vector, truncation)
        return cls(truncation, vector / moments.pop("mass"), moments)

    def change(self, before: Estimate, name: str) -> float:
        """By how much a moment differs."""
        return abs(self.moments[name] - before.moments[name])


def smooth_steady_state(
    model: SmoothLayDownModel, tolerance: float | None, memory_limit: float
) -> SmoothSpectralSteadyState:
    """See `spectral_steady_state`."""
    basis = smooth_discretisation_for(model)
    if isinstance(basis, CoupledDiscretisation):
        return coupled_steady_state(basis, tolerance, memory_limit)
    return round_steady_state(basis, tolerance, memory_limit)


def coupled_steady_state(
    basis: CoupledDiscretisation, tolerance: float | None, memory_limit: float
) -> SmoothSpectralSteadyState:
    """On a belt, or about unequal throwing ranges: what is reached, if it is enough."""
    aim, largest = (TOLERANCE, LARGEST) if tolerance is None else (tolerance, tolerance)
    known = Refinement(basis, aim, memory_limit, Work(DEFAULT_WORK)).run()
    if known is None or not (known.settled and known.relative <= largest):
        reached = math.inf if known is None else known.relative
        raise ToleranceError(reached, largest, REMEDY)
    estimates = [
        Estimate(truncation, vector, known.moments) for vector, truncation in known.both
    ]
    return result(basis.model, basis, estimates, known.errors)


def round_steady_state(
    basis: SmoothDiscretisation, tolerance: float | None, memory_limit: float
) -> SmoothSpectralSteadyState:
    """Of a round potential on a belt at rest, to the tolerance."""
    aim, largest = (TOLERANCE, LARGEST) if tolerance is None else (tolerance, tolerance)
    model = basis.model
    known: list[Estimate] = []
    errors: dict[str, float] = {}
    reached = math.inf
    for level in itertools.count():
        truncation = basis.truncation(level)
        if required(basis, truncation) > memory_limit:
            if reached <= largest:
                return result(model, basis, known, errors)
            raise ToleranceError(reached, largest, remedy(model))
        known.append(Estimate.of(basis, truncation))
        if len(known) > 2:
            errors = errors_of(*known[-3:])
            reached = max(
                error / max(1.0, abs(known[-1].moments[name]))
                for name, error in errors.items()
            )
            if reached <= aim:
                return result(model, basis, known, errors)
    raise AssertionError("the levels end")


def result(
    model: SmoothLayDownModel,
    basis: SmoothDiscretisation,
    known: list[Estimate],
    errors: dict[str, float],
) -> SmoothSpectralSteadyState:
    """The last of the estimates with its errors."""
    coarse, fine = known[-2:]
    residual = residual_norm(basis, fine)
    return SmoothSpectralSteadyState(
        model, fine.moments, errors, residual, fine.truncation, fine.vector,
        (coarse.vector, coarse.truncation),
    )  # fmt: skip


def required(basis: SmoothDiscretisation, truncation: Truncation) -> float:
    """Bytes of the factors in the stationary sector."""
    entries = basis.factor_entries(truncation)
    assert entries is not None
    size = basis.size(basis.stationary_sector, truncation)
    return BYTES * entries + 1e3 * size


def null_vector(basis: SmoothDiscretisation, truncation: Truncation) -> Array:
    """The vector that the transposed matrix takes to 0, or nearly: unit norm.

    Inverse iteration from a fixed start, so that equal arguments give equal results.
    """
    matrix = basis.matrix(basis.stationary_sector, *truncation).T.tocsc()
    shift = SHIFT / quadratic(basis.model).sigma1
    inverse = ShiftedInverse(matrix, shift, None, basis.ordering)
    vector: Array = np.random.default_rng(0).standard_normal(inverse.size)
    for _ in range(STEPS):
        vector = inverse.operator.matvec(vector)
        vector /= np.linalg.norm(vector)
    return vector


def errors_of(first: Estimate, second: Estimate, last: Estimate) -> dict[str, float]:
    """Error of every moment of the last of three truncations.

    The last change times what is still to come if the changes fall slowly, a share of
    the change before it where that is larger, and rounding.
    """
    errors = {}
    for name, value in last.moments.items():
        before, after = second.change(first, name), last.change(second, name)
        change = max(after, BEFORE * before)
        error = change * slowness(change, before) if change else 0.0
        errors[name] = error + (ROUNDING * max(1.0, abs(value)) if value else 0.0)
    return errors


def residual_norm(basis: SmoothDiscretisation, found: Estimate) -> float:
    """‖L* p‖/‖p‖ of coefficients, in a basis where it is exact."""
    sector, large = basis.stationary_sector, basis.enlarged(found.truncation)
    vector = basis.embed(found.vector, sector, found.truncation, large)
    image = basis.matrix(sector, *large).T @ vector
    return float(np.linalg.norm(image) / np.linalg.norm(vector))


def remedy(model: SmoothLayDownModel) -> str:
    """What helps where no truncation that fits is enough."""
    return (
        f"at noise {model.noise:g} and relaxation length {model.relaxation_length:g} "
        "the density is far from a few modes: raise `tolerance` or `memory_limit`, "
        "choose a larger noise or use `steady_state`"
    )
