"""Peer: FiPy, finite volumes with van Leer convection and implicit α-diffusion.

FiPy's `VanLeerConvectionTerm` is explicit, so the step obeys a Courant condition over
the whole box, corners included; the diffusion along α is implicit (backward Euler),
solved by preconditioned conjugate gradients because the matrix is symmetric. Nothing
is compiled.
"""

from __future__ import annotations

import os

os.environ.setdefault("FIPY_SOLVERS", "scipy")

from importlib.metadata import version
from typing import Any

import fipy
import numpy as np
from problem import (
    HALF_WIDTH,
    Problem,
    Result,
    cell_centres,
    initial_density,
    torque,
)
from timing import Stopwatch

NAME = "FiPy (van Leer)"
VERSION = version("fipy")
# Sum over the three directions at the fastest points of the box, its corners, where the
# density is negligible. At 0.4 the error on 32³ is 1 % smaller at four times the cost.
COURANT = 1.6
QUICK_RUNS = ({"shape": (16, 16, 16)},)


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost."""
    return tuple({"shape": (n, n, n)} for n in (32, 64, 128))


def make_mesh(shape: tuple[int, int, int]) -> fipy.PeriodicGrid3D:
    """Periodic box with FiPy's own origin (0, 0, 0)."""
    d1, d2, d_alpha = 2 * HALF_WIDTH / shape[0], 2 * HALF_WIDTH / shape[1], 2 * np.pi
    return fipy.PeriodicGrid3D(
        nx=shape[0], ny=shape[1], nz=shape[2], dx=d1, dy=d2, dz=d_alpha / shape[2]
    )


def make_equation(mesh: fipy.PeriodicGrid3D, diffusivity: float) -> object:
    """∂ₛp + ∇·(u p) = ∂_α(D ∂_α p), u = (cos α, sin α, −∇B·τ⊥) at face centres."""
    xi1, xi2, alpha = mesh.faceCenters.value
    xi1, xi2 = xi1 - HALF_WIDTH, xi2 - HALF_WIDTH
    velocity = fipy.FaceVariable(mesh=mesh, rank=1)
    velocity.setValue([np.cos(alpha), np.sin(alpha), -torque(xi1, xi2, alpha)])
    across_alpha = np.abs(mesh.faceNormals[2]) > 0.5
    diffusion = fipy.FaceVariable(mesh=mesh, value=diffusivity * across_alpha)
    return fipy.TransientTerm() + fipy.VanLeerConvectionTerm(
        coeff=velocity
    ) == fipy.DiffusionTerm(coeff=diffusion)


def stable_step(shape: tuple[int, int, int]) -> float:
    """Step at which the Courant numbers of the three directions add up to COURANT."""
    n1, n2, n_alpha = shape
    shift = np.hypot(n1, n2) / (2 * HALF_WIDTH)
    kick = np.sqrt(2) * HALF_WIDTH * n_alpha / (2 * np.pi)
    return COURANT / (shift + kick)


def solve(problem: Problem, shape: tuple[int, int, int]) -> Result:
    """Solve the benchmark problem."""
    with Stopwatch() as setup:
        mesh = make_mesh(shape)
        xi1, xi2, alpha = mesh.cellCenters.value
        start = initial_density(xi1 - HALF_WIDTH, xi2 - HALF_WIDTH, alpha)
        density = fipy.CellVariable(mesh=mesh, value=start, hasOld=True)
        equation = make_equation(mesh, problem.diffusivity)
    linear_solver = fipy.LinearCGSolver(tolerance=1e-10, iterations=1000)
    s_end = problem.s_end
    n_steps = int(np.ceil(s_end / stable_step(shape)))
    with Stopwatch() as watch:  # once: it takes seconds to minutes
        for _ in range(n_steps):
            density.updateOld()
            equation.solve(density, dt=s_end / n_steps, solver=linear_solver)
    # FiPy numbers its cells with the first coordinate fastest
    values = density.value.reshape(shape[::-1]).transpose()
    return Result(
        solver=NAME,
        axes=cell_centres(HALF_WIDTH, shape),
        density=np.ascontiguousarray(values),
        step=f"{s_end / n_steps:.2g}",
        cpu=watch.cpu,
        wall=watch.wall,
        setup=setup.cpu,
        note=f"Courant number {COURANT:g}",
    )
