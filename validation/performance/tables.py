"""Tables of the benchmark, from its JSON files alone.

    python validation/performance/tables.py            # all of them

docs/benchmarks.md prints its tables with these functions. Nothing is imported that is
not in Python's own library.
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"
OURS = ("drift_kick", "semi_lagrangian")
BASELINE = ("py-pde", [64, 64, 64])
NOISES = (0.3, 1.0, 3.0)
LEVELS = tuple(10.0**-k for k in range(1, 9))
# Against py-pde on 64³: family, extrapolated or not, error of py-pde over the largest
# one allowed, and CPU time of py-pde over the largest one allowed.
AIMS = (
    ("drift_kick", False, 1, 250),
    ("semi_lagrangian", False, 1, 25),
    ("", True, 500, 100),
)
AIMED_AT = {
    "cells_per_second": "cells of a whole step of drift_kick per second",
    "ratio_to_euler": "steps of drift_kick per explicit Euler step of py-pde",
    "two_threads": "steps on two threads per step on one",
    "record_share": "time of a record over that of a step",
    "import_seconds": "seconds of import fpsolve, beyond an empty process",
    "example_seconds": "seconds of a warm fpsolve run of the example",
}


def aim_line(name: str, value: float, relation: str, aim: float) -> str:
    """What was measured, what was aimed at, and whether it was reached."""
    met = value >= aim if relation == ">=" else value <= aim
    word = "reached" if met else "MISSED "
    return f"{word} {name}: {value:.3g}, aim {relation} {aim:.3g}"


class Tables:
    """Prints what the files of a folder hold.

    Parameters
    ----------
    folder : Path
    prefix : str
        "benchmark", or "quick".
    """

    def __init__(self, folder: Path = RESULTS, prefix: str = "benchmark") -> None:
        self.folder, self.prefix = folder, prefix

    def read(self, part: str) -> Any:
        """Numbers of one part; FileNotFoundError if it was not run."""
        path = self.folder / f"{self.prefix}-{part}.json"
        return json.loads(path.read_text("utf-8"))

    def rows(self, noise: float) -> list[dict[str, Any]]:
        """Every run at one noise."""
        sections = self.read(f"noise-{noise:g}")["sections"]
        return [row for section in sections.values() for row in section["rows"]]

    def machine(self) -> None:
        """What the numbers were measured on and with."""
        record = self.read("cells")
        known = record["versions"].items()
        print(f"{record['processor']}, {record['n_cpus']} cores, {record['date'][:10]}")
        print(", ".join(f"{name} {version}" for name, version in known if version))

    def errors(self, noise: float) -> None:
        """Error against CPU time of every run at one noise."""
        rows = self.rows(noise)
        base = baseline(rows)
        print(
            f"{'solver':45} {'grid':>11} {'ds':>18} {'L1 error':>9} "
            f"{'CPU s':>8} {'set-up':>7} {'ratio':>6}"
        )
        for row in rows:
            ratio = f"{base['cpu'] / row['cpu']:6.3g}" if base else f"{'-':>6}"
            print(
                f"{row['solver']:45} {grid(row['shape']):>11} {row['step']:>18} "
                f"{row['l1_error']:9.2e} {row['cpu']:8.3g} {row['setup']:7.2g} {ratio}"
            )

    def left_out(self, noise: float) -> None:
        """Runs that were not made at one noise, and why."""
        for solver, section in self.read(f"noise-{noise:g}")["sections"].items():
            for run in section["left_out"]:
                name = ", ".join(filter(None, (solver, run["options"])))
                print(f"{name}, {grid(run['shape'])}: {run['reason']}")

    def winners(self, noise: float) -> None:
        """The cheapest run of ours and of the peers below each error."""
        rows = self.rows(noise)
        mine = [row for row in rows if row["solver"].startswith(OURS)]
        peers = [row for row in rows if not row["solver"].startswith(OURS)]
        heads = f"{'error below':>11}  {'ours':>8}  {'best peer':>9}  {'times':>5}"
        print(f"{heads}  cheapest")
        for level in LEVELS:
            ours, peer = cheapest(mine, level), cheapest(peers, level)
            if ours or peer:
                print(
                    f"{level:11.0e}  {cost(ours)}  {cost(peer):>9}  {win(ours, peer)}"
                )

    def aims(self) -> None:
        """What was aimed at against py-pde on 64³ at A = 1, and what was reached."""
        rows = self.rows(1.0)
        base = baseline(rows)
        if base is None:
            print("not judged: needs the run of py-pde on 64³")
            return
        for aim in AIMS:
            print(judged(aim, rows, base))

    def cells(self) -> None:
        """Cells per second of a whole step against the number of cells."""
        rows = self.read("cells")["rows"]
        columns = sorted({row["n"] for row in rows})
        print(f"{'Mcells/s':30} " + " ".join(f"{f'{n}³':>6}" for n in columns))
        for scheme in dict.fromkeys(row["scheme"] for row in rows):
            rates = [row for row in rows if row["scheme"] == scheme]
            text = " ".join(f"{row['cells_per_second'] / 1e6:6.1f}" for row in rates)
            print(f"{scheme:30} {text}")

    def threads(self) -> None:
        """Elapsed time on one thread over that on two."""
        for row in self.read("threads")["rows"]:
            one, two = row["seconds_per_step"]["1"], row["seconds_per_step"]["2"]
            print(
                f"{row['scheme']:22} {row['n']:>4}³: {1e3 * one:7.1f} ms a step on one "
                f"thread, {1e3 * two:7.1f} ms on two, ratio {row['ratio']:.2f}"
            )

    def arclengths(self) -> None:
        """Cost and error of runs to growing s at A = 1."""
        rows = self.read("s")["rows"]
        ends = sorted({row["s"] for row in rows})
        heads = " ".join(f"{f's = {s:g}':>17}" for s in ends)
        print(f"{'CPU s, L1 error':45} {'grid':>8} {heads}")
        for solver in dict.fromkeys(row["solver"] for row in rows):
            mine = [row for row in rows if row["solver"] == solver]
            text = " ".join(f"{r['cpu']:7.2g}, {r['l1_error']:.2e}" for r in mine)
            print(f"{solver:45} {grid(mine[0]['shape']):>8} {text}")

    def memory(self) -> None:
        """Peak memory, what of it grows with the cells, and fpsolve's estimate."""
        print(f"{'':16} {'cells':>5} {'peak':>8} {'above start':>14} {'estimate':>9}")
        for row in self.read("memory")["rows"]:
            grown = row["peak_bytes"] - row["before_bytes"]
            densities = f"{grown / row['density_bytes']:.1f} densities"
            print(
                f"{row['solver']:16} {row['n']:>4}³ {mebibytes(row['peak_bytes'])} "
                f"{densities:>14} {mebibytes(row['estimate_bytes']):>9}"
            )

    def start(self) -> None:
        """Seconds of imports and of the packaged example."""
        record = self.read("start")
        for name, seconds in record["imports"].items():
            print(f"import of {name}: {seconds['elapsed']:.2f} s")
        for name, seconds in record["example"].items():
            print(
                f"fpsolve run, {name}: {seconds['elapsed']:.1f} s, "
                f"{seconds['cpu']:.1f} s of CPU time"
            )

    def contributors(self) -> None:
        """Where the import time of `solve` and a scheme goes."""
        parts = self.read("start")["contributors"]
        print(", ".join(f"{name} {seconds:.2f} s" for name, seconds in parts.items()))

    def operators(self) -> None:
        """Rates of our operators beside what the machine copies and multiplies."""
        print(f"{'':34} {'Mcells/s':>8} {'of copying':>10} {'of DGEMM':>8}")
        for row in self.read("operators")["kernels"]:
            shares = row["shares"]
            print(
                f"{row['name']:34} {row['cells_per_second'] / 1e6:8.1f} "
                f"{shares['copy_large']:10.0%} {percent(shares['dgemm']):>8}"
            )

    def targets(self) -> None:
        """Aims for whole steps, records and the start, and what was reached."""
        record = self.read("targets")
        measured, shape = record["measured"], record["shape"]
        print(f"on {grid(shape)} cells, and one thread where not said:")
        for name, (relation, aim) in record["aims"].items():
            if name not in measured:
                print(f"left out by --quick: {AIMED_AT[name]}")
            elif self.prefix == "quick":
                # The aims are set for 64³ cells.
                print(f"{AIMED_AT[name]}: {measured[name]:.3g}")
            else:
                print(aim_line(AIMED_AT[name], measured[name], relation, aim))
        fastest = min(one["steps"] for one in record["rounds"])
        print(f"fastest round: {math.prod(shape) / fastest:.3g} cells per second")
        if "ratio_to_fused_euler" in measured:
            ratio = measured["ratio_to_fused_euler"]
            print(
                f"steps per Euler step of py-pde with fused coefficients: {ratio:.3g}"
            )
        print(f"record over a step made alone: {measured['record_share_alone']:.3g}")

    def reference(self, noise: float) -> None:
        """L1 differences of a reference to variations of itself."""
        known = ("noise", "s", "half_width", "shape", "rtol")
        for row in self.read(f"reference-{noise:g}")["rows"]:
            print(
                f"A = {row['noise']:g}, s = {row['s']:g}, {grid(row['shape'])} points:"
            )
            for name, difference in row.items():
                if name not in known:
                    text = "not reached" if difference is None else f"{difference:.1e}"
                    print(f"  {name:18} {text}")


