"""Stationary densities on a moving belt by expansion: L* h = 0, degree by degree."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_tolerance
from fpsolve.errors import ToleranceError
from fpsolve.evolution.call import Call, recorded
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution import quadrature, sector_steady
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.exponential import ForwardOperator
from fpsolve.spectral.evolution.layout import STEADY
from fpsolve.spectral.evolution.null_vector import (
    memory_of,
    stationary,
    truncation_limits,
)
from fpsolve.spectral.evolution.quadratic import (
    check_model,
    checked_tolerance,
    quadratic,
)
from fpsolve.spectral.evolution.smooth_steady import (
    TOLERANCE,
    SmoothSpectralSteadyState,
    smooth_steady_state,
)
from fpsolve.spectral.evolution.stationary_density import StationaryDensity

__all__ = ["SpectralSteadyState", "spectral_steady_state"]

# Degree of the first truncation and its growth.
DEGREE, RATIO = 24, 1.3
# The same where sectors are coupled.
DEGREE_OF_SECTORS = 68
ROUNDING = 1e-15
_LIMIT = "memory_limit"


@dataclass(frozen=True, eq=False)
class SpectralSteadyState(StationaryDensity):
    """A density with L* h = 0, its moments and how well both are known.

    Attributes
    ----------
    model : LayDownModel
    moments : dict of float
        E ξ, the covariance of ξ, E cos α (−v) and E sin α (0).
    errors : dict of float
        Change of each moment from the next coarser truncation.
    residual : float
        ‖L* h‖/‖h‖ in L²(μ), computed in the basis that L* maps the truncation into, so
        that no part of it is left out. It is dominated by the last degrees, of which
        the moments hardly know.
    truncation : (int, int)
        Degree and largest harmonic.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "spectral-steady-state"
    layout = STEADY

    model: LayDownModel
    moments: dict[str, float]
    errors: dict[str, float]
    residual: float
    truncation: tuple[int, int]
    _expansion: Expansion
    _coarser: Expansion
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        mean = f"({self.moments['mean_xi1']:.6g}, {self.moments['mean_xi2']:.6g})"
        return (
            f"SpectralSteadyState(E ξ = {mean}, largest error "
            f"{max(self.errors.values()):.1e}, residual {self.residual:.1e}, degree "
            f"{self.truncation[0]}, harmonics {self.truncation[1]})"
        )

    def _density_and_error(self, grid: PhaseSpaceGrid) -> tuple[Array, float]:
        potential = quadratic(self.model)
        p, q = (
            quadrature.density_on(one, grid, potential)
            for one in (self._expansion, self._coarser)
        )
        error = float(np.abs(p - q).sum()) * grid.cell_volume
        return p, error + ROUNDING


@recorded()
@one_blas_thread()
def spectral_steady_state(
    model: FibreModel,
    *,
    tolerance: float | None = None,
    memory_limit: float = 2**31,
) -> SpectralSteadyState | SmoothSpectralSteadyState:
    """Density with L* p = 0 and mass one, for quadratic B and constant belt speed.

    Of a basic fibre, the null vector of the forward equation in the basis of
    `spectral_solve`. Degrees only couple to their neighbours, so that it is found by
    block elimination from degree 0, where the mass is given, upwards. On a belt at
    rest it is p_S, exactly. Where that does not fit and B is isotropic, from sectors of
    the angular index M, each factorised alone, which the belt couples to M ± 1, by
    GMRES.
    Refined until every moment changes by less than `tolerance`.

    Of a smooth fibre, for an isotropic B on a belt at rest, the null vector of the
    transposed matrix of `spectrum`, by inverse iteration. It has no closed form. With
    little noise it takes more functions than fit: 1e-8 is reached at A = 1 for R up to
    σ1, in twenty seconds where both are one, and in two where A >= 2.

    On a belt and about unequal throwing ranges the angular indices M are coupled
    (`CoupledDiscretisation`), and the equations solved by GMRES with the indices alone
    as preconditioner. The basis stands about the mean and is as wide as the density,
    which small truncations give first. E cos α = -v and E κ² converge faster than the
    variances.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
    tolerance : float, optional
        For each moment, relative where it is above one; by default 1e-8, of a
        smooth fibre that or what the default work and memory reach, but not above
        1e-3: `errors` say what.
    memory_limit : int
        Bytes that the elimination may take.

    Raises
    ------
    ValueError
        As `spectral_solve`.
    ToleranceError
        If the tolerance is not reached within the memory.

    References
    ----------
    [KMW09]_, section 3.1.2.
    """
    if isinstance(model, SmoothLayDownModel):
        wanted = None if tolerance is None else checked_tolerance(tolerance)
        limit = check_tolerance(_LIMIT, memory_limit)
        return smooth_steady_state(model, wanted, limit)
    check_model(model)
    wanted = checked_tolerance(TOLERANCE if tolerance is None else tolerance)
    limit = check_tolerance(_LIMIT, memory_limit)
    return basic_steady_state(model, wanted, limit)


