"""What a run puts up with before it stops."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import check_tolerance
from fpsolve.density.schemes.form import State
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.errors import (
    CirculationError,
    CurvatureRangeError,
    DomainTooSmallError,
    EntropyRiseError,
    MassDriftError,
    NegativeDensityError,
    NonFiniteDensityError,
)

__all__ = ["Tolerances", "check_finite", "check_record"]


@dataclass(frozen=True)
class Tolerances:
    """What a run puts up with before it stops."""

    mass: float
    boundary: float
    negative: float
    entropy: float = 0.1
    circulation: float = 0.05

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check_tolerance(f"{name}_tolerance", value)


def check_finite(p: NDArray[np.float64], s: float) -> None:
    """Raise unless every value of a density is a number."""
    # A sum is finite unless a cell is not, or the values are about to overflow.
    if not math.isfinite(float(p.sum())):
        bad = np.argwhere(~np.isfinite(p))
        index = bad[0] if len(bad) else np.unravel_index(np.argmax(p), p.shape)
        raise NonFiniteDensityError(s, tuple(int(i) for i in index))


def check_record(
    values: Mapping[str, float],
    mass: float,
    scheme: Scheme,
    state: State,
    allowed: Tolerances,
) -> None:
    """Raise if a record tells that a density is none, or a scheme repaired too much.

    Parameters
    ----------
    values : mapping
        What a `Recorder` found.
    mass : float
        At the start.
    scheme : Scheme
    state : State
        Of the scheme, with what its last step corrected.
    allowed : Tolerances
    """
    s, drift = values["s"], values["mass"] / mass - 1.0
    if not abs(drift) <= allowed.mass:
        raise MassDriftError(s, drift, allowed.mass)
    if not abs(state.correction) <= scheme.correction_limit:
        raise MassDriftError(s, state.correction, scheme.correction_limit)
    negative = values["negative_mass"] / values["mass"]
    if not negative <= allowed.negative:
        raise NegativeDensityError(s, negative, allowed.negative)
    boundary = values["boundary_mass"]
    if not boundary <= allowed.boundary:
        raise DomainTooSmallError(boundary, scheme.grid.half_width, s, allowed.boundary)
    at_ends = values.get("kappa_boundary_mass", 0.0)
    if not at_ends <= allowed.boundary:
        grid: Any = scheme.grid
        raise CurvatureRangeError(at_ends, grid.kappa_half_width, allowed.boundary, s)
    _check_laws(values, allowed)


def _check_laws(values: Mapping[str, float], allowed: Tolerances) -> None:
    """Raise if a record breaks what holds on a belt at rest; see `Recorder`."""
    rise = values.get("entropy_rise", 0.0)
    # An infinite tolerance asks not to be told, not even of NaN.
    if not (rise <= allowed.entropy or math.isinf(allowed.entropy)):
        raise EntropyRiseError(values["s"], rise, allowed.entropy)
    deviation = values.get("circulation_deviation", 0.0)
    if not (abs(deviation) <= allowed.circulation or math.isinf(allowed.circulation)):
        raise CirculationError(values["s"], deviation, allowed.circulation)
