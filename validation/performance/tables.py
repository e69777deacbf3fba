"""Tables of the benchmark, from its JSON files alone.

    python validation/performance/tables.py            # all of them

docs/benchmarks.md prints its tables with these functions. Nothing is imported that is
not in Python's own library.
"""

from __future__ import annotations

import argparse
import json
import math
import runpy
from pathlib import Path
from types import SimpleNamespace
from typing import Any

HERE = Path(__file__).parent
RESULTS = HERE / "results"
NOISES = (0.1, 0.3, 1.0, 3.0, 10.0)
PARTS = ("cells", "s", "memory", "operators", "threads", "start", "targets")
# Beside this file, which a page runs from anywhere.
wins = SimpleNamespace(**runpy.run_path(str(HERE / "wins.py")))
OURS, SECTORS, grid = wins.OURS, wins.SECTORS, wins.grid
NAMED = {
    "cells_per_second": "cells of a whole step of drift_kick per second",
    "ratio_to_euler": "steps of drift_kick per explicit Euler step of py-pde",
    "two_threads": "steps on two threads per step on one",
    "path_steps_per_second": "steps of sampled paths per second of CPU time",
    "record_share": "time of a record over that of a step",
    "import_seconds": "seconds of import fpsolve, beyond an empty process",
    "example_seconds": "seconds of a warm fpsolve run of the example",
}

AIMS = {"two_threads": (">=", 1.8), "path_steps_per_second": (">=", 180e6)}


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

    def sections(self, noise: float) -> dict[str, dict[str, Any]]:
        """What every solver did at one noise."""
        return dict(self.read(f"noise-{noise:g}")["sections"])

    def rows(self, noise: float) -> list[dict[str, Any]]:
        """Every run at one noise."""
        sections = self.sections(noise).values()
        return [row for section in sections for row in section["rows"]]

    def machine(self) -> None:
        """What the numbers were measured on and with."""
        record = self.read("cells")
        known = record["versions"].items()
        print(f"{record['processor']}, {record['n_cpus']} cores")
        print(", ".join(f"{name} {version}" for name, version in known if version))
        sections = {noise: self.sections(noise) for noise in NOISES}
        records = {part: self.read(part) for part in PARTS}
        print("\n".join(wins.day_lines(sections, records)))

    def errors(self, noise: float) -> None:
        """Error against CPU time of every run at one noise."""
        rows = self.rows(noise)
        base = wins.baseline(rows)
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
        for solver, section in self.sections(noise).items():
            for run in section["left_out"]:
                name = ", ".join(filter(None, (solver, run["options"])))
                print(f"{name}, {grid(run['shape'])}: {run['reason']}")

    def winners(self, noise: float) -> None:
        """The cheapest run of ours and of the peers below each error."""
        print("\n".join(wins.winner_lines(self.rows(noise))))

    def sectors(self, noise: float) -> None:
        """What sectors cost at one noise, their error, and what they tell of H."""
        print(f"{'':17} {'CPU s':>8} {'L1 error':>9} {'told of H':>10}")
        for row in wins.sectors(self.rows(noise)):
            costs = f"{row['cpu']:8.3g} {row['l1_error']:9.2e} {row['told']:10.2e}"
            print(f"{row['step']:17} {costs}")

    def same_grid(self) -> None:
        """CPU time of `semi_lagrangian` over `drift_kick`, same cells, same step."""
        for noise in NOISES:
            print(wins.same_grid_line(self.rows(noise), noise))

    def told(self) -> None:
        """What extrapolated runs of ours say of their errors, over the errors."""
        for noise in NOISES:
            print(wins.told_line(self.rows(noise), noise))

    def lost(self) -> None:
        """Where a peer is cheaper than every grid scheme of ours."""
        lines = [
            line
            for noise in NOISES
            for line in wins.lost_lines(self.rows(noise), noise)
        ]
        print("\n".join(lines or ["nowhere"]))

    def aims(self) -> None:
        """What was aimed at against the peers, and what was reached."""
        heads = " ".join(f"{level:6.0e}" for level in wins.AIMED_LEVELS)
        print(f"CPU time of the best peer over ours, by error:\n{'':7} {heads}")
        for noise in NOISES:
            print(wins.ratio_line(self.rows(noise), noise))
        print(wins.semi_lagrangian_line(self.rows(1.0)))
        for noise, seconds in wins.SECTORS_AIMS:
            print(wins.sectors_line(self.rows(noise), noise, seconds))

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
        """Aims for threads and paths; whole steps, records, the start without one."""
        record = self.read("targets")
        measured, shape = record["measured"], record["shape"]
        print(f"on {grid(shape)} cells, and one thread where not said:")
        for name, (relation, aim) in AIMS.items():
            if name not in measured:
                print(f"not measured: {NAMED[name]}, aim {relation} {aim:.3g}")
            elif self.prefix == "quick":
                # The aims are set for 64³ cells.
                print(f"{NAMED[name]}: {measured[name]:.3g}")
            else:
                print(aim_line(NAMED[name], measured[name], relation, aim))
        for name in NAMED:
            if name in measured and name not in AIMS:
                print(f"{NAMED[name]}: {measured[name]:.3g}")
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


def mebibytes(n_bytes: int | None) -> str:
    """Memory as printed, or a dash."""
    return "-" if n_bytes is None else f"{n_bytes / 2**20:4.0f} MiB"


def percent(share: float | None) -> str:
    """A share as printed, or a dash."""
    return "-" if share is None else f"{share:.0%}"


def print_all(tables: Tables) -> None:
    """Print every table whose numbers are there."""
    calls: list[Any] = []
    for noise in NOISES:
        part = f"noise-{noise:g}"
        methods = (tables.errors, tables.left_out, tables.winners, tables.sectors)
        for method in methods:
            calls.append((part, method, (noise,)))
    needed = (*(f"noise-{noise:g}" for noise in NOISES), *PARTS)
    complete = all(
        (tables.folder / f"{tables.prefix}-{part}.json").exists() for part in needed
    )
    if complete:
        calls += [("cells", tables.machine, ())]
        calls += [("noise-1", tables.lost, ()), ("noise-1", tables.aims, ())]
        calls += [("noise-1", tables.told, ()), ("noise-1", tables.same_grid, ())]
    calls += [("cells", tables.cells, ())]
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
