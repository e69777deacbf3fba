"""The force of turbulent air on a fibre, from k and ε of the flow around it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from fpsolve._kernels.drag import shaking
from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_flag,
    check_non_negative,
    check_positive,
    keep_checked,
)
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.random_force import node_tangents
from fpsolve.fibre.string import String
from fpsolve.fibre.turbulent_air import smallest_energy, white_amplitudes

__all__ = ["TurbulentForce"]


@dataclass(frozen=True)
class TurbulentForce:
    """A dw_{s,t} = L D dw_{s,t}: L = ∂f/∂v of the drag, D of the fluctuations.

    Fluctuations u' of the air change the drag by L u', with L at the mean velocity past
    the fibre, and D dw stands for them: an amplitude along the fibre, one along w_n,
    the part of the mean velocity across it, and one along the normal of both, of the
    spectrum that fits k and ε of the air where the node is
    (`TurbulenceSpectrum.decaying_amplitudes`; without decay `frozen_amplitude`). It
    holds for pieces of fibre and steps that are long beside the eddies and the time in
    which they pass: with shorter ones the noise is stronger than that of the eddies on
    their scale. The mean drag is that of the mean velocity, as if it were linear in the
    fluctuations. Where k = 0 there is no noise.

    Parameters
    ----------
    kolmogorov_constant : float
        C_K. Spectra measured behind grids are fitted by about 1.2 to 1.5, the paper's
        model takes 1/2, with which the amplitude is about four times that of 1.5.
    frozen : bool
        Whether eddies do not decay while they pass. Air that does not move past the
        fibre is refused then.
    decay_time : float, optional
        t_T in s; by default k/ε.
    correlation_time : float
        In s, as of `RandomForce`; 0 for white noise.

    Raises
    ------
    ValueError
        If a number is out of its range, or there is a decay time of frozen eddies.

    References
    ----------
    [KMW09]_, equation (5); [MW06]_; [MW11]_; [Sre95]_ for the constant.
    """

    _recorded: ClassVar[str] = "turbulent_force"

    kolmogorov_constant: float = 1.2
    frozen: bool = False
    decay_time: float | None = None
    correlation_time: float = 0.0

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, "kolmogorov_constant")
        keep_checked(self, check_flag, "frozen")
        keep_checked(self, check_non_negative, "correlation_time")
        if self.decay_time is not None:
            keep_checked(self, check_positive, "decay_time")
            if self.frozen:
                raise ValueError(
                    f"`decay_time` must be None for frozen eddies, got "
                    f"{self.decay_time:g}; they do not decay."
                )

    def to_dict(self) -> dict[str, Any]:
        """The parameters, as JSON holds them."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def amplitudes(
        self, string: String, air: AirFlow | None, r: Array, v: Array, t: float
    ) -> Array:
        """L D at nodes at r, shape (n, 3, 3), in N s^½/m^½.

        Raises
        ------
        ValueError
            If there is no air, k too small for ε, or air at rest past the fibre and the
            eddies frozen.
        FlowRangeError
            If a node is outside of a table of the air.
        """
        if air is None:
            raise ValueError(
                "`air` must be given with a `TurbulentForce`; its k and ε say how "
                "strong the noise is."
            )
        tangent, wind = node_tangents(r), air.at(r, t) - v
        across = wind - np.einsum("ni,ni->n", wind, tangent)[:, None] * tangent
        speed = np.linalg.norm(across, axis=1)
        strengths, out = self._strengths(air, r, speed, t), np.empty((*r.shape, 3))
        shaking(air.drag(string.diameter), wind, tangent, strengths, out)
        return out

    def _strengths(self, air: AirFlow, r: Array, speed: Array, t: float) -> Array:
        """Of the fluctuations along the fibre, the flow and their normal, (3, n)."""
        k, dissipation = air.turbulence_at(r, t)
        found = np.zeros((3, speed.size))
        rough = k > 0
        if not rough.any():
            return found
        k, dissipation, speed = k[rough], dissipation[rough], speed[rough]
        constant, viscosity = self.kolmogorov_constant, air.viscosity
        smallest = smallest_energy(dissipation, viscosity, constant)
        if not (k >= smallest).all():
            worst = (k / smallest).argmin()
            place = ", ".join(f"{x:.4g}" for x in r[rough][worst])
            raise ValueError(
                f"`k` of the air must be 0 or at least {smallest[worst]:g} where its "
                f"dissipation is {dissipation[worst]:g}, got {k[worst]:g} at ({place}) "
                "m; with less there is no inertial range."
            )
        if self.frozen and not (speed > 0).all():
            raise ValueError(
                f"`frozen` must be False where the air does not move across the fibre, "
                f"as at t = {t:g} s; eddies that do not pass are no white noise."
            )
        time = None
        if not self.frozen:
            given = self.decay_time
            time = k / dissipation if given is None else np.full(k.shape, given)
        found[:, rough] = white_amplitudes(
            k, dissipation, speed,
            viscosity=viscosity, constant=constant, decay_time=time,
        )  # fmt: skip
        return found
