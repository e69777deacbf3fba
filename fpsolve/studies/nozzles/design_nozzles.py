"""The frequency and the radii with which nozzles lay the most even pattern."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_integer, check_positive, shown
from fpsolve.evolution.call import recorded
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.studies.arguments import checked_pair, several
from fpsolve.studies.nozzles.confirm import laid_squares
from fpsolve.studies.nozzles.patterns import Asked, Patterns
from fpsolve.studies.nozzles.result import NozzleDesign
from fpsolve.studies.nozzles.valleys import (
    RESOLUTION,
    best_of,
    range_of,
    scanned,
    searched,
)
from fpsolve.web.pattern_of_model import check_nozzle_model
from fpsolve.web.pattern_row import IN_PHASE, INDEPENDENT, offsets_of

__all__ = ["design_nozzles"]

FREQUENCY = "angular_speed"
# Free numbers at most: a scan of three takes an hour. Points along an axis of one or
# of two.
MOST_FREE, N_SCAN = 2, (17, 7)


@recorded()
def design_nozzles(
    model: LayDownModel,
    zones: ArrayLike,
    *,
    spacing: float,
    bounds: Mapping[str, tuple[float, float]],
    phases: Any = IN_PHASE,
    n_scan: int = 0,
    tolerance: float = 2e-3,
    n_webs: int = 12,
    seed: int = 1,
) -> NozzleDesign:
    """min Σ CV²(x_i) of the mean pattern, over ω and radii of moving nozzles.

    CV²(x) = Σ |c_nm|² sinc²(k₁x/2) sinc²(k₂x/2), with c_nm of `mean_pattern` from the
    generator: the strips and holes that all webs of these nozzles share. About it the
    fibres vary by themselves, which is not predicted for moving nozzles: laid webs say
    how much.

    The Bessel functions in c_nm make many valleys. The pattern is computed on a grid of
    logarithms, and the three deepest valleys are searched by the simplex of Nelder and
    Mead until its corners differ by less than the errors of the pattern. Between the
    points of the scan a valley may be missed: what was computed is returned.

    Parameters
    ----------
    model : LayDownModel
        As for `mean_pattern`; what is not free stays as it is.
    zones : array_like
        Sides of square zones.
    spacing : float
        Distance of neighbouring nozzles.
    bounds : mapping of str to (float, float)
        Lowest and highest value of one or two of "angular_speed" and the radii as the
        nozzle names them: "radius", "amplitude", "radius1", "radius2". Positive; a
        nozzle that turns the other way does so still.
    phases : "in phase" or array_like, shape (N,)
        Of neighbouring nozzles, as for `mean_pattern`.
    n_scan : int
        Points along every axis, at least 3; by default 17 of one and 7 of two.
    tolerance : float
        Of the amplitudes of the pattern.
    n_webs : int
        Webs laid of the optimum for every zone, 0 or at least 2.
    seed : int
        Of these webs.

    Returns
    -------
    NozzleDesign

    Raises
    ------
    ValueError, TypeError
        Bad arguments, as `mean_pattern`.
    ToleranceError
        If no pattern of the scan is known to the tolerance.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    check_nozzle_model(model)
    names, low, high = checked_space(model, bounds)
    asked = Asked(
        model, names, checked_sides(zones), check_positive("spacing", spacing),
        checked_phases(phases), checked_tolerance(tolerance),
    )  # fmt: skip
    n = check_integer("n_scan", n_scan, at_least=0) or N_SCAN[len(names) - 1]
    n = check_integer("n_scan", n, at_least=3)
    n_webs, seed = several("n_webs", n_webs), check_integer("seed", seed, at_least=0)
    patterns = Patterns(asked)
    step = (high - low) / (n - 1)
    valleys = scanned(patterns, low, high, n)
    n_scanned = len(patterns.known)
    for start in valleys:
        searched(patterns, start, low, high, 0.5 * step)
    return design_of(patterns, (low, high), n_scanned, n_webs, seed)


def design_of(
    patterns: Patterns,
    ends: tuple[Array, Array],
    n_scanned: int,
    n_webs: int,
    seed: int,
) -> NozzleDesign:
    """The result, with webs laid of the best point."""  # fmt: skip
    asked, best = patterns.asked, best_of(patterns)
    model, found = asked.at(np.exp(best)), list(patterns.known.values())
    squares = np.full((2, 2, asked.zones.size), np.nan)
    if n_webs:
        squares[:] = laid_squares(
            model, asked.zones, asked.spacing, asked.phases, n_webs, seed
        )
    phases = asked.phases
    told = phases if isinstance(phases, str) else tuple(offsets_of(phases).tolist())
    at = patterns(best)
    # A simplex that has ended says no more than its resolution.
    widest = np.array([[-RESOLUTION], [RESOLUTION]])
    where = np.clip(range_of(patterns) + widest, *ends)
    return NozzleDesign(
        model, asked.names, asked.spacing, told, np.exp(ends[0]), np.exp(ends[1]),
        np.exp(where), asked.zones, at.cv, at.errors,
        np.exp(patterns.points), n_scanned,
        np.array([one.cv for one in found]), np.array([one.errors for one in found]),
        squares[0, 0], squares[1, 0], squares[0, 1], squares[1, 1], n_webs,
    )  # fmt: skip


def checked_space(
    model: LayDownModel, bounds: Any
) -> tuple[tuple[str, ...], Array, Array]:
    """Names of the free numbers, and logarithms of their bounds."""
    curve: Any = model.curve
    known = (FREQUENCY, *curve._lengths)
    if not isinstance(bounds, Mapping):
        raise TypeError(
            "`bounds` must be a mapping of names to (lowest, highest), got "
            f"{shown(bounds)}."
        )
    unknown = [shown(one) for one in bounds if one not in known]
    if unknown or not 0 < len(bounds) <= MOST_FREE:
        raise ValueError(
            f"`bounds` must be of one or two of {', '.join(known)}, got "
            f"{', '.join(unknown or map(shown, bounds)) or 'none'}; these are the free "
            f"numbers of {type(curve).__name__}."
        )
    names = tuple(name for name in known if name in bounds)
    pairs = [checked_pair(name, bounds[name]) for name in names]
    low, high = np.log(np.array(pairs)).T
    return names, low, high


def checked_sides(zones: Any) -> Array:
    """Sides of zones; ValueError unless there is one and all are positive."""
    sides = np.atleast_1d(check_finite_numbers("zones", zones)).ravel()
    if not sides.size or not (sides > 0).all():
        raise ValueError(
            "`zones` must be sides of zones, all positive, got "
            f"{shown(sides.tolist())}."
        )
    return sides


def checked_phases(phases: Any) -> Any:
    """Phases that lay one pattern together."""
    if isinstance(phases, str) and phases == INDEPENDENT:
        raise ValueError(
            "`phases` must be 'in phase' or an array, got 'independent'; waves of "
            "fibres that know nothing of each other are no pattern."
        )
    offsets_of(phases)
    return phases
