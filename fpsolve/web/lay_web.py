"""Lay a web: many fibres on a moving belt, seen through a window of pixels."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.memory import OVERHEAD, allowed_memory, check_memory
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.evolution.call import recorded
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.web.laying import (
    PIXEL_BYTES,
    lay_elsewhere,
    lay_here,
    n_workers_for,
    total,
)
from fpsolve.web.order import order_of, pixels_of
from fpsolve.web.web import Web
from fpsolve.web.window import Window

__all__ = ["Told", "lay_web"]


@recorded()
def lay_web(
    model: FibreModel | Process,
    *,
    width: float,
    length: float,
    pixel: float,
    spacing: float | None = None,
    positions: Any = "regular",
    phases: Any = "independent",
    ds: float | None = None,
    seed: int | np.random.SeedSequence | None = None,
    periodic: bool = False,
    titer: float | None = None,
    client: Any = None,
    progress: bool | ProgressCallback = False,
    memory_limit: int | None = None,
) -> Web:
    """η_f(s) = ξ_f(s) + γ_f(s) + y_f e₂: the web of independent fibres f.

    Each fibre is a path of the model, laid from its own spinning position y_f; its
    mean length per area is 1/(v d). Fibres are drawn as polygons, of pieces as long as
    a step in the basic model, and of chords of a smooth fibre. Pieces are clipped at
    the edges of pixels exactly and counted in integers, 2⁻³⁶ of a step: the length
    inside and outside sums up to what was laid, and the web is bitwise the same for
    any number of threads and of workers. Fibre f draws from (seed, f) alone.

    The window sees a stationary web. Fibres start by e^{-B}, and count after 9.2 of
    their relaxation lengths 2/A² + A²σ² (and R of a smooth one), of which e^{-9.2} is
    left; they are laid from before they can reach the window until they cannot any
    more, from all positions that are near enough. How far fibres are thrown, 256
    pilots of the same model tell, whose extremes are taken 1.3 times; `margin_error`
    says what lies beyond.

    Parameters
    ----------
    model : LayDownModel, SmoothLayDownModel or Process
        With noise, a potential that confines, and a belt that moves. Of a process all
        lengths are metres.
    width, length : float
        Of the window, across the belt and along it: multiples of `pixel`.
    pixel : float
        Side of a pixel.
    spacing : float
        Distance d of neighbouring spinning positions; with a `positions` array their
        mean distance by default.
    positions : {"regular", "random"} or array
        In the middle of cells of width d; or uniform, a Poisson number of them; or
        places across the belt, those beyond the window included.
    phases : {"independent", "in phase"} or array
        Of rotating and oscillating nozzles: uniform, or those of the curve, or angles
        to add to its own, for each position in increasing order.
    ds : float, optional
        Step of the fibres; by default what resolves force and noise.
    seed : int or SeedSequence
    periodic : bool
        Whether the web continues periodically across the belt, without margins.
    titer : float, optional
        Mass of the fibre in grams per metre (1 dtex is 1e-4), for webs of a process.
    client : optional
        Where to lay: a dask.distributed client, or an executor of concurrent.futures;
        anything whose ``submit(f, *args)`` gives a future.
    progress : bool or callable
        Show a bar, or call with (fibre-steps done, fibre-steps in all, s).
    memory_limit : int, optional
        Bytes the web may take; by default what is available.

    Returns
    -------
    Web

    Raises
    ------
    ValueError, TypeError
        Bad arguments; a belt at rest, no noise, or a potential that does not confine,
        for which no web is stationary.
    MemoryLimitError
        If the pixels would not fit into memory; before anything is computed.
    NonFinitePathError
        If the gradient is not finite where a fibre comes.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    check_pixels(Window.of(width, length, pixel), memory_limit)
    order = order_of(
        model, width=width, length=length, pixel=pixel, spacing=spacing, ds=ds,
        positions=positions, phases=phases, seed=seed, periodic=periodic, titer=titer,
    )  # fmt: skip
    plan = order.plan
    with reporting(progress) as report:
        told = Told(report, plan.n_fibres * plan.ensemble.schedule.n_steps)
        if client is None:
            n_bytes = bytes_of(plan.window)
            left = allowed_memory(memory_limit) - n_bytes - OVERHEAD
            laid = lay_here(plan, n_workers_for(plan.n_fibres, n_bytes, left), told)
        else:
            laid = lay_elsewhere(plan, client, told)
    return order.web(total(laid.counts), laid, pixels_of(laid.counts, order))


class Told:
    """Steps that are done, told to whoever wants to know."""

    def __init__(self, report: ProgressCallback, n_total: int) -> None:
        self.report, self.n_total, self.n_done = report, n_total, 0

    def __call__(self, n_steps: int, s: float) -> None:
        """Count on, and report."""
        self.n_done += n_steps
        self.report(self.n_done, self.n_total, s)


def check_pixels(window: Window, limit: int | None) -> None:
    """Raise MemoryLimitError if there is no memory for the pixels."""
    remedy = "use larger pixels, or `stream_web`, which lays on a disk"
    check_memory(2 * bytes_of(window) + OVERHEAD, limit, remedy)


def bytes_of(window: Window) -> int:
    """Of the counts of a window, and as many of the arrays that are made of them."""
    rows, columns = window.shape
    return PIXEL_BYTES * rows * columns
