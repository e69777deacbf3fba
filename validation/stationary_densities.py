"""Does the error that `steady_state` states cover, and is it small where it can be?

Claims: on moving belts, for every noise, speed, potential and grid that is tried, the
L1 error of the density and the error of every moment stay below what the result
states, or the call refuses; E cos α = −v and E sin α = 0 within their stated errors;
on the finer grids the default tolerance is met. Reference: the expansion in Hermite
polynomials for quadratic B, otherwise the same model on a finer grid of a larger box,
where what is stated there is at most 0.3 of what is judged.
"""

from __future__ import annotations

import argparse
import math
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from reporting import Report, restricted

import fpsolve as fp
from fpsolve.density.stationary.start import concentration_of
from fpsolve.errors import ToleranceError

DEFAULT = 1e-4
# A reference is one if its own error is below this share of what it judges.
KNOWN = 0.3
# Cells in a row of a reference.
LARGEST = 150


def off_centre() -> fp.CallablePotential:
    return fp.CallablePotential(
        lambda x, y: 0.5 * ((x - 0.6) ** 2 + (y + 0.4) ** 2),
        lambda x, y: (x - 0.6 + 0 * y, y + 0.4 + 0 * x),
    )


def rippled() -> fp.CallablePotential:
    """Neither isotropic nor convex."""
    return fp.CallablePotential(
        lambda x, y: 0.5 * (x**2 + y**2) + 0.6 * np.cos(2 * x + y),
        lambda x, y: (
            x - 1.2 * np.sin(2 * x + y), y - 0.6 * np.sin(2 * x + y),
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class Shape:
    """A potential, the half width of its e^{−B}, and a length that cells resolve."""

    name: str
    make: Callable[[], fp.Potential]
    half_width: float
    length: float
    # B″ or the slope, by which the belt is held.
    stiffness: float = 1.0


SHAPES = (
    Shape("quadratic", fp.QuadraticPotential, 5.4, 1.0),
    Shape("quadratic 1:0.6", lambda: fp.QuadraticPotential(1.0, 0.6), 5.4, 0.6),
    Shape("linear", fp.LinearPotential, 13.0, 1.0, math.nan),
    Shape("quartic", lambda: fp.PowerPotential(4.0), 3.4, 0.6),
    Shape("off centre", off_centre, 6.0, 1.0),
    Shape("rippled", rippled, 5.6, 0.6),
)
NOISES = (0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0)
SPEEDS = (0.05, 1 / 9, 0.3, 0.6)
# Cells per length, more or fewer by an odd number, angles.
GRIDS = {"coarse": (2.0, 16), "odd": (2.7, 20), "fine": (3.4, 32)}


@dataclass(frozen=True)
class Case:
    shape: Shape
    noise: float
    speed: float
    grid_name: str

    @property
    def model(self) -> fp.LayDownModel:
        return fp.LayDownModel(self.shape.make(), self.noise, fp.MovingBelt(self.speed))

    def half_width(self) -> float | None:
        """Of a box that holds the density; None if that is far from e^{−B}."""
        force = 0.5 * self.noise**2 * concentration_of(self.speed)
        if math.isnan(self.shape.stiffness):
            return self.shape.half_width / (1 - force) if force < 0.4 else None
        return self.shape.half_width + force if force < 2.5 else None

    def grid(self) -> fp.PhaseSpaceGrid | None:
        half = self.half_width()
        if half is None:
            return None
        per_length, n_alpha = GRIDS[self.grid_name]
        n = 2 * round(half * per_length / self.shape.length)
        odd = self.grid_name == "odd"
        return fp.PhaseSpaceGrid(half, (n + odd, n + odd, n_alpha))


def cases(quick: bool) -> Iterator[Case]:
    if quick:
        yield Case(SHAPES[0], 3.0, 1 / 9, "fine")
        yield Case(SHAPES[0], 1.0, 0.3, "coarse")
        yield Case(SHAPES[4], 1.0, 1 / 9, "odd")
        return
    for shape in SHAPES:
        for noise in NOISES:
            for speed in SPEEDS:
                for grid_name in GRIDS:
                    yield Case(shape, noise, speed, grid_name)


class References:
    """Densities that are known better, one for every model."""

    def __init__(self) -> None:
        self.known: dict[tuple[str, float, float], tuple[object, ...] | None] = {}

    def find(
        self, case: Case, grid: fp.PhaseSpaceGrid
    ) -> tuple[np.ndarray, float] | None:
        """The density at the centres of a grid, and its error in L1."""
        key = (case.shape.name, case.noise, case.speed)
        if key not in self.known:
            self.known[key] = self._expansion(case) or self._finer(case)
        found = self.known[key]
        if found is None:
            return None
        if isinstance(found[0], fp.SpectralSteadyState):
            p = found[0].density(grid)
            # Far out the expansion is divided by e^{−B}; its mass tells.
            mass = float(p.sum()) * grid.cell_volume
            return (p, 1e-7) if abs(mass - 1) < 1e-2 else None
        p, fine, error = found
        return restricted(p, fine, grid), error

    def _expansion(self, case: Case) -> tuple[object, ...] | None:
        if "quadratic" not in case.shape.name:
            return None
        try:
            found = fp.spectral_steady_state(
                case.model, tolerance=1e-7, memory_limit=2**29
            )
        except ToleranceError:
            return None
        return (found,)

    def _finer(self, case: Case) -> tuple[object, ...] | None:
        half = case.half_width()
        assert half is not None
        half *= 1.2
        n = 2 * round(half * 4.6 / case.shape.length)
        grid = fp.PhaseSpaceGrid(half, (n, n, 40))
        if n > LARGEST:
            return None
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            try:
                found = fp.steady_state(case.model, grid, tolerance=1e-6)
            except fp.FpsolveError:
                return None
        return found.density, grid, found.error


def measured(case: Case, references: References) -> dict[str, object] | None:
    """One row: the error, what is stated of it, and the largest share used up."""
    grid = case.grid()
    if grid is None:
        return None
    row: dict[str, object] = {
        "B": case.shape.name, "A": case.noise, "v": case.speed,
        "cells": "x".join(map(str, grid.shape)),
    }  # fmt: skip
    began = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            found = fp.steady_state(case.model, grid)
        except fp.FpsolveError as error:
            return row | {"outcome": type(error).__name__}
    row["CPU s"] = time.process_time() - began
    row["outcome"] = "met" if found.error <= DEFAULT else "warned"
    row["stated"] = found.error
    row |= {name: size for name, size in found.errors.items() if name != "iteration"}
    moments, errors = found.moments(), found.moment_errors
    row["identities"] = max(
        abs(moments["mean_cos_alpha"] + case.speed) / errors["mean_cos_alpha"],
        abs(moments["mean_sin_alpha"]) / errors["mean_sin_alpha"],
    )
    reference = references.find(case, grid)
    if reference is None or not reference[1] < KNOWN * found.error:
        return row
    inside = fp.diagnostics.l1_distance(found.density, reference[0], grid)
    outside = max(0.0, 1.0 - fp.diagnostics.mass(reference[0], grid))
    row["error"] = inside + outside
    row["of the stated"] = (inside + outside) / found.error
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="three cases")
    parser.add_argument("--potential", help="only those whose name begins like this")
    arguments = parser.parse_args()
    quick, name = arguments.quick, arguments.potential or ""
    title = "_".join(["stationary_densities", *name.split()])
    report = Report(title, quick)
    references, rows = References(), []
    for case in cases(quick):
        if not case.shape.name.startswith(name):
            continue
        row = measured(case, references)
        if row is not None:
            rows.append(row)
            report.console.print(" ".join(f"{k}={shown(v)}" for k, v in row.items()))
    if not rows:
        parser.error(f"no case has a potential that begins like {name!r}")
    finish(report, rows, whole=not name)


def shown(value: object) -> str:
    return f"{value:.2g}" if isinstance(value, float) else str(value)


def finish(report: Report, rows: list[dict[str, object]], whole: bool) -> None:
    """Counts by potential, and the claims; that some meet 1e-4 of the whole only."""
    report.rows += rows
    known = [row for row in rows if "error" in row]
    stated = [row for row in rows if "stated" in row]
    summary = []
    for name in dict.fromkeys(row["B"] for row in rows):
        mine = [row for row in rows if row["B"] == name]
        shares = [row["of the stated"] for row in mine if "error" in row]
        counts = {one: sum(row["outcome"] == one for row in mine) for one in
                  ("met", "warned")}  # fmt: skip
        summary.append({
            "B": name, "cases": len(mine), **counts,
            "refused": len(mine) - sum(counts.values()), "compared": len(shares),
            "largest share of the stated error": max(shares, default=math.nan),
            "median": float(np.median(shares)) if shares else math.nan,
        })  # fmt: skip
    report.table(summary)
    report.check("cases compared with a reference", len(known), ">", int(whole))
    report.check(
        "L1 error over the stated one", max(row["of the stated"] for row in known),
        "<", 1.0,
    )  # fmt: skip
    report.check(
        "|E cos α + v|, |E sin α| over the stated ones",
        max(row["identities"] for row in stated), "<", 1.0,
    )  # fmt: skip
    if whole:
        met = sum(row["outcome"] == "met" for row in rows)
        report.check("cases that meet 1e-4", met, ">", 0)
    report.finish()


if __name__ == "__main__":
    main()
