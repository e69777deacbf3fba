"""Models, grids, starts and options drawn at random, ordinary ones and extreme ones."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import initial

__all__ = [
    "anisotropic",
    "belt",
    "curve",
    "drift_kick_options",
    "grid_for",
    "isotropic",
    "noise",
    "nozzle",
    "potential",
    "scaled_curve",
    "scaled_potential",
    "scheme",
    "semi_lagrangian_options",
    "shown",
    "start",
    "tilted",
]

ORDINARY = (0.3, 3.0)
EXTREME_NOISES = (0.0, 1e-12, 1e-3, 0.05, 8.0, 20.0, 1e3, 1e8)


@dataclass(frozen=True)
class LogCosh:
    """log 2 cosh ξ1/σ + k ξ2²/2σ²: smooth, isotropic nowhere."""

    stiffness: float
    sigma: float = 1.0

    def value(self, x: Any, y: Any) -> Any:
        x, y = np.divide(x, self.sigma), np.divide(y, self.sigma)
        return np.logaddexp(x, -x) + 0.5 * self.stiffness * y**2

    def gradient(self, x: Any, y: Any) -> Any:
        x, y = np.divide(x, self.sigma), np.divide(y, self.sigma)
        return np.tanh(x) / self.sigma, self.stiffness * y / self.sigma


@dataclass(frozen=True)
class Softened:
    """√(r² + c²) + b, everything in units of σ: linear far away, without the kink."""

    radius: float
    offset: float = 0.0
    sigma: float = 1.0

    def value(self, r: Any) -> Any:
        return np.hypot(np.divide(r, self.sigma), self.radius) + self.offset

    def slope(self, r: Any) -> Any:
        r = np.divide(r, self.sigma)
        return r / np.hypot(r, self.radius) / self.sigma


@dataclass(frozen=True)
class Quartic:
    """(r⁴/4 + a r²/2) in units of σ, as the user's own functions."""

    share: float
    sigma: float = 1.0

    def value(self, r: Any) -> Any:
        r = np.divide(r, self.sigma)
        return r**4 / 4 + self.share * r**2 / 2

    def slope(self, r: Any) -> Any:
        r = np.divide(r, self.sigma)
        return (r**3 + self.share * r) / self.sigma


OWN = {"log cosh": LogCosh, "softened": Softened, "quartic": Quartic}


def between(rng: Any, low: float, high: float) -> float:
    """A number of four digits, which a reader can type."""
    return float(f"{rng.uniform(low, high):.4g}")


def log_between(rng: Any, low: float, high: float) -> float:
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")


