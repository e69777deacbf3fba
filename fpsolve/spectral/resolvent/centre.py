"""Where the fibre lies on a moving belt, to within what a basis needs."""

from __future__ import annotations

import math

from scipy.optimize import brentq
from scipy.special import ive

from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator

__all__ = ["centre_of", "concentration"]

# A basis that knows the mean well enough for a centre, and how often it is moved there.
SMALL, TIMES = Basis(12, 10), 2
# From here on I1/I0(κ) = 1 − 1/(2κ) to more digits than a centre needs.
SHARP = 1e6


def concentration(v: float) -> float:
    """κ of the von Mises law with I1(κ)/I0(κ) = v, 0 <= v < 1."""
    if v == 0:
        return 0.0
    if 0.5 / (1.0 - v) >= SHARP:
        return 0.5 / (1.0 - v)
    return float(brentq(lambda one: ive(1, one) / ive(0, one) - v, 0.0, 2 * SHARP))


def centre_of(model: LayDownModel) -> float:
    """E ξ1 in the stationary law, as a small truncation knows it.

    Started from large noise, where the force at the mean balances the angle:
    E ξ1 = σ1² A² κ/2 with κ of `concentration`.
    """
    v = -float(model.curve.velocity(0.0)[0])
    sigma1 = quadratic(model).sigma1
    centre = sigma1**2 * model.diffusivity * math.copysign(concentration(abs(v)), v)
    for _ in range(TIMES):
        moved = Generator(model, SMALL, centre).mean
        if abs(moved - centre) <= sigma1:
            centre = moved
    return centre
