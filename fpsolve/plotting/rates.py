"""The rate of convergence against the noise: integrals, branches, bounds, variances."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from fpsolve.plotting.ergodicity import _symbol
from fpsolve.plotting.selection import check_dataset, check_datasets, check_spectrum
from fpsolve.plotting.style import COLOURS, COLUMN, PAGE, new_figure, paper_style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fpsolve.spectral.eigen.spectrum import Spectrum

__all__ = [
    "plot_asymptotic_variance",
    "plot_inverse_decay_rate",
    "plot_rates",
    "plot_spectrum",
]

_SECTOR_COLOURS = ("vermilion", "green", "blue", "orange")
_MARKERS = "osD^vP"
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

    Returns
    -------
    matplotlib.figure.Figure

    References
    ----------
    [KMW09]_, figure 5.
    """
    listed = check_datasets(datasets)
    _require(listed, "inverse_decay_rate", "relaxation")
    with paper_style():
        figure = new_figure(COLUMN, 2.8)
        axes = figure.subplots()
        for dataset, colour in zip(
            listed, ("blue", "vermilion", "green"), strict=False
        ):
            _draw_integral(axes, dataset, COLOURS[colour])
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel(r"noise $A$")
        axes.set_ylabel(r"$I = \int_0^S H(p(s)\,|\,p_S)\,\mathrm{d}s$")
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

    Returns
    -------
    matplotlib.figure.Figure
    """
    check_dataset("dataset", dataset)
    if "gap" not in dataset and "branch_rate" not in dataset:
        _require([dataset], "gap", "gap")
    with paper_style():
        figure = new_figure(PAGE, 3.6)
        axes = figure.subplots()
        theory = _theory(dataset)
        _draw_bounds(axes, theory)
        _draw_branches(axes, dataset)
        _draw_asymptotes(axes, theory)
        _draw_runs(axes, dataset if runs is None else runs)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylim(*_limits(dataset))
        axes.set_xlabel(r"noise $A$")
        axes.set_ylabel(r"rate $-\mathrm{Re}\,\lambda$")
        axes.set_title(_potential(dataset))
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

    Returns
    -------
    matplotlib.figure.Figure
    """
    check_dataset("dataset", dataset)
    _require([dataset], "asymptotic_variance", "variance")
    with paper_style():
        figure = new_figure(COLUMN, 2.8)
        axes = figure.subplots()
        colours = [COLOURS[name] for name in ("blue", "vermilion", "green", "orange")]
        drawn = 0
        for name in dataset["function"].to_numpy():
            one = dataset.sel(function=name)
            if np.nanmax(one["asymptotic_variance"]) < _VANISHING:
                continue
            _draw_variance(
                axes, one, str(name), colours[drawn % 4], _MARKERS[drawn % 6]
            )
            drawn += 1
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel(r"noise $A$")
        axes.set_ylabel(r"$-2\langle f, L^{-1} f\rangle \,/\, \mathrm{Var} f$")
        axes.set_title(_potential(dataset))
        if drawn:
            axes.legend(loc="upper center", ncols=2)
            bottom, top = axes.get_ylim()
            axes.set_ylim(bottom, top * (top / bottom) ** 0.3)
        _plain_ticks(axes)
    return figure


def plot_spectrum(found: Spectrum) -> Figure:
    """Eigenvalues in the complex plane, by sector, and where the gap ends.

    Parameters
    ----------
    found : Spectrum

    Returns
    -------
    matplotlib.figure.Figure
    """
    check_spectrum(found)
    with paper_style():
        figure = new_figure(COLUMN, 2.8)
        axes = figure.subplots()
        names = list(dict.fromkeys(str(sector) for sector in found.sectors))
        colours = [colour for name, colour in COLOURS.items() if name != "black"]
        for place, name in enumerate(names):
            own = [str(sector) == name for sector in found.sectors]
            values = found.eigenvalues[np.array(own)]
            axes.plot(
                values.real, values.imag, linestyle="none", label=_sector_label(name),
                marker=_MARKERS[place % len(_MARKERS)], markersize=4.5,
                color=colours[place % len(colours)],
            )  # fmt: skip
        axes.plot(0, 0, "o", color=COLOURS["black"], markersize=4, label="stationary")
        axes.axvline(-found.gap, color="0.6", linewidth=0.8, linestyle="--")
        if found.essential is not None:
            axes.axvline(found.essential, color="0.3", linewidth=0.8, linestyle=":",
                         label="essential spectrum from here")  # fmt: skip
        axes.set_xlabel(r"$\mathrm{Re}\,\lambda$")
        axes.set_ylabel(r"$\mathrm{Im}\,\lambda$")
        model = found.model
        axes.set_title(f"$B$ = {model.potential.formula},  $A$ = {model.noise:g}")
        bottom, top = axes.get_ylim()
        if top - bottom < 1e-6:
            axes.set_ylim(-0.5, 0.5)
        axes.legend(loc="best")
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
    noise = dataset["noise"].to_numpy()
    values = dataset["inverse_decay_rate"].to_numpy()
    error = dataset["inverse_decay_rate_error"].to_numpy()
    spread = [error, error + np.nan_to_num(dataset["tail_bound"].to_numpy())]
    axes.plot(noise, values, color=colour, linewidth=0.6, alpha=0.5)
    axes.errorbar(
        noise, values, spread, color=colour, marker="o", markersize=3.5,
        markerfacecolor="white", linestyle="none", elinewidth=0.9, capsize=1.5,
        label=f"{_potential(dataset)}, grid",
    )  # fmt: skip
    if "spectral_inverse_decay_rate" in dataset:
        found = dataset["spectral_inverse_decay_rate"].to_numpy()
        axes.plot(
            noise, found, color=colour, marker="x", markersize=3.5, linestyle="none",
            label=f"{_potential(dataset)}, spectral",
        )  # fmt: skip
    if np.isfinite(values).any():
        least = int(np.nanargmin(values))
        axes.plot(noise[least], values[least], "*", color=colour, markersize=8)


