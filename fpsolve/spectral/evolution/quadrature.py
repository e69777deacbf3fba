"""Values, relative entropy and moments of an expansion."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.spectral.bases.hermite_functions import hermite_functions
from fpsolve.spectral.evolution.expansion import Expansion

__all__ = ["density_on", "moments", "relative_entropy"]

# Points evaluated at a time.
CHUNK = 2**18
REFINEMENTS = 4


def moments(h: Expansion, potential: QuadraticPotential) -> dict[str, float]:
    """E ξ, the covariance of ξ, E cos α and E sin α, from seven coefficients."""
    d = h.within(np.full(3, 1)).complex_values
    sigma1, sigma2 = potential.sigma1, potential.sigma2
    # c = i^j d: what is odd in j is imaginary in d.
    mean1, mean2 = d[1, 0, 0].real, -d[0, 1, 0].imag
    square1 = 1 + math.sqrt(2) * d[2, 0, 0].real
    square2 = 1 - math.sqrt(2) * d[0, 2, 0].real
    values = (
        sigma1 * mean1,
        sigma2 * mean2,
        sigma1**2 * (square1 - mean1**2),
        sigma2**2 * (square2 - mean2**2),
        sigma1 * sigma2 * (-d[1, 1, 0].imag - mean1 * mean2),
        d[0, 0, 1].real,
        -d[0, 0, 1].imag,
    )
    # Adding zero turns a negative zero into a plain one.
    return {name: float(v) + 0.0 for name, v in zip(MOMENTS, values, strict=True)}


def relative_entropy(h: Expansion, tolerance: float) -> tuple[float, float]:
    """H(p|p_S) = ∫ (h ln h − h + 1) dμ by the trapezoid rule, and an error estimate.

    Spectrally accurate on R² × [0, 2π); every term is non-negative, so that small
    entropies keep their digits. Where a truncated expansion is negative it counts as
    zero. The estimate is the change from every second angle and from every second
    point of the plane; nodes are added until it is below `tolerance`, at most
    `REFINEMENTS` times.
    """
    spacing = 2 * math.pi / (1.5 * math.sqrt(h.degree) + 10.0)
    n_alpha = 4 * math.ceil((2.5 * h.harmonics + 24) / 4)
    for refinement in range(REFINEMENTS + 1):
        value, in_alpha, in_plane = entropy_sums(h, nodes(spacing, tolerance), n_alpha)
        if refinement == REFINEMENTS or max(in_alpha, in_plane) <= tolerance:
            break
        if in_alpha > tolerance:
            n_alpha *= 2
        if in_plane > tolerance:
            spacing /= math.sqrt(2)
    return value, max(in_alpha, in_plane)


def entropy_sums(h: Expansion, x: Array, n_alpha: int) -> tuple[float, float, float]:
    """The entropy, and its changes with half the angles and half the points."""
    weight = np.exp(-0.5 * x**2) * (x[1] - x[0]) / math.sqrt(2 * math.pi)
    # Every second point of the plane, as on a chequerboard, with twice the weight.
    chequered = 2.0 * (np.add.outer(np.arange(x.size), np.arange(x.size)) % 2)
    full = fewer_angles = fewer_points = 0.0
    for rows, values in slabs(h, x, x, n_alpha):
        density = entropy_density(values - 1.0)
        plane = weight[rows, None] * density.mean(axis=2) * weight
        full += float(plane.sum())
        fewer_points += float((plane * chequered[rows]).sum())
        half = density[:, :, ::2].mean(axis=2)
        fewer_angles += float(weight[rows] @ half @ weight)
    return full, abs(full - fewer_angles), abs(full - fewer_points)


def nodes(spacing: float, tolerance: float) -> Array:
    """Nodes of the trapezoid rule for ∫ f h dμ.

    By Cauchy and Schwarz, what lies beyond X is at most ‖h‖ e^{−X²/4}.
    """
    width = math.sqrt(4.0 * math.log(1e3 / tolerance))
    n = math.ceil(width / spacing)
    return np.asarray(np.arange(-n, n + 1) * spacing)


def entropy_density(excess: Array) -> Array:
    """(1 + u) ln(1 + u) − u for u ≥ −1, without cancellation; 1 below −1."""
    u = np.maximum(excess, -1.0 + 1e-300)
    near = np.abs(u) < 1e-2
    small = np.where(near, u, 0.0)
    series = np.zeros_like(small)
    # Σ (−1)^n u^n/(n (n − 1)), nine terms for |u| < 1e-2.
    for n in range(10, 1, -1):
        series = series * small + (-1) ** n / (n * (n - 1))
    rest = np.where(near, 1.0, 1.0 + u)
    far = rest * np.log(np.maximum(rest, 1e-300)) - (rest - 1.0)
    return np.where(near, series * small**2, far)


def slabs(
    h: Expansion, x1: Array, x2: Array, n_alpha: int, shift: float = 0.0
) -> Iterator[tuple[slice, Array]]:
    """Values p/p_S at x1 × x2 × (2πq/n_alpha + shift), some x1 at a time."""
    degree, harmonics = h.degree, h.harmonics
    d = h.complex_values
    d = d * (1j ** np.arange(degree + 1))[:, None]
    d *= np.exp(1j * shift * np.arange(harmonics + 1))
    # A multiple of the angles asked for that resolves the highest harmonic.
    n_fine = n_alpha * math.ceil((2 * harmonics + 1) / n_alpha)
    functions1, functions2 = (hermite_functions(degree, x) for x in (x1, x2))
    root1, root2 = functions1[0], functions2[0]
    rows_at_once = max(1, CHUNK // (x2.size * n_fine))
    for start in range(0, x1.size, rows_at_once):
        rows = slice(start, min(start + rows_at_once, x1.size))
        half = np.tensordot(functions1[:, rows].T, d, 1)
        waves = np.matmul(functions2.T, half)
        waves /= (root1[rows, None] * root2)[:, :, None]
        values = np.fft.irfft(waves, n_fine, axis=2) * n_fine
        yield rows, values[:, :, :: n_fine // n_alpha]


def density_on(
    h: Expansion, grid: PhaseSpaceGrid, potential: QuadraticPotential
) -> Array:
    """p at the cell centres of a grid; shape ``grid.shape``."""
    x1, x2 = grid.xi1 / potential.sigma1, grid.xi2 / potential.sigma2
    p = np.empty(grid.shape)
    for rows, values in slabs(h, x1, x2, grid.shape[2], float(grid.alpha[0])):
        p[rows] = values
    scale = 2 * math.pi * potential.partition_function
    return p * np.exp(-potential.value(*grid.plane()))[:, :, None] / scale
