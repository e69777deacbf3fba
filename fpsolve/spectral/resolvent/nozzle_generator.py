"""The generator of a fibre under a moving nozzle, in a basis that swings along."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse

from fpsolve.model.curves.belts import MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator

__all__ = ["NozzleBasis", "NozzleGenerator", "Swing", "nozzle_amplitudes", "on_belt"]

# From one truncation to the next.
DEGREES, ANGLES, PHASES = 4, 2, 1


class Swing(NamedTuple):
    """Where a basis is centred, c(s) = c0 e1 + Re (ĉ e^{iωs}).

    Attributes
    ----------
    centre : float
        c0.
    along, across : complex
        ĉ.
    """

    centre: float
    along: complex = 0j
    across: complex = 0j


@dataclass(frozen=True)
class NozzleBasis:
    """The states of a `Basis` times e^{ijωs}, |j| <= `phases`.

    Attributes
    ----------
    plain : Basis
    phases : int
    """

    plain: Basis
    phases: int

    @property
    def size(self) -> int:
        """Number of unknowns: those of −j are conjugate to those of j."""
        return self.plain.size * (self.phases + 1)

    def grown(self, level: int) -> NozzleBasis:
        """The basis that is `level` steps larger."""
        plain = Basis(
            self.plain.degree + DEGREES * level, self.plain.harmonics + ANGLES * level
        )
        return NozzleBasis(plain, self.phases + PHASES * level)


@dataclass(frozen=True, eq=False)
class NozzleGenerator:
    """L(s) = L0 + R e^{iωs} + R̄ e^{−iωs} of x = (ξ − c(s))/σ.

    With γ = −v s e1 + Re (γ̂ e^{iωs}), where γ̂ = (r1, −i r2) e^{iφ}, L0 is the
    generator on a belt, about c0, and

        R = −(iω/2) (γ̂ + ĉ)·∇ + [ĉ1 sin α/σ1² − ĉ2 cos α/σ2²] ∂_α/2.

    A fibre that lags behind swings about the nozzle: polynomials about its mean are
    few, polynomials about the nozzle many.

    Attributes
    ----------
    model : LayDownModel
    basis : NozzleBasis
    swing : Swing
    """

    model: LayDownModel
    basis: NozzleBasis
    swing: Swing

    @cached_property
    def plain(self) -> Generator:
        """That on the belt, about c0."""
        return Generator(on_belt(self.model), self.basis.plain, self.swing.centre)

    @property
    def frequency(self) -> float:
        """ω."""
        curve: Any = self.model.curve
        return float(curve.angular_speed)

    @cached_property
    def rising(self) -> sparse.csr_array:
        """R; column and row are the states of the plain basis."""
        basis, (sigma1, sigma2) = self.basis.plain, self.plain.scales
        lower1, lower2 = basis.lowering(0), basis.lowering(1)
        cosine, sine, turn = basis.turned()
        on_planes = sparse.eye_array(lower1.shape[0], format="csr")
        on_circle = sparse.eye_array(turn.shape[0], format="csr")
        nozzle1, nozzle2 = nozzle_amplitudes(self.model.curve)
        _, swing1, swing2 = self.swing
        half = -0.5j * self.frequency
        parts = (
            (half * (nozzle1 + swing1) / sigma1, lower1, on_circle),
            (half * (nozzle2 + swing2) / sigma2, lower2, on_circle),
            (0.5 * swing1 / sigma1**2, on_planes, sine @ turn),
            (-0.5 * swing2 / sigma2**2, on_planes, cosine @ turn),
        )
        return sum(factor * basis.product(*part) for factor, *part in parts)

    def place(self, curve: Curve, s: float) -> tuple[float, float]:
        """γ(s) + c(s): about where the fibre is laid."""
        gamma1, gamma2 = curve.position(s)
        turned = np.exp(1j * self.frequency * s)
        centre, along, across = self.swing
        return (
            float(gamma1) + centre + (along * turned).real,
            float(gamma2) + (across * turned).real,
        )


def on_belt(model: LayDownModel) -> LayDownModel:
    """The model with the nozzle at rest."""
    curve: Any = model.curve
    speed = float(curve.speed)
    return LayDownModel(model.potential, model.noise, MovingBelt(speed))


def nozzle_amplitudes(curve: Any) -> tuple[complex, complex]:
    """γ̂ = (r1, −i r2) e^{iφ}."""
    radius1, radius2 = curve.radii
    turned = complex(np.exp(1j * curve.phase))
    return radius1 * turned, -1j * radius2 * turned
