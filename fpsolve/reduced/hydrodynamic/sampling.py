"""Paths of dξ = (−ε∇B + v e₁) ds + √(2εF) dW, the process of the limit equation."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array, check_numbers
from fpsolve._support.checks import check_integer, check_one_of, check_positive
from fpsolve._support.memory import check_memory
from fpsolve.errors import NonFinitePathError
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import Schedule, make_schedule
from fpsolve.evolution.schedule import checked_stops as checked_series
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.reduced.hydrodynamic.layout import PATHS
from fpsolve.reduced.hydrodynamic.ornstein_uhlenbeck import OrnsteinUhlenbeckLimit

__all__ = ["METHODS", "HydrodynamicPaths", "sample"]


METHODS = ("exact", "heun")


@dataclass(frozen=True, eq=False)
class HydrodynamicPaths(Saved):
    """Positions ξ of independent paths of the limit process.

    Attributes
    ----------
    s : ndarray, shape (n_saved,)
    xi : ndarray, shape (n_saved, n_paths, 2)
    method : {"exact", "heun"}
    ds : float
        Step; for "exact" the longest distance between two saved points.
    model : FibreModel or None
        Of which they are; None if it could not be read back.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "hydrodynamic-paths"
    layout = PATHS

    s: Array
    xi: Array
    method: str
    ds: float
    model: FibreModel | None = None
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def n_paths(self) -> int:
        """Number of paths."""
        return int(self.xi.shape[1])

    def mean(self) -> tuple[Array, Array]:
        """Estimates of E ξ and their standard errors, each (n_saved, 2)."""
        spread = self.xi.std(axis=1, ddof=1)
        return self.xi.mean(axis=1), spread / math.sqrt(self.n_paths)

    def covariance(self) -> tuple[Array, Array]:
        """Estimates of the covariance and their standard errors, (n_saved, 2, 2)."""
        away = self.xi - self.xi.mean(axis=1, keepdims=True)
        products = away[..., :, None] * away[..., None, :]
        scale = self.n_paths / (self.n_paths - 1)
        error = products.std(axis=1, ddof=1) / math.sqrt(self.n_paths)
        return scale * products.mean(axis=1), error


def sample(
    model: FibreModel,
    n_paths: int,
    s_end: float,
    ds: float | None,
    *,
    seed: int | np.random.SeedSequence,
    initial: Any,
    save_at: Iterable[float] | None = None,
    method: str | None = None,
) -> HydrodynamicPaths:
    """See `HydrodynamicLimit.sample`."""
    n_paths = check_integer("n_paths", n_paths, at_least=2)
    method = checked_method(model, method)
    s_end = check_positive("s_end", s_end)
    if ds is not None:
        ds = check_positive("ds", ds)
    rng = np.random.default_rng(checked_seed(seed))
    if method == "exact":
        stops = checked_stops(s_end, save_at)
        check_room(n_paths, stops.size)
        return _exact(model, starts(initial, n_paths, rng), stops, rng)
    if ds is None:
        raise ValueError(
            "`ds` must be given for the method 'heun', got None; its bias is of order "
            "ds², compare two steps."
        )
    schedule = make_schedule((0.0, s_end), ds, save_at)
    check_room(n_paths, len(schedule.saves))
    return _heun(model, starts(initial, n_paths, rng), schedule, rng)


def checked_seed(seed: Any) -> Any:
    """The seed; TypeError or ValueError unless it makes a generator."""
    if isinstance(seed, np.random.SeedSequence):
        return seed
    return check_integer("seed", seed, at_least=0)


def check_room(n_paths: int, n_saved: int) -> None:
    """Raise MemoryLimitError if the positions do not fit into memory."""
    # Those saved, and the current ones with their step.
    required = n_paths * 2 * 8 * (n_saved + 4)
    check_memory(required, None, "sample fewer paths, save less often")


def checked_method(model: FibreModel, method: str | None) -> str:
    """The method, or the best one for the potential."""
    quadratic = isinstance(model.potential, QuadraticPotential)
    if method is None:
        return "exact" if quadratic else "heun"
    check_one_of("method", method, METHODS)
    if method == "exact" and not quadratic:
        raise ValueError(
            "`method` must be 'heun' for a potential that is not quadratic, got "
            f"'exact' with {model.potential!r}."
        )
    return method


