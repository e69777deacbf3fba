"""What drives a path besides noise: the force ∇B and the motion of the curve."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fpsolve._kernels import paths as kernels
from fpsolve._support.arrays import Array
from fpsolve.model.curves.curve import Curve
from fpsolve.model.potentials.free import FreePotential
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential

__all__ = ["OwnMotion", "compiled_potential", "half_step_shifts", "step_shifts"]

# c⁻ⁿ of a power is kept that far from the largest and the smallest number.
MOST_DECADES = 250.0
# Powers of ‖ξ‖² up to here are multiplied out.
LARGEST_EVEN = 64


@dataclass(frozen=True, eq=False)
class OwnMotion:
    """What the nozzle of every path adds to the motion of the curve.

    Attributes
    ----------
    parts : (Curve, Curve)
    weights : ndarray, shape (2, n_paths)
        By which each path multiplies and adds them.
    """

    parts: tuple[Curve, Curve]
    weights: Array

    def of(self, path: int) -> OwnMotion:
        """That of a single path."""
        return replace(self, weights=self.weights[:, path : path + 1])


def step_shifts(
    curve: Curve,
    own: OwnMotion | None,
    s_start: float,
    ds: float,
    step: int,
    n_steps: int,
) -> kernels.Shifts:
    """Displacements of γ and of what is added to it, over both halves of every step."""
    common = half_step_shifts(curve, s_start, ds, step, n_steps)
    if own is None:
        return kernels.Shifts(common, np.zeros((0, 2, 2, 2)), np.zeros((2, 0)))
    parts = [half_step_shifts(part, s_start, ds, step, n_steps) for part in own.parts]
    return kernels.Shifts(
        common, np.stack(parts, axis=-1), np.ascontiguousarray(own.weights)
    )


def compiled_potential(potential: Potential) -> tuple[int, float, float] | None:
    """Kind and two parameters of a potential that the kernels know, else None.

    ∇B is (a ξ1, b ξ2) for the kind QUADRATIC, a ξ/‖ξ‖ for LINEAR, and a ‖ξ‖ⁿ⁻² ξ for
    the powers n.
    """
    # A subclass may have a gradient of its own.
    if type(potential) is FreePotential:
        return kernels.FREE, 0.0, 0.0
    if type(potential) is QuadraticPotential:
        stiffness = potential.sigma1**-2.0, potential.sigma2**-2.0
        return kernels.QUADRATIC, *stiffness
    if type(potential) is LinearPotential:
        return kernels.LINEAR, potential.slope, 0.0
    if type(potential) is PowerPotential:
        return compiled_power(potential)
    return None


def compiled_power(potential: PowerPotential) -> tuple[int, float, float] | None:
    """The kernels' description of (‖ξ‖/c)ⁿ/n; None if c⁻ⁿ would over- or underflow."""
    n = potential.exponent
    if n * abs(math.log10(potential.scale)) > MOST_DECADES:
        return None
    factor = potential.scale**-n
    if n == 1:
        return kernels.LINEAR, factor, 0.0
    if n == 2:
        return kernels.QUADRATIC, factor, factor
    multiplied = n % 2 == 0 and n <= LARGEST_EVEN
    return (kernels.EVEN_POWER if multiplied else kernels.POWER), factor, n


def half_step_shifts(
    curve: Curve, s_start: float, ds: float, step: int, n_steps: int
) -> NDArray[np.float64]:
    """Displacements of γ over both halves of every step; shape (n_steps, 2, 2).

    They depend on the number of a step alone, not on where a computation began. Their
    sum telescopes, so that rounding does not add up.
    """
    if curve.autonomous:
        half = curve.displacement(0.0, 0.5 * ds)
        return np.broadcast_to(np.array(half), (n_steps, 2, 2)).copy()
    halves = np.arange(2 * step, 2 * (step + n_steps) + 1)
    position = np.stack(curve.position(s_start + 0.5 * ds * halves), axis=-1)
    return np.ascontiguousarray(np.diff(position, axis=0).reshape(n_steps, 2, 2))
