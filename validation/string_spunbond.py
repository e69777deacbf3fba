"""A spunbond fibre in the air of a plane jet, from a table as CFD codes export it.

A fibre of polypropylene of 20 µm is spun at 40 m/s into the developed jet of a slot,
0.5 m above a belt of 2 m/s. The jet is that of the literature: half width S x with S =
0.1, U = U₀ sech²(α y/y_½), U₀ from the momentum U_J² d of the slot, so that it falls
like x^{−1/2}, the velocity across by continuity, k = 0.08 U₀² on the axis and a bell
beside it, ε = C_μ k²/ν_T of an eddy viscosity U₀ y_½/31 (Pope, Turbulent Flows, 5.4).
`--table FILE` writes it alone, as netCDF or CSV; the fibre reads it back from netCDF by
`AirFlow.from_file`. The belt takes the air in where it arrives.

Claims: edges keep their length; a metre takes less than 10 CPU seconds; v_in t of fibre
is laid or in the air; from edges of 2 mm to 1 mm the width of the lay-down changes by
less than a quarter. What was laid is identified with both models; printed, without a
claim, are p-values and the CV of webs of the string and of both.
"""

from __future__ import annotations

import argparse
import csv
import os
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
import xarray as xr  # noqa: E402
from reporting import Report, save_figure  # noqa: E402
from string_identification import fit_of, parameters_of, webs_of  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve import fibre, plotting  # noqa: E402

# Slot: its width in m and its velocity in m/s; spreading, R_T of the eddy viscosity,
# k/U₀² on the axis, C_μ.
SLOT, JET = 0.01, 80.0
SPREADING, EDDIES, ENERGY, C_MU = 0.1, 31.0, 0.08, 0.09
HALF = float(np.arccosh(np.sqrt(2)))
# The nozzle above the belt, half the width of the table, in m; the speeds in m/s.
HEIGHT, ASIDE = 0.5, 0.4
SPUN, BELT = 40.0, 2.0
# In s: of the eddies' noise, and until what stands on the belt has been sucked down.
CORRELATED, SETTLING = 3e-4, 2e-3
# Not counted, in m; blocks for the standard error of the width.
SKIPPED, BLOCKS = 1.0, 10


class Case(NamedTuple):
    """Edges and steps."""

    edge: float
    dt: float
    metres: float


def jet() -> xr.Dataset:
    """The table: a grid in x (along the belt) and z (up), SI units."""
    x = ASIDE * np.sinh(np.linspace(-4, 4, 241)) / np.sinh(4.0)
    z = np.linspace(-0.02, HEIGHT + 0.02, 261)
    # From the virtual origin: there the axis would be as fast as the slot.
    scale = 4 / (3 * HALF) * SPREADING
    along = HEIGHT - z[None, :] + 0.02 + SLOT / scale
    axis = JET * np.sqrt(SLOT / (scale * along))
    half = SPREADING * along
    y = x[:, None] / half
    flow = axis / np.cosh(HALF * y) ** 2
    across = SPREADING * (y * flow - axis * np.tanh(HALF * y) / (2 * HALF))
    k = ENERGY * axis**2 * np.exp(-(y**2) / 2)
    dissipation = C_MU * k**2 * EDDIES / (axis * half)
    # Far aside the bell has lost all of its digits: no turbulence.
    rough = y**2 < 30
    found = {
        "velocity_x": (across, "m/s"), "velocity_z": (-flow, "m/s"),
        "k": (np.where(rough, k, 0.0), "m2/s2"),
        "dissipation": (np.where(rough, dissipation, 0.0), "m2/s3"),
    }  # fmt: skip
    return xr.Dataset(
        {
            name: (("x", "z"), one, {"units": unit})
            for name, (one, unit) in found.items()
        },
        {"x": ("x", x, {"units": "m"}), "z": ("z", z, {"units": "m"})},
    )


def write_table(path: Path) -> None:
    """As netCDF, or as the scattered points of a CSV file."""
    table = jet()
    if path.suffix.lower() != ".csv":
        table.to_netcdf(path)
        return
    frame = table.to_dataframe().reset_index()
    units = {name: table[name].attrs["units"] for name in frame}
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(f"{name} [{units[name]}]" for name in frame)
        writer.writerows(frame.to_numpy().tolist())


