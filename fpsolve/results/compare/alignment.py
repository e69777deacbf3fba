"""What two datasets have in common: the same variables at the same places."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["aligned", "on_arclength"]

# Coordinates of cells: where they differ there is nothing to pick out.
CELLS = {"xi1", "xi2", "alpha", "g", "face", "cell_xi1", "cell_xi2", "cell_alpha",
         "initial_xi1", "initial_xi2", "initial_alpha"}  # fmt: skip
# Places are the same up to rounding of s = start + k ds.
_SAME_PLACE = 1e-9
# Never equal, and no result.
_TIMES = ("seconds",)


def on_arclength(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with recorded steps told apart by their arclength."""
    dataset = dataset.drop_vars([name for name in _TIMES if name in dataset])
    if "step" in dataset.dims and "s_step" in dataset.coords:
        return dataset.swap_dims(step="s_step")
    return dataset


def aligned(
    a: xr.Dataset, b: xr.Dataset
) -> tuple[xr.Dataset, xr.Dataset, tuple[str, ...]]:
    """Return both where they can be compared, and what is left out and why."""
    left_out = [
        f"{name}: only in {side}"
        for side, own, other in (("A", a, b), ("B", b, a))
        for name in own.data_vars
        if name not in other
    ]
    common = [name for name in a.data_vars if name in b]
    a, b = a[common], b[common]
    for dimension in [str(name) for name in a.sizes if name in b.sizes]:
        if dimension not in a.dims or not _used(a, dimension):
            continue
        rows, columns, reason = _matched(a, b, dimension)
        if reason:
            left_out.append(reason)
        if not rows.size and (a.sizes[dimension] or b.sizes[dimension]):
            a, b = a.drop_dims(dimension), b.drop_dims(dimension)
            continue
        a, b = a.isel({dimension: rows}), b.isel({dimension: columns})
    shaped = [name for name in a.data_vars if a[name].dims == b[name].dims]
    left_out += [f"{name}: other dimensions" for name in a.data_vars
                 if name not in shaped]  # fmt: skip
    return a[shaped], b[shaped], tuple(left_out)


def _used(dataset: xr.Dataset, dimension: str) -> bool:
    return any(dimension in values.dims for values in dataset.data_vars.values())


def _matched(
    a: xr.Dataset, b: xr.Dataset, dimension: str
) -> tuple[NDArray[np.intp], NDArray[np.intp], str]:
    """Rows of A and B at the same places; what is left out, in words."""
    n_a, n_b = a.sizes[dimension], b.sizes[dimension]
    if dimension not in a.coords or dimension not in b.coords:
        places = np.arange(n_a)
        found = places if n_a == n_b else np.full(n_b, -1)
    else:
        found = _places(a.indexes[dimension], b.indexes[dimension])
    columns = np.flatnonzero(found >= 0)
    rows = found[columns]
    if len(rows) == n_a == n_b:
        return rows, columns, ""
    if dimension in CELLS or not len(rows):
        nothing = np.empty(0, np.intp)
        return nothing, nothing, _without(a, dimension, n_a, n_b)
    share = f"{len(rows)} of {n_a} places of A and of {n_b} of B are in common"
    return rows, columns, f"{dimension}: {share}"


def _places(first: Any, second: Any) -> NDArray[np.intp]:
    """For every place of the second the same one of the first, or -1."""
    if not len(first) or not len(second):
        return np.full(len(second), -1)
    if first.dtype.kind not in "iuf" or second.dtype.kind not in "iuf":
        return np.asarray(first.astype(str).get_indexer(second.astype(str)))
    largest = float(np.max(np.abs(first.to_numpy())))
    tolerance = _SAME_PLACE * max(1.0, largest)
    found = first.get_indexer(second, method="nearest", tolerance=tolerance)
    return np.asarray(found)


def _without(a: xr.Dataset, dimension: str, n_a: int, n_b: int) -> str:
    names = ", ".join(str(n) for n, v in a.data_vars.items() if dimension in v.dims)
    many = f" ({n_a} and {n_b})" if n_a != n_b else ""
    return f"{names}: other places along {dimension}{many}"
