"""Peer: Dedalus 3, Fourier in all directions, mixed explicit-implicit Runge-Kutta.

Dedalus needs MPI and FFTW at installation (README.md). It may be absent:
importing this module then raises ImportError, which `run.py` reports and goes on.
The transport terms are explicit (their coefficients vary), the α-diffusion implicit.
`dealias=1`: with 3/2 the coefficients, which jump at the edge of the box, would be
cut off after the first half of their Fourier series.
"""

from __future__ import annotations

import logging
import math
from importlib.metadata import version
from typing import Any

import dedalus.public as d3
import numpy as np
from problem import (
    HALF_WIDTH,
    Problem,
    Result,
    initial_density,
    torque,
)
from timing import ONCE_ABOVE, Stopwatch, measure

NAME = "Dedalus 3"
VERSION = version("dedalus")
STABLE_STEP = (
    1.5  # divided by the largest frequency; RK443 allows 1.57 without diffusion
)
SHAPES = (
    *((24, 24, 16), (32, 32, 24), (32, 32, 32), (40, 40, 32)),
    *((48, 48, 48), (64, 64, 64), (128, 128, 128)),
)
# As few or as many angles as ours at this noise.
LEAN = {
    0.1: ((48, 48, 64),),
    0.3: ((56, 56, 56),),
    1.0: ((36, 36, 16), (48, 48, 24)),
    3.0: ((36, 36, 16), (48, 48, 16)),
    10.0: ((36, 36, 8), (48, 48, 16)),
}
QUICK_RUNS = ({"shape": (16, 16, 16)},)


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost."""
    shapes = sorted((*SHAPES, *LEAN[problem.noise]), key=math.prod)
    return tuple({"shape": shape} for shape in shapes)


def make_axes(shape: tuple[int, int, int]) -> tuple[np.ndarray, ...]:
    """Nodes of Dedalus' Fourier bases: left ends of the cells."""
    n1, n2, n_alpha = shape
    xi1 = -HALF_WIDTH + 2 * HALF_WIDTH / n1 * np.arange(n1)
    xi2 = -HALF_WIDTH + 2 * HALF_WIDTH / n2 * np.arange(n2)
    return xi1, xi2, 2 * np.pi / n_alpha * np.arange(n_alpha)


def make_problem(
    shape: tuple[int, int, int], diffusivity: float
) -> tuple[d3.IVP, d3.Field]:
    """Initial-value problem for ∂ₛp − D ∂_αα p = −τ·∇_ξ p + ∂_α(∇B·τ⊥ p)."""
    coordinates = d3.CartesianCoordinates("xi1", "xi2", "alpha")
    distributor = d3.Distributor(coordinates, dtype=np.float64)
    bounds = [(-HALF_WIDTH, HALF_WIDTH)] * 2 + [(0.0, 2 * np.pi)]
    bases = tuple(
        d3.RealFourier(coordinates[name], size=size, bounds=interval, dealias=1)
        for name, size, interval in zip(coordinates.names, shape, bounds, strict=True)
    )
    xi1, xi2, alpha = distributor.local_grids(*bases)
    p, cosine, sine, torque_field = (distributor.Field(bases=bases) for _ in range(4))
    p["g"] = initial_density(xi1, xi2, alpha)
    cosine["g"] = np.cos(alpha)
    sine["g"] = np.sin(alpha)
    # The bases have no unmatched (Nyquist) mode. On these nodes a sawtooth has none
    # either if it takes its mean, 0, at the jump; else the round trip through the
    # coefficients leaves an error of one grid spacing, alternating from node to node.
    xi1, xi2 = (np.where(xi <= -HALF_WIDTH, 0.0, xi) for xi in (xi1, xi2))
    torque_field["g"] = torque(xi1, xi2, alpha)
    d1, d2, d_alpha = (
        lambda f, c=coordinates[name]: d3.Differentiate(f, c)
        for name in coordinates.names
    )
    problem = d3.IVP([p])
    problem.add_equation(
        (
            d3.TimeDerivative(p) - diffusivity * d_alpha(d_alpha(p)),
            -cosine * d1(p) - sine * d2(p) + d_alpha(torque_field * p),
        )
    )
    return problem, p


def stable_step(shape: tuple[int, int, int]) -> float:
    """Step bounded by the fastest rotation in the corners of the box."""
    n1, n2, n_alpha = shape
    shift = np.pi / (2 * HALF_WIDTH) * np.hypot(n1, n2)
    return STABLE_STEP / (shift + np.sqrt(2) * HALF_WIDTH * n_alpha / 2)


def solve(problem: Problem, shape: tuple[int, int, int]) -> Result:
    """Solve the benchmark problem; the first step factorises and is done twice."""
    for name in ("solvers", "subsystems"):
        logging.getLogger(name).setLevel(logging.WARNING)
    s_end = problem.s_end
    n_steps = int(np.ceil(s_end / stable_step(shape)))
    with Stopwatch() as setup:
        equations, p = make_problem(shape, problem.diffusivity)
        solver = equations.build_solver(d3.RK443)
        start = p["g"].copy()
        solver.step(s_end / n_steps)

    def run() -> np.ndarray:
        p["g"] = start
        for _ in range(n_steps):
            solver.step(s_end / n_steps)
        return p["g"].copy()

    measured = measure(run, samples=3, once_above=ONCE_ABOVE)
    return Result(
        solver=NAME,
        axes=make_axes(shape),
        density=measured.value,
        step=f"{s_end / n_steps:.2g}",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=setup.cpu,
        note="RK443; set-up includes the factorisation",
    )
