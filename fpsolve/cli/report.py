"""The result of a run as a short table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fpsolve.solution import Solution

__all__ = ["print_report"]

_MOST_ROWS = 11


def print_report(solution: Solution) -> None:
    """Print entropy, minimum, mass error and error estimates at some arclengths."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False, markup=False)
    table = Table(box=box.SIMPLE_HEAD)
    columns = _columns(solution)
    for name in columns:
        table.add_column(name, justify="right")
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    console.print(table)
    for line in _lines(solution):
        console.print(line)


def _columns(solution: Solution) -> dict[str, list[str]]:
    rows = _rows(solution)
    series, errors = solution.series, solution.errors or {}
    entropy, mass = series["relative_entropy"], series["mass"]
    columns = {
        "s": _shown(series["s"][rows], ".4g"),
        "H(p|p_S)": _shown(entropy[rows], ".6g"),
    }
    if "relative_entropy" in errors:
        columns["± H"] = _shown(errors["relative_entropy"][rows], ".1e")
    columns |= {
        "minimum": _shown(series["minimum"][rows], ".1e"),
        "mass error": _shown((mass / mass[:1] - 1)[rows], ".1e"),
        "boundary mass": _shown(series["boundary_mass"][rows], ".1e"),
    }
    return columns


def _rows(solution: Solution) -> np.ndarray:
    """Return recorded steps near evenly spaced saved arclengths."""
    s, saved = solution.series["s"], solution.saved_s
    wanted = saved if saved.size else s[-1:]
    places = np.linspace(0, wanted.size - 1, min(wanted.size, _MOST_ROWS))
    wanted = wanted[places.round().astype(int)]
    return np.array([int(np.argmin(np.abs(s - one))) for one in wanted], dtype=int)


def _lines(solution: Solution) -> list[str]:
    seconds = solution.provenance
    lines = []
    if solution.errors is not None and solution.saved_s.size:
        worst = float(np.max(solution.errors["density_l1"]))
        lines.append(f"estimated L1 error of the saved densities: at most {worst:.1e}")
    rate = _rate(solution)
    if rate is not None:
        lines.append(rate)
    if "wall_seconds" in seconds:
        lines.append(
            f"{solution.status} after {seconds['wall_seconds']:.2f} s "
            f"({seconds['cpu_seconds']:.2f} s of CPU time)"
        )
    return lines


def _rate(solution: Solution) -> str | None:
    from fpsolve.plotting.entropy import fitted_rate

    fit = fitted_rate(solution)
    if fit is None:
        return None
    start, end = fit.window
    return (
        f"H - H_box falls like exp(-λs), λ = {fit}, "
        f"fitted for s from {start:g} to {end:g}"
    )


def _shown(values: np.ndarray, form: str) -> list[str]:
    return [format(float(value), form) for value in values]
