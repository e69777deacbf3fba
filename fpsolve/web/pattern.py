"""What a row of nozzles in phase lays down on average: strips and holes."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.checks import check_kind, check_positive
from fpsolve.density.periodic.result import PeriodicState
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.web.pattern_harmonics import harmonics_of
from fpsolve.web.pattern_of_model import check_nozzle_model, pattern_of_model
from fpsolve.web.pattern_result import MeanPattern
from fpsolve.web.pattern_row import IN_PHASE, of_the_row, offsets_of

__all__ = ["MeanPattern", "mean_pattern"]


@recorded()
def mean_pattern(
    state: PeriodicState | LayDownModel,
    *,
    spacing: float,
    phases: Any = IN_PHASE,
    tolerance: float = 1e-3,
) -> MeanPattern:
    """E m(x) = Σ_j ∫ p(x − γ_j(s); s) ds: what a row of nozzles lays down on average.

    p is the density of ξ of the periodic state and γ_j the curve of nozzle j, at j d
    across the belt. With k = (2πn/L, 2πm/d) and nozzles in phase its Fourier
    coefficients relative to the mean are
    c_nm = (1/P) ∫ e^{−ik·γ(s)} E e^{−ik·ξ(s)} ds over a period P, exactly, whatever the
    curvature of γ: where that is small, 2|c_n0| is 2|J_n(nωr₁/v) φ_ξ(nω/v)|.

    Of a model the law comes from its generator, without a grid: E of Hermite
    polynomials times harmonics of α, about the mean of the fibre, is periodic in s, and
    its harmonics in ω solve one linear system, up to truncation in all three. The error
    of every c_nm is then twice the largest change from one truncation to the next, as
    in `web_spectrum`. It takes a second where a grid takes many.

    Parameters
    ----------
    state : PeriodicState or LayDownModel
        On a belt that moves. A model has a `QuadraticPotential`, A √σ >= 0.7, and a
        nozzle that circles or swings.
    spacing : float
        d, distance of neighbouring nozzles.
    phases : "in phase", "independent" or array_like, shape (N,)
        Of nozzle j relative to the state in radians, one after the other and again. For
        independent uniform ones the pattern varies across the belt alone.
    tolerance : float
        Of a model: for the amplitudes 2|c_nm|, relative to the mean of the pattern.

    Returns
    -------
    MeanPattern
        Of a state the waves that its cells resolve, of a model |k_i| σ_i <= 5.

    Raises
    ------
    ValueError
        If the belt does not move, the spacing is not positive, or the model of the
        state is not known; for a model that has another potential, less noise, or a
        nozzle at rest.
    ToleranceError
        If no truncation is fine enough for a model, which is so where its nozzle moves
        about as fast as the fibre is laid.

    References
    ----------
    [KMW09]_, section 4.2, figure 11: the strips and holes.
    """
    if isinstance(state, LayDownModel):
        check_nozzle_model(state)
        spacing = check_positive("spacing", spacing)
        return pattern_of_model(state, spacing, phases, checked_tolerance(tolerance))
    check_kind("state", state, PeriodicState, "it is what `periodic_state` returns")
    spacing, curve = check_positive("spacing", spacing), _moving_curve(state)
    offsets = offsets_of(phases)
    length, width = abs(curve.speed) * state.period, spacing * offsets.size
    found = harmonics_of(state, curve, length, width)
    row = of_the_row(found.k1, found.k2, phases, offsets, spacing, curve.speed)
    values = found.values * row
    middle = (found.k1.size // 2, found.k2.size // 2)
    # The mass of every density, which is one.
    values = values / values[middle]
    return MeanPattern(
        length=length,
        width=width,
        spacing=spacing,
        mean=1.0 / (abs(curve.speed) * spacing),
        coefficients=values,
        errors=found.errors * np.abs(row),
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
