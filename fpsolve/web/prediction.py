"""What a web will be like, as computed from the generator."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import Attribute, Layout, Part, Source, Stored, Variable
from fpsolve.evolution.parts import Model
from fpsolve.evolution.saved import Saved
from fpsolve.model.fibre import FibreModel

__all__ = ["POSITIONS", "WebPrediction"]

# Of the nozzles across the belt.
POSITIONS = ("regular", "random")
_ZONE, _BAND, _STRIP = ("zone",), ("band",), ("strip",)
_PARAMETER = ("parameter",)


def _checked_positions(name: str) -> str:
    if name not in POSITIONS:
        raise ValueError(f"`positions` must be one of {POSITIONS}, got {name!r}")
    return name


class _Parameters(Part):
    """What it is differentiated in, as texts; none in a file without derivatives."""

    def write(self, result: Any) -> Stored:
        names = np.array(result.parameters, dtype=object)
        return {"parameter": (_PARAMETER, names)} if names.size else {}

    def read(self, source: Source) -> dict[str, Any]:
        if "parameter" not in source.dataset:
            return {"parameters": ()}
        stored = source.dataset["parameter"]
        names = tuple(stored.values.ravel().tolist())
        if stored.dims != _PARAMETER or not all(isinstance(one, str) for one in names):
            raise ValueError("`parameter` must hold names over parameter")
        return {"parameters": names}


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
    _Parameters(),
    Variable("gradient", ("parameter", "zone"), "∂CV/∂parameter", optional=True),
    Variable("gradient_error", ("parameter", "zone"), "error of ∂CV/∂parameter",
             "gradient_errors", optional=True),
    Variable("strip_gradient", ("parameter", "strip"),
             "∂amplitude/∂parameter of the strips", optional=True),
    Variable("strip_gradient_error", ("parameter", "strip"),
             "error of ∂amplitude/∂parameter", "strip_gradient_errors", optional=True),
    Variable("cloudiness_gradient", ("parameter", "band"), "∂cloudiness/∂parameter",
             optional=True),
    Variable("cloudiness_gradient_error", ("parameter", "band"),
             "error of ∂cloudiness/∂parameter", "cloudiness_gradient_errors",
             optional=True),
    Variable("orientation_gradient", ("parameter", "row", "column"),
             "∂⟨τ⊗τ⟩/∂parameter", optional=True),
    Variable("orientation_gradient_error", ("parameter", "row", "column"),
             "error of ∂⟨τ⊗τ⟩/∂parameter", "orientation_gradient_errors",
             optional=True),
    Variable("carried_error", ("zone",),
             "standard error of CV by the errors of identified parameters",
             "carried_errors", optional=True),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class WebPrediction(Saved):
    """The homogeneity of a web without a random number, with errors.

    Of a `Process` all lengths are metres, else in the unit of ξ.

    Attributes
    ----------
    model : LayDownModel, SmoothLayDownModel or None
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
    parameters : tuple of str
        Of a model "noise", "belt_speed", "sigma1", "sigma2", "spacing", of a process
        "speed_ratio" in place of the second, of smooth fibres "relaxation_length"
        before the last; none unless `gradients` were asked for.
    gradient, gradient_errors : ndarray, shape (parameter, zone), or None
        ∂CV/∂parameter at fixed other parameters, and bounds of the errors.
    strip_gradient, strip_gradient_errors : ndarray, shape (parameter, strip), or None
        ∂ of `strips`.
    cloudiness_gradient, cloudiness_gradient_errors : ndarray or None
        ∂ of `cloudiness`, of shape (parameter, band).
    orientation_gradient, orientation_gradient_errors : ndarray or None
        ∂ of `orientation`, of shape (parameter, 2, 2).
    carried_errors : ndarray, shape (n_zones,), or None
        Standard errors of CV by those of identified parameters, where
        `Identification.carry_errors` has added them.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "web-prediction"
    layout = PREDICTION

    model: FibreModel | None
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
    parameters: tuple[str, ...] = ()
    gradient: Array | None = None
    gradient_errors: Array | None = None
    strip_gradient: Array | None = None
    strip_gradient_errors: Array | None = None
    cloudiness_gradient: Array | None = None
    cloudiness_gradient_errors: Array | None = None
    orientation_gradient: Array | None = None
    orientation_gradient_errors: Array | None = None
    carried_errors: Array | None = None
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def mean(self) -> float:
        """Laid length per area, 1/(v d), exactly."""
        if self.model is None:
            return math.nan
        return 1.0 / (abs(float(self.model.curve.velocity(0.0)[0])) * self.spacing)

    @property
    def mean_gradient(self) -> Array | None:
        """∂`mean` of 1/(v d) in every parameter, exactly; None without `gradients`."""
        if not self.parameters:
            return None
        speed = math.nan if self.model is None else self.model.belt_speed
        by = {"belt_speed": speed, "speed_ratio": speed, "spacing": self.spacing}
        return np.array(
            [-self.mean / by[name] if name in by else 0.0 for name in self.parameters]
        )

    @property
    def machine_cross_ratio(self) -> float:
        """MD/CD = ⟨τ₁²⟩/⟨τ₂²⟩, 1 without a preferred direction."""
        return float(self.orientation[0, 0] / self.orientation[1, 1])

    @property
    def machine_cross_gradient(self) -> Array | None:
        """∂ `machine_cross_ratio` = ∂⟨τ₁²⟩/⟨τ₂²⟩² in every parameter.

        None without `gradients`. From ⟨τ₁²⟩ + ⟨τ₂²⟩ = 1.
        """
        if self.orientation_gradient is None:
            return None
        return np.asarray(
            self.orientation_gradient[:, 0, 0] / self.orientation[1, 1] ** 2
        )

    @property
    def machine_cross_gradient_errors(self) -> Array | None:
        """Bounds of its errors, by those of the orientation and of its derivatives."""
        if (
            self.orientation_gradient is None
            or self.orientation_gradient_errors is None
        ):
            return None
        across, error = self.orientation[1, 1], self.orientation_errors[1, 1]
        least = max(across - error, 0.0)
        with np.errstate(divide="ignore"):
            largest = np.abs(self.orientation_gradient[:, 0, 0])
            changed = largest * np.abs(1.0 / np.square(least) - 1.0 / across**2)
            return np.asarray(
                changed + self.orientation_gradient_errors[:, 0, 0] / np.square(least)
            )

    def __repr__(self) -> str:
        told = ", ".join(
            f"{cv:.4g} ± {error:.1g} at {zone:g}"
            for zone, cv, error in zip(self.zones, self.cv, self.errors, strict=True)
        )
        by = f", ∂ by {', '.join(self.parameters)}" if self.parameters else ""
        return f"WebPrediction(mean {self.mean:.4g}, CV {told}{by})"

    def small_zone_law(self) -> Array:
        """CV of zones so small that fibres cross them as random straight lines.

        CV² → 0.946402 v d/x for a web without a preferred direction, 0.946402 =
        (4/π) [ln(1 + √2) + (1 − √2)/3].
        """
        number = 4 / math.pi * (math.log(1 + math.sqrt(2)) + (1 - math.sqrt(2)) / 3)
        return np.sqrt(number / (self.mean * self.zones))
