"""Gaussian noise that pulls at a fibre, drawn anew at every step."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_integer,
    check_non_negative,
    keep_checked,
    shown,
)
from fpsolve.fibre.air import AirFlow
from fpsolve.fibre.string import String

__all__ = [
    "Draws",
    "Noise",
    "RandomForce",
    "StochasticForce",
    "checked_law",
    "node_tangents",
    "noise_force",
]


class StochasticForce(Protocol):
    """A(r, ∂_t r, ∂_s r, s, t) of the force A·dw_{s,t} on a fibre."""

    @property
    def correlation_time(self) -> float:
        """τ in s; 0 for white noise."""
        ...

    def amplitudes(
        self, string: String, air: AirFlow | None, r: Array, v: Array, t: float
    ) -> Array:
        """A at every node, shape (n_edges + 1, 3, 3), in N s^½/m^½."""
        ...


@dataclass(frozen=True)
class RandomForce:
    """A dw_{s,t}: noise of the same strength everywhere and in all directions.

    Parameters
    ----------
    amplitude : float
        A in N s^½/m^½: during the time Δ a piece of the length h is given the momentum
        A √(h Δ) ξ, the components of ξ independent and standard normal.
    correlation_time : float
        τ in s of an Ornstein-Uhlenbeck process in time for every node, of the
        covariance A² e^{−|t|/τ}/(2τ) per length, whose limit for τ → 0 is the white
        noise of τ = 0. Across nodes it is white.

    Raises
    ------
    ValueError
        If a number is negative or not finite.

    References
    ----------
    [KMW09]_, equation (5) and remark 2.5.
    """

    _recorded: ClassVar[str] = "random_force"

    amplitude: float
    correlation_time: float = 0.0

    def __post_init__(self) -> None:
        keep_checked(self, check_non_negative, "amplitude", "correlation_time")

    def to_dict(self) -> dict[str, Any]:
        """The parameters, as JSON holds them."""
        return {"amplitude": self.amplitude, "correlation_time": self.correlation_time}

    def amplitudes(
        self, string: String, air: AirFlow | None, r: Array, v: Array, t: float
    ) -> Array:
        """A times the identity at every node, shape (n, 3, 3)."""
        shape = (len(r), 3, 3)
        return np.asarray(np.broadcast_to(self.amplitude * np.eye(3), shape))


@dataclass(eq=False)
class Noise:
    """Means over a step of independent noises η of unit strength: dw/dt, or correlated.

    White noise of a step is ξ/√Δ; correlated noise is the mean of the process over the
    step, exact for its law whatever the step. The numbers of a step are those of Philox
    under the key (seed, number of the step): a run is repeated bit by bit by its seed
    and its step. One of `pieces` steps in one draws the noise of all of them, so that
    both motions are driven by the same.

    Attributes
    ----------
    size : int
        Number of noises, of three components each.
    correlation_time : float
    dt : float
        Of a whole step.
    seed : int
    pieces : int
    """

    size: int
    correlation_time: float
    dt: float
    seed: int
    pieces: int = 1
    _process: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        time = self.correlation_time
        # At its stationary law; the steps are numbered from 1.
        self._process = np.zeros((self.size, 3))
        if time:
            self._process = self._normal(0, 1)[0] / math.sqrt(2 * time)

    def mean(self, number: int) -> Array:
        """Over the step of this number, shape (size, 3); to be asked for 1, 2, … ."""
        first = (number - 1) * self.pieces + 1
        means = [self._mean(first + piece) for piece in range(self.pieces)]
        return np.asarray(sum(means[1:], start=means[0]) / self.pieces)

    def _mean(self, number: int) -> Array:
        """Over one piece; the process moves on to the end of it."""
        dt, time = self.dt / self.pieces, self.correlation_time
        if not time:
            return np.asarray(self._normal(number, 1)[0] / math.sqrt(dt))
        mean, moved = correlated_step(dt, time)
        given = np.concatenate([self._process[None], self._normal(number, 2)])
        self._process = np.asarray(np.tensordot(moved, given, 1))
        return np.asarray(np.tensordot(mean, given, 1))

    def _normal(self, number: int, sets: int) -> Array:
        """The first standard normal numbers of a step, shape (sets, size, 3)."""
        key = np.array([self.seed, number], dtype=np.uint64)
        generator = np.random.Generator(np.random.Philox(key=key))
        return generator.standard_normal((sets, self.size, 3))


@dataclass(eq=False)
class Draws:
    """Forces on the nodes, one step after the other: √h A(r⁰, v⁰) times the noise.

    The amplitude is that at the beginning of a step, as Itô's integral has it.

    Attributes
    ----------
    law : StochasticForce
    string : String
    air : AirFlow or None
    dt : float
        Of a whole step.
    seed : int
    pieces : int
    """

    law: StochasticForce
    string: String
    air: AirFlow | None
    dt: float
    seed: int
    pieces: int = 1
    noise: Noise = field(init=False, repr=False)

    def __post_init__(self) -> None:
        nodes, time = self.string.n_edges + 1, self.law.correlation_time
        self.noise = Noise(nodes, time, self.dt, self.seed, self.pieces)

    def value(self, number: int, r: Array, v: Array, t: float) -> Array:
        """Force on every node during the step of this number, in N, shape (n, 3).

        To be asked for step 1, 2, … in turn, with what the step begins with.
        """
        lengths = self.string.masses / self.string.line_density
        amplitudes = self.law.amplitudes(self.string, self.air, r, v, t)
        return noise_force(lengths, amplitudes, self.noise.mean(number))


def checked_law(
    turbulence: StochasticForce | None, seed: int | None
) -> tuple[StochasticForce, int] | None:
    """Both, or None; TypeError unless they are given together."""
    if (turbulence is None) != (seed is None):
        given = "`seed`" if turbulence is None else "`turbulence`"
        raise TypeError(
            f"`turbulence` and `seed` must be given together, got {given} alone."
        )
    if turbulence is None:
        return None
    if not hasattr(turbulence, "amplitudes"):
        raise TypeError(
            f"`turbulence` must be a `RandomForce` or a `TurbulentForce`, got "
            f"{shown(turbulence)}."
        )
    return turbulence, check_integer("seed", seed, 0)


def noise_force(lengths: Array, amplitudes: Array, noise: Array) -> Array:
    """√h A η on every node, shape (n, 3)."""
    drawn = np.einsum("nij,nj->ni", amplitudes, noise)
    return np.asarray(np.sqrt(lengths)[:, None] * drawn)


def correlated_step(dt: float, time: float) -> tuple[Array, Array]:
    """Coefficients of (η, ξ₁, ξ₂) in the mean of η over a step, and in η at its end.

    Of dη = −η/τ dt + dw/τ, ξ standard normal: the joint Gaussian law of both, exact for
    every step.
    """
    forgotten = -math.expm1(-dt / time)
    # Variances of what is added to η and to its integral, and their covariance.
    added = forgotten * (2 - forgotten) / (2 * time)
    both = 0.5 * forgotten**2
    whole = dt - 2 * time * forgotten + 0.5 * time * forgotten * (2 - forgotten)
    # A difference that vanishes like dt³, which rounding may leave negative.
    rest = math.sqrt(max(whole - both**2 / added, 0.0))
    mean = np.array([time * forgotten, both / math.sqrt(added), rest]) / dt
    return mean, np.array([1 - forgotten, math.sqrt(added), 0.0])


def node_tangents(r: Array) -> Array:
    """Unit vectors along the sum of both neighbouring edges; of one at an end."""
    edges = np.diff(r, axis=0)
    tangent = np.concatenate([edges[:1], edges[1:] + edges[:-1], edges[-1:]])
    return np.asarray(tangent / np.linalg.norm(tangent, axis=1, keepdims=True))
