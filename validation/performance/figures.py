"""Figures of the benchmark, from its JSON files.

    python validation/performance/figures.py            # into docs/_static

Each figure says in its PNG text "Numbers" which numbers it was drawn from: the digest
of their files. A test compares it with the files that are kept.
"""

from __future__ import annotations

import argparse
import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
from tables import NOISES, OURS, RESULTS, SECTORS, Tables

mpl.use("Agg")

from matplotlib.axes import Axes
from matplotlib.figure import Figure

STATIC = Path(__file__).parents[2] / "docs/_static"
# Okabe and Ito's palette and a grey: told apart with any colour vision.
STYLES = {
    "semi_lagrangian": ("#0072B2", "o"),
    "semi_lagrangian, extrapolated": ("#56B4E9", "s"),
    "drift_kick": ("#D55E00", "D"),
    "drift_kick, extrapolated": ("#E69F00", "^"),
    "drift_kick, Fourier": ("#7A0403", "H"),
    "spectral_solve, sectors": ("#9467BD", "8"),
    "Fourier + RK4 (numpy)": ("#009E73", "v"),
    "Dedalus 3": ("#000000", "P"),
    "py-pde": ("#CC79A7", "X"),
    "py-pde, expression": ("#CC79A7", "+"),
    "FiPy (van Leer)": ("#999999", "d"),
    "fplanck": ("#B8A800", "*"),
    "fplanck, force corrected": ("#B8A800", "p"),
}
FIGURES = {
    "benchmark_errors.png": tuple(f"noise-{noise:g}" for noise in NOISES),
    "benchmark_scaling.png": ("cells", "s", "memory"),
}


def digest(parts: tuple[str, ...], folder: Path, prefix: str) -> str:
    """SHA-256 of the files of some parts, one after the other."""
    found = hashlib.sha256()
    for part in parts:
        found.update((folder / f"{prefix}-{part}.json").read_bytes())
    return found.hexdigest()


def family(solver: str) -> str:
    """Legend entry: our scheme, and how it was made more accurate; or the peer."""
    if not solver.startswith((*OURS, SECTORS)):
        return solver
    name, words = solver.split(" (")[0], solver.partition(" (")[2]
    kinds = {"Fourier": "Fourier", "extrapolated": "extrapolated", "sectors": "sectors"}
    kind = next((kinds[word] for word in kinds if word in words), None)
    return f"{name}, {kind}" if kind else name


def plot(axes: Axes, name: str, x: list[float], y: list[float], line: str = "") -> None:
    """Points of one family: ours filled, the peers open."""
    colour, marker = STYLES[name]
    fill = colour if name.startswith((*OURS, SECTORS)) or marker == "+" else "white"
    axes.loglog(
        *(x, y, marker + line),
        color=colour,
        markerfacecolor=fill,
        markersize=5,
        linewidth=0.8,
        label=name,
    )