def one_of(rng: Any, *choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def wrapped(own: Any) -> Any:
    """A potential of the user's own functions, which remembers them."""
    if isinstance(own, LogCosh):
        made: Any = fp.CallablePotential(own.value, own.gradient)
    else:
        made = fp.IsotropicPotential(own.value, own.slope)
    object.__setattr__(made, "own", own)
    return made


def isotropic(rng: Any, smooth: bool = False, own: bool = True) -> Any:
    """An isotropic potential with one well."""
    kinds = ["quadratic", "power"] + ["linear", "kink"] * (not smooth)
    kind = one_of(rng, *kinds, *(["softened", "quartic"] if own else []))
    if kind == "quadratic":
        return fp.QuadraticPotential(*(between(rng, 0.7, 1.5),) * 2)
    if kind == "linear":
        return fp.LinearPotential(between(rng, 0.7, 2.0))
    if kind == "softened":
        offset = one_of(rng, 0.0, 0.0, between(rng, -30.0, 30.0))
        return wrapped(Softened(between(rng, 0.3, 2.0), offset))
    if kind == "quartic":
        return wrapped(Quartic(between(rng, 0.0, 2.0)))
    low = 2.0 if smooth else 1.0
    return fp.PowerPotential(between(rng, low, 4.0), between(rng, 0.8, 1.5))


def anisotropic(rng: Any) -> Any:
    if rng.random() < 0.3:
        return wrapped(LogCosh(between(rng, 0.5, 2.0)))
    return fp.QuadraticPotential(between(rng, 0.6, 1.6), between(rng, 0.6, 1.6))


def potential(rng: Any) -> Any:
    """Any potential; a steep wall now and then."""
    if rng.random() < 0.08:
        return fp.PowerPotential(one_of(rng, 12.0, 30.0, 60.0), between(rng, 1.5, 2.5))
    return isotropic(rng) if rng.random() < 0.6 else anisotropic(rng)


def noise(rng: Any, extreme: float = 0.25) -> float:
    if rng.random() < extreme:
        return float(one_of(rng, *EXTREME_NOISES))
    return log_between(rng, *ORDINARY)


def belt(rng: Any) -> Any:
    if rng.random() < 0.4:
        return fp.FixedBelt()
    return fp.MovingBelt(one_of(rng, between(rng, -0.5, 0.5), 0.999, -0.999, 1e-9))


def nozzle(rng: Any) -> Any:
    speed, radius = between(rng, -0.5, 0.5), between(rng, 0.0, 1.0)
    turning = one_of(rng, between(rng, -3.0, 3.0), 0.0, 60.0)
    phase = between(rng, -3.0, 3.0)
    return one_of(
        rng,
        fp.RotatingNozzle(speed, radius, turning, phase),
        fp.OscillatingNozzle(speed, radius, turning, phase),
        fp.EllipticNozzle(speed, radius, between(rng, 0.0, 1.0), turning, phase),
    )


def curve(rng: Any) -> Any:
    return belt(rng) if rng.random() < 0.6 else nozzle(rng)


def grid_for(rng: Any, half_width: float = 5.0, most: int = 24) -> Any:
    """A small grid: odd and even numbers of cells, square boxes and others."""
    n1, n2 = (int(rng.integers(8, most + 1)) for _ in range(2))
    n_alpha = 2 * int(rng.integers(3, 9))
    width = between(rng, 0.8 * half_width, 1.3 * half_width)
    widths = (width, between(rng, 0.8 * half_width, 1.3 * half_width))
    return fp.PhaseSpaceGrid(one_of(rng, width, widths), (n1, n2, n_alpha))


def start(rng: Any, grid: Any) -> Any:
    """A Gaussian that fits the box, somewhere off its middle."""
    away = 0.15 * min(grid.half_widths)
    mean = tuple(between(rng, -away, away) for _ in range(2))
    variance = between(rng, 0.5, 1.2) * (min(grid.half_widths) / 5.0) ** 2
    return initial.gaussian(
        grid, mean, variance, between(rng, -3.0, 3.0), between(rng, 0.0, 3.0)
    )


def drift_kick_options(rng: Any) -> dict[str, Any]:
    return {
        "positive": bool(rng.random() < 0.5),
        "balanced": bool(rng.random() < 0.5),
        "interpolation_order": one_of(rng, 2, 4, 6, 8),
    }


def semi_lagrangian_options(rng: Any) -> dict[str, Any]:
    return {
        "form": one_of(rng, "h", "h", "p"),
        "splitting": one_of(rng, "lie", "strang"),
        "diffusion": one_of(rng, "backward_euler", "crank_nicolson"),
        "interpolation_order": one_of(rng, 4, 6),
        "limited": bool(rng.random() < 0.5),
        "adjusted": bool(rng.random() < 0.5),
        "compact": bool(rng.random() < 0.5),
    }


def scheme(rng: Any) -> tuple[Any, dict[str, Any]]:
    """A constructor and its options."""
    if rng.random() < 0.6:
        return fp.drift_kick, drift_kick_options(rng)
    return fp.semi_lagrangian, semi_lagrangian_options(rng)


def scaled_potential(one: Any, sigma: float) -> Any:
    """B(ξ/σ), of the same kind."""
    if isinstance(one, fp.QuadraticPotential):
        return fp.QuadraticPotential(sigma * one.sigma1, sigma * one.sigma2)
    if isinstance(one, fp.LinearPotential):
        return fp.LinearPotential(one.slope / sigma)
    if isinstance(one, fp.PowerPotential):
        return fp.PowerPotential(one.exponent, sigma * one.scale)
    numbers = {**vars(one.own), "sigma": sigma * one.own.sigma}
    return wrapped(type(one.own)(**numbers))


def scaled_curve(one: Any, sigma: float) -> Any:
    """γ(s/σ) σ: the same belt speed, radii times σ, turning σ times slower."""
    names = ("radius", "radius1", "radius2", "amplitude")
    numbers = dict(vars(one))
    for name in names:
        if name in numbers:
            numbers[name] *= sigma
    if "angular_speed" in numbers:
        numbers["angular_speed"] /= sigma
    if isinstance(one, fp.FixedBelt):
        return one
    return type(one)(**numbers)


def tilted(one: Any) -> bool:
    """Whether nothing but the reflection across the belt is left as a symmetry."""
    return not one.fixed


def shown(one: Any) -> str:
    """One line that makes a reader find the object again."""
    if isinstance(one, fp.LayDownModel):
        inner = f"{shown(one.potential)}, {one.noise!r}, {one.curve!r}"
        return f"LayDownModel({inner})"
    return repr(getattr(one, "own", one))
