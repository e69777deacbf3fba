"""Fibres in front of the flow that moves them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_kind, check_real
from fpsolve.fibre.air import AirFlow
from fpsolve.plotting.style import COLUMN, drawing, show_frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot_fibres_in_flow"]

# Places at which the flow is asked, along the longer side.
PLACES = 160
# Of the extent of the fibres, on every side; of the longer extent, at least.
MARGIN = 0.05


def plot_fibres_in_flow(
    fibres: Sequence[ArrayLike], air: AirFlow, *, t: float = 0.0
) -> Figure:
    """Fibres seen along y, in white, before the speed |u| of the air in their plane.

    Parameters
    ----------
    fibres : sequence of array_like, shape (n, 3) each
        Positions in m, as of `Motion.r` at one time.
    air : AirFlow
        It is drawn at the mean y of the fibres, around all of them: a table must reach
        a twentieth of their extent further.
    t : float, optional
        Time in s.

    Raises
    ------
    ValueError
        If there is no fibre, or one has another shape.
    FlowRangeError
        If the flow is not known around the fibres.
    """
    check_kind("air", air, AirFlow, "AirFlow((1.0, 0.0, 0.0)) is one")
    t = check_real("t", t)
    curves = [_checked(one) for one in fibres]
    if not curves:
        raise ValueError("`fibres` must not be empty; give the positions of one.")
    places = np.concatenate(curves)
    low, high = places.min(axis=0), places.max(axis=0)
    margin = MARGIN * float((high - low)[[0, 2]].max())
    x, z = (
        np.linspace(low[i] - margin, high[i] + margin, PLACES) for i in (0, 2)
    )  # fmt: skip
    there = np.zeros((PLACES, PLACES, 3))
    there[..., 0], there[..., 2] = x, z[:, None]
    there[..., 1] = places[:, 1].mean()
    speed = np.linalg.norm(air.at(there.reshape(-1, 3), t), axis=1)
    with drawing(COLUMN, 4.0) as figure:
        axes = figure.subplots()
        mesh = axes.pcolormesh(
            100 * x, 100 * z, speed.reshape(PLACES, PLACES), rasterized=True,
            shading="gouraud",
        )  # fmt: skip
        for curve in curves:
            axes.plot(*100 * curve[:, [0, 2]].T, color="white", linewidth=0.5)
        figure.colorbar(mesh, label=r"$|u|$ in m/s")
        axes.set_aspect("equal")
        axes.set(xlabel="$x$ in cm", ylabel="$z$ in cm")
        show_frame(axes)
    return figure


def _checked(curve: ArrayLike) -> Array:
    found = check_finite_numbers("fibres", curve)
    if found.ndim != 2 or found.shape[1] != 3:
        raise ValueError(
            f"`fibres` must be positions of the shape (n, 3), got {found.shape}."
        )
    return found
