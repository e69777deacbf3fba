"""Digests of results of every kind; as a script it prints them as JSON.

Run as a script, it computes those named, or all, with the threads that the environment
asks for.
"""

import hashlib
import json
import sys
import warnings

import numpy as np

import fpsolve as fp
from fpsolve._kernels import threads
from fpsolve._kernels.tridiagonal import solve_four
from fpsolve.density.schemes.diffusion import ImplicitDiffusion
from fpsolve.density.schemes.rotation import RotationDiffusion

GRID = fp.PhaseSpaceGrid(5.0, (20, 16, 16))
QUADRATIC, LINEAR = fp.QuadraticPotential(), fp.LinearPotential()
MODEL = fp.LayDownModel(QUADRATIC, 1.0)
BELT = fp.LayDownModel(QUADRATIC, 1.0, fp.MovingBelt(0.2))
# Whose spectrum needs few harmonics.
FAST = fp.LayDownModel(QUADRATIC, 3.0, fp.MovingBelt(0.05))
NOZZLE = fp.LayDownModel(QUADRATIC, 1.0, fp.RotatingNozzle(0.1, 0.3, 1.0, 0.0))
START = fp.initial.gaussian(
    GRID, mean=(1.0, 0.3), variance=0.6, angle=1.0, concentration=2.0
)
# The grid is a coarse one, made for quick tests.
LENIENT = {
    f"{name}_tolerance": 1.0
    for name in ("mass", "boundary", "negative", "entropy", "circulation")
}
RUN = {"s_span": (0.0, 0.5), "ds": 0.25, "save_at": (0.25, 0.5), **LENIENT}
DRIFT_KICKS = {
    "plain": {},
    "balanced": {"balanced": True},
    "positive": {"positive": True},
    "balanced and positive": {"balanced": True, "positive": True},
    "order 4": {"interpolation_order": 4},
}
SEMI_LAGRANGIANS = {
    "default": {},
    "p": {"form": "p"},
    "lie": {"splitting": "lie"},
    "backward Euler": {"diffusion": "backward_euler"},
    "order 6": {"interpolation_order": 6},
    "limited": {"limited": True},
    "not adjusted": {"adjusted": False},
    "not compact": {"compact": False},
}


def digest(*arrays):
    """SHA-256 of the bits of arrays."""
    found = hashlib.sha256()
    for array in arrays:
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()[:16]


def of_solution(solution):
    """Digest of densities, series and errors."""
    parts = [solution.series, solution.errors or {}]
    values = [part[name] for part in parts for name in sorted(part)]
    return digest(solution.densities, *values)


def drift_kick(options, model=MODEL, **run):
    return of_solution(
        fp.solve(fp.drift_kick(model, GRID, **options), START, **{**RUN, **run})
    )


def semi_lagrangian(options):
    return of_solution(
        fp.solve(fp.semi_lagrangian(MODEL, GRID, **options), START, **RUN)
    )


def paths(method, model):
    found = fp.sample_paths(
        model, 3000, 1.0, 0.125, seed=3, save_at=(0.5, 1.0), method=method,
        histogram=GRID,
    )  # fmt: skip
    moments = found.moments().values
    return digest(
        found.states, found.sums, found.counts, *[moments[name] for name in moments]
    )


def hydrodynamic(method, extrapolate):
    return of_solution(
        fp.HydrodynamicLimit(BELT).solve(
            lambda x, y: np.exp(-((x - 1) ** 2) - y**2), (0.0, 1.0), 0.25,
            # More cells than from where on BLAS shares a sum between its threads.
            grid=fp.PlaneGrid(5.0, (120, 100)), method=method, extrapolate=extrapolate,
        )
    )  # fmt: skip


def energy(method, extrapolate):
    process = fp.EnergyProcess(QUADRATIC, 0.3)
    found = process.solve(
        0.2, (0.0, 2.0), 0.25, grid=process.grid(200), method=method,
        extrapolate=extrapolate,
    )  # fmt: skip
    return digest(found.masses, *[found.series[name] for name in sorted(found.series)])


def energy_spectrum():
    process = fp.EnergyProcess(QUADRATIC, 0.3)
    found = [process.spectrum(4, family) for family in ("even", "odd")]
    return digest(*[one.eigenvalues for one in found], *[one.errors for one in found])


