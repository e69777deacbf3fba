"""T as two products with circulant matrices for every angle."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.arrays.library import Foreign, Library
from fpsolve.density.schemes.fourier_translation import (
    FourierTranslation,
    shift_weights,
)
from fpsolve.density.schemes.stencils import shift_taps
from fpsolve.density.schemes.translation import Translation

__all__ = ["CirculantTranslation", "circulant_columns"]

# Half a step and a whole one.
_KEPT = 2


class CirculantTranslation:
    """∂ₛp + (τ(α) − γ′(s))·∇_ξ p = 0: p ← C₁(α) p C₂(α)ᵀ, plane by plane.

    C₁ and C₂ are the circulants of a `Translation`, of piecewise polynomials or
    trigonometric: the same numbers but for the rounding of sums. They are laid out on
    the device from one column for every angle.

    Parameters
    ----------
    translation : Translation
        Of the same equation on the host; not `positive`.
    library : Library
    """

    def __init__(self, translation: Translation, library: Library) -> None:
        self.translation, self.library = translation, library
        self._made: dict[tuple[float, float], tuple[Foreign, Foreign]] = {}
        self.places = tuple(library.array(circulant(n)) for n in self.sizes)
        self.shift = library.compiled(shifted)
        self.lay_out = library.compiled(laid_out)

    @property
    def sizes(self) -> tuple[int, int]:
        """Cells in both directions."""
        return self.translation.grid.shape[:2]

    def __call__(self, planes: Foreign, s: float, ds: float) -> Foreign:
        """Return planes (n_alpha, n1, n2), advanced from s to s + ds."""
        return self.shift(planes, *self.matrices(s, ds))

    def matrices(self, s: float, ds: float) -> tuple[Foreign, Foreign]:
        """C₁ (n_alpha, n1, n1) and C₂ᵀ (n_alpha, n2, n2)."""
        # Rounding of s must not defeat the memory for belts of constant speed.
        start = 0.0 if self.translation.curve.autonomous else s
        known, key = self._made, (start, ds)
        if key in known:
            return known[key]
        column1, column2 = circulant_columns(self.translation, start, ds)
        array, (place1, place2) = self.library.array, self.places
        made = (
            self.lay_out(array(column1.T), place1),
            self.lay_out(array(column2.T), place2.T),
        )
        # A new table takes the place of the old: a thread may be reading that.
        self._made = {**(known if len(known) < _KEPT else {}), key: made}
        return made


def circulant(n: int) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Which entry of its first column a circulant has at i, j: (i − j) mod n."""
    return (np.arange(n)[:, None] - np.arange(n)) % n


def circulant_columns(
    translation: Translation, s: float, ds: float
) -> tuple[Array, Array]:
    """First columns of C₁ and C₂ for every angle; shapes (n1, n_alpha), (n2, n_alpha).

    Each sums to one, so that mass is kept.
    """
    shift1, shift2 = translation.shifts(s, ds)
    n1, n2 = translation.grid.shape[:2]
    if isinstance(translation, FourierTranslation):
        return fourier_column(shift1, n1), fourier_column(shift2, n2)
    order = translation.order
    return wrapped_taps(shift1, order, n1), wrapped_taps(shift2, order, n2)


def fourier_column(shift: Array, n: int) -> Array:
    """c_d of p(x − shift) ≈ Σ_d c_d p(x − d) by the trigonometric interpolant."""
    parts = shift_weights(shift, n)
    if n % 2:
        whole: Array = parts[0]
        return whole
    return np.concatenate([parts[0] + parts[1], parts[0] - parts[1]])


def wrapped_taps(shift: Array, order: int, n: int) -> Array:
    """Likewise by piecewise polynomials: what is a period further on is added."""
    first, weights = shift_taps(shift, order)
    column = np.zeros((n, weights.shape[1]))
    np.add.at(column, (first + np.arange(len(weights))) % n, weights)
    return column


def laid_out(xp: Any, columns: Foreign, places: Foreign) -> Foreign:
    """matrices[k, i, j] = columns[k, places[i, j]]."""
    flat = xp.take(columns, xp.reshape(places, (-1,)), axis=1)
    return xp.reshape(flat, (-1, *places.shape))


def shifted(xp: Any, planes: Foreign, left: Foreign, right: Foreign) -> Foreign:
    """left[k] planes[k] right[k]."""
    return xp.matmul(xp.matmul(left, planes), right)
