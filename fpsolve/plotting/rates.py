"""The rate of convergence against the noise: integrals, branches, bounds, variances."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve.plotting.ergodicity import symbol
from fpsolve.plotting.logarithmic import legend_with_room, plain_numbers
from fpsolve.plotting.selection import check_dataset, check_datasets, potential_of
from fpsolve.plotting.spectrum import sector_label
from fpsolve.plotting.style import COLOURS, COLUMN, MARKERS, PAGE, drawing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_asymptotic_variance", "plot_inverse_decay_rate", "plot_rates"]

_LOG_LOG: dict[str, Any] = {"xscale": "log", "yscale": "log", "xlabel": "noise $A$"}
_COLOURS = [COLOURS[name] for name in ("blue", "vermilion", "green", "orange")]
_CIRCLES: dict[str, Any] = {
    "marker": "o", "markerfacecolor": "white", "linestyle": "none",
    "elinewidth": 0.9, "capsize": 1.5,
}  # fmt: skip
_SECTOR_COLOURS = ("vermilion", "green", "blue", "orange")
# Below this a variance is that of a derivative along the path: zero.
_VANISHING = 1e-8


def plot_inverse_decay_rate(datasets: xr.Dataset | Iterable[xr.Dataset]) -> Figure:
    """Inverse decay rate I = ∫₀^S H ds against A, as in figure 5.

    Circles: runs on grids with their errors, the bound of the tail beyond S included
    upwards; line: `spectral_solve`, where it is known; a star at the least.

    Parameters
    ----------
    datasets : xarray.Dataset or iterable of them
        From `rate_versus_noise`; one for each potential.

    References
    ----------
    [KMW09]_, figure 5.
    """
    listed = check_datasets(datasets)
    _require(listed, "inverse_decay_rate", "relaxation")
    with drawing(COLUMN, 2.8) as figure:
        axes = figure.subplots()
        for dataset, colour in zip(listed, _COLOURS, strict=False):
            _draw_integral(axes, dataset, colour)
        axes.set(**_LOG_LOG, ylabel=r"$I = \int_0^S H(p(s)\,|\,p_S)\,\mathrm{d}s$")
        _plain_ticks(axes)
        axes.legend(loc="upper center")
    return figure


def plot_rates(dataset: xr.Dataset, *, runs: xr.Dataset | None = None) -> Figure:
    """Spectral gap with its branches, measured rates, bounds and asymptotes.

    Lines: leading eigenvalues by sector, the gap drawn heavy; circles: half the decay
    rate of H in runs, with errors; dashed: asymptotes; shaded: what the proven bounds
    leave out.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rate_versus_noise`, with the part "gap" or "branches"; branches look best
        at many noises, which costs little.
    runs : xarray.Dataset, optional
        Where the runs come from, if not from the same Dataset.
    """
    check_dataset("dataset", dataset)
    if "gap" not in dataset and "branch_rate" not in dataset:
        _require([dataset], "gap", "gap")
    with drawing(PAGE, 3.6) as figure:
        axes = figure.subplots()
        theory = _theory(dataset)
        _draw_bounds(axes, theory)
        _draw_branches(axes, dataset)
        _draw_asymptotes(axes, theory)
        _draw_runs(axes, dataset if runs is None else runs)
        axes.set(
            **_LOG_LOG,
            ylim=_limits(dataset),
            ylabel=r"rate $-\mathrm{Re}\,\lambda$",
            title=_potential(dataset),
        )
        _plain_ticks(axes)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), borderaxespad=0.2)
    return figure


def plot_asymptotic_variance(dataset: xr.Dataset) -> Figure:
    """Asymptotic variance of time averages against A, beside the shape of (12).

    Markers: −2⟨f, L⁻¹f⟩/Var f; dashed: (c₁c₂/A + c₁c₃A)², fitted. A function whose
    variance is zero is left out.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rate_versus_noise`, with the part "variance".
    """
    check_dataset("dataset", dataset)
    _require([dataset], "asymptotic_variance", "variance")
    looks = zip(cycle(_COLOURS), cycle(MARKERS), strict=True)
    with drawing(COLUMN, 2.8) as figure:
        axes = figure.subplots()
        for name in dataset["function"].to_numpy():
            one = dataset.sel(function=name)
            if np.nanmax(one["asymptotic_variance"]) < _VANISHING:
                continue
            _draw_variance(axes, one, str(name), *next(looks))
        axes.set(
            **_LOG_LOG,
            ylabel=r"$-2\langle f, L^{-1} f\rangle \,/\, \mathrm{Var} f$",
            title=_potential(dataset),
        )
        legend_with_room(axes)
        _plain_ticks(axes)
    return figure


def _require(datasets: list[xr.Dataset], variable: str, part: str) -> None:
    for dataset in datasets:
        if variable not in dataset:
            known = ", ".join(map(str, dataset))
            raise ValueError(
                f'`dataset` must hold "{variable}", got {known}; '
                f'ask `rate_versus_noise` for the part "{part}".'
            )


def _draw_integral(axes: Axes, dataset: xr.Dataset, colour: str) -> None:
    noise, title = dataset["noise"].to_numpy(), _potential(dataset)
    values = dataset["inverse_decay_rate"].to_numpy()
    error = dataset["inverse_decay_rate_error"].to_numpy()
    spread = [error, error + np.nan_to_num(dataset["tail_bound"].to_numpy())]
    axes.plot(noise, values, color=colour, linewidth=0.6, alpha=0.5)
    axes.errorbar(
        noise, values, spread, color=colour, markersize=3.5, label=f"{title}, grid",
        **_CIRCLES,
    )  # fmt: skip
    if "spectral_inverse_decay_rate" in dataset:
        found = dataset["spectral_inverse_decay_rate"]
        label = f"{title}, spectral"
        axes.plot(noise, found, "x", color=colour, markersize=3.5, label=label)
    if np.isfinite(values).any():
        least = int(np.nanargmin(values))
        axes.plot(noise[least], values[least], "*", color=colour, markersize=8)


def _theory(dataset: xr.Dataset) -> dict[str, np.ndarray]:
    """Bounds and asymptotes at many noises, where the potential can be made again."""
    from fpsolve.studies.rates.dataset import theory_curves

    noise, potential = dataset["noise"].to_numpy(), potential_of(dataset)
    if potential is None:
        names = ("hypocoercive_bound", "averaging_bound", "small_noise_asymptote",
                 "large_noise_asymptote")  # fmt: skip
        return {"noise": noise, **{name: dataset[name].to_numpy() for name in names}}
    fine = np.geomspace(noise.min(), noise.max(), 60)
    curves = theory_curves(potential, fine)
    return {"noise": fine, **{name: values for name, (values, _) in curves.items()}}


def _draw_bounds(axes: Axes, theory: dict[str, np.ndarray]) -> None:
    noise, proven = theory["noise"], theory["hypocoercive_bound"]
    if np.isfinite(proven).any():
        axes.fill_between(
            noise, 1e-12, proven, color="0.88", linewidth=0, label="below proven bound"
        )
        axes.plot(noise, proven, color="0.5", linewidth=0.8)
    _draw_known(
        axes, noise, theory["averaging_bound"], "-.", color=COLOURS["purple"],
        linewidth=0.9, label="theorem 3.3, at most",
    )  # fmt: skip


def _draw_branches(axes: Axes, dataset: xr.Dataset) -> None:
    noise = dataset["noise"].to_numpy()
    if "branch_rate" in dataset:
        for sector, name in zip(dataset["sector"].to_numpy(), _SECTOR_COLOURS,
                                strict=False):  # fmt: skip
            rates = dataset["branch_rate"].sel(sector=sector).to_numpy()
            labels = [sector_label(str(sector)), *[None] * (rates.shape[1] - 1)]
            for rate, label in zip(rates.T, labels, strict=True):
                looks = {"color": COLOURS[name], "linewidth": 1.1, "label": label}
                _draw_known(axes, noise, rate, **looks)
        _draw_known(axes, noise, dataset["essential_rate"], ":",
                    color=COLOURS["black"], label="essential spectrum")  # fmt: skip
    if "gap" in dataset:
        axes.plot(
            noise, dataset["gap"], color=COLOURS["black"], linewidth=3.0, alpha=0.25,
            solid_capstyle="round", label="spectral gap",
        )  # fmt: skip


def _draw_asymptotes(axes: Axes, theory: dict[str, np.ndarray]) -> None:
    looks: dict[str, Any] = {"color": "0.2", "linewidth": 1.0}
    small, large = theory["small_noise_asymptote"], theory["large_noise_asymptote"]
    _draw_known(axes, theory["noise"], small, "--", label=r"$A^2/2$", **looks)
    _draw_known(axes, theory["noise"], large, linestyle=(0, (1, 1)),
                label=r"$\Lambda/A^2 + \ldots$", **looks)  # fmt: skip


def _draw_known(axes: Axes, noise: Any, rates: Any, *form: str, **looks: Any) -> None:
    """Draw a curve, unless it is nowhere known."""
    if np.isfinite(rates).any():
        axes.plot(noise, rates, *form, **looks)


def _draw_runs(axes: Axes, dataset: xr.Dataset) -> None:
    if "entropy_rate" not in dataset:
        return
    rate, error = dataset["entropy_rate"] / 2, dataset["entropy_rate_error"] / 2
    axes.errorbar(
        dataset["noise"], rate, error, color=COLOURS["black"], markersize=4, zorder=5,
        label="half the decay rate of $H$, runs", **_CIRCLES,
    )  # fmt: skip


def _limits(dataset: xr.Dataset) -> tuple[float, float]:
    """Around the gap, with room for the nearest branches and the bounds."""
    names = ("gap", "entropy_rate", "branch_rate")
    name = next(one for one in names if one in dataset)
    values = dataset[name].to_numpy()
    finite = values[np.isfinite(values) & (values > 0)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.1, 1)
    return 0.08 * low, 4.0 * high


def _draw_variance(
    axes: Axes, dataset: xr.Dataset, name: str, colour: str, marker: str
) -> None:
    noise = dataset["noise"].to_numpy()
    axes.errorbar(
        noise, dataset["asymptotic_variance"].to_numpy(),
        dataset["asymptotic_variance_error"].to_numpy(), color=colour, marker=marker,
        markersize=3.5, linestyle="none", elinewidth=0.8, label=symbol(name),
    )  # fmt: skip
    fine = np.geomspace(noise.min(), noise.max(), 200)
    shape = float(dataset["shape_small"]) / fine + float(dataset["shape_large"]) * fine
    axes.plot(fine, shape**2, "--", color=colour, linewidth=0.9)


def _potential(dataset: xr.Dataset) -> str:
    return f"$B$ = {dataset.attrs['formula']}"


def _plain_ticks(axes: Axes) -> None:
    for axis in (axes.xaxis, axes.yaxis):
        plain_numbers(axis, (1, 2, 5), 200)
