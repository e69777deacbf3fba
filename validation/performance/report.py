"""The benchmark's table, its aims, its JSON file and its figure."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from kernels import KernelRate
from machine import Machine
from problem import Result

OURS = ("drift_kick", "semi_lagrangian")
BASELINE = ("py-pde", (64, 64, 64))


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    solver: str
    shape: tuple[int, ...]
    step: str
    l1_error: float
    cpu: float
    wall: float
    setup: float
    note: str

    @property
    def grid(self) -> str:
        """The grid as printed, 64x64x32."""
        return "x".join(map(str, self.shape))


def make_row(result: Result, reference: Any) -> Row:
    """Compare a result with the reference on its own grid."""
    return Row(
        solver=result.solver,
        shape=result.shape,
        step=result.step,
        l1_error=result.l1_error(reference(*result.axes)),
        cpu=result.cpu,
        wall=result.wall,
        setup=result.setup,
        note=result.note,
    )


def find_baseline(rows: list[Row]) -> Row | None:
    """The py-pde run on 64³, if it was made."""
    for row in rows:
        if (row.solver, row.shape) == BASELINE:
            return row
    return None


def print_table(rows: list[Row]) -> None:
    """Print all rows; the last number is the baseline's CPU time over the row's."""
    baseline = find_baseline(rows)
    print(
        f"{'solver':46} {'grid':>9} {'ds':>18} {'L1 error':>9} "
        f"{'CPU s':>9} {'set-up':>8} {'ratio':>7}  note"
    )
    for row in rows:
        ratio = f"{baseline.cpu / row.cpu:7.3g}" if baseline else f"{'-':>7}"
        print(
            f"{row.solver:46} {row.grid:>9} {row.step:>18} {row.l1_error:9.2e} "
            f"{row.cpu:9.3g} {row.setup:8.2g} {ratio}  {row.note}"
        )
    print(
        "CPU s: process time from the first step to the last, one solve; set-up: what\n"
        "comes before it (compilation for py-pde, tables for ours, whose kernels are\n"
        "compiled once per machine); ratio: CPU time of py-pde on 64³ over this one."
    )


@dataclass(frozen=True)
class Aim:
    """A ratio to the baseline that was aimed at, and what was reached.

    `error_factor`: error of the baseline over the largest one allowed.
    """

    text: str
    family: str
    extrapolated: bool
    error_factor: float
    speed: float


AIMS = (
    Aim("drift_kick, as accurate, 250 times less CPU", "drift_kick", False, 1, 250),
    Aim(
        "semi_lagrangian, as accurate, 25 times less CPU",
        "semi_lagrangian",
        False,
        1,
        25,
    ),
    Aim("extrapolated, error / 500 at 100 times less CPU", "", True, 500, 100),
)


def judge(aim: Aim, rows: list[Row], baseline: Row) -> dict[str, Any]:
    """The cheapest row that is accurate enough, and whether it is cheap enough."""
    allowed = baseline.l1_error / aim.error_factor
    candidates = [
        row
        for row in rows
        if row.solver.startswith(aim.family or OURS)
        and ("extrapolated" in row.solver) == aim.extrapolated
        and row.l1_error <= allowed
    ]
    if not candidates:
        return {"aim": aim.text, "reached": False, "speed": None, "row": None}
    best = min(candidates, key=lambda row: row.cpu)
    speed = baseline.cpu / best.cpu
    return {
        "aim": aim.text,
        "reached": speed >= aim.speed,
        "speed": speed,
        "error_ratio": baseline.l1_error / best.l1_error,
        "row": asdict(best),
    }


def judge_all(rows: list[Row]) -> list[dict[str, Any]]:
    """Judge every aim; an empty list without the baseline."""
    baseline = find_baseline(rows)
    return [judge(aim, rows, baseline) for aim in AIMS] if baseline else []


def print_aims(verdicts: list[dict[str, Any]]) -> None:
    """Print which aims were reached and by what."""
    if not verdicts:
        print("Aims not judged: they need the run of py-pde on 64³.")
    for verdict in verdicts:
        word = "reached" if verdict["reached"] else "MISSED"
        if verdict["row"] is None:
            print(f"{word:8} {verdict['aim']}: no run is accurate enough")
            continue
        row = verdict["row"]
        print(
            f"{word:8} {verdict['aim']}: {verdict['speed']:.0f} times less, error "
            f"{verdict['error_ratio']:.3g} times smaller ({row['solver']}, "
            f"{'x'.join(map(str, row['shape']))}, ds = {row['step']})"
        )


def percent(share: float | None) -> str:
    """A share as a percentage, or a dash."""
    return "-" if share is None else f"{100 * share:.0f} %"


def print_kernels(rates: list[KernelRate], machine: Machine) -> None:
    """Print the rates of our operators and the shares of the machine's limits."""
    print(
        f"{'operator':44} {'Mcells/s':>9} {'copy 64³':>9} {'copy RAM':>9} {'DGEMM':>7}"
    )
    for kernel in rates:
        shares = [percent(share) for share in kernel.shares(machine).values()]
        print(
            f"{kernel.name:44} {kernel.cells_per_second / 1e6:9.0f} "
            f"{shares[0]:>9} {shares[1]:>9} {shares[2]:>7}"
        )


def kernel_records(rates: list[KernelRate], machine: Machine) -> list[dict[str, Any]]:
    """Rates and shares as plain values."""
    return [asdict(kernel) | {"shares": kernel.shares(machine)} for kernel in rates]


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write the numbers; the file appears complete or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    partial.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n")
    os.replace(partial, path)


# Okabe and Ito's palette and a grey: told apart with any colour vision.
COLOURS = (
    "#0072B2",
    "#56B4E9",
    "#D55E00",
    "#E69F00",
    "#009E73",
    "#000000",
    "#CC79A7",
    "#999999",
    "#B8A800",
)
MARKERS = "osD^vPXd*"


def family(row: Row) -> str:
    """Legend entry of a row: scheme, and whether it was extrapolated."""
    if row.solver.startswith(OURS):
        name = row.solver.split(" (")[0]
        return f"{name}, extrapolated" if "extrapolated" in row.solver else name
    return row.solver


def draw(rows: list[Row], s_end: float, path: Path) -> None:
    """Error against CPU time: our schemes filled, the peers open and joined."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
    for index, name in enumerate(dict.fromkeys(map(family, rows))):
        mine = [row for row in rows if family(row) == name]
        ours = name.startswith(OURS)
        axes.loglog(
            [row.cpu for row in mine],
            [row.l1_error for row in mine],
            MARKERS[index % len(MARKERS)] + ("" if ours else "--"),
            color=COLOURS[index % len(COLOURS)],
            markerfacecolor=None if ours else "white",
            linewidth=0.8,
            label=name,
        )
    axes.set_xlabel("process CPU time / s")
    axes.set_ylabel(rf"$L^1$ error of $p(\xi, \alpha, s = {s_end:g})$")
    axes.set_title(r"$B = |\xi|^2/2$, $A = 1$", fontsize="medium")
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right upper", fontsize="small")
    figure.savefig(path, dpi=200)
    plt.close(figure)
