"""What was asked for, in the units in which it was: from arguments to a web."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._kernels import raster as kernels
from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive
from fpsolve.errors import FpsolveError
from fpsolve.model.fibre import check_fibre_model
from fpsolve.model.process import Process
from fpsolve.paths.randomness import seed_number
from fpsolve.web.laying import Counts, Laid
from fpsolve.web.plan import Plan, plan_of
from fpsolve.web.web import Web
from fpsolve.web.window import Window

__all__ = ["Order", "order_of", "pixels_of"]

# A fibre of a tenth of a gram per metre is a rope.
_THICKEST = 0.1
# Pieces of fibre that may lie beyond the margins without one being found, in relaxation
# lengths: P(none) = e^{-3}.
_UNSEEN = 3.0
# How far a width may be from a multiple of the spacing, relatively: rounding.
_TYPED = 1e-9


@dataclass(frozen=True, eq=False)
class Order:
    """A web before it is laid.

    Attributes
    ----------
    plan : Plan
    process : Process or None
    titer : float or None
    """

    plan: Plan
    process: Process | None
    titer: float | None

    @property
    def unit(self) -> float:
        """The throwing range in metres, or 1."""
        return 1.0 if self.process is None else self.process.length

    def web(self, inside: int, laid: Laid, pixels: tuple[Array, Array, Array]) -> Web:
        """The web of what was laid, of which so many counts lie inside.

        Its pixels are those that `pixels_of` makes.
        """
        plan, ds = self.plan, self.plan.ensemble.schedule.ds
        pieces = plan.n_fibres * plan.n_counted
        check_conserved(inside + laid.outside, pieces)
        unseen = _UNSEEN * plan.margins.relaxation / ds
        length, first, mixed = pixels
        return Web(
            plan=plan,
            process=self.process,
            titer=self.titer,
            length_density=length,
            orientation_11=first,
            orientation_12=mixed,
            laid_length=pieces * ds * self.unit,
            outside_length=laid.outside / kernels.UNIT * ds * self.unit,
            margin_error=min((laid.beyond + unseen) / max(pieces, 1), 1.0),
        )


def order_of(
    model: Any,
    *,
    width: float,
    length: float,
    pixel: float,
    spacing: float | None = None,
    positions: Any = "regular",
    phases: Any = "independent",
    ds: float | None = None,
    seed: Any = None,
    periodic: bool = False,
    titer: float | None = None,
) -> Order:
    """Check the arguments, in metres for a process, and plan the web of them."""
    process = model if isinstance(model, Process) else None
    model = model.model if isinstance(model, Process) else model
    check_fibre_model(model)
    number, grams = checked_seed(seed), checked_titer(titer, process)
    unit = 1.0 if process is None else process.length
    window = Window.of(width, length, pixel)
    if periodic is True and isinstance(positions, str) and positions == "regular":
        check_closed(window.width, check_positive("spacing", spacing))
    window = Window(window.width / unit, window.length / unit, window.pixel / unit)
    if not isinstance(positions, str):
        positions = check_finite_numbers("positions", positions) / unit
    plan = plan_of(
        model, window, in_units("spacing", spacing, unit), in_units("ds", ds, unit),
        number, positions, phases, periodic,
    )  # fmt: skip
    return Order(plan, process, grams)


def pixels_of(counts: Counts, order: Order) -> tuple[Array, Array, Array]:
    """Length per area, and the means of τ₁τ₁ and τ₁τ₂, of counts of any rows."""
    plan = order.plan
    # One after the other: together they take as much memory as the counts, and no more.
    length = counts[..., 0].astype(np.float64)
    with np.errstate(invalid="ignore"):
        first, mixed = counts[..., 1] / length, counts[..., 2] / length
    one = plan.ensemble.schedule.ds / kernels.UNIT / plan.window.pixel**2 / order.unit
    length *= one
    return length, first, mixed


def check_closed(width: float, d: float) -> None:
    """Raise ValueError unless regular positions continue on the other side."""
    number = width / d
    if not abs(number - round(number)) <= _TYPED * number:
        raise ValueError(
            f"`width` must be a multiple of `spacing` = {d:g} across a periodic web, "
            f"got {width:g}; use width = {max(round(number), 1) * d:.12g}."
        )


def check_conserved(counted: int, pieces: int) -> None:
    """Raise FpsolveError unless all that was laid is inside or outside."""
    if counted != pieces * kernels.UNIT:
        raise FpsolveError(
            f"the length inside and outside must be that of {pieces} steps, got "
            f"{counted / kernels.UNIT:.6g}; a pixel holds more pieces of fibre than "
            "its integer: use smaller pixels."
        )


def checked_seed(seed: Any) -> int:
    """The seed as one number; TypeError if there is none."""
    if seed is None:
        raise TypeError(
            "`seed` must be given, got None; pass seed=1, which repeats the web, or "
            "another number for another web."
        )
    return seed_number(seed, None)


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


def in_units(name: str, value: Any, unit: float) -> float | None:
    """A length in units of the throwing range; None as it is."""
    return None if value is None else check_positive(name, value) / unit
