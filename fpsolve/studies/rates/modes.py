"""The slowest modes of a run, from its last densities.

A run of a linear scheme is x_n = Tⁿ x_0 with x = (p/p_S − 1) in L²(μ). A few dozen of
these vectors span a space in which T has, to many digits, its slowest eigenvalues: far
more than the scalar series H(s) can tell when two modes decay nearly equally fast, or
while one of them oscillates. As H → ½‖x‖², H decays at twice the slowest rate.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["CLASSES", "SlowestMode", "slowest_modes"]

# Quarter turns of ξ and α are a symmetry of a square grid: densities fall apart into
# classes of the angular index modulo 4, which do not mix.
CLASSES = ("M = 0", "M = ±1", "M = 2")
# Norms of x below this are rounding.
_NOISE = 1e-8
# Singular values of the normalised vectors that are told from rounding.
_RANK = 1e-8
# Parts of a run that are left out: the second shows how much the first matters.
_STARTS = (0.3, 0.45)
_FEWEST = 6
# A mode counts if its residual is below this share of its rate.
_RESIDUAL = 0.03


@dataclass(frozen=True)
class SlowestMode:
    """The eigenvalue of a class of densities that decays most slowly.

    Attributes
    ----------
    eigenvalue : complex
        Of the generator; NaN if no mode stands out.
    error : float
        Change when less of the run is used, and the residual.
    apparent : float
        Rate at which the whole class fell over the second half of the run, infinite
        if it fell below rounding too early to tell.
    """

    eigenvalue: complex
    error: float
    apparent: float

    @property
    def rate(self) -> float:
        """Decay rate −Re λ."""
        return -self.eigenvalue.real


def slowest_modes(
    densities: Array, spacing: float, model: LayDownModel, grid: PhaseSpaceGrid
) -> dict[str, SlowestMode]:
    """The slowest mode of every class that the symmetry of model and grid allows.

    Parameters
    ----------
    densities : ndarray, shape (n, n1, n2, n_alpha)
        At equally spaced arclengths.
    spacing : float
    model : LayDownModel
        With an equilibrium.
    grid : PhaseSpaceGrid

    Returns
    -------
    dict of str to SlowestMode
        For the names in `CLASSES`, or for "all" where quarter turns are no symmetry.
    """
    return {
        name: _slowest(vectors, spacing)
        for name, vectors in _classes(densities, model, grid)
    }


def relative_norm(p: Array, model: LayDownModel, grid: PhaseSpaceGrid) -> float:
    """‖p/p_S − 1‖ in L²(μ), with the p_S of the grid."""
    return float(np.linalg.norm(_weighted(p, model, grid)))


def _weighted(p: Array, model: LayDownModel, grid: PhaseSpaceGrid) -> Array:
    """(p/p_S − 1) √(p_S dξ dα): its Euclidean norm is that of L²(μ)."""
    plane = model.equilibrium(*grid.plane())[:, :, None]
    scale = float(plane.sum()) * grid.shape[2] * grid.cell_volume
    equilibrium = plane / scale
    return np.asarray((p / equilibrium - 1) * np.sqrt(equilibrium * grid.cell_volume))


def _classes(
    densities: Array, model: LayDownModel, grid: PhaseSpaceGrid
) -> Iterator[tuple[str, Array]]:
    """Names of classes and their vectors as columns, one class at a time."""
    n1, n2, n_alpha = grid.shape
    width1, width2 = grid.half_widths
    turnable = n1 == n2 and width1 == width2 and n_alpha % 4 == 0
    if not (turnable and model.potential.isotropic):
        columns = [_weighted(p, model, grid).ravel() for p in densities]
        yield "all", np.stack(columns, axis=1)
        return
    for name in CLASSES:
        columns = [_part(_weighted(p, model, grid), name).ravel() for p in densities]
        yield name, np.stack(columns, axis=1)


def _part(x: Array, name: str) -> Array:
    """The part of a class, from the sum over quarter turns."""
    half_turned = _quarter_turn(_quarter_turn(x))
    if name == CLASSES[1]:
        return (x - half_turned) / 2
    even = (x + half_turned) / 2
    sign = 1 if name == CLASSES[0] else -1
    return (even + sign * _quarter_turn(even)) / 2


def _quarter_turn(x: Array) -> Array:
    """ξ and α turned by π/2."""
    turned = np.rot90(x, 1, axes=(0, 1))
    return np.roll(turned, x.shape[2] // 4, axis=2)


def _slowest(vectors: Array, spacing: float) -> SlowestMode:
    """The slowest mode of one class."""
    norms = np.linalg.norm(vectors, axis=0)
    loud = norms > _NOISE
    n_usable = int(np.argmin(loud)) if not loud.all() else loud.size
    found = []
    for start in _STARTS:
        first = int(start * n_usable)
        if n_usable - first < _FEWEST:
            return SlowestMode(complex(math.nan, math.nan), math.nan, math.inf)
        used = slice(first, n_usable)
        found.append(_leading(vectors[:, used], norms[used], spacing))
    (eigenvalue, residual), (other, _) = found
    error = max(abs(eigenvalue.real - other.real), residual)
    half = n_usable // 2
    fall = math.log(norms[half] / norms[n_usable - 1])
    return SlowestMode(eigenvalue, error, fall / ((n_usable - 1 - half) * spacing))


def _leading(vectors: Array, norms: Array, spacing: float) -> tuple[complex, float]:
    """Slowest eigenvalue in the span of the vectors whose residual is small."""
    # Divided by their norms: the first vectors are by far the largest, and would
    # decide alone which directions are told from rounding.
    before, after = vectors[:, :-1] / norms[:-1], vectors[:, 1:] / norms[:-1]
    left, singular, right = np.linalg.svd(before, full_matrices=False)
    rank = int(np.count_nonzero(singular > _RANK * singular[0]))
    # T on an orthonormal basis of the span; T itself is not known, only its images.
    left, images = left[:, :rank], after @ (right[:rank].T / singular[:rank])
    factors, modes = np.linalg.eig(left.T @ images)
    residuals = np.linalg.norm(images @ modes - (left @ modes) * factors, axis=0)
    with np.errstate(divide="ignore"):
        eigenvalues = np.log(factors.astype(complex)) / spacing
    # From factors to their logarithms over the spacing, which are the eigenvalues.
    residuals = residuals / (np.abs(factors) * spacing)
    kept = residuals < _RESIDUAL * np.abs(eigenvalues.real)
    if not kept.any():
        return complex(math.nan, math.nan), math.nan
    place = np.flatnonzero(kept)[np.argmax(eigenvalues[kept].real)]
    # Of a conjugate pair the one above the real axis.
    eigenvalue = complex(eigenvalues[place].real, abs(eigenvalues[place].imag))
    return eigenvalue, float(residuals[place])
