"""A fibre in white noise: variances of small vibrations, and laws of large motions.

Small vibrations of a damped cantilever, by the step that moves fibres of any shape: the
mean square displacement of every node over a long time is A² G(s, s)/(2c) with θ = ½
and, with other θ, what −(AP + PA^T) + (2θ − 1) Δ APA^T = Q says of its modes, which is
less. Large motions of a fibre with bending stiffness from rest: their mean and mean
square in the same noise at steps of Δ and 2Δ differ the less the shorter they are.
Standard errors come from independent fibres.
"""

from __future__ import annotations

import argparse
import os

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402
from scipy.special import stdtrit  # noqa: E402

from fpsolve.fibre import (  # noqa: E402
    Clamped,
    Free,
    Modes,
    RandomForce,
    String,
    equilibrium,
    modes,
    simulate,
)
from fpsolve.fibre.random_force import Draws  # noqa: E402
from fpsolve.fibre.theta_step import ThetaStep  # noqa: E402

HELD = Clamped((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
SMALL, LARGE = 2e-5, 3e-3
DAMPING = 2e-3
# Steps of a period of the slowest vibration, periods of a run; thetas.
STEPS, PERIODS, THETAS = 50, 40, (0.5, 0.6, 1.0)
# Of a large motion: time in s, finest steps, and how many of these make one.
TIME, FINEST, PIECES = 0.5, 512, (1, 2, 4, 8, 16)
# Once in so many studies chance alone goes beyond a bound.
ONCE_IN = 100


def fibre(n_edges: int) -> String:
    return String(1.0, 2e-3, 1000.0, 1e9, HELD, Free(), (0.0, 0.0, 0.0), n_edges)


def of_scheme(omega: float, gamma: float, noise: float, delta: float) -> float:
    """⟨x²⟩ of x'' = −ω² x − γ x' + σ ξ, δ = (2θ − 1) Δ, by its linear equation."""
    a = np.array([[0.0, 1.0], [-(omega**2), -gamma]])
    one = np.eye(2)
    equation = -np.kron(a, one) - np.kron(one, a) + delta * np.kron(a, a)
    return float(np.linalg.solve(equation, [0.0, 0.0, 0.0, noise**2])[0])


def expected(vibrations: Modes, delta: float) -> np.ndarray:
    """Mean squares of every node across the fibre."""
    string = vibrations.equilibrium.string
    noise = SMALL / string.line_density**0.5
    gamma = DAMPING / string.line_density
    return sum(
        of_scheme(omega, gamma, noise, delta) * shape[:, 1] ** 2
        for omega, shape in zip(
            vibrations.angular_frequencies, vibrations.displacements, strict=True
        )
    )


def small_vibrations(report: Report, n_fibres: int) -> dict[str, object]:
    """Mean squares over time of fibres, beside the formula of their scheme."""
    string = fibre(6)
    vibrations = modes(equilibrium(string), 2 * string.n_edges)
    period = 2 * np.pi / vibrations.angular_frequencies[0]
    dt, rows, found = period / STEPS, [], {}
    exact = expected(vibrations, 0.0)
    for theta in THETAS:
        squares = []
        for seed in range(n_fibres):
            motion = simulate(
                string, PERIODS * period, PERIODS * STEPS, theta=theta, seed=seed,
                damping=DAMPING, turbulence=RandomForce(SMALL), save_every=5,
                estimate_error=False,
            )  # fmt: skip
            later = motion.saved > 0.25 * motion.t[-1]
            squares.append((motion.r[later][:, :, 1:] ** 2).mean(axis=(0, 2)))
        mean = np.mean(squares, axis=0)
        error = np.std(squares, axis=0, ddof=1) / np.sqrt(n_fibres)
        formula = expected(vibrations, (2 * theta - 1) * dt)
        z = (mean - formula)[1:] / error[1:]
        found[theta] = (formula, mean, error)
        rows.append({
            "theta": theta, "tip / m": mean[-1] ** 0.5,
            "formula / m": formula[-1] ** 0.5, "kept": formula[-1] / exact[-1],
            "standard error": error[-1] / mean[-1],
            "largest |z|": np.abs(z).max(),
        })  # fmt: skip
    report.table(rows)
    scores = len(THETAS) * string.n_edges
    bound = float(stdtrit(n_fibres - 1, 1 - 0.5 / (ONCE_IN * scores)))
    for row in rows:
        about = f"small vibrations, θ = {row['theta']:g}: largest |z| of six nodes"
        report.check(about, row["largest |z|"], "<", bound)
    exactly = SMALL**2 / (2 * DAMPING) / (3 * string.bending_stiffness)
    report.check(
        "sum over modes at the tip beside A² L³/(6 c EI): order 2 of six edges",
        abs(exact[-1] / exactly - 1), "<", 0.02,
    )  # fmt: skip
    return {"s": string.s, "found": found}


def large_motion(seed: int, pieces: int) -> np.ndarray:
    """Means over one fibre of what is measured, at steps of so many pieces."""
    string = fibre(4)
    n_steps = FINEST // pieces
    dt = TIME / n_steps
    draws = Draws(RandomForce(LARGE), string, None, dt, seed, pieces)
    step = ThetaStep(string, dt, 0.5, DAMPING)
    r = string.s[:, None] * np.array(HELD.direction)
    v, tension = np.zeros(r.shape), np.zeros(string.n_edges)
    for number in range(n_steps):
        force = draws.value(number + 1, r, v, number * dt)
        r, v, tension, _ = step(r, v, tension, number * dt, force)
    return np.array([
        1 - r[-1, 0], (r[-1, 1:] ** 2).mean(), 0.5 * string.masses @ (v**2).sum(axis=1)
    ])  # fmt: skip


def large_motions(report: Report, n_fibres: int, pieces: tuple[int, ...]) -> None:
    """Changes of means at halved steps, in the same noise, beside their errors."""
    found = np.array([[large_motion(seed, n) for n in pieces]
                      for seed in range(n_fibres)])  # fmt: skip
    rows, changes = [], found[:, 1:] - found[:, :-1]
    names = ("shortening / m", "mean square across / m²", "kinetic energy / J")
    errors = changes.std(axis=0, ddof=1) / np.sqrt(n_fibres)
    for k, name in enumerate(names):
        for i, n in enumerate(pieces[:-1]):
            mean, error = changes[:, i, k].mean(), errors[i, k]
            rows.append({
                "mean of": name, "steps": f"{FINEST // n} and half as many",
                "finer": found[:, i, k].mean(), "change": mean,
                "standard error": error, "in errors": mean / error,
                "typical change": np.sqrt((changes[:, i, k] ** 2).mean()),
            })  # fmt: skip
    report.table(rows)
    for k, name in enumerate(names):
        change = abs(changes[:, 0, k].mean())
        share = (change + 3 * errors[0, k]) / found[:, 0, k].mean()
        report.check(
            f"{name}: change at the last halving, with 3 errors, of the mean",
            share, "<", 0.02 if n_fibres > 100 else 0.1,
        )  # fmt: skip
        typical = np.sqrt((changes[:, :, k] ** 2).mean(axis=0))
        order = np.log2(typical[-1] / typical[0]) / (len(pieces) - 2)
        report.check(f"{name}: order of typical changes, same noise", order, ">", 0.5)


def drawn(small: dict[str, object]) -> object:
    from matplotlib.figure import Figure

    figure = Figure(layout="constrained")
    axes = figure.subplots()
    for theta, (formula, mean, error) in small["found"].items():
        (line,) = axes.plot(small["s"], 1e3 * formula**0.5, label=f"θ = {theta:g}")
        axes.errorbar(
            small["s"], 1e3 * mean**0.5, 1e3 * error / np.maximum(mean, 1e-30) ** 0.5,
            fmt="o", color=line.get_color(),
        )  # fmt: skip
    axes.set(xlabel="s / m", ylabel="root mean square across the fibre / mm")
    axes.legend(title="lines: formula of the scheme")
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few fibres")
    options = parser.parse_args()
    report = Report("string_noise", options.quick)
    small = small_vibrations(report, 5 if options.quick else 12)
    pieces = PIECES[1:] if options.quick else PIECES
    large_motions(report, 16 if options.quick else 400, pieces)
    save_figure(drawn(small), "string_noise.png")
    report.finish()


if __name__ == "__main__":
    main()
