"""What the motion of a string costs: an iteration, a step, a metre of fibre laid.

Claims: an iteration, with its share of the series of a step, takes less than three
times what it took on a core of 2 GHz; a shared machine is allowed the rest. A metre of
a fibre of 20 µm, spun at 20 m/s into eddies of 8 m/s a decimetre above the belt, with
edges of a millimetre, takes less than 10 CPU seconds.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).parents[1]))
import numpy as np
from reporting import Report

from fpsolve import fibre

STIFF = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}


def costs(n_edges: int, air: fibre.AirFlow | None, repeats: int) -> tuple[float, float]:
    """CPU seconds of a step and of an iteration: the best of several short motions."""
    held = fibre.Clamped((0, 0, 0), (1, 0, 0))
    string = fibre.String(1.0, **STIFF, start=held, end=fibre.Free(), n_edges=n_edges)
    found = []
    for _ in range(repeats):
        began = time.process_time()
        motion = fibre.simulate(string, 0.05, 50, air=air, estimate_error=False)
        took = time.process_time() - began
        found.append((took / 50, took / motion.iterations.sum()))
    return min(found)


def eddies(r: np.ndarray, t: float) -> np.ndarray:
    """Down to the belt ever slower, and aside in waves that pass."""
    height = np.clip(r[:, 2], 0.0, 0.1) / 0.1
    found = np.zeros_like(r)
    found[:, 2] = -40.0 * height
    waves = 2 * np.pi / 0.03
    found[:, 0] = 8.0 * np.sin(waves * (r[:, 1] + 1.2 * t)) * height
    found[:, 1] = 8.0 * np.sin(waves * (r[:, 0] - t) + 1.0) * height
    return found


def metre(edge: float, dt: float, t_end: float) -> dict[str, float]:
    """CPU seconds for a metre of fine fibre, with edges and steps of a length."""
    nozzle = fibre.Nozzle((0, 0, 0.1), (0.05, 0.02, -1), speed=20.0)
    string = fibre.String(
        0.05, 20e-6, 900.0, 1e9, nozzle, fibre.Free(), n_edges=round(0.05 / edge)
    )
    shape = np.array(nozzle.position) + string.s[:, None] * np.array(nozzle.direction)
    began = time.process_time()
    laid = fibre.lay_down(
        string, t_end, round(t_end / dt), belt=fibre.Belt(2.0, settling_time=5e-3),
        shape=shape, air=fibre.AirFlow(eddies), estimate_error=False,
    )  # fmt: skip
    took = time.process_time() - began
    lies = edge * len(laid.landed)
    return {
        "edge (mm)": 1e3 * edge, "µs a step": 1e6 * dt, "laid (m)": lies,
        "in the air (m)": laid.free_length[-1], "CPU s/m": took / lies,
        "width (mm)": 1e3 * laid.landed[:, 1].std(),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report = Report("string_motion", quick)
    rows = []
    for n_edges, allowed in ((32, 60e-6), (64, 65e-6), (300, 130e-6)):
        for name, air in (("none", None), ("uniform", fibre.AirFlow((1.0, 0, 0)))):
            step, iteration = costs(n_edges, air, 10 if quick else 50)
            rows.append(
                {"edges": n_edges, "air": name, "µs/step": 1e6 * step}
                | {"µs/iteration": 1e6 * iteration}
            )
            claim = f"seconds an iteration, {n_edges} edges, air: {name}"
            report.check(claim, iteration, "<=", 3 * allowed)
    report.table(rows)
    metre(2e-3, 2e-5, 0.01)
    cases = [(2e-3, 2e-5), (1e-3, 1e-5)] + ([] if quick else [(5e-4, 5e-6)])
    laid = [metre(*case, 0.02 if quick else 0.1) for case in cases]
    report.table(laid)
    report.check("CPU seconds a metre, 1 mm", laid[1]["CPU s/m"], "<=", 10.0)
    report.finish()


if __name__ == "__main__":
    main()
