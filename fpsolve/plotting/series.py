"""Numbers over s with their errors: of expansions, and of paths of the limits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.selection import evenly
from fpsolve.plotting.style import COLOURS, LINES, PAGE, drawing, parameters
from fpsolve.reduced.energy.sampling import EnergyPaths
from fpsolve.reduced.hydrodynamic.sampling import HydrodynamicPaths
from fpsolve.spectral.evolution.smooth_solution import SmoothSpectralSolution
from fpsolve.spectral.evolution.solution import SpectralSolution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = [
    "plot_energy_paths",
    "plot_hydrodynamic_paths",
    "plot_smooth_spectral",
    "plot_spectral",
]

_MEANS = {
    "mean_xi1": r"$E\,\xi_1$", "mean_xi2": r"$E\,\xi_2$",
    "mean_cos_alpha": r"$E\cos\alpha$", "mean_sin_alpha": r"$E\sin\alpha$",
}  # fmt: skip
_VARIANCES = {
    "variance_xi1": r"$\mathrm{Var}\,\xi_1$", "variance_xi2": r"$\mathrm{Var}\,\xi_2$",
}  # fmt: skip
_SMOOTH_MEANS = {
    "mean_xi1": r"$E\,\xi_1$", "mean_xi2": r"$E\,\xi_2$",
    "mean_cos_alpha": r"$E\cos\alpha$", "mean_kappa": r"$E\,\kappa$",
}  # fmt: skip
_MOST_LAWS = 5
_BINS = 60


def plot_spectral(solution: SpectralSolution) -> Figure:
    """H(p|p_S) over s, logarithmic, and means; bars: the estimated errors.

    Parameters
    ----------
    solution : SpectralSolution
    """
    check_kind("solution", solution, SpectralSolution, "see `spectral_solve`")
    with drawing(PAGE, 2.8, parameters(solution)) as figure:
        entropy, means = figure.subplots(1, 2)
        _draw(entropy, solution.s, solution.relative_entropy,
              solution.errors["relative_entropy"], COLOURS["blue"], "$H$")  # fmt: skip
        if (solution.relative_entropy > 0).all():
            entropy.set_yscale("log")
        entropy.set_ylabel(r"$H(p\,|\,p_S)$")
        for (name, label), colour in zip(_MEANS.items(), LINES, strict=False):
            _draw(means, solution.s, solution.series[name], solution.errors[name],
                  colour, label)  # fmt: skip
        means.legend(loc="best")
    return figure


def plot_smooth_spectral(solution: SmoothSpectralSolution) -> Figure:
    """Variances of ξ, and means, over s; bars: the estimated errors.

    Parameters
    ----------
    solution : SmoothSpectralSolution
    """
    check_kind("solution", solution, SmoothSpectralSolution, "see `spectral_solve`")
    with drawing(PAGE, 2.8, parameters(solution)) as figure:
        for axes, labelled in zip(
            figure.subplots(1, 2), (_VARIANCES, _SMOOTH_MEANS), strict=True
        ):
            for (name, label), colour in zip(labelled.items(), LINES, strict=False):
                _draw(axes, solution.s, solution.series[name], solution.errors[name],
                      colour, label)  # fmt: skip
            axes.legend(loc="best")
    return figure


def plot_hydrodynamic_paths(paths: HydrodynamicPaths) -> Figure:
    """E ξ and Var ξ over s; bars: standard errors.

    Parameters
    ----------
    paths : HydrodynamicPaths
    """
    check_kind("paths", paths, HydrodynamicPaths, "see HydrodynamicLimit.sample")
    (mean, mean_error), (spread, spread_error) = paths.mean(), paths.covariance()
    with drawing(PAGE, 2.8, parameters(paths)) as figure:
        left, right = figure.subplots(1, 2)
        for axis, colour in zip((0, 1), LINES, strict=False):
            name = rf"\xi_{axis + 1}"
            _draw(left, paths.s, mean[:, axis], mean_error[:, axis], colour,
                  rf"$E\,{name}$")  # fmt: skip
            _draw(right, paths.s, spread[:, axis, axis], spread_error[:, axis, axis],
                  colour, rf"$\mathrm{{Var}}\,{name}$")  # fmt: skip
        left.legend(loc="best")
        right.legend(loc="best")
    return figure


def plot_energy_paths(paths: EnergyPaths) -> Figure:
    """Histograms of signed G at some saved s; dashed: the stationary density.

    Parameters
    ----------
    paths : EnergyPaths
    """
    check_kind("paths", paths, EnergyPaths, "see EnergyProcess.sample")
    process = paths.process
    largest = float(np.abs(paths.g).max()) if process is None else process.g_max
    with drawing(PAGE, 2.8) as figure:
        axes = figure.subplots()
        rows = evenly(paths.s.size, _MOST_LAWS)
        for row, colour in zip(rows, LINES, strict=False):
            counts, ends = np.histogram(paths.g[row], _BINS, (-largest, largest), True)
            axes.stairs(counts, ends, color=colour, label=f"$s = {paths.s[row]:g}$")
        if process is not None:
            g = process.g_max * np.sin(np.linspace(0.02, np.pi / 2, 200)) ** 2
            law = 0.5 * process.stationary_density(g)
            for sign in (-1, 1):
                axes.plot(sign * g, law, "--", color="0.4", linewidth=0.8)
        axes.set(xlabel="$G$", ylabel="density")
        axes.legend(loc="best")
    return figure


def _draw(
    axes: Axes,
    s: NDArray[np.float64],
    values: NDArray[np.float64],
    errors: NDArray[np.float64],
    colour: str,
    label: str,
) -> None:
    axes.errorbar(s, values, yerr=errors, color=colour, label=label,
                  marker=".", capsize=2.0)  # fmt: skip
    axes.set_xlabel("$s$")
