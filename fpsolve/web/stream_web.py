"""A web that does not fit into memory, laid on a disk."""

from __future__ import annotations

import inspect
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_path, check_positive
from fpsolve._support.files import check_room
from fpsolve._support.netcdf import check_engine, write_dataset
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve._support.provenance import Stopwatch
from fpsolve._support.streaming import Streamed
from fpsolve.evolution.call import Call
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.web.counted import CountedFile, PixelBlocks
from fpsolve.web.lay_web import Told, bytes_of, lay_web
from fpsolve.web.laying import Laid, check_client
from fpsolve.web.layout import pixel_labels
from fpsolve.web.order import Order, order_of
from fpsolve.web.stretches import lay_in_stretches
from fpsolve.web.web import Web

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["stream_web"]

_DIMENSIONS = ("cross", "machine")


def stream_web(
    model: FibreModel | Process,
    path: str | os.PathLike[str],
    *,
    tile: float | None = None,
    client: Any = None,
    progress: bool | ProgressCallback = False,
    **options: Any,
) -> Path:
    """Lay a web of any length on a disk: a zarr store of tiles along the machine.

    The store holds, bit for bit, what ``lay_web(model, **options).save(path)`` would
    write, in chunks of the whole width and a tile of the length. `fpsolve.load` reads
    it where it fits into memory, xarray.open_zarr tile by tile.

    Fibres are laid over one tile after the other. In memory are a tile and the stretch
    of the belt that they reach, the places of the fibres, and with a client what its
    workers give back of a tile. Counts lie in a file beside the store, 24 bytes for a
    pixel, as long as they are needed. Here one thread counts, and the steps are taken
    by all; elsewhere every worker lays some of the fibres over a tile, and hands on
    where they end.

    Parameters
    ----------
    model : LayDownModel, SmoothLayDownModel or Process
    path : str or os.PathLike
        Ends in ".zarr"; the store appears whole or not at all.
    tile : float, optional
        Length of a tile along the belt, a multiple of the pixel or rounded to one; by
        default the width.
    client : optional
        Where to lay, as for `lay_web`.
    progress : bool or callable
        Show a bar, or call with (fibre-steps done, fibre-steps in all, s).
    **options
        As for `lay_web`, but for `memory_limit`.

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
    plan = order.plan
    tile = plan.window.width if tile is None else check_tile(tile, order)
    if client is not None:
        check_client(client)
    with counting(path, order) as counted:
        with reporting(progress) as report:
            told = Told(report, plan.n_fibres * plan.ensemble.schedule.n_steps)
            outside, beyond = 0, 0
            for laid in lay_in_stretches(plan, tile, client, told):
                counted.add(laid)
                outside, beyond = outside + laid.outside, beyond + laid.beyond
        # One number in the place of all, which takes no memory.
        nothing = np.broadcast_to(np.float64(0.0), plan.window.shape)
        laid = Laid(np.zeros((0, 0, 0), np.int64), 0, outside, beyond)
        web = order.web(counted.inside, laid, (nothing, nothing, nothing))
        web = replace(web, call=call, provenance=watch.provenance())
        columns = max(round(tile / plan.window.pixel), 1)
        streamed = list(variables(web, counted, columns))
        return write_dataset(without_pixels(web), path, "zarr", streamed)


def check_tile(tile: Any, order: Order) -> float:
    """The length of a tile in throwing ranges; ValueError unless it is positive."""
    return check_positive("tile", tile) / order.unit


def call_of(model: Any, options: Any) -> Call:
    """The call of `lay_web` that gives the same web."""
    bound = inspect.signature(lay_web).bind(model, **options)
    bound.apply_defaults()
    return Call.of("lay_web", bound.arguments)


@contextmanager
def counting(path: Path, order: Order) -> Iterator[CountedFile]:
    """A file of counts that is there as long as it is needed."""
    with TemporaryDirectory(dir=path.parent, prefix=f".{path.name}-") as folder:
        place = Path(folder)
        # The counts, and as much or a third more for the store.
        check_room(path, 3 * bytes_of(order.plan.window), place)
        yield CountedFile(place / "counts", order)


def variables(web: Web, counted: CountedFile, columns: int) -> Iterable[Streamed]:
    """What is known of every pixel, in tiles of so many columns."""
    n_rows, n_columns = web.length_density.shape
    chunks = (n_rows, min(columns, n_columns))
    for name, about in pixel_labels(web).items():
        blocks = PixelBlocks(counted, name, chunks[1])
        yield Streamed(name, _DIMENSIONS, (n_rows, n_columns), np.dtype(np.float64),
                       blocks, about, chunks, blocks.tiles())  # fmt: skip


def without_pixels(web: Web) -> xr.Dataset:
    """The dataset of a web but for its pixels."""
    # Without the titer there is no mass, which would be an array of its own.
    dataset = replace(web, titer=None).to_xarray()
    dataset = dataset.drop_vars([*pixel_labels(replace(web, titer=None))])
    return dataset if web.titer is None else dataset.assign_attrs(titer=web.titer)
