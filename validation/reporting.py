"""What every validation script does at its end: print, assert, write JSON."""

from __future__ import annotations

import json
import operator
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from fpsolve._support.files import atomic_path
from fpsolve._support.provenance import versions

RESULTS = Path(__file__).parent / "results"
COMPARISONS = {"<": operator.lt, "<=": operator.le, ">": operator.gt}


class Report:
    """Rows, claims and their outcome; written to results/NAME.json."""

    def __init__(self, name: str, quick: bool) -> None:
        self.name, self.quick = name, quick
        self.rows: list[dict[str, Any]] = []
        self.claims: list[dict[str, Any]] = []
        self.began = time.perf_counter()
        self.console = Console(width=160)

    def table(self, rows: list[dict[str, Any]]) -> None:
        """Print rows and keep them."""
        self.rows += rows
        table = Table(title=self.name)
        for key in rows[0]:
            table.add_column(key)
        for row in rows:
            table.add_row(*(text(value) for value in row.values()))
        self.console.print(table)

    def check(self, claim: str, measured: float, relation: str, bound: float) -> None:
        """Note whether a claim holds; a NaN does not."""
        holds = bool(COMPARISONS[relation](measured, bound))
        self.claims.append(
            {"claim": claim, "measured": float(measured), "bound": float(bound),
             "relation": relation, "holds": holds}
        )  # fmt: skip
        mark = "holds" if holds else "FAILS"
        self.console.print(f"{mark}: {claim}: {measured:.3g} {relation} {bound:.3g}")

    def finish(self) -> None:
        """Write the JSON, then exit with 1 if a claim failed."""
        RESULTS.mkdir(exist_ok=True)
        setting = "quick" if self.quick else "full"
        content = {
            "name": self.name, "setting": setting, "versions": versions(),
            "seconds": time.perf_counter() - self.began,
            "rows": self.rows, "claims": self.claims,
        }  # fmt: skip
        path = RESULTS / f"{self.name}_{setting}.json"
        with atomic_path(path) as draft:
            draft.write_text(json.dumps(content, indent=1))
        failed = [claim for claim in self.claims if not claim["holds"]]
        if failed:
            sys.exit(f"{len(failed)} of {len(self.claims)} claims failed")
        self.console.print(f"all {len(self.claims)} claims hold")


def save_figure(figure: Any, name: str, **options: Any) -> None:
    """Write a figure beside the numbers, whole or not at all."""
    RESULTS.mkdir(exist_ok=True)
    with atomic_path(RESULTS / name) as draft:
        figure.savefig(draft, **options)


def text(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def trigonometric(n: int, low: float, width: float, places: np.ndarray) -> np.ndarray:
    """Matrix from n cell-centred values on [low, low + width) to other places."""
    first = low + 0.5 * width / n
    modes = np.fft.fftfreq(n, 1 / n)
    evaluate = np.exp(2j * np.pi * np.outer(places - first, modes) / width)
    if n % 2 == 0:
        evaluate[:, n // 2] = np.cos(np.pi * n * (places - first) / width)
    transform = np.exp(-2j * np.pi * np.outer(modes, np.arange(n)) / n) / n
    return (evaluate @ transform).real


def restricted(p: np.ndarray, fine: Any, grid: Any) -> np.ndarray:
    """A density on a fine grid at the cell centres of another, spectrally."""
    half1, half2 = fine.half_widths
    matrix1 = trigonometric(fine.shape[0], -half1, 2 * half1, grid.xi1)
    matrix2 = trigonometric(fine.shape[1], -half2, 2 * half2, grid.xi2)
    matrix3 = trigonometric(fine.shape[2], 0.0, 2 * np.pi, grid.alpha)
    return np.einsum("ai,bj,ck,ijk->abc", matrix1, matrix2, matrix3, p, optimize=True)
