"""Single paths: the deviation ξ in the plane, and the fibre η on its belt."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from fpsolve.plotting.selection import check_paths
from fpsolve.plotting.style import (
    COLOURS,
    COLUMN,
    PAGE,
    new_figure,
    paper_style,
    parameters,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.model.curves.curve import Curve
    from fpsolve.model.potentials.potential import Potential
    from fpsolve.paths.result import Paths
    from fpsolve.paths.trajectory import Trajectory

__all__ = ["plot_fibre", "plot_nozzles", "plot_trajectories"]

# Limits of the first and of the second axis.
_Box: TypeAlias = tuple[tuple[float, float], tuple[float, float]]

# Share of the equilibrium's mass inside the dashed line.
_SHARE = 0.95
# Of the mass that the panels need not show.
_OUTSIDE = 1e-3
_PER_ROW = 3
_THIN = 0.5
# Height in inches of a page, and height / width from which a panel fits a column.
_HIGHEST, _SQUARISH = 9.5, 0.65
_PROCESSES = {
    "fixed_belt": "belt at rest",
    "moving_belt": "transversal",
    "rotating_nozzle": "rotating",
    "oscillating_nozzle": "oscillating",
}


def plot_trajectories(paths: Paths | Sequence[Paths], k: int = 0) -> Figure:
    """Path k of each of several ensembles in the ξ plane, as in figure 4 of the paper.

    One panel for each, all with the same axes. The dashed line encloses 95 % of
    p_S = c exp(-B), a circle for an isotropic potential; the dot is where the path
    begins. Figure 4 itself, for noises from 0 to 10::

        plot_trajectories([
            sample_paths(LayDownModel(QuadraticPotential(), noise), n_paths=1,
                         s_end=60.0, ds=0.02, seed=1, initial=((1.5, 0.0), np.pi / 2))
            for noise in (0, 0.1, 1, 2, 5, 10)
        ])

    Parameters
    ----------
    paths : Paths or sequence of Paths
        With the same potential and curve.
    k : int, optional
        Number of the path.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If there is nothing to draw, or potentials or curves differ.

    References
    ----------
    [KMW09]_, figure 4.
    """
    several = _several(paths)
    model = several[0].model
    if any(
        (one.model.potential, one.model.curve) != (model.potential, model.curve)
        for one in several
    ):
        raise ValueError(
            "`paths` must have one potential and one curve in common, got several; "
            "draw them in figures of their own."
        )
    trajectories = [one.replay(k) for one in several]
    region = _equilibrium_region(model.potential)
    farthest = [float(np.abs(one.xi).max()) for one in trajectories]
    limit = 1.05 * max(*farthest, 0.0 if region is None else region.limit())
    with paper_style():
        n_columns = min(len(several), _PER_ROW)
        n_rows = math.ceil(len(several) / n_columns)
        width = COLUMN if n_columns == 1 else PAGE
        side = (width - 0.6) / n_columns
        figure = new_figure(width, n_rows * (side + 0.2) + 0.6)
        # Panels are squares: no room is left for what they do not fill.
        figure.set_layout_engine("compressed")
        panels = figure.subplots(
            n_rows, n_columns, sharex=True, sharey=True, squeeze=False
        )
        for axes, one, trajectory in zip(
            panels.flat, several, trajectories, strict=False
        ):
            _draw_deviation(axes, trajectory, region)
            axes.set_title(f"$A = {one.model.noise:g}$")
        panels[0, 0].set(xlim=(-limit, limit), ylim=(-limit, limit))
        panels[0, 0].locator_params(nbins=7)
        _label_outer(panels, len(several))
        figure.suptitle(_trajectory_title(several, region is not None))
    return figure


def plot_fibre(paths: Paths, k: int = 0) -> Figure:
    """Fibre η = ξ + γ(s) of path k as it lies on the belt, with its curve γ.

    The view is that of the belt, in which the nozzle moves by -v e1 per unit of
    arclength.

    Parameters
    ----------
    paths : Paths
    k : int, optional
        Number of the path.

    Returns
    -------
    matplotlib.figure.Figure

    References
    ----------
    [KMW09]_, equation (6).
    """
    check_paths(paths)
    with paper_style():
        figure, _ = _fibres([paths], k)
        figure.suptitle(_parameters(paths))
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

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ValueError
        If there is nothing to draw.

    References
    ----------
    [KMW09]_, figure 3 and section 4.2.
    """
    several = _several(paths)
    with paper_style():
        figure, panels = _fibres(several, k)
        for axes, one in zip(panels, several, strict=True):
            axes.set_title(_process_title(one.model.curve, one.model.noise))
    return figure


def _several(paths: Paths | Sequence[Paths]) -> list[Paths]:
    several = list(paths) if isinstance(paths, Sequence) else [paths]
    for one in several:
        check_paths(one)
    if not several:
        raise ValueError("`paths` must hold at least one ensemble to draw, got none.")
    return several


