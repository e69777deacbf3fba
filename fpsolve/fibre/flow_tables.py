"""Flows of air from the tables that CFD codes write."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.interpolate import LinearNDInterpolator, RegularGridInterpolator
from scipy.spatial import Delaunay, QhullError

from fpsolve._kernels.flow import between_planes
from fpsolve._support.arrays import Array
from fpsolve.errors import FlowRangeError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["TableField", "fields_of_dataset", "fields_of_file"]

AXES, VELOCITIES = ("x", "y", "z"), ("velocity_x", "velocity_y", "velocity_z")
QUANTITIES = {"velocity": VELOCITIES, "k": ("k",), "dissipation": ("dissipation",)}
# Ways of writing the units of every name; none means SI.
METRES = ("", "m")
UNITS = {
    **dict.fromkeys(AXES, METRES),
    **dict.fromkeys(VELOCITIES, ("", "m/s", "m s-1", "m s^-1", "m.s-1")),
    "k": ("", "m2/s2", "m^2/s^2", "m²/s²", "m2 s-2", "m^2 s^-2", "J/kg", "J kg-1"),
    "dissipation": (
        "", "m2/s3", "m^2/s^3", "m²/s³", "m2 s-3", "m^2 s^-3", "W/kg", "W kg-1",
    ),
}  # fmt: skip
# What the columns of a CSV file may be called besides.
SHORT = {
    "u": "velocity_x", "v": "velocity_y", "w": "velocity_z",
    "epsilon": "dissipation", "eps": "dissipation",
}  # fmt: skip
HEADING = re.compile(r"^\s*(?P<name>[^\s\[(]+)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?\s*$")
# Points that are left out to see what they change are drawn by this.
SEED = 0


class Points(NamedTuple):
    """Where a table has values: planes of a grid, or scattered places.

    Attributes
    ----------
    names : tuple of str
        Of the coordinates on which the flow depends.
    axes : tuple of ndarray, or None
        Of a rectilinear grid.
    places : ndarray, shape (n, len(names)), or None
        Of scattered points.
    """

    names: tuple[str, ...]
    axes: tuple[Array, ...] | None
    places: Array | None


@dataclass(frozen=True, eq=False)
class TableField:
    """A quantity of the air between the points of a table, by linear interpolation.

    On a rectilinear grid in every coordinate, between scattered points on the simplices
    of their Delaunay triangulation: exact for linear fields, of order 2 in the distance
    of the points otherwise.

    Attributes
    ----------
    points : Points
    values : ndarray
        Of the shape of the grid or (n,), and (3,) behind for the velocity.
    """

    points: Points
    values: Array

    def __call__(self, r: Array, t: float) -> Array:
        """Values at positions r of shape (n, 3); NaN nowhere, or a FlowRangeError."""
        if self.points.axes is None:
            wanted = [AXES.index(name) for name in self.points.names]
            found = np.asarray(self._scattered(r[:, wanted]))
            finite = np.isfinite(found.reshape(len(r), -1)).all(axis=1)
            outside = -1 if finite.all() else int(finite.argmin())
        else:
            axes, values = self._planes
            out = np.empty((len(r), values.shape[3]))
            outside = between_planes(axes, values, np.ascontiguousarray(r), out)
            found = out if self.values.ndim > len(self.points.names) else out[:, 0]
        if outside >= 0:
            raise FlowRangeError(t, tuple(r[outside].tolist()))
        return found

    @cached_property
    def error(self) -> float:
        """Largest change where half of the points are left out.

        Every second plane of every coordinate, or half of the scattered points inside
        of the hull, drawn once. Infinite with too few to leave any out.
        """
        axes, places = self.points.axes, self.points.places
        if axes is not None:
            if min(one.size for one in axes) < 3:
                return np.inf
            kept = [_every_second(one.size) for one in axes]
            fewer = tuple(one[which] for one, which in zip(axes, kept, strict=True))
            coarse = RegularGridInterpolator(fewer, self.values[np.ix_(*kept)])
            nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
            away = coarse(nodes) - self.values
            return _largest(away, self.values.ndim - len(axes))
        assert places is not None
        chosen = np.random.default_rng(SEED).random(len(places)) < 0.5
        chosen[np.unique(self._triangles.convex_hull)] = True
        if chosen.all():
            return np.inf
        coarse = LinearNDInterpolator(places[chosen], self.values[chosen])
        away = coarse(places[~chosen]) - self.values[~chosen]
        # Rounding may put a place on the hull out of it.
        away = away[np.isfinite(away.reshape(len(away), -1)).all(axis=1)]
        return _largest(away, self.values.ndim - 1)

    @cached_property
    def _triangles(self) -> Delaunay:
        return triangles_of(self.points)

    @cached_property
    def _scattered(self) -> LinearNDInterpolator:
        return LinearNDInterpolator(self._triangles, self.values)

    @cached_property
    def _planes(self) -> tuple[tuple[Array, ...], Array]:
        """Axes and values over x, y and z, with one plane of what is left out."""
        axes = self.points.axes
        assert axes is not None
        given = dict(zip(self.points.names, axes, strict=True))
        every = tuple(np.array(given.get(name, [0.0])) for name in AXES)
        shape = (*(one.size for one in every), -1)
        return every, np.ascontiguousarray(self.values).reshape(shape)


def fields_of_dataset(table: xr.Dataset) -> dict[str, TableField]:
    """The velocity, and k and ε where the table has them, by `AirFlow`'s names."""
    units = {name: str(table[name].attrs.get("units", "")) for name in table.variables}
    _check_units(units)
    columns = {str(name): table[name] for name in table.variables}
    names = _coordinates(columns)
    if all(columns[name].dims == (name,) for name in names):
        axes = tuple(np.asarray(columns[name], dtype=np.float64) for name in names)
        if not all(one.size > 1 and (np.diff(one) > 0).all() for one in axes):
            raise ValueError(
                "`table` must have rising coordinates, two at least of each."
            )
        ordered = {
            name: one.transpose(*names).to_numpy()
            for name, one in columns.items()
            if name in UNITS and name not in AXES
        }
        return _fields(Points(names, axes, None), ordered)
    if len({columns[name].dims for name in names}) > 1:
        raise ValueError(
            f"`table` must have {', '.join(names)} as the coordinates of a grid, or "
            "all of them on one dimension of points."
        )
    return fields_of_points({
        name: one.to_numpy() for name, one in columns.items() if name in UNITS
    })  # fmt: skip


