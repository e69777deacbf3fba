"""The fibre η of a path on its belt, beside the reference curve γ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fpsolve.plotting.selection import check_paths
from fpsolve.plotting.style import (
    COLOURS,
    COLUMN,
    PAGE,
    new_figure,
    noise_of,
    paper_style,
    parameters,
    show_frame,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.model.curves.curve import Curve
    from fpsolve.paths.result import Paths
    from fpsolve.paths.trajectory import Trajectory

__all__ = ["THIN", "listed", "plot_fibre", "plot_nozzles"]

# Limits of the first and of the second axis.
_Box: TypeAlias = tuple[tuple[float, float], tuple[float, float]]

THIN = 0.5
# Height in inches of a page, and height / width from which a panel fits a column.
_HIGHEST, _SQUARISH = 9.5, 0.65
_PROCESSES = {
    "fixed_belt": "belt at rest",
    "moving_belt": "transversal",
    "rotating_nozzle": "rotating",
    "oscillating_nozzle": "oscillating",
}


def plot_fibre(paths: Paths, k: int = 0) -> Figure:
    """Fibre η = ξ + γ(s) of path k as it lies on the belt, with its curve γ.

    The view is that of the belt, in which the nozzle moves by -v e1 per unit of
    arclength.

    Parameters
    ----------
    paths : Paths
    k : int, optional
        Number of the path.

    References
    ----------
    [KMW09]_, equation (6).
    """
    check_paths(paths)
    with paper_style():
        figure, _ = _fibres([paths], k)
        figure.suptitle(parameters(paths))
    return figure


def plot_nozzles(paths: Sequence[Paths], k: int = 0) -> Figure:
    """Fibres of several processes with their curves γ, one above the other.

    Meant for the shapes of figure 3 of the paper: a transversal process (a belt that
    moves below a nozzle at rest), a rotating and an oscillating nozzle.

    Parameters
    ----------
    paths : sequence of Paths
        One for each process.
    k : int, optional
        Number of the path.

    Raises
    ------
    ValueError
        If there is nothing to draw.

    References
    ----------
    [KMW09]_, figure 3 and section 4.2.
    """
    several = listed(paths)
    with paper_style():
        figure, panels = _fibres(several, k)
        for axes, one in zip(panels, several, strict=True):
            axes.set_title(_process_title(one.model.curve, noise_of(one.model)))
    return figure


def listed(paths: Paths | Sequence[Paths]) -> list[Paths]:
    """Return ensembles as a list; ValueError if there is none."""
    several = list(paths) if isinstance(paths, Sequence) else [paths]
    for one in several:
        check_paths(one)
    if not several:
        raise ValueError("`paths` must hold at least one ensemble to draw, got none.")
    return several


def _fibres(several: list[Paths], k: int) -> tuple[Figure, list[Axes]]:
    trajectories = [one.replay(k) for one in several]
    curves = [
        np.stack(one.model.curve.position(trajectory.s), axis=-1)
        for one, trajectory in zip(several, trajectories, strict=True)
    ]
    both = list(zip(trajectories, curves, strict=True))
    figure, panels = _stack(
        [_box(np.concatenate([trajectory.eta, curve])) for trajectory, curve in both]
    )
    for axes, (trajectory, curve) in zip(panels, both, strict=True):
        _draw_fibre(axes, trajectory, curve)
    panels[-1].set_xlabel(r"$\eta_1$")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower right", ncols=2)
    return figure, panels


def _stack(boxes: list[_Box]) -> tuple[Figure, list[Axes]]:
    """Return a figure with a panel for each box, all on one scale."""
    left, right = min(x[0] for x, _ in boxes), max(x[1] for x, _ in boxes)
    heights = [high - low for _, (low, high) in boxes]
    ratio, rest = sum(heights) / (right - left), 0.35 * len(boxes) + 0.5
    width = COLUMN if len(boxes) == 1 and ratio > _SQUARISH else PAGE
    figure = new_figure(width, min((width - 0.6) * ratio + rest, _HIGHEST))
    panels = figure.subplots(
        len(boxes), 1, squeeze=False, sharex=True, height_ratios=heights
    )
    for axes, (_, limits) in zip(panels[:, 0], boxes, strict=True):
        axes.set(xlim=(left, right), ylim=limits)
    return figure, list(panels[:, 0])


def _draw_fibre(axes: Axes, trajectory: Trajectory, curve: NDArray[np.float64]) -> None:
    blue, red = COLOURS["blue"], COLOURS["vermilion"]
    axes.plot(*trajectory.eta.T, color=blue, linewidth=THIN, label=r"fibre $\eta$")
    # A nozzle that stays above one point of the belt is that point.
    marker = "." if np.ptp(curve) == 0 else None
    name = r"reference curve $\gamma$"
    axes.plot(*curve.T, color=red, linewidth=0.9, marker=marker, label=name)
    axes.set_aspect("equal")
    axes.set_ylabel(r"$\eta_2$")
    show_frame(axes)


def _box(points: NDArray[np.float64]) -> _Box:
    """Return the limits of both axes, with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.03 * float(np.max(high - low))
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return (left, right), (bottom, top)


def _process_title(curve: Curve, noise: str) -> str:
    name = _PROCESSES.get(curve.kind, curve.kind.replace("_", " "))
    return rf"{name}:  $\gamma(s) = {curve.latex}$,  {noise}"
