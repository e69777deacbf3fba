"""Fourier translations with levels of extrapolation against the Fourier peer.

    OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python validation/performance/levels.py
    … levels.py --noises 1          # one noise, half a minute
    … levels.py --quick

The benchmark problem at A = 0.1, 0.3, 1, 3 and 10. For every error from 1e-3 to 1e-9
the least CPU time of ours and of the peer among the settings below, in one run on one
thread, and their ratio. Errors are L1 distances to a run of ours that is finer than
all others; that it is right says the peer, which shares no code with it and comes as
near as the table says. Set-up (matrices, tables) is counted for neither.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import peer_fourier
from ours import NEVER, make_start
from problem import HALF_WIDTH, Problem
from reference import Reference
from timing import measure

import fpsolve as fp

# Too few cells are to show as an error and not to stop a run.
LAX: dict[str, Any] = {
    f"{name}_tolerance": np.inf
    for name in ("boundary", "negative", "entropy", "circulation")
}
# Errors below may be those of the reference.
SHARP = 1e-10
# Of the peer with its stable step.
MOST_CELLS = 300_000
TARGETS = tuple(10.0**-power for power in range(3, 10))


class Setting(NamedTuple):
    """Cells, the longest step as a share of one, and levels."""

    shape: tuple[int, int, int]
    n_steps: int
    levels: int


class Found(NamedTuple):
    """CPU seconds and error of one setting, and what it says of its error."""

    name: str
    cpu: float
    error: float
    told: float = np.nan


class Choice(NamedTuple):
    """What is tried at one noise: the reference, ours, and shapes of the peer."""

    reference: Setting
    ours: tuple[Setting, ...]
    peers: tuple[tuple[tuple[int, int, int], float], ...]


def crossed(
    shapes: tuple[tuple[int, int, int], ...], steps: tuple[tuple[int, int], ...]
) -> tuple[Setting, ...]:
    """Every shape with every pair of steps and levels."""
    return tuple(Setting(shape, *one) for shape in shapes for one in steps)


def squares(*sizes: tuple[int, int]) -> tuple[tuple[int, int, int], ...]:
    """Shapes (n, n, n_alpha)."""
    return tuple((n, n, n_alpha) for n, n_alpha in sizes)


def choice(
    reference: Setting,
    shapes: tuple[tuple[int, int, int], ...],
    steps: tuple[tuple[int, int], ...],
) -> Choice:
    """The same shapes for both; the peer with its stable step and with half of it.

    But shapes on which a run of the peer takes minutes.
    """
    peers = tuple(
        (shape, share)
        for shape in shapes
        for share in (1.0, 0.5)
        if math.prod(shape) <= MOST_CELLS * share
    )
    return Choice(reference, crossed(shapes, steps), peers)


# Little noise needs angles, much noise needs steps.
CHOICES = {
    0.1: choice(
        Setting((96, 96, 128), 6, 7),
        squares((36, 40), (44, 56), (52, 64), (60, 80), (68, 96), (80, 112)),
        ((2, 2), (2, 3), (2, 4), (2, 5), (3, 5), (4, 6)),
    ),
    0.3: choice(
        Setting((88, 88, 96), 6, 7),
        squares((32, 32), (40, 40), (48, 48), (56, 56), (64, 64), (76, 80)),
        ((2, 2), (2, 3), (2, 4), (2, 5), (3, 5), (4, 6)),
    ),
    1.0: choice(
        Setting((72, 72, 48), 6, 8),
        squares((28, 16), (32, 16), (36, 16), (40, 24), (44, 24), (48, 24), (56, 32)),
        ((2, 2), (2, 3), (2, 4), (2, 5), (3, 4), (3, 5), (4, 5)),
    ),
    3.0: choice(
        Setting((64, 64, 28), 16, 8),
        squares((28, 16), (32, 16), (36, 16), (40, 16), (44, 16), (48, 16), (52, 24)),
        ((3, 2), (4, 2), (4, 3), (6, 3), (6, 4), (8, 4), (8, 5), (8, 6), (12, 6)),
    ),
    10.0: choice(
        Setting((64, 64, 20), 64, 7),
        squares((28, 8), (32, 8), (36, 8), (40, 8), (44, 8), (48, 16)),
        ((20, 2), (20, 3), (24, 3), (32, 3), (32, 4), (32, 5), (48, 5),
         (64, 6)),
    ),
}  # fmt: skip
QUICK = Choice(
    Setting((32, 32, 24), 4, 4),
    crossed(((16, 16, 12), (24, 24, 16)), ((2, 2), (2, 3))),
    (((16, 16, 12), 1.0), ((24, 24, 16), 1.0)),
)


def scheme_of(noise: float, shape: tuple[int, int, int]) -> Any:
    """The palindrome with Fourier translations."""
    model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=noise)
    grid = fp.PhaseSpaceGrid(half_width=HALF_WIDTH, shape=shape)
    return fp.drift_kick(model, grid, translation="fourier")


def solved(scheme: Any, p0: np.ndarray, setting: Setting) -> Any:
    """The run of a setting to s = 1."""
    return fp.solve(
        scheme, p0, (0.0, 1.0), 1.0 / setting.n_steps, extrapolate=setting.levels,
        record_every=NEVER, **LAX,
    )  # fmt: skip


def distance(reference: Reference, axes: Any, density: np.ndarray) -> float:
    """∫ |p − reference| on the cells of p."""
    volume = (2 * HALF_WIDTH) ** 2 * 2 * np.pi / density.size
    return float(np.abs(density - reference(*axes)).sum() * volume)


def our_runs(
    noise: float, settings: tuple[Setting, ...], reference: Reference
) -> Iterator[Found]:
    """Time and error of every setting of ours, without the first run of each."""
    for setting in settings:
        scheme = scheme_of(noise, setting.shape)
        grid, p0 = scheme.grid, make_start(scheme.grid)
        axes = grid.xi1, grid.xi2, grid.alpha
        solved(scheme, p0, setting)
        taken = measure(lambda: solved(scheme, p0, setting), samples=3)  # noqa: B023
        name = f"{setting.shape} ds = 1/{setting.n_steps}, {setting.levels} levels"
        error = distance(reference, axes, taken.value.final)
        told = taken.value.errors["density_l1"][-1]
        yield Found(name, taken.cpu, error, told)


def peer_runs(noise: float, choice: Choice, reference: Reference) -> Iterator[Found]:
    """The same of the peer."""
    for shape, share in choice.peers:
        found = peer_fourier.solve(Problem(noise), shape, share=share)
        name = f"{shape} ds = {found.step}"
        yield Found(name, found.cpu, distance(reference, found.axes, found.density))


def best(found: list[Found], target: float) -> Found | None:
    """The cheapest run within the target; None if there is none."""
    within = [one for one in found if one.error <= target]
    return min(within, key=lambda one: one.cpu, default=None)


def print_ratios(
    ours: list[Found], peers: list[Found], targets: tuple[float, ...]
) -> None:
    """The cheapest of both within each error, and how many times faster ours is."""
    print(f"{'error':>6} {'ours, ms':>9} {'peer, ms':>9} {'ratio':>6}")
    for target in targets:
        one, other = best(ours, target), best(peers, target)
        times = [f"{1e3 * x.cpu:9.2f}" if x else f"{'-':>9}" for x in (one, other)]
        ratio = f"{other.cpu / one.cpu:6.1f}" if one and other else f"{'-':>6}"
        print(f"{target:6.0e} {times[0]} {times[1]} {ratio}  {one.name if one else ''}"
              f" | {other.name if other else ''}")  # fmt: skip


def report(noise: float, choice: Choice) -> None:
    """Print one table."""
    scheme = scheme_of(noise, choice.reference.shape)
    finest = solved(scheme, make_start(scheme.grid), choice.reference)
    reference = Reference(HALF_WIDTH, finest.final)
    ours = list(our_runs(noise, choice.ours, reference))
    peers = list(peer_runs(noise, choice, reference))
    nearest = min(one.error for one in peers)
    print(f"\nA = {noise:g}: reference {choice.reference.shape}, the peer within "
          f"{nearest:.1e} of it")  # fmt: skip
    covers = [one.told / one.error for one in ours if one.error > SHARP]
    print(f"ours tell {min(covers):.2g} to {max(covers):.2g} times their errors")
    print_ratios(ours, peers, TARGETS)


def main(arguments: list[str] | None = None) -> None:
    """Read the command line and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--noises", nargs="+", type=float, default=list(CHOICES))
    parser.add_argument("--quick", action="store_true", help="tiny grids")
    options = parser.parse_args(arguments)
    for noise in options.noises:
        report(noise, QUICK if options.quick else CHOICES[noise])


if __name__ == "__main__":
    main()
