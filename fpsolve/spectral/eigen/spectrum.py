"""Eigenvalues of the generator, each with its error and its sector."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array, Complex
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_integer
from fpsolve.evolution.call import Call, recorded
from fpsolve.evolution.saved import Saved
from fpsolve.grids.smooth import AnyGrid, check_smooth_grid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.bases.choice import check_resolved, discretisation_for
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation
from fpsolve.spectral.bases.smooth import SmoothDiscretisation
from fpsolve.spectral.eigen.following import left_vector
from fpsolve.spectral.eigen.layout import SPECTRUM
from fpsolve.spectral.eigen.refinement import Refinement
from fpsolve.spectral.eigen.settings import (
    FINEST,
    accepted_for,
    checked_sectors,
    essential_of,
    memory_of,
    tolerance_for,
    work_for,
)
from fpsolve.spectral.eigen.survey import Mode, Scale

__all__ = ["Spectrum", "spectrum"]

# More than any basis that fits resolves.
MOST = 1000


@dataclass(frozen=True, eq=False)
class Spectrum(Saved):
    """The slowest modes of the generator L, without the 0 of the constants.

    Attributes
    ----------
    model : LayDownModel or SmoothLayDownModel
    eigenvalues : ndarray of complex, shape (n,)
        Rightmost first; both of a complex pair, the one with the positive imaginary
        part first.
    errors : ndarray, shape (n,)
        Distance to the eigenvalue in the truncation before, times what is still to
        come if the distances fall slowly, plus rounding.
    residuals : ndarray, shape (n,)
        ‖L f - λ f‖/‖f‖ in L²(μ), computed in the next larger basis, which for a
        quadratic potential holds L f exactly.
    sectors : list of Sector
        Where each eigenvalue belongs. A sector ±M has every eigenvalue twice, once for
        each sign; it is listed once.
    essential : float or None
        Right end of the essential spectrum (B growing linearly); eigenvalues are given
        to the right of it only.
    truncation : Truncation
        The largest basis used.
    call : Call or None
        How `spectrum` was called.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "spectrum"
    layout = SPECTRUM

    model: FibreModel
    eigenvalues: Complex
    errors: Array
    residuals: Array
    sectors: list[Sector]
    essential: float | None
    truncation: Truncation
    _modes: list[Mode] = field(repr=False)
    _discretisation: Discretisation | None = field(repr=False)
    call: Call | None = field(default=None, repr=False)
    provenance: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def gap(self) -> float:
        """-max Re λ over the spectrum without 0: the asymptotic rate of convergence."""
        candidates = [*self.eigenvalues.real[:1], *self._essential]
        return -max(map(float, candidates))

    @property
    def gap_error(self) -> float:
        """Error of `gap`."""
        if self.is_isolated:
            return float(self.errors[0])
        return FINEST * self.gap

    @property
    def is_isolated(self) -> bool:
        """Whether an eigenvalue, not the essential spectrum, limits the rate."""
        return self.eigenvalues.size > 0

    @property
    def multiplicities(self) -> NDArray[np.int64]:
        """2 for the sectors ±M, else 1; shape (n,)."""
        return np.array([sector.multiplicity for sector in self.sectors], np.int64)

    def eigenfunction(self, i: int, grid: AnyGrid) -> Complex:
        """F with L f = λ f on the grid, of norm 1 in L²(μ), μ = p_S.

        Of a smooth fibre on a `SmoothPhaseSpaceGrid`, and of norm 1 in the space of its
        coefficients.

        Its largest coefficient is real and positive. For ±M it is the one of +M; the
        other is its reflection f(ξ1, -ξ2, -α).
        """
        basis, mode = self._basis, self._modes[i]
        vector = normalised(mode.vector)
        if isinstance(basis, SmoothDiscretisation):
            check_smooth_grid(grid)
        return basis.values(vector, mode.sector, mode.truncation, grid)

    def density_mode(self, i: int, grid: AnyGrid) -> Complex:
        """p_S h with L* h = λ h, h of norm 1: the mode of the density itself.

        Of a smooth fibre there is no p_S of a closed form: q with L* q = λ q, its
        coefficients of norm 1, and for ±M the one of -M.

        p_S + ε Re(density_mode · exp(λ s)) solves (7) on a fixed belt. There h is the
        eigenfunction with α turned by π; on a moving belt it is a function of its own,
        less well resolved than the eigenfunction.
        """
        basis, mode = self._basis, self._modes[i]
        left = normalised(left_vector(basis, mode))
        if isinstance(basis, SmoothDiscretisation):
            check_smooth_grid(grid)
            return basis.dual_values(left, mode.sector, mode.truncation, grid)
        h = basis.values(left, mode.sector, mode.truncation, grid)
        assert isinstance(self.model, LayDownModel)
        reference: Complex = h * self.model.equilibrium(*grid.plane())[:, :, None]
        return reference

    @property
    def _basis(self) -> Discretisation:
        if self._discretisation is None:
            raise ValueError(
                "`model` must be known for an eigenfunction, got None; its potential "
                "was your own code: call `spectrum` again."
            )
        return self._discretisation

    @property
    def _essential(self) -> list[float]:
        return [] if self.essential is None else [self.essential]

    def __str__(self) -> str:
        lines = [] if self.model is None else [self.model.equation]
        lines.append(f"{'eigenvalue':>44}  {'error':>8}  {'residual':>8}  sector")
        rows = zip(
            self.eigenvalues, self.errors, self.residuals, self.sectors, strict=True
        )
        for value, error, residual, sector in rows:
            digits = max(1, min(15, math.floor(-math.log10(error))))
            number = f"{value.real:.{digits}f}"
            number += f" {value.imag:+.{digits}f}i" if value.imag else ""
            lines.append(f"{number:>44}  {error:8.1e}  {residual:8.1e}  {sector}")
        if self.essential is not None:
            lines.append(f"essential spectrum from {self.essential:.12g}")
        return "\n".join(lines)


