"""Pixels of a web for other programs: a table, and an image of 16 bits."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from fpsolve._support.files import atomic_path
from fpsolve._support.labels import to_json

__all__ = ["tifffile_module", "write_csv", "write_tiff"]

_WHITE = 2**16 - 1
_CENTIMETRES = 100.0


def write_csv(web: Any, path: str | os.PathLike[str]) -> Path:
    """Write a line for every pixel."""
    cross, machine = np.meshgrid(web.cross, web.machine, indexing="ij")
    columns = {"cross": cross, "machine": machine, "length_density": web.length_density}
    if web.mass_density is not None:
        columns["mass_density"] = web.mass_density
    columns |= {
        "orientation_11": web.orientation_11,
        "orientation_12": web.orientation_12,
    }
    table = np.stack([values.ravel() for values in columns.values()], axis=1)
    with atomic_path(path) as draft:
        np.savetxt(draft, table, "%.17g", ",", header=",".join(columns), comments="")
    return Path(path)


def tifffile_module() -> Any:
    """The library that writes TIFF; ImportError with what to install without it."""
    try:
        import tifffile
    except ImportError as error:
        raise ImportError(
            "tifffile must be installed to write a TIFF: pip install 'fpsolve[web]'."
        ) from error
    return tifffile


def write_tiff(web: Any, path: str | os.PathLike[str]) -> Path:
    """Write the mass per area, or the length, with the physical size of a pixel."""
    tifffile = tifffile_module()
    mass = web.mass_density
    shown = web.length_density if mass is None else mass
    one = float(shown.max()) / _WHITE or 1.0
    image = np.rint(shown / one).astype(np.uint16)
    about = {
        "quantity": "length per area" if mass is None else "mass per area in g/m2",
        "unit_of_one": one,
        "pixel": web.pixel,
        "unit_of_length": web.unit or "throwing range",
        "rows": "across the belt",
        "columns": "along the belt",
    }
    resolution = 1 / (web.pixel * (_CENTIMETRES if web.unit else 1.0))
    with atomic_path(path) as draft, draft.open("wb") as file:
        tifffile.imwrite(
            file, image, photometric="minisblack", description=to_json(about),
            resolution=(resolution, resolution),
            resolutionunit="CENTIMETER" if web.unit else "NONE", metadata=None,
        )  # fmt: skip
    return Path(path)
