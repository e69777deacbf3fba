"""Eigenvalues and eigenfunctions of the energy process."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.checks import check_energies
from fpsolve.reduced.energy.elements import Elements

__all__ = ["EnergySpectrum", "energy_spectrum"]


FAMILIES = ("even", "odd")
# Degree for the first eigenvalues, what a further one costs, and how much lower the
# degree is whose difference is the error.
_DEGREE, _DEGREE_PER_EIGENVALUE, _COARSER = 20, 1, 4
# What rounding leaves of an eigenvalue, relative.
_ROUNDING = 5e-13
# Matrices of that size still take seconds only.
_MOST_EIGENVALUES = 1000


@dataclass(frozen=True, eq=False, repr=False)
class EnergySpectrum:
    """(A²/2)(J u')' = -λ S u on (0, g_max), u bounded at g_max.

    The even family has J u' = 0 at g = 0 (the process |G|, reflected there), the odd
    one u = 0 (the odd functions of signed G). Eigenvalues are decay rates of (16);
    u are eigenfunctions of the generator, u S those of the Fokker-Planck operator.

    Attributes
    ----------
    eigenvalues : ndarray, shape (n,)
        λ, ascending; the even family begins with 0, the odd one with A²/2 exactly.
    errors : ndarray, shape (n,)
        Difference to polynomials four degrees lower, at least rounding.
    family : str
        "even" or "odd".
    g_max : float
        Energy of the circle.

    References
    ----------
    [KMW09]_, below equation (16).
    """

    eigenvalues: Array
    errors: Array
    family: str
    g_max: float
    _elements: Elements
    _coefficients: Array
    _at_zero: Array

    def eigenfunction(self, index: int, g: ArrayLike) -> Array:
        """u(g) in the shape of g; ∫ u² S dg = ∫ S dg over (0, g_max), u(g_max) > 0.

        Parameters
        ----------
        index : int
            Which, in the order of `eigenvalues`.
        g : array_like
            Energies, |g| <= g_max; to g < 0 the function is continued by its symmetry.

        Raises
        ------
        IndexError
            If there is no such eigenvalue.
        ValueError
            If an energy lies outside.
        """
        if not 0 <= index < len(self.eigenvalues):
            raise IndexError(
                f"`index` must be at least 0 and below {len(self.eigenvalues)}, got "
                f"{index}; ask for more eigenvalues."
            )
        energies = check_energies("g", g, self.g_max, signed=True)
        combined = self._elements.combined(
            self._coefficients[index], np.abs(energies).ravel()
        )
        values = (self._at_zero[index] + combined).reshape(energies.shape)
        if self.family == "odd":
            values = values * np.sign(energies)
        return np.asarray(values)

    def __repr__(self) -> str:
        numbers = ", ".join(f"{value:.10g}" for value in self.eigenvalues)
        return f"EnergySpectrum({self.family}: {numbers})"


def energy_spectrum(
    averages: OrbitAverages, noise: float, n: int, family: str
) -> EnergySpectrum:
    """The n smallest λ of a family, with errors.

    Raises
    ------
    ValueError
        If n < 1 or the family is unknown.
    TypeError
        If n is not an integer.
    """
    n = check_integer("n", n, 1, _MOST_EIGENVALUES)
    if family not in FAMILIES:
        raise ValueError(f"`family` must be 'even' or 'odd', got {family!r}.")
    elements = Elements.of(averages, _DEGREE + _DEGREE_PER_EIGENVALUE * n)
    mass, stiffness, means = _forms(averages, elements, family)
    n_positive = n - 1 if family == "even" else n
    eigenvalues, coefficients = _pencil(mass, stiffness, n_positive)
    low = elements.modes < elements.degree - _COARSER
    coarse, _ = _pencil(mass[low][:, low], stiffness[low][:, low], n_positive)
    errors = np.abs(coarse - eigenvalues) + _ROUNDING * eigenvalues
    at_zero = -coefficients @ means
    if family == "even":
        eigenvalues, errors = np.insert(eigenvalues, 0, 0.0), np.insert(errors, 0, 0.0)
        coefficients = np.vstack([np.zeros(elements.size), coefficients])
        at_zero = np.insert(at_zero, 0, 1.0)
    top = at_zero + coefficients @ elements.values(elements.faces[-1:])[:, 0]
    upwards, rate = np.sign(top), 0.5 * noise**2
    return EnergySpectrum(
        rate * eigenvalues,
        rate * errors,
        family,
        averages.well.g_max,
        elements,
        upwards[:, None] * coefficients,
        upwards * at_zero,
    )


def _forms(
    averages: OrbitAverages, elements: Elements, family: str
) -> tuple[Array, Array, Array]:
    """∫ S u v and ∫ J u'v' of the basis over ∫ S, and the means ∫ S u.

    Even functions are orthogonal to the constants, which have the eigenvalue 0: their
    basis has its means taken off.
    """
    g, weights = elements.quadrature()
    share = averages.period(g) * weights / averages.total
    action = averages.action(g) * weights / averages.total
    values, slopes = elements.values(g), elements.slopes(g)
    means = values @ share if family == "even" else np.zeros(elements.size)
    values -= means[:, None]
    return (values * share) @ values.T, (slopes * action) @ slopes.T, means


def _pencil(mass: Array, stiffness: Array, n: int) -> tuple[Array, Array]:
    """The n smallest λ, ascending, and rows c, with K c = λ M c and cᵀM c = 1."""
    from scipy.linalg import cholesky, solve_triangular
    from scipy.sparse.linalg import eigsh

    size = len(mass)
    if n == 0:
        return np.zeros(0), np.zeros((0, size))
    # Functions of small elements have small masses; scaled by their stiffness they
    # do no harm.
    scaling = 1.0 / np.sqrt(np.diag(stiffness))
    both = np.outer(scaling, scaling)
    root = cholesky(both * stiffness, lower=True)
    half = solve_triangular(root, both * mass, lower=True)
    inverses = solve_triangular(root, half.T, lower=True)
    # Few of many, far apart: Lanczos, from a start that is always the same.
    start = np.cos(np.arange(size))
    inverse, vectors = eigsh((inverses + inverses.T) / 2, k=n, which="LA", v0=start)
    inverse, vectors = inverse[::-1], vectors[:, ::-1]
    coefficients = scaling[:, None] * solve_triangular(root.T, vectors)
    return 1.0 / inverse, (coefficients / np.sqrt(inverse)).T
