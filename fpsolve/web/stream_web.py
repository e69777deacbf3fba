"""A web that does not fit into memory, laid on a disk."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_path, check_positive
from fpsolve._support.files import check_room
from fpsolve._support.netcdf import check_engine, write_dataset
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve._support.provenance import Stopwatch
from fpsolve.evolution.call import Call
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.web.lay_web import Told, bytes_of, lay_web
from fpsolve.web.laying import Counts, image_shape, lay_on
from fpsolve.web.order import Order, order_of, pixels_of
from fpsolve.web.window import Window

__all__ = ["stream_web"]

_PIXELS = ("length_density", "orientation_11", "orientation_12")
# Pixels that are made of counts at once.
_AT_ONCE = 2**20


def stream_web(
    model: FibreModel | Process,
    path: str | os.PathLike[str],
    *,
    tile: float | None = None,
    progress: bool | ProgressCallback = False,
    **options: Any,
) -> Path:
    """Lay a web of any length on a disk: a zarr store of tiles along the machine.

    The store holds, bit for bit, what ``lay_web(model, **options).save(path)`` would
    write, in chunks of the whole width and a tile of the length. `fpsolve.load` reads
    it where it fits into memory, xarray.open_zarr tile by tile.

    While fibres are laid their counts lie in a file beside the store, 48 bytes for a
    pixel, of which the system keeps in memory what is being laid: the stretch of the
    belt below the nozzles. Where the titer is known, the mass per area takes eight
    bytes of memory for a pixel. One thread counts, the steps are taken by all.

    Parameters
    ----------
    model : LayDownModel, SmoothLayDownModel or Process
    path : str or os.PathLike
        Ends in ".zarr"; the store appears whole or not at all.
    tile : float, optional
        Length of a tile along the belt, a multiple of the pixel or rounded to one; by
        default the width.
    progress : bool or callable
        Show a bar, or call with (fibre-steps done, fibre-steps in all, s).
    **options
        As for `lay_web`, but for `client` and `memory_limit`.

    Returns
    -------
    Path
        The store.

    Raises
    ------
    ValueError, TypeError, NonFinitePathError
        As `lay_web`; or if the path does not end in ".zarr", the tile is not positive.
    OSError
        If the disk has no room for the counts and for the store.
    ImportError
        If zarr is not installed.
    """
    path = check_path("path", path)
    if path.suffix != ".zarr":
        raise ValueError(f"`path` must end in .zarr, got `{path}`.")
    check_engine("zarr")
    watch = Stopwatch()
    order, call = order_of(model, **options), call_of(model, options)
    along = order.plan.window.width * order.unit if tile is None else tile
    columns = max(round(check_positive("tile", along) / order.unit
                        / order.plan.window.pixel), 1)  # fmt: skip
    with mapped(path, order.plan.window, image_shape(order.plan)) as (counts, pixels):
        with reporting(progress) as report:
            n_steps = order.plan.ensemble.schedule.n_steps
            told = Told(report, order.plan.n_fibres * n_steps)
            laid = lay_on(order.plan, counts[None], told)
        fill(pixels, laid.counts, order)
        length, first, mixed = pixels
        web = order.web(laid, (length, first, mixed))
        web = replace(web, call=call, provenance=watch.provenance())
        dataset = web.to_xarray()
        n_rows, n_columns = web.length_density.shape
        for name in _PIXELS:
            chunks = (n_rows, min(columns, n_columns))
            dataset[name].encoding["chunks"] = chunks
        return write_dataset(dataset, path, "zarr")


def call_of(model: Any, options: Any) -> Call:
    """The call of `lay_web` that gives the same web."""
    bound = inspect.signature(lay_web).bind(model, **options)
    bound.apply_defaults()
    return Call.of("lay_web", bound.arguments)


@contextmanager
def mapped(
    path: Path, window: Window, shape: tuple[int, ...]
) -> Iterator[tuple[Counts, list[Array]]]:
    """Counts and pixels in files that are there as long as they are needed."""
    with TemporaryDirectory(dir=path.parent, prefix=f".{path.name}-") as folder:
        place = Path(folder)
        check_room(path, 3 * bytes_of(window), place)
        counts: Any = np.memmap(place / "counts", np.int64, "w+", shape=shape)
        pixels = [
            np.memmap(place / name, np.float64, "w+", shape=shape[:2])
            for name in _PIXELS
        ]
        yield np.asarray(counts), [np.asarray(one) for one in pixels]


def fill(pixels: list[Array], counts: Counts, order: Order) -> None:
    """Make the pixels of the counts, some rows at a time."""
    n_rows, n_columns = counts.shape[:2]
    step = max(_AT_ONCE // n_columns, 1)
    for start in range(0, n_rows, step):
        rows = slice(start, start + step)
        for target, values in zip(pixels, pixels_of(counts[rows], order), strict=True):
            target[rows] = values
