"""The web of a design, laid: its variation beside the one predicted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.studies.design.settings import Settings
from fpsolve.web.lay_web import lay_web

__all__ = ["laid_variation"]

# Zones along each side of a web, at least, and throwing ranges, within which zones see
# the same fibres.
N_ZONES, LONG = 10, 4.0
# Throwing ranges beside the window, beyond which a fibre is as good as never.
BESIDE = 6.0


def laid_variation(
    settings: Settings, zones: Array, positions: str, n_webs: int, seed: int
) -> tuple[Array, Array]:
    """CV of laid webs, and its standard error from their spread.

    Every zone has webs of its own, whose pixels are the zones, so that nothing is lost
    at edges; the deviation is that from 1/(v d), which is exact.
    """
    found = []
    seeds = iter(np.random.SeedSequence(seed).spawn(zones.size * n_webs))
    for zone in zones:
        squares = np.array([
            web_square(settings, float(zone), positions, next(seeds))
            for _ in range(n_webs)
        ])  # fmt: skip
        cv = math.sqrt(squares.mean())
        error = squares.std(ddof=1) / math.sqrt(n_webs)
        found.append((cv, error / (2 * cv) if cv else math.inf))
    cv, errors = np.array(found).T
    return cv, errors


def web_square(
    settings: Settings, zone: float, positions: str, seed: np.random.SeedSequence
) -> float:
    """⟨(v d m − 1)²⟩ over the zones of one web."""
    process = settings.process
    widest = max(process.sigma1, process.sigma2)
    side = max(N_ZONES, math.ceil(LONG * widest / zone)) * zone
    places, own = seed.spawn(2)
    where: Any = positions
    if positions == "regular":
        shift = float(np.random.default_rng(places).random())
        where = positions_within(settings, side, shift)
    web = lay_web(
        process, width=side, length=side, pixel=zone, spacing=settings.spacing,
        positions=where, seed=own,
    )  # fmt: skip
    return float(np.mean((web.length_density / web.expected_density - 1.0) ** 2))


def positions_within(settings: Settings, width: float, shift: float) -> Array:
    """Regular positions that can reach a window, shifted by a part of their distance.

    The prediction is the mean over all shifts.
    """
    d, beside = settings.spacing, BESIDE * settings.process.sigma2
    first, last = math.floor(-beside / d), math.ceil((width + beside) / d)
    return np.asarray(d * (np.arange(first, last + 1.0) + shift))
