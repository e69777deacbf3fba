"""Sample the stochastic differential equations (6) and (22)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from fpsolve._support.arrays import check_numbers
from fpsolve._support.checks import (
    check_flag,
    check_integer,
    check_one_of,
    shown,
)
from fpsolve._support.memory import check_memory
from fpsolve._support.progress import ProgressCallback
from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.ensemble import START_BLOCK, Ensemble, GivenStart, checked_sample
from fpsolve.paths.laws import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.paths.randomness import seed_number, start_generator
from fpsolve.paths.result import Paths
from fpsolve.paths.runner import completed, required_memory, stepwise
from fpsolve.paths.samplers import integrator_of

__all__ = ["sample_paths"]


# Laws that draw from the generator alone.
KNOWN = (PointLaw, GaussianLaw, EquilibriumLaw, DensityLaw, GivenStart)


def sample_paths(
    model: FibreModel,
    n_paths: int,
    s_end: float,
    ds: float,
    *,
    seed: int | np.random.SeedSequence | None = None,
    rng: Any = None,
    initial: Any = None,
    save_at: Iterable[float] | None = None,
    s_start: float = 0.0,
    method: str = "splitting",
    histogram: PhaseSpaceGrid | None = None,
    keep: bool = True,
    client: Any = None,
    progress: bool | ProgressCallback = False,
    memory_limit: int | None = None,
) -> Paths:
    """Paths of dξ = τ(α) ds - dγ, dα = -∇B(ξ)·τ⊥(α) ds + A dW, or of smooth fibres.

    For a `SmoothLayDownModel` they are paths of dα = κ ds,
    dκ = -(κ + ∇B·τ⊥)/R ds + K dW: a step draws the noise of (κ, α, ∫α) together, and
    the force acts through its mean tangent; weakly of order 2, uniformly in R, and
    exact in (α, κ) without potential.

    For a `LayDownModel` the splitting T½ R½ D R½ T½ is weakly of order 2; it is exact
    in the angle for frozen ξ, and safe for A = 0, for any A √ds, and through the kink
    of B = ‖ξ‖. Path k depends on (seed, k, ds) alone: it is bitwise the same for any
    number of paths, of threads and of workers, and wherever it is saved.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        Any potential and any curve. A potential of the user's own is evaluated by its
        Python functions, the others by compiled code.
    n_paths : int
    s_end : float
    ds : float
        Step; must divide the span.
    seed : int or SeedSequence
    rng : Generator, int or SeedSequence
        Instead of `seed`; a generator gives one number, the seed that is recorded.
    initial : law or arrays, optional
        A law from `fpsolve.paths` (or any object with ``sample(rng, n)``), or arrays of
        shape (n_paths, 2) and (n_paths,) for ξ and α, or one point for all. By default
        ξ = 0, the point below the nozzle, and a uniform angle. For a smooth model a
        third array is κ; without it κ has the Gaussian law of variance K²R/2 that it
        keeps where no force turns the fibre.
    save_at : iterable of float, optional
        Where to keep the paths; by default at the end.
    s_start : float
        Arclength at the start; it matters for curves that turn or swing.
    method : {"splitting", "euler_maruyama", "heun"}
        For a smooth model "splitting" only.
    histogram : PhaseSpaceGrid, optional
        Count the paths in the cells of this grid at every saved s, while sampling.
    keep : bool
        False keeps no positions: memory then does not depend on `n_paths`.
    client : optional
        Where to compute: a dask.distributed client, or an executor of
        concurrent.futures; anything whose ``submit(f, *args)`` gives a future.
    progress : bool or callable
        Show a bar, or call with (path-steps done, path-steps in all, s).
    memory_limit : int, optional
        Bytes the result may take; by default what is available.

    Returns
    -------
    Paths

    Raises
    ------
    ValueError, TypeError
        Bad arguments.
    MemoryLimitError
        If the result would not fit into memory.
    NonFinitePathError
        If the gradient is not finite where a path comes.
    RunInterrupted
        On Ctrl-C, with the finished part of the paths as `.solution`.

    Warns
    -----
    UserWarning
        If |∇B| ds exceeds 2.5 where more than one path in a hundred ends: the method
        is not of its order there.

    References
    ----------
    [KMW09]_, section 3.1, equation (6), and section 3.2, equation (22).
    """
    check_fibre_model(model)
    n_paths = check_integer("n_paths", n_paths, 1)
    check_one_of("method", method, integrator_of(model).methods)
    check_histogram(histogram)
    schedule = stepwise(s_start, s_end, ds, save_at)
    model.curve.check_span(schedule.start, schedule.end)
    ensemble = Ensemble(
        model=model,
        n_paths=n_paths,
        schedule=schedule,
        seed=seed_number(seed, rng),
        method=method,
        law=law_of(initial, n_paths, isinstance(model, SmoothLayDownModel)),
        keep=check_flag("keep", keep),
        grid=histogram,
    )
    remedy = "pass keep=False to keep no positions, save less often"
    check_memory(required_memory(ensemble), memory_limit, remedy)
    found: Paths = completed(Paths, ensemble, None, client, progress)
    return found


def check_histogram(grid: Any) -> None:
    """Raise TypeError unless it is a grid or nothing."""
    if grid is not None:
        check_grid(grid, "histogram")


def check_repeats(law: Any) -> None:
    """Raise ValueError if a law draws other points from a generator that is the same.

    Path k would then depend on when and where it is drawn, and not on the seed.
    """
    if type(law) in KNOWN:
        return
    first, again = (
        checked_sample(law, law.sample(start_generator(0, 0), START_BLOCK))
        for _ in range(2)
    )
    if not all(map(np.array_equal, first, again)):
        raise ValueError(
            "`initial` must draw from the generator that it is given and from nothing "
            f"else, got two different samples for the same one from {shown(law)}."
        )


def law_of(initial: Any, n_paths: int, smooth: bool = False) -> Any:
    """The law of the start, from any of the ways to give it; κ only if `smooth`."""
    if initial is None:
        return PointLaw()
    if hasattr(initial, "sample"):
        check_repeats(initial)
        return initial
    names = ("xi", "alpha", "kappa") if smooth else ("xi", "alpha")
    given = isinstance(initial, tuple | list) and len(initial)
    if given not in {2, len(names)}:
        raise TypeError(
            "`initial` must be a law with a method sample(rng, n), or a pair "
            f"(xi, alpha){', or (xi, alpha, kappa)' if smooth else ''}, got "
            f"{shown(initial)}."
        )
    points = []
    for name, values in zip(names, initial, strict=False):
        shape = (n_paths, 2) if name == "xi" else (n_paths,)
        array = check_numbers("initial", values)
        if array.shape not in (shape[1:], shape):
            raise GridMismatchError(shape, array.shape, f"initial {name}")
        points.append(np.broadcast_to(array, shape))
    for name, values in zip(names, points, strict=False):
        if not np.isfinite(values).all():
            index = np.argwhere(~np.isfinite(values))[0]
            raise ValueError(
                f"`initial` must be finite, got {values[tuple(index)]:g} in {name} of "
                f"path {index[0]}."
            )
    return GivenStart(*points)