def spectrum(model, tolerance=1e-6):
    found = fp.spectrum(model, 2, tolerance=tolerance)
    return digest(found.eigenvalues, found.errors, found.residuals)


def spectral_solve():
    law = fp.paths.GaussianLaw((1.0, 0.0), 0.25, 1.0, 2.0)
    found = fp.spectral_solve(MODEL, law, [0.5, 1.0], tolerance=1e-3)
    return digest(found.relative_entropy, found.mass, found.mean_xi1)


def rotation():
    """R½ D R½ alone, which is one kernel and that of its matrices."""
    turned = np.empty_like(START)
    RotationDiffusion(MODEL, GRID, balanced=True)(START, 0.0, 0.25, turned)
    return digest(turned)


def steps():
    """A few steps of the default sampler alone."""
    found = fp.sample_paths(BELT, 300, 1.0, 0.125, seed=3)
    return digest(found.states)


def diffusion():
    """One step of the implicit diffusion alone, which is one kernel with one helper."""
    diffused = np.empty_like(START)
    ImplicitDiffusion(MODEL, GRID)(START, 0.0, 0.25, diffused)
    return digest(diffused)


def elimination():
    """That helper alone."""
    factors = ImplicitDiffusion(MODEL, GRID).factors(0.25)
    four = np.ascontiguousarray(START[0, :4].T)
    solved = np.empty_like(four)
    solve_four(four, *factors, solved)
    return digest(solved)


# Kernels that a test compiles once more.
KERNELS = {
    "kernel of rotation": (rotation,),
    "kernel of paths": (steps,),
    "kernel of diffusion": (diffusion,),
    "kernel of elimination": (elimination,),
}
# Everything that computes, by name.
CASES = {
    **{f"drift_kick, {name}": (drift_kick, options)
       for name, options in DRIFT_KICKS.items()},
    "drift_kick, belt": (drift_kick, {}, BELT),
    "drift_kick, nozzle": (drift_kick, {"balanced": True}, NOZZLE),
    **{f"semi_lagrangian, {name}": (semi_lagrangian, options)
       for name, options in SEMI_LAGRANGIANS.items()},
    "extrapolated": (
        lambda: of_solution(
            fp.solve(fp.drift_kick(MODEL, GRID), START, **RUN, extrapolate=True)
        ),
    ),
    "steady_state": (
        lambda: digest(
            fp.steady_state(
                BELT, fp.PhaseSpaceGrid(5.0, (16, 16, 8)), ds=0.5,
                boundary_tolerance=1.0, error_tolerance=2.0, tolerance=1e-3,
            ).density
        ),
    ),
    "hydrodynamic": (hydrodynamic, "backward_euler", False),
    "hydrodynamic, extrapolated": (hydrodynamic, "sdirk2", True),
    "energy": (energy, "backward_euler", False),
    "energy, extrapolated": (energy, "sdirk2", True),
    "energy spectrum": (energy_spectrum,),
    "spectrum, quadratic": (spectrum, MODEL),
    "spectrum, linear": (spectrum, fp.LayDownModel(LINEAR, 3.0), 1e-3),
    "spectrum, power": (spectrum, fp.LayDownModel(fp.PowerPotential(4.0), 1.0)),
    "spectrum, belt": (spectrum, FAST, 1e-3),
    "spectral_solve": (spectral_solve,),
    "paths, splitting": (paths, "splitting", BELT),
    "paths, euler_maruyama": (paths, "euler_maruyama", NOZZLE),
    "paths, heun": (paths, "heun", fp.LayDownModel(LINEAR, 1.0)),
}  # fmt: skip
# Those in which numba shares the work between threads.
THREADED = [name for name in CASES if name.startswith(
    ("drift_kick", "semi_lagrangian", "extrapolated", "steady", "paths"))]  # fmt: skip


def digest_of(name):
    """Digest of one case."""
    compute, *arguments = {**CASES, **KERNELS}[name]
    return compute(*arguments)


if __name__ == "__main__":
    # Runs on grids as small as these would be left to one thread.
    threads.CELLS_PER_THREAD = 1
    warnings.simplefilter("ignore")
    names = sys.argv[1:] or CASES
    json.dump({name: digest_of(name) for name in names}, sys.stdout)