def fields_of_points(columns: Mapping[str, Array]) -> dict[str, TableField]:
    """Of columns of scattered points, in SI units."""
    names = _coordinates(columns)
    places = np.stack([columns[name] for name in names], axis=-1).astype(np.float64)
    if places.ndim != 2 or not np.isfinite(places).all():
        raise ValueError("`table` must have finite numbers as coordinates of points.")
    points = Points(names, None, places)
    triangles_of(points)
    return _fields(points, columns)


def fields_of_file(path: Path) -> dict[str, TableField]:
    """Of a CSV file with a heading, or a netCDF file."""
    if path.suffix.lower() != ".csv":
        import xarray as xr

        with xr.open_dataset(path) as table:
            return fields_of_dataset(table.load())
    with path.open(encoding="utf-8-sig", newline="") as file:
        headings = next(csv.reader(file), [])
        found = [HEADING.match(one) for one in headings]
        if not headings or None in found:
            raise ValueError(
                f"`path` must begin with a heading such as `x [m],y [m],u [m/s]`, got "
                f"{','.join(headings)!r} in {path.name}."
            )
        parts = [one.group("name", "unit") for one in found if one is not None]
        names = [SHORT.get(name.lower(), name.lower()) for name, _ in parts]
        if len(set(names)) < len(names):
            raise ValueError(
                f"`path` must have every column once, got {', '.join(names)}."
            )
        _check_units({
            name: (unit or "").strip()
            for name, (_, unit) in zip(names, parts, strict=True)
        })  # fmt: skip
        rows = np.loadtxt(file, delimiter=",", ndmin=2)
    if rows.shape[1] != len(names):
        raise ValueError(
            f"`path` must have {len(names)} numbers a line, got {rows.shape[1]}."
        )
    return fields_of_points({
        name: rows[:, i] for i, name in enumerate(names) if name in UNITS
    })  # fmt: skip


def triangles_of(points: Points) -> Delaunay:
    """The triangulation of scattered points; ValueError if they have none."""
    try:
        found = Delaunay(points.places)
    except (QhullError, ValueError) as failed:
        raise ValueError(
            f"`table` must have points that span {', '.join(points.names)}; where the "
            "flow does not depend on a coordinate, leave it out."
        ) from failed
    if found.coplanar.size:
        raise ValueError(
            f"`table` must have every point once, got {len(found.coplanar)} that "
            "others stand for."
        )
    return found


def _fields(points: Points, columns: Mapping[str, Array]) -> dict[str, TableField]:
    """Checked; what a flow lacks along a coordinate that is left out is 0."""
    left_out = {
        velocity
        for axis, velocity in zip(AXES, VELOCITIES, strict=True)
        if axis not in points.names
    }
    missing = [one for one in VELOCITIES if one not in columns and one not in left_out]
    if missing:
        raise ValueError(
            f"`table` must have {', '.join((*AXES, *VELOCITIES))}, without "
            f"{', '.join(missing)}."
        )
    if ("k" in columns) != ("dissipation" in columns):
        raise ValueError("`table` must have both of k and dissipation, or neither.")
    nothing = np.zeros_like(next(columns[one] for one in VELOCITIES if one in columns))
    columns = dict.fromkeys(left_out, nothing) | dict(columns)
    found = {}
    for quantity, names in QUANTITIES.items():
        if names[0] not in columns:
            continue
        parts = [np.asarray(columns[name], dtype=np.float64) for name in names]
        values = np.stack(parts, axis=-1) if len(names) > 1 else parts[0]
        if not np.isfinite(values).all():
            raise ValueError(f"`table` must have finite numbers as {quantity}.")
        if quantity != "velocity" and not (values >= 0).all():
            raise ValueError(
                f"`table` must have a non-negative {quantity}, got {values.min():g}."
            )
        found[quantity] = TableField(points, values)
    return found


def _coordinates(columns: Mapping[str, Any]) -> tuple[str, ...]:
    """Those of the table; one may be left out, of a flow that does not depend on it."""
    names = tuple(name for name in AXES if name in columns)
    if len(names) < 2:
        raise ValueError(
            f"`table` must have {', '.join((*AXES, *VELOCITIES))}, without "
            f"{', '.join(name for name in AXES if name not in names)}; one coordinate "
            "may be left out."
        )
    return names


def _check_units(units: Mapping[Any, str]) -> None:
    for name, unit in units.items():
        if name in UNITS and unit not in UNITS[name]:
            raise ValueError(
                f"`{name}` of the table must be in {UNITS[name][1]}, got {unit}; "
                "convert it first."
            )


def _every_second(n: int) -> Array:
    """Places of every second of n planes, and of the last."""
    return np.unique(np.append(np.arange(0, n, 2), n - 1))


def _largest(away: Array, behind: int) -> float:
    """Of numbers, or of vectors in the last place."""
    sizes = np.linalg.norm(away, axis=-1) if behind else np.abs(away)
    return float(sizes.max())
