"""What a web will be like, as computed from the generator."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import Attribute, Layout, Variable
from fpsolve.evolution.parts import Model
from fpsolve.evolution.saved import Saved
from fpsolve.model.laydown import LayDownModel

__all__ = ["POSITIONS", "WebPrediction"]

# Of the nozzles across the belt.
POSITIONS = ("regular", "random")
_ZONE, _BAND, _STRIP = ("zone",), ("band",), ("strip",)


def _checked_positions(name: str) -> str:
    if name not in POSITIONS:
        raise ValueError(f"`positions` must be one of {POSITIONS}, got {name!r}")
    return name


PREDICTION = Layout(
    "Predicted web",
    Model(),
    Variable("spacing", (), "distance of the spinning positions", kind=float),
    Variable("length", (), "length of one unit of ξ", kind=float),
    Attribute("positions", read_as=_checked_positions),
    Variable("zone", _ZONE, "side of the zone", "zones"),
    Variable("cv", _ZONE, "CV of the zones"),
    Variable("cv_error", _ZONE, "error of CV", "errors"),
    Variable("shortest", _BAND, "shortest wavelength"),
    Variable("longest", _BAND, "longest wavelength"),
    Variable("cloudiness", _BAND, "part of CV² in the band"),
    Variable("cloudiness_error", _BAND, "error of the part", "cloudiness_errors"),
    Variable("strips", _STRIP, "amplitude of the strips relative to the mean"),
    Variable("strip_error", _STRIP, "error of the amplitude", "strip_errors"),
    Variable("orientation", ("row", "column"), "⟨τ⊗τ⟩"),
    Variable("orientation_error", ("row", "column"), "error of ⟨τ⊗τ⟩",
             "orientation_errors"),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class WebPrediction(Saved):
    """The homogeneity of a web without a random number, with errors.

    Of a `Process` all lengths are metres, else in the unit of ξ.

    Attributes
    ----------
    model : LayDownModel or None
        None where it was read back and is a user's own.
    spacing : float
        Distance d of the spinning positions across the belt.
    length : float
        Of one unit of ξ: that of the process in metres, or 1. All lengths here,
        wavelengths and the mean have its unit.
    positions : {"regular", "random"}
    zones : ndarray
        Sides of square zones.
    cv, errors : ndarray
        Coefficient of variation of the length in such a zone, and bounds of its errors.
    shortest, longest : ndarray
        Bands of wavelengths.
    cloudiness, cloudiness_errors : ndarray
        Part of CV² that has its waves in each band.
    strips, strip_errors : ndarray
        Amplitudes, relative to the mean, of the waves cos(2πj ξ2/d), j = 1, 2, 3, that
        regular positions leave in the mean web; none for random ones.
    orientation, orientation_errors : ndarray, shape (2, 2)
        ⟨τ⊗τ⟩ over laid length, index 0 in the machine direction.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "web-prediction"
    layout = PREDICTION

    model: LayDownModel | None
    spacing: float
    length: float
    positions: str
    zones: Array
    cv: Array
    errors: Array
    shortest: Array
    longest: Array
    cloudiness: Array
    cloudiness_errors: Array
    strips: Array
    strip_errors: Array
    orientation: Array
    orientation_errors: Array
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def mean(self) -> float:
        """Laid length per area, 1/(v d), exactly."""
        if self.model is None:
            return math.nan
        return 1.0 / (abs(float(self.model.curve.velocity(0.0)[0])) * self.spacing)

    @property
    def machine_cross_ratio(self) -> float:
        """MD/CD = ⟨τ₁²⟩/⟨τ₂²⟩, 1 without a preferred direction."""
        return float(self.orientation[0, 0] / self.orientation[1, 1])

    def __repr__(self) -> str:
        told = ", ".join(
            f"{cv:.4g} ± {error:.1g} at {zone:g}"
            for zone, cv, error in zip(self.zones, self.cv, self.errors, strict=True)
        )
        return f"WebPrediction(mean {self.mean:.4g}, CV {told})"

    def small_zone_law(self) -> Array:
        """CV of zones so small that fibres cross them as random straight lines.

        CV² → 0.946402 v d/x for a web without a preferred direction, 0.946402 =
        (4/π) [ln(1 + √2) + (1 − √2)/3].
        """
        number = 4 / math.pi * (math.log(1 + math.sqrt(2)) + (1 - math.sqrt(2)) / 3)
        return np.sqrt(number / (self.mean * self.zones))
