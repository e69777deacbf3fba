"""Stationary densities on a moving belt by expansion: L* h = 0, degree by degree."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import lu_factor, lu_solve

from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_tolerance
from fpsolve.errors import ToleranceError
from fpsolve.evolution.call import Call, recorded
from fpsolve.evolution.saved import Saved
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution import quadrature
from fpsolve.spectral.evolution.expansion import Expansion, Limits
from fpsolve.spectral.evolution.exponential import ForwardOperator
from fpsolve.spectral.evolution.layout import STEADY
from fpsolve.spectral.evolution.quadratic import (
    check_model,
    checked_tolerance,
    quadratic,
)

__all__ = ["SpectralSteadyState", "spectral_steady_state"]

Array = NDArray[np.float64]
# Degree of the first truncation and its growth, harmonics per degree. At low noise
# the angle far out is sharp, so that high degrees need harmonics too.
DEGREE, RATIO = 24, 1.3
FEWEST_HARMONICS, ASPECT = 16, 0.4
ROUNDING = 1e-15
# Bytes of the elimination per squared size of a block: the block, its factors, and
# the block that couples it to the next.
BYTES = 4 * 8


@dataclass(frozen=True, eq=False)
class SpectralSteadyState(Saved):
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

    def density(self, grid: PhaseSpaceGrid, *, tolerance: float = 1e-2) -> Array:
        """p(ξ, α) at the cell centres of a grid; shape ``grid.shape``.

        Moments need the first coefficients only, the density all of them: where the
        belt has moved it far from e^{−B}, the moments are exact and the density is not
        known at all.

        Raises
        ------
        ToleranceError
            If `density_error` is above `tolerance`.
        """
        tolerance = checked_tolerance(tolerance)
        p, error = self._density_and_error(grid)
        if not error <= tolerance:
            remedy = (
                "lower the `tolerance` of `spectral_steady_state`, which raises the "
                "truncation, or use `steady_state`"
            )
            raise ToleranceError(error, tolerance, remedy)
        return p

    def density_error(self, grid: PhaseSpaceGrid) -> float:
        """∫ |p − p′| dξ dα on a grid, p′ from the next coarser truncation."""
        return self._density_and_error(grid)[1]

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
    model: LayDownModel,
    *,
    tolerance: float = 1e-8,
    memory_limit: float = 2**31,
) -> SpectralSteadyState:
    """Density with L* p = 0 and mass one, for quadratic B and constant belt speed.

    The null vector of the forward equation in the basis of `spectral_solve`. Degrees
    only couple to their neighbours, so that it is found by block elimination from
    degree 0, where the mass is given, upwards. On a belt at rest it is p_S, exactly.
    Refined until every moment changes by less than `tolerance`.

    Parameters
    ----------
    model : LayDownModel
    tolerance : float
        For each moment, relative where it is above one.
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
    check_model(model)
    tolerance = checked_tolerance(tolerance)
    memory_limit = check_tolerance("memory_limit", memory_limit)
    degree, reached = DEGREE, np.inf
    remedy = "raise `memory_limit` or `tolerance`"
    coarse = stationary(model, truncation_limits(degree))
    while True:
        degree = round(RATIO * degree)
        limits = truncation_limits(degree)
        if memory_of(limits) > memory_limit:
            raise ToleranceError(float(reached), tolerance, remedy)
        fine = stationary(model, limits)
        if not (np.isfinite(coarse.values).all() and np.isfinite(fine.values).all()):
            remedy = (
                f"at noise {model.noise:g} its coefficients grow beyond all numbers: "
                "choose another noise or use `steady_state`"
            )
            raise ToleranceError(np.inf, tolerance, remedy)
        result = compared(model, coarse, fine)
        reached = max(
            error / max(1.0, abs(result.moments[name]))
            for name, error in result.errors.items()
        )
        if reached <= tolerance:
            return result
        coarse = fine


def truncation_limits(degree: int) -> Limits:
    """Harmonics on a quarter of an ellipse over the degrees, at least one.

    Without any harmonic a degree would couple to nothing.
    """
    n = np.arange(degree + 1)
    harmonics = max(FEWEST_HARMONICS, ASPECT * degree)
    height = harmonics * np.sqrt(1.0 - (n / degree) ** 2)
    return np.maximum(1, np.rint(height)).astype(np.int64)


def memory_of(limits: Limits) -> int:
    """Bytes of the elimination."""
    sizes = (np.arange(limits.size) + 1.0) * (limits + 1.0)
    return int(BYTES * np.sum(sizes**2))


