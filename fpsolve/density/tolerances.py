"""What a run puts up with before it stops."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fpsolve._support.checks import check_tolerance
from fpsolve.errors import CirculationError, EntropyRiseError

__all__ = ["Tolerances", "check_laws"]


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


def check_laws(values: Mapping[str, float], allowed: Tolerances) -> None:
    """Raise if a record breaks what holds on a belt at rest; see `Recorder`."""
    rise = values.get("entropy_rise", 0.0)
    # An infinite tolerance asks not to be told, not even of NaN.
    if not (rise <= allowed.entropy or math.isinf(allowed.entropy)):
        raise EntropyRiseError(values["s"], rise, allowed.entropy)
    deviation = values.get("circulation_deviation", 0.0)
    if not (abs(deviation) <= allowed.circulation or math.isinf(allowed.circulation)):
        raise CirculationError(values["s"], deviation, allowed.circulation)
