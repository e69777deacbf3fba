"""`drift_kick` as an array program: cells per second, bandwidth, error against numba.

    python validation/performance/array_namespaces.py --namespace jax --cells 64 128

For every n a density on n³ cells of the quadratic B at A = 1, with Fourier
translations: milliseconds of a step of the array program and of the kernels of the
host, cells per second, bytes and operations that a step has to move and make (counted,
elementwise parts fused with what reads them) over its time against a copy and a matrix
product of the same run, milliseconds of a record, and the largest difference of the
densities after 20 steps, relative to the largest value. "Of paper" is the time that the
parts of a step would take if each were held up by memory or by products alone, over the
time it takes. Elapsed time, medians of 5. With numpy and 64³ ten seconds.

    python validation/performance/array_namespaces.py --paper 4300 60 --cells 64 128

counts only, for a machine of 4300 GB/s and 60 TFlop/s.
"""

from __future__ import annotations

import argparse
import importlib
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve.density.arrays.array_drift_kick import ArrayDriftKick
from fpsolve.density.arrays.library import Library, on_host
from fpsolve.density.arrays.record import ArrayRecorder

HALF_WIDTH, DS, N_STEPS, SAMPLES = 6.0, 0.1, 20, 5
AT_LEAST = 0.05
# Largest difference to the host: rounding of sums of hundreds, twenty times.
ALLOWED = 1e-12
MODULES = {"numpy": "numpy", "jax": "jax.numpy", "cupy": "cupy"}
HEAD = (
    "cells", "step", "cells/s", "host step", "times", "GB/s", "of copy", "TFlop/s",
    "of DGEMM", "of paper", "record", "difference",
)  # fmt: skip


def library_named(name: str) -> Library:
    """The library, float64 switched on, on the device that it takes by itself."""
    if name == "jax":
        importlib.import_module("jax").config.update("jax_enable_x64", True)
    xp = importlib.import_module(MODULES[name])
    return Library(xp, getattr(xp.zeros(1), "device", None))


def seconds(call: Callable[[], Any]) -> float:
    """Elapsed seconds of a call, the median of a few samples after one to warm up."""
    call()
    begin = time.perf_counter()
    call()
    n_calls = max(1, round(AT_LEAST / (time.perf_counter() - begin)))
    found = []
    for _ in range(SAMPLES):
        begin = time.perf_counter()
        for _ in range(n_calls):
            call()
        found.append((time.perf_counter() - begin) / n_calls)
    return statistics.median(found)


def finished(values: Any) -> None:
    """Wait for an array: one of its numbers is brought to the host."""
    on_host(values[(slice(0, 1),) * values.ndim])