def _draw_deviation(axes: Axes, trajectory: Trajectory, region: _Region | None) -> None:
    xi = trajectory.xi
    axes.plot(*xi.T, color=COLOURS["blue"], linewidth=_THIN)
    if region is not None:
        region.draw(axes)
    axes.plot(*xi[0], ".", color=COLOURS["black"], markersize=4)
    axes.set_aspect("equal")
    _frame(axes)


def _fibres(several: list[Paths], k: int) -> tuple[Figure, list[Axes]]:
    trajectories = [one.replay(k) for one in several]
    curves = [
        np.stack(one.model.curve.position(trajectory.s), axis=-1)
        for one, trajectory in zip(several, trajectories, strict=True)
    ]
    figure, panels = _stack(
        [
            _box(np.concatenate([trajectory.eta, curve]))
            for trajectory, curve in zip(trajectories, curves, strict=True)
        ]
    )
    for axes, trajectory, curve in zip(panels, trajectories, curves, strict=True):
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
    axes.plot(
        *trajectory.eta.T,
        color=COLOURS["blue"],
        linewidth=_THIN,
        label=r"fibre $\eta$",
    )
    axes.plot(
        *curve.T,
        color=COLOURS["vermilion"],
        linewidth=0.9,
        # A nozzle that stays above one point of the belt is that point.
        marker="." if np.ptp(curve) == 0 else None,
        label=r"reference curve $\gamma$",
    )
    axes.set_aspect("equal")
    axes.set_ylabel(r"$\eta_2$")
    _frame(axes)


def _frame(axes: Axes) -> None:
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)


def _box(points: NDArray[np.float64]) -> _Box:
    """Return the limits of both axes, with a margin."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.03 * float(np.max(high - low))
    (left, bottom), (right, top) = (low - margin).tolist(), (high + margin).tolist()
    return (left, right), (bottom, top)


class _Region(NamedTuple):
    """Where p_S is large enough to hold 95 % of its mass: weight above a level."""

    centres: NDArray[np.float64]
    weight: NDArray[np.float64]
    level: float

    def draw(self, axes: Axes) -> None:
        """Draw the border as a dashed line."""
        axes.contour(
            self.centres,
            self.centres,
            self.weight.T,
            levels=[self.level],
            colors=COLOURS["vermilion"],
            linestyles="--",
            linewidths=0.9,
        )

    def limit(self) -> float:
        """Return the largest coordinate of the border, to one cell."""
        inside = self.weight >= self.level
        shown = self.centres[inside.any(axis=0) | inside.any(axis=1)]
        return float(np.abs(shown).max())


def _equilibrium_region(potential: Potential, n_cells: int = 400) -> _Region | None:
    """Return the region in a square that holds all but a thousandth of the mass."""
    from fpsolve.model.potentials.nodes import gibbs_nodes

    if not potential.normalisable:
        return None
    half_width = max(gibbs_nodes(potential).half_widths(_OUTSIDE))
    cell = 2 * half_width / n_cells
    centres = -half_width + cell * np.arange(0.5, n_cells, dtype=np.float64)
    value = potential.value(centres[:, None], centres[None, :])
    weight = np.exp(value.min() - value)
    descending = np.sort(weight, axis=None)[::-1]
    share = np.cumsum(descending) / descending.sum()
    level = float(descending[np.searchsorted(share, _SHARE)])
    return _Region(centres, weight, level)


def _label_outer(panels: NDArray[Any], n_panels: int) -> None:
    n_columns = panels.shape[1]
    for index, axes in enumerate(panels.flat):
        if index >= n_panels:
            axes.remove()
            continue
        if index % n_columns == 0:
            axes.set_ylabel(r"$\xi_2$")
        if index + n_columns >= n_panels:
            axes.set_xlabel(r"$\xi_1$")
            axes.tick_params(labelbottom=True)


def _trajectory_title(several: list[Paths], has_region: bool) -> str:
    """Return potential, curve and length; the noises are those of the panels."""
    title = _parameters(several[0])
    noise = rf",  $A = {several[0].model.noise:g}$"
    lengths = {float(one.s[-1]) - one.s_start for one in several}
    title = title.replace(noise, "", 1)
    if len(lengths) == 1:
        title += f",  length ${lengths.pop():g}$"
    return title + (r";  dashed: 95 % of $p_S$" if has_region else "")


def _parameters(paths: Paths) -> str:
    # Only the model of what it is given is read.
    return parameters(cast(Any, paths))


def _process_title(curve: Curve, noise: float) -> str:
    name = _PROCESSES.get(curve.kind, curve.kind.replace("_", " "))
    return rf"{name}:  $\gamma(s) = {curve.latex}$,  $A = {noise:g}$"
