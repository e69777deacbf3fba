"""Where the spinning positions are, and the phases in which their nozzles move."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive, shown
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.nozzles import (
    EllipticNozzle,
    OscillatingNozzle,
    RotatingNozzle,
)

__all__ = ["checked_phases", "drawn_phases", "has_phases", "nozzle_parts", "places_of"]

_NOZZLES = (EllipticNozzle, OscillatingNozzle, RotatingNozzle)
# Beyond these the web is no web but a slip of units.
_MOST_FIBRES = 2**31
# Generators of their own beside those of the starts, which have one number as key.
_PLACES, _PHASES = (0, 1), (0, 2)


def generator(seed: int, purpose: tuple[int, int]) -> np.random.Generator:
    """A generator that draws for one purpose."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=purpose))


def places_of(
    positions: Any, spacing: float | None, span: tuple[float, float], seed: int
) -> tuple[Array, float]:
    """Places of the fibres across the belt, increasing, and their spacing.

    Parameters
    ----------
    positions : {"regular", "random"} or array
        In the middle of cells of the width d from 0 on; or independent and uniform, a
        Poisson number of them; or given.
    spacing : float or None
        d; of given positions their mean distance by default.
    span : (float, float)
        From where to where positions are needed.
    seed : int
    """
    if not isinstance(positions, str):
        return given_places(positions, spacing)
    if positions not in ("regular", "random"):
        raise ValueError(
            "`positions` must be 'regular', 'random' or an array of places, got "
            f"{shown(positions)}."
        )
    d = check_positive("spacing", spacing, "; it is the distance of neighbours")
    low, high = span
    expected = (high - low) / d
    if not expected < _MOST_FIBRES:
        raise ValueError(
            f"`spacing` must leave fewer than {_MOST_FIBRES} fibres, got {d:g} for a "
            f"width of {high - low:g} with its margins."
        )
    if positions == "regular":
        # The cells of the width d that a part of the span belongs to.
        cells = np.arange(math.floor(low / d), math.ceil(high / d))
        return np.asarray((cells + 0.5) * d), d
    rng = generator(seed, _PLACES)
    number = int(rng.poisson(expected))
    return np.sort(rng.uniform(low, high, number)), d


def given_places(positions: Any, spacing: float | None) -> tuple[Array, float]:
    """Places that were given, checked, and their spacing."""
    places = check_finite_numbers("positions", positions)
    if places.ndim != 1 or not places.size:
        raise ValueError(
            "`positions` must be a row of places across the belt, got an array of "
            f"shape {places.shape}."
        )
    places = np.sort(places)
    if spacing is not None:
        return places, check_positive("spacing", spacing)
    if not places[-1] > places[0]:
        raise ValueError(
            "`spacing` must be given when all `positions` are one place, got "
            f"{places[0]:g}."
        )
    return places, float(np.ptp(places)) / (places.size - 1)


def has_phases(curve: Curve) -> bool:
    """Whether the nozzles move, so that it matters in which phase each is."""
    return isinstance(curve, _NOZZLES) and not curve.autonomous


def checked_phases(phases: Any, curve: Curve) -> Any:
    """What was said of the phases: a word, or an array of angles.

    Raises
    ------
    ValueError
        If it is another word; or for a curve that has no phase unless it is
        "in phase", or the default where nothing but the belt moves.
    """
    if isinstance(phases, str):
        if phases not in ("independent", "in phase"):
            raise ValueError(
                "`phases` must be 'independent', 'in phase' or an array of angles, "
                f"got {shown(phases)}."
            )
        word = phases
    else:
        phases, word = check_finite_numbers("phases", phases), "given"
    if word != "in phase" and not (has_phases(curve) or curve.autonomous):
        raise ValueError(
            "`phases` must be 'in phase' for a curve that is no rotating or "
            f"oscillating nozzle, got {shown(phases)} with {curve!r}."
        )
    return phases


def drawn_phases(phases: Any, curve: Curve, n: int, seed: int) -> Array:
    """The phase φ of every nozzle beside that of the curve; zeros where none moves."""
    if isinstance(phases, str):
        if phases == "in phase" or not has_phases(curve):
            return np.zeros(n)
        return generator(seed, _PHASES).uniform(0.0, 2 * math.pi, n)
    if phases.shape != (n,):
        raise ValueError(
            f"`phases` must be one angle for each of the {n} fibres, got an array of "
            f"shape {phases.shape}; give the positions too, so that their number is "
            "known."
        )
    return np.asarray(phases, dtype=np.float64)


def nozzle_parts(curve: Curve) -> tuple[Curve, Curve]:
    """The motion of the nozzle alone, and a quarter of a turn ahead.

    With the phase φ the nozzle is at cos φ times the first and sin φ times the second:
    what φ adds to its place is (cos φ - 1) of one and sin φ of the other.
    """
    still: Any = replace(curve, speed=0.0)  # type: ignore[type-var]
    return still, replace(still, phase=still.phase + 0.5 * math.pi)
