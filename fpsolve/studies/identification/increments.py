"""The functional (24), and the increments of angle and curvature that enter it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer, check_kind
from fpsolve.paths.fibres.chords import chord_angles, chord_curvatures
from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = [
    "NAMES",
    "IncrementCurves",
    "Sample",
    "Squares",
    "check_long_enough",
    "functional",
    "increment_curves",
    "lags_up_to",
    "log_functional",
    "samples_of",
    "squares",
    "usual_k_max",
]

# Components of (24), which are guesses of the parameters of these names.
NAMES = ("sigma1", "sigma2", "noise", "curvature_noise")
# Lags: all up to there, and beyond as many again at equal ratios.
ALL_LAGS = 24
# k_max Δs in units of the larger σ, between 2 and 4 as measured; and how many points of
# a fibre an increment needs.
REACH, PER_LAG = 3.0, 10
# Units of σ below which the fibre is too short for its own variance.
SHORTEST = 100.0


@dataclass(frozen=True, eq=False)
class IncrementCurves:
    """Γ_α and Γ_κ of a fibre.

    Attributes
    ----------
    h : ndarray, shape (n,)
        Distances k Δs along the fibre.
    angle, curvature : ndarray, shape (n,)
        √(E(α(s+h) - α(s))²/h), and the same of κ.
    """

    h: Array
    angle: Array
    curvature: Array


@dataclass(frozen=True, eq=False)
class Sample:
    """Fibres of one length side by side.

    Attributes
    ----------
    xi : ndarray, shape (n, m, 2)
    alpha : ndarray, shape (n - 1, m)
    """

    xi: Array
    alpha: Array

    @classmethod
    def of(cls, xi: Array, eta: Array) -> Sample:
        """Of deviations and points, both of shape (n, m, 2)."""
        return cls(xi, chord_angles(eta))


@dataclass(frozen=True, eq=False)
class Squares:
    """Means along every fibre, from which (24) and more follow.

    Attributes
    ----------
    xi : ndarray, shape (5, m)
        Means of ξ1, ξ2, ξ1², ξ2², ξ1 ξ2.
    angle, curvature : ndarray, shape (n_lags, m)
        Mean squares of the increments, over h.
    """

    xi: Array
    angle: Array
    curvature: Array

    def pooled(self) -> Squares:
        """Those of all fibres together, m = 1."""
        return Squares(*(
            part.mean(axis=1, keepdims=True)
            for part in (self.xi, self.angle, self.curvature)
        ))  # fmt: skip


def increment_curves(fibre: FibreCurve, k_max: int | None = None) -> IncrementCurves:
    """Γ_α(h) = √(E(α(s+h) - α(s))²/h) and Γ_κ(h) at h = k Δs, k = 1, …, k_max.

    α and κ are those of the chords, unwrapped, so that the curves of data and model
    are comparable where both have the same Δs. Lags are all up to 24, and 24 more at
    equal ratios beyond.

    Parameters
    ----------
    fibre : FibreCurve
    k_max : int, optional
        By default 3 of the larger root mean square of ξ, in steps.

    Returns
    -------
    IncrementCurves

    Raises
    ------
    ValueError
        If the angle cannot be unwrapped, or k_max is more than a tenth of a fibre.

    References
    ----------
    [KMW09]_, section 4.1.
    """
    lags, found = _of_fibre(fibre, k_max)
    return IncrementCurves(
        np.asarray(lags * fibre.ds, dtype=np.float64),
        np.sqrt(found.angle[:, 0]),
        np.sqrt(found.curvature[:, 0]),
    )


def functional(fibre: FibreCurve, k_max: int | None = None) -> dict[str, float]:
    """(√⟨ξ₁²⟩, √⟨ξ₂²⟩, max Γ_α(kΔs), max Γ_κ(kΔs)), the functional (24).

    Its components are guesses of (σ1, σ2, RK, K), by whose names they go. Γ_α is not
    bounded by RK: a fibre that circles lets it grow with h, so that the third component
    depends on k_max, which must be told with it.

    Parameters
    ----------
    fibre : FibreCurve
        With its reference curve.
    k_max : int, optional
        As for `increment_curves`.

    Returns
    -------
    dict of float

    References
    ----------
    [KMW09]_, equation (24).
    """
    _, found = _of_fibre(fibre, k_max)
    values = np.exp(log_functional(found)[:, 0])
    return dict(zip(NAMES, values.tolist(), strict=True))


def _of_fibre(fibre: Any, k_max: int | None) -> tuple[NDArray[np.int64], Squares]:
    check_kind("fibre", fibre, FibreCurve, "make one by FibreCurve(eta, ds)")
    fibre.check_turns()
    longest = usual_k_max(fibre) if k_max is None else k_max
    lags = lags_up_to(checked_k_max(fibre, longest))
    return lags, squares(samples_of(fibre), lags, fibre.ds)


def checked_k_max(fibre: FibreCurve, k_max: Any) -> int:
    """k_max as an int; ValueError where too few increments are left."""
    longest = check_integer("k_max", k_max, 1)
    most = int(fibre.lengths.min()) // PER_LAG
    if not longest <= most:
        raise ValueError(
            f"`k_max` must be at most a tenth of the points of the shortest fibre, "
            f"{most}, got {longest}; take a longer fibre or a smaller `k_max`."
        )
    return longest


def usual_k_max(fibre: FibreCurve) -> int:
    """Steps of which 3 of the larger σ consist; no more than a tenth of a fibre."""
    wanted = int(REACH * largest_spread(fibre) / fibre.ds + 0.5)
    most: int = int(fibre.lengths.min()) // PER_LAG
    usual: int = max(1, min(max(wanted, 8), most))
    return usual


def largest_spread(fibre: FibreCurve) -> float:
    """The larger root mean square of ξ1 and ξ2."""
    xi = np.concatenate(fibre.deviations)
    return float(np.sqrt(np.mean(xi**2, axis=0)).max())


def check_long_enough(fibre: FibreCurve) -> None:
    """Raise ValueError for a fibre shorter than 100 σ."""
    sigma = largest_spread(fibre)
    if not fibre.length >= SHORTEST * sigma:
        raise ValueError(
            f"`curve_or_eta` must be at least {SHORTEST:g} throwing ranges long, got a "
            f"length of {fibre.length:.4g} and √⟨ξ²⟩ = {sigma:.4g}; measure a longer "
            "fibre, and check that the reference curve is that of the points."
        )


def lags_up_to(k_max: int) -> NDArray[np.int64]:
    """k = 1, …, k_max, thinned out at equal ratios beyond 24."""
    near = np.arange(1, min(ALL_LAGS, k_max) + 1)
    if k_max <= ALL_LAGS:
        return near
    far = np.geomspace(ALL_LAGS, k_max, ALL_LAGS + 1)[1:]
    return np.unique(np.concatenate([near, np.rint(far).astype(np.int64)]))


def samples_of(fibre: FibreCurve) -> list[Sample]:
    """Every fibre as a sample of one."""
    return [
        Sample.of(xi[:, None], eta[:, None])
        for xi, eta in zip(fibre.deviations, fibre.pieces, strict=True)
    ]


def squares(pieces: Sequence[Sample], lags: NDArray[np.int64], ds: float) -> Squares:
    """Means along fibres, each of several pieces one after the other."""
    found = [_piece(piece, lags, ds) for piece in pieces]
    weights = np.array([len(piece.xi) for piece in pieces], dtype=np.float64)
    return Squares(*(
        np.average([getattr(one, name) for one in found], axis=0, weights=weights)
        for name in ("xi", "angle", "curvature")
    ))  # fmt: skip


def _piece(piece: Sample, lags: NDArray[np.int64], ds: float) -> Squares:
    x, y = piece.xi[..., 0], piece.xi[..., 1]
    moments = [x, y, x * x, y * y, x * y]
    kappa = chord_curvatures(piece.alpha, ds)
    return Squares(
        np.array([one.mean(axis=0) for one in moments]),
        _increments(piece.alpha, lags, ds),
        _increments(kappa, lags, ds),
    )


def _increments(values: Array, lags: NDArray[np.int64], ds: float) -> Array:
    """Means of (v(s+h) - v(s))²/h over s, (n_lags, m)."""
    found = np.empty((len(lags), values.shape[1]))
    for number, k in enumerate(lags):
        step = values[k:] - values[:-k]
        found[number] = np.einsum("ij,ij->j", step, step) / (len(step) * k * ds)
    return found


def log_functional(found: Squares) -> Array:
    """Logarithms of (24) for every fibre, (4, m)."""
    return np.asarray(0.5 * np.log(np.stack([
        found.xi[2], found.xi[3], found.angle.max(axis=0), found.curvature.max(axis=0),
    ])))  # fmt: skip
