"""The power spectrum of a web of independent fibres, from the generator of one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.blas import one_blas_thread
from fpsolve.model.fibre import FibreModel
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.spectral.resolvent.fibre import check_fibre, fibre_of

__all__ = ["WebSpectrum", "web_spectrum"]


class WebSpectrum(np.ndarray[Any, np.dtype[np.float64]]):
    """Ŝ as an array, with what it may be wrong by beside it.

    What is computed with it is an ordinary array, and so is what is reshaped; a part of
    it keeps its errors.

    Parameters
    ----------
    values : array_like
    errors : array_like
        Bounds of the errors; they broadcast to the shape of the values.
    """

    errors: Array

    def __new__(cls, values: Array, errors: Array) -> WebSpectrum:
        """An array with errors."""
        made = np.array(values, dtype=np.float64).view(cls)
        made.errors = np.broadcast_to(np.asarray(errors, float), made.shape)
        return made

    def __getitem__(self, index: Any) -> Any:
        """A number, or a part with its errors."""
        values = np.asarray(self)[index]
        if np.ndim(values) == 0:
            return values
        return WebSpectrum(values, self.errors[index])

    def __array_wrap__(self, array: Any, *_: Any) -> Any:
        """An ordinary array, or a number."""
        return np.asarray(array)[()]


@one_blas_thread()
def web_spectrum(
    model: FibreModel, k1: ArrayLike, k2: ArrayLike, *, tolerance: float = 1e-3
) -> WebSpectrum:
    """Ŝ(k) = 2 Re E e^{−ik·ξ} (i k1 v − L)⁻¹ (e^{ik·ξ} − E e^{ik·ξ}).

    Of one fibre Ŝ is the spectrum of where it lies, ∫ (E e^{ik·(η_s − η_0)} − |φ|²
    e^{−i k1 v s}) ds with η = ξ + γ, φ = E e^{ik·ξ} and L the backward generator. A web
    of independent fibres at distance d has the mean length per area m = 1/(v d) and
    the power spectrum m Ŝ. The coherent line 2π |φ(0, k2)|² δ(k1)/v, which random
    spinning positions add, is left out; `predict_web` counts it.

    For |k| σ up to 3 one factorisation serves all k2 of a k1. Beyond that the equation
    −(L + ik·τ) u = 1 is solved, of which few polynomials suffice, and very short waves
    have Ŝ = (2π/|k|) [f(β + π/2) + f(β − π/2)] with the law f of the angle and β the
    direction of k, corrected by what it lacks at |k| σ = 300 or at |k| = 20 A².
    Long waves end in Ŝ = k·C k, no fibre gets lost: C = 2 E ξ (−L)⁻¹ (ξ − E ξ), which
    is used up to |k| = 1e-3 of what it forgets over, so that tiny k lose no digits.
    On a belt at rest under an isotropic potential long waves split into sectors of the
    angular index, which are small: up to |k| σ = 6 they are solved down to A = 0.2.
    Other short waves are refused below A √σ = 0.7, where their errors do not cover.

    Of a smooth fibre the functions have a third factor, Hermite polynomials of κ, and
    Gaussians that leave the law its wider tails. Short waves see arcs instead of
    straight pieces, Ŝ lacks (π/12|k|³) Σ± (f₂⁗ − 2f₂″ − 3f₂)(β ± π/2), f₂ = E[κ² | α]
    f, and then O(|k|⁻⁴) of it, which is measured where waves are short against 1/σ,
    the radius of curvature, and (R/A)^(2/3).

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        With a `QuadraticPotential`, of the basic model also with an isotropic potential
        that is smooth in ‖ξ‖², such as B = r⁴/4 or a user's own, and a belt at rest or
        at constant speed.
    k1, k2 : array_like
        Wave numbers along and across the belt in radians per unit of ξ; they broadcast.
    tolerance : float
        For every number, relative to itself; beyond |k| σ = 3, and of smooth fibres
        everywhere, relative to the larger of itself and σ/(1 + |k| σ), σ the smaller
        throwing range or, for a potential that has none, the root mean square of ξ1 at
        rest.

    Returns
    -------
    WebSpectrum
        An array in the broadcast shape, with its `errors`: twice the change from the
        next smaller truncation, of smooth fibres the larger of that and half of the
        change before.

    Raises
    ------
    ValueError
        If the potential is neither quadratic nor isotropic and smooth, the noise is not
        positive, the curve is no belt at constant speed, or a wave number not finite.
    TypeError
        If the model is no lay-down model.
    ToleranceError
        If no truncation is fine enough, as at low noise.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    check_fibre(model)
    tolerance = checked_tolerance(tolerance)
    first, second = check_finite_numbers("k1", k1), check_finite_numbers("k2", k2)
    first, second = np.broadcast_arrays(first, second)
    values, errors = fibre_of(model).spectrum(first.ravel(), second.ravel(), tolerance)
    return WebSpectrum(values.reshape(first.shape), errors.reshape(first.shape))
