"""An ensemble of paths: positions, estimates, single paths, and how it goes on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import saved_index
from fpsolve.grids.phase_space import PhaseSpaceGrid, check_grid
from fpsolve.paths.averages import Observable, observed, time_averages
from fpsolve.paths.ensemble import KAPPA, Ensemble, angle_of
from fpsolve.paths.histogram import Histogram, count_paths, wrapped
from fpsolve.paths.layout import PATHS
from fpsolve.paths.moments import Moments
from fpsolve.paths.runner import completed, going_on
from fpsolve.paths.trajectory import Trajectory, traced, trajectory

__all__ = ["Paths"]


@dataclass(frozen=True, eq=False, repr=False)
class Paths(Saved):
    """Paths (ξ, α) of the model (6), or (ξ, α, κ) of (22), at the saved arclengths.

    Everything is dimensionless, angles are in radians. Estimates come with the
    standard errors of independent paths; the bias of the step comes in addition.

    Attributes
    ----------
    ensemble : Ensemble
        Model, number of paths, steps, seed, method and law of the start.
    s : ndarray, shape (n_saved,)
    states : ndarray, shape (n_saved, n_state, n_paths)
        ξ1, ξ2, cos α, sin α, full turns and, of a smooth model, κ; without paths,
        (n_saved, n_state, 0), when not kept.
    sums : ndarray, shape (n_saved, n_sums)
        Sums over paths for the moments.
    counts : ndarray of int64, shape (n_saved, n1, n2, n_alpha)
        Histograms collected while sampling.
    outside : ndarray of int64, shape (n_saved,)
        Paths outside of the ξ box of the histograms.
    start, end : ndarray, shape (n_state, n_paths)
        States at the beginning and at the end.
    status : str
        "finished" or "interrupted".
    message : str
    provenance : dict
        Versions, date, times, number of path-steps.
    call : Call or None
        The call of `sample_paths` that gives these paths, all of them and whole.
    """

    kind: ClassVar[str] = "paths"
    layout = PATHS

    ensemble: Ensemble
    s: Array
    states: Array
    sums: Array
    counts: NDArray[np.int64]
    outside: NDArray[np.int64]
    start: Array
    end: Array
    status: str = "finished"
    message: str = ""
    provenance: dict[str, Any] = field(default_factory=dict)
    call: Call | None = None

    model = property(
        attrgetter("ensemble.model"),
        doc="The model; None for a file whose potential was the user's own code.",
    )
    n_paths = property(attrgetter("ensemble.n_paths"), doc="Number of paths.")
    ds = property(attrgetter("ensemble.schedule.ds"), doc="Step.")
    s_start = property(
        attrgetter("ensemble.schedule.start"),
        doc="Arclength at which step 0 begins.",
    )
    seed = property(
        attrgetter("ensemble.seed"),
        doc="The seed: with model, method and step it determines every path.",
    )
    method = property(attrgetter("ensemble.method"), doc="Name of the integrator.")
    initial = property(attrgetter("ensemble.law"), doc="Law of the start.")
    kept = property(attrgetter("ensemble.keep"), doc="Whether positions were kept.")

    def check_model(self) -> None:
        """Raise ValueError unless the model is known, as the paths go on by it."""
        self.ensemble.check_model()

    def __repr__(self) -> str:
        s = ", ".join(f"{value:g}" for value in self.s[:4])
        more = ", …" if len(self.s) > 4 else ""
        return (
            f"Paths({self.n_paths} paths, {self.method}, ds = {self.ds:g}, "
            f"seed = {self.seed}, saved at s = {s}{more}, {self.status})"
        )

    @property
    def xi(self) -> Array:
        """Deviations ξ; shape (n_saved, n_paths, 2)."""
        return self._kept(self.states)[:, :2].transpose(0, 2, 1)

    @cached_property
    def alpha(self) -> Array:
        """Angles α, continuous along every path; shape (n_saved, n_paths)."""
        return angle_of(self._kept(self.states))

    @property
    def wrapped_alpha(self) -> Array:
        """Angles α in [0, 2π); shape (n_saved, n_paths)."""
        return wrapped(self.alpha)

    @property
    def kappa(self) -> Array:
        """Curvatures κ of smooth fibres; shape (n_saved, n_paths).

        Raises
        ------
        ValueError
            If the model is the basic one, whose fibres have none.
        """
        states = self._kept(self.states)
        if not states.shape[1] > KAPPA:
            raise ValueError(
                "`model` must be a SmoothLayDownModel for paths to have a curvature, "
                "got paths of the basic model."
            )
        return states[:, KAPPA]

    @property
    def eta(self) -> Array:
        """Fibres on the belt, η = ξ + γ(s); shape (n_saved, n_paths, 2)."""
        self.check_model()
        position: Array = np.stack(self.model.curve.position(self.s), axis=-1)
        return self.xi + position[:, None, :]

    def moments(self) -> Moments:
        """Mean, covariance and mean direction at every saved s, with standard errors.

        They were collected while sampling, and are there whether or not positions are.
        """
        return Moments(self.s, self.n_paths, self.sums)

    def expectation(self, f: Observable) -> tuple[Array, Array]:
        """E f(ξ1, ξ2, α) at every saved s and its standard error; (n_saved,) each."""
        xi1, xi2 = self._kept(self.states)[:, 0], self.states[:, 1]
        values = observed(f, xi1, xi2, self.alpha)
        deviation = values.std(axis=1, ddof=1) if self.n_paths > 1 else np.nan
        error = np.broadcast_to(deviation / np.sqrt(self.n_paths), self.s.shape)
        return values.mean(axis=1), np.array(error)

    def histogram(
        self, grid: PhaseSpaceGrid | None = None, s: float | None = None
    ) -> Histogram:
        """Numbers of paths in the cells of a grid at a saved s.

        Parameters
        ----------
        grid : PhaseSpaceGrid, optional
            By default the one whose histograms were collected while sampling.
        s : float, optional
            By default the last saved one.

        Raises
        ------
        ValueError
            If nothing was saved at s, or if there is neither a collected histogram
            nor a position.
        """
        at = self._index(s)
        if grid is not None:
            check_grid(grid)
        known = self.ensemble.grid
        if known is not None and (grid is None or grid == known):
            counts, outside, grid = self.counts[at], int(self.outside[at]), known
        elif grid is None:
            raise ValueError(
                "`grid` must be given, got None; no histogram was collected while "
                "sampling. Pass a grid here, or as `histogram` to sample_paths."
            )
        else:
            state = self._kept(self.states)[at]
            counts, outside = count_paths(grid, state[0], state[1], angle_of(state))
        return Histogram(grid, float(self.s[at]), counts, outside, self.n_paths)

    def marginal(
        self, which: str, s: float | None = None, grid: PhaseSpaceGrid | None = None
    ) -> Array:
        """Density of "xi", "alpha", "xi1" or "xi2", averaged over cells of a grid."""
        density: Array = self.histogram(grid, s).marginal(which)
        return density

    def time_averages(self, f: Observable | Sequence[Observable]) -> Array:
        """(1/s)∫ f(ξ, α) ds along every path, from its start to every saved s.

        The paths are run again, the same ones, and every step counts (trapezoidal
        rule). Positions need not have been kept.

        Parameters
        ----------
        f : callable or sequence of callables
            ``f(xi1, xi2, alpha)`` elementwise on arrays of one shape.

        Returns
        -------
        ndarray, shape (n_saved, n_paths)
            With a leading axis for a sequence. NaN at the start itself, where there is
            nothing to average.
        """
        several = isinstance(f, tuple | list)
        asked: Any = f if several else [f]
        found = time_averages(self.ensemble, self._traced, asked)
        return found if several else np.asarray(found[0])

    def replay(self, k: int, every: int = 1) -> Trajectory:
        """Path k from its start to the end, at every step or every few.

        It is run again and equals what was saved bitwise.

        Raises
        ------
        ValueError
            If there is no path k.
        TypeError
            If `k` or `every` is not an integer.
        """
        k = check_integer("k", k, 0)
        if not k < self.n_paths:
            raise ValueError(
                f"`k` must be below the number of paths {self.n_paths}, got {k}."
            )
        every = check_integer("every", every, 1)
        return trajectory(self.ensemble, self._traced(k, 1), every)

    def continued(
        self,
        s_end: float,
        *,
        save_at: Iterable[float] | None = None,
        progress: Any = False,
    ) -> Paths:
        """The same paths on to `s_end`, bitwise as if they had never stopped.

        The result is what one call of `sample_paths` from the start to `s_end` gives,
        histograms, moments and averages along paths included; what was saved before
        stays with these paths.

        Parameters
        ----------
        s_end : float
            Beyond the end of these paths, by whole steps.
        save_at : iterable of float, optional
            Where to save; by default at the end.
        progress : bool or callable

        Raises
        ------
        ValueError
            If `s_end` is not beyond the end, an arclength to save at is not on the way,
            or if the states were not kept.
        MemoryLimitError
            If the result would not fit into memory.
        """
        ensemble = going_on(self.ensemble, s_end, save_at)
        longer: Paths = completed(Paths, ensemble, self, None, progress)
        return longer

    def _traced(self, first: int, n: int) -> Iterator[tuple[int, Array]]:
        """The states of some of the paths at every step, leg by leg."""
        self.check_model()
        end = self.end[:, first : first + n] if self.kept else None
        return traced(self.ensemble, first, self.states_at_start(first, n), end)

    def states_at_start(self, first: int, n: int) -> Array:
        """States (n_state, n) at which some of the paths begin."""
        if self.kept:
            return self.start[:, first : first + n].copy()
        return self.ensemble.initial_state(first, n)

    def _kept(self, array: Array) -> Array:
        if not self.kept:
            raise ValueError(
                "positions must have been kept for this, got paths sampled with "
                "keep=False; moments and collected histograms are there."
            )
        return array

    def _index(self, s: float | None) -> int:
        """Index of a saved s."""
        if s is None and len(self.s):
            return len(self.s) - 1
        wanted = np.nan if s is None else s
        return saved_index(np.asarray(self.s), wanted, self.ds, "add it to `save_at`")