def _theory(dataset: xr.Dataset) -> dict[str, np.ndarray]:
    """Bounds and asymptotes at many noises, where the potential can be made again."""
    from fpsolve._support.declared import declared
    from fpsolve.model.potentials.dictionaries import potential_from_dict
    from fpsolve.studies.rates.dataset import theory_curves

    noise = dataset["noise"].to_numpy()
    try:
        potential = potential_from_dict(declared(dataset.attrs)["potential"])
    except ValueError:
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
    averaging = theory["averaging_bound"]
    if np.isfinite(averaging).any():
        axes.plot(
            noise, averaging, color=COLOURS["purple"], linewidth=0.9, linestyle="-.",
            label="theorem 3.3, at most",
        )  # fmt: skip


def _draw_branches(axes: Axes, dataset: xr.Dataset) -> None:
    noise = dataset["noise"].to_numpy()
    if "branch_rate" in dataset:
        for sector, name in zip(dataset["sector"].to_numpy(), _SECTOR_COLOURS,
                                strict=False):  # fmt: skip
            rates = dataset["branch_rate"].sel(sector=sector).to_numpy()
            for mode, rate in enumerate(rates.T):
                if np.isfinite(rate).any():
                    label = _sector_label(str(sector)) if mode == 0 else None
                    axes.plot(
                        noise, rate, color=COLOURS[name], linewidth=1.1, label=label
                    )
        essential = dataset["essential_rate"].to_numpy()
        if np.isfinite(essential).any():
            axes.plot(noise, essential, ":", color=COLOURS["black"],
                      label="essential spectrum")  # fmt: skip
    if "gap" in dataset:
        axes.plot(
            noise, dataset["gap"].to_numpy(), color=COLOURS["black"], linewidth=3.0,
            alpha=0.25, solid_capstyle="round", label="spectral gap",
        )  # fmt: skip


def _sector_label(sector: str) -> str:
    """The sector with its index in italics."""
    return sector.replace("M = ", "$M$ = ")


def _draw_asymptotes(axes: Axes, theory: dict[str, np.ndarray]) -> None:
    noise = theory["noise"]
    small, large = theory["small_noise_asymptote"], theory["large_noise_asymptote"]
    names = (r"$A^2/2$", r"$\Lambda/A^2 + \ldots$")
    for values, name, dash in zip(
        (small, large), names, ("--", (0, (1, 1))), strict=True
    ):
        if np.isfinite(values).any():
            axes.plot(noise, values, color="0.2", linewidth=1.0, linestyle=dash,
                      label=name)  # fmt: skip


def _draw_runs(axes: Axes, dataset: xr.Dataset) -> None:
    if "entropy_rate" not in dataset:
        return
    axes.errorbar(
        dataset["noise"].to_numpy(), dataset["entropy_rate"].to_numpy() / 2,
        dataset["entropy_rate_error"].to_numpy() / 2, color=COLOURS["black"],
        marker="o", markersize=4, markerfacecolor="white", linestyle="none",
        elinewidth=0.9, capsize=1.5, zorder=5, label="half the decay rate of $H$, runs",
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
        markersize=3.5, linestyle="none", elinewidth=0.8, label=_symbol(name),
    )  # fmt: skip
    fine = np.geomspace(noise.min(), noise.max(), 200)
    shape = float(dataset["shape_small"]) / fine + float(dataset["shape_large"]) * fine
    axes.plot(fine, shape**2, "--", color=colour, linewidth=0.9)


def _potential(dataset: xr.Dataset) -> str:
    return f"$B$ = {dataset.attrs['formula']}"


def _plain_ticks(axes: Axes) -> None:
    """Numbers like 0.2 and 30 along both axes instead of powers of ten."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        digits = [1, 2, 5] if high < 200 * low else [1]
        candidates = np.outer(10.0 ** np.arange(-9, 10), digits).ravel()
        inside = (candidates >= low) & (candidates <= high)
        axis.set_major_locator(FixedLocator(candidates[inside].tolist()))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())
