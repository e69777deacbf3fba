"""The string keeps its energy over 1e5 steps with θ = ½, and loses it with θ = 1.

A clamped fibre falls from horizontal and whips, a chain without stiffness swings from
horizontal, a free fibre without weight spins and bends: the largest deviation of the
energy from that at the beginning, over the largest kinetic energy, is rounding; edges
have their length to 1e-12 at every step; and the spin of the free one is kept as well.
"""

from __future__ import annotations

import argparse
import os

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402

from fpsolve.fibre import Clamped, Free, Hinged, Motion, String, simulate  # noqa: E402

NOWHERE = (0.0, 0.0, 0.0)
STEP = 1e-3
# Residuals of Newton's method are 1e-12 of an edge, of either sign at every step.
MOST = 1e-9


def clamped() -> tuple[String, dict[str, object]]:
    held = Clamped(NOWHERE, (1, 0, 0))
    return String(1.0, 2e-3, 1000.0, 1e9, held, Free(), n_edges=8), {}


def chain() -> tuple[String, dict[str, object]]:
    string = String(1.0, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), Free(), n_edges=4)
    return string, {"shape": string.s[:, None] * np.array([1.0, 0.0, 0.0])}


def spinning() -> tuple[String, dict[str, object]]:
    string = String(1.0, 2e-3, 1000.0, 1e9, Free(), Free(), NOWHERE, n_edges=8)
    angles = np.linspace(-0.6, 0.6, 8)
    edges = string.edge * np.stack([np.cos(angles), np.sin(angles), 0 * angles], -1)
    shape = np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])
    velocity = np.cross([3.0, -1.0, 5.0], shape - shape.mean(axis=0))
    return string, {"shape": shape, "velocity": velocity}


CASES = {"clamped": clamped, "chain": chain, "free": spinning}


def spin(motion: Motion) -> np.ndarray:
    return np.cross(motion.r, motion.string.masses[:, None] * motion.v).sum(axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="1e4 steps")
    parser.add_argument("--case", choices=CASES, help="this one alone")
    options = parser.parse_args()
    n_steps = 10_000 if options.quick else 100_000
    report = Report("string_energy", options.quick)
    rows, motions = [], {}
    for name in [options.case] if options.case else CASES:
        string, start = CASES[name]()
        for theta in (0.5, 1.0):
            # What is lost is lost soon.
            steps = n_steps if theta == 0.5 else n_steps // 10
            motion = simulate(
                string, steps * STEP, steps, theta=theta, estimate_error=False,
                save_every=steps // 10, **start,
            )  # fmt: skip
            size = motion.kinetic.max()
            turned = spin(motion)
            rows.append({
                "fibre": name, "theta": theta, "steps": steps,
                "kinetic energy / J": size,
                "deviation": np.abs(motion.energy - motion.energy[0]).max() / size,
                "after a tenth": np.abs(
                    motion.energy - motion.energy[0])[: steps // 10].max() / size,
                "stretched": motion.stretched.max(),
                "iterations": motion.iterations[1:].mean(),
                "spin": np.abs(turned - turned[0]).max() / np.abs(turned).max(),
            })  # fmt: skip
            motions[name, theta] = motion
    report.table(rows)
    for row in rows:
        about = f"{row['fibre']}, θ = {row['theta']:g}, {row['steps']} steps"
        report.check(f"{about}: edges keep their length", row["stretched"], "<=", 1e-12)
        if row["theta"] == 1.0:
            report.check(f"{about}: energy lost", row["deviation"], ">", 1e-2)
            continue
        report.check(f"{about}: energy kept", row["deviation"], "<", MOST)
        if row["fibre"] == "free":
            report.check(f"{about}: spin kept", row["spin"], "<", MOST)
    if not options.quick:
        save_figure(drawn(motions), "string_energy.png")
    report.finish()


def drawn(motions: dict[tuple[str, float], Motion]) -> object:
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    for (name, theta), motion in motions.items():
        away = np.abs(motion.energy - motion.energy[0]) / motion.kinetic.max()
        axes.loglog(
            np.arange(1, away.size), np.maximum.accumulate(away[1:]),
            label=f"{name}, θ = {theta:g}",
        )  # fmt: skip
    axes.set(xlabel="steps", ylabel="|energy − first| / largest kinetic energy")
    axes.legend()
    return figure


if __name__ == "__main__":
    main()