@recorded()
@one_blas_thread()
def spectrum(
    model: FibreModel,
    n_eigenvalues: int = 6,
    *,
    tolerance: float | None = None,
    sectors: Iterable[Sector] | None = None,
    memory_limit: int | None = None,
    work_limit: float | None = None,
) -> Spectrum:
    """The rightmost eigenvalues of the generator of (9) in L²(μ), other than 0.

    L f = (τ + v e₁)·∇f - ∇B·τ⊥ ∂_α f + (A²/2) ∂_αα f by Galerkin projection on
    polynomials in ξ times harmonics of α, sector by sector; of a smooth fibre that of
    (23), L f = τ·∇f + κ ∂_α f - (κ + ∇B·τ⊥)/R ∂_κ f + (K²/2) ∂_κκ f, in the frame of
    the fibre. All eigenvalues of a truncation right of a line are found by overlapping
    discs along the imaginary axis; those that move from one truncation to the next are
    spurious or not resolved, the others are followed through growing bases until they
    stand still.

    Not proved but measured: that no mode is lost in the sectors of large |M| and at
    the high frequencies where the search ends (see `fpsolve.spectral.survey`).

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        Noise A > 0; a quadratic potential on a belt at rest or of constant speed, or
        any isotropic one on a fixed belt. A smooth fibre: a quadratic potential on a
        belt at rest or of constant speed.
    n_eigenvalues : int
        How many; a complex pair counts as two, ±M as one.
    tolerance : float, optional
        Largest error of every eigenvalue relative to its rate -Re λ, at least 1e-13;
        by default 1e-10. Of a smooth fibre by default 1e-6, on a belt or about unequal
        throwing ranges 1e-4, or what the work reaches, but not above 1e-3: `errors`
        say what.
        Close to a double eigenvalue rounding limits the accuracy to about 1e-8; then
        `errors` says so and no exception is raised.
    sectors : iterable of Sector, optional
        Search in these only.
    memory_limit : int, optional
        Bytes for the largest basis; by default 256 MiB, of a smooth fibre 2 GiB, or
        what is available.
    work_limit : float, optional
        Entries of factors that may be gone through, one or two nanoseconds each; by
        default 1e10, of a smooth fibre 2e10. Bases and their number of eigenvalues
        near the axis grow as the noise falls.

    Raises
    ------
    ValueError
        If the model has no gap, there is no basis for it, or its noise is so small or
        large that rounding hides the rates.
    MemoryLimitError
        If not even the smallest basis fits.
    ToleranceError
        If no basis that fits reaches the tolerance, or none within the work.

    References
    ----------
    [KMW09]_, equation (9); section 3.1.1.
    """
    n = check_integer("n_eigenvalues", n_eigenvalues, 1, MOST)
    discretisation = discretisation_for(model)
    check_resolved(model)
    essential = essential_of(model)
    refinement = Refinement(
        discretisation,
        n,
        tolerance_for(model, tolerance),
        Scale.of(model, essential),
        memory_of(memory_limit, model),
        None if sectors is None else checked_sectors(sectors),
        work_for(model, work_limit),
        accepted_for(model, tolerance),
    )
    modes: list[Mode] = []
    for mode in refinement.run():
        known = mode.vector, mode.eigenvalue, mode.sector, mode.truncation
        mode = replace(mode, residual=discretisation.residual(*known))
        modes += [mode, mode.conjugate()][: mode.count]
    modes = modes[:n]
    largest = max((mode.truncation for mode in modes), default=Truncation(0, 0))
    return Spectrum(
        model=model,
        eigenvalues=np.array([mode.eigenvalue for mode in modes], complex),
        errors=np.array([mode.error for mode in modes]),
        residuals=np.array([mode.residual for mode in modes]),
        sectors=[mode.sector for mode in modes],
        essential=essential,
        truncation=largest,
        _modes=modes,
        _discretisation=discretisation,
    )


def normalised(vector: Complex) -> Complex:
    """The vector with norm 1 and its largest entry real and positive."""
    largest = vector[np.argmax(np.abs(vector))]
    unit: Complex = vector * (abs(largest) / largest) / np.linalg.norm(vector)
    return unit
