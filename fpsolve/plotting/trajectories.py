"""Single paths in the plane of the deviation ξ."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fpsolve.model.laydown import LayDownModel
from fpsolve.plotting.fibres import THIN, listed
from fpsolve.plotting.maps import enclosing_levels
from fpsolve.plotting.marginals import label_outer
from fpsolve.plotting.style import (
    COLOURS,
    COLUMN,
    PAGE,
    drawing,
    noise_of,
    parameters,
    show_frame,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.model.potentials.potential import Potential
    from fpsolve.paths.result import Paths
    from fpsolve.paths.trajectory import Trajectory

__all__ = ["plot_trajectories"]

# Of the equilibrium's mass that the panels need not show.
_OUTSIDE = 1e-3
_PER_ROW = 3


def plot_trajectories(paths: Paths | Sequence[Paths], k: int = 0) -> Figure:
    """Path k of each of several ensembles in the ξ plane, as in figure 4 of the paper.

    One panel for each, all with the same axes. The dashed line encloses 95 % of
    p_S = c exp(-B), a circle for an isotropic potential; there is none with smooth
    fibres, whose stationary law it is not. The dot is where the path begins. Figure 4
    itself, for noises from 0 to 10::

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

    Raises
    ------
    ValueError
        If there is nothing to draw, or potentials or curves differ.

    References
    ----------
    [KMW09]_, figure 4.
    """
    several = listed(paths)
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
    basic = all(isinstance(one.model, LayDownModel) for one in several)
    region = _equilibrium_region(model.potential) if basic else None
    farthest = [float(np.abs(one.xi).max()) for one in trajectories]
    limit = 1.05 * max(*farthest, 0.0 if region is None else region.limit())
    n_rows = math.ceil(len(several) / _PER_ROW)
    n_columns = math.ceil(len(several) / n_rows)
    width = COLUMN if n_columns == 1 else PAGE
    height = n_rows * ((width - 0.6) / n_columns + 0.2) + 0.6
    title = _trajectory_title(several, region is not None)
    with drawing(width, height, title) as figure:
        # Panels are squares: no room is left for what they do not fill.
        figure.set_layout_engine("compressed")
        panels = figure.subplots(
            n_rows, n_columns, sharex=True, sharey=True, squeeze=False
        )
        for axes, one, trajectory in zip(
            panels.flat, several, trajectories, strict=False
        ):
            _draw_deviation(axes, trajectory, region)
            axes.set_title(noise_of(one.model))
        panels[0, 0].set(xlim=(-limit, limit), ylim=(-limit, limit))
        panels[0, 0].locator_params(nbins=7)
        label_outer(panels, len(several))
    return figure


def _draw_deviation(axes: Axes, trajectory: Trajectory, region: _Region | None) -> None:
    xi = trajectory.xi
    axes.plot(*xi.T, color=COLOURS["blue"], linewidth=THIN)
    if region is not None:
        region.draw(axes)
    axes.plot(*xi[0], ".", color=COLOURS["black"], markersize=4)
    axes.set_aspect("equal")
    show_frame(axes)


class _Region(NamedTuple):
    """Where p_S is large enough to hold 95 % of its mass: weight above a level."""

    centres: NDArray[np.float64]
    weight: NDArray[np.float64]
    level: float

    def draw(self, axes: Axes) -> None:
        """Draw the border as a dashed line."""
        axes.contour(
            self.centres, self.centres, self.weight.T, levels=[self.level],
            colors=COLOURS["vermilion"], linestyles="--", linewidths=0.9,
        )  # fmt: skip

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
    return _Region(centres, weight, min(enclosing_levels(weight)))


def _trajectory_title(several: list[Paths], has_region: bool) -> str:
    """Return potential, curve and length; the noises are those of the panels."""
    title = parameters(several[0])
    noise = f",  {noise_of(several[0].model)}"
    lengths = {float(one.s[-1]) - one.s_start for one in several}
    title = title.replace(noise, "", 1)
    if len(lengths) == 1:
        title += f",  length ${lengths.pop():g}$"
    return title + (r";  dashed: 95 % of $p_S$" if has_region else "")
