"""A fibre that moves, and one that is laid down."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.fibre.laid import LayDown
from fpsolve.fibre.motion import Motion
from fpsolve.plotting.selection import evenly
from fpsolve.plotting.style import COLOURS, DENSITY_MAP, PAGE, drawing

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve._support.arrays import Array

__all__ = ["plot_lay_down", "plot_motion"]

# Shapes that are drawn over each other, from pale to dark.
MOST_SHAPES = 12
THIN = 0.7


def plot_motion(motion: Motion) -> Figure:
    """Shapes of a fibre where they were saved, and its energies over time.

    Parameters
    ----------
    motion : Motion
    """
    check_kind("motion", motion, Motion, "see `fpsolve.fibre.simulate`")
    with drawing(PAGE, 2.8) as figure:
        shapes, energies = figure.subplots(1, 2)
        _draw_shapes(shapes, motion.r, motion.saved)
        for name, colour in (("kinetic", "blue"), ("potential", "green"),
                             ("energy", "black")):  # fmt: skip
            energies.plot(motion.t, getattr(motion, name), color=COLOURS[colour],
                          label="sum" if name == "energy" else name)  # fmt: skip
        energies.set(xlabel="$t$ in s", ylabel="energy in J")
        energies.legend()
        figure.suptitle(
            f"{motion.string.length:g} m of fibre, {motion.t.size - 1} steps, edges "
            f"keep their length to {motion.stretched.max():.0e}"
        )
    return figure


def plot_lay_down(found: LayDown) -> Figure:
    """The fibre on the belt about its reference curve, and in the air from the side.

    Parameters
    ----------
    found : LayDown
    """
    check_kind("found", found, LayDown, "see `fpsolve.fibre.lay_down`")
    with drawing(PAGE, 4.6) as figure:
        above = figure.add_gridspec(2, 2)
        belt = figure.add_subplot(above[0, :])
        side, lengths = (figure.add_subplot(above[1, one]) for one in (0, 1))
        _draw_belt(belt, found)
        _draw_shapes(side, found.r, found.saved)
        lengths.plot(found.t, found.free_length, color=COLOURS["blue"])
        lengths.set(xlabel="$t$ in s", ylabel="length in the air in m", ylim=(0, None))
        figure.suptitle(
            f"{found.fed:.3g} m of fibre of {1e6 * found.string.diameter:.3g} µm, spun "
            f"at {found.nozzle.speed:g} m/s"
            + ("" if found.belt is None else f", belt at {found.belt.speed:g} m/s")
        )
    return figure


def _draw_belt(axes: Axes, found: LayDown) -> None:
    """What lies on the belt, and where the nozzle went in its frame."""
    eta = found.landed
    axes.plot(*eta.T, color=COLOURS["blue"], linewidth=THIN, label="fibre")
    if len(eta) and (found.belt is None or found.belt.speed < found.nozzle.speed):
        s = np.linspace(0.0, found.fed, 400)
        nozzle = found.nozzle
        x, y = found.reference_curve.position(s)
        axes.plot(
            nozzle.position[0] + x, nozzle.position[1] + y, linewidth=0.9,
            color=COLOURS["vermilion"], label="nozzle in the frame of the belt",
        )  # fmt: skip
        axes.legend(loc="best")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="along the belt in m", ylabel="across in m")


def _draw_shapes(axes: Axes, shapes: Sequence[Array] | Array, times: Array) -> None:
    """Some shapes from the side; the later the darker."""
    import matplotlib as mpl

    chosen = evenly(len(shapes), MOST_SHAPES)
    colours = mpl.colormaps[DENSITY_MAP].reversed()
    end = float(times[-1]) or 1.0
    for k in chosen:
        axes.plot(shapes[k][:, 0], shapes[k][:, 2], linewidth=THIN,
                  color=colours(0.1 + 0.9 * float(times[k]) / end))  # fmt: skip
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="$x$ in m", ylabel="$z$ in m")
    axes.set_title(f"$t = {times[0]:g}$ to ${times[-1]:g}$ s, pale to dark")
