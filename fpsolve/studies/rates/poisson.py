"""Asymptotic variances −2⟨f, L⁻¹f⟩ of time averages, by solving Poisson's equation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_array, csc_array

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve.errors import ToleranceError
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.eigen.eigenvalues import factorised
from fpsolve.spectral.eigen.following import slowness
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.spectral.work import DEFAULT_WORK, OutOfWork, Work
from fpsolve.studies.arguments import check_functions
from fpsolve.studies.observables import Observable
from fpsolve.studies.rates.poisson_bases import Basis, basis_for

__all__ = ["AsymptoticVariances", "asymptotic_variances", "estimated_variances"]

# Parts of a function below this share of it are rounding.
_SILENT = 1e-12
# Truncations that are tried, and the most functions of a sector.
_TRUNCATIONS = tuple(
    Truncation(degree, degree // 2) for degree in (16, 24, 36, 54, 80, 120, 180)
)
_LARGEST = 20_000
# A variance below this share of ‖f‖² times the relaxation length is zero.
_ZERO = 1e-12
# A number whose error is more than this share of it is not known at all.
_UNKNOWN = 0.5


@dataclass(frozen=True)
class AsymptoticVariances:
    """lim s E(s⁻¹∫f − E f)² for several functions.

    Attributes
    ----------
    values, errors : ndarray, shape (n_functions,)
        The error is the change from the next smaller basis, times what is still to
        come if the changes fall slowly.
    deviations : ndarray, shape (n_functions,)
        ‖f − E f‖ in L²(μ), as the basis holds it.
    truncation : Truncation
    """

    values: Array
    errors: Array
    deviations: Array
    truncation: Truncation

    @property
    def unknown(self) -> NDArray[np.bool_]:
        """Which values their errors leave nothing of, and which are not zero either."""
        allowed = _UNKNOWN * np.abs(self.values) + _ZERO * self.deviations**2
        return np.asarray(~(self.errors <= allowed))

    def known_only(self) -> AsymptoticVariances:
        """The variances with NaN for those that are not known at all."""
        values, errors = (np.where(self.unknown, np.nan, one)
                          for one in (self.values, self.errors))  # fmt: skip
        return replace(self, values=values, errors=errors)


@one_blas_thread()
def asymptotic_variances(
    model: LayDownModel, functions: Mapping[str, Observable], *, tolerance: float = 1e-6
) -> AsymptoticVariances:
    """v = −2⟨f − E f, L⁻¹(f − E f)⟩ in L²(μ): averages of f have the variance v/s.

    L u = f − E f is solved in the bases of `fpsolve.spectral`, for growing bases until
    v stands still, or the largest is reached: look at the errors. At small noise u
    winds up and needs ever larger ones; a value that is unknown by half of it is
    refused.

    Parameters
    ----------
    model : LayDownModel
        On a fixed belt; isotropic or quadratic potential, noise A > 0.
    functions : mapping of str to callable
        f(xi1, xi2, alpha), elementwise and real, of finite variance; smooth away from
        the origin.
    tolerance : float
        Change of v relative to v at which to stop.

    Raises
    ------
    ValueError
        If the belt moves, the noise is zero, or the potential has no basis.
    ToleranceError
        If the largest basis tells nothing about one of the values.

    References
    ----------
    [KMW09]_, section 3.1.1: the limit of s times the square of the left side of (12).
    """
    check_model(model)
    functions = check_functions(functions)
    tolerance = checked_tolerance(tolerance)
    if not model.curve.fixed:
        raise ValueError(
            "`model` must have a fixed belt for asymptotic variances, got "
            f"{model.curve!r}."
        )
    found = estimated_variances(model, functions, tolerance)
    unknown = found.unknown
    if unknown.any():
        names = [name for name, one in zip(functions, unknown, strict=True) if one]
        worst = float(np.max(found.errors[unknown] / np.abs(found.values[unknown])))
        raise ToleranceError(
            worst,
            tolerance,
            f"at noise {model.noise:g} no basis that fits resolves the variance of "
            f"{', '.join(names)}: choose a larger noise, or average along paths",
        )
    return found


def estimated_variances(
    model: LayDownModel, functions: Mapping[str, Observable], tolerance: float
) -> AsymptoticVariances:
    """The variances in the largest basis needed or possible, whatever the errors."""
    basis, work = basis_for(model), Work(DEFAULT_WORK)
    result: AsymptoticVariances | None = None
    changes = np.full(len(functions), np.inf)
    for truncation in _TRUNCATIONS:
        if result is not None and basis.size(truncation) > _LARGEST:
            break
        try:
            pairs = [_variance(basis, f, truncation, work) for f in functions.values()]
        except OutOfWork:
            break
        values, deviations = np.array(pairs).T
        errors = np.full(len(functions), np.inf)
        if result is not None:
            last, changes = changes, np.abs(values - result.values)
            errors = changes * np.array(list(map(slowness, changes, last)))
        result = AsymptoticVariances(values, errors, deviations, truncation)
        if np.all(errors <= tolerance * values + _ZERO * deviations**2):
            break
    assert result is not None
    return result


def _variance(
    basis: Basis, f: Observable, truncation: Truncation, work: Work
) -> tuple[float, float]:
    """v and ‖f − E f‖ in one basis."""
    variance = square = 0.0
    parts = list(basis.parts(f, truncation))
    largest = max(float(np.linalg.norm(part)) for _, _, part in parts)
    for sector, count, part in parts:
        if not float(np.linalg.norm(part)) > _SILENT * largest:
            continue
        matrix = basis.matrix(sector, truncation)
        kernel = basis.kernel(sector, truncation)
        if kernel is not None:
            # Only what is orthogonal to the constants is L of something.
            part = part - kernel @ (kernel.T @ part)
        solution = _solved(matrix, kernel, part, work)
        variance -= 2 * count * float(np.vdot(part, solution).real)
        square += count * float(np.vdot(part, part).real)
    return variance, float(np.sqrt(square))


def _solved(matrix: csc_array, kernel: Array | None, right: Any, work: Work) -> Any:
    """U with L u = right, orthogonal to the kernel."""
    n = len(right)
    if kernel is not None:
        # Bordered by its kernel the singular matrix is regular, and u orthogonal to it.
        columns = csc_array(kernel)
        matrix = block_array([[matrix, columns], [columns.T, None]], format="csc")
        right = np.append(right, np.zeros(kernel.shape[1]))
    factors = factorised(matrix.tocsc(), work)
    solution = factors.solve(right.real).astype(complex)
    if np.iscomplexobj(right):
        solution += 1j * factors.solve(right.imag)
    return solution[:n]
