"""gap·A² = Λ (1 + c ε² + O(ε⁴)): the next term of the rate for large noise."""

from __future__ import annotations

import math

from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential

__all__ = ["next_gap_term"]


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
