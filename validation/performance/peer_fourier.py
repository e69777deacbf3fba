"""Peer: forty lines of numpy, Fourier collocation and fixed steps of Runge-Kutta 4.

What a numerical analyst would write in an afternoon; the right-hand side is that of
the reference. Explicit, so the step is bounded by the fastest rotation in the corners
of the box and by the diffusion of the shortest angular wave.
"""

from __future__ import annotations

import numpy as np
from problem import DIFFUSIVITY, HALF_WIDTH, Result, initial_density, open_mesh
from reference import FourierCollocation
from timing import Stopwatch, measure

NAME = "Fourier + RK4 (numpy)"
VERSION = np.__version__
STABLE_IMAGINARY = 2.8  # Runge-Kutta 4 is stable on about [-2.78, 0] and 2.83 [-i, i]
SAFETY = 0.8
RUNS = tuple(
    {"shape": shape}
    for shape in ((24, 24, 16), (32, 32, 24), (40, 40, 32), (48, 48, 32))
)
QUICK_RUNS = ({"shape": (24, 24, 16)},)


def stable_step(code: FourierCollocation) -> float:
    """Largest step at which RK4 damps every Fourier mode, with a margin."""
    n1, n2, n_alpha = code.shape
    shift = np.pi / (2 * code.half_width) * np.hypot(n1, n2)
    kick = np.abs(code.torque).max() * n_alpha / 2
    return SAFETY * STABLE_IMAGINARY / (shift + kick + DIFFUSIVITY * n_alpha**2 / 4)


def runge_kutta_4(code: FourierCollocation, p: np.ndarray, ds: float) -> np.ndarray:
    """One classical Runge-Kutta step."""
    k1 = code.rate(p)
    k2 = code.rate(p + ds / 2 * k1)
    k3 = code.rate(p + ds / 2 * k2)
    k4 = code.rate(p + ds * k3)
    return p + ds / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def solve(s_end: float, shape: tuple[int, int, int]) -> Result:
    """Solve the benchmark problem."""
    with Stopwatch() as setup:
        code = FourierCollocation(HALF_WIDTH, shape)
        p0 = initial_density(*open_mesh(*code.axes))
    n_steps = int(np.ceil(s_end / stable_step(code)))

    def run() -> np.ndarray:
        p = p0
        for _ in range(n_steps):
            p = runge_kutta_4(code, p, s_end / n_steps)
        return p

    measured = measure(run, samples=3)
    return Result(
        solver=NAME,
        axes=code.axes,
        density=measured.value,
        step=f"{s_end / n_steps:.2g}",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=setup.cpu,
        note="dense Fourier matrices",
    )
