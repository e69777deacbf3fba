"""Peer: forty lines of numpy, Fourier collocation and fixed steps of Runge-Kutta 4.

What a numerical analyst would write in an afternoon; the transport terms are those of
the reference. The diffusion is solved exactly by an integrating factor (Lawson), so
that the step is bounded by the fastest rotation in the corners of the box alone,
whatever the noise.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from fourier import FourierCollocation
from problem import HALF_WIDTH, Problem, Result, initial_density, open_mesh
from timing import ONCE_ABOVE, Stopwatch, measure

NAME = "Fourier + RK4 (numpy)"
VERSION = np.__version__
STABLE_IMAGINARY = 2.8  # Runge-Kutta 4 is stable up to 2.83 [-i, i]
SAFETY = 0.8
SHAPES = (
    *((24, 24, 16), (32, 32, 24), (32, 32, 32), (40, 40, 32), (48, 48, 32)),
    *((48, 48, 48), (64, 64, 48), (64, 64, 64), (96, 96, 64), (128, 128, 128)),
)
# As few or as many angles as ours at this noise.
LEAN = {
    0.1: (
        (36, 36, 40), (44, 44, 56), (52, 52, 64), (60, 60, 80), (68, 68, 96),
        (80, 80, 112), (80, 96, 128), (92, 112, 144),
    ),
    0.3: ((40, 40, 40), (56, 56, 56), (76, 76, 80)),
    1.0: (
        (28, 28, 16), (32, 32, 16), (36, 36, 16), (40, 40, 24), (44, 44, 24),
        (48, 48, 24), (56, 56, 32),
    ),
    3.0: (
        (28, 28, 12), (32, 32, 12), (28, 28, 16), (32, 32, 16), (36, 36, 16),
        (40, 40, 16), (44, 44, 16), (48, 48, 16), (52, 52, 24),
    ),
    10.0: (
        (24, 24, 8), (28, 28, 8), (32, 32, 8), (36, 36, 8), (36, 36, 12), (40, 40, 16),
        (44, 44, 16), (48, 48, 16),
    ),
}  # fmt: skip
# Half of the stable step, where it bounds the error.
HALVED = {
    0.1: ((60, 60, 80), (80, 80, 112)),
    0.3: ((56, 56, 56), (64, 64, 64), (72, 72, 72), (80, 80, 80)),
    1.0: (
        (36, 36, 16), (44, 44, 24), (48, 48, 24), (48, 48, 32), (56, 56, 32),
        (56, 56, 40), (64, 64, 48),
    ),
    3.0: (
        (36, 36, 16), (44, 44, 16), (48, 48, 16), (48, 48, 32), (52, 52, 24),
        (56, 56, 40), (64, 64, 48),
    ),
    10.0: ((36, 36, 12), (40, 40, 16), (48, 48, 16), (48, 48, 32), (64, 64, 32)),
}  # fmt: skip
QUICK_RUNS = ({"shape": (16, 16, 16)},)


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost; then smaller steps, where they bound the error."""
    shapes = sorted((*SHAPES, *LEAN[problem.noise]), key=math.prod)
    largest = tuple({"shape": shape} for shape in shapes)
    halved = HALVED[problem.noise]
    return (*largest, *({"shape": shape, "share": 0.5} for shape in halved))


def stable_step(code: FourierCollocation) -> float:
    """Largest step at which RK4 damps every Fourier mode, with a margin."""
    n1, n2, n_alpha = code.shape
    shift = np.pi / (2 * code.half_width) * np.hypot(n1, n2)
    kick = np.abs(code.torque).max() * n_alpha / 2
    return SAFETY * STABLE_IMAGINARY / (shift + kick)


def heat(n: int, duration: float) -> np.ndarray:
    """exp(duration ∂_αα) on n points, to be applied from the right."""
    wavenumber = np.fft.rfftfreq(n, 1 / n)
    damped = np.exp(-duration * wavenumber**2)[:, None] * np.fft.rfft(np.eye(n), axis=0)
    return np.fft.irfft(damped, n, axis=0).T.copy()


def lawson_4(
    code: FourierCollocation, half: np.ndarray, p: np.ndarray, ds: float
) -> np.ndarray:
    """One Runge-Kutta step of the transport of e^{−sD∂²} p, D from `half`."""
    k1 = code.rate(p) @ half
    middle = p @ half
    k2 = code.rate(middle + ds / 2 * k1)
    k3 = code.rate(middle + ds / 2 * k2)
    k4 = code.rate((middle + ds * k3) @ half)
    return (middle + ds / 6 * (k1 + 2 * k2 + 2 * k3)) @ half + ds / 6 * k4


def solve(
    problem: Problem, shape: tuple[int, int, int], *, share: float = 1.0
) -> Result:
    """Solve the benchmark problem with steps of a share of the stable one."""
    with Stopwatch() as setup:
        code = FourierCollocation(HALF_WIDTH, shape, diffusivity=0.0)
        p0 = initial_density(*open_mesh(*code.axes))
        n_steps = int(np.ceil(problem.s_end / (share * stable_step(code))))
        ds = problem.s_end / n_steps
        half = heat(shape[2], problem.diffusivity * ds / 2)

    def run() -> np.ndarray:
        p = p0
        for _ in range(n_steps):
            p = lawson_4(code, half, p, ds)
        return p

    measured = measure(run, samples=3, once_above=ONCE_ABOVE)
    return Result(
        solver=NAME,
        axes=code.axes,
        density=measured.value,
        step=f"{ds:.2g}",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=setup.cpu,
        note="dense Fourier matrices",
    )