def grid(shape: list[int]) -> str:
    """A grid as printed, 64x64x32."""
    return "x".join(map(str, shape))


def baseline(rows: list[dict[str, Any]]) -> dict[str, Any] | None:
    """The py-pde run on 64³, if it was made."""
    for row in rows:
        if (row["solver"], row["shape"]) == BASELINE:
            return row
    return None


def cheapest(rows: list[dict[str, Any]], level: float) -> dict[str, Any] | None:
    """The run with the least CPU time among those with at most this error."""
    accurate = [row for row in rows if row["l1_error"] <= level]
    return min(accurate, key=lambda row: row["cpu"], default=None)


def mebibytes(n_bytes: int | None) -> str:
    """Memory as printed, or a dash."""
    return "-" if n_bytes is None else f"{n_bytes / 2**20:4.0f} MiB"


def percent(share: float | None) -> str:
    """A share as printed, or a dash."""
    return "-" if share is None else f"{share:.0%}"


def cost(row: dict[str, Any] | None) -> str:
    """CPU time as printed."""
    return f"{row['cpu']:6.2g} s" if row else f"{'-':>8}"


def win(ours: dict[str, Any] | None, peer: dict[str, Any] | None) -> str:
    """How many times cheaper the cheaper of two runs is, and which it is."""
    if ours is None or (peer is not None and peer["cpu"] < ours["cpu"]):
        assert peer is not None
        best, other, label = peer, ours, f"peer: {peer['solver']}"
    else:
        best, other, label = ours, peer, ours["solver"]
    times = f"{other['cpu'] / best['cpu']:.2g}" if other else "alone"
    return f"{times:>5}  {label}, {grid(best['shape'])}"


