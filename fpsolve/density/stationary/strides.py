"""A density over a stride of arclength, with one step length or several combined."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fpsolve._kernels.threads import threads_worth_their_wait
from fpsolve._support.arrays import Array
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.form import State
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.evolution.richardson import weights_of

__all__ = ["DIVISORS", "STRIDE", "Stride", "Strides"]


# One application of the map covers about this arclength: long enough for the slow
# modes to move, short enough that the fast ones cost few steps.
STRIDE = 1.0
# Steps of a stride relative to the longest.
DIVISORS = (1, 2, 3)


class Stride:
    """The density evolved over a stride, as a map for a Krylov solver.

    Parameters
    ----------
    scheme : Scheme
    ds : float
    divisor : int
        Make this many steps of ds/divisor for every one of ds.
    length : float
        The arclength to cover, rounded to a whole number of steps; from s = 0.
    """

    def __init__(
        self, scheme: Scheme, ds: float, divisor: int = 1, length: float = STRIDE
    ) -> None:
        self.scheme, self.ds = scheme, ds / divisor
        self.n_steps = divisor * max(1, round(length / ds))
        self.n_applications = 0

    @property
    def stride(self) -> float:
        """The arclength of one application."""
        return self.n_steps * self.ds

    def __call__(self, p: Array) -> Array:
        """Evolve p over the stride."""
        self.n_applications += 1
        with threads_worth_their_wait(p.size):
            state: State = self.scheme.start(p)
            self.scheme.advance(state, 0.0, self.ds, self.n_steps)
            # A scheme may correct what is read, and go on from what is not.
            read = getattr(self.scheme, "evolved", self.scheme.density)
            density: Array = read(state).copy()
            return density


class Strides:
    """The same stride with ds, ds/2 and ds/3, and what they say together (Neville).

    The error of the palindrome has even powers of ds only; a combination of the three
    is left with ds⁶.

    Parameters
    ----------
    scheme : DriftKick
    ds : float
    extrapolate : bool
        Whether `answer` is the combination, or the stride with ds alone.
    length : float
        As for `Stride`.
    """

    def __init__(
        self, scheme: DriftKick, ds: float, extrapolate: bool = True,
        length: float = STRIDE,
    ) -> None:  # fmt: skip
        self.extrapolate = extrapolate
        self.evolutions = [Stride(scheme, ds, j, length) for j in DIVISORS]

    @property
    def n_applications(self) -> int:
        """Strides evolved."""
        return sum(one.n_applications for one in self.evolutions)

    @property
    def longest(self) -> Stride:
        """The stride with ds."""
        return self.evolutions[0]

    def __call__(self, p: Array) -> list[Array]:
        """p after the stride, by every step length."""
        return [evolution(p) for evolution in self.evolutions]

    def readings(self, images: Sequence[Array]) -> list[Array] | None:
        """What is added to the images where they are read; None if nothing is."""
        correction = getattr(self.longest.scheme, "correction_of", None)
        if correction is None:
            return None
        of_each = zip(images, self.evolutions, strict=True)
        return [correction(p, one.ds) for p, one in of_each]

    def answer(self, images: Sequence[Array]) -> Array:
        """The stride whose stationary density is looked for."""
        return self._combined(images, 0) if self.extrapolate else images[0]

    def step_error(self, images: Sequence[Array]) -> Array:
        """What the answer does over a stride that another does not.

        The other is the combination without the longest step, which is less accurate;
        with ds alone the combination of all, which is more.
        """
        other = 1 if self.extrapolate else 0
        return self.answer(images) - self._combined(images, other)

    def splitting(self, images: Sequence[Array]) -> Array:
        """What the stride with ds alone does that the combination of all does not."""
        return images[0] - self._combined(images, 0)

    def _combined(self, images: Sequence[Array], first: int) -> Array:
        weights = weights_of(DIVISORS[first:])
        total = np.zeros_like(images[0])
        for weight, image in zip(weights, images[first:], strict=True):
            total += weight * image
        return total
