"""The reference curve of a fibre by least squares: the best parametric fit."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_finite, check_flag, check_kind, check_one_of
from fpsolve.model.curves.curve import Curve, check_speed
from fpsolve.model.curves.nozzles import OscillatingNozzle, RotatingNozzle
from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = ["CurveFit", "fit_curve"]

MOTIONS = ("rotating", "oscillating")
# Blocks from which standard errors come, and periods that a block must hold so that
# neighbours are independent and the phase of γ drops out of it.
N_BLOCKS, FEWEST_PERIODS, FEWEST_BLOCKS = 20, 1, 8


@dataclass(frozen=True, eq=False)
class CurveFit:
    """A reference curve that was fitted to a fibre.

    Attributes
    ----------
    curve : RotatingNozzle or OscillatingNozzle
    radius, phase : float
        r and φ.
    radius_error, phase_error : float
        Standard errors, from blocks of the fibre.
    centre : (float, float)
        What the points are away from γ on average; 0 unless asked for.
    fibre : FibreCurve
        The fibre with that curve, its points centred.
    """

    curve: Curve
    radius: float
    phase: float
    radius_error: float
    phase_error: float
    centre: tuple[float, float]
    fibre: FibreCurve


def fit_curve(
    fibre: FibreCurve,
    angular_speed: float,
    speed: float = 0.0,
    *,
    motion: str = "rotating",
    centre: bool = False,
) -> CurveFit:
    """min over r, φ of Σ ‖η - γ‖² with γ = -v s e1 + r (cos(ωs + φ), sin(ωs + φ)).

    ω and v are those of the process; for an oscillating nozzle γ = -v s e1 +
    r sin(ωs + φ) e2. With p = r cos φ and q = r sin φ the fit is linear and exact.
    Standard errors are those of the means of independent blocks of the fibre.

    Fibres lag behind their nozzle: E ξ turns with it, and this fit, which is that of
    the paper, finds the circle of E η and not that of γ. For ω → 0 the mean of ξ is
    that of a belt of speed ωr, about A²ωr at right angles to γ: the phase is off by
    about A²ω, and the radius by the part (A²ω)²/2.

    Parameters
    ----------
    fibre : FibreCurve
    angular_speed : float
        ω, not zero, with its sign.
    speed : float, optional
        v.
    motion : {"rotating", "oscillating"}
    centre : bool, optional
        Whether the mean of the points is fitted as well, where the place below the
        nozzle was not measured. On a belt that moves this takes the mean of ξ away.

    Returns
    -------
    CurveFit

    Raises
    ------
    ValueError
        If ω is 0, or the fibre does not cover eight periods 2π/ω.
    TypeError
        If an argument is of another kind.

    References
    ----------
    [KMW09]_, section 4.1.
    """
    check_kind("fibre", fibre, FibreCurve, "make one by FibreCurve(eta, ds)")
    check_one_of("motion", motion, MOTIONS)
    omega, v = check_finite("angular_speed", angular_speed), check_speed("speed", speed)
    if omega == 0:
        raise ValueError(
            "`angular_speed` must not be 0, got 0; a nozzle at rest needs no fit, its "
            "curve is MovingBelt(speed)."
        )
    blocks = _blocks(fibre, 2 * math.pi / abs(omega))
    rows = _Rows(omega, v, motion, check_flag("centre", centre))
    found, covariance = _least_squares([rows.of(*block) for block in blocks])
    p, q = found[:2]
    radius, phase = math.hypot(p, q), math.atan2(q, p)
    # Of r and φ as functions of p and q.
    slopes = np.array([[p, q], [-q / radius, p / radius]]) / radius
    errors = np.sqrt(np.diag(slopes @ covariance[:2, :2] @ slopes.T)).tolist()
    curve: Curve
    if motion == "rotating":
        curve = RotatingNozzle(v, radius, omega, phase)
    else:
        curve = OscillatingNozzle(v, radius, omega, phase)
    middle = (float(found[2]), float(found[3])) if centre else (0.0, 0.0)
    moved = replace(fibre, eta=fibre.eta - np.array(middle), curve=curve, call=None)
    return CurveFit(curve, radius, phase, errors[0], errors[1], middle, moved)


@dataclass(frozen=True)
class _Rows:
    """Equations η + v s e1 = M (p, q, c1, c2) at the points of a block."""

    omega: float
    speed: float
    motion: str
    centre: bool

    def of(self, eta: Array, s: Array) -> tuple[Array, Array]:
        cosine, sine = np.cos(self.omega * s), np.sin(self.omega * s)
        one, zero = np.ones_like(s), np.zeros_like(s)
        across = np.stack([sine, cosine, zero, one])
        along = np.stack([cosine, -sine, one, zero])
        # Swings do not move the fibre along the belt.
        still = np.stack([zero, zero, one, zero])
        first = along if self.motion == "rotating" else still
        columns = slice(None) if self.centre else slice(2)
        matrix = np.concatenate([first, across], axis=1)[columns]
        target = np.concatenate([eta[:, 0] + self.speed * s, eta[:, 1]])
        return matrix.T, target


def _blocks(fibre: FibreCurve, period: float) -> list[tuple[Array, Array]]:
    """Parts of the fibres of whole periods, about as many as `N_BLOCKS`."""
    periods = fibre.length / period
    per_block = max(FEWEST_PERIODS, math.floor(periods / N_BLOCKS))
    size = round(per_block * period / fibre.ds)
    blocks = [
        (eta[k : k + size], s[k : k + size])
        for eta, s in zip(fibre.pieces, fibre.arclengths, strict=True)
        for k in range(0, len(eta) - size + 1, size)
    ]
    if not len(blocks) >= FEWEST_BLOCKS:
        raise ValueError(
            f"`fibre` must cover at least {FEWEST_BLOCKS} periods of its nozzle for "
            f"its curve to be fitted, got a length of {fibre.length:g} and a period of "
            f"{period:g}; measure a longer one."
        )
    return blocks


def _least_squares(blocks: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """The solution, and its covariance from the scores of the blocks."""
    grams = [matrix.T @ matrix for matrix, _ in blocks]
    rights = [matrix.T @ target for matrix, target in blocks]
    inverse = np.linalg.inv(np.sum(grams, axis=0))
    found = inverse @ np.sum(rights, axis=0)
    scores = np.array(
        [right - gram @ found for gram, right in zip(grams, rights, strict=True)]
    )
    n = len(blocks)
    spread = n / (n - len(found)) * scores.T @ scores
    return found, inverse @ spread @ inverse
