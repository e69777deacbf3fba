"""Into which directions the fibres of a web run."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.web.statistics.blocks import Blocks, choose_blocks
from fpsolve.web.statistics.estimate import Estimate, Estimates
from fpsolve.web.statistics.fields import check_density, check_orientation
from fpsolve.web.statistics.jackknife import estimate, jackknife

__all__ = ["machine_cross_ratio", "mean_orientation", "orientation_rose"]


def mean_orientation(length_density: Any, pixel: float, orientation: Any) -> Array:
    """⟨τ⊗τ⟩ = Σ_pixels m T / Σ_pixels m: the mean over laid length, trace 1.

    Parameters
    ----------
    length_density, pixel, orientation
        As for `machine_cross_ratio`.

    Returns
    -------
    array
        Of shape (2, 2); first index the machine direction.

    Raises
    ------
    TypeError, ValueError
        As for `machine_cross_ratio`.
    """
    density, _ = check_density(length_density, pixel)
    tensor = check_orientation(orientation, density)
    return np.asarray(np.einsum("ij,ijkl->kl", density, tensor) / density.sum())


def machine_cross_ratio(
    length_density: Any, pixel: float, orientation: Any, *, block: float | None = None
) -> Estimate:
    """MD/CD = ⟨τ₁²⟩/⟨τ₂²⟩ over laid length, 1 for an isotropic web.

    Parameters
    ----------
    length_density, pixel
        As for `coefficient_of_variation`.
    orientation : array
        ⟨τ⊗τ⟩ of every pixel, of shape (cross, machine, 2, 2), index 0 the machine
        direction; NaN or anything else where there is no fibre.
    block : float, optional
        Side of the blocks; by default as for `coefficient_of_variation`.

    Returns
    -------
    Estimate
        Infinite where no fibre has a component across.

    Raises
    ------
    TypeError, ValueError
        As for `coefficient_of_variation`, and where `orientation` is no tensor of
        trace 1.
    """
    density, pixel = check_density(length_density, pixel)
    tensor = check_orientation(orientation, density)
    parts = [density * tensor[..., axis, axis] for axis in (0, 1)]
    return estimate(_ratio, parts, pixel, block)


def orientation_rose(
    length_density: Any,
    pixel: float,
    orientation: Any,
    *,
    n_bins: int = 36,
    block: float | None = None,
) -> Estimates:
    """f(θ), θ modulo π: the density of laid length over the angle to machine direction.

    The length of a pixel is shared out to the two principal directions of its tensor,
    in proportion to the eigenvalues. So the rose has the tensor of the web: its second
    Fourier coefficient is that of the fibres, up to the width of a bin. It is the rose
    of the fibres themselves where pixels hold straight pieces of one fibre; fibres
    that cross in a pixel are seen through their tensor only.

    Parameters
    ----------
    length_density, pixel, orientation, block
        As for `machine_cross_ratio`.
    n_bins : int
        Bins of [0, π); the first one is centred on the machine direction.

    Returns
    -------
    Estimates
        f at the centres of the bins, of integral 1 over [0, π).

    Raises
    ------
    TypeError, ValueError
        As for `machine_cross_ratio`; if there are fewer than 2 bins.
    """
    density, pixel = check_density(length_density, pixel)
    tensor = check_orientation(orientation, density)
    n_bins = check_integer("n_bins", n_bins, 2)
    uneven = density * (tensor[..., 0, 0] - tensor[..., 1, 1])
    blocks = choose_blocks(uneven, pixel, block)
    lengths = _lengths_by_angle(density, tensor, blocks, n_bins)
    values, errors = jackknife(_shares, lengths, blocks.sizes)
    errors *= np.sqrt(blocks.inflation)
    width = np.pi / n_bins
    n_samples = int(np.count_nonzero(density))
    return Estimates.of(
        width * np.arange(n_bins),
        [
            Estimate(
                value / width, error / width, blocks.n_blocks, n_samples, blocks.reason
            )
            for value, error in zip(values, errors, strict=True)
        ],
    )


def _ratio(means: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(means[..., 0] / means[..., 1])


def _shares(means: Array) -> Array:
    return np.asarray(means / means.sum(axis=-1, keepdims=True))


def _lengths_by_angle(
    density: Array, tensor: Array, blocks: Blocks, n_bins: int
) -> Array:
    """Return the laid length of every block in every bin of the angle."""
    stretch, shear = tensor[..., 0, 0] - tensor[..., 1, 1], 2.0 * tensor[..., 0, 1]
    strength = np.minimum(np.hypot(stretch, shear), 1.0)
    angle = 0.5 * np.arctan2(shear, stretch)
    lengths = np.zeros(blocks.n_blocks * n_bins)
    for turn, share in ((0.0, 1.0 + strength), (0.5 * np.pi, 1.0 - strength)):
        bins = np.rint((angle + turn) * n_bins / np.pi).astype(np.int64) % n_bins
        places = (blocks.labels * n_bins + bins).ravel()
        weights = (0.5 * share * density).ravel()
        lengths += np.bincount(places, weights, lengths.size)
    return lengths.reshape(blocks.n_blocks, n_bins)