def spun(case: Case, air: fibre.AirFlow) -> tuple[fibre.LayDown, float]:
    """The fibre, and the CPU seconds for a metre of what was spun."""
    nozzle = fibre.Nozzle((0, 0, HEIGHT), (0.02, 0.01, -1), SPUN)
    string = fibre.String(
        0.1, 20e-6, 900.0, 1e9, nozzle, fibre.Free(), n_edges=round(0.1 / case.edge)
    )
    shape = np.array(nozzle.position) + string.s[:, None] * np.array(nozzle.direction)
    t_end = case.metres / SPUN
    began = time.process_time()
    found = fibre.lay_down(
        string, t_end, round(t_end / case.dt), shape=shape, air=air, seed=1,
        turbulence=fibre.TurbulentForce(correlation_time=CORRELATED),
        belt=fibre.Belt(BELT, settling_time=SETTLING), estimate_error=False,
    )  # fmt: skip
    return found, (time.process_time() - began) / case.metres


def width_of(curve: fp.FibreCurve) -> tuple[float, float]:
    """Standard deviation across the belt, and its error from blocks."""
    across = curve.deviations[0][:, 1]
    squares = [
        np.mean(one**2) for one in np.array_split(across - across.mean(), BLOCKS)
    ]
    width = float(np.sqrt(np.mean(squares)))
    return width, float(np.std(squares, ddof=1) / np.sqrt(BLOCKS) / (2 * width))


def described(case: Case, laid: fibre.LayDown, cost: float) -> dict[str, Any]:
    """What it took, and where it landed."""
    curve = laid.laid_curve(skip=SKIPPED)
    width, error = width_of(curve)
    late = laid.t > 0.5 * laid.t[-1]
    return {
        "edge (mm)": 1e3 * case.edge, "µs a step": 1e6 * case.dt,
        "spun (m)": case.metres, "CPU s/m": cost, "steps": laid.t.size - 1,
        "iterations a step": float(laid.iterations.sum() / (laid.t.size - 1)),
        "rejected": int(laid.rejected.sum()), "laid (m)": curve.length + SKIPPED,
        "in the air (m)": float(laid.free_length[late].mean()),
        "tension (mN)": 1e3 * float(np.median(laid.largest_tension[late])),
        "std along (mm)": 1e3 * float(curve.deviations[0][:, 0].std()),
        "std across (mm)": 1e3 * width, "± (mm)": 1e3 * error,
    }  # fmt: skip


def check(case: Case, laid: fibre.LayDown, row: dict[str, Any], report: Report) -> None:
    """Claims of one fibre."""
    name = f"edges of {1e3 * case.edge:g} mm"
    report.check(f"{name}: stretch", float(laid.stretched.max()), "<", 1e-12)
    report.check(f"{name}: CPU seconds a metre", row["CPU s/m"], "<", 10.0)
    # Of the nodes that have come out every one lies, or is in the chain.
    lies = len(laid.landed) + int((~laid.last.laid).sum())
    between = int(laid.last.laid.sum())
    came = round((0.1 + case.metres) / case.edge)
    lost = max(came - lies - between, 0)
    report.check(f"{name}: fibre lost, in edges", lost, "<", 2)


def webs(curve: fp.FibreCurve, report: Report, name: str) -> None:
    """Both models, and what CV their webs and the string's have."""
    both, parameters = [], []
    for model in ("smooth", "basic"):
        began = time.process_time()
        both.append(fp.identify(curve, model=model))
        parameters.append(parameters_of(both[-1], time.process_time() - began))
    report.table(parameters)
    report.table([fit_of(found) for found in both])
    report.table([row for found in both for row in webs_of(found)])
    save_figure(plotting.plot_identified_fibres(*both), f"{name}_figure_8.png")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few short metres")
    parser.add_argument("--metres", type=float, default=40.0, help="of every fibre")
    parser.add_argument("--edges", type=float, nargs="+", default=(2.0, 1.0), help="mm")
    parser.add_argument("--table", type=Path, help="write the flow, and nothing else")
    options = parser.parse_args()
    if options.table is not None:
        write_table(options.table)
        return
    report = Report("string_spunbond", options.quick)
    cases = [Case(1e-3 * one, 1e-5 * one, options.metres) for one in options.edges]
    if options.quick:
        cases = [Case(4e-3, 4e-5, 4.0)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "jet.nc"
        write_table(path)
        air = fibre.AirFlow.from_file(path)
    report.table([air.table_errors()])
    rows, found = [], []
    for case in cases:
        laid, cost = spun(case, air)
        rows.append(described(case, laid, cost))
        found.append(laid)
        check(case, laid, rows[-1], report)
    report.table(rows)
    if not options.quick and len(rows) == 2:
        one, other = (row["std across (mm)"] for row in rows)
        report.check("width, 2 to 1 mm, relative", abs(other / one - 1), "<", 0.25)
    if not options.quick:
        try:
            webs(found[-1].laid_curve(skip=SKIPPED), report, "string_spunbond")
        except ValueError as refused:
            # Loops that the edges do not resolve have no angles.
            report.table([{"not identified": str(refused)}])
    report.finish()


if __name__ == "__main__":
    main()
