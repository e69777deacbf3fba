"""The small-noise limit: the energy process of a fibre on a belt at rest."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_flag
from fpsolve._support.progress import ProgressCallback
from fpsolve._support.provenance import Stopwatch
from fpsolve.evolution.call import Kept, recorded
from fpsolve.evolution.schedule import checked_stops, make_schedule
from fpsolve.reduced.energy.coefficients import Coefficients
from fpsolve.reduced.energy.grid import EnergyGrid
from fpsolve.reduced.energy.passage import Passage
from fpsolve.reduced.energy.sampling import EnergyPaths, sample_energies
from fpsolve.reduced.energy.solution import EnergySolution
from fpsolve.reduced.energy.spectrum import EnergySpectrum, energy_spectrum
from fpsolve.reduced.energy.start import masses_of, starting_masses
from fpsolve.reduced.relaxation import Relaxation, completed

__all__ = ["EnergyProcess"]


def _described_start(start: Any, arguments: Mapping[str, Any]) -> Kept:
    """The masses of the start in the cells, which a solution holds."""
    return Kept("initial_masses", masses_of(start, arguments["grid"]))


class EnergyProcess(Coefficients):
    """dG = -(A²/2) G ds + σ(G) dW, σ² = A² J(G)/S(G): (15), averaged over orbits.

    G = r exp(-B(r)) sin β is constant along the motion (13) of a fibre without noise,
    whose orbits run around the circle r B'(r) = 1. With little noise and on lengths
    of order A⁻², G is a diffusion on [-g_max, g_max], g_max = max r exp(-B). Its
    coefficients are integrals over the orbit of energy g: the period S and the action
    J = 2 ∫ w √(w² - g²) dr with w = r exp(-B), J' = -g S. Its
    stationary density is proportional to S and does not depend on A. A belt speed of
    order A² drops out.

    The paper lets g run through [0, 1], which is so when B is normalised to
    B(1) = 0; otherwise the largest energy is exp(-B(1)), here `g_max`. It restricts β
    to [0, π], that is to |G|, the even family; signed G has the odd family besides,
    whose first rate A²/2 is the slowest of all.

    Everything is dimensionless. B'(1) = 1 is not needed.

    Parameters
    ----------
    potential : Potential
        Isotropic, with a single well: r B'(r) = 1 at exactly one radius.
    noise : float
        Noise amplitude A > 0; it only scales the arclength.

    Raises
    ------
    TypeError
        If `potential` is not a Potential or `noise` not a number.
    ValueError
        If the potential is not isotropic, not normalisable or has more or less than
        one well, or if the noise is not positive.

    References
    ----------
    [KMW09]_, section 3.1.2, equations (13) to (16).
    """

    def eigenvalues(self, n: int, family: str = "even") -> Array:
        """The n smallest decay rates of (16), ascending, about twelve digits.

        Parameters
        ----------
        n : int
        family : {"even", "odd"}
            Even: the process |G|, reflected at 0; begins with 0. Odd: functions of
            signed G that change sign; begins with A²/2.

        Raises
        ------
        ValueError
            If n < 1 or the family is unknown.
        """
        return self.spectrum(n, family).eigenvalues

    @one_blas_thread()
    def spectrum(self, n: int, family: str = "even") -> EnergySpectrum:
        """`eigenvalues` with error estimates and eigenfunctions."""
        return energy_spectrum(self._averages, self.noise, n, family)

    def passage(self, target: float) -> Passage:
        """First passage of |G| to a target: expected length, variance, occupation.

        Raises
        ------
        ValueError
            If the target lies outside [0, g_max].
        """
        return Passage(self._averages, self.noise, target)

    def grid(self, n_cells: int, signed: bool = False) -> EnergyGrid:
        """Cells of |G| on [0, g_max], or of signed G, for `solve`; see `EnergyGrid`."""
        return EnergyGrid(self._averages, n_cells, signed)

    @recorded(start=_described_start)
    @one_blas_thread()
    def solve(
        self,
        start: Callable[[Array], ArrayLike] | ArrayLike,
        s_span: tuple[float, float],
        ds: float,
        *,
        grid: EnergyGrid,
        save_at: Iterable[float] | None = None,
        method: str = "backward_euler",
        extrapolate: bool = False,
        record_every: int = 1,
        progress: bool | ProgressCallback = False,
    ) -> EnergySolution:
        """∂ₛp + ∂_g(a p) = ½ ∂_gg(σ² p), (16), by finite volumes, implicitly.

        The flux is -(A²/2) J ∂_g(p/S): mass, positivity and the stationary law are
        kept exactly on any grid, and the entropy falls at every step, for any ds,
        with the default method. Order 2 in the cells, 1 in ds ("backward_euler") or 2
        ("sdirk2", positivity not promised).

        Parameters
        ----------
        start : callable, float, or array_like
            Density p0(g) as a function of g; an energy, where all mass begins; or the
            masses of the cells. Normalised.
        s_span : (float, float)
            Arclength at the start and at the end.
        ds : float
            Step; must divide the span. Rates are of the order A².
        grid : EnergyGrid
            From `grid(n_cells, signed)`.
        save_at : iterable of float, optional
            Where to keep the density; by default at the end.
        method : {"backward_euler", "sdirk2"}
        extrapolate : bool
            Run with ds and ds/2 and combine them; errors are then estimated.
        record_every : int
            Steps between two records.
        progress : bool or callable

        Returns
        -------
        EnergySolution

        Raises
        ------
        ValueError
            If the arguments do not fit.
        TypeError
            If `grid` is not an EnergyGrid.
        RunInterrupted
            After Ctrl-C; `solution` is what was recorded, or the finished run at ds.

        Warns
        -----
        UserWarning
            If ds of an extrapolated run is longer than twice the time scale of the
            slowest mode, so that its estimates may be too small.
        """
        self._check_grid(grid)
        save_at = None if save_at is None else checked_stops(save_at)
        schedule = make_schedule(s_span, ds, save_at, record_every)
        start = masses_of(start, grid)
        extrapolate = check_flag("extrapolate", extrapolate)
        watch = Stopwatch()

        def solution(
            found: Relaxation, errors: Mapping[str, Array] | None, status: str
        ) -> EnergySolution:
            n_steps = schedule.n_steps * (1 + 2 * (errors is not None))
            return EnergySolution(
                self, grid, method, schedule.ds, found.series, errors, found.saved_s,
                found.saved, watch.provenance(n_steps), start, status,
            )  # fmt: skip

        solved: EnergySolution = completed(
            solution, grid.generator(self.noise), starting_masses(start, grid),
            grid.equilibrium, schedule,
            method=method, extrapolate=extrapolate, progress=progress,
        )  # fmt: skip
        return solved

    @recorded()
    @one_blas_thread()
    def sample(
        self,
        n_paths: int,
        s_end: float,
        ds: float,
        *,
        seed: int,
        initial: ArrayLike | str,
        save_at: Iterable[float] | None = None,
        method: str = "transition",
    ) -> EnergyPaths:
        """Paths of (15) with signed G, which never leave [-g_max, g_max].

        By default the next cell of a thousand is drawn from the transition law: exact
        in ds, whatever its length. With "sphere" G/g_max moves as the height of a
        point on a sphere, by normal steps along meridian and parallel, a scheme for
        the stochastic equation itself: weak order 1 in ds at best, less where paths
        cross G = 0. Two runs with the same arguments agree bitwise.

        Parameters
        ----------
        n_paths : int
        s_end, ds : float
            Length and step. For "sphere" A² ds should be 0.05 or less.
        seed : int
        initial : float, ndarray (n_paths,), or "stationary"
            Energies at s = 0.
        save_at : iterable of float, optional
            Multiples of ds; by default the end.
        method : {"transition", "sphere"}

        Raises
        ------
        ValueError
            If an argument does not fit.
        """
        paths = sample_energies(
            self._averages, self.noise, n_paths, s_end, ds, seed, initial, save_at,
            method,
        )  # fmt: skip
        return replace(paths, process=self)

    def __repr__(self) -> str:
        return f"EnergyProcess({self.potential!r}, noise={self.noise:g})"

    def _check_grid(self, grid: EnergyGrid) -> None:
        if not isinstance(grid, EnergyGrid):
            raise TypeError(
                f"`grid` must be an EnergyGrid, got {grid!r}; make one with "
                "`process.grid(n_cells)`."
            )
        if grid.averages.well.potential != self.potential:
            raise ValueError(
                f"`grid` must be one of this process, got one for "
                f"{grid.averages.well.potential!r}; make it with `process.grid`."
            )
