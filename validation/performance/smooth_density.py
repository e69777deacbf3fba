"""Error against CPU time of the density of smooth fibres, equation (23).

    python validation/performance/smooth_density.py            # both cases
    python validation/performance/smooth_density.py --quick    # small, no times

B = |ξ|²/2 on a belt of v = 0.1, (R, K) = (0.1, 10) and (1, 2), to s = 1, one thread.
The peer is what one would otherwise write: Fourier derivatives in all four directions
and Runge-Kutta 4 in numpy, on the same cells, with the longest stable step. Moments are
held against `spectral_solve`, which expands the same density without a grid, and whose
errors are printed. It knows moments only: for the L1 distance the reference is ours on
finer cells with a step eight times as short, extrapolated. That the peer, another
method, comes as close to it as its cells allow is asserted.
"""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402
from machine import processor_name  # noqa: E402
from results import write_json  # noqa: E402
from timing import ONCE_ABOVE, keep_memory, measure  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve._support.provenance import versions  # noqa: E402
from fpsolve.density.stationary.coarser import carried  # noqa: E402

HERE = Path(__file__).parent
Array = np.ndarray
MOMENTS = ("mean_xi1", "variance_xi1", "variance_xi2", "mean_cos_alpha", "mean_kappa2")
# The start: a Gaussian of ξ, a von Mises law of α, the stationary Gaussian of κ.
MEAN, VARIANCE, ANGLE, CONCENTRATION = (1.0, 0.0), 0.7, np.pi / 2, 1.0
# Of the stability of Runge-Kutta 4 on the imaginary axis and on the negative one.
OSCILLATING, DAMPED = 2.8, 2.7


@dataclass(frozen=True)
class Case:
    """A pair of parameters with cells for runs and for the reference."""

    length: float
    curvature_noise: float
    half_width: float
    largest: float
    shape: tuple[int, int, int, int]
    finer: tuple[int, int, int, int]
    fine: tuple[int, int, int, int]
    steps: tuple[int, ...]

    @property
    def model(self) -> fp.SmoothLayDownModel:
        """The model of the case."""
        return fp.SmoothLayDownModel(
            fp.QuadraticPotential(), self.length, curve=fp.MovingBelt(0.1),
            curvature_noise=self.curvature_noise,
        )  # fmt: skip

    def grid(self, shape: tuple[int, int, int, int]) -> fp.SmoothPhaseSpaceGrid:
        """The box of the case with these cells."""
        return fp.SmoothPhaseSpaceGrid(self.half_width, self.largest, shape)

    def start(self, grid: fp.SmoothPhaseSpaceGrid) -> Array:
        """A start that every grid here resolves."""
        basic = fp.initial.gaussian(
            grid.phase_space, MEAN, VARIANCE, ANGLE, CONCENTRATION
        )
        variance = self.model.curvature_variance
        return fp.initial.with_curvature(basic, grid, variance)


CASES = (
    Case(
        0.1,
        10.0,
        6.0,
        15.0,
        (28, 28, 20, 22),
        (36, 36, 24, 26),
        (44, 44, 32, 32),
        (8, 16, 32, 64),
    ),
    Case(
        1.0,
        2.0,
        6.5,
        9.0,
        (28, 28, 20, 24),
        (36, 36, 20, 28),
        (44, 44, 28, 32),
        (4, 8, 16, 32),
    ),
)
QUICK = (
    Case(
        1.0, 2.0, 6.5, 9.0, (16, 16, 12, 16), (18, 18, 12, 16), (20, 20, 16, 20), (4, 8)
    ),
)


def ours(case: Case, shape: Any, n_steps: int, extrapolate: bool, points: int) -> Any:
    """A run of ours, recorded at its end."""
    grid = case.grid(shape)
    scheme = fp.smooth_drift_kick(case.model, grid, interpolation_order=points)
    return fp.solve(
        scheme, case.start(grid), (0.0, 1.0), 1.0 / n_steps, extrapolate=extrapolate,
        record_every=n_steps,
    )  # fmt: skip


