"""Marginals of a density against the histograms of paths."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind, told_apart
from fpsolve.evolution.schedule import index_of
from fpsolve.plotting.angle import show_turn
from fpsolve.plotting.selection import evenly
from fpsolve.plotting.style import COLOURS, PAGE, drawing, parameters
from fpsolve.studies.agreement.check import CrossCheck

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["plot_cross_check"]


_LABELS = {"xi1": r"$\xi_1$", "xi2": r"$\xi_2$", "alpha": r"$\alpha$"}
_MOST_ROWS = 4
# Cells in which fewer paths are expected carry no bar: their errors are not normal.
_LEAST_COUNT = 10
# Share of the probability of a marginal that may lie outside of the window.
_OUTSIDE = 1e-4
# Standard deviations that the strip below a panel shows at least.
_LEAST_SCORE = 4.0
_ROW, _STRIP, _MARGINS = 1.15, 0.45, 0.85


def plot_cross_check(check: CrossCheck, at: Iterable[float] | None = None) -> Figure:
    """∫ p over the other variables against the paths, with deviations beneath.

    Points are histograms of the paths with their standard errors, lines the averages
    of the density over the same cells. The strips show the deviation z of every cell
    in standard deviations, with ± 2 shaded; the number in a panel is the p-value of the
    χ² test of that marginal, the title says how all tests came out.

    Parameters
    ----------
    check : CrossCheck
        From `fpsolve.studies.cross_check`.
    at : iterable of float, optional
        Arclengths to show; by default all, at most four of them.

    Raises
    ------
    ValueError
        If one of the arclengths was not compared.
    """
    check_kind("check", check, CrossCheck, "it is what `cross_check` returns")
    rows = _rows(check, at)
    height = _MARGINS + len(rows) * (_ROW + _STRIP)
    with drawing(PAGE, height, _title(check)) as figure:
        panels = figure.subplots(
            2 * len(rows), 3, squeeze=False, sharex="col",
            height_ratios=[_ROW, _STRIP] * len(rows),
        )  # fmt: skip
        for place, row in enumerate(rows):
            for axes, strip, which in zip(
                panels[2 * place], panels[2 * place + 1], _LABELS, strict=True
            ):
                _draw_marginal(axes, check, row, which)
                _draw_scores(strip, check, row, which)
            panels[2 * place, 0].set_ylabel(f"$s = {check.s[row]:g}$\ndensity")
            panels[2 * place + 1, 0].set_ylabel("$z$")
        for axes, which in zip(panels[-1], _LABELS, strict=True):
            axes.set_xlabel(_LABELS[which])
        _limit(panels, check, rows)
        panels[0, 0].legend(
            loc="upper left", borderaxespad=0.1, handlelength=1.2, fontsize=7
        )
    return figure


def _rows(check: CrossCheck, at: Iterable[float] | None) -> list[int]:
    """Numbers of the arclengths to show."""
    if at is None:
        return evenly(len(check.s), _MOST_ROWS)
    return [_row_of(check, float(s)) for s in at]


def _row_of(check: CrossCheck, s: float) -> int:
    row = index_of(check.s, s)
    if row is None:
        *known, got = told_apart(*check.s.tolist(), s)
        raise ValueError(
            f"`at` must hold compared arclengths {', '.join(known)}, got {got}."
        )
    return row


def _draw_marginal(axes: Axes, check: CrossCheck, row: int, which: str) -> None:
    """Averages over the cells as a line, counts with their errors as points."""
    places, width = _cells(check, which)
    counts = check.counts[which][row]
    share = check.probabilities[which][row]
    n_inside = int(counts.sum())
    axes.plot(
        places, share / share.sum() / width, color=COLOURS["blue"], label="density"
    )
    axes.errorbar(
        places, counts / n_inside / width, np.sqrt(counts) / n_inside / width,
        fmt=".", markersize=2.6, elinewidth=0.6, color=COLOURS["vermilion"],
        label="paths",
    )  # fmt: skip
    axes.set_ylim(bottom=0.0)
    axes.set_ylim(top=1.22 * axes.get_ylim()[1])
    test = check.test(f"marginal {which}", float(check.s[row]))
    axes.text(
        0.98, 0.96, _p_value(test.p_value), transform=axes.transAxes, ha="right",
        va="top", fontsize=7, color=COLOURS["black" if test.agrees else "vermilion"],
    )  # fmt: skip


def _draw_scores(axes: Axes, check: CrossCheck, row: int, which: str) -> None:
    """Deviations of the counts in standard deviations."""
    places, width = _cells(check, which)
    score = _scores(check, row, which)
    axes.axhspan(-2, 2, color="0.9", linewidth=0)
    axes.axhline(0, color=COLOURS["black"], linewidth=0.5)
    axes.bar(places, score, width=0.8 * width, color=COLOURS["vermilion"])


def _scores(check: CrossCheck, row: int, which: str) -> Array:
    """(n − N q)/√(N q (1 − q)) in cells where enough paths are expected, else NaN."""
    counts, share = check.counts[which][row], check.probabilities[which][row]
    share = np.clip(share / share.sum(), 0.0, 1.0)
    expected = counts.sum() * share
    spread = np.sqrt(np.maximum(expected * (1 - share), 1e-300))
    deviations = (counts - expected) / spread
    return np.where(expected >= _LEAST_COUNT, deviations, np.nan)


def _limit(panels: NDArray[Any], check: CrossCheck, rows: list[int]) -> None:
    """Show where the probability is, and all strips on one scale."""
    for axes, which in zip(panels[0], ("xi1", "xi2"), strict=False):
        axes.set_xlim(_window(check, rows, which))
    show_turn(panels[0, -1])
    scores = [_scores(check, row, which) for row in rows for which in _LABELS]
    largest = max(float(np.nanmax(np.abs(score))) for score in scores)
    height = max(_LEAST_SCORE, 1.1 * largest)
    for strip in panels[1::2].flat:
        strip.set_ylim(-height, height)
        strip.locator_params(axis="y", nbins=3)


def _window(check: CrossCheck, rows: list[int], which: str) -> tuple[float, float]:
    places, width = _cells(check, which)
    share = check.probabilities[which][rows].max(axis=0)
    inside = np.flatnonzero(share > _OUTSIDE * share.sum())
    return float(places[inside[0]] - width), float(places[inside[-1]] + width)


def _cells(check: CrossCheck, which: str) -> tuple[Array, float]:
    """Centres of the cells of a marginal and their width."""
    width = check.grid.spacing[list(_LABELS).index(which)]
    return getattr(check.grid, which), width


def _p_value(p_value: float) -> str:
    return f"$p$ = {p_value:.2g}" if p_value >= 1e-4 else "$p$ < 1e-4"


def _title(check: CrossCheck) -> str:
    failed, total = len(check.failed), len(check.tests)
    outcome = (
        f"all {total} tests passed"
        if check.agrees
        else f"{failed} of {total} tests failed"
    )
    thousands = f"{check.n_paths:,}".replace(",", r"\,")
    return (
        f"{parameters(check)}\n${thousands}$ paths, {outcome} "
        f"(false alarm: at most {check.false_alarm:g})"
    )