def front(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Runs that no cheaper run beats, by CPU time."""
    best: list[dict[str, Any]] = []
    for row in sorted(rows, key=lambda row: row["cpu"]):
        if not best or row["l1_error"] < best[-1]["l1_error"]:
            best.append(row)
    return best


def draw_errors(axes: Axes, rows: list[dict[str, Any]], noise: float) -> None:
    """Error against CPU time at one noise; a line joins a family's best runs."""
    for name in STYLES:
        mine = [row for row in rows if family(row["solver"]) == name]
        if not mine:
            continue
        best = front(mine)
        style = "-" if name.startswith((*OURS, SECTORS)) else "--"
        x, y = [row["cpu"] for row in best], [row["l1_error"] for row in best]
        axes.loglog(x, y, style, color=STYLES[name][0], linewidth=0.8)
        plot(axes, name, [row["cpu"] for row in mine], [r["l1_error"] for r in mine])
    axes.set(title=f"$A = {noise:g}$", xlabel="CPU time / s")
    axes.grid(alpha=0.3)


def errors_figure(tables: Tables) -> Figure:
    """One panel for every noise that was run."""
    noises = [
        noise
        for noise in NOISES
        if (tables.folder / f"{tables.prefix}-noise-{noise:g}.json").exists()
    ]
    columns = min(len(noises), 3)
    n_rows = -(-len(noises) // columns)
    size = (2 + 3.1 * columns, 1.2 + 3.4 * n_rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(n_rows, columns, sharex=True, sharey=True, squeeze=False)
    shown, left = panels.flat[: len(noises)], panels.flat[len(noises) :]
    for axes, noise in zip(shown, noises, strict=True):
        draw_errors(axes, tables.rows(noise), noise)
    for axes in left:
        axes.set_axis_off()
    for axes in shown:
        axes.tick_params(labelbottom=True)
    for axes in panels[:, 0]:
        axes.set_ylabel(r"$L^1$ error of $p(\xi, \alpha, s = 1)$")
    legend(figure, shown, 4)
    return figure


def legend(figure: Figure, panels: Iterable[Axes], columns: int) -> None:
    """One legend for what any of the panels shows, below them."""
    entries: dict[str, Any] = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        entries = dict(zip(labels, handles, strict=True)) | entries
    figure.legend(
        *(list(entries.values()), list(entries)),
        loc="outside lower center",
        ncols=columns,
        fontsize="small",
    )


def draw_cells(axes: Axes, rows: list[dict[str, Any]]) -> None:
    """Rate of whole steps against the number of cells."""
    for name in (*OURS, "drift_kick (Fourier)"):
        mine = [row for row in rows if row["scheme"] == name]
        if not mine:
            continue
        cells = [row["n"] ** 3 for row in mine]
        plot(
            axes,
            family(name),
            cells,
            [row["cells_per_second"] / 1e6 for row in mine],
            "-",
        )
    axes.set(xlabel="cells", ylabel="whole steps, Mcells / CPU s", title="cells")
    axes.set(yscale="linear", ylim=(0, None))


def draw_arclengths(axes: Axes, rows: list[dict[str, Any]]) -> None:
    """Error against s."""
    for solver in dict.fromkeys(row["solver"] for row in rows):
        mine = [row for row in rows if row["solver"] == solver]
        s = [row["s"] for row in mine]
        line = "-" if "balanced" not in solver or "order" in solver else ":"
        plot(axes, family(solver), s, [row["l1_error"] for row in mine], line)
    axes.set(xlabel="s", ylabel="$L^1$ error", title="arclength, $A = 1$")


def draw_memory(axes: Axes, rows: list[dict[str, Any]]) -> None:
    """Peak memory against cells, and what fpsolve says before (dotted)."""
    for name in dict.fromkeys(row["solver"] for row in rows):
        mine = [row for row in rows if row["solver"] == name]
        cells = [row["n"] ** 3 for row in mine]
        plot(axes, name, cells, [row["peak_bytes"] / 2**20 for row in mine], "-")
        if mine[0]["estimate_bytes"]:
            said = [row["estimate_bytes"] / 2**20 for row in mine]
            axes.plot(cells, said, ":", color=STYLES[name][0])
    axes.set(xlabel="cells", ylabel="peak memory / MiB", title="memory")
    axes.set(yscale="linear", ylim=(0, None))


def scaling_figure(tables: Tables) -> Figure:
    """Cells, arclength, memory."""
    figure = Figure(figsize=(10.5, 4.2), layout="constrained")
    panels = figure.subplots(1, 3)
    draw_cells(panels[0], tables.read("cells")["rows"])
    draw_arclengths(panels[1], tables.read("s")["rows"])
    draw_memory(panels[2], tables.read("memory")["rows"])
    for axes in panels:
        axes.grid(alpha=0.3)
    legend(figure, panels, 5)
    return figure


def draw_all(tables: Tables, out: Path) -> None:
    """Draw the figures whose numbers are there."""
    from fpsolve._support.files import atomic_path

    for name, parts in FIGURES.items():
        files = [tables.folder / f"{tables.prefix}-{part}.json" for part in parts]
        present = tuple(
            part for part, file in zip(parts, files, strict=True) if file.exists()
        )
        draw = errors_figure if name == "benchmark_errors.png" else scaling_figure
        if not present or (draw is scaling_figure and present != parts):
            continue
        numbers = digest(present, tables.folder, tables.prefix)
        with atomic_path(out / name) as draft:
            draw(tables).savefig(draft, dpi=150, metadata={"Numbers": numbers})
        print(f"drawn: {name}")


def main() -> None:
    """Draw into docs/_static, or beside numbers that are not the kept ones."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=RESULTS)
    arguments = parser.parse_args()
    kept = arguments.out == RESULTS and not arguments.quick
    tables = Tables(arguments.out, "quick" if arguments.quick else "benchmark")
    draw_all(tables, STATIC if kept else arguments.out)


if __name__ == "__main__":
    main()
