"""The power spectrum of a web, as an average over blocks of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_one_of, check_positive
from fpsolve.web.statistics.blocks import FEWEST_BLOCKS, Blocks, cut
from fpsolve.web.statistics.estimate import Estimate, Estimates
from fpsolve.web.statistics.fields import check_density

__all__ = ["PowerSpectrum", "power_spectrum"]

# Periodograms that are averaged by default: errors of a quarter at one wave vector.
_BLOCKS = 16
# Pixels along a block, at least; of fewer there is no section to look at.
_FEWEST_PIXELS = 8


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """P(k) with ∫ P d²k/(2π)² = variance of the density.

    Parameters
    ----------
    k1, k2 : array
        Wave numbers in machine and cross direction, ascending.
    power, standard_errors : array
        P(k₂, k₁) and its standard error, cross × machine direction.
    radial : Estimates
        Means of P over rings of ‖k‖.
    machine, cross : Estimates
        P(0, k₁) and P(k₂, 0) over positive wave numbers.
    mean : float
        Mean density ⟨m⟩; P/⟨m⟩ is Ŝ(k), the spectrum of one fibre.
    window : str
        That of the blocks.
    """

    k1: Array
    k2: Array
    power: Array
    standard_errors: Array
    radial: Estimates
    machine: Estimates
    cross: Estimates
    mean: float
    window: str


def power_spectrum(
    length_density: Any,
    pixel: float,
    *,
    block: float | None = None,
    window: str = "hann",
) -> PowerSpectrum:
    """P(k) = ⟨|p² Σ_j w_j (m_j - ⟨m⟩) e^{-ik·r_j}|²⟩ / (p² Σ_j w_j²) over blocks.

    p is the side of a pixel. The mean of P over blocks has as its expectation the
    spectrum of the web, smoothed over the width of the window's transform (2 π/side of
    a block, twice that for "hann"), and multiplied by sinc²(k₁p/2) sinc²(k₂p/2), which
    the pixels do. At k = 0 and beside it the mean that was taken off is missing.

    Parameters
    ----------
    length_density, pixel
        As for `coefficient_of_variation`.
    block : float, optional
        Side of the blocks, to which resolution belongs; by default 16 of them are cut.
    window : {"hann", "none"}
        w. Edges of a block are jumps without one, whose power falls like k⁻² only.

    Returns
    -------
    PowerSpectrum

    Raises
    ------
    TypeError, ValueError
        As for `coefficient_of_variation`; if fewer than 4 blocks of 8 × 8 pixels fit.

    References
    ----------
    [Welch67]_.
    """
    density, pixel = check_density(length_density, pixel)
    check_one_of("window", window, ("hann", "none"))
    blocks = _segments(density.shape, pixel, block)
    shape = (blocks.cells[0] // blocks.counts[0], blocks.cells[1] // blocks.counts[1])
    parts = _periodograms(density, pixel, blocks, shape, window)
    k2, k1 = (_wave_numbers(n, pixel) for n in shape)
    order = np.ix_(np.argsort(k2), np.argsort(k1))
    power, errors = _mean(parts)
    machine, cross = (slice(1, (n + 1) // 2) for n in (shape[1], shape[0]))
    return PowerSpectrum(
        np.sort(k1), np.sort(k2), power[order], errors[order], _rings(parts, k2, k1),
        _over(k1[machine], parts[:, 0, machine]),
        _over(k2[cross], parts[:, cross, 0]),
        float(density.mean()), window,
    )  # fmt: skip


def _wave_numbers(n: int, pixel: float) -> Array:
    return np.asarray(2.0 * np.pi * np.fft.fftfreq(n, pixel), dtype=np.float64)


def _segments(shape: Any, pixel: float, block: float | None) -> Blocks:
    """Return the blocks; ValueError unless four of them hold 8 × 8 pixels."""
    side = pixel * math.sqrt(shape[0] * shape[1] / _BLOCKS)
    if block is not None:
        side = check_positive("block", block)
    blocks = cut(shape, pixel, (side, side))
    pixels = min(n // count for n, count in zip(shape, blocks.counts, strict=True))
    if blocks.n_blocks < FEWEST_BLOCKS or pixels < _FEWEST_PIXELS:
        raise ValueError(
            f"`block` must leave {FEWEST_BLOCKS} blocks of {_FEWEST_PIXELS} × "
            f"{_FEWEST_PIXELS} pixels or more for a spectrum with errors, got "
            f"{blocks.n_blocks} of {pixels} pixels along their shorter side."
        )
    return blocks


def _periodograms(
    density: Array, pixel: float, blocks: Blocks, shape: tuple[int, int], window: str
) -> Array:
    """Return one periodogram per block."""
    (rows, columns), (n2, n1) = blocks.counts, shape
    centred = density[: rows * n2, : columns * n1] - density.mean()
    parts = centred.reshape(rows, n2, columns, n1).swapaxes(1, 2)
    weights = np.ones(shape)
    if window == "hann":
        # From half a pixel on, symmetric in the block.
        across, along = (np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2 for n in shape)
        weights = across[:, None] * along
    waves = np.fft.fft2(parts * weights).reshape(-1, n2, n1)
    return np.asarray(np.abs(waves) ** 2 * (pixel**2 / np.sum(weights**2)))


def _mean(parts: Array) -> tuple[Array, Array]:
    """Return the mean over blocks and its standard error."""
    return parts.mean(axis=0), parts.std(axis=0, ddof=1) / math.sqrt(len(parts))


def _over(wave_numbers: Array, parts: Array, n_samples: Any = 1) -> Estimates:
    """Return the means over blocks as estimates at wave numbers."""
    counts = np.broadcast_to(n_samples, wave_numbers.shape)
    values = zip(*_mean(parts), counts, strict=True)
    made = [Estimate(power, error, len(parts), n) for power, error, n in values]
    return Estimates.of(wave_numbers, made)


def _rings(parts: Array, k2: Array, k1: Array) -> Estimates:
    """Return means over rings as wide as the coarser distance of wave numbers."""
    width = max(k1[1], k2[1])
    length = np.hypot(k2[:, None], k1)
    last = min(k1.max(), k2.max())
    ring = np.where(length <= last, np.rint(length / width), 0).astype(np.int64).ravel()
    n_waves = np.bincount(ring)
    sums = np.stack([np.bincount(ring, one.ravel()) for one in parts])
    centres = np.bincount(ring, length.ravel()) / n_waves
    return _over(centres[1:], (sums / n_waves)[:, 1:], n_waves[1:])
