"""The decay of the relative entropy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fpsolve.density.solution import Solution
from fpsolve.evolution.decay import NOISE_LEVEL, DecayRate
from fpsolve.plotting.moments import show_lengths
from fpsolve.plotting.selection import check_solution
from fpsolve.plotting.style import COLOURS, COLUMN, drawing, parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_entropy", "fitted_rate", "has_entropy", "plot_entropy"]

# Powers of ten shown below the largest value, at most: what lies lower is rounding.
_DECADES = 16


def plot_entropy(solution: Solution) -> Figure:
    """H(p|p_S) and its dissipation (A²/2) ∫ p (∂_α ln(p/p_S))² on a logarithmic axis.

    What H tends to on the grid, `entropy_floor`, is subtracted, so that the decay is
    a straight line down to rounding. On a fixed belt the fitted rate λ and its
    standard error are in the legend; with error estimates a band of ± one estimate is
    drawn.

    Parameters
    ----------
    solution : Solution

    Raises
    ------
    ValueError
        If there is no relative entropy, because exp(-B) is not normalisable.
    """
    check_solution(solution)
    if not has_entropy(solution):
        raise ValueError(
            "`solution` must have a relative entropy to show, got none; exp(-B) has to "
            "be normalisable."
        )
    with drawing(COLUMN, 2.8, parameters(solution)) as figure:
        draw_entropy(figure.subplots(), solution)
    return figure


def draw_entropy(axes: Axes, solution: Solution) -> None:
    """Draw entropy, dissipation and fit into one panel."""
    s, excess = solution.series["s"], _excess(solution)
    axes.plot(s, _positive(excess), color=COLOURS["blue"], label=r"$H(p\,|\,p_S)$")
    _draw_band(axes, solution, excess)
    dissipation = _positive(solution.series["entropy_dissipation"])
    if np.isfinite(dissipation).any():
        axes.plot(s, dissipation, "--", color=COLOURS["orange"], label="dissipation")
    _draw_fit(axes, fitted_rate(solution))
    axes.set_yscale("log")
    _limit_decades(axes)
    show_lengths(axes, s)
    axes.set_ylabel("entropy and dissipation")
    axes.legend(borderaxespad=0.2)


def fitted_rate(solution: Solution) -> DecayRate | None:
    """Return the decay rate on a fixed belt; None where there is none to fit.

    On a moving belt p_S is not stationary, and H tends to a positive constant.
    """
    if solution.model is not None and not solution.model.has_equilibrium:
        return None
    try:
        return solution.entropy_rate()
    except ValueError:
        return None


def has_entropy(solution: Solution) -> bool:
    """Whether the relative entropy was recorded at all."""
    return bool(np.isfinite(_positive(_excess(solution))).any())


def _excess(solution: Solution) -> NDArray[np.float64]:
    return np.asarray(solution.series["relative_entropy"] - solution.entropy_floor)


def _positive(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values with NaN where a logarithmic axis has no place for them."""
    return np.where(values > NOISE_LEVEL, values, np.nan)


def _draw_band(axes: Axes, solution: Solution, excess: NDArray[np.float64]) -> None:
    if solution.errors is None or "relative_entropy" not in solution.errors:
        return
    error = solution.errors["relative_entropy"]
    low, high = (np.maximum(excess + one, NOISE_LEVEL) for one in (-error, error))
    axes.fill_between(
        solution.series["s"], low, high, color=COLOURS["blue"], alpha=0.25, linewidth=0,
        label=rf"error $\leq {_power_of_ten(float(np.nanmax(error)))}$",
    )  # fmt: skip


def _draw_fit(axes: Axes, fit: DecayRate | None) -> None:
    if fit is None:
        return
    window = np.linspace(*fit.window, 50)
    rate = str(fit).replace("±", r"\pm")
    axes.plot(
        window, fit.amplitude * np.exp(-fit.rate * window), ":",
        color=COLOURS["black"], linewidth=1.6, label=rf"$\lambda = {rate}$",
    )  # fmt: skip


def _power_of_ten(number: float) -> str:
    """Return the number with one digit, rounded up, as mathtext."""
    if not number > 0:
        return "0"
    power = int(np.floor(np.log10(number)))
    digit = int(np.ceil(number / 10.0**power))
    digit, power = (1, power + 1) if digit == 10 else (digit, power)
    return rf"{digit}\cdot 10^{{{power}}}"


def _limit_decades(axes: Axes) -> None:
    """Show whole powers of ten, and label no others."""
    from matplotlib.ticker import NullFormatter

    bottom, top = (float(np.log10(limit)) for limit in axes.get_ylim())
    lowest, highest = np.floor(max(bottom, top - _DECADES)), np.ceil(top)
    axes.set_ylim(10.0**lowest, 10.0**highest)
    axes.yaxis.set_minor_formatter(NullFormatter())
