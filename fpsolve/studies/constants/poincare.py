"""Λ and c of gap·A² = Λ (1 + c ε² + O(ε⁴)): constants of e^{−B} on the plane."""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import eigh_tridiagonal

from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential

__all__ = ["next_gap_term", "poincare_constant", "require_confining"]

# Cells of the two radial grids, whose values are extrapolated; the share of e^{−B}
# outside, in which a function that grows like e^{B/2} still fits.
_CELLS = 2000
_LOST = 1e-30


def poincare_constant(potential: Potential) -> float:
    """Λ, the largest number with Λ ∫ |f − E f|² e^{−B} ≤ ∫ |∇f|² e^{−B}.

    min 1/σᵢ² for quadratic B and (2/9) K² for B = K|ξ|, exactly; for other isotropic
    potentials the least eigenvalue of −Δ + ∇B·∇ with angular index 0 or 1, by finite
    volumes in r, to about six digits where it is isolated. Where that operator has a
    continuous spectrum below, the box makes Λ too large.

    Parameters
    ----------
    potential : Potential
        Normalisable; isotropic unless quadratic.

    Raises
    ------
    ValueError
        If exp(-B) is not normalisable, or B neither isotropic nor quadratic.
    """
    require_confining(potential)
    if isinstance(potential, QuadraticPotential):
        return float(1 / max(potential.sigma1, potential.sigma2) ** 2)
    if isinstance(potential, LinearPotential):
        return 2 / 9 * potential.slope**2
    if not potential.isotropic:
        raise ValueError(
            "`potential` must be isotropic or quadratic for its Poincaré constant, got "
            f"{potential!r}."
        )
    return min(_extrapolated(potential, 0), _extrapolated(potential, 1))


def next_gap_term(potential: Potential) -> float:
    """c = 2Λ − E‖N‖²/(2Λ Eψ²), ψ the slowest mode of −Δ + ∇B·∇ and E under e^{−B}.

    N is the symmetric part without trace of ∇²ψ + ∇B ⊗ ∇ψ, ‖·‖ the Frobenius norm.
    In closed form for quadratic B, (7/σ₁² − 1/σ₂²)/4 with σ₁ ≥ σ₂ (ψ = ξ1), and for
    B = K‖ξ‖, −K²/48 (ψ = ξ1 e^{K‖ξ‖/3}); NaN for others. Derived in docs/limits.md.

    Parameters
    ----------
    potential : Potential
    """
    if isinstance(potential, QuadraticPotential):
        wide, narrow = potential.sigma1, potential.sigma2
        if wide < narrow:
            wide, narrow = narrow, wide
        return (7 / wide**2 - 1 / narrow**2) / 4
    if isinstance(potential, LinearPotential):
        return -(potential.slope**2) / 48
    return math.nan


def require_confining(potential: Potential) -> None:
    """Raise unless exp(-B) is normalisable."""
    if not potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {potential!r}; without a normalisable "
            "exp(-B) there is no equilibrium to converge to, and no rate."
        )


def _extrapolated(potential: Potential, index: int) -> float:
    """Second-order values on two grids, combined."""
    reach = _reach(potential)
    coarse, fine = (_least(potential, index, reach, n) for n in (_CELLS, 2 * _CELLS))
    return fine + (fine - coarse) / 3


def _least(potential: Potential, index: int, reach: float, n: int) -> float:
    """Least non-zero eigenvalue with angular index 0 or 1 on n cells of [0, reach]."""
    h = reach / n
    centres = (np.arange(n) + 0.5) * h
    faces = np.arange(1, n) * h
    value = potential.radial_value(centres)
    # Symmetric form: f √w; only ratios of weights enter, none underflows.
    log_weight = np.log(centres) - value
    log_face = np.log(faces) - potential.radial_value(faces)
    right = np.exp(log_face - log_weight[:-1]) / h**2
    left = np.exp(log_face - log_weight[1:]) / h**2
    diagonal = np.zeros(n)
    diagonal[:-1] += right
    diagonal[1:] += left
    diagonal += (index / centres) ** 2
    couplings = -np.exp(log_face - 0.5 * (log_weight[:-1] + log_weight[1:])) / h**2
    place = 1 if index == 0 else 0
    return float(
        eigh_tridiagonal(
            diagonal, couplings, select="i", select_range=(place, place),
            eigvals_only=True,
        )[0]
    )  # fmt: skip


def _reach(potential: Potential) -> float:
    """Radius beyond which r e^{−B} is below a share of its largest value."""
    r = math.sqrt(potential.normalisation.integral / math.tau) * np.geomspace(
        1e-3, 1e3, 4000
    )
    with np.errstate(over="ignore"):
        height = np.log(r) - potential.radial_value(r)
    inside = np.flatnonzero(height > height.max() + math.log(_LOST))
    return float(r[min(inside[-1] + 1, r.size - 1)])
