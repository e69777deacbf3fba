"""The converged reference: Fourier collocation in (ξ, α), Dormand-Prince 8(5,3) in s.

It shares no code with fpsolve: the whole right-hand side of (9) is evaluated at once
(no splitting), derivatives are dense Fourier differentiation matrices and the step is
chosen by scipy. The density on any grid is the exact trigonometric interpolant.

    python validation/performance/reference.py            # evidence, a few minutes

solves the problem at two resolutions, on two boxes and at two tolerances, compares the
code with an exact solution, and prints the differences.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from problem import (
    DIFFUSIVITY,
    cell_centres,
    initial_density,
    open_mesh,
    torque,
)
from scipy.integrate import solve_ivp
from timing import Stopwatch

CACHE = Path(__file__).parent / ".cache"


def differentiation_matrix(n: int, period: float) -> np.ndarray:
    """d/dx of the trigonometric interpolant on `n` points (the unmatched mode: 0)."""
    wavenumber = 2 * np.pi / period * np.fft.rfftfreq(n, 1 / n)
    if n % 2 == 0:
        wavenumber[-1] = 0.0
    spectrum = 1j * wavenumber[:, None] * np.fft.rfft(np.eye(n), axis=0)
    return np.fft.irfft(spectrum, n, axis=0)


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


class FourierCollocation:
    """∂ₛp = −τ·∇_ξ p + ∂_α(∇B·τ⊥ p) + (A²/2) ∂_αα p on a periodic box.

    Spectrally accurate as long as p is negligible at the edge of the box, where ∇B
    jumps. An even number of points along every axis.

    Parameters
    ----------
    half_width : float
    shape : tuple of int
        (n1, n2, n_alpha).
    """

    def __init__(self, half_width: float, shape: tuple[int, int, int]) -> None:
        if any(n % 2 for n in shape):
            raise ValueError(f"`shape` must be even along every axis, got {shape}.")
        self.half_width, self.shape = half_width, shape
        self.axes = cell_centres(half_width, shape)
        mesh = open_mesh(*self.axes)
        self.cosine, self.sine = np.cos(mesh[2]), np.sin(mesh[2])
        self.torque = torque(*mesh)
        self.d1, self.d2 = (
            differentiation_matrix(n, 2 * half_width) for n in shape[:2]
        )
        self.d_alpha = differentiation_matrix(shape[2], 2 * np.pi).T.copy()

    def rate(self, p: np.ndarray) -> np.ndarray:
        """∂ₛp, shape `shape`."""
        n1 = self.shape[0]
        flux = self.torque * p + DIFFUSIVITY * (p @ self.d_alpha)
        rate = flux @ self.d_alpha
        rate -= self.cosine * (self.d1 @ p.reshape(n1, -1)).reshape(p.shape)
        rate -= self.sine * (self.d2 @ p)
        return rate

    def solve(self, p0: np.ndarray, s_end: float, rtol: float) -> np.ndarray:
        """Density at `s_end`, started from `p0` at s = 0; both of shape `shape`."""
        run = solve_ivp(
            lambda s, p: self.rate(p.reshape(self.shape)).ravel(),
            (0.0, s_end),
            p0.ravel(),
            method="DOP853",
            t_eval=(s_end,),
            rtol=rtol,
            atol=rtol * 1e-2 * p0.max(),
        )
        if not run.success:
            raise RuntimeError(f"The reference failed: {run.message}")
        return run.y[:, -1].reshape(self.shape)


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


FINE = {"half_width": 8.0, "shape": (96, 96, 64), "rtol": 1e-10}
QUICK = {"half_width": 7.0, "shape": (56, 56, 32), "rtol": 1e-6}


def compute(
    s_end: float, half_width: float, shape: tuple[int, int, int], rtol: float
) -> Reference:
    """Solve the benchmark problem to `s_end`."""
    code = FourierCollocation(half_width, shape)
    p0 = initial_density(*open_mesh(*code.axes))
    return Reference(half_width, code.solve(p0, s_end, rtol))


def load(s_end: float, *, quick: bool = False) -> Reference:
    """Reference at `s_end`, from the cache if it is there, else computed and kept."""
    setting = QUICK if quick else FINE
    sizes = "x".join(map(str, setting["shape"]))
    name = f"s{s_end:g}-L{setting['half_width']:g}-{sizes}-{setting['rtol']:g}.npz"
    if (CACHE / name).exists():
        with np.load(CACHE / name) as data:
            return Reference(float(data["half_width"]), data["density"])
    reference = compute(s_end, **setting)
    CACHE.mkdir(exist_ok=True)
    partial = CACHE / f"partial-{name}"
    np.savez_compressed(
        partial, half_width=reference.half_width, density=reference.density
    )
    partial.replace(CACHE / name)
    return reference


def l1_difference(one: Reference, other: Reference) -> float:
    """∫|p − q| over the smaller box, on the midpoint grid of the common comparison."""
    half_width = min(one.half_width, other.half_width)
    axes = cell_centres(half_width, (90, 90, 60))
    volume = np.prod([axis[1] - axis[0] for axis in axes])
    return float(np.abs(one(*axes) - other(*axes)).sum() * volume)


def exact_solution_error(s_end: float, setting: dict, q: float = 1.0) -> float:
    """L1 error on the exact solution p = e^{−B} (1 + q e^{−A²s/2} G)/(4π²) of (9).

    G = e^{−B}(ξ₁ sin α − ξ₂ cos α) is an eigenfunction for every isotropic potential;
    p is a density for |q| ≤ e^{1/2}.
    """
    code = FourierCollocation(setting["half_width"], setting["shape"])
    mesh = open_mesh(*code.axes)
    weight = np.exp(-(mesh[0] ** 2 + mesh[1] ** 2) / 2)
    momentum = -weight * torque(*mesh)

    def exact(s: float) -> np.ndarray:
        decay = np.exp(-DIFFUSIVITY * s)
        return weight * (1 + q * decay * momentum) / (4 * np.pi**2)

    computed = code.solve(exact(0.0), s_end, setting["rtol"])
    volume = np.prod([axis[1] - axis[0] for axis in code.axes])
    return float(np.abs(computed - exact(s_end)).sum() * volume)


def print_evidence(s_end: float, *, quick: bool = False) -> None:
    """Print the difference of the reference to four variations of itself."""
    base = QUICK if quick else FINE
    reference = load(s_end, quick=quick)
    n1, _, n_alpha = base["shape"]
    variations = {
        "box": {"half_width": base["half_width"] - 0.5},
        "xi": {"shape": (n1 - 16, n1 - 16, n_alpha)},
        "alpha": {"shape": (n1, n1, n_alpha - 16)},
        "tolerance": {"rtol": base["rtol"] * 100},
    }
    print(f"reference to s = {s_end:g}: {base}")
    for name, change in variations.items():
        with Stopwatch() as watch:
            varied = compute(s_end, **{**base, **change})
        difference = l1_difference(reference, varied)
        print(f"  {name:9} {change}: L1 {difference:.1e} [{watch.cpu:.0f} CPU s]")
    print(f"  exact solution: L1 error {exact_solution_error(s_end, base):.1e}")


def main() -> None:
    """Print the convergence evidence of the reference."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--s", type=float, nargs="+", default=[1.0])
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    for s_end in arguments.s:
        print_evidence(s_end, quick=arguments.quick)


if __name__ == "__main__":
    main()
