"""∂ₛ𝒫 = ∇·(εF∇ + ε∇B − v e₁)𝒫: the limit of large noise as an object."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_flag, check_positive, check_tolerance
from fpsolve._support.progress import ProgressCallback
from fpsolve.errors import DomainTooSmallError
from fpsolve.evolution.call import Kept, recorded
from fpsolve.evolution.schedule import checked_stops, make_schedule
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid, plane_of
from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.reduced.hydrodynamic import reconstruction, run, sampling
from fpsolve.reduced.hydrodynamic.equation import LimitEquation
from fpsolve.reduced.hydrodynamic.initial_layer import InitialLayer
from fpsolve.reduced.hydrodynamic.ornstein_uhlenbeck import OrnsteinUhlenbeckLimit
from fpsolve.reduced.hydrodynamic.scharfetter_gummel import gibbs_masses
from fpsolve.reduced.hydrodynamic.solution import (
    HydrodynamicSolution,
    HydrodynamicSteadyState,
)
from fpsolve.reduced.hydrodynamic.spectrum import HydrodynamicSpectrum, spectrum_of

__all__ = ["HydrodynamicLimit"]

Start = ArrayLike | Callable[..., ArrayLike]
ROUNDING = 1e-15


def _described_start(P0: Any, arguments: Mapping[str, Any]) -> Kept:
    """The density of the start on the grid, which a solution holds."""
    density = run.checked_start(P0, plane_of(arguments["grid"]))
    return Kept("initial_density", density)


class HydrodynamicLimit(LimitEquation):
    """∂ₛ𝒫 = ∇·(εF∇ + ε∇B − v e₁)𝒫, ε = 1/A²: the model for large noise.

    The angle forgets itself over the arclength 2F/A², and what is left of p is its
    plane density, p ≈ 𝒫/2π. The belt is a constant force, so that the whole drift is
    −εF∇Φ with Φ = (B − v ξ1/ε)/F, and 𝒫_S = c exp(−(B − v ξ1/ε)/F) is stationary, in
    detailed balance. The paper prints −v ξ1/ε; its own remark 3.7, with the mean
    (A²v, 0), needs the plus.

    F = 1 for the basic model. A smooth fibre keeps its direction longer: for A → ∞ at
    fixed a = A²R/2, and R → 0 with it, F = ₁F₁(1; a+1; a), and the drift is the same.
    The corrections are O(ε²), in p that of order ε, see `reconstruct`.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        Any potential that confines, positive noise, FixedBelt or MovingBelt.

    Attributes
    ----------
    model : LayDownModel or SmoothLayDownModel
    epsilon : float
        ε = 1/A².
    diffusivity : float
        εF.

    Raises
    ------
    ValueError
        If the noise is zero, the curve does not move at constant speed, or
        exp(−(B − v ξ1/ε)/F) is not integrable: a potential that does not confine, or
        B = K‖ξ‖ and v >= K ε.
    TypeError
        If `model` is something else.

    References
    ----------
    [BGKMW08]_; [KMW09]_, section 3.1.2, equations (17) to (21).
    """

    @one_blas_thread()
    def steady_state(
        self, grid: PlaneGrid | PhaseSpaceGrid, *, boundary_tolerance: float = 1e-3
    ) -> HydrodynamicSteadyState:
        """𝒫_S on a grid: the stationary density of the discrete equation, exactly.

        It is known in closed form; what is computed is its residual, and its error as
        a density on the plane.

        Raises
        ------
        DomainTooSmallError
            If more than `boundary_tolerance` of the mass lies in the outermost cells.
        """
        plane = plane_of(grid)
        boundary_tolerance = check_tolerance("boundary_tolerance", boundary_tolerance)
        masses = gibbs_masses(self._phi.on(plane))
        residual = float(np.abs(self.generator(plane) @ masses.ravel()).sum())
        share = diagnostics.ring_share(masses)
        if not share <= boundary_tolerance:
            raise DomainTooSmallError(
                share, plane.half_width, tolerance=boundary_tolerance
            )
        density = masses / plane.cell_area
        error = self._stationary_error(plane)
        return HydrodynamicSteadyState(density, residual, share, plane, error)

    def _stationary_error(self, plane: PlaneGrid) -> float:
        """∫ |𝒫 − 𝒫_S| of exp(−Φ) at the centres, normalised on the grid."""
        n1, n2 = plane.shape
        twice = PlaneGrid(plane.half_width, (2 * n1, 2 * n2))
        here, finer = (
            float(self.equilibrium(*one.mesh()).sum()) * one.cell_area
            for one in (plane, twice)
        )
        return 2.0 * abs(1.0 - finer) + 2.0 * abs(here - finer) + ROUNDING

    @recorded(P0=_described_start)
    @one_blas_thread()
    def solve(
        self,
        P0: Start,
        s_span: tuple[float, float],
        ds: float,
        *,
        grid: PlaneGrid | PhaseSpaceGrid,
        method: str = "backward_euler",
        save_at: Iterable[float] | None = None,
        extrapolate: bool = False,
        record_every: int = 1,
        progress: bool | ProgressCallback = False,
        boundary_tolerance: float = 1e-3,
    ) -> HydrodynamicSolution:
        """𝒫(ξ, s) from 𝒫0 by finite volumes in ξ and implicit steps in s.

        Exact: the mass, and 𝒫_S stays. The fluxes are those of Scharfetter and
        Gummel, of order 2 in the cell width. "backward_euler" is of order 1 in ds,
        keeps densities positive and lets the entropy fall at every step whatever ds;
        "sdirk2" is L-stable and of order 2, and may undershoot after a rough start.
        `extrapolate` raises either order by one.

        Parameters
        ----------
        P0 : ndarray, shape (n1, n2), or callable
            Density at the start; a callable ``P0(xi1, xi2)`` is normalised on the
            grid. An array keeps its mass. It may be negative somewhere, as a start
            corrected for the initial layer can be.
        s_span : (float, float)
        ds : float
            Step; must divide the span.
        grid : PlaneGrid or PhaseSpaceGrid
            Cells; of a phase-space grid those of its plane. The box is closed.
        method : {"backward_euler", "sdirk2"}
        save_at : iterable of float, optional
            Where to keep the density; by default at the end.
        extrapolate : bool
            Run with ds and ds/2, combine both (Richardson) and attach estimates of
            the error of the step to every series and density. The result need not be
            positive.
        record_every : int
            Steps between two records.
        progress : bool or callable
            Show a bar, or call with (steps done, steps in all, s).
        boundary_tolerance : float
            Largest share of mass in the outermost cells.

        Raises
        ------
        ValueError, GridMismatchError
            For arguments that do not fit.
        DomainTooSmallError
            If mass reaches the boundary of the box; it carries the `solution`.
        RunInterrupted
            After Ctrl-C; `solution` is what was recorded, or the finished run at ds.

        Warns
        -----
        UserWarning
            If ds of an extrapolated run is longer than twice the time scale of the
            slowest mode, so that its estimates may be too small.
        """
        plane = plane_of(grid)
        start = run.checked_start(P0, plane)
        save_at = None if save_at is None else checked_stops(save_at)
        extrapolate = check_flag("extrapolate", extrapolate)
        check_positive("boundary_tolerance", boundary_tolerance)
        schedule = make_schedule(s_span, ds, save_at, record_every)
        found = run.solve(
            self, plane, start, schedule, method=method, extrapolate=extrapolate,
            progress=progress,
        )  # fmt: skip
        run.check_box(found, boundary_tolerance)
        return found

    @one_blas_thread()
    def spectrum(
        self, grid: PlaneGrid | PhaseSpaceGrid, n_eigenvalues: int = 6
    ) -> HydrodynamicSpectrum:
        """The slowest decay rates on a grid, with errors from half its cells.

        Eigenvalues of the symmetrised generator, all real, of order 2 in the cell
        width. They also depend on the box: modes of B = K‖ξ‖ reach far, and above
        εK²/4F, where its essential spectrum begins, eigenvalues are those of the box.
        Exact values: ε(k/σ1² + l/σ2²) for the quadratic potential on any belt, and
        the gap 2εK²/9F of the linear one on a belt at rest.

        Raises
        ------
        ValueError
            If the grid is too coarse for that many.
        """
        return spectrum_of(self, plane_of(grid), n_eigenvalues)

    def gap(self, grid: PlaneGrid | PhaseSpaceGrid | None = None) -> float:
        """Rate at which 𝒫 tends to 𝒫_S: the smallest positive eigenvalue.

        ε/max(σ1², σ2²) exactly for a quadratic potential, where no grid is needed;
        otherwise that of `spectrum(grid)`, which also has its error.

        Raises
        ------
        ValueError
            If a grid is needed.
        """
        if grid is not None:
            return self.spectrum(grid, 2).gap
        if not isinstance(self.model.potential, QuadraticPotential):
            raise ValueError(
                "`grid` must be given for a potential that is not quadratic, got None "
                f"with {self.model.potential!r}."
            )
        return float(OrnsteinUhlenbeckLimit(self.model).rates.min())

    @recorded()
    def sample(
        self,
        n_paths: int,
        s_end: float,
        ds: float | None = None,
        *,
        seed: int | np.random.SeedSequence,
        initial: Any,
        save_at: Iterable[float] | None = None,
        method: str | None = None,
    ) -> sampling.HydrodynamicPaths:
        """Paths of dξ = (−ε∇B + v e₁) ds + √(2εF) dW.

        Parameters
        ----------
        n_paths : int
            At least 2.
        s_end : float
        ds : float
            Step of "heun"; must divide `s_end`.
        seed : int or SeedSequence
        initial : array_like or callable
            A point (xi1, xi2), positions of shape (n_paths, 2), a callable
            ``initial(rng, n_paths)`` that draws them, or a pair of a PlaneGrid and a
            density on it: cells are drawn by their mass, places within evenly.
        save_at : iterable of float, optional
            Where to keep positions; by default at the end.
        method : {"exact", "heun"}, optional
            "exact" draws from the Gaussian transition law of a quadratic potential,
            for which it is the default; "heun" is the stochastic Heun scheme, weakly
            of order 2 for additive noise, for every other.

        Raises
        ------
        ValueError
            For arguments that do not fit.
        NonFinitePathError
            If a path runs away: ds is too long for a potential this steep.
        """
        return sampling.sample(
            self.model, n_paths, s_end, ds, seed=seed, initial=initial,
            save_at=save_at, method=method,
        )  # fmt: skip

    def reconstruct(self, P: Array, grid: PhaseSpaceGrid, *, order: int = 1) -> Array:
        """p ≈ 𝒫/2π + ε p₁ on the phase-space grid; see `reconstruction.reconstruct`.

        Of a smooth fibre that is the density of (ξ, α).
        """
        noise, length = Persistence.of(self.model)
        return reconstruction.reconstruct(
            P, grid, self.model.potential, noise, order=order, relaxation_length=length
        )

    def initial_layer(self, p0: Array, grid: PhaseSpaceGrid) -> InitialLayer:
        """What the slow equation does not see of a start p0; see `InitialLayer`."""
        return InitialLayer(p0, grid, *Persistence.of(self.model))
