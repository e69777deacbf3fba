"""Whatever byte of a file is hit, the result is what it was or is refused.

Claims: of a saved result (netCDF, zarr) and of a checkpoint with one or two passes, in
which one byte of one file was changed at random, `load`, `resume` and the same `solve`
give the bits that they gave before, or an error of fpsolve; never another number, never
another exception.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from reporting import Report

import fpsolve as fp
from fpsolve.errors import FpsolveError

MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
GRID = fp.PhaseSpaceGrid((6.0, 5.5), (14, 12, 8))
SCHEME = fp.drift_kick(MODEL, GRID)
P0 = fp.initial.gaussian(GRID, (0.5, 0.0), 0.8)
# The box is small, which is no matter here.
RUN: dict[str, Any] = {
    "s_span": (0.0, 40.0), "ds": 0.125, "save_at": range(0, 41, 5),
    "boundary_tolerance": 1.0,
}  # fmt: skip
OUTCOMES = ("exact", "refused", "other numbers", "other exception")


class Killed(BaseException):
    """What SIGKILL is to a process."""


def solved(**options: Any) -> Any:
    return fp.solve(SCHEME, P0, **RUN, **options)


def killed(folder: Path, step: int, **options: Any) -> Path:
    """The checkpoint of a run that was killed after so many steps."""

    def kill(n_done: int, n_total: int, s: float) -> None:
        if n_done >= step:
            raise Killed

    try:
        solved(checkpoint=fp.Checkpoint(folder, 50), progress=kill, **options)
    except Killed:
        return folder
    raise AssertionError("the run came to its end")


def flips(path: Path, n: int, rng: np.random.Generator) -> Iterator[Path]:
    """Copies of a file or a folder with one byte changed, half of them by one bit."""
    copy = path.with_name(f"hit{path.suffix}")
    for number in range(n):
        shutil.rmtree(copy, ignore_errors=True)
        (shutil.copytree if path.is_dir() else shutil.copy)(path, copy)
        files = [one for one in sorted(copy.rglob("*")) if one.is_file()] or [copy]
        hit = files[rng.integers(len(files))]
        content = bytearray(hit.read_bytes())
        if content:
            change = 1 << rng.integers(8) if number % 2 else rng.integers(1, 256)
            content[rng.integers(len(content))] ^= int(change)
            hit.write_bytes(content)
        yield copy


def outcome(read: Callable[[Path], Any], path: Path, whole: Any) -> str:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = read(path)
    except FpsolveError:
        return "refused"
    except Exception as error:
        print(f"{path}: {error!r}", file=sys.stderr)
        return "other exception"
    return "exact" if fp.compare(found, whole).equal else "other numbers"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the flips")
    quick = parser.parse_args().quick
    report = Report("flipped_bytes", quick)
    n, rng = 40 if quick else 400, np.random.default_rng(11)
    ways = {"load": fp.load, "resume": fp.resume}
    rows, total = [], Counter[str]()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole, both = solved(), solved(extrapolate=True)
        cases = [
            ("netCDF", whole.save(folder / "run.nc"), whole, "load"),
            ("zarr", whole.save(folder / "run.zarr"), whole, "load"),
            ("checkpoint", killed(folder / "one", 300), whole, "resume"),
            ("checkpoint, two passes", killed(folder / "two", 700, extrapolate=True),
             both, "resume"),
        ]  # fmt: skip
        for kind, path, result, way in cases:
            found = Counter(
                outcome(ways[way], hit, result) for hit in flips(path, n, rng)
            )
            rows.append({"hit": kind, **{one: found[one] for one in OUTCOMES}})
            total += found
    report.table(rows)
    report.check("other numbers", total["other numbers"], "<=", 0)
    report.check("other exceptions", total["other exception"], "<=", 0)
    report.finish()


if __name__ == "__main__":
    main()