class Fourier:
    """Equation (23) by Fourier derivatives and Runge-Kutta 4, forty lines of numpy."""

    def __init__(self, case: Case, shape: tuple[int, int, int, int]) -> None:
        model, grid = case.model, case.grid(shape)
        xi1, xi2, alpha, kappa = grid.mesh()
        force1, force2 = model.potential.gradient(xi1, xi2)
        self.along = np.cos(alpha) + model.belt_speed
        self.across, self.turn = np.sin(alpha), kappa
        bend = force2 * np.cos(alpha) - force1 * np.sin(alpha)
        self.pull = (kappa + bend) / model.relaxation_length
        self.diffusivity = 0.5 * model.curvature_noise**2
        self.slopes = []
        for axis, (n, width) in enumerate(zip(shape, grid.spacing, strict=True)):
            wave = 2j * np.pi * np.fft.fftfreq(n, width)
            wave[n // 2] = 0.0
            self.slopes.append(wave.reshape([-1 if k == axis else 1 for k in range(4)]))
        fastest = [
            float(np.abs(speed).max() * np.abs(slope).max())
            for speed, slope in zip(
                (self.along, self.across, self.turn, self.pull), self.slopes,
                strict=True,
            )
        ]  # fmt: skip
        highest = float(np.abs(self.slopes[3]).max())
        self.longest = min(
            OSCILLATING / sum(fastest), DAMPED / (self.diffusivity * highest**2)
        )
        self.p0 = case.start(grid)

    def derivative(self, values: Array, axis: int) -> Array:
        """The derivative of the interpolant in one direction."""
        modes = np.fft.fft(values, axis=axis) * self.slopes[axis]
        return np.fft.ifft(modes, axis=axis).real

    def rate(self, p: Array) -> Array:
        """∂ₛp."""
        flux = self.pull * p + self.diffusivity * self.derivative(p, 3)
        moved = self.along * self.derivative(p, 0) + self.across * self.derivative(p, 1)
        return self.derivative(flux, 3) - moved - self.turn * self.derivative(p, 2)

    def __call__(self) -> Array:
        """The density at s = 1."""
        n_steps = int(np.ceil(1.0 / self.longest))
        ds, p = 1.0 / n_steps, self.p0
        for _ in range(n_steps):
            k1 = self.rate(p)
            k2 = self.rate(p + 0.5 * ds * k1)
            k3 = self.rate(p + 0.5 * ds * k2)
            p = p + ds / 6 * (k1 + 2 * k2 + 2 * k3 + self.rate(p + ds * k3))
        return p


@dataclass(frozen=True)
class Reference:
    """A density on fine cells, and moments by expansion with their largest error."""

    density: Array
    moments: dict[str, float]
    error: float

    @classmethod
    def of(cls, case: Case, n_steps: int, tolerance: float) -> Reference:
        """Both at s = 1."""
        law = fp.paths.GaussianLaw(
            MEAN, VARIANCE, angle=ANGLE, concentration=CONCENTRATION
        )
        found = fp.spectral_solve(case.model, law, [1.0], tolerance=tolerance)
        moments = {name: float(found.series[name][-1]) for name in MOMENTS}
        error = max(float(found.errors[name][-1]) for name in MOMENTS)
        density = ours(case, case.fine, n_steps, True, 14).final
        return cls(density, moments, error)


def errors(case: Case, p: Array, reference: Reference) -> dict[str, float]:
    """L1 distance from the density, and the largest error of a moment."""
    fine = case.grid(reference.density.shape)
    apart = carried(p, fine.shape) - reference.density
    found = fp.diagnostics.moments(p, case.grid(p.shape))
    off = max(abs(found[name] - reference.moments[name]) for name in MOMENTS)
    return {"l1": float(np.abs(apart).sum() * fine.cell_volume), "moments": off}


def rows_of(case: Case, reference: Reference, samples: int) -> list[dict[str, Any]]:
    """All runs of a case."""
    rows = []
    kinds = ((False, case.shape), (True, case.shape), (True, case.finer))
    for extrapolate, shape in kinds:
        for n_steps in case.steps:
            arguments = case, shape, n_steps, extrapolate, 12
            made = measure(
                lambda arguments=arguments: ours(*arguments), samples=samples,
                once_above=ONCE_ABOVE,
            )  # fmt: skip
            name = "smooth_drift_kick" + (", extrapolated" if extrapolate else "")
            rows.append({"solver": name, "shape": shape, "steps": n_steps,
                         "cpu": made.cpu,
                         **errors(case, made.value.final, reference)})  # fmt: skip
    peer = Fourier(case, case.shape)
    made = measure(peer, samples=samples, once_above=ONCE_ABOVE)
    n_steps = int(np.ceil(1.0 / peer.longest))
    rows.append({"solver": "numpy, Fourier and Runge-Kutta 4", "shape": case.shape,
                 "steps": n_steps, "cpu": made.cpu,
                 **errors(case, made.value, reference)})  # fmt: skip
    return rows


def main() -> None:
    """Measure, print, assert what was computed, and write the numbers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    keep_memory()
    results = []
    for case in QUICK if quick else CASES:
        finest = case.steps[-1] * (2 if quick else 8)
        reference = Reference.of(case, finest, 1e-3 if quick else 1e-5)
        rows = rows_of(case, reference, 1 if quick else 3)
        named = f"R = {case.length:g}, K = {case.curvature_noise:g}"
        print(f"{named}; moments by expansion ± {reference.error:.0e}")
        for row in rows:
            print(f"  {row['solver']:34s} {row['shape']!s:18s} {row['steps']:4d} steps "
                  f"{row['cpu']:8.3f} s  "
                  f"L1 {row['l1']:.1e}  moments {row['moments']:.1e}")  # fmt: skip
        # Two methods, one answer: what is left is that of the cells.
        assert max(rows[-2]["l1"], rows[-1]["l1"]) <= (0.1 if quick else 1e-3)
        fine = errors(case, reference.density, reference)["moments"]
        assert fine <= (0.1 if quick else 1e-3)
        results.append({
            "R": case.length, "K": case.curvature_noise,
            "error_of_expansion": reference.error, "rows": rows,
        })  # fmt: skip
    if not quick:
        content = {
            "processor": processor_name(), "versions": versions(), "cases": results,
        }  # fmt: skip
        write_json(HERE / "results" / "benchmark-smooth-density.json", content)


if __name__ == "__main__":
    main()
