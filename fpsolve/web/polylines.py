"""Fibres of a web as polylines in a file of VTK's XML format for PolyData."""

from __future__ import annotations

import base64
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive
from fpsolve._support.files import atomic_path

__all__ = ["parts_inside", "write_vtp"]

_TYPES = {"float64": "Float64", "int64": "Int64"}
_FRAME = """<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<PolyData>
<Piece NumberOfPoints="{n_points}" NumberOfLines="{n_lines}">
<Points>{points}</Points>
<Lines>{connectivity}{offsets}</Lines>
<CellData>{fibre}{diameter}</CellData>
</Piece>
</PolyData>
</VTKFile>
"""


def write_vtp(
    web: Any,
    path: str | os.PathLike[str],
    fibres: Iterable[int] | None,
    diameter: float | None,
) -> Path:
    """Write what some fibres have in the window, a polyline for each part."""
    numbers = range(web.positions.size) if fibres is None else fibres
    parts, owners = [np.empty((0, 2))], []
    for number in numbers:
        inside = parts_inside(web.curve(number), web.length, web.width)
        parts += inside
        owners += [number] * len(inside)
    flat = np.concatenate(parts)
    points = np.column_stack([flat, np.zeros(len(flat))])
    thickness = ""
    if diameter is not None:
        width = check_positive("diameter", diameter)
        thickness = _array("diameter", np.full(len(owners), width))
    ends = np.cumsum([len(part) for part in parts[1:]], dtype=np.int64)
    text = _FRAME.format(
        n_points=len(points),
        n_lines=len(owners),
        points=_array("Points", points, 3),
        connectivity=_array("connectivity", np.arange(len(points), dtype=np.int64)),
        offsets=_array("offsets", ends),
        fibre=_array("fibre", np.array(owners, dtype=np.int64)),
        diameter=thickness,
    )
    with atomic_path(path) as draft:
        draft.write_text(text, "utf-8")
    return Path(path)


def parts_inside(curve: Array, length: float, width: float) -> list[Array]:
    """The runs of corners of which pieces may meet the window, as arrays (n, 2)."""
    size = (length, width)
    inside = np.asarray(((curve >= 0) & (curve <= size)).all(axis=1))
    # A piece with one end inside belongs to the window.
    near = inside.copy()
    near[1:] |= inside[:-1]
    near[:-1] |= inside[1:]
    edges = np.flatnonzero(
        np.diff(np.concatenate([[False], near, [False]]).astype(int))
    )
    return [curve[start:end] for start, end in edges.reshape(-1, 2)]


def _array(name: str, values: NDArray[Any], components: int = 1) -> str:
    """A DataArray: the number of bytes and the bytes, each encoded in 64 letters."""
    kind = _TYPES[values.dtype.name]
    raw = np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes()
    coded = base64.b64encode(np.uint64(len(raw)).tobytes() + raw).decode("ascii")
    return (
        f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" '
        f'format="binary">{coded}</DataArray>'
    )