def stationary(model: LayDownModel, limits: Limits) -> Expansion:
    """The null vector within limits, its constant coefficient one.

    Reflection (ξ2, α) → (−ξ2, −α) leaves it unchanged: it is real in this basis.
    """
    index = Unknowns(limits)
    matrix = forward_matrix(model, index)
    solution = eliminate(matrix, index.offsets)
    result = Expansion.empty(limits)
    result.values[index.i, index.j, 2 * index.k] = solution
    return result


class Unknowns:
    """Real parts of d[i, j, k], sorted by degree; k = 0 only for even j."""

    def __init__(self, limits: Limits) -> None:
        i, j, k, sizes = [], [], [], []
        for n, last in enumerate(limits):
            second, harmonic = np.divmod(np.arange((n + 1) * (last + 1)), last + 1)
            kept = (harmonic > 0) | (second % 2 == 0)
            i.append(n - second[kept])
            j.append(second[kept])
            k.append(harmonic[kept])
            sizes.append(int(kept.sum()))
        self.i, self.j, self.k = map(np.concatenate, (i, j, k))
        self.offsets = np.concatenate([[0], np.cumsum(sizes)])
        m = int(limits.max()) + 2
        self._table = np.full((limits.size + 1, limits.size + 1, m), -1)
        self._table[self.i, self.j, self.k] = np.arange(self.i.size)

    def find(self, i: Limits, j: Limits, k: Limits) -> Limits:
        """Numbers of unknowns, −1 where there is none."""
        outside = (i < 0) | (j < 0) | (k < 0)
        return np.where(outside, -1, self._table[i, j, k])


def forward_matrix(model: LayDownModel, index: Unknowns) -> sparse.csr_array:
    """L* on functions that are even under (ξ2, α) → (−ξ2, −α), as a matrix."""
    scale1, scale2, diffusivity, belt = ForwardOperator(model).numbers
    i, j, k = index.i, index.j, index.k
    up1, up2 = scale1 * np.sqrt(i + 1.0), scale2 * np.sqrt(j + 1.0)
    down1, down2 = scale1 * np.sqrt(i), scale2 * np.sqrt(j)
    # Without a harmonic the two neighbours k = ±1 are one unknown.
    above = np.where(k == 0, 1.0, 0.5 * (k + 1.0))
    below = np.where(k == 0, 0.0, 0.5 * (k - 1.0))
    couplings = (
        (i, j, k, -diffusivity * k**2.0),
        (i + 1, j, k - 1, -0.5 * k * up1),
        (i + 1, j, k + 1, 0.5 * k * up1),
        (i, j + 1, k - 1, -0.5 * k * up2),
        (i, j + 1, k + 1, -0.5 * k * up2),
        (i - 1, j, k + 1, above * down1),
        (i - 1, j, k - 1, -below * down1),
        (i, j - 1, k + 1, above * down2),
        (i, j - 1, k - 1, below * down2),
        (i - 1, j, k, belt * down1),
    )
    rows, columns, values = [], [], []
    for first, second, harmonic, value in couplings:
        column = index.find(first, second, harmonic)
        kept = np.flatnonzero((column >= 0) & (value != 0))
        rows.append(kept)
        columns.append(column[kept])
        values.append(value[kept])
    where = np.concatenate(rows), np.concatenate(columns)
    n = i.size
    return sparse.csr_array((np.concatenate(values), where), shape=(n, n))


def eliminate(matrix: sparse.csr_array, offsets: NDArray[np.int64]) -> Array:
    """The null vector of a block tridiagonal matrix whose first unknown is one."""
    # Without the first unknown, which moves to the right-hand side.
    right = -matrix[1:, [0]].toarray()[:, 0]
    matrix = matrix[1:, 1:].tocsr()
    offsets = np.maximum(offsets - 1, 0)
    blocks = [slice(a, b) for a, b in pairwise(offsets)]
    factors: list[Any] = []
    carried: list[Array] = []
    for n, here in enumerate(blocks):
        # Too large a number anywhere leaves none in the solution that is one.
        if n and not np.isfinite(carried[-1]).all():
            return np.full(matrix.shape[0] + 1, np.nan)
        diagonal = matrix[here, here].toarray()
        source = right[here]
        if n:
            before = blocks[n - 1]
            lower, upper = matrix[here, before], matrix[before, here]
            diagonal -= lower @ lu_solve(factors[-1], upper.toarray())
            source = source - lower @ lu_solve(factors[-1], carried[-1])
        factors.append(lu_factor(diagonal))
        carried.append(source)
    solution = np.empty(matrix.shape[0])
    for n in range(len(blocks) - 1, -1, -1):
        source = carried[n]
        if n + 1 < len(blocks):
            source = source - matrix[blocks[n], blocks[n + 1]] @ solution[blocks[n + 1]]
        solution[blocks[n]] = lu_solve(factors[n], source)
    return np.concatenate([[1.0], solution])


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
