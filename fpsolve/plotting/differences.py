"""Where two results differ, and whether their errors explain it."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.plotting.logarithmic import noise_ticks
from fpsolve.plotting.selection import evenly
from fpsolve.plotting.style import COLOURS, PAGE, drawing
from fpsolve.results.compare.comparison import Comparison, verdict
from fpsolve.results.compare.differences import FLOOR

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_comparison"]


# What a line is drawn against, the first that there is.
_AXES = {
    "s_step": "$s$",
    "s": "$s$",
    "noise": "noise $A$",
    "index": "number of the eigenvalue",
    "g": "energy $g$",
}
_AXIS_NAMES = {"xi1": r"$\xi_1$", "xi2": r"$\xi_2$", "alpha": r"$\alpha$"}
# Shown before others that differ more.
_FIRST = ("relative_entropy", "mean_xi1", "variance_xi1", "mass")
# Tables of all kinds of things, and what is shown in panels of its own.
_NO_LINES = ("density", "cell_mass", "states", "counts", "xi", "tau", "turns", "kappa",
             "alpha", "moment_sums")  # fmt: skip
_MOST_LINES, _MOST_ARCLENGTHS, _FEW = 5, 4, 10
_HEIGHT, _DIFFERENCES = 3.0, "RdBu_r"
_LINES = ("blue", "vermilion", "green", "purple", "orange", "sky")


def plot_comparison(comparison: Comparison) -> Figure:
    """B − A: marginals of the density, and |B − A| of all else with its error.

    The map is ∫ (p_B − p_A) dα where the L¹ distance is largest. Solid lines are
    |B − A|, the largest over what is not on the axis; dashed lines are the estimated
    errors of A and B together, or the standard error of the difference.

    Parameters
    ----------
    comparison : Comparison
        From `fpsolve.compare`.

    Raises
    ------
    TypeError
        If it is something else.
    """
    check_kind("comparison", comparison, Comparison, "it is what `compare` returns")
    dataset, (a, b) = comparison.dataset, comparison.names
    known = set(dataset["density"].dims) if "density" in dataset else set()
    panels = [_draw_map] if {"xi1", "xi2"} <= known else []
    panels += [_draw_profiles] if known else []
    panels += [_draw_lines]
    wrapped = verdict(comparison).replace("; ", "\n")
    with drawing(PAGE, _HEIGHT, f"A = {a}, B = {b}\n{wrapped}") as figure:
        columns = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, draw in zip(columns, panels, strict=True):
            draw(axes, dataset)
    return figure


def _draw_map(axes: Axes, dataset: xr.Dataset) -> None:
    """∫ (p_B − p_A) dα in the plane."""
    density, worst = dataset["density"], _worst(dataset)
    plane = _integrated(density.isel(s=worst), "alpha").transpose("xi2", "xi1")
    most = float(np.abs(plane).max()) or 1.0
    image = axes.pcolormesh(
        plane["xi1"], plane["xi2"], plane, cmap=_DIFFERENCES, vmin=-most, vmax=most,
        rasterized=True,
    )  # fmt: skip
    bar = axes.figure.colorbar(image, ax=axes, shrink=0.8)
    bar.ax.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes.set_aspect("equal")
    _limit_to_difference(axes, plane)
    axes.set(xlabel=r"$\xi_1$", ylabel=r"$\xi_2$")
    axes.set_title(f"B − A at $s = {float(density['s'][worst]):g}$")


def _limit_to_difference(axes: Axes, plane: xr.DataArray) -> None:
    """Cut off the margin in which nothing differs."""
    seen = np.abs(plane) > 1e-3 * np.abs(plane).max()
    for axis, other, limit in (("xi1", "xi2", axes.set_xlim),
                               ("xi2", "xi1", axes.set_ylim)):  # fmt: skip
        places = plane[axis].to_numpy()[seen.any(other).to_numpy()]
        if places.size > 1:
            limit(places.min(), places.max())


def _draw_profiles(axes: Axes, dataset: xr.Dataset) -> None:
    """Differences of the marginals in α, or of densities of one variable, at some s."""
    density = dataset["density"]
    along = next(name for name in ("alpha", "g", "xi1") if name in density.dims)
    others = [axis for axis in ("xi1", "xi2") if axis != along]
    rows = evenly(density.sizes["s"], _MOST_ARCLENGTHS)
    for colour, row in zip(_LINES, rows, strict=False):
        one = reduce(_integrated, others, density.isel(s=row))
        label = f"$s = {float(density['s'][row]):g}$"
        axes.plot(one[along], one, color=COLOURS[colour], label=label)
    axes.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    axes.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes.set(xlabel=_AXIS_NAMES.get(along, "$g$"), ylabel="B − A of the marginal")
    axes.legend()


def _draw_lines(axes: Axes, dataset: xr.Dataset) -> None:
    """|B − A| of the series, or of the numbers of a study, with their errors."""
    along, chosen = _lines(dataset)
    if not chosen:
        axes.text(0.5, 0.5, "no number differs", ha="center", va="center")
        axes.set_axis_off()
        return
    for colour, name in zip(_LINES, chosen, strict=False):
        x, apart = _largest(dataset, name, along)
        marks, label = ".-" if len(x) < 30 else "-", name.replace("_", " ")
        axes.plot(x, apart, marks, color=COLOURS[colour], label=label)
        if f"{name}_error" in dataset:
            x, error = _largest(dataset, f"{name}_error", along)
            axes.plot(x, error, "--", color=COLOURS[colour], linewidth=0.9)
    axes.set_yscale("log")
    if along == "noise":
        axes.set_xscale("log")
        # If they are few, the noises themselves are the ticks.
        if dataset.sizes["noise"] < _FEW:
            noise_ticks(axes, dataset["noise"].to_numpy())
    errors = any(f"{name}_error" in dataset for name in chosen)
    title = "|B − A|, dashed: errors" if errors else "|B − A|"
    axes.set(xlabel=_AXES[along], title=title)
    axes.legend(fontsize=7, loc="best")


def _lines(dataset: xr.Dataset) -> tuple[str, list[str]]:
    """What to draw against, and the names of the lines."""
    for along in _AXES:
        found = {
            str(name): float(np.nanmax(np.abs(values), initial=0.0))
            for name, values in dataset.data_vars.items()
            if along in values.dims
            and name not in _NO_LINES
            and not str(name).endswith("_error")
        }
        found = {name: apart for name, apart in found.items() if 0 < apart < np.inf}
        # Rounding is shown only if there is nothing else.
        seen = {name: apart for name, apart in found.items() if apart > FLOOR}
        found = seen or found
        if found:
            order = sorted(found, key=lambda name: (name not in _FIRST, -found[name]))
            return along, order[:_MOST_LINES]
    return "s", []


def _largest(dataset: xr.Dataset, name: str, along: str) -> tuple[Array, Array]:
    """|values|, the largest over all else; zeros are gaps on a logarithmic axis."""
    values = dataset[name]
    others = tuple(n for n, axis in enumerate(values.dims) if axis != along)
    most = np.abs(values.to_numpy()).max(axis=others)
    return dataset[along].to_numpy(), np.where(most > 0, most, np.nan)


def _worst(dataset: xr.Dataset) -> int:
    """Row of the largest L1 distance."""
    if "density_l1" not in dataset:
        return dataset.sizes["s"] - 1
    return int(np.argmax(dataset["density_l1"].to_numpy()))


def _integrated(values: xr.DataArray, axis: str) -> xr.DataArray:
    if axis not in values.dims:
        return values
    step = float(np.diff(values[axis].to_numpy()[:2])[0])
    return values.sum(axis) * step
