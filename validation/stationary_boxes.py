"""Does the share of the box in the error that `steady_state` states cover?

Claims: the same cells in a box that is much larger give a density that differs by less
than is stated, for every potential, noise and speed that is tried; and where the box
has the largest share of what is stated, by less than that share alone. (Where cells or
angles have the largest, two boxes differ by what their grids do: in the corners of the
larger one the force is larger.) Moments differ by less than is stated of them.
"""

from __future__ import annotations

import argparse
import math
import warnings
from collections.abc import Iterator

import numpy as np
from reporting import Report
from stationary_densities import SHAPES, Shape

import fpsolve as fp
from fpsolve.density.stationary.start import concentration_of

# Half widths at which e^{−B} is 1e-3 or so of its largest.
TIGHT = {
    "quadratic": 3.5, "quadratic 1:0.6": 3.5, "linear": 7.0, "quartic": 2.3,
    "off centre": 4.2, "rippled": 4.0,
}  # fmt: skip
# Boxes relative to these; the last is the reference.
WIDTHS = (1.0, 1.2, 1.9)
NOISES, SPEEDS = (0.5, 1.0, 2.0, 4.0), (0.05, 0.3, 0.6)
CELLS_PER_LENGTH, ANGLES = 2.2, 16


def boxes(
    shape: Shape, noise: float, speed: float
) -> Iterator[tuple[fp.SteadyState, float]]:
    """Densities in boxes of the same cells, and their widths, the largest first."""
    force = 0.5 * noise**2 * concentration_of(speed)
    linear = math.isnan(shape.stiffness)
    if force > (0.4 if linear else 2.5):
        return
    cell = shape.length / CELLS_PER_LENGTH
    model = fp.LayDownModel(shape.make(), noise, fp.MovingBelt(speed))
    for width in reversed(WIDTHS):
        half = width * TIGHT[shape.name]
        half = half / (1 - force) if linear else half + force
        n = 2 * round(half / cell)
        grid = fp.PhaseSpaceGrid(n * cell / 2, (n, n, ANGLES))
        try:
            # Half of the density may stand in the box, and be resolved badly.
            yield (
                fp.steady_state(
                    model, grid, boundary_tolerance=1.0, error_tolerance=1.0
                ),
                width,
            )
        except fp.FpsolveError:
            if width == max(WIDTHS):
                return


def compared(found: fp.SteadyState, reference: fp.SteadyState) -> dict[str, float]:
    """Distance of the density in a small box to that in a large one, and shares."""
    grid = found.grid
    margin = (reference.grid.shape[0] - grid.shape[0]) // 2
    inner = reference.density[margin:-margin, margin:-margin]
    inside = float(np.abs(inner - found.density).sum()) * grid.cell_volume
    outside = max(0.0, 1.0 - float(inner.sum()) * grid.cell_volume)
    moments, others = found.moments(), reference.moments()
    box, cells = found.errors["box"], found.errors["grid"]
    return {
        "difference": inside + outside, "box": box, "grid": cells,
        "of the stated": (inside + outside) / found.error,
        "of the box": (inside + outside) / box if box > cells else math.nan,
        "moments": max(
            abs(moments[name] - others[name]) / error
            for name, error in found.moment_errors.items()
        ),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one potential, A = 2")
    quick = parser.parse_args().quick
    warnings.simplefilter("ignore", UserWarning)
    report, rows = Report("stationary_boxes", quick), []
    for shape in SHAPES[:1] if quick else SHAPES:
        for noise in (2.0,) if quick else NOISES:
            for speed in SPEEDS:
                results = list(boxes(shape, noise, speed))
                for found, width in results[1:]:
                    rows.append(
                        {"B": shape.name, "A": noise, "v": speed, "width": width}
                        | compared(found, results[0][0])
                    )
    report.table(rows)
    for name in ("of the stated", "of the box", "moments"):
        shares = [row[name] for row in rows if math.isfinite(row[name])]
        report.check(f"difference, {name} ({len(shares)})", max(shares), "<", 1.0)
    report.finish()


if __name__ == "__main__":
    main()
