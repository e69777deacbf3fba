"""Sectors of the angular index (`spectral_solve`) against the Fourier peer.

    OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python validation/performance/sectors.py
    … sectors.py --noises 1         # one noise, half a minute
    … sectors.py --alone            # without the peer
    … sectors.py --quick

The benchmark problem at A = 0.1, 0.3, 1 and 3. For errors of 1e-4, 1e-7 and 1e-9 the
least CPU time of ours and of the peer, in one run on one thread, and their ratio. Ours
is a whole call, with H, moments and all bounds, and the density on 48x48x32 cells.
Errors are L1 distances to a run of ours that is finer than all others; that it is
right says the peer, which shares no code with it and comes as near as the table says.
"""

from __future__ import annotations

import argparse
from typing import Any, NamedTuple

import numpy as np
import peer_fourier
from levels import Found, print_ratios
from problem import ANGLE, CONCENTRATION, HALF_WIDTH, MEAN, VARIANCE, Problem
from timing import measure

import fpsolve as fp

SHAPE = (48, 48, 32)
TARGETS = (1e-4, 1e-7, 1e-9)
Shapes = tuple[tuple[int, int, int], ...]


class Choice(NamedTuple):
    """Tolerances of ours, that of the reference, and shapes of the peer."""

    tolerances: tuple[float, ...]
    reference: float
    peers: Shapes


# What a call tells of its errors is for H, in the worst case: the L1 error is less.
CHOICES = {
    0.1: Choice(
        (1e-1, 1e-2, 1e-3), 1e-5, ((52, 52, 64), (68, 68, 96)),
    ),
    0.3: Choice(
        (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), 1e-10,
        ((40, 40, 40), (56, 56, 56), (76, 76, 80)),
    ),
    1.0: Choice(
        (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), 1e-11,
        ((28, 28, 16), (32, 32, 16), (36, 36, 16), (44, 44, 24), (48, 48, 24),
         (56, 56, 32), (64, 64, 32)),
    ),
    3.0: Choice(
        (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), 1e-11,
        ((28, 28, 16), (32, 32, 16), (36, 36, 16), (44, 44, 16), (48, 48, 16),
         (56, 56, 24), (64, 64, 24)),
    ),
}  # fmt: skip
QUICK = Choice((1e-1, 1e-3), 1e-5, ((16, 16, 12), (24, 24, 16)))


def solved(noise: float, tolerance: float) -> Any:
    """The solution at s = 1."""
    model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=noise)
    law = fp.paths.GaussianLaw(MEAN, VARIANCE, ANGLE, CONCENTRATION)
    return fp.spectral_solve(model, law, 1.0, tolerance=tolerance, work_limit=1e12)


def grid_of(shape: tuple[int, ...]) -> Any:
    """The box of the problem in so many cells."""
    return fp.PhaseSpaceGrid(half_width=HALF_WIDTH, shape=shape)


def distance(p: np.ndarray, q: np.ndarray) -> float:
    """∫ |p − q| on the cells of the box."""
    volume = (2 * HALF_WIDTH) ** 2 * 2 * np.pi / p.size
    return float(np.abs(p - q).sum() * volume)


def report(noise: float, choice: Choice, alone: bool) -> None:
    """Print one table."""
    grid, finest = grid_of(SHAPE), solved(noise, choice.reference)
    entropy, density = finest.relative_entropy[0], finest.density(1.0, grid)
    told, (degree, harmonics) = (
        finest.errors["relative_entropy"][0],
        finest.truncation[0],
    )
    print(f"\nA = {noise:g}: H = {entropy:.12f} within {told:.1e}, degree {degree}, "
          f"harmonics {harmonics}")  # fmt: skip
    print(f"{'tolerance':>9} {'CPU, ms':>8} {'density, ms':>11} {'L1 error':>8} "
          f"{'error of H':>10} {'told':>8}")  # fmt: skip
    ours = []
    for tolerance in choice.tolerances:
        taken = measure(lambda: solved(noise, tolerance), samples=3, once_above=5.0)  # noqa: B023
        found = taken.value
        drawn = measure(lambda: found.density(1.0, grid), samples=3)  # noqa: B023
        told = found.errors["relative_entropy"][0]
        error = distance(drawn.value, density)
        ours.append(Found(f"tolerance {tolerance:g}", taken.cpu + drawn.cpu, error))
        print(f"{tolerance:9.0e} {1e3 * taken.cpu:8.1f} {1e3 * drawn.cpu:11.1f} "
              f"{error:8.1e} {abs(found.relative_entropy[0] - entropy):10.1e} "
              f"{told:8.1e}")  # fmt: skip
    if alone:
        return
    peers = []
    for shape in choice.peers:
        for share in (1.0, 0.5):
            run = peer_fourier.solve(Problem(noise), shape, share=share)
            exact = finest.density(1.0, grid_of(shape))
            error = distance(run.density, exact)
            peers.append(Found(f"{shape} ds = {run.step}", run.cpu, error))
    print(f"the peer within {min(one.error for one in peers):.1e}")
    print_ratios(ours, peers, TARGETS)


def main(arguments: list[str] | None = None) -> None:
    """Read the command line and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--noises", nargs="+", type=float, default=list(CHOICES))
    parser.add_argument("--quick", action="store_true", help="small grids, two digits")
    parser.add_argument("--alone", action="store_true", help="without the peer")
    options = parser.parse_args(arguments)
    for noise in options.noises:
        choice = QUICK if options.quick else CHOICES[noise]
        report(noise, choice, options.alone)


if __name__ == "__main__":
    main()
