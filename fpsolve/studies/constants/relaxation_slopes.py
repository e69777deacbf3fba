"""What a short relaxation length of the curvature changes, to first order in it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_array, eye_array
from scipy.sparse.linalg import splu

from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_tolerance
from fpsolve.errors import ToleranceError
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.choice import check_resolved
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Sector, Truncation, Vector
from fpsolve.spectral.bases.states import States, assembled
from fpsolve.spectral.eigen.gap import spectral_gap

__all__ = ["Slope", "gap_slope", "variance_slope"]

# Truncations, each √2 times as large as the one before; the last one has 384 degrees.
_LEVELS = 9
# Iterations with an inverse that is this close to the eigenvalue leave rounding.
_NEAR, _ITERATIONS = 1e-7, 5
# The rounding of sums over thousands of states.
_ROUNDING = 1e-13


class Slope(float):
    """A derivative at R = 0, a float with its error.

    Parameters
    ----------
    value : float
        The derivative.

    Attributes
    ----------
    error : float
        Its change from the next coarser truncation, and rounding.
    """

    error: float

    def __new__(cls, value: float, error: float) -> Slope:
        """A float with an error."""
        slope = super().__new__(cls, value)
        slope.error = error
        return slope

    def __getnewargs__(self) -> tuple[float, float]:  # type: ignore[override]
        return float(self), self.error


@one_blas_thread()
def variance_slope(model: FibreModel, *, tolerance: float = 1e-9) -> Slope:
    """d Var ξ₁/dR at R = 0 and fixed A = RK, in the stationary state of a belt at rest.

    The marginal of (ξ, α) is p_S (1 + R q) + O(R²) with L†q = ∂_α L† f and
    f = −∇B·τ⊥, L the generator of the basic model and L† its adjoint in L²(p_S); the
    slope is E q‖ξ‖²/2 under p_S. Solved in complex Hermite functions, refined until it
    changes by less than the tolerance. It tends to A²σ²/2 for large noise, where
    Var ξ₁ = σ² ₁F₁(1; a+1; a), a = A²R/2. Derived in docs/limits.md.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        B = ‖ξ‖²/(2σ²) on a belt at rest, positive noise; of a smooth model the limit
        R → 0.
    tolerance : float
        Largest error, relative where the slope is above one.

    Returns
    -------
    Slope
        A float with its `error`.

    Raises
    ------
    ValueError, TypeError
        If the model is another.
    ToleranceError
        If the tolerance is not reached; the noise is too small.

    References
    ----------
    [KMW09]_, section 3.2, for the limit.
    """
    basis = _basis_for(model)
    scale = basis.sigma**2
    return _refined(lambda cut: scale * _tilt(basis, cut), basis, tolerance)


@one_blas_thread()
def gap_slope(model: FibreModel, *, tolerance: float = 1e-9) -> Slope:
    """d gap/dR at R = 0 and fixed A = RK, of the mode that is the slowest at R = 0.

    −Re ⟨ψ, (f + (A²/2)∂_α)(L − λ)∂_α φ⟩/⟨ψ, φ⟩ with Lφ = λφ and L†ψ = λψ, f = −∇B·τ⊥,
    all in L²(p_S). 1/(3σ²) exactly for little noise, where φ = e^{−B} ξ·τ⊥. Derived in
    docs/limits.md.

    Parameters
    ----------
    model, tolerance
        As in `variance_slope`.

    Returns
    -------
    Slope
        A float with its `error`.

    Raises
    ------
    ValueError, TypeError
        If the model is another.
    ToleranceError
        If the tolerance is not reached: the noise is too small, or two eigenvalues are
        one, where there is no derivative.
    """
    basis = _basis_for(model)
    limit = LayDownModel(model.potential, model.noise)
    found = spectral_gap(limit)
    # Quadratic potentials on a belt at rest have isolated eigenvalues only.
    sector = Sector(found.sector.M if found.sector is not None else None)

    def slope(cut: Truncation) -> float:
        return -_drift_of(found.eigenvalue, basis, sector, cut)

    return _refined(slope, basis, tolerance)


def _refined(
    value: Callable[[Truncation], float], basis: HermiteDiscretisation, tolerance: float
) -> Slope:
    """A number of a truncation, for larger ones until it stays."""
    tolerance = check_tolerance("tolerance", tolerance)
    before, error = value(basis.truncation(0)), math.inf
    for level in range(1, _LEVELS):
        now = value(basis.truncation(level))
        scale = max(1.0, abs(now))
        error = abs(now - before) + _ROUNDING * scale
        if error <= tolerance * scale:
            return Slope(now, error)
        before = now
    remedy = f"enlarge `tolerance`, or the noise, which is {basis.noise:g}"
    raise ToleranceError(error, tolerance, remedy)


def _tilt(basis: HermiteDiscretisation, cut: Truncation) -> float:
    """E q ‖ξ‖²/(2σ²) under p_S: the coefficient of q at w w̄ − 1."""
    sector = Sector(0)
    states, adjoint = basis.states(sector, cut), basis.matrix(sector, *cut).T.tocsr()
    force = np.zeros(len(states.k))
    force[_place(states, -1, 1, 0)] = math.sqrt(0.5) / basis.sigma
    force[_place(states, 1, 0, 1)] = -math.sqrt(0.5) / basis.sigma
    # f = i·force and ∂_α = ik: the product of the two is −1.
    source = -states.k * (adjoint @ force)
    kept = np.arange(len(states.k)) != _place(states, 0, 0, 0)
    q = np.zeros(len(states.k))
    q[kept] = splu(csc_array(adjoint[kept][:, kept])).solve(source[kept])
    return float(q[_place(states, 0, 1, 1)])


def _drift_of(
    eigenvalue: complex, basis: HermiteDiscretisation, sector: Sector, cut: Truncation
) -> float:
    """Re dλ/dR of an eigenvalue, whose vectors are computed in a truncation."""
    right, left = _modes(eigenvalue, basis.matrix(sector, *cut))
    # One more degree for (L − λ), one for f.
    larger = Truncation(cut.degree + 2, cut.harmonics + 2)
    right, left = (basis.embed(vector, sector, cut, larger) for vector in (right, left))
    states, generator = basis.states(sector, larger), basis.matrix(sector, *larger)
    turned = states.k * right
    shifted = generator @ turned - eigenvalue * turned
    # i from ∂_α and i from f + (A²/2)∂_α.
    image = -(_turning(basis, states) @ shifted)
    return float(((left @ image) / (left @ right)).real)


def _modes(eigenvalue: complex, matrix: csc_array) -> tuple[Vector, Vector]:
    """Right and left eigenvectors by inverse iteration; left @ right is not zero."""
    shift: Any = eigenvalue * (1 + _NEAR)
    if not shift.imag:
        shift = shift.real
    inverse = splu((matrix - shift * eye_array(matrix.shape[0])).tocsc())
    right: Vector = (
        np.random.default_rng(0).standard_normal(matrix.shape[0]) + 0 * shift
    )
    left = right.copy()
    for _ in range(_ITERATIONS):
        right, left = inverse.solve(right), inverse.solve(left, "T")
        right, left = right / np.linalg.norm(right), left / np.linalg.norm(left)
    return right, left


def _turning(basis: HermiteDiscretisation, states: States) -> csc_array:
    """(f + (A²/2)∂_α)/i, f = i (w e^{−iα} − w̄ e^{iα})/(√2 σ), w = a† + b."""
    scale = math.sqrt(0.5) / basis.sigma
    m, n = states.m, states.n
    parts = (
        (-1, 1, 0, scale * np.sqrt(m + 1)), (-1, 0, -1, scale * np.sqrt(n)),
        (1, 0, 1, -scale * np.sqrt(n + 1)), (1, -1, 0, -scale * np.sqrt(m)),
    )  # fmt: skip
    turning = 0.5 * basis.noise**2 * states.k.astype(np.float64)
    diagonal = states.all, states.all, turning
    return assembled([diagonal, *(states.coupling(*one) for one in parts)], len(m))


def _place(states: States, k: int, m: int, n: int) -> int:
    """Where a state stands in a vector."""
    return int(states.position(*(np.array([index]) for index in (k, m, n)))[0])


def _basis_for(model: FibreModel) -> HermiteDiscretisation:
    """The basis of an isotropic quadratic model at rest; ValueError for others."""
    check_fibre_model(model)
    potential = model.potential
    if not (isinstance(potential, QuadraticPotential) and potential.isotropic):
        raise ValueError(
            "`potential` must be ‖ξ‖²/(2σ²) for derivatives by R, got "
            f"{potential!r}; compare solutions at small R for others."
        )
    if not model.curve.fixed:
        raise ValueError(
            "`curve` must be a belt at rest for derivatives by R, got "
            f"{model.curve!r}; compare solutions at small R for others."
        )
    if not model.noise > 0:
        raise ValueError(
            "`noise` must be positive, got 0; without it there is no stationary state "
            "that a fibre tends to."
        )
    check_resolved(model if isinstance(model, LayDownModel) else _limit_of(model))
    return HermiteDiscretisation(potential.sigma1, model.noise)


def _limit_of(model: FibreModel) -> LayDownModel:
    """The basic model of the same noise."""
    if isinstance(model, SmoothLayDownModel):
        return model.white_noise_limit
    return LayDownModel(model.potential, model.noise, model.curve)
