"""The energy process: orbits, coefficients, the law on its way, eigenfunctions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import check_kind
from fpsolve.plotting.selection import evenly
from fpsolve.plotting.style import COLOURS, DENSITY_MAP, PAGE, drawing, formula
from fpsolve.reduced.energy.process import EnergyProcess
from fpsolve.reduced.energy.solution import EnergySolution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "plot_energy_coefficients",
    "plot_energy_eigenfunctions",
    "plot_energy_law",
    "plot_orbits",
]

# Energies of the orbits drawn, in shares of g_max, and of the fibres beside them.
_SHARES = (0.02, 0.1, 0.25, 0.45, 0.65, 0.85, 0.97)
_FIBRES = ((0.02, "purple"), (0.25, "vermilion"), (0.85, "green"))
_N_PERIODS = 7
# Densities are drawn down to this share of g_max: at 0 they are infinite.
_LOWEST = 1e-4
_SEQUENCE = ("blue", "vermilion", "green", "orange", "purple", "sky")


def plot_orbits(process: EnergyProcess) -> Figure:
    """Orbits of (13) in the (r, β)-plane, as in figure 6, and fibres that follow three.

    Lines: level sets of G = r exp(-B) sin β, coloured by G/g_max; cross: the fixed
    point, the circle r B'(r) = 1. Right: ξ along some periods of the three orbits with
    the same colours; dashed: the circle.

    Parameters
    ----------
    process : EnergyProcess

    References
    ----------
    [KMW09]_, figure 6.
    """
    _check(process)
    with drawing(PAGE, 3.5, _title(process, noise=False)) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
        _draw_orbits(figure, left, process)
        _draw_fibres(right, process)
    return figure


def plot_energy_coefficients(process: EnergyProcess) -> Figure:
    """Period S, variance σ² and stationary density of |G| against g.

    Parameters
    ----------
    process : EnergyProcess
    """
    _check(process)
    g = _energies(process)
    with drawing(PAGE, 2.5, _title(process)) as figure:
        period, variance, density = figure.subplots(1, 3)
        inside = g >= _LOWEST * process.g_max
        period.plot(g[inside], process.period(g[inside]), color=COLOURS["blue"])
        period.set_ylabel(r"period $S(g)$")
        bound = process.noise**2 * (process.g_max**2 - g**2)
        variance.plot(g, bound, "--", color="0.6", linewidth=0.9,
                      label=r"$A^2(g_{\max}^2 - g^2)$")  # fmt: skip
        variance.plot(g, process.variance(g), color=COLOURS["vermilion"],
                      label=r"$\sigma^2(g)$")  # fmt: skip
        variance.set_ylabel(r"variance per unit of $s$")
        variance.legend(loc="upper right")
        law = process.stationary_density(g[inside])
        density.plot(g[inside], law, color=COLOURS["green"])
        density.set_ylabel(r"stationary density of $|G|$")
        for axes in (period, variance, density):
            axes.set(xlabel="energy $g$", xlim=(0, 1.02 * process.g_max))
            axes.set_ylim(bottom=0)
    return figure


def plot_energy_law(solution: EnergySolution) -> Figure:
    """Densities p(g, s) at the saved arclengths, and the entropy over s.

    Dashed: the stationary density. Six arclengths at most.

    Parameters
    ----------
    solution : EnergySolution
    """
    check_kind("solution", solution, EnergySolution, "see EnergyProcess.solve")
    with drawing(PAGE, 3.0, _title(solution.process)) as figure:
        law, entropy = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        _draw_law(law, solution)
        _draw_entropy(entropy, solution)
    return figure


def plot_energy_eigenfunctions(process: EnergyProcess, n: int = 4) -> Figure:
    """Eigenfunctions u(g) of both families, with their decay rates.

    Parameters
    ----------
    process : EnergyProcess
    n : int
        How many of each family, at most six.
    """
    _check(process)
    if not 1 <= n <= len(_SEQUENCE):
        raise ValueError(f"`n` must be from 1 to {len(_SEQUENCE)}, got {n}.")
    g = _energies(process)
    with drawing(PAGE, 2.9, _title(process)) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, family in zip(panels, ("even", "odd"), strict=True):
            _draw_family(axes, process.spectrum(n, family), g)
        panels[0].set_ylabel("eigenfunction $u(g)$")
    return figure


def _check(process: Any) -> None:
    check_kind("process", process, EnergyProcess, "EnergyProcess(potential, noise)")


def _energies(process: EnergyProcess) -> np.ndarray:
    """A sequence that crowds at both ends, where the curves are steep."""
    crowded: np.ndarray = np.sin(np.linspace(0, np.pi / 2, 301)) ** 2
    return process.g_max * crowded


def _title(process: EnergyProcess | None, noise: bool = True) -> str:
    if process is None:
        return r"$B$ from the user's own functions"
    title = f"$B =$ {formula(process.potential)}"
    title += rf",  $g_{{\max}} = {process.g_max:.4g}$"
    return rf"{title},  $A = {process.noise:g}$" if noise else title


def _draw_orbits(figure: Figure, axes: Axes, process: EnergyProcess) -> None:
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap

    # The lightest tenth of the map is too pale for a line.
    shade = colormaps[DENSITY_MAP]
    for share in _SHARES:
        axes.plot(*_level_curve(process, share), color=shade(0.9 * share))
    axes.plot(process.radius, np.pi / 2, "+", color=COLOURS["black"], markersize=7,
              label="fixed point")  # fmt: skip
    axes.set(xlabel="distance $r$", ylabel=r"angle to the radius $\beta$")
    axes.set_xlim(left=0)
    axes.set_ylim(0, np.pi)
    axes.set_yticks([0, np.pi / 2, np.pi], ["0", r"$\pi/2$", r"$\pi$"])
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    shortened = ListedColormap(shade(np.linspace(0.0, 0.9, 256)))
    levels = ScalarMappable(cmap=shortened)
    bar = figure.colorbar(levels, ax=axes, pad=0.02, aspect=25)
    bar.set_label(r"$G / g_{\max}$")
    bar.set_ticks(list(_SHARES), labels=[f"{share:g}" for share in _SHARES])


def _level_curve(process: EnergyProcess, share: float) -> tuple[Any, Any]:
    """(r, β) where r exp(-B(r)) sin β is that share of g_max, a closed curve."""
    ends = np.log(process.turning_points(share * process.g_max))
    # From the largest distance to the smallest and back, without a kink at the ends.
    turn = np.linspace(0, 2 * np.pi, 401)
    r = np.exp(np.mean(ends) + 0.5 * (ends[1] - ends[0]) * np.cos(turn))
    weight = r * np.exp(-process.potential.radial_value(r))
    sine = np.minimum(share * process.g_max / weight, 1.0)
    return r, np.where(turn < np.pi, np.pi - np.arcsin(sine), np.arcsin(sine))


def _draw_fibres(axes: Axes, process: EnergyProcess) -> None:
    for share, colour in _FIBRES:
        xi = _rosette(process, share)
        axes.plot(xi[:, 0], xi[:, 1], color=COLOURS[colour], linewidth=0.8,
                  label=rf"$G = {share:g}\,g_{{\max}}$")  # fmt: skip
    turn = np.linspace(0, 2 * np.pi, 201)
    axes.plot(process.radius * np.cos(turn), process.radius * np.sin(turn), "--",
              color=COLOURS["black"], linewidth=0.8)  # fmt: skip
    axes.set(aspect="equal", xlabel=r"$\xi_1$", ylabel=r"$\xi_2$")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), borderaxespad=0.2,
                ncols=3, columnspacing=1.2)  # fmt: skip


def _rosette(process: EnergyProcess, share: float) -> np.ndarray:
    """(ξ1, ξ2) over some periods: each is the first, turned."""
    orbit = process.orbit(share * process.g_max, 201)
    turns = orbit.phi[-1] * np.arange(_N_PERIODS)
    phi = (turns[:, None] + orbit.phi).ravel()
    r = np.tile(orbit.r, _N_PERIODS)
    return np.column_stack([r * np.cos(phi), r * np.sin(phi)])


def _draw_law(axes: Axes, solution: EnergySolution) -> None:
    from matplotlib import colormaps

    grid = solution.grid
    wanted = evenly(len(solution.saved_s), 6)
    shade = colormaps[DENSITY_MAP]
    for place, index in enumerate(wanted):
        colour = shade(0.9 * place / max(len(wanted) - 1, 1))
        axes.stairs(
            solution.densities[index], grid.faces, color=colour, baseline=None,
            linewidth=1.2, label=f"$s = {solution.saved_s[index]:g}$",
        )  # fmt: skip
    stationary = grid.equilibrium / grid.widths
    axes.stairs(stationary, grid.faces, baseline=None, linestyle="--",
                color=COLOURS["black"], linewidth=0.9, label="stationary")  # fmt: skip
    later = solution.densities[wanted[1:]] if len(wanted) > 1 else stationary
    # A start in one cell would leave nothing to see of the rest.
    axes.set_ylim(0, 1.3 * max(float(np.max(later)), float(np.median(stationary))))
    lowest = -grid.g_max if grid.signed else 0.0
    axes.set(xlim=(lowest, grid.g_max), xlabel="energy $g$", ylabel="density $p(g, s)$")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.2)


def _draw_entropy(axes: Axes, solution: EnergySolution) -> None:
    entropy = solution.relative_entropy
    shown = entropy > 0
    axes.plot(solution.s[shown], entropy[shown], color=COLOURS["blue"])
    axes.set(yscale="log", xlabel="arclength $s$", ylabel="relative entropy $H$")


def _draw_family(axes: Axes, found: Any, g: np.ndarray) -> None:
    for index, value in enumerate(found.eigenvalues):
        axes.plot(g, found.eigenfunction(index, g), color=COLOURS[_SEQUENCE[index]],
                  label=rf"$\lambda = {value:.4g}$")  # fmt: skip
    axes.axhline(0, color="0.8", linewidth=0.6, zorder=0)
    title = {"even": "even: $|G|$", "odd": "odd: sign of $G$"}[found.family]
    axes.set(xlim=(0, 1.02 * g[-1]), xlabel="energy $g$", title=title)
    axes.legend(loc="upper left", ncols=2)
