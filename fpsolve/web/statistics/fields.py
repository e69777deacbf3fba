"""What a field of a web must be before anything is measured on it."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers, check_numbers
from fpsolve._support.checks import check_positive, shown

__all__ = ["check_density", "check_orientation"]

# Of the trace of an orientation tensor, which sums of single precision keep.
_TRACE = 1e-5


def check_density(length_density: Any, pixel: Any) -> tuple[Array, float]:
    """Return the length density as an array in two dimensions, and the pixel.

    Raises
    ------
    TypeError
        If they are no real numbers.
    ValueError
        If an entry is negative, NaN or infinite, the web is empty, or the pixel not
        positive.
    """
    density = check_finite_numbers("length_density", length_density)
    if density.ndim != 2 or density.size == 0:
        raise ValueError(
            "`length_density` must have two dimensions, cross and machine direction, "
            f"got an array of shape {density.shape}."
        )
    lowest = float(density.min())
    if not lowest >= 0:
        raise ValueError(f"`length_density` must be non-negative, got {lowest:g}.")
    if not density.max() > 0:
        raise ValueError("`length_density` must hold some fibre, got zeros only.")
    return density, check_positive("pixel", pixel, "; it is the side of a pixel")


def check_orientation(orientation: Any, density: Array) -> Array:
    """Return ⟨τ⊗τ⟩ of every pixel, zero where there is no fibre.

    Raises
    ------
    TypeError
        If it holds no real numbers.
    ValueError
        If its shape is not that of the density with (2, 2), or if its trace is not 1
        in a pixel with fibre.
    """
    tensor = check_numbers("orientation", orientation)
    if tensor.shape != (*density.shape, 2, 2):
        raise ValueError(
            f"`orientation` must be of shape {(*density.shape, 2, 2)}, that of "
            f"`length_density` and the tensor, got {shown(tensor)}."
        )
    covered = density > 0
    trace = tensor[..., 0, 0] + tensor[..., 1, 1]
    wrong = covered & ~(np.abs(trace - 1.0) <= _TRACE)
    if wrong.any():
        place = tuple(int(i) for i in np.argwhere(wrong)[0])
        raise ValueError(
            "`orientation` must have trace 1 wherever there is fibre, got "
            f"{trace[place]:g} at pixel {place}."
        )
    return np.where(covered[..., None, None], tensor, 0.0)