def judged(
    aim: tuple[str, bool, int, int], rows: list[dict[str, Any]], base: dict[str, Any]
) -> str:
    """One line: the cheapest run that is accurate enough, and whether it is enough."""
    family, extrapolated, error_factor, speed = aim
    name = family or "extrapolated"
    candidates = [
        row
        for row in rows
        if row["solver"].startswith(family or OURS)
        and ("extrapolated" in row["solver"]) == extrapolated
    ]
    best = cheapest(candidates, base["l1_error"] / error_factor)
    if best is None:
        return f"MISSED  {name}: no run reaches error / {error_factor}"
    reached = base["cpu"] / best["cpu"]
    word = "reached" if reached >= speed else "MISSED "
    accuracy = base["l1_error"] / best["l1_error"]
    return (
        f"{word} {name}: CPU time / {reached:.0f} (aim / {speed}), "
        f"error / {accuracy:.3g} (aim / {error_factor})\n"
        f"        by {best['solver']}, {grid(best['shape'])}"
    )


def print_all(tables: Tables) -> None:
    """Print every table whose numbers are there."""
    calls = [("cells", tables.machine, ())]
    for noise in NOISES:
        part = f"noise-{noise:g}"
        for method in (tables.errors, tables.left_out, tables.winners):
            calls.append((part, method, (noise,)))
    calls += [("noise-1", tables.aims, ()), ("cells", tables.cells, ())]
    calls += [("threads", tables.threads, ()), ("s", tables.arclengths, ())]
    calls += [("memory", tables.memory, ()), ("start", tables.start, ())]
    calls += [("start", tables.contributors, ()), ("targets", tables.targets, ())]
    calls += [("operators", tables.operators, ())]
    calls += [(f"reference-{noise:g}", tables.reference, (noise,)) for noise in NOISES]
    for part, method, arguments in calls:
        if (tables.folder / f"{tables.prefix}-{part}.json").exists():
            print(f"\n-- {method.__doc__.splitlines()[0]} [{part}]")
            method(*arguments)


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=RESULTS)
    arguments = parser.parse_args()
    print_all(Tables(arguments.out, "quick" if arguments.quick else "benchmark"))


if __name__ == "__main__":
    main()
