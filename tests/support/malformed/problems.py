"""Small valid problems that the tables spoil; made once, when first asked for."""

from __future__ import annotations

from functools import cache

import numpy as np

import fpsolve as fp
from fpsolve.reduced.energy import EnergyProcess


@cache
def model(noise=1.0, speed=0.0):
    curve = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.LayDownModel(fp.QuadraticPotential(), noise, curve)


@cache
def turning():
    curve = fp.RotatingNozzle(0.1, 0.5, 1.0)
    return fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)


@cache
def grid():
    return fp.PhaseSpaceGrid(6.0, (12, 12, 8))


@cache
def plane():
    return fp.PlaneGrid(6.0, (12, 12))


@cache
def p0():
    return fp.initial.gaussian(grid(), variance=1.0)


@cache
def plane_density():
    return p0().sum(axis=2) * grid().spacing[2]


@cache
def scheme():
    return fp.drift_kick(model(), grid())


def solve(**changes):
    arguments = {"s_span": (0.0, 1.0), "ds": 0.25, "boundary_tolerance": np.inf}
    given = {"scheme": scheme(), "p0": p0(), **arguments, **changes}
    return fp.solve(**given)


@cache
def solution():
    return solve(save_at=(0.5, 1.0))


def sample(**changes):
    arguments = {"model": model(), "n_paths": 10, "s_end": 1.0, "ds": 0.25, "seed": 1}
    return fp.sample_paths(**{**arguments, **changes})


@cache
def paths():
    return sample(save_at=(0.5, 1.0))


@cache
def limit():
    return fp.HydrodynamicLimit(model())


@cache
def energy():
    return EnergyProcess(fp.QuadraticPotential(), 1.0)


@cache
def energy_grid():
    return energy().grid(16)
