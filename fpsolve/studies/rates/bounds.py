"""Proven lower bounds of the rate of convergence, and the asymptotes of the rate."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_noise
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.studies.constants.poincare import (
    next_gap_term,
    poincare_constant,
    require_confining,
)

__all__ = [
    "NO_DECAY",
    "HypocoerciveBound",
    "averaging_bound",
    "hypocoercive_bound",
    "large_noise_asymptote",
    "small_noise_asymptote",
]

# What a noise of zero means, for messages.
NO_DECAY = "; without noise the density never forgets its start"


@dataclass(frozen=True)
class HypocoerciveBound:
    """‖h(s) − 1‖ ≤ factor ‖h(0) − 1‖ e^{−rate s} in L²(μ), h = p/p_S.

    Attributes
    ----------
    rate, factor : float
    epsilon, kappa : float
        Weight and inverse length of the entropy that proves it.
    """

    rate: float
    factor: float
    epsilon: float
    kappa: float


def hypocoercive_bound(
    potential: Potential, noise: float, *, factor: float = math.inf
) -> HypocoerciveBound:
    """The bound of Dolbeault, Klar, Mouhot and Schmeiser with constants filled in.

    Their modified entropy ½‖f‖² + ε⟨𝒜f, f⟩, 𝒜 = (κ² + (TΠ)*TΠ)⁻¹(TΠ)*, with Π the
    average over α and T the transport, decays like e^{−2λs} if

        4 (εm − λ)(D − ε − λ) ≥ ε² (C + |D − 2λ|/(2κ))²,   m = Λ/(Λ + 2κ²),

    D = A²/2, with C = ‖𝒜T(1 − Π)‖; then ‖f‖ falls like e^{−λs} up to the factor
    √((2κ + ε)/(2κ − ε)). The best ε and κ are chosen (they have κ = 1). λ grows like D
    for small and falls like 1/D for large noise, as the gap does.

    C ≤ 1 + √2 + √ΔB/(4κ) for quadratic B and 1 + K/(4κ) for B = K|ξ|, both from
    ‖∇²u‖ ≤ ‖(−Δ + ∇B·∇)u‖ for convex B. For B = |ξ|²/2 truncations suggest that C is
    no larger than √(14/3), which is not used because it is not proven.

    Parameters
    ----------
    potential : QuadraticPotential or LinearPotential
    noise : float
        A > 0.
    factor : float
        Largest factor in front of the exponential that is accepted, above 1.

    Raises
    ------
    ValueError
        For other potentials, whose constants are not known, and a noise of 0.

    References
    ----------
    [DKMS13]_, theorem 1; [DMS15]_.
    """
    noise = check_noise("noise", noise, NO_DECAY)
    if not factor > 1:
        raise ValueError(
            f"`factor` must be above 1, got {factor:g}; no rate is proven without one."
        )
    length, unit = _unit_of(potential)
    regularity = _regularity(unit)
    poincare = poincare_constant(unit)
    scaled = 0.5 * (noise * math.sqrt(length)) ** 2
    share = 1.0 if math.isinf(factor) else (factor**2 - 1) / (factor**2 + 1)

    def entropy(parameters: Array) -> tuple[float, float]:
        """ε and κ from two unbounded numbers; ε < 2κ."""
        kappa = math.exp(parameters[1])
        return 2 * kappa * share / (1 + math.exp(-parameters[0])), kappa

    def loss(parameters: Array) -> float:
        return -_best_rate(*entropy(parameters), scaled, poincare, regularity)

    starts = [np.array([x, y]) for x in (-8.0, -5.0, -2.0) for y in (-2.0, 0.0, 1.5)]
    first = min(starts, key=loss)
    options = {"xatol": 1e-9, "fatol": 1e-14, "maxiter": 4000}
    found = minimize(loss, first, method="Nelder-Mead", options=options)
    epsilon, kappa = entropy(found.x)
    cost = math.sqrt((2 * kappa + epsilon) / (2 * kappa - epsilon))
    return HypocoerciveBound(-float(found.fun) / length, cost, epsilon, kappa)


def averaging_bound(potential: Potential, noise: float) -> float:
    """2c/(b/A + (1 + 1/√2) A)² at the least b possible, c = Λ/2: theorem 3.3 as a rate.

    The theorem bounds the asymptotic variance of averages by
    c⁻¹(b/A + (1 + 1/√2)A)² ‖f − E f‖². An eigenfunction of a real eigenvalue −γ has
    the variance 2/γ, so that every real γ lies above the number returned. The paper
    does not give b; the exact eigenvalue A²/2 asks for b ≥ 2√c, taken here: what is
    proven is at most this curve. Complex eigenvalues are not bounded by it.

    Parameters
    ----------
    potential : QuadraticPotential
        Isotropic: |ξ| is not smooth enough for the theorem, and other potentials lack
        the eigenvalue.
    noise : float
        A > 0.

    References
    ----------
    [KMW09]_, theorem 3.3.
    """
    noise = check_noise("noise", noise, NO_DECAY)
    if not (isinstance(potential, QuadraticPotential) and potential.isotropic):
        raise ValueError(
            "`potential` must be an isotropic QuadraticPotential for this bound, got "
            f"{potential!r}."
        )
    c = poincare_constant(potential) / 2
    return 2 * c / (2 * math.sqrt(c) / noise + (1 + math.sqrt(0.5)) * noise) ** 2


def small_noise_asymptote(potential: Potential, noise: ArrayLike) -> Array:
    """A²/2: the exact eigenvalue of G = e^{−B} ξ×τ for every isotropic B.

    An upper bound of the gap at every noise. For B = |ξ| and |ξ|²/2 it is the gap
    itself at small noise. NaN for a potential that is not isotropic.
    """
    require_confining(potential)
    noise = np.asarray(noise, dtype=np.float64)
    return 0.5 * noise**2 if potential.isotropic else np.full(noise.shape, np.nan)


def large_noise_asymptote(potential: Potential, noise: ArrayLike) -> Array:
    """Λ/A² (1 + c/A⁴), the rate of the hydrodynamic limit with its first correction.

    Λ is the Poincaré constant of e^{−B}, and c that of `next_gap_term`: known for
    quadratic and linear B, 3/(2σ²) and −K²/48 among them. For other potentials c is
    left out. NaN where the correction exceeds a half: there it means nothing.
    """
    noise = np.asarray(noise, dtype=np.float64)
    poincare = poincare_constant(potential)
    term = next_gap_term(potential)
    correction = term if math.isfinite(term) else 0.0
    share = correction / noise**4
    rate = poincare / noise**2 * (1 + share)
    return np.asarray(np.where(np.abs(share) <= 0.5, rate, np.nan))


def _unit_of(potential: Potential) -> tuple[float, Potential]:
    """Length ℓ and potential for which rate(B, A) = rate(unit, √ℓ A)/ℓ."""
    require_confining(potential)
    if isinstance(potential, LinearPotential):
        return 1 / potential.slope, LinearPotential()
    if isinstance(potential, QuadraticPotential):
        length = potential.sigma1
        return length, QuadraticPotential(1.0, potential.sigma2 / length)
    raise ValueError(
        "`potential` must be quadratic or linear for a bound with known constants, got "
        f"{potential!r}."
    )


def _regularity(unit: Potential) -> Callable[[float], float]:
    """Upper bound of C = ‖𝒜T(1 − Π)‖ as a function of κ."""
    if isinstance(unit, LinearPotential):
        return lambda kappa: 1 + 1 / (4 * kappa)
    assert isinstance(unit, QuadraticPotential)
    laplacian = 1 / unit.sigma1**2 + 1 / unit.sigma2**2
    return lambda kappa: 1 + math.sqrt(2) + math.sqrt(laplacian) / (4 * kappa)


def _best_rate(
    epsilon: float,
    kappa: float,
    diffusivity: float,
    poincare: float,
    regularity: Callable[[float], float],
) -> float:
    """Largest λ that the inequality allows; negative if none is positive."""
    coercive = epsilon * poincare / (poincare + 2 * kappa**2)
    constant = regularity(kappa)

    def room(rate: float) -> float:
        cross = constant + abs(diffusivity - 2 * rate) / (2 * kappa)
        both = (coercive - rate) * (diffusivity - epsilon - rate)
        return 4 * both - (epsilon * cross) ** 2

    largest = min(coercive, diffusivity - epsilon)
    if largest <= 0 or room(0.0) <= 0:
        return min(largest, room(0.0), 0.0)
    return float(brentq(room, 0.0, largest, xtol=1e-16, rtol=1e-13))
