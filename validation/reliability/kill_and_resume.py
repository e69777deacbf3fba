"""A run that is killed at a random instant goes on to the same bits.

`fpsolve run --checkpoint` and `fpsolve resume` are killed by SIGKILL at instants drawn
over the whole life of the process, from its first import to the removal of the
checkpoint, once or several times in a row. Claims: after every kill the checkpoint and
every result in the folder can be read, no more than one interval is lost, and the
result in the end is bitwise that of a run that was never killed.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from reporting import Report

import fpsolve as fp
from fpsolve.density.checkpoints.identity import digest_of_run
from fpsolve.density.checkpoints.manifest import MANIFEST, read_manifest
from fpsolve.density.checkpoints.snapshots import SnapshotFiles
from fpsolve.density.checkpoints.start import read_start
from fpsolve.density.checkpoints.status import status_of
from fpsolve.density.checkpoints.store import PassStore
from fpsolve.evolution.schedule import make_schedule

CHILD = Path(__file__).with_name("reporting_child.py")
# Steps between two checkpoints, and between two records.
EVERY, RECORD = 6, 2
CONFIG = """
[potential]
kind = "quadratic"
[model]
noise = 1.0
[curve]
kind = "{curve}"
[grid]
half_width = 6.0
shape = [24, 24, 16]
[initial]
kind = "gaussian"
mean = [0.5, 0.0]
variance = 0.5
[scheme]
kind = "{scheme}"
[run]
s_end = 15.0
ds = 0.125
save_every = 0.5
record_every = {record}
extrapolate = {extrapolate}
[output]
name = "killed"
format = "{format}"
figures = false
"""
CASES = [
    ("drift_kick", "netcdf", False, "fixed_belt"),
    ("drift_kick", "zarr", True, "fixed_belt"),
    ("semi_lagrangian", "netcdf", True, "rotating_nozzle"),
    ("semi_lagrangian", "zarr", False, "rotating_nozzle"),
]
NOZZLE = 'kind = "rotating_nozzle"\nradius = 0.5\nangular_speed = 0.4\nspeed = 0.1'


@dataclass
class Case:
    """One configuration, the result it should have, and what its kills showed."""

    name: str
    folder: Path
    suffix: str
    seconds: float = 0.0
    expected: Any = None
    kills: list[dict[str, Any]] = field(default_factory=list)
    results_equal: list[bool] = field(default_factory=list)

    @property
    def config(self) -> Path:
        return self.folder / "run.toml"


def start(case: Case, out: Path) -> tuple[subprocess.Popen[bytes], int]:
    """A process that begins the run in `out`, or goes on with it; its reports."""
    reading, writing = os.pipe()
    kept = out / "killed.checkpoint"
    if (kept / MANIFEST).exists():
        words = ["resume", kept]
    else:
        words = ["run", case.config, "--out", out, "--checkpoint", EVERY]
    process = subprocess.Popen(
        [sys.executable, str(CHILD), str(writing), *map(str, words)],
        pass_fds=(writing,),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    os.close(writing)
    return process, reading


def last_report(reading: int) -> int:
    """Steps done by the last report of a process that has ended."""
    with os.fdopen(reading, "rb") as pipe:
        lines = pipe.read().split(b"\n")[:-1]
    return int(lines[-1]) if lines else 0


def finish(case: Case, out: Path) -> float:
    """Let the run in `out` come to its end; seconds it took."""
    began = time.perf_counter()
    process, reading = start(case, out)
    # Reports are few enough to fit into the buffer of a pipe.
    _, complaint = process.communicate(timeout=300)
    last_report(reading)
    if process.returncode:
        raise RuntimeError(f"{case.name}: {complaint.decode()}")
    return time.perf_counter() - began


def kill(case: Case, out: Path, delay: float) -> bool:
    """Begin or go on, and kill after `delay` seconds; whether there was time to."""
    process, reading = start(case, out)
    time.sleep(delay)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    n_reported = last_report(reading)
    if process.returncode != -signal.SIGKILL:
        return False
    case.kills.append({"delay": delay, **inspect(case, out, n_reported)})
    return True


def inspect(case: Case, out: Path, n_reported: int) -> dict[str, Any]:
    """Look at everything that a kill left."""
    result, kept = out / f"killed{case.suffix}", out / "killed.checkpoint"
    found: dict[str, Any] = {"reported": n_reported, "unreadable": ""}
    found["drafts"] = sum(1 for path in kept.rglob("*") if is_draft(path))
    try:
        found["result"] = result.exists()
        if result.exists():
            fp.load(result)
        found["kept"] = read_everything(kept) if (kept / MANIFEST).exists() else None
    except Exception as error:
        found["unreadable"] = f"{type(error).__name__}: {error}"
        found["kept"] = None
    # With the result complete, or before the first step, nothing can be lost.
    kept_steps = n_reported if found["result"] else found["kept"] or 0
    found["lost"] = max(0, n_reported - kept_steps)
    return found


def is_draft(path: Path) -> bool:
    return path.name.endswith((".draft", ".partial"))


def read_everything(folder: Path) -> int:
    """Read every file of a checkpoint, checksums included; steps done in it."""
    run = read_manifest(folder).run
    read_start(folder, run)
    schedule = make_schedule(
        run["s_span"], run["ds"], run.get("save_at"), run["record_every"]
    )
    for name in ("pass-1", "pass-2"):
        files = SnapshotFiles(folder, name, digest_of_run(run))
        if len(list(files.read())) != sum(path.exists() for path in files.paths):
            raise RuntimeError(f"a snapshot of {name} is damaged")
        newest = next(files.read(), None)
        if newest is not None:
            check_store(folder, name, newest, schedule, run)
    return status_of(folder).n_done


def check_store(folder: Path, name: str, newest: Any, schedule: Any, run: Any) -> None:
    store = PassStore(
        folder / "output.zarr" / name, len(schedule.saves),
        tuple(run["scheme"]["$scheme"]["grid"]["$grid"]["shape"]),
    )  # fmt: skip
    if not store.holds(newest.n_saved):
        raise RuntimeError(f"output of {name} is missing")
    store.n_saved = newest.n_saved
    for p in store.densities():
        if not np.isfinite(p).all():
            raise RuntimeError(f"a density of {name} is not what was written")


def same(first: Any, second: Any) -> bool:
    """Whether two results agree in every bit that is not a time or a date."""
    if (first.status, first.entropy_floor) != (second.status, second.entropy_floor):
        return False
    pairs = [(first.densities, second.densities), (first.saved_s, second.saved_s)]
    for one, other in ((first.series, second.series), (first.errors, second.errors)):
        if set(one or {}) != set(other or {}):
            return False
        pairs += [(one[name], other[name]) for name in one or {}]
    return all(np.asarray(a).tobytes() == np.asarray(b).tobytes() for a, b in pairs)


def chain(case: Case, rng: np.random.Generator, length: int, number: int) -> int:
    """Kill a run up to `length` times, then let it finish; the number of kills."""
    out, n_kills = case.folder / f"out-{number}", 0
    while n_kills < length:
        if not kill(case, out, rng.uniform(0.0, case.seconds)):
            break
        n_kills += 1
    if (
        not (out / f"killed{case.suffix}").exists()
        or (out / "killed.checkpoint" / MANIFEST).exists()
    ):
        finish(case, out)
    result = fp.load(out / f"killed{case.suffix}")
    case.results_equal.append(same(result, case.expected))
    return n_kills


def make_case(folder: Path, scheme: str, form: str, extrapolate: bool, curve: str):
    text = CONFIG.format(
        scheme=scheme, format=form, extrapolate=str(extrapolate).lower(), curve=curve,
        record=RECORD,
    )  # fmt: skip
    text = text.replace('kind = "rotating_nozzle"', NOZZLE)
    name = f"{scheme}, {form}, {'ds and ds/2' if extrapolate else 'ds'}, {curve}"
    case = Case(name, folder, ".nc" if form == "netcdf" else ".zarr")
    folder.mkdir()
    case.config.write_text(text)
    # Without checkpoints, by the plain command, which also fills the compile cache.
    command = [sys.executable, "-m", "fpsolve", "run", str(case.config)]
    plain = folder / "plain"
    subprocess.run([*command, "--out", str(plain)], check=True, capture_output=True)
    case.expected = fp.load(plain / f"killed{case.suffix}")
    case.seconds = finish(case, folder / "timed")
    case.results_equal.append(
        same(fp.load(folder / "timed" / f"killed{case.suffix}"), case.expected)
    )
    return case


def row_of(case: Case) -> dict[str, Any]:
    kills = case.kills
    share = [one["delay"] / case.seconds for one in kills]
    return {
        "case": case.name,
        "kills": len(kills),
        "from": min(share),
        "to": max(share),
        "before the 1st step": sum(one["reported"] == 0 for one in kills),
        "amid a write": sum(one["drafts"] > 0 for one in kills),
        "result there": sum(one["result"] for one in kills),
        "most steps lost": max(one["lost"] for one in kills),
        "unreadable": sum(bool(one["unreadable"]) for one in kills),
        "runs": len(case.results_equal),
        "bitwise equal": sum(case.results_equal),
        "seconds": case.seconds,
    }


def check(report: Report, case: Case, row: dict[str, Any]) -> None:
    for one in case.kills:
        if one["unreadable"]:
            report.console.print(f"{case.name}: {one}")
    different = row["runs"] - row["bitwise equal"]
    report.check(f"{case.name}: unreadable files", row["unreadable"], "<=", 0)
    report.check(f"{case.name}: results that differ", different, "<=", 0)
    lost = row["most steps lost"]
    report.check(f"{case.name}: steps lost, most", lost, "<=", EVERY)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="6 kills of two cases")
    quick = parser.parse_args().quick
    report = Report("kill_and_resume", quick)
    rng = np.random.default_rng(20080611)
    n_kills, cases = (6, CASES[1:3]) if quick else (52, CASES)
    with tempfile.TemporaryDirectory() as folder:
        made = []
        for number, words in enumerate(cases):
            case = make_case(Path(folder) / str(number), *words)
            left, chains = n_kills // len(cases), 0
            while left > 0:
                length = min(left, int(rng.choice([1, 1, 2, 4])))
                left -= chain(case, rng, length, chains)
                chains += 1
                print(f"{case.name}: {len(case.kills)} kills", flush=True)
            made.append(case)
        rows = [row_of(case) for case in made]
        report.table(rows)
        total = sum(len(case.kills) for case in made)
        report.check("kills in all", total, ">", n_kills - 1)
        for case, row in zip(made, rows, strict=True):
            check(report, case, row)
        report.rows = [{**row, "instants": case.kills} for row, case in
                       zip(rows, made, strict=True)]  # fmt: skip
    report.finish()


if __name__ == "__main__":
    main()
