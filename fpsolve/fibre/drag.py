"""Air drag on a long thin cylinder at every Reynolds number."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._kernels.drag import (
    CREEPING,
    FAST,
    OSEEN,
    many_resistances,
    oseen,
    oseen_slopes,
)
from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive, shown

__all__ = [
    "check_slenderness",
    "drag_coefficients",
    "drag_force",
    "drag_resistances",
]

# Below this slenderness Stokes's resistances are lower than Oseen's at `CREEPING`, and
# are joined to them by rising cubics.
MOST_SLENDERNESS = 3.5e-2


def drag_coefficients(w: ArrayLike) -> tuple[Array, Array]:
    """c_n(w), c_τ(w): force per length (ρν²/d) (w_n² c_n n + w_n w_τ c_τ τ).

    w = w_n = d |v_n|/ν is the Reynolds number of the flow v_n across the fibre; the
    flow along it enters by w_τ only, linearly. Up to w = 0.1 both are Oseen's
    expansions with S = 2.0022 − ln w,

        c_n = 4π/(S w) [1 − w² (S² − S/2 + 5/16)/(32 S)],
        c_τ = 4π/((2S − 1) w) [1 − w² (2S² − 2S + 1)/(16 (2S − 1))],

    from w = 100 on c_n = 2/√w + 1/2 and c_τ = 2/√w, and between them exponentials of
    cubics in ln w, which continue value and slope at both ends. The usual drag
    coefficient of a cylinder is 2 c_n. They grow like 1/(w |ln w|) for w → 0, and the
    force falls to 0; `drag_resistances` has a limit there.

    Parameters
    ----------
    w : array_like
        Reynolds numbers, positive.

    Returns
    -------
    normal, tangential : ndarray
        In the shape of w.

    Raises
    ------
    ValueError
        If a w is not positive and finite.

    References
    ----------
    [MW11]_.
    """
    w = _checked_reynolds("w", w)
    if not (w > 0).all():
        raise ValueError(
            f"`w` must be positive, got {w.min():g}; the coefficients are infinite at "
            "0, where `drag_resistances` are finite."
        )
    normal, tangential = _resistances(w, 0.0)
    return normal / w, tangential / w


def drag_resistances(
    w: ArrayLike, *, slenderness: float = MOST_SLENDERNESS
) -> tuple[Array, Array]:
    """r_n = w c_n(w), r_τ = w c_τ(w): force (ρν²/d) (w_n r_n n + w_τ r_τ τ).

    Oseen's expansion knows no length but the diameter, so that its resistances fall to
    0 like 1/|ln w|, with an infinite slope. A fibre has a length over which it is
    straight: with ℓ = ln(4/δ), δ its slenderness, they end at Stokes's

        r_n(0) = (4π ℓ − π)/ℓ², r_τ(0) = (2π ℓ + π/2)/ℓ²,

    and from there a cubic without a slope at 0 leads to Oseen's value and slope at
    w₀ = 2 exp(2.0022 − 4π/r_n(0)), twice the w where Oseen's first term equals r_n(0).
    So the force is differentiable in the velocity everywhere.

    Parameters
    ----------
    w : array_like
        Reynolds numbers of the flow across the fibre, 0 or more.
    slenderness : float
        δ, diameter divided by the length over which the fibre is straight; positive
        and at most 0.035, above which Stokes's limit lies beyond Oseen's expansion.

    Returns
    -------
    normal, tangential : ndarray
        In the shape of w.

    Raises
    ------
    ValueError
        If a w is negative or not finite, or the slenderness out of its range.

    References
    ----------
    [MW11]_.
    """
    w = _checked_reynolds("w", w)
    if not (w >= 0).all():
        raise ValueError(
            f"`w` must be non-negative, got {w.min():g}; it is the modulus of the "
            "velocity across the fibre times d/ν."
        )
    slenderness = check_slenderness("slenderness", slenderness)
    return _resistances(w, slenderness)


def drag_force(
    velocity: ArrayLike,
    tangent: ArrayLike,
    *,
    diameter: float,
    density: float,
    viscosity: float,
    slenderness: float = MOST_SLENDERNESS,
) -> Array:
    """f = ρν (r_n(w) v_n + r_τ(w) v_τ), w = d |v_n|/ν.

    Force of the air on a fibre per length of it. v_τ = (v·τ)τ and v_n = v − v_τ are the
    parts of the velocity of the air relative to the fibre along and across it.

    Parameters
    ----------
    velocity : array_like, shape (…, 3)
        Of the air minus that of the fibre, in m/s.
    tangent : array_like, shape (…, 3)
        Unit vectors τ; the shapes broadcast.
    diameter : float
        d of the fibre in m.
    density : float
        ρ of the air in kg/m³.
    viscosity : float
        Kinematic viscosity ν of the air in m²/s.
    slenderness : float
        As in `drag_resistances`.

    Returns
    -------
    ndarray, shape (…, 3)
        In N/m.

    Raises
    ------
    ValueError
        If a number is not finite, a parameter not positive, or a tangent not of length
        1 to within 1e-6.

    References
    ----------
    [MW11]_; [KMW09]_, equation (5).
    """
    diameter = check_positive("diameter", diameter)
    scale = check_positive("density", density) * check_positive("viscosity", viscosity)
    velocity = _checked_vectors("velocity", velocity)
    tangent = _checked_vectors("tangent", tangent)
    length = np.linalg.norm(tangent, axis=-1)
    if not (np.abs(length - 1) <= 1e-6).all():
        worst = length.flat[np.abs(length - 1).argmax()]
        raise ValueError(
            f"`tangent` must have vectors of length 1, got one of {worst:g}; divide "
            "them by their lengths."
        )
    along = (velocity * tangent).sum(axis=-1, keepdims=True) * tangent
    across = velocity - along
    w = diameter * np.linalg.norm(across, axis=-1) / viscosity
    normal, tangential = drag_resistances(w, slenderness=slenderness)
    return np.asarray(
        scale * (normal[..., None] * across + tangential[..., None] * along)
    )


def check_slenderness(name: str, value: object) -> float:
    """Return it; ValueError unless positive and at most `MOST_SLENDERNESS`."""
    slenderness = check_positive(name, value)
    if slenderness > MOST_SLENDERNESS:
        raise ValueError(
            f"`{name}` must be at most {MOST_SLENDERNESS:g}, got {slenderness:g}; a "
            "fibre is many times longer than thick."
        )
    return slenderness


def resistance_table(slenderness: float) -> tuple[Array, float, Array]:
    """Of `Drag`: the polynomials, w₀, and what joins Oseen to Stokes."""
    return np.array(_matched()), _joint(slenderness), np.array(_at_joint(slenderness)).T


def _resistances(w: Array, slenderness: float) -> tuple[Array, Array]:
    """(w c_n, w c_τ); for δ = 0 Oseen's however slow the flow is, at w > 0."""
    table = np.array(_matched()), 0.0, np.zeros((2, 3))
    if slenderness:
        table = resistance_table(slenderness)
    found = np.empty((2, w.size))
    many_resistances(w.ravel(), *table, found)
    return found[0].reshape(w.shape), found[1].reshape(w.shape)


