"""Paths of the averaged equation (15), which never leave the interval."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer, check_one_of, check_real
from fpsolve._support.memory import check_memory
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import make_schedule
from fpsolve.reduced.energy.averages import OrbitAverages
from fpsolve.reduced.energy.checks import check_energies
from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.layout import PATHS
from fpsolve.reduced.energy.steps import Sphere, Transition

__all__ = ["EnergyPaths", "sample_energies"]


_N_QUANTILES = 2000
METHODS: dict[str, Any] = {"transition": Transition, "sphere": Sphere}


@dataclass(frozen=True, eq=False, repr=False)
class EnergyPaths(Saved):
    """Signed energies G of independent paths at the saved arclengths.

    Attributes
    ----------
    s : ndarray, shape (n_saved,)
    g : ndarray, shape (n_saved, n_paths)
        In [-g_max, g_max]; `abs(paths.g)` for the reflected process |G|.
    ds : float
    seed : int
    method : str
    process : EnergyProcess or None
        Of which they are; None if its potential could not be read back.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "energy-paths"
    layout = PATHS

    s: Array
    g: Array
    ds: float
    seed: int
    method: str
    process: Any = None
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def histogram(self, grid: EnergyGrid) -> Array:
        """Share of the paths in each cell at each saved s, (n_saved, n_cells)."""
        return np.array([grid.histogram(row) for row in self.g])

    def __repr__(self) -> str:
        n_saved, n_paths = self.g.shape
        return f"EnergyPaths({n_paths} paths, {n_saved} saved, ds = {self.ds:g})"


def sample_energies(
    averages: OrbitAverages,
    noise: float,
    n_paths: int,
    s_end: float,
    ds: float,
    seed: int,
    initial: ArrayLike | str,
    save_at: Iterable[float] | None,
    method: str,
) -> EnergyPaths:
    """Sample (15); see `EnergyProcess.sample`."""
    check_one_of("method", method, METHODS)
    n_paths = check_integer("n_paths", n_paths, at_least=1)
    seed = check_integer("seed", seed, at_least=0)
    s_end = check_real("s_end", s_end)
    schedule = make_schedule((0.0, s_end), ds, save_at, record_every=sys.maxsize)
    required = n_paths * 8 * (len(schedule.saves) + 8)
    check_memory(required, None, "sample fewer paths, save less often")
    generator = np.random.Generator(np.random.Philox(seed))
    g = starting_energies(averages, n_paths, initial, generator)
    step = METHODS[method](averages, noise, schedule.ds)
    state, saved = step.start(g, generator), {0: g}
    for n in range(1, schedule.n_steps + 1):
        state = step(state, generator)
        if n in schedule.saves:
            saved[n] = step.energies(state, generator)
    arclengths = np.array([schedule.s(n) for n in schedule.saves])
    kept = np.array([saved[n] for n in schedule.saves])
    return EnergyPaths(arclengths, kept, schedule.ds, seed, method)


def starting_energies(
    averages: OrbitAverages,
    n_paths: int,
    initial: ArrayLike | str,
    generator: np.random.Generator,
) -> Array:
    """Energies at the start: given ones, or drawn from the stationary law.

    Raises
    ------
    ValueError
        If their number or one of them does not fit.
    """
    if isinstance(initial, str):
        if initial != "stationary":
            raise ValueError(
                f"`initial` must be energies or 'stationary', got {initial!r}."
            )
        return _stationary(averages, n_paths, generator)
    g = check_energies("initial", initial, averages.well.g_max, signed=True)
    if g.shape not in ((), (n_paths,)):
        raise ValueError(
            f"`initial` must be one energy or {n_paths} of them, got shape {g.shape}."
        )
    return np.array(np.broadcast_to(g, (n_paths,)))


def _stationary(
    averages: OrbitAverages, n_paths: int, generator: np.random.Generator
) -> Array:
    """Quantiles of N at uniform numbers, with a fair sign."""
    quantile = _quantile(averages)
    sign = generator.choice([-1.0, 1.0], size=n_paths)
    return np.asarray(sign * quantile(generator.uniform(size=n_paths)))


@lru_cache(maxsize=16)
def _quantile(averages: OrbitAverages) -> Any:
    """Inverse of the distribution N of one well, by monotone interpolation."""
    from scipy.interpolate import PchipInterpolator

    g = averages.well.g_max * np.sin(np.linspace(0, np.pi / 2, _N_QUANTILES)) ** 2
    beyond = averages.measure(g)
    return PchipInterpolator(beyond[::-1] / beyond[0], g[::-1])
