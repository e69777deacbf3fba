"""L1 distances of densities at common arclengths, on other grids too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.results.compare.differences import distance

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["density_distance", "on_common_grid", "to_angles"]


PLANE = ("xi1", "xi2")
_ANGLE = "alpha"
_SAME_BOX = 1e-9


def density_distance(a: xr.Dataset, b: xr.Dataset) -> xr.DataArray | None:
    """∫ |p_b − p_a| at every s, if any, of densities on the same cells, or None."""
    for name, volume in (("cell_mass", 1.0), ("density", _volume(a))):
        if name in a and name in b:
            apart = distance(a[name].to_numpy(), b[name].to_numpy())
            cells = [one for one in a[name].dims if one != "s"]
            places = tuple(map(a[name].dims.index, cells))
            total = apart.sum(axis=places) * volume
            first = dict.fromkeys(cells, 0)
            return a[name].isel(first, drop=True).copy(data=total)
    return None


def on_common_grid(
    a: xr.Dataset, b: xr.Dataset
) -> tuple[xr.DataArray, xr.DataArray] | None:
    """Densities of both on the coarser of their grids, or None if there is none.

    Along ξ1 and ξ2 the cells of the finer grid are averaged, which keeps the mass and
    differs from the value at the centre by O(h²); their boxes must be the same and the
    numbers of cells multiples. Along α the finer one is interpolated by its
    trigonometric polynomial.
    """
    p, q = a["density"], b["density"]
    for axis in PLANE:
        n = min(p.sizes[axis], q.sizes[axis])
        rest = p.sizes[axis] % n + q.sizes[axis] % n
        if rest or not _same_box(p[axis].to_numpy(), q[axis].to_numpy()):
            return None
        p, q = (_averaged(one, axis, one.sizes[axis] // n) for one in (p, q))
    if _ANGLE in p.dims:
        n = min(p.sizes[_ANGLE], q.sizes[_ANGLE])
        p, q = to_angles(p, n), to_angles(q, n)
    return p, q.assign_coords({axis: p[axis] for axis in p.dims if axis != "s"})


def to_angles(p: xr.DataArray, n: int) -> xr.DataArray:
    """p(α) by its trigonometric polynomial at the centres of n cells."""
    size = p.sizes[_ANGLE]
    if size == n:
        return p
    old = (np.arange(size) + 0.5) * (2 * math.pi / size)
    new = (np.arange(n) + 0.5) * (2 * math.pi / n)
    values = p.to_numpy() @ _kernel(new[None, :] - old[:, None], size)
    moved = p.isel({_ANGLE: slice(n)}).copy(data=values)
    return moved.assign_coords({_ANGLE: new})


def _kernel(angle: Array, n: int) -> Array:
    """Weights of n equidistant values at a distance: 1 at 0, 0 at the others."""
    harmonics = np.arange(1, (n - 1) // 2 + 1)
    total = 1.0 + 2.0 * np.cos(angle[..., None] * harmonics).sum(axis=-1)
    if n % 2 == 0:
        total = total + np.cos(angle * (n // 2))
    return np.asarray(total / n)


def _averaged(p: xr.DataArray, axis: str, ratio: int) -> xr.DataArray:
    if ratio == 1:
        return p
    windows: Any = p.coarsen({axis: ratio})
    averaged: xr.DataArray = windows.mean()
    return averaged


def _same_box(first: Array, second: Array) -> bool:
    """Whether the cells with these centres fill the same interval."""
    one, two = (
        np.array([x[0] - (x[1] - x[0]) / 2, x[-1] + (x[1] - x[0]) / 2])
        for x in (first, second)
    )
    return bool(np.allclose(one, two, rtol=0.0, atol=_SAME_BOX * np.abs(one).max()))


def _volume(dataset: xr.Dataset) -> float:
    """Volume of a cell of the grid of `density`."""
    axes = [axis for axis in (*PLANE, _ANGLE) if axis in dataset.coords]
    return math.prod(float(np.diff(dataset[axis].to_numpy()[:2])[0]) for axis in axes)
