"""Lay a web: many fibres on a moving belt, seen through a window of pixels."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._kernels import raster as kernels
from fpsolve._support.arrays import check_finite_numbers
from fpsolve._support.checks import check_positive
from fpsolve._support.memory import OVERHEAD, allowed_memory, check_memory
from fpsolve._support.progress import ProgressCallback, reporting
from fpsolve.errors import FpsolveError
from fpsolve.evolution.call import recorded
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.process import Process
from fpsolve.paths.randomness import seed_number
from fpsolve.web.laying import (
    PIXEL_BYTES,
    Laid,
    lay_elsewhere,
    lay_here,
    n_workers_for,
    total,
)
from fpsolve.web.plan import Plan, plan_of
from fpsolve.web.web import Web
from fpsolve.web.window import Window

__all__ = ["lay_web"]

# A fibre of a tenth of a gram per metre is a rope.
_THICKEST = 0.1
# Pieces of fibre that may lie beyond the margins without one being found, in relaxation
# lengths: P(none) = e^{-3}.
_UNSEEN = 3.0


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
    process = model if isinstance(model, Process) else None
    model = model.model if isinstance(model, Process) else model
    check_fibre_model(model)
    seed, titer = seed_number(seed, None), checked_titer(titer, process)
    unit = 1.0 if process is None else process.length
    window = Window.of(width, length, pixel)
    n_bytes = bytes_of(window)
    check_memory(2 * n_bytes + OVERHEAD, memory_limit, "use larger pixels")
    window = Window(window.width / unit, window.length / unit, window.pixel / unit)
    spacing = in_units("spacing", spacing, unit)
    ds = in_units("ds", ds, unit)
    if not isinstance(positions, str):
        positions = check_finite_numbers("positions", positions) / unit
    plan = plan_of(model, window, spacing, ds, seed, positions, phases, periodic)
    schedule = plan.ensemble.schedule
    with reporting(progress) as report:
        told = Told(report, plan.n_fibres * schedule.n_steps)
        if client is None:
            left = allowed_memory(memory_limit) - n_bytes - OVERHEAD
            laid = lay_here(plan, n_workers_for(plan.n_fibres, n_bytes, left), told)
        else:
            laid = lay_elsewhere(plan, client, told)
    return web_of(plan, laid, process, titer)


class Told:
    """Steps that are done, told to whoever wants to know."""

    def __init__(self, report: ProgressCallback, n_total: int) -> None:
        self.report, self.n_total, self.n_done = report, n_total, 0

    def __call__(self, n_steps: int, s: float) -> None:
        """Count on, and report."""
        self.n_done += n_steps
        self.report(self.n_done, self.n_total, s)


def web_of(plan: Plan, laid: Laid, process: Process | None, titer: Any) -> Web:
    """The web that has been laid, once every count of it is accounted for."""
    pieces = plan.n_fibres * plan.n_counted
    inside = total(laid.counts)
    if inside + laid.outside != pieces * kernels.UNIT:
        raise FpsolveError(
            f"the length inside and outside must be that of {pieces} steps, got "
            f"{(inside + laid.outside) / kernels.UNIT:.6g}; a pixel holds more pieces "
            "of fibre than its integer: use smaller pixels."
        )
    unit = 1.0 if process is None else process.length
    ds, counts = plan.ensemble.schedule.ds, laid.counts
    length, first, mixed = np.moveaxis(counts, -1, 0).astype(np.float64)
    with np.errstate(invalid="ignore"):
        first, mixed = first / length, mixed / length
    unseen = _UNSEEN * plan.margins.relaxation / ds
    return Web(
        plan=plan,
        process=process,
        titer=titer,
        length_density=length * (ds / kernels.UNIT / plan.window.pixel**2 / unit),
        orientation_11=first,
        orientation_12=mixed,
        laid_length=pieces * ds * unit,
        outside_length=laid.outside / kernels.UNIT * ds * unit,
        margin_error=min((laid.beyond + unseen) / max(pieces, 1), 1.0),
    )


def checked_titer(titer: Any, process: Process | None) -> float | None:
    """The titer; ValueError unless it is one of a fibre of a process."""
    if titer is None:
        return None
    grams = check_positive("titer", titer)
    if process is None:
        raise ValueError(
            f"`titer` must be given with a Process, got {grams:g} for a dimensionless "
            "model; lengths have no unit there."
        )
    if not grams < _THICKEST:
        raise ValueError(
            f"`titer` must be below {_THICKEST:g} g/m, got {grams:g}; dtex given "
            f"instead? {grams:g} dtex are {1e-4 * grams:g} g/m."
        )
    return grams


def bytes_of(window: Window) -> int:
    """Of the counts of a window, and as many of the arrays that are made of them."""
    rows, columns = window.shape
    return PIXEL_BYTES * rows * columns


def in_units(name: str, value: Any, unit: float) -> float | None:
    """A length in units of the throwing range; None as it is."""
    return None if value is None else check_positive(name, value) / unit
