"""What a row of nozzles in phase lays down on average: strips and holes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_kind, check_positive, shown
from fpsolve.density.periodic.result import PeriodicState
from fpsolve.evolution.call import recorded
from fpsolve.web.pattern_harmonics import Complex, Harmonics, harmonics_of
from fpsolve.web.pattern_result import MeanPattern

__all__ = ["MeanPattern", "mean_pattern"]

IN_PHASE, INDEPENDENT = "in phase", "independent"


@recorded()
def mean_pattern(
    state: PeriodicState, *, spacing: float, phases: Any = IN_PHASE
) -> MeanPattern:
    """E m(x) = Σ_j ∫ p(x − γ_j(s); s) ds: what a row of nozzles lays down on average.

    p is the density of ξ of the periodic state and γ_j the curve of nozzle j, at j d
    across the belt. With k = (2πn/L, 2πm/d) and nozzles in phase its Fourier
    coefficients relative to the mean are
    c_nm = (1/P) ∫ e^{−ik·γ(s)} E e^{−ik·ξ(s)} ds over a period P, exactly, whatever the
    curvature of γ: where that is small, 2|c_n0| is 2|J_n(nωr₁/v) φ_ξ(nω/v)|.

    Parameters
    ----------
    state : PeriodicState
        On a belt that moves.
    spacing : float
        d, distance of neighbouring nozzles.
    phases : "in phase", "independent" or array_like, shape (N,)
        Of nozzle j relative to the state in radians, one after the other and again. For
        independent uniform ones the pattern varies across the belt alone.

    Returns
    -------
    MeanPattern

    Raises
    ------
    ValueError
        If the belt does not move, the spacing is not positive, or the model of the
        state is not known.

    References
    ----------
    [KMW09]_, section 4.2, figure 11: the strips and holes.
    """
    check_kind("state", state, PeriodicState, "it is what `periodic_state` returns")
    spacing, curve = check_positive("spacing", spacing), _moving_curve(state)
    offsets = _offsets(phases)
    length, width = abs(curve.speed) * state.period, spacing * offsets.size
    found = harmonics_of(state, curve, length, width)
    of_the_row = _of_the_row(found, phases, offsets, spacing, curve.speed)
    values = found.values * of_the_row
    middle = (found.k1.size // 2, found.k2.size // 2)
    # The mass of every density, which is one.
    values = values / values[middle]
    return MeanPattern(
        length=length,
        width=width,
        spacing=spacing,
        mean=1.0 / (abs(curve.speed) * spacing),
        coefficients=values,
        errors=found.errors * np.abs(of_the_row),
        phases=phases if isinstance(phases, str) else tuple(offsets.tolist()),
    )


def _moving_curve(state: PeriodicState) -> Any:
    if state.model is None:
        raise ValueError(
            "`state` must know its model, got one whose curve was a user's own and "
            "could not be read back; compute it again."
        )
    curve = state.model.curve
    if curve.speed == 0:
        raise ValueError(
            f"`state` must be on a belt that moves, got {curve!r}; the web on a belt "
            "at rest grows without end."
        )
    return curve


def _offsets(phases: Any) -> Array:
    """The phases of nozzles one after the other; 0 for words."""
    if isinstance(phases, str):
        if phases not in (IN_PHASE, INDEPENDENT):
            raise ValueError(
                f"`phases` must be {IN_PHASE!r}, {INDEPENDENT!r} or an array, got "
                f"{shown(phases)}."
            )
        return np.zeros(1)
    offsets = check_finite_numbers("phases", phases)
    if offsets.ndim != 1 or offsets.size == 0:
        raise ValueError(
            f"`phases` must have the shape (N,), got {offsets.shape}; one for every "
            "nozzle until they are repeated."
        )
    return offsets


def _of_the_row(
    found: Harmonics, phases: Any, offsets: Array, spacing: float, speed: float
) -> Complex:
    """(1/N) Σ_j e^{−i(n φ_j + k₂ j d)} of N nozzles, one after the other.

    A nozzle that is ahead by a phase has laid, at the same place of the belt, what
    another lays earlier: its pattern is moved along the belt.
    """
    n = np.arange(found.k1.size) - found.k1.size // 2
    if isinstance(phases, str) and phases == INDEPENDENT:
        return np.where(n == 0, 1.0, 0.0)[:, None].astype(np.complex128)
    along = np.exp(-1j * math.copysign(1.0, speed) * np.multiply.outer(n, offsets))
    places = np.arange(offsets.size) * spacing
    across = np.exp(-1j * np.multiply.outer(places, found.k2))
    factors: Complex = along @ across / offsets.size
    return factors
