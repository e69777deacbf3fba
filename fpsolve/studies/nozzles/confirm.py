"""Webs of moving nozzles, laid twice side by side: their pattern is what both share."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.web.lay_web import lay_web
from fpsolve.web.pattern_row import offsets_of

__all__ = ["laid_squares"]

# Zones along each side of a window, and cells of the pattern, at least.
N_ZONES, N_CELLS = 16, 6
# Of the largest number of zones along a side.
MOST_ZONES = 400
# Throwing ranges beside a window, beyond which a fibre is as good as never, and radii.
BESIDE = 6.0


def laid_squares(
    model: LayDownModel,
    zones: Array,
    spacing: float,
    phases: Any,
    n_webs: int,
    seed: int,
) -> tuple[Array, Array]:
    """CV² of the pattern and of the whole web by zone, and standard errors.

    Two rows of nozzles far from each other, with the same places and phases relative to
    their windows, lay independent fibres on the same pattern: the mean of the product
    of both deviations is its CV², without a bias, that of a square the CV² of webs.

    Returns
    -------
    values, errors : ndarray, shape (2, zone)
    """  # fmt: skip
    seeds = iter(np.random.SeedSequence(seed).spawn(zones.size * n_webs))
    found = np.array([
        [products(model, float(zone), spacing, phases, next(seeds))
         for _ in range(n_webs)]
        for zone in zones
    ])  # fmt: skip
    errors = found.std(axis=1, ddof=1) / math.sqrt(n_webs)
    return found.mean(axis=1).T, errors.T


def products(
    model: LayDownModel,
    zone: float,
    spacing: float,
    phases: Any,
    seed: np.random.SeedSequence,
) -> tuple[float, float]:
    """⟨a b⟩ and ⟨a² + b²⟩/2 of the deviations in two windows."""  # fmt: skip
    curve: Any = model.curve
    offsets = offsets_of(phases)
    width, length = (
        zone * min(max(N_ZONES, math.ceil(N_CELLS * period / zone)), MOST_ZONES)
        for period in (spacing * offsets.size, abs(curve.speed) * curve.period)
    )
    places, own = seed.spawn(2)
    shift, turn = np.random.default_rng(places).random(2)
    beside = BESIDE * quadratic(model).sigma2 + curve.radii[1]
    numbers = np.arange(
        math.floor(-beside / spacing), math.ceil((width + beside) / spacing) + 1
    )
    # All places of the window among the nozzles count alike, across and along.
    row = spacing * (numbers + offsets.size * shift)
    apart = zone * math.ceil((width + 2 * beside + 2 * offsets.size * spacing) / zone)
    turned = offsets[numbers % offsets.size] + 2 * math.pi * turn
    web = lay_web(
        model, width=apart + width, length=length, pixel=zone, spacing=spacing,
        positions=np.concatenate([row, row + apart]), phases=np.tile(turned, 2),
        seed=own,
    )  # fmt: skip
    relative = web.length_density * (abs(curve.speed) * spacing) - 1.0
    n = round(width / zone)
    one, other = relative[:n], relative[-n:]
    return float(np.mean(one * other)), float(np.mean(0.5 * (one**2 + other**2)))