def starts(initial: Any, n_paths: int, rng: np.random.Generator) -> Array:
    """Positions at s = 0, shape (n_paths, 2)."""
    if isinstance(initial, tuple) and initial and isinstance(initial[0], PlaneGrid):
        grid, density = initial
        return drawn(grid, density, n_paths, rng)
    given = initial(rng, n_paths) if callable(initial) else initial
    xi = check_numbers("initial", given)
    if xi.shape not in ((2,), (n_paths, 2)):
        raise ValueError(
            f"`initial` must be a point (xi1, xi2) or have the shape ({n_paths}, 2), "
            f"got {xi.shape}."
        )
    if not np.isfinite(xi).all():
        raise ValueError("`initial` must be finite, got NaN or infinity.")
    return np.array(np.broadcast_to(xi, (n_paths, 2)))


def drawn(
    grid: PlaneGrid, density: Any, n_paths: int, rng: np.random.Generator
) -> Array:
    """Positions with a density that is constant on each cell."""
    mass = grid.check(density, "initial").ravel()
    if not (mass.min() >= 0 and 0 < mass.sum() < math.inf):
        raise ValueError(
            "`initial` must be a non-negative, finite density with mass, got a minimum "
            f"of {mass.min():g} and a sum of {mass.sum():g}."
        )
    cells = np.unravel_index(
        rng.choice(mass.size, n_paths, p=mass / mass.sum()), grid.shape
    )
    centres = np.stack([grid.xi1[cells[0]], grid.xi2[cells[1]]], axis=1)
    return np.asarray(centres + (rng.random((n_paths, 2)) - 0.5) * grid.spacing)


def checked_stops(s_end: float, save_at: Iterable[float] | None) -> Array:
    """Where paths are kept, ascending."""
    end = check_positive("s_end", s_end)
    asked = [end] if save_at is None else checked_series(save_at)
    stops = np.array(sorted(set(asked)))
    if not (stops.size and stops[0] >= 0 and stops[-1] <= end):
        raise ValueError(
            f"`save_at` must hold numbers in [0, {end:g}], got {stops.tolist()}."
        )
    return stops


def _exact(
    model: FibreModel, xi: Array, stops: Array, rng: np.random.Generator
) -> HydrodynamicPaths:
    """From one saved point to the next by the Gaussian transition law."""
    process = OrnsteinUhlenbeckLimit(model)
    gaps = np.diff(stops, prepend=0.0)
    saved = np.empty((len(stops), *xi.shape))
    for i, gap in enumerate(gaps):
        xi = process.transition(xi, gap, rng) if gap else xi
        saved[i] = xi
    return HydrodynamicPaths(stops, saved, "exact", float(gaps.max()), model)


def _heun(
    model: FibreModel, xi: Array, schedule: Schedule, rng: np.random.Generator
) -> HydrodynamicPaths:
    """ξ* = ξ + a(ξ) ds + b ΔW, ξ ← ξ + ½(a(ξ) + a(ξ*)) ds + b ΔW.

    Weakly of order 2, because the noise is additive.
    """
    # √(2εF ds), εF half the persistence length.
    amplitude = math.sqrt(Persistence.of(model).length * schedule.ds)
    drift = _Drift(model)
    saved = [xi] if 0 in schedule.saves else []
    saves = set(schedule.saves)
    for step in range(1, schedule.n_steps + 1):
        kick = amplitude * rng.standard_normal(xi.shape)
        # Where a path runs away the potential overflows; the step is then refused.
        with np.errstate(all="ignore"):
            slope = drift(xi)
            ahead = drift(xi + schedule.ds * slope + kick)
            moved = xi + 0.5 * schedule.ds * (slope + ahead) + kick
        check_paths(model, xi, moved, schedule.s(step - 1))
        xi = moved
        if step in saves:
            saved.append(xi)
    s = np.array([schedule.s(step) for step in schedule.saves])
    return HydrodynamicPaths(s, np.array(saved), "heun", schedule.ds, model)


class _Drift:
    """a(ξ) = −ε∇B(ξ) + v e₁."""

    def __init__(self, model: FibreModel) -> None:
        self.gradient = model.potential.gradient
        self.epsilon = 1.0 / model.noise**2
        self.belt = np.array([model.belt_speed, 0.0])

    def __call__(self, xi: Array) -> Array:
        slopes = np.stack(self.gradient(xi[:, 0], xi[:, 1]), axis=1)
        return np.asarray(self.belt - self.epsilon * slopes)


def check_paths(model: FibreModel, before: Array, after: Array, s: float) -> None:
    """Raise NonFinitePathError if a step led to infinity."""
    if math.isfinite(float(np.abs(after).max())):
        return
    path = int(np.flatnonzero(~np.isfinite(after).all(axis=1))[0])
    xi1, xi2 = map(float, before[path])
    with np.errstate(all="ignore"):
        slope1, slope2 = map(float, model.potential.gradient(xi1, xi2))
    raise NonFinitePathError(path, s, (xi1, xi2), (slope1, slope2))
