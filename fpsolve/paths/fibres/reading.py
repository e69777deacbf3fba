"""Points of fibres from tables of text and from datasets."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_path, shown
from fpsolve.errors import FileFormatError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Table", "equal_step", "is_equal", "read_csv", "read_dataset"]

# Names of the two coordinates, along and across the belt.
PAIRS = (("eta1", "eta2"), ("x", "y"))
# Relative difference of steps that are meant to be the same, as text of six digits.
SAME_STEP = 1e-4


class Table(NamedTuple):
    """Points of fibres, their arclengths where they are known, and their rounding."""

    pieces: list[Array]
    s: list[Array] | None
    rounding: float = 0.0

    def scaled(self, unit: float) -> Table:
        """The same in another unit of length."""
        s = None if self.s is None else [one / unit for one in self.s]
        pieces = [piece / unit for piece in self.pieces]
        return Table(pieces, s, self.rounding / unit)

    def step(self, ds: float | None) -> float | None:
        """The distance of points that are equally far apart; None if they are not.

        Raises
        ------
        ValueError
            If ds must be given.
        """
        if self.s is None:
            if ds is None:
                raise ValueError(
                    "`ds` must be given where there is no column `s`, got None."
                )
            return ds
        steps = [np.diff(s) for s in self.s]
        step = float(steps[0].mean())
        even = all(is_equal(one, step) for one in steps)
        if even and (ds is None or abs(ds - step) <= SAME_STEP * step):
            return step
        if ds is None:
            raise ValueError(
                "`ds` must be given where the steps of `s` differ, got None; points "
                "are resampled to it."
            )
        return None


def is_equal(steps: Array, step: float) -> bool:
    """Whether all steps are that one, up to the rounding of a table."""
    return bool(np.all(np.abs(steps - step) <= SAME_STEP * step))


def equal_step(s: Array, name: str) -> float:
    """The step of equal arclengths; ValueError if they are not equal."""
    steps = np.diff(s)
    if len(steps) and is_equal(steps, float(steps.mean())):
        return float(steps.mean())
    raise ValueError(
        f"`{name}` must be at equal distances for a fibre curve, got {shown(s)}; "
        "save the paths at np.arange(n) * ds."
    )


def read_csv(path: str | Path) -> Table:
    """Columns of a file, comma, semicolon, tab or space between them.

    Between semicolons or tabs a comma is a decimal one.
    """
    place = check_path("path", path)
    try:
        text = place.read_text("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(place, "it is not text in UTF-8") from None
    lines = [
        _with_commas(line)
        for line in text.splitlines()
        if line.strip() and not line.lstrip().startswith("#")
    ]
    rows = [[word.strip() for word in row] for row in csv.reader(lines)]
    if not rows:
        raise FileFormatError(place, "it holds no row of numbers")
    header = ["x", "y"] if _is_numbers(rows[0]) else rows.pop(0)
    columns = _columns(rows, header, place)
    table = _table(columns, place)
    named = [name.lower() in PAIRS[0] + PAIRS[1] for name in header]
    words = [word for row in rows for word, own in zip(row, named, strict=True) if own]
    return table._replace(rounding=rounding_of(words))


def rounding_of(words: list[str]) -> float:
    """q/√12, the standard deviation of what rounding to the digits q takes away."""
    digits = [Decimal(word).as_tuple().exponent for word in words]
    # Not the least: trailing zeros may be left out, and small numbers have more.
    usual = float(np.median(np.array(digits, dtype=np.float64)))
    return math.pow(10.0, min(usual, 0.0)) / math.sqrt(12)


def _with_commas(line: str) -> str:
    for separator in (";", "\t"):
        if separator in line:
            return line.replace(",", ".").replace(separator, ",")
    return line if "," in line else ",".join(line.split())


def read_dataset(dataset: xr.Dataset | str | Path) -> Table:
    """Variables of a dataset or of a netCDF file."""
    import xarray as xr

    place: str | Path = "dataset"
    if not isinstance(dataset, xr.Dataset):
        place = check_path("dataset", dataset)
        with xr.open_dataset(place, engine="h5netcdf") as opened:
            dataset = opened.load()
    columns: dict[str, Array] = {}
    for name in ("s", "fibre", *(one for pair in PAIRS for one in pair)):
        if name in dataset:
            columns[name] = np.asarray(dataset[name].values, dtype=np.float64)
    if "eta" in dataset:
        eta = np.asarray(dataset["eta"].values, dtype=np.float64)
        columns |= {"eta1": eta[:, 0], "eta2": eta[:, 1]}
    return _table(columns, place)


def _is_numbers(row: list[str]) -> bool:
    try:
        return bool([float(word) for word in row])
    except ValueError:
        return False


def _columns(rows: list[list[str]], header: list[str], place: Path) -> dict[str, Array]:
    for number, row in enumerate(rows, start=1):
        if len(row) != len(header) or not _is_numbers(row):
            raise FileFormatError(
                place, f"row {number} is no {len(header)} numbers: {shown(row)}"
            )
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(header))
    gaps = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(gaps):
        raise FileFormatError(
            place,
            f"row {gaps[0] + 1} must be finite, and is {shown(rows[gaps[0]])}; leave "
            "out points that are not known, and number the fibre on either side of a "
            "gap in a column `fibre`",
        )
    return dict(zip((name.lower() for name in header), values.T, strict=True))


def _table(columns: Mapping[str, Array], place: Any) -> Table:
    pair = next((pair for pair in PAIRS if set(pair) <= columns.keys()), None)
    if pair is None:
        named = ", ".join(columns) or "none"
        raise FileFormatError(
            place, f"its columns must be eta1, eta2 or x, y, and are {named}"
        )
    points = np.stack([columns[name] for name in pair], axis=-1)
    numbers = columns.get("fibre", np.zeros(len(points)))
    # Where the number changes, and not by sorting: rows are in the order of a fibre.
    ends = np.flatnonzero(np.diff(numbers)) + 1
    s = np.split(columns["s"], ends) if "s" in columns else None
    return Table(np.split(points, ends), s)