def basic_steady_state(
    model: Any, tolerance: float, memory_limit: float
) -> SpectralSteadyState:
    """See `spectral_steady_state`; the model has been checked."""
    degree, reached = DEGREE, np.inf
    remedy = "raise `memory_limit` or `tolerance`"
    coarse = stationary(model, truncation_limits(degree))
    while True:
        degree = round(RATIO * degree)
        limits = truncation_limits(degree)
        if memory_of(limits) > memory_limit:
            if quadratic(model).isotropic:
                return between_sectors(model, tolerance, memory_limit, float(reached))
            raise ToleranceError(float(reached), tolerance, remedy)
        fine = stationary(model, limits)
        if not (np.isfinite(coarse.values).all() and np.isfinite(fine.values).all()):
            remedy = (
                f"at noise {model.noise:g} its coefficients grow beyond all numbers: "
                "choose another noise or use `steady_state`"
            )
            raise ToleranceError(np.inf, tolerance, remedy)
        result = compared(model, coarse, fine)
        reached = worst_error(result)
        if reached <= tolerance:
            return result
        coarse = fine


def between_sectors(
    model: LayDownModel, tolerance: float, memory_limit: float, reached: float
) -> SpectralSteadyState:
    """The same where elimination does not fit, from sectors of the angular index."""
    degree, remedy = DEGREE_OF_SECTORS, "raise `memory_limit` or `tolerance`"
    coarse = None
    while sector_steady.memory_of(degree) <= memory_limit:
        fine = sector_steady.SectorsOnBelt(model, degree).stationary()
        if coarse is not None:
            result = compared(model, coarse, fine)
            error = worst_error(result)
            reached = min(reached, error)
            if error <= tolerance:
                return result
        coarse, degree = fine, round(RATIO * degree)
    raise ToleranceError(reached, tolerance, remedy)


def worst_error(result: SpectralSteadyState) -> float:
    """Largest error of a moment, relative where it is above one."""
    return max(
        error / max(1.0, abs(result.moments[name]))
        for name, error in result.errors.items()
    )


def compared(
    model: LayDownModel, coarse: Expansion, fine: Expansion
) -> SpectralSteadyState:
    """The finer stationary density, with the changes of its moments."""
    potential = quadratic(model)
    before = quadrature.moments(coarse, potential)
    moments = quadrature.moments(fine, potential)
    errors = {
        name: abs(value - before[name]) + ROUNDING * max(1.0, abs(value))
        for name, value in moments.items()
    }
    residual = residual_norm(model, fine)
    truncation = fine.degree, fine.harmonics
    return SpectralSteadyState(
        model, moments, errors, residual, truncation, fine, coarse
    )


def residual_norm(model: LayDownModel, h: Expansion) -> float:
    """‖L* h‖/‖h‖ with one more degree and one more harmonic, where it is exact."""
    larger = np.append(h.limits, h.limits[-1])
    larger = np.maximum(larger, np.append(h.limits[:1], h.limits)) + 1
    image = ForwardOperator(model)(h.within(larger))
    return float(np.sqrt(image.energies().sum() / h.energies().sum()))
