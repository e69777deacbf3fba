"""Compare two results of the same kind."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.series import is_extrapolated
from fpsolve.results.compare.alignment import aligned, on_arclength
from fpsolve.results.compare.comparison import Comparison
from fpsolve.results.compare.densities import density_distance, on_common_grid
from fpsolve.results.compare.differences import Difference, difference_of
from fpsolve.results.compare.parameters import (
    differing_environment,
    differing_parameters,
)
from fpsolve.results.compare.reading import dataset_of, kind_of_dataset, name_of
from fpsolve.results.kinds import KINDS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["compare"]


ESTIMATED, STANDARD = "_error", "_standard_error"
# The L1 distance of densities and the estimate of its error, by the name in a file.
_L1 = "density_l1"
_L1_ERRORS = ("density_l1_error", "saved_l1_error")


def compare(a: Any, b: Any) -> Comparison:
    """b − a of two results of the same kind, number by number.

    Numbers are compared at the arclengths, noises and paths that both have. Densities
    on other cells are compared on the coarser grid, if the box is the same and the
    numbers of cells are multiples: cells of the finer one are averaged in ξ, which
    moves values by O(h²), and α is interpolated trigonometrically. What cannot be
    compared is named in `left_out`. Dates and run times are no results.

    Parameters
    ----------
    a, b : path or result
        Files, results of any kind, or their datasets; a study is one.

    Returns
    -------
    Comparison

    Raises
    ------
    FileNotFoundError, FileFormatError
        If a file does not exist or is damaged.
    ValueError, TypeError
        If one of them is no result, or they are of different kinds.
    """
    first, second = dataset_of(a, "a"), dataset_of(b, "b")
    kind = kind_of_dataset(first, "a")
    other = kind_of_dataset(second, "b")
    if kind != other:
        raise ValueError(
            f"`a` and `b` must be of the same kind, got {KINDS[kind].words} "
            f"and {KINDS[other].words}; `studies.compare` puts a density beside paths."
        )
    one, two, left_out = aligned(
        on_arclength(with_start(first)), on_arclength(with_start(second))
    )
    found = list(_all_differences(one, two))
    distances = _distances(first, second, one, two)
    dataset = _subtracted(one, two)
    if distances is not None:
        found.insert(0, _l1_difference(distances, one, two))
        dataset[_L1] = distances
        if "density" not in one and "cell_mass" not in one:
            left_out += ("density_l1 is that on the coarser grid",)
    return Comparison(
        kind=KINDS[kind].words,
        names=(name_of(a, "A"), name_of(b, "B")),
        differences=tuple(found),
        left_out=left_out,
        parameters=differing_parameters(first.attrs, second.attrs),
        environment=differing_environment(first.attrs, second.attrs),
        dataset=dataset,
    )


def with_start(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the start of a run, which may be a saved density."""
    if dataset.attrs.get("fpsolve_kind") != "solution" or "initial_density" in dataset:
        return dataset
    s, start = dataset["s"].to_numpy(), dataset["s_step"].to_numpy()
    if not (s.size and start.size and s[0] == start[0]):
        return dataset
    return dataset.assign(initial_density=dataset["density"].isel(s=0, drop=True))


def _all_differences(a: xr.Dataset, b: xr.Dataset) -> Iterator[Difference]:
    for name in map(str, a.data_vars):
        error, statistical = error_of(name, a, b)
        yield difference_of(name, a[name], b[name], error, statistical)
    for name in map(str, a.coords):
        if name in b.coords and a[name].sizes == b[name].sizes:
            yield difference_of(name, a[name], b[name], None, False)


def error_of(name: str, a: xr.Dataset, b: xr.Dataset) -> tuple[Array | None, bool]:
    """Error of b − a at every place, and whether it is a standard error.

    What describes the finer of two runs, and is no approximation, has none.
    """
    if not is_extrapolated(name):
        return None, False
    for ending, statistical in ((STANDARD, True), (ESTIMATED, False)):
        key = f"{name}{ending}"
        if key in a and key in b and a[key].dims == a[name].dims:
            first, second = a[key].to_numpy(), b[key].to_numpy()
            together = np.hypot(first, second) if statistical else first + second
            return np.asarray(together), statistical
    return None, False


def _subtracted(a: xr.Dataset, b: xr.Dataset) -> xr.Dataset:
    """b − a of what are numbers; of errors what they add up to."""
    values: dict[str, Any] = {}
    for name in map(str, a.data_vars):
        if a[name].dtype.kind in "iuf" and not name.endswith((ESTIMATED, STANDARD)):
            with np.errstate(all="ignore"):
                values[name] = (a[name].dims, b[name].to_numpy() - a[name].to_numpy(),
                                a[name].attrs)  # fmt: skip
            error, _ = error_of(name, a, b)
            if error is not None:
                values[f"{name}{ESTIMATED}"] = a[name].dims, error
    dataset = a.drop_vars(list(a.data_vars)).assign(values)
    dataset.attrs = {}
    return dataset


def _distances(
    first: xr.Dataset, second: xr.Dataset, a: xr.Dataset, b: xr.Dataset
) -> xr.DataArray | None:
    """L1 distances at common s, on the coarser grid if there are two."""
    if "density" in a or "cell_mass" in a:
        return density_distance(a, b)
    if not ("density" in first and "density" in second and "s" in a.coords):
        return None
    if "xi1" not in first["density"].dims or not a.sizes.get("s"):
        return None
    p, q = (one[["density"]].sel(s=a["s"], method="nearest") for one in (first, second))
    common = on_common_grid(p, q)
    if common is None:
        return None
    on_a, on_b = (one.to_dataset(name="density") for one in common)
    return density_distance(on_a, on_b)


def _l1_difference(distances: xr.DataArray, a: xr.Dataset, b: xr.Dataset) -> Difference:
    """Their largest; the mass is one."""
    apart = distances.to_numpy()
    error = next((a[key].to_numpy() + b[key].to_numpy() for key in _L1_ERRORS
                  if key in a and key in b), None)  # fmt: skip
    found = difference_of(_L1, 0.0 * distances, distances, error, False)
    return Difference(
        _L1, bool((apart == 0).all()), found.largest, 1.0, found.place, found.in_errors
    )