@cache
def _matched() -> tuple[Array, Array]:
    """Coefficients of ln c in powers of ln w, from values and slopes at both ends."""
    ends = np.log([CREEPING, FAST])
    powers = np.arange(4)
    values = ends[:, None] ** powers
    slopes = powers * ends[:, None] ** np.maximum(powers - 1, 0)
    creeping = oseen(CREEPING)
    # d ln c/d ln w = w r'/r − 1.
    start = [
        CREEPING * slope / r - 1
        for r, slope in zip(creeping, oseen_slopes(CREEPING), strict=True)
    ]
    root = 2 / math.sqrt(FAST)
    end = [-0.5 * root / (root + 0.5), -0.5]
    found = [
        np.linalg.solve(
            np.concatenate([values, slopes]),
            [
                math.log(creeping[axis] / CREEPING),
                math.log(fast),
                start[axis],
                end[axis],
            ],
        )
        for axis, fast in enumerate((root + 0.5, root))
    ]
    return found[0], found[1]


def _joint(slenderness: float) -> float:
    """w₀ from which on Oseen's resistances hold."""
    return 2 * math.exp(OSEEN - 4 * math.pi / _stokes(slenderness)[0])


def _stokes(slenderness: float) -> tuple[float, float]:
    """Resistances of a slender body that is straight over 1/δ diameters."""
    length = math.log(4 / slenderness)
    return (
        (4 * math.pi * length - math.pi) / length**2,
        (2 * math.pi * length + math.pi / 2) / length**2,
    )


@cache
def _at_joint(slenderness: float) -> tuple[tuple[float, float], ...]:
    """Values at w₀, at 0, and slopes at w₀, each of r_n and r_τ."""
    joined = _joint(slenderness)
    return oseen(joined), _stokes(slenderness), oseen_slopes(joined)


def _checked_reynolds(name: str, w: ArrayLike) -> Array:
    return np.array(check_finite_numbers(name, w), dtype=np.float64)


def _checked_vectors(name: str, vectors: ArrayLike) -> Array:
    found = check_finite_numbers(name, vectors)
    if found.ndim == 0 or found.shape[-1] != 3:
        raise ValueError(
            f"`{name}` must have three components in its last axis, got "
            f"{shown(vectors)}."
        )
    return found
