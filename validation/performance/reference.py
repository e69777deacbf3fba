"""The converged reference: Fourier collocation in (ξ, α), Dormand-Prince 8(5,3) in s.

It shares no code with fpsolve: the whole right-hand side of (9) is evaluated at once
(no splitting), derivatives are dense Fourier differentiation matrices and the step is
chosen by scipy. The density on any grid is the exact trigonometric interpolant.
reference_evidence.py shows that it is converged.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fourier import FourierCollocation
from problem import Problem, cell_centres, initial_density, open_mesh

CACHE = Path(__file__).parent / ".cache"
# Less noise, narrower filaments: more points, more across the first motion, along ξ₂.
# Much noise: no short angular waves; but the one that nothing damps, n_alpha/2, is in
# the start.
FINE: dict[float, dict[str, Any]] = {
    0.1: {"half_width": 6.25, "shape": (116, 160, 192), "rtol": 1e-9},
    0.3: {"half_width": 8.0, "shape": (128, 128, 96), "rtol": 1e-10},
    1.0: {"half_width": 8.0, "shape": (96, 96, 64), "rtol": 1e-10},
    3.0: {"half_width": 8.0, "shape": (96, 96, 48), "rtol": 1e-10},
    10.0: {"half_width": 8.0, "shape": (80, 80, 28), "rtol": 1e-11},
}
QUICK: dict[str, Any] = {"half_width": 7.0, "shape": (48, 48, 32), "rtol": 1e-6}


def interpolation_matrix(
    points: np.ndarray, nodes: np.ndarray, period: float
) -> np.ndarray:
    """Values at `points` of the trigonometric interpolant through uniform `nodes`.

    The cardinal function of an even number n of nodes is sin(n t/2) / (n tan(t/2)).
    """
    n = len(nodes)
    t = 2 * np.pi / period * (points[:, None] - nodes[None, :])
    t -= 2 * np.pi * np.round(t / (2 * np.pi))
    at_node = np.abs(t) < 1e-14  # there the quotient is 0/0 and its limit is 1
    half = np.where(at_node, 1.0, t / 2)
    return np.where(at_node, 1.0, np.sin(n * half) / (n * np.tan(half)))


@dataclass(frozen=True)
class Reference:
    """A reference density; callable at the points of any tensor grid.

    Attributes
    ----------
    half_width : float
    density : ndarray, shape (n1, n2, n_alpha)
        Values on the cell-centred grid of that half width.
    """

    half_width: float
    density: np.ndarray

    def __call__(
        self, xi1: np.ndarray, xi2: np.ndarray, alpha: np.ndarray
    ) -> np.ndarray:
        """Density at xi1 x xi2 x alpha (1-D arrays), the exact interpolant."""
        nodes = cell_centres(self.half_width, self.density.shape)
        periods = (2 * self.half_width, 2 * self.half_width, 2 * np.pi)
        e1, e2, e_alpha = (
            interpolation_matrix(points, x, period)
            for points, x, period in zip((xi1, xi2, alpha), nodes, periods, strict=True)
        )
        along_plane = np.tensordot(e1, self.density @ e_alpha.T, axes=(1, 0))
        return e2 @ along_plane


def compute(
    noise: float,
    s_values: tuple[float, ...],
    half_width: float,
    shape: tuple[int, int, int],
    rtol: float,
) -> list[Reference]:
    """Solve the benchmark problem once; the references at the ascending `s_values`."""
    code = FourierCollocation(half_width, shape, Problem(noise).diffusivity)
    p0 = initial_density(*open_mesh(*code.axes))
    densities = code.solve(p0, s_values, rtol)
    return [Reference(half_width, density) for density in densities]


def settings(noise: float, *, quick: bool = False) -> dict[str, Any]:
    """Box, points and tolerance of the reference at one noise."""
    return QUICK if quick else FINE[noise]


def path_of(noise: float, s: float, setting: dict[str, Any]) -> Path:
    """File in which a reference is kept between runs."""
    sizes = "x".join(map(str, setting["shape"]))
    box, rtol = setting["half_width"], setting["rtol"]
    return CACHE / f"A{noise:g}-s{s:g}-L{box:g}-{sizes}-{rtol:g}.npz"


def load_all(
    noise: float, s_values: tuple[float, ...], *, quick: bool = False
) -> list[Reference]:
    """References at `s_values`, kept ones if all are there, else computed and kept."""
    setting = settings(noise, quick=quick)
    paths = [path_of(noise, s, setting) for s in s_values]
    if not all(path.exists() for path in paths):
        for path, reference in zip(
            paths, compute(noise, s_values, **setting), strict=True
        ):
            keep(path, reference)
    return [read(path) for path in paths]


def load(problem: Problem, *, quick: bool = False) -> Reference:
    """Reference of one problem, from the cache if it is there."""
    return load_all(problem.noise, (problem.s_end,), quick=quick)[0]


def keep(path: Path, reference: Reference) -> None:
    """Write a reference; the file appears complete or not at all."""
    from fpsolve._support.files import atomic_path

    path.parent.mkdir(exist_ok=True)
    with atomic_path(path) as draft:
        np.savez_compressed(
            draft, half_width=reference.half_width, density=reference.density
        )


def read(path: Path) -> Reference:
    """Read what `keep` wrote."""
    with np.load(path) as data:
        return Reference(float(data["half_width"]), data["density"])
