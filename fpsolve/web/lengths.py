"""Lengths that a web needs: over which a fibre forgets, and which a step resolves."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.nodes import gibbs_nodes

__all__ = ["Lengths", "lengths_of"]


@dataclass(frozen=True)
class Lengths:
    """Over which a fibre forgets, the longest step, the period of the nozzles."""

    relaxation: float
    step: float
    period: float


def lengths_of(model: FibreModel) -> Lengths:
    """The lengths of a model whose potential confines and whose noise is positive.

    Raises
    ------
    ValueError
        If the potential does not confine, or there is no noise: the fibre then never
        forgets its start, and no web of it is stationary.
    """
    if not model.noise > 0:
        raise ValueError(
            f"`model` must have noise for a web to be stationary, got {model.noise:g}; "
            "without noise a fibre never forgets where it began."
        )
    nodes = gibbs_nodes(model.potential)
    deviations = nodes.deviations()
    finest = min(1.0 / math.sqrt(max(nodes.mean_square_forces())), *deviations)
    period = period_of(model.curve)
    length = Persistence.of(model).relaxation_length
    # A smooth fibre also forgets its curvature, over R.
    relaxation = relaxation_length(model.noise, max(deviations)) + length
    return Lengths(
        relaxation=rounded(relaxation),
        step=rounded(longest_step(model.noise, finest, period, length)),
        period=period,
    )


def period_of(curve: Curve) -> float:
    """The period that a curve names, a user's own one too; 0 for none."""
    period = 0.0 if curve.autonomous else float(getattr(curve, "period", 0.0))
    return period if 0 < period < math.inf else 0.0


def relaxation_length(noise: float, deviation: float) -> float:
    """2/A² + A²σ²: the length over which a fibre forgets, or somewhat more.

    The first is that of little noise, over which the energy wanders, the second that
    of much, over which ξ does. Times the spectral gap of the quadratic potential it is
    1.00 at A = 0.3, 1.11 at A = 1, 1.24 at A = 2, 1.03 at A = 3 and 0.99 at A = 10.
    """
    return 2.0 / noise**2 + (noise * deviation) ** 2


def longest_step(noise: float, finest: float, period: float, smooth: float) -> float:
    """The longest step that resolves force, noise and nozzle.

    Parameters
    ----------
    noise : float
        A.
    finest : float
        Shortest length over which the force changes.
    period : float
        Of the nozzle; 0 for none.
    smooth : float
        Relaxation length R of a smooth model; 0 for the basic one.
    """
    steps = [0.1 * finest]
    if smooth > 0:
        # Mean turn of a step by the stationary curvature: a third of a radian.
        steps.append(math.sqrt(2 * smooth) / (3 * noise))
    else:
        steps.append(0.5 / noise**2)
    if period > 0:
        steps.append(0.1 / math.pi * period)
    return min(steps)


def rounded(length: float) -> float:
    """To three digits: sums of quadratures are rounded otherwise on another machine.

    A step that differs in its last digit makes another web.
    """
    return float(f"{length:.3g}")
