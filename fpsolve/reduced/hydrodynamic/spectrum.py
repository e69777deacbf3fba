"""Decay rates of the limit equation: eigenvalues of a symmetric sparse matrix."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.grids.plane import PlaneGrid
from fpsolve.reduced.hydrodynamic.equation import LimitEquation
from fpsolve.reduced.hydrodynamic.scharfetter_gummel import gibbs_masses

__all__ = ["HydrodynamicSpectrum", "slowest_modes", "spectrum_of", "symmetrised"]


# The shift, below the eigenvalue 0 by this share of the diagonal: far enough for a
# stable factorisation, close enough for the smallest rates to be found first.
_SHIFT = 1e-7
# The largest rate counts up to this multiple of its mean over 𝒫_S.
_WALL = 100.0


@dataclass(frozen=True, eq=False)
class HydrodynamicSpectrum:
    """The slowest modes 𝒫 = 𝒫_S + Σ c_k m_k e^{−λ_k s} of the limit equation.

    Attributes
    ----------
    eigenvalues : ndarray, shape (n,)
        Decay rates λ_k per unit of arclength, ascending from 0, of the discrete
        equation; of order 2 in the cell width.
    errors : ndarray, shape (n,)
        |λ_k(h) − λ_k(2h)|/3, h the cell width: what is left of them if the order
        holds. The box adds its own error, which this does not see; compare two.
    grid : PlaneGrid
    density_modes : ndarray, shape (n, n1, n2)
        m_k, with ∫ m_k m_l/𝒫_S dξ = δ_kl; m_0 = 𝒫_S.
    """

    eigenvalues: Array
    errors: Array
    grid: PlaneGrid
    density_modes: Array
    _root: Array = field(repr=False)

    @property
    def gap(self) -> float:
        """λ_1, the rate at which 𝒫 tends to 𝒫_S."""
        return float(self.eigenvalues[1])

    @property
    def gap_error(self) -> float:
        """Error of `gap`, from a grid with half the cells."""
        return float(self.errors[1])

    def eigenfunction(self, k: int) -> Array:
        """m_k/𝒫_S, with norm 1 in L²(𝒫_S); shape (n1, n2).

        An observable that decays on average as e^{−λ_k s}. Where 𝒫_S is below 1e-20
        of its largest value the eigenvector holds only rounding, and 0 is returned.
        """
        held = self._root > 1e-10 * self._root.max()
        masses = self.density_modes[k] * self.grid.cell_area
        safe = np.where(held, self._root, 1.0)
        return np.asarray(np.where(held, masses / safe**2, 0.0))


def spectrum_of(
    limit: LimitEquation, plane: PlaneGrid, n_eigenvalues: int
) -> HydrodynamicSpectrum:
    """See `HydrodynamicLimit.spectrum`."""
    n = checked_count(n_eigenvalues, plane)
    halved = PlaneGrid(plane.half_width, (plane.shape[0] // 2, plane.shape[1] // 2))
    (values, vectors), root = _modes(limit, plane, n)
    (coarse, _), _ = _modes(limit, halved, n)
    # Of order 2 in the cell width; odd numbers of cells do not halve exactly.
    gain = 1.0 / (plane.n_cells / halved.n_cells - 1.0)
    modes = (vectors * root).reshape(n, *plane.shape) / plane.cell_area
    errors = gain * np.abs(values - coarse)
    return HydrodynamicSpectrum(values, errors, plane, modes, root.reshape(plane.shape))


def _modes(
    limit: LimitEquation, plane: PlaneGrid, n: int
) -> tuple[tuple[Array, Array], Array]:
    """The slowest modes on a grid, and √π."""
    root = np.sqrt(gibbs_masses(limit.effective_potential(*plane.mesh())).ravel())
    root /= np.linalg.norm(root)
    return slowest_modes(limit.generator(plane), root, n), root


def symmetrised(generator: Any) -> Any:
    """S = −π^{−1/2} Q π^{1/2}, positive semi-definite, without the use of π.

    In detailed balance Q_ij √(π_j/π_i) = √(Q_ij Q_ji), where no small number divides.
    """
    from scipy.sparse import csc_array, dia_array

    n = generator.shape[0]
    diagonal = generator.diagonal()
    moves = generator - dia_array((diagonal[None], [0]), shape=(n, n))
    product = moves.multiply(moves.T)
    return csc_array(dia_array((-diagonal[None], [0]), shape=(n, n)) - product.sqrt())


def slowest_modes(generator: Any, root: Array, n: int) -> tuple[Array, Array]:
    """The n smallest eigenvalues of S, ascending, and orthonormal eigenvectors.

    By inverse Lanczos iteration from one sparse factorisation (ARPACK). The first
    pair is known, 0 and √π, and set.

    Parameters
    ----------
    generator : sparse array, shape (m, m)
    root : ndarray, shape (m,)
        √π, of norm 1.
    n : int

    Returns
    -------
    (n,) and (n, m) arrays
    """
    from scipy.sparse import csc_array, eye_array
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    matrix = symmetrised(generator)
    diagonal = matrix.diagonal()
    # At a steep wall the largest rate says nothing about those of the modes.
    shift = _SHIFT * float(min(diagonal.max(), _WALL * (root**2 @ diagonal)))
    shifted = csc_array(matrix + shift * eye_array(len(root)))
    factors = splu(
        shifted,
        "MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    inverse = LinearOperator(matrix.shape, matvec=factors.solve, dtype=np.float64)
    # Any start without symmetry will do; a fixed one makes runs repeatable.
    start = np.random.default_rng(0).standard_normal(len(root)) * root
    found = eigsh(matrix, k=n, sigma=-shift, OPinv=inverse, v0=start)
    order = np.argsort(found[0])
    values, vectors = found[0][order], found[1][:, order].T.copy()
    values[0], vectors[0] = 0.0, root
    return values, vectors


def checked_count(n_eigenvalues: Any, grid: PlaneGrid) -> int:
    """The number of eigenvalues, if the grid at half resolution has that many."""
    n = check_integer("n_eigenvalues", n_eigenvalues, at_least=2)
    halves = (grid.shape[0] // 2, grid.shape[1] // 2)
    if not (n < halves[0] * halves[1] and min(halves) >= 2):
        raise ValueError(
            f"`n_eigenvalues` must be below the number of cells of half the grid, got "
            f"{n} for {grid.shape}; refine the grid."
        )
    return n