def limits(library: Library, quick: bool) -> tuple[float, float]:
    """Bytes per second of a copy, operations per second of a matrix product."""
    host = library.name == "numpy" or "cpu" in str(library.device).lower()
    n, size = (2**22, 512) if quick else (2**25, 1024) if host else (2**28, 8192)
    draw = np.random.default_rng(1).random
    # An outer product, so that the host sends little.
    left, right = library.array(draw((2**12, 1))), library.array(draw(n // 2**12))
    values = library.xp.reshape(left * right, (-1,))
    matrix = library.array(draw((size, size)))
    copy = library.compiled(added)
    copied = seconds(lambda: finished(copy(values)))
    product = library.compiled(multiplied)
    made = seconds(lambda: finished(product(matrix)))
    return 16 * n / copied, 2 * size**3 / made


def added(xp: Any, values: Any) -> Any:
    """Read once, written once."""
    return values + 1.0


def multiplied(xp: Any, matrix: Any) -> Any:
    """A square product."""
    return xp.matmul(matrix, matrix)


def counted(scheme: ArrayDriftKick) -> np.ndarray:
    """Bytes and operations of the parts of a step in the middle of a leg, (5, 2).

    Two products of a translation, that each read and write a density and the
    circulants; the transform in α, there; turning into the frames and gathering rows;
    the product of the blocks with their matrices; the way back, and the transform.
    """
    n1, n2, n = scheme.grid.shape
    cells, n_modes = n1 * n2 * n, n // 2
    _, rows, _, coefficients, matrices = scheme.kick.tables(DS)
    padded, n_nodes = rows.shape[0] * n, coefficients.shape[3]
    weighted = 0 if n_nodes == 1 else 2 * n_nodes * padded
    size_of_matrices = float(np.prod(matrices.shape))
    parts = [
        (4 * cells + n * (n1**2 + n2**2), 2 * cells * (n1 + n2)),
        (2 * cells, 2 * cells * n),
        (2 * cells + padded, 0),
        (2 * padded + weighted + size_of_matrices, 2 * padded * n_nodes * n_modes),
        (2.5 * cells + padded + 2 * cells, 2 * cells * n),
    ]
    return np.array(parts, dtype=float) * (8.0, 1.0)


def on_paper(parts: np.ndarray, machine: tuple[float, float]) -> float:
    """Seconds of a step whose parts are each held up by memory or by products."""
    return float((parts / machine).max(axis=1).sum())


def problem(n: int) -> tuple[fp.LayDownModel, fp.PhaseSpaceGrid, Any]:
    """The model, n³ cells and the scheme of the host."""
    grid = fp.PhaseSpaceGrid(half_width=HALF_WIDTH, shape=(n, n, n))
    model = fp.LayDownModel(fp.QuadraticPotential(), noise=1.0)
    return model, grid, fp.drift_kick(model, grid, translation="fourier")


def expected(cells: list[int], machine: tuple[float, float]) -> None:
    """What is counted, and what it takes on a machine of that bandwidth and rate."""
    print(f"{'cells':>5} {'bytes/cell':>10} {'Flop/cell':>10} {'step':>9} cells/s")
    for n in cells:
        _, _, host = problem(n)
        parts = counted(ArrayDriftKick(host, Library(np)))
        moved, made = parts.sum(axis=0) / n**3
        step = on_paper(parts, machine)
        print(
            f"{n:>4}³ {moved:10.0f} {made:10.0f} {1e3 * step:9.3f} {n**3 / step:7.2g}"
        )


def measured(n: int, library: Library, machine: tuple[float, float]) -> dict[str, Any]:
    """One line of the table."""
    model, grid, host = problem(n)
    p0 = fp.initial.gaussian(
        grid, mean=(1.0, 0.3), variance=0.5, angle=1.0, concentration=2.0
    )
    there = ArrayDriftKick(host, library)
    run, state = {}, {}
    for name, scheme in (("host", host), ("there", there)):
        state[name] = scheme.start(p0)
        scheme.advance(state[name], 0.0, DS, N_STEPS)
    p, q = (np.asarray(s.density(state[k])) for k, s in
            (("host", host), ("there", there)))  # fmt: skip
    difference = float(np.abs(p - q).max() / np.abs(p).max())
    # `advance` ends with the mass, which waits for the device.
    for name, scheme in (("host", host), ("there", there)):
        run[name] = seconds(
            lambda name=name, scheme=scheme: scheme.advance(
                state[name], 0.0, DS, N_STEPS
            )
        )
    density = there.density(state["there"])
    recorder = ArrayRecorder(model, grid)
    record = seconds(lambda: recorder.record(density, 0.0))
    step = run["there"] / N_STEPS
    parts = counted(there)
    moved, made = parts.sum(axis=0)
    paper = on_paper(parts, machine)
    return {
        "cells": n, "step": 1e3 * step, "cells/s": n**3 / step,
        "host step": 1e3 * run["host"] / N_STEPS, "times": run["host"] / run["there"],
        "GB/s": moved / step / 1e9, "of copy": moved / step / machine[0],
        "TFlop/s": made / step / 1e12, "of DGEMM": made / step / machine[1],
        "of paper": paper / step, "record": 1e3 * record, "difference": difference,
        "bytes per cell": moved / n**3, "operations per cell": made / n**3,
    }  # fmt: skip


def line(row: dict[str, Any]) -> str:
    """A row of the table."""
    return (
        f"{row['cells']:>4}³ {row['step']:9.3f} {row['cells/s']:9.3g} "
        f"{row['host step']:9.2f} {row['times']:7.1f} {row['GB/s']:8.0f} "
        f"{row['of copy']:7.2f} {row['TFlop/s']:8.3f} {row['of DGEMM']:8.2f} "
        f"{row['of paper']:8.2f} {row['record']:8.2f} {row['difference']:10.1e}"
    )


def main(arguments: list[str] | None = None) -> None:
    """Print a line for every grid; end with an error if one differs from the host."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--namespace", choices=MODULES, default="numpy")
    parser.add_argument("--cells", type=int, nargs="+", default=[64])
    parser.add_argument("--out", type=Path, help="the table as JSON")
    parser.add_argument("--quick", action="store_true", help="12³ and 16³ cells")
    speed = {"type": float, "nargs": 2, "metavar": ("GB/s", "TFlop/s")}
    parser.add_argument("--paper", help="count only, for such a machine", **speed)
    asked = parser.parse_args(arguments)
    cells = [12, 16] if asked.quick else asked.cells
    if asked.paper:
        expected(cells, (1e9 * asked.paper[0], 1e12 * asked.paper[1]))
        return
    library = library_named(asked.namespace)
    machine = limits(library, asked.quick)
    print(
        f"{library.origin}: copy {machine[0] / 1e9:.0f} GB/s, DGEMM "
        f"{machine[1] / 1e12:.3g} TFlop/s; milliseconds"
    )
    widths = (5, 9, 9, 9, 7, 8, 7, 8, 8, 8, 8, 10)
    print(" ".join(f"{one:>{w}}" for one, w in zip(HEAD, widths, strict=True)))
    rows = []
    for n in cells:
        rows.append(measured(n, library, machine))
        print(line(rows[-1]), flush=True)
        if asked.out:
            about = {"origin": library.origin, "copy": machine[0], "dgemm": machine[1]}
            asked.out.write_text(json.dumps({**about, "rows": rows}, indent=1) + "\n")
    worst = max(row["difference"] for row in rows)
    if not worst <= ALLOWED:
        raise SystemExit(f"differs from the host by {worst:.1e}, more than {ALLOWED:g}")


if __name__ == "__main__":
    main()
