"""e^{sL*} applied to an expansion, by Chebyshev polynomials on an ellipse."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ive, jv

from fpsolve._kernels.ladder import apply_ladder
from fpsolve._support.arrays import Array
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.expansion import Expansion, Limits
from fpsolve.spectral.work import Work

__all__ = ["ForwardOperator"]

# Chebyshev terms per unit of (half axes) × (arclength) approach one from above as the
# product grows; beyond this product little is gained and rounding grows.
REACH = 60.0
# The foci stay this share of the longer half axis from the centre: a disc would need
# powers instead of Chebyshev polynomials.
FLATTEST = 0.35
# For a long real axis a of the ellipse and a short one b: steps of GROWTH a/b² let the
# polynomials grow by about e⁶, and need 6 a/b terms; a/b counts up to FLATTER.
GROWTH, FLATTER = 0.6, 60.0
# Terms between two looks at whether the series has converged.
STRIDE = 4


@dataclass(frozen=True)
class ForwardOperator:
    """L* h = −τ·∇h + (∇B·τ⊥) ∂_α h + (A²/2) ∂_αα h − v (∂₁ − ξ₁/σ₁²) h.

    The generator of h = p/p_S for quadratic B, with v ∂₁p on a moving belt. In the
    basis of `Expansion` it couples degrees and harmonics that differ by one, except
    that −v (∂₁ − ξ₁/σ₁²) only raises the first degree: truncation keeps mass and, on a
    fixed belt, the norm of what transport alone does.

    Parameters
    ----------
    model : LayDownModel
        With a QuadraticPotential and a belt of constant speed.
    """

    model: LayDownModel

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """1/σ₁, 1/σ₂, A²/2, v."""
        potential = self.model.potential
        scales = 1 / potential.sigma1, 1 / potential.sigma2  # type: ignore[attr-defined]
        return *scales, self.model.diffusivity, self.model.belt_speed

    def half_axes(self, limits: Limits) -> tuple[float, float]:
        """Half widths of a box around the numerical range: along ℜ, along ℑ.

        Its symbol is |τ·ξ' − k ∇B·τ⊥| with |ξ'|² + |ξ|²/4 ≤ n: √(n (1 + 4k²)).
        """
        scale1, scale2, diffusivity, belt = self.numbers
        degree = np.arange(limits.size)
        kept = limits >= 0
        speed = np.sqrt(degree * (1.0 + 4.0 * limits**2))[kept].max()
        raising = abs(belt) * scale1 * math.sqrt(limits.size)
        imaginary = speed * max(scale1, scale2) + 0.5 * raising
        real = 0.5 * diffusivity * float(limits.max()) ** 2 + 0.5 * raising
        return real, max(imaginary, 1e-3)

    def longest(self, limits: Limits) -> float:
        """Arclength that one call of `advance` covers efficiently.

        Where diffusion dominates, the number of terms grows like a square root, until
        the polynomials grow too much off the real axis.
        """
        real, imaginary = self.half_axes(limits)
        flatness = min(real / imaginary, FLATTER)
        return max(REACH / (real + imaginary), GROWTH * flatness**2 / real)

    def advance(
        self, start: Expansion, ds: float, tolerance: float, work: Work | None = None
    ) -> Expansion:
        """e^{ds L*} of an expansion within its limits, to `tolerance` in L²(μ)."""
        n_steps = math.ceil(ds / self.longest(start.limits))
        work = Work() if work is None else work
        for _ in range(n_steps):
            start = self._series(start, ds / n_steps, tolerance / n_steps, work)
        return start

    def _series(
        self, start: Expansion, ds: float, tolerance: float, work: Work
    ) -> Expansion:
        """Σ a_n U_n with U_{n+1} = 2 X U_n − sign U_{n−1}, X = (L* − centre)/focus.

        Foci on the real axis (sign 1) take modified Bessel functions as coefficients,
        on a parallel of the imaginary axis (sign −1) ordinary ones. The terms grow
        until n = (half axis along ℑ) ds and fall beyond.
        """
        real, imaginary = self.half_axes(start.limits)
        centre = -real
        square = real**2 - imaginary**2
        focus = math.sqrt(max(abs(square), (FLATTEST * max(real, imaginary)) ** 2))
        sign = 1.0 if square > 0 else -1.0
        coefficients = bessel(centre * ds, focus * ds, sign)
        total = Expansion(coefficients[0] * start.values, start.limits)
        # U_0 and U_1 = X U_0; from there on two arrays take turns.
        older = np.array(start.values)
        newer = np.zeros_like(older)
        gain = 1.0 / focus
        self._apply(older, newer, start.limits, gain, centre, 0.0)
        total.values[...] += coefficients[1] * newer
        for n in range(2, coefficients.size):
            work.applied(start.n_coefficients)
            apply_ladder(
                newer, start.limits, self.numbers,
                (2 * gain, -2 * gain * centre, -sign), older,
                coefficients[n], total.values,
            )  # fmt: skip
            older, newer = newer, older
            # While the terms still grow, small ones say nothing of those to come.
            if n % STRIDE == 0 and n >= imaginary * ds:
                ahead = np.abs(coefficients[n + 1 : n + 1 + STRIDE]).max(initial=0.0)
                if ahead * (norm(older) + norm(newer)) < tolerance:
                    return total
        raise ArithmeticError("the Chebyshev series did not converge.")

    def _apply(
        self,
        c: Array,
        out: Array,
        limits: Limits,
        gain: float,
        centre: float,
        keep: float,
    ) -> None:
        nothing = np.zeros_like(c)
        recurrence = gain, -gain * centre, keep
        apply_ladder(c, limits, self.numbers, recurrence, out, 0.0, nothing)

    def __call__(self, h: Expansion) -> Expansion:
        """L* h within the limits of h."""
        out = Expansion.empty(h.limits)
        self._apply(h.values, out.values, h.limits, 1.0, 0.0, 0.0)
        return out


def norm(values: Array) -> float:
    """Norm of an array of coefficients, up to the weight of the harmonics."""
    flat = values.ravel()
    return math.sqrt(2.0 * float(flat @ flat))


def bessel(shift: float, argument: float, sign: float) -> Array:
    """e^{shift} (2 − δ_n0) I_n(argument), or J_n for sign −1; n up to several REACH."""
    n = np.arange(int(12 * REACH))
    if sign > 0:
        values = ive(n, argument) * math.exp(shift + argument)
    else:
        values = jv(n, argument) * math.exp(shift)
    return np.asarray(np.where(n == 0, 1.0, 2.0) * values)
