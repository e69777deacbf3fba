"""Command lines with random options: exit codes, one line of error, whole files."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from .configurations import run_toml, written_paths, written_run
from .draws import between, log_between, one_of
from .families import family
from .terminal import called, check_files, check_manners, everything

NUMBERS = (
    "0",
    "-1",
    "1e-300",
    "1e300",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "0x10",
    "1_0",
    "½",
    "",
    " ",
    "1,5",
    "1e-12",
    "9999999999999999999999",
)


def number(rng: Any, ordinary: Any) -> str:
    """An ordinary number, mostly."""
    return str(ordinary) if rng.random() < 0.8 else one_of(rng, *NUMBERS)


def potential_words(rng: Any) -> list[str]:
    kind = one_of(rng, "quadratic", "linear", "power", "free", "Quadratic")
    words = ["--potential", kind] if rng.random() < 0.8 else []
    if kind == "quadratic" and rng.random() < 0.5:
        words += ["--sigma1", number(rng, between(rng, 0.5, 2.0))]
    if kind == "quadratic" and rng.random() < 0.3:
        words += ["--sigma2", number(rng, between(rng, 0.5, 2.0))]
    if kind == "linear" and rng.random() < 0.5:
        words += ["--slope", number(rng, between(rng, 0.5, 2.0))]
    if kind == "power" and rng.random() < 0.7:
        words += ["--exponent", number(rng, between(rng, 1.0, 5.0))]
    return words


def figures(rng: Any) -> list[str]:
    return [] if rng.random() < 0.15 else ["--no-figures"]


@family(30, 3)
def spectrum_words(rng: Any, notes: Any) -> None:
    """`fpsolve spectrum`: the gap that is printed is at most A²/2 for isotropic B."""
    words = ["spectrum", *potential_words(rng), *figures(rng)]
    noise = number(rng, log_between(rng, 0.05, 4.0))
    words += ["--noise", noise, "--tolerance", number(rng, 1e-4)]
    words += ["--count", number(rng, int(rng.integers(1, 6)))]
    belt = rng.random() < 0.3
    if belt:
        words += ["--belt-speed", number(rng, between(rng, -0.3, 0.3))]
    done = called(notes, words)
    check_manners(notes, done)
    found = check_files(notes, done)
    if done.exit_code or belt or "--sigma2" in words:
        return
    gap = float(found["results/spectrum.nc"].attrs["gap"])
    bound = 0.5 * float(noise) ** 2
    notes.holds(f"gap {gap} ≤ A²/2 = {bound}", gap <= bound * (1 + 1e-3))


@family(26, 2)
def energy_words(rng: Any, notes: Any) -> None:
    """`fpsolve energy`: rates of the odd family begin with A²/2."""
    words = ["energy", *potential_words(rng), *figures(rng)]
    noise = number(rng, log_between(rng, 0.01, 3.0))
    words += ["--noise", noise, "--energies", number(rng, int(rng.integers(1, 9)))]
    words += ["--count", number(rng, int(rng.integers(1, 4)))]
    if rng.random() < 0.4:
        words += ["--passage", number(rng, between(rng, 0.1, 0.4)), number(rng, 0.05)]
    done = called(notes, words)
    check_manners(notes, done)
    found = check_files(notes, done)
    if done.exit_code == 0:
        rates = found["results/energy.nc"]["eigenvalue"].sel(family="odd")
        first = abs(float(rates[0]))
        notes.close("A²/2", first, 0.5 * float(noise) ** 2, 1e-6 * first)


@family(30, 3)
def run_words(rng: Any, notes: Any) -> None:
    """`fpsolve run` of a small file with options, then what is done with its result."""
    Path("run.toml").write_text(run_toml(), encoding="utf-8")
    out = one_of(rng, "results", "results", "ä ö", "a/b/c", ".")
    words = ["run", "run.toml", "--out", out, *figures(rng)]
    if rng.random() < 0.4:
        every = one_of(
            rng,
            "1",
            "3",
            "1s",
            "2min",
            "0.5h",
            "0",
            "1e9",
            "-1",
            "1d",
            "nan",
            "infs",
            "1e400s",
            "٣",
        )
        words += ["--checkpoint", every, *one_of(rng, [], ["--keep-checkpoint"])]
    if rng.random() < 0.2:
        words += ["--threads", one_of(rng, "1", "2", "64", "-1", "1e1")]
    done = called(notes, words)
    check_manners(notes, done)
    found = check_files(notes, done)
    if done.exit_code:
        return
    result = found[str(Path(out) / "small.nc")]
    notes.close("mass", result.mass, 1.0, 1e-9)
    follow_up(rng, notes, str(Path(out) / "small.nc"))


def follow_up(rng: Any, notes: Any, result: str) -> None:
    """Another command on a result that is there."""
    words = one_of(
        rng,
        ["plot", result, "--out", "figures"],
        ["plot", result, "--movie", "--fps", number(rng, 4)],
        ["report", result, "--out", one_of(rng, "page.html", "page", "x/page.html")],
        ["report", result, result, "--title", one_of(rng, "<b>&", "", "ä" * 300)],
        ["rerun", result, "--out", one_of(rng, "again", "again/deeper", ".")],
        ["compare", result, result, "--tolerance", number(rng, 1e-9)],
        ["compare", result, "run.toml"],
        ["plot", "run.toml"],
        ["report", "."],
        ["rerun", "run.toml"],
        ["resume", "."],
        ["resume", result],
    )
    before = everything()
    done = called(notes, words)
    check_manners(notes, done)
    if done.exit_code == 2:
        notes.holds(
            f"nothing is written: {everything() - before}", everything() == before
        )


@family(24, 2)
def paths_words(rng: Any, notes: Any) -> None:
    """`fpsolve paths` of a random file: moments in the file are finite."""
    written_paths(rng, notes)
    words = ["paths", "paths.toml", *figures(rng)]
    if rng.random() < 0.4:
        words += ["--n-paths", number(rng, int(rng.integers(1, 60)))]
    if rng.random() < 0.4:
        words += ["--seed", number(rng, int(rng.integers(0, 2**31)))]
    done = called(notes, words)
    check_manners(notes, done)
    found = check_files(notes, done)
    if done.exit_code == 0:
        for result in found.values():
            if hasattr(result, "moments"):
                values = result.moments().values["mean_xi1"]
                notes.holds("finite", np.isfinite(values).all())


@family(8, 1)
def check_words(rng: Any, notes: Any) -> None:
    """`fpsolve check`: density and paths of a file that is in order agree."""
    Path("run.toml").write_text(
        run_toml(shape="[40, 40, 16]", ds=0.0625), encoding="utf-8"
    )
    words = ["check", "run.toml", "--n-paths", number(rng, 4000), *figures(rng)]
    words += ["--at", number(rng, one_of(rng, 0.5, 1.0)), "--seed", "3"]
    if rng.random() < 0.3:
        words += ["--false-alarm", number(rng, 1e-4)]
    if rng.random() < 0.3:
        words += ["--paths-ds", number(rng, 0.05)]
    done = called(notes, words)
    check_manners(notes, done)
    check_files(notes, done)
    notes.holds("they agree", not re.search("DISAGREE", done.output))


@family(8, 1)
def rate_words(rng: Any, notes: Any) -> None:
    """`fpsolve rate`, its cheap parts: the gap is at most A²/2 where B is isotropic."""
    words = ["rate", *potential_words(rng), "--quick", "--workers", "0", *figures(rng)]
    noise = number(rng, between(rng, 0.7, 3.0))
    words += ["--noise", noise, "--part", one_of(rng, "gap", "gap", "branches", "gaps")]
    done = called(notes, words)
    check_manners(notes, done)
    found = check_files(notes, done)
    if done.exit_code == 0 and "gap" in words and "--sigma2" not in words:
        for result in found.values():
            gaps = np.ravel(result["gap"])
            notes.holds(f"gaps {gaps}", np.all(gaps <= 0.5 * float(noise) ** 2 * 1.001))


@family(14, 1)
def other_words(rng: Any, notes: Any) -> None:
    """Commands without a result, or with words that fit nothing."""
    words = one_of(
        rng,
        ["info"],
        ["info", "info"],
        ["--version"],
        ["--help"],
        [],
        ["run", "--help"],
        [
            "limits",
            one_of(rng, "small", "large-noise", ""),
            "--noise",
            number(rng, 2.0),
            "--potential",
            "free",
        ],
        [
            "limits",
            "small-noise",
            "--noise",
            one_of(rng, *NUMBERS),
            "--quick",
            "--workers",
            one_of(rng, "-1", "x", "1.5"),
        ],
        ["plot", one_of(rng, "", "/", "missing.nc", "\x01", "a" * 300)],
        ["report", one_of(rng, "", "/", "missing.nc", "a" * 300)],
        ["rerun", one_of(rng, "", "/", "missing.zarr", "a" * 300)],
        ["compare", one_of(rng, "", "/"), "missing.nc"],
        ["resume", one_of(rng, "", "/", "missing", "a" * 300)],
        ["run", one_of(rng, "", "/", "missing.toml", "a" * 300)],
        ["paths", one_of(rng, "", "/", "missing.toml", "a" * 300)],
        ["check", one_of(rng, "", "/", "missing.toml"), "--n-paths", number(rng, 1000)],
        ["run", "--out", one_of(rng, "", "a" * 300, "\x01", "x\ny"), "missing.toml"],
    )
    done = called(notes, words)
    check_manners(notes, done)
    check_files(notes, done)


def mean_decay(noise: float, s: float) -> float:
    """e^{−A²s/2}."""
    return math.exp(-0.5 * noise**2 * s)


@family(60, 6)
def configured_runs(rng: Any, notes: Any) -> None:
    """`fpsolve run` of a random file, sound or not."""
    sound = written_run(rng, notes)
    done = called(notes, ["run", "run.toml", *figures(rng)])
    check_manners(notes, done)
    found = check_files(notes, done)
    for name, result in found.items():
        if done.exit_code == 0 and hasattr(result, "densities"):
            notes.close(f"mass of {name}", result.mass, 1.0, 1e-6)
            notes.holds("finite", all(np.isfinite(p).all() for p in result.densities))
            again = called(
                notes, ["run", "results/result.toml", "--out", "again", "--no-figures"]
            )
            notes.holds("the written file runs", again.exit_code == 0)
    if sound and done.exit_code:
        # Large steps may end a sound run, where it says at which one and what helps.
        stopped = "(step " in done.stderr and ";" in done.stderr
        notes.holds(f"a sound file runs: {done.stderr[-300:]}", stopped)
