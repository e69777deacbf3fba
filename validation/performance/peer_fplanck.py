"""Peer: fplanck, jumps between neighbouring cells and the matrix exponential.

fplanck solves overdamped motion: in every direction a force and a temperature, and
rates D/Δ² exp(±F Δ/2kT) between neighbours. Forces need not derive from a potential,
so the drift of (9) can be given, and D = kT may differ between directions. It cannot
be zero, though (0 · ∞), and the rates carry the right velocity only if F Δ ≪ 2 D:
sinh(F Δ/2D) · 2D/Δ is what they carry, with the diffusivity D cosh(F Δ/2D). Hence

- "fplanck": the force is the drift, D along ξ of (9) raised from 0 to Δξ · `RAISED`;
- "fplanck, force corrected": F = (2D/Δ) asinh(drift Δ/2D), so that the velocity is
  right and the diffusivity √(D² + (drift Δ/2)²): upwind differences as D → 0.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np

if not hasattr(np, "product"):  # fplanck 0.2.2 calls it; NumPy 2 has it no more
    setattr(np, "product", np.prod)  # noqa: B010

import fplanck
from problem import (
    HALF_WIDTH,
    LeftOutError,
    Problem,
    Result,
    cell_centres,
    initial_density,
    torque,
)
from timing import ONCE_ABOVE, Stopwatch, measure

NAME = "fplanck"
VERSION = version("fplanck")
RAISED = 0.5
NEARLY_ZERO = 1e-2
QUICK_RUNS = ({"shape": (12, 12, 12), "corrected": True},)
# expm_multiply makes about as many products with the matrix as its norm times s.
# Multiplications that take about 90 s:
LARGEST_WORK = 6e10


def runs(problem: Problem) -> tuple[dict[str, Any], ...]:
    """Settings by growing cost."""
    return tuple(
        {"shape": (n, n, n), "corrected": corrected}
        for corrected in (False, True)
        for n in (32, 64, 128)
    )


def drift(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """(cos α, sin α, −∇B·τ⊥) at (ξ₁, ξ₂, α − π): fplanck centres every axis at 0."""
    alpha = z + np.pi
    return np.stack([np.cos(alpha), np.sin(alpha), -torque(x, y, alpha)])


def make_solver(
    problem: Problem, shape: tuple[int, int, int], *, corrected: bool
) -> fplanck.fokker_planck:
    """fplanck's solver: drag 1, so that its diffusivity is kT."""
    extent = np.array([2 * HALF_WIDTH, 2 * HALF_WIDTH, 2 * np.pi])
    spacing = extent / shape * (1 + 1e-13)  # it rounds extent / spacing up
    along_xi = (NEARLY_ZERO if corrected else RAISED) * spacing[:2]
    diffusivity = np.array([*along_xi, problem.diffusivity])
    scale = (2 * diffusivity / spacing).reshape(3, 1, 1, 1)

    def force(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        velocity = drift(x, y, z)
        return scale * np.arcsinh(velocity / scale) if corrected else velocity

    largest = np.array([1.0, 1.0, np.sqrt(2) * HALF_WIDTH]) / scale.ravel()
    growth = np.sqrt(1 + largest**2) if corrected else np.cosh(largest)
    norm = 4 * float(np.sum(diffusivity / spacing**2 * growth))
    n_products, n_entries = norm * problem.s_end, 7 * np.prod(shape)
    if n_products * n_entries > LARGEST_WORK:
        raise LeftOutError(
            f"about {n_products:.0e} products with a matrix of {n_entries:.0e} entries"
        )
    return fplanck.fokker_planck(
        temperature=diffusivity / fplanck.k,
        drag=1.0,
        extent=extent,
        resolution=spacing,
        force=force,
        boundary=fplanck.boundary.periodic,
    )


def start(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Initial density on fplanck's axes."""
    return initial_density(x, y, z + np.pi)


def solve(problem: Problem, shape: tuple[int, int, int], *, corrected: bool) -> Result:
    """Solve the benchmark problem."""
    with Stopwatch() as setup:
        solver = make_solver(problem, shape, corrected=corrected)
    measured = measure(
        lambda: solver.propagate(start, problem.s_end, normalize=False),
        samples=3,
        once_above=ONCE_ABOVE,
    )
    return Result(
        solver=f"{NAME}, force corrected" if corrected else NAME,
        axes=cell_centres(HALF_WIDTH, shape),
        density=measured.value,
        step="exponential",
        cpu=measured.cpu,
        wall=measured.wall,
        setup=setup.cpu,
        note="set-up builds the matrix in Python",
    )
