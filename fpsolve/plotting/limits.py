"""Distances to limits, with the slopes of the orders derived."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.selection import check_dataset
from fpsolve.plotting.style import COLOURS, PAGE, drawing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_large_noise", "plot_white_noise"]

_PANELS = {
    "stationary": r"stationary, $v = w\varepsilon$",
    "belt_directed": r"$v = w\varepsilon$, directed start",
    "belt_uniform": r"$v = w\varepsilon$, uniform start",
    "rest_directed": r"$v = 0$, directed start",
    "rest_uniform": r"$v = 0$, uniform start",
    "gap": "gap, and mean at fixed $v$",
}
# Measure: (label, colour, marker).
_LINES = {
    "joint": (r"$p$ to $\mathcal{P}/2\pi$", "vermilion", "s"),
    "marginal_uncorrected": (
        r"$\int p\,\mathrm{d}\alpha$, start as given", "purple", "v",
    ),
    "joint_p1": (r"$p$, with $\varepsilon p_1$", "orange", "D"),
    "marginal": (r"$\int p\,\mathrm{d}\alpha$ to $\mathcal{P}$", "blue", "o"),
    "mean": (r"$\mathrm{E}\,\xi$", "sky", "^"),
    "entropy": (r"$H$", "black", "P"),
    "direction_p1": (r"$\mathrm{E}\,\tau$, with $\varepsilon p_1$", "green", "X"),
}  # fmt: skip
_RATES = {
    "gap/gap": (r"gap$\cdot A^2/\Lambda$ to $1$", "blue", "o"),
    "gap/next_term": (r"to $1 + c\varepsilon^2$", "green", "X"),
    "fixed_speed/mean_linear": (r"$\mathrm{E}\,\xi_1$ to $A^2v$", "vermilion", "s"),
    "fixed_speed/mean_balance": ("to the von Mises balance", "orange", "D"),
}
_COLUMNS = 3
_WHITE = {
    "density/joint": (r"$p$ of $(\xi, \alpha)$", "vermilion", "s"),
    "density/marginal": (r"$p$ of $\xi$", "blue", "o"),
    "density/angle": (r"$p$ of $\alpha$", "orange", "D"),
    "density/mean": (r"$\mathrm{E}\,\xi$", "sky", "^"),
    "density/direction": (r"$\mathrm{E}\,\tau$", "green", "X"),
    "paths/angle": (r"$\alpha$, same noise", "vermilion", "v"),
    "paths/position": (r"$\xi$, same noise", "blue", "P"),
    "paths/corrected": (r"$\alpha + R\kappa$, same noise", "orange", "*"),
    "gap/gap": ("gap", "blue", "o"),
    "gap/next_term": ("gap, with its derivative", "sky", "^"),
    "variance/variance": (r"$\mathrm{Var}\,\xi_1$", "vermilion", "s"),
    "variance/next_term": (
        r"$\mathrm{Var}\,\xi_1$, with its derivative",
        "orange",
        "D",
    ),
}
_WHITE_PANELS = {
    "densities and moments": ("density",),
    "paths": ("paths",),
    "stationary, and rates": ("gap", "variance"),
}


def plot_large_noise(dataset: xr.Dataset) -> Figure:
    """Distance of the full equation from its limit against ε = A⁻², on log-log axes.

    One panel for every part that was studied. Markers: distances, with the numerical
    error as bars; thin lines: the slope of the order that is derived, through the
    smallest ε. Filled where the error is below a third of the distance, open where
    the solver cannot tell it from zero.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `large_noise_limit`.
    """
    check_dataset("dataset", dataset)
    if "expected_order" not in dataset or "epsilon" not in dataset.coords:
        raise ValueError(
            "`dataset` must come from `large_noise_limit`, got one without "
            '"expected_order" over "epsilon".'
        )
    panels = _panels(dataset)
    rows = math.ceil(len(panels) / _COLUMNS)
    title = f"$B$ = {dataset.attrs['formula']}"
    with drawing(PAGE, 0.5 + 2.4 * rows, title) as figure:
        grid = figure.subplots(rows, min(_COLUMNS, len(panels)), squeeze=False)
        for axes, (part, lines) in zip(grid.flat, panels.items(), strict=False):
            _draw(axes, dataset, lines)
            axes.set_title(_PANELS[part])
        for axes in grid.flat[len(panels) :]:
            axes.set_axis_off()
        for axes in grid[:, 0]:
            axes.set_ylabel("distance")
        for axes in grid[-1]:
            axes.set_xlabel(r"$\varepsilon = A^{-2}$")
        _legend(figure, grid)
    return figure


def plot_white_noise(dataset: xr.Dataset) -> Figure:
    """Distance of smooth fibres from their white-noise limit against R, log-log.

    Markers and lines as in `plot_large_noise`.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `white_noise_limit`.
    """
    check_dataset("dataset", dataset)
    over = "relaxation_length"
    if "expected_order" not in dataset or over not in dataset.coords:
        raise ValueError(
            "`dataset` must come from `white_noise_limit`, got one without "
            f'"expected_order" over "{over}".'
        )
    known = set(dataset["quantity"].to_numpy())
    panels = {
        title: {name: _WHITE[name] for name in _WHITE if name in known & _of(parts)}
        for title, parts in _WHITE_PANELS.items()
    }
    panels = {title: lines for title, lines in panels.items() if lines}
    title = f"$B$ = {dataset.attrs['formula']}"
    with drawing(PAGE, 3.4, title) as figure:
        grid = figure.subplots(1, len(panels), squeeze=False)
        for axes, (panel, lines) in zip(grid.flat, panels.items(), strict=True):
            _draw(axes, dataset, lines, over)
            axes.set_title(panel)
            axes.set_xlabel("$R$")
        grid[0, 0].set_ylabel("distance")
        _legend(figure, grid)
    return figure


def _of(parts: tuple[str, ...]) -> set[str]:
    """The quantities of parts that are drawn."""
    return {name for name in _WHITE if name.partition("/")[0] in parts}


def _panels(dataset: xr.Dataset) -> dict[str, dict[str, tuple[str, str, str]]]:
    """Which quantities go where, for the parts that there are."""
    known = set(dataset["quantity"].to_numpy())
    panels = {}
    for part in _PANELS:
        wanted = (
            _RATES
            if part == "gap"
            else {f"{part}/{name}": line for name, line in _LINES.items()}
        )
        found = {name: line for name, line in wanted.items() if name in known}
        if found:
            panels[part] = found
    return panels


def _draw(
    axes: Axes,
    dataset: xr.Dataset,
    lines: dict[str, tuple[str, str, str]],
    over: str = "epsilon",
) -> None:
    epsilon = dataset[over].to_numpy()
    for name, (label, colour, marker) in lines.items():
        one = dataset.sel(quantity=name)
        distance = one["distance"].to_numpy()
        error = one["distance_error"].to_numpy()
        order = float(one["expected_order"])
        if not math.isfinite(order) or not np.isfinite(distance).any():
            continue
        _draw_slope(axes, epsilon, distance, order, COLOURS[colour])
        seen = distance > 3 * error
        for chosen, face in ((seen, COLOURS[colour]), (~seen, "white")):
            axes.errorbar(
                epsilon[chosen], distance[chosen],
                np.minimum(error[chosen], 0.9 * distance[chosen]),
                color=COLOURS[colour], marker=marker, markersize=4,
                markerfacecolor=face, linestyle="none", elinewidth=0.8,
                label=f"{label} ({order:g})" if face != "white" else None,
            )  # fmt: skip
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    axes.set_xticks(epsilon, [_fraction(one) for one in epsilon])
    axes.minorticks_off()


def _draw_slope(
    axes: Axes, epsilon: np.ndarray, distance: np.ndarray, order: float, colour: str
) -> None:
    """The line of the order through the distance at the smallest ε."""
    usable = np.isfinite(distance) & (distance > 0)
    least = int(np.argmin(np.where(usable, epsilon, np.inf)))
    ends = np.array([epsilon.min(), epsilon.max()])
    line = distance[least] * (ends / epsilon[least]) ** order
    axes.plot(ends, line, color=colour, linewidth=0.7)


def _fraction(epsilon: float) -> str:
    """Return "1/8" for 0.125, other numbers as they are."""
    inverse = 1 / epsilon
    near = abs(inverse - round(inverse)) < 1e-6
    return f"1/{round(inverse)}" if near else f"{epsilon:.3g}"


def _legend(figure: Figure, grid: np.ndarray) -> None:
    """One legend below all panels; the derived order in brackets."""
    found = {}
    for axes in grid.flat:
        handles, names = axes.get_legend_handles_labels()
        found.update(dict(zip(names, handles, strict=True)))
    figure.legend(
        found.values(), found.keys(), loc="outside lower center", ncols=3,
        title="distance (order derived, thin line)",
    )  # fmt: skip
