"""Peer: zwicker-group/py-pde, second-order differences and adaptive Runge-Kutta 5(4).

py-pde compiles the whole stepper, for the given grid, inside `make_stepper` (its
numba backend declares the signatures). What is timed is a call of that compiled
stepper; one call over a negligible interval before makes sure of it.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np
import pde
from problem import (
    HALF_WIDTH,
    LeftOutError,
    Problem,
    Result,
    cell_centres,
    initial_density,
    open_mesh,
)
from timing import ONCE_ABOVE, Stopwatch, measure

NAME = "py-pde"
VERSION = version("py-pde")
INITIAL_STEP = 1e-3


class LayDownEquation(pde.PDEBase):
    """∂ₛp = −τ·∇_ξ p + ∂_α(∇B·τ⊥ p) + (A²/2) ∂_αα p for B = |ξ|²/2."""

    def __init__(self, problem: Problem) -> None:
        super().__init__()
        self.diffusivity = problem.diffusivity

    def evolution_rate(self, state: pde.ScalarField, t: float = 0) -> pde.ScalarField:
        """∂ₛp, through the compiled form."""
        rate = self.make_evolution_rate(state, pde.get_backend("numba"))
        return pde.ScalarField(state.grid, rate(state.data, t))

    def make_evolution_rate(self, state: pde.ScalarField, backend: Any) -> Any:
        """∂ₛp as a function of an array; the coefficients are 1-D constants."""
        options = {"bc": "auto_periodic_neumann", "backend": backend}
        d_xi1, d_xi2, d_alpha, d2_alpha = (
            state.grid.make_operator(name, **options)
            for name in ("d_dx", "d_dy", "d_dz", "d2_dz2")
        )
        xi1, xi2, alpha = open_mesh(*state.grid.axes_coords)
        cosine, sine = np.cos(alpha), np.sin(alpha)
        diffusivity = self.diffusivity

        def rate(p, t=0):  # type: ignore[no-untyped-def]
            torque_density = (xi2 * cosine - xi1 * sine) * p
            return (
                d_alpha(torque_density)
                + diffusivity * d2_alpha(p)
                - cosine * d_xi1(p)
                - sine * d_xi2(p)
            )

        return rate


def expression_equation(problem: Problem) -> pde.PDE:
    """The same equation as a user would type it."""
    return pde.PDE(
        {
            "p": "-cos(z) * d_dx(p) - sin(z) * d_dy(p)"
            "+ d_dz((y * cos(z) - x * sin(z)) * p)"
            f"+ {problem.diffusivity} * d2_dz2(p)"
        },
        bc="auto_periodic_neumann",
    )


CUBES = tuple({"shape": (n, n, n)} for n in (32, 64, 128))
TYPED = {"shape": (64, 64, 64), "equation": expression_equation}
QUICK_RUNS = ({"shape": (8, 8, 8)},)


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost; the typed equation at one noise, it costs a minute.

    Much noise bounds the step by the diffusion in α: there few angles, too.
    """
    if problem.noise == 10.0:
        return ({"shape": (64, 64, 16)}, *CUBES)
    return (*CUBES, TYPED) if problem.noise == 1.0 else CUBES


def solve(
    problem: Problem,
    shape: tuple[int, int, int],
    *,
    equation: Callable[[Problem], pde.PDEBase] = LayDownEquation,
    tolerance: float = 1e-4,
) -> Result:
    """Solve the benchmark problem; `tolerance` is py-pde's own default.

    The coarsest grid and the finest are solved at one noise only: a minute to compile.
    """
    if problem.noise != 1.0 and {"shape": shape} in (CUBES[0], CUBES[2]):
        raise LeftOutError("compiles for a minute; made at A = 1")
    bounds = [(-HALF_WIDTH, HALF_WIDTH)] * 2 + [(0.0, 2 * np.pi)]
    grid = pde.CartesianGrid(bounds, list(shape), periodic=True)
    axes = cell_centres(HALF_WIDTH, shape)
    state = pde.ScalarField(grid, initial_density(*open_mesh(*axes)))
    solver = pde.solvers.RungeKuttaSolver(
        equation(problem), backend="numba", adaptive=True, tolerance=tolerance
    )
    with Stopwatch() as compilation:
        stepper = solver.make_stepper(state, dt=INITIAL_STEP)
        stepper(state.copy(), 0.0, 1e-9)

    def run() -> pde.ScalarField:
        solver.info.update(dt=INITIAL_STEP, steps=0)
        p = state.copy()
        stepper(p, 0.0, problem.s_end)
        return p

    measured = measure(run, samples=3, once_above=ONCE_ABOVE)
    return Result(
        solver=NAME if equation is LayDownEquation else f"{NAME}, expression",
        axes=axes,
        density=measured.value.data,
        step=f"adaptive, {solver.info['steps']} steps",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=compilation.cpu,
        note="set-up is compilation, once per process and grid",
    )
