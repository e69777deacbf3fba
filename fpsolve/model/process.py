"""A production process in SI units, and its dimensionless model."""

from __future__ import annotations

import math
import warnings
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_non_negative, check_positive, keep_checked
from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.curves.curve import Curve, check_speed
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["Process"]

# What industrial processes look like: name, lowest, highest, unit, and the slip that
# is likely outside.
_INDUSTRIAL_RANGES = (
    ("sigma1", 1e-3, 50e-3, " m", "millimetres given instead of metres"),
    ("sigma2", 1e-3, 50e-3, " m", "millimetres given instead of metres"),
    ("noise", 1.0, 50.0, " m^-1/2", "the dimensionless noise given instead"),
    ("speed_ratio", 0.01, 0.25, "", "per cent, or the inverse ratio, given instead"),
)
# Ten times beyond them is no process but a slip of units.
_POSSIBLE_RANGES = {
    "sigma1": (1e-4, 0.5),
    "sigma2": (1e-4, 0.5),
    "noise": (0.0, 500.0),
    "speed_ratio": (-1.0, 1.0),
}
# The curvature of a fibre relaxes over no more than the widest throwing range.
_LONGEST_RELAXATION = 0.5
# Faster than air, which pulls the fibre, can be.
_FASTEST_SPINNING = 1000.0


@dataclass(frozen=True)
class Process:
    """σ1* = 1, σ2* = σ2/σ1, A* = √σ1 A, R* = R/σ1: SI units to the model and back.

    The unit of length is the throwing range σ1; the arclength s has it too. The unit
    of time is σ1 divided by the spinning speed, because the fibre is laid down at that
    speed. The conversions are exact.

    Parameters
    ----------
    sigma1, sigma2 : float
        Throwing ranges along and across the belt in metres; 1 to 50 mm in industry.
    noise : float
        Noise amplitude A in m^-1/2; 1 to 50 in industry.
    speed_ratio : float
        Belt speed divided by spinning speed; 0.01 to 0.25 in industry, 0 for a belt at
        rest.
    spinning_speed : float
        Fibre length laid down per second, in m/s.
    relaxation_length : float, optional
        Length R in metres over which the curvature of the fibre relaxes. With it
        `model` is the smooth one, without it the basic one.

    Raises
    ------
    ValueError
        If a throwing range, the spinning speed or the relaxation length is not
        positive, the noise negative, or the speed ratio not between -1 and 1. Also
        where a number can only be a slip of units: throwing ranges outside 0.1 mm to
        0.5 m, a relaxation length above 0.5 m, a noise above 500 m^-1/2, a spinning
        speed of 1000 m/s or more.

    Warns
    -----
    UserWarning
        If a number lies outside its industrial range, with the likely slip.

    References
    ----------
    [KMW09]_, section 3.1, remark 3.1, and section 3.2.
    """

    _recorded: ClassVar[str] = "process"

    sigma1: float
    sigma2: float
    noise: float
    speed_ratio: float
    spinning_speed: float
    relaxation_length: float | None = None

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, "sigma1", "sigma2", "spinning_speed")
        keep_checked(self, check_non_negative, "noise")
        keep_checked(self, check_speed, "speed_ratio")
        self._check_relaxation_length()
        self._check_units()
        self._warn_outside_industrial_ranges()

    @property
    def model(self) -> FibreModel:
        """The dimensionless model: σ1* = 1, σ2* = σ2/σ1, A* = √σ1 A, R* = R/σ1."""
        belt: Curve = MovingBelt(self.speed_ratio) if self.speed_ratio else FixedBelt()
        potential = QuadraticPotential(1.0, self.sigma2 / self.sigma1)
        noise = math.sqrt(self.sigma1) * self.noise
        if self.relaxation_length is None:
            return LayDownModel(potential, noise, belt)
        length = self.relaxation_length / self.sigma1
        return SmoothLayDownModel(potential, length, noise, belt)

    @property
    def length(self) -> float:
        """Metres per unit of ξ and of s: σ1."""
        return self.sigma1

    @property
    def time(self) -> float:
        """Seconds per unit of s: σ1 divided by the spinning speed."""
        return self.sigma1 / self.spinning_speed

    def to_metres(self, x: ArrayLike) -> Array:
        """Lengths ξ or s in metres: x σ1."""
        return _times(x, self.length)

    def from_metres(self, x: ArrayLike) -> Array:
        """Lengths in metres as dimensionless ξ or s: x/σ1."""
        return _times(x, 1 / self.length)

    def to_seconds(self, s: ArrayLike) -> Array:
        """Time in seconds that it takes to lay down the arclength s."""
        return _times(s, self.time)

    def rate_per_metre(self, rate: ArrayLike) -> Array:
        """Rates per unit of s (a spectral gap, say) per metre of fibre."""
        return _times(rate, 1 / self.length)

    def rate_per_second(self, rate: ArrayLike) -> Array:
        """Rates per unit of s per second of production."""
        return _times(rate, 1 / self.time)

    def area_density(self, p: ArrayLike) -> Array:
        """Densities per unit of ξ plane per square metre: p/σ1².

        A density of (ξ, α) stays a density per radian in α.
        """
        return _times(p, self.length**-2)

    def to_dict(self) -> dict[str, Any]:
        """Return the parameters as a JSON-able dictionary."""
        return asdict(self)

    def _check_relaxation_length(self) -> None:
        if self.relaxation_length is None:
            return
        length = check_positive("relaxation_length", self.relaxation_length)
        if not length <= _LONGEST_RELAXATION:
            raise ValueError(
                f"`relaxation_length` must be at most {_LONGEST_RELAXATION:g} m, got "
                f"{length:g}; millimetres given instead of metres?"
            )
        object.__setattr__(self, "relaxation_length", length)

    def _check_units(self) -> None:
        for name, lowest, highest, unit, slip in _INDUSTRIAL_RANGES:
            number, possible = getattr(self, name), _POSSIBLE_RANGES[name]
            if not possible[0] <= number <= possible[1]:
                raise ValueError(
                    f"`{name}` must lie between {possible[0]:g} and {possible[1]:g}"
                    f"{unit}, got {number:g}; the industrial range is {lowest:g} to "
                    f"{highest:g}{unit}: {slip}?"
                )
        if not self.spinning_speed < _FASTEST_SPINNING:
            raise ValueError(
                f"`spinning_speed` must be below {_FASTEST_SPINNING:g} m/s, got "
                f"{self.spinning_speed:g}; metres per minute given instead?"
            )

    def _warn_outside_industrial_ranges(self) -> None:
        for name, lowest, highest, unit, slip in _INDUSTRIAL_RANGES:
            number = getattr(self, name)
            # Zero noise and a belt at rest are limiting cases, not slips.
            at_rest = number == 0 and name in ("noise", "speed_ratio")
            if at_rest or lowest <= abs(number) <= highest:
                continue
            warnings.warn(
                f"`{name}` is {number:g}{unit}, outside the industrial range "
                f"{lowest:g} to {highest:g}{unit}; {slip}?",
                UserWarning,
                stacklevel=4,
            )


def _times(numbers: ArrayLike, factor: float) -> Array:
    return check_numbers("x", numbers) * factor
