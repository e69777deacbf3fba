"""How long a fibre without a potential keeps its direction, curved or not."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gammainc, gammaln

from fpsolve.model.fibre import FibreModel
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["Persistence"]

# From here on ln Γ is Stirling's series, whose large terms cancel by hand.
_STIRLING = 30.0
# Below, γ(a, x) is its first term to rounding.
_EARLY = 1e-17


class Persistence(NamedTuple):
    """E τ_s·τ_0 = exp(−(A²/2)(s − R(1 − e^{−s/R}))) for B = 0, and its integral 2F/A².

    The angle of a smooth fibre whose curvature is stationary is Gaussian with the
    variance A²(s − R(1 − e^{−s/R})); for R = 0 it is that of the basic model. With
    a = A²R/2 the integral over s is (2/A²) F, F = eᵃ a^{1−a} γ(a, a) = ₁F₁(1; a+1; a):
    1 at a = 0, √(πa/2) for a → ∞.

    Attributes
    ----------
    noise : float
        A > 0.
    relaxation_length : float
        R >= 0.
    """

    noise: float
    relaxation_length: float = 0.0

    @classmethod
    def of(cls, model: FibreModel) -> Persistence:
        """That of a model; R = 0 for the basic one."""
        if isinstance(model, SmoothLayDownModel):
            return cls(model.noise, model.relaxation_length)
        return cls(model.noise)

    @property
    def bending(self) -> float:
        """a = A²R/2, half the variance that the angle gets over R by white noise."""
        return 0.5 * self.noise**2 * self.relaxation_length

    @property
    def factor(self) -> float:
        """F = ₁F₁(1; a+1; a), to about 14 digits."""
        if not self.bending:
            return 1.0
        return self._scale() * float(gammainc(self.bending, self.bending))

    @property
    def length(self) -> float:
        """∫₀^∞ E τ_s·τ_0 ds = 2F/A²: the persistence length."""
        return 2.0 / self.noise**2 * self.factor

    def turned(self, s: float) -> float:
        """Half the variance of α_s − α_0; harmonic n falls by exp(−n² times it)."""
        share = self._share(s)
        # s − R(1 − e^{−s/R}) without the loss of digits for s far below R.
        kept = s if math.isinf(share) else self.relaxation_length * _late(share)
        return 0.5 * self.noise**2 * kept

    def beyond(self, s: float) -> float:
        """∫_s^∞ E τ_u·τ_0 du: what is left of `length` at s."""
        reached = self.bending * math.exp(-self._share(s))
        if reached < _EARLY:
            # γ(a, x) = xᵃ/a there, and no power of a number that underflows.
            return (
                2.0 / self.noise**2 * math.exp(self.bending - 0.5 * self.noise**2 * s)
            )
        tail = float(gammainc(self.bending, reached))
        return 2.0 / self.noise**2 * self._scale() * tail

    def _share(self, s: float) -> float:
        """s/R, infinite for R = 0."""
        return s / self.relaxation_length if self.relaxation_length else math.inf

    def _scale(self) -> float:
        """eᵃ a^{1−a} Γ(a), a > 0."""
        a = self.bending
        if a < _STIRLING:
            return math.exp(a - a * math.log(a) + float(gammaln(a + 1.0)))
        series = 1 / (12 * a) - 1 / (360 * a**3) + 1 / (1260 * a**5) - 1 / (1680 * a**7)
        return math.sqrt(2 * math.pi * a) * math.exp(series)


def _late(x: float) -> float:
    """x − (1 − e^{−x})."""
    if x > 0.1:
        return x + math.expm1(-x)
    powers = np.arange(2.0, 13.0)
    return float(((-x) ** powers / np.cumprod(powers)).sum())
