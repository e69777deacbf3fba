"""The end of long waves: no fibre gets lost, so that Ŝ begins with a quadratic form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from fpsolve._support.arrays import Array
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder, grown
from fpsolve.spectral.resolvent.waves import along_long_waves, solver_of

__all__ = ["LongWaveLimit", "long_wave_form", "long_wave_limit", "reach_of"]

# Of `reach_of`: the quadratic form lacks about the square of it, relatively.
NEAR = 1e-3


@dataclass(frozen=True)
class LongWaveLimit:
    """Ŝ = c1 k1² + c2 k2² + O(|k|⁴), and what bounds the rest.

    Attributes
    ----------
    form, errors : ndarray, shape (2,)
        (c1, c2) and bounds of their errors.
    quartic : ndarray, shape (3,)
        Coefficients of k1⁴, k1² k2² and k2⁴, to a few digits.
    reach : float
        |k| up to which they were measured.
    """

    form: Array
    errors: Array
    quartic: Array
    reach: float

    def __call__(self, k1: Array, k2: Array) -> tuple[Array, Array]:
        """Ŝ by the quadratic form, and bounds of the errors; |k| <= `reach`."""
        squares = np.stack([k1**2, k2**2], axis=-1)
        products = np.stack([k1**4, k1**2 * k2**2, k2**4], axis=-1)
        # Of the terms beyond the fourth nothing is known but that they are smaller.
        rest = 2 * products @ np.abs(self.quartic)
        return squares @ self.form, squares @ self.errors + rest


def reach_of(ladder: Ladder) -> float:
    """|k| up to which the quadratic form serves.

    Its rest is small where |k| σ is, and k1 v against the rate of forgetting, A²/2 at
    low noise and 1/(σ² A²) at high noise.
    """
    wide, diffusivity = max(ladder.scales), ladder.model.diffusivity
    rate = diffusivity / (1.0 + 2.0 * (diffusivity * wide) ** 2)
    return NEAR / (wide + abs(ladder.model.curve.speed) / rate)


def long_wave_form(generator: Generator) -> Array:
    """c_i = 2 E ξi (−L)⁻¹ (ξi − E ξi): two equations of Poisson.

    Ŝ at k is then the spectrum of k·ξ at frequency zero: of e^{ik·ξ} only ik·ξ is left,
    and of i k1 v − L only −L. By reflection ξ1 and ξ2 are not correlated.
    """
    form = np.zeros(2)
    stationary, constant = generator.stationary, np.eye(1, generator.basis.size)[0]
    for axis, (position, sign) in enumerate(
        zip(generator.positions, (1, -1), strict=True)
    ):
        states = generator.basis.parity(sign)
        inner = sparse.csr_array(generator.matrix[states][:, states])
        row = position.T @ stationary
        row = row - row[0] * stationary
        right = position @ constant
        solution = solver_of(-inner).solve(right[states])
        form[axis] = 2 * (row[states] @ solution)
    return form


def long_wave_limit(
    ladder: Ladder, first: Basis, tolerance: float, most: int
) -> LongWaveLimit:
    """The form to a relative tolerance, and the rest from Ŝ at three wave vectors.

    Raises
    ------
    ToleranceError
        As `Ladder.climb`.
    """
    forms, errors, level = ladder.climb(
        first,
        lambda generator: long_wave_form(generator)[:, None],
        lambda found: tolerance * np.abs(found),
        most=most,
    )
    form, errors = forms[:, 0], errors[:, 0]
    reach, generator = reach_of(ladder), ladder.generator(grown(first, level))
    return LongWaveLimit(form, errors, quartic_form(generator, form, reach), reach)


def quartic_form(generator: Generator, form: Array, k: float) -> Array:
    """Coefficients of k1⁴, k1² k2², k2⁴ from Ŝ at (k, 0), (k, k) and (0, k)."""
    vectors = ((k, 0.0), (k, k), (0.0, k))
    lacks = [
        along_long_waves(generator, k1, [k2])[0] - form @ (k1**2, k2**2)
        for k1, k2 in vectors
    ]
    first, both, last = np.array(lacks) / k**4
    return np.array([first, both - first - last, last])
