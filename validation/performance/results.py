"""The numbers of a part of the benchmark: one JSON file each, kept with the code."""

from __future__ import annotations

import argparse
import json
import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "results"
PACKAGES = (
    *("fpsolve", "numpy", "scipy", "numba"),
    *("py-pde", "fipy", "dedalus", "fplanck"),
)
THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


def set_threads(n_threads: int) -> None:
    """Fix the number of threads; numpy and numba read it when they are imported."""
    for name in THREAD_VARIABLES:
        os.environ[name] = str(n_threads)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Options that every part has."""
    parser.add_argument(
        "--quick", action="store_true", help="tiny grids; numbers mean nothing"
    )
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for results")


def installed_versions() -> dict[str, str | None]:
    """Versions of Python and of everything that is compared."""
    found: dict[str, str | None] = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = None
    return found


def run_record() -> dict[str, Any]:
    """When, with what and on what a part was run; no name of a machine or a folder."""
    from machine import processor_name

    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": installed_versions(),
        "processor": processor_name(),
        "n_cpus": os.cpu_count() or 1,
        "threads": int(os.environ.get("NUMBA_NUM_THREADS", 0)) or None,
    }


def path_of(part: str, folder: Path = FOLDER, *, quick: bool = False) -> Path:
    """File of a part; those of quick runs have another name and are not kept."""
    return folder / f"{'quick' if quick else 'benchmark'}-{part}.json"


def write_part(
    part: str, content: dict[str, Any], arguments: argparse.Namespace
) -> None:
    """Write the numbers of a part where its options say, and say so."""
    path = path_of(part, arguments.out, quick=arguments.quick)
    write_json(path, content)
    print(f"written: {path.name}")


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write the numbers; the file appears complete or not at all."""
    from fpsolve._support.files import atomic_path

    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(rounded(content), indent=1, ensure_ascii=False)
    with atomic_path(path) as draft:
        draft.write_text(text + "\n", encoding="utf-8")


def rounded(value: Any) -> Any:
    """Floats with six digits, which is more than a clock has; keys as text."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {str(key): rounded(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(entry) for entry in value]
    return value


def read_part(part: str, folder: Path = FOLDER, *, quick: bool = False) -> Any:
    """Numbers of a part; FileNotFoundError if it was not run."""
    return json.loads(path_of(part, folder, quick=quick).read_text("utf-8"))
