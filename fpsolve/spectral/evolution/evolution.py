"""Time evolution for quadratic B by expansion: H(s) and moments to many digits."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_positive
from fpsolve.evolution.call import recorded
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution import smooth_transient, transient
from fpsolve.spectral.evolution.quadratic import check_parts, checked_tolerance
from fpsolve.spectral.evolution.smooth_solution import SmoothSpectralSolution
from fpsolve.spectral.evolution.solution import SpectralSolution
from fpsolve.spectral.work import Work

__all__ = ["spectral_solve"]

# Work that is allowed unless told otherwise: about a minute.
DEFAULT_WORK = 3e10


@recorded()
@one_blas_thread()
def spectral_solve(
    model: FibreModel,
    p0: Any,
    s: ArrayLike,
    *,
    tolerance: float | None = None,
    memory_limit: int | None = None,
    work_limit: float = DEFAULT_WORK,
) -> SpectralSolution | SmoothSpectralSolution:
    """H(p|p_S) and moments at s, for B quadratic, by expansion in Hermite × Fourier.

    p/p_S is expanded in functions orthonormal in L²(μ), where (7) is a sparse matrix;
    its exponential is applied by Chebyshev series, and which coefficients are kept
    follows the solution. Nothing of a grid scheme is used. Exact: the norm balance
    d‖h‖²/ds = −A²‖∂_α h‖² on a fixed belt.

    For an isotropic B on a belt at rest the functions are circular Hermite functions
    times e^{ikα}, which split by the angular index M = l + k into sectors: small real
    recurrences, of which those present in p0 are evolved, one by one. (7) is
    dissipative in L²(μ), so that what is left out is at most as large later: every
    sector has a bound from the norms left out at each fitting, the tolerances of the
    series, and E² = 2 ∫ ‖edge‖ ‖(1 − P) L* h‖ ds, what flows out of the coefficients P
    kept, with the norm of the last of them for those beyond. How much smaller the error
    is than the bound is measured: five sectors are evolved a hundred times as coarsely,
    their distance from the run is their error, and all errors are taken to be three
    times its share of their bounds. That is validated, not proved. Mass is conserved
    exactly.

    Otherwise the basis is He_i(ξ1/σ1) He_j(ξ2/σ2) e^{ikα}, refined until two
    truncations agree to `tolerance` in every number at every s. Mass is conserved up to
    the tolerance of the exponential. In both the entropy converges last, most slowly
    just after a narrow start; low noise lets the density fold and needs many more
    degrees and harmonics.

    Of a smooth model there are the moments only, with those of κ and without H. The
    density is expanded in circular Hermite functions of ξ, Hermite functions of κ and
    e^{ikα} that carry a part of a Gaussian weight; the last of them are damped, as the
    truncated equation is not stable by itself. Mass is not conserved but for what is
    neglected, and what is missing of it is part of every error.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        With a QuadraticPotential, isotropic or not, positive noise, and a belt at rest
        or of constant speed.
    p0 : GaussianLaw or (PhaseSpaceGrid, ndarray)
        A law with `mean`, `variance`, `angle` and `concentration`, whose coefficients
        are known in closed form, or a density on a grid that resolves it and has room
        for it: p0/p_S must be in L²(μ). Of a smooth model a law; κ is independent of it
        and Gaussian of variance K²R/2, as for `sample_paths`.
    s : float or array_like
        Arclengths, non-negative and increasing; p0 is the density at s = 0.
    tolerance : float
        Largest error of each number, relative where the number is above one. By default
        1e-8, and 1e-6 for a smooth model.
    memory_limit : int, optional
        Bytes; by default what the machine has available.
    work_limit : float
        Coefficients that may be gone through, about two nanoseconds each: with little
        noise they become many, with much noise the steps.

    Returns
    -------
    SpectralSolution or SmoothSpectralSolution

    Raises
    ------
    ValueError
        If the potential is not quadratic, the noise not positive, the curve not a
        straight line at constant speed, the arclengths not increasing, or the start
        not in L²(μ) or not resolved by its grid.
    TypeError
        If `p0` is of another kind.
    MemoryLimitError
        If not even the two coarsest truncations fit.
    ToleranceError
        If the tolerance is not reached within the memory, the work or the refinements.

    References
    ----------
    [KMW09]_, equations (7), (9), (11) and (23).
    """
    check_fibre_model(model)
    check_parts(model)
    smooth = isinstance(model, SmoothLayDownModel)
    solver: Any = smooth_transient if smooth else transient
    tolerance = checked_tolerance(solver.TOLERANCE if tolerance is None else tolerance)
    stops = checked_arclengths(s)
    work = Work(check_positive("work_limit", work_limit))
    found: SpectralSolution | SmoothSpectralSolution = solver.transient(
        model, p0, stops, tolerance, memory_limit, work
    )
    return found


def checked_arclengths(s: ArrayLike) -> Array:
    """s as an increasing array; ValueError unless it is one."""
    stops = np.atleast_1d(check_numbers("s", s))
    if stops.ndim != 1 or stops.size == 0:
        raise ValueError(f"`s` must be one number or a list of them, got {s!r}.")
    rising = np.isfinite(stops).all() and (np.diff(stops) > 0).all()
    if not (rising and stops[0] >= 0):
        raise ValueError(
            f"`s` must be finite, non-negative and increasing, got {stops.tolist()}."
        )
    return stops
