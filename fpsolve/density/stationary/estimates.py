"""Errors of a stationary density and of its moments, part by part."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids import diagnostics
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid

__all__ = ["DENSITY", "box_error", "field_error", "scaled", "signed_error", "total"]

Errors = Mapping[str, float]

DENSITY = "density"
# What the periodic box does, measured by validation/stationary_boxes.py: the mass
# that meets its edge comes back on the other side, and spreads from there over the
# whole density. ∫ |p − p_exact| is at most this times the half width times the density
# per length along the edge.
EDGE = 4.0


def field_error(difference: Array, p: Array, grid: AnyGrid) -> dict[str, float]:
    """∫ |d| w dξ dα: of the density, w = 1, and with the weight of every moment.

    No part of the field makes up for another, so that an error of the same size, but
    of other signs, is covered.
    """
    size = np.abs(difference) * grid.cell_volume
    moments = diagnostics.moments(p, grid)
    curved = {}
    if isinstance(grid, SmoothPhaseSpaceGrid):
        curvatures = size.sum(axis=(0, 1, 2))
        for power, name in enumerate(("mean_kappa", "mean_kappa2"), start=1):
            away = np.abs(grid.kappa**power - moments[name])
            curved[name] = float(curvatures @ away)
        size = size.sum(axis=3)
    plane, angles = size.sum(axis=2), size.sum(axis=(0, 1))
    line1, line2 = plane.sum(axis=1), plane.sum(axis=0)
    away1 = np.abs(grid.xi1 - moments["mean_xi1"])
    away2 = np.abs(grid.xi2 - moments["mean_xi2"])
    mean1, mean2 = float(line1 @ away1), float(line2 @ away2)
    values = (
        mean1,
        mean2,
        float(line1 @ np.abs(away1**2 - moments["variance_xi1"])) + mean1**2,
        float(line2 @ np.abs(away2**2 - moments["variance_xi2"])) + mean2**2,
        float(away1 @ plane @ away2) + mean1 * mean2,
        float(angles @ np.abs(np.cos(grid.alpha) - moments["mean_cos_alpha"])),
        float(angles @ np.abs(np.sin(grid.alpha) - moments["mean_sin_alpha"])),
    )
    known = dict(zip(MOMENTS, values, strict=True))
    return {DENSITY: float(size.sum()), **known, **curved}


def signed_error(difference: Array, p: Array, grid: AnyGrid) -> dict[str, float]:
    """∫ |d| dξ dα, and by how much p + d differs from p in every moment."""
    size = float(np.abs(difference).sum()) * grid.cell_volume
    before = diagnostics.moments(p, grid)
    after = diagnostics.moments(p + difference, grid)
    changes = {name: abs(after[name] - before[name]) for name in before}
    return {DENSITY: size, **changes}


def box_error(p: Array, grid: AnyGrid) -> dict[str, float]:
    """What the box cuts off and lets in on the other side; see `EDGE`."""
    plane = np.abs(p).sum(axis=tuple(range(2, p.ndim))) * grid.cell_volume
    (half1, half2), (d1, d2, *_) = grid.half_widths, grid.spacing
    edge1 = float(plane[[0, -1]].sum()) / d1
    edge2 = float(plane[:, [0, -1]].sum()) / d2
    share = EDGE * (half1 * edge1 + half2 * edge2)
    curved = {}
    if isinstance(grid, SmoothPhaseSpaceGrid):
        ends = float(np.abs(p[..., [0, -1]]).sum()) * grid.cell_volume
        # What leaves at one end relaxes from the other within R.
        largest = grid.kappa_half_width
        share += EDGE * largest * ends / grid.spacing[3]
        curved = {"mean_kappa": share * largest, "mean_kappa2": share * largest**2}
    moments = diagnostics.moments(p, grid)
    reach1 = half1 + abs(moments["mean_xi1"])
    reach2 = half2 + abs(moments["mean_xi2"])
    reaches = (reach1, reach2, reach1**2, reach2**2, reach1 * reach2, 1.0, 1.0)
    values = {name: share * w for name, w in zip(MOMENTS, reaches, strict=True)}
    return {DENSITY: share, **values, **curved}


def scaled(errors: Errors, factor: float) -> dict[str, float]:
    """Every error times a factor."""
    return {name: factor * value for name, value in errors.items()}


def total(parts: Mapping[str, Errors]) -> dict[str, float]:
    """Sum over the parts, of the density and of every moment."""
    names = dict.fromkeys(name for part in parts.values() for name in part)
    return {
        name: math.fsum(part.get(name, 0.0) for part in parts.values())
        for name in names
    }
