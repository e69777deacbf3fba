"""One run to equilibrium: ∫ H ds and the decay rate of H, with errors."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from fpsolve._support.arrays import Array
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.rates.modes import SlowestMode, relative_norm, slowest_modes
from fpsolve.studies.rates.relaxation_plan import N_SAVED, Plan, plan_relaxation
from fpsolve.studies.starts import density_and_law

__all__ = ["relaxation_case"]

# Cells of the comparison are longer by 4/3. Where a kink makes the order two, its
# error then is 16/9 of that of the run, and their difference 7/9.
_GRID_FACTOR = 9 / 7
# A class without a mode that stands out is faster if it falls by this factor faster.
_CLEARLY = 1.5
# Records at every step until here, in steps; then at least every so much s.
_DENSE, _RECORD = 16, 0.2


def relaxation_case(
    potential: Potential,
    noise: float,
    law: Any,
    tolerance: float,
    e_folds: float,
    s_end: float | None = None,
) -> dict[str, Any]:
    """∫₀^S H ds and the asymptotic decay rate of H from runs of `drift_kick`.

    Balanced runs with ds and ds/2, extrapolated, and one with ds on a coarser grid in
    a smaller box. All runs share the records, so that a quadrature error, from every
    other record, is added.

    Parameters
    ----------
    potential : Potential
    noise : float
    law : GaussianLaw
        Of the start.
    tolerance, e_folds, s_end : float
        See `plan_relaxation`.

    Returns
    -------
    dict
        Numbers by the names of the Dataset of `rate_versus_noise`.
    """
    model = LayDownModel(potential, noise)
    plan = plan_relaxation(model, tolerance, e_folds, s_end)
    runs = _Runs(
        coarse=_Relaxation(model, plan.grid, plan, law, 1),
        fine=_Relaxation(model, plan.grid, plan, law, 2),
        other=_Relaxation(model, plan.compared, plan, law, 1),
    )
    return {**_integral(runs), **_rates(runs), **_description(plan, runs.fine)}


class _Relaxation:
    """One run: its entropy over s, and its slowest modes."""

    def __init__(
        self,
        model: LayDownModel,
        grid: PhaseSpaceGrid,
        plan: Plan,
        law: Any,
        parts: int,
    ) -> None:
        ds = plan.ds / parts
        scheme = drift_kick(model, grid, balanced=True)
        p0, _ = density_and_law(law, grid)
        n_steps = round(plan.s_end / plan.ds)
        turn = min(_DENSE, n_steps // 2) * plan.ds
        first = solve(scheme, p0, (0.0, turn), ds, record_every=parts)
        places = plan.spacing * np.arange(N_SAVED + 1)
        every = max(1, int(_RECORD / plan.ds)) * parts
        rest = solve(
            scheme, first.final, (turn, plan.s_end), ds,
            save_at=places[places >= turn], record_every=every,
        )  # fmt: skip
        self.floor = rest.entropy_floor
        self.s = np.concatenate([first.s, rest.s[1:]])
        self.entropy = _joined(first, rest, "relative_entropy") - self.floor
        self.loss = _joined(first, rest, "entropy_dissipation")
        self.boundary_mass = float(
            max(first.boundary_mass.max(), rest.boundary_mass.max())
        )
        self.modes = slowest_modes(rest.densities, plan.spacing, model, grid)
        # H = ½‖x‖² as long as x is small.
        norm = relative_norm(rest.final, model, grid)
        self.quadratic = float(self.entropy[-1] / (0.5 * norm**2))

    def integral(self, every: int = 1) -> float:
        """∫ H ds by cubics with the slopes that the recorded dissipation gives."""
        places = np.unique(np.append(np.arange(0, self.s.size, every), self.s.size - 1))
        s, entropy, loss = self.s[places], self.entropy[places], self.loss[places]
        return float(CubicHermiteSpline(s, entropy, -loss).integrate(s[0], s[-1]))

    @property
    def quadrature_error(self) -> float:
        """Of the integral, from every other record; the rule is of order four."""
        return abs(self.integral() - self.integral(2)) / 15


def _joined(first: Any, rest: Any, name: str) -> Array:
    return np.concatenate([first.series[name], rest.series[name][1:]])


class _Runs(NamedTuple):
    """The run with ds, the one with ds/2, and the one on a coarser grid."""

    coarse: _Relaxation
    fine: _Relaxation
    other: _Relaxation

    def errors(self, number: Callable[[_Relaxation], float]) -> tuple[float, float]:
        """What step and grid do to a number of a run."""
        coarse, fine, other = map(number, self)
        return abs(fine - coarse) / 3, _GRID_FACTOR * abs(other - coarse)


def _integral(runs: _Runs) -> dict[str, float]:
    """I = ∫₀^S H ds, its errors, and a bound of what lies beyond S."""
    coarse, fine = runs.coarse.integral(), runs.fine.integral()
    step, grid = runs.errors(_Relaxation.integral)
    return {
        "inverse_decay_rate": fine + (fine - coarse) / 3,
        "inverse_decay_rate_error": step + grid + runs.fine.quadrature_error,
        "inverse_decay_rate_step_error": step,
        "inverse_decay_rate_grid_error": grid,
        "tail_bound": _tail(runs.fine),
    }


def _tail(run: _Relaxation) -> float:
    """∫_S^∞ H ds if H e^{λs} stays below its largest value in the second half."""
    rates = [mode.rate for mode in run.modes.values() if math.isfinite(mode.rate)]
    if not rates:
        return math.nan
    rate = 2 * min(rates)
    late = run.s >= run.s[-1] / 2
    ahead = np.exp(rate * (run.s[late] - run.s[-1]))
    return float(np.max(run.entropy[late] * ahead)) / rate


def _rates(runs: _Runs) -> dict[str, Any]:
    """Decay rate of H: twice that of the slowest mode, each class extrapolated."""
    fine, names = runs.fine, list(runs.fine.modes)
    found = [_extrapolated(*(run.modes[name] for run in runs)) for name in names]
    modes, errors = (np.array(column) for column in zip(*found, strict=True))
    apparent = np.array([fine.modes[name].apparent for name in names])
    slowest = _slowest(-modes.real, errors, apparent)
    line = fit_decay(fine.s, fine.entropy, step_error=_step_error(runs))
    if slowest is None:
        rate, error = line.rate / 2, line.standard_error / 2
        _warn_of_line(line, fine.s[-1])
    else:
        rate, error = -modes[slowest].real, errors[slowest]
    return {
        "entropy_rate": 2 * rate,
        "entropy_rate_error": 2 * error,
        "entropy_rate_line": line.rate,
        "entropy_rate_line_error": line.standard_error,
        "run_rate": -modes.real,
        "run_rate_error": errors,
        "slowest_class": "not resolved" if slowest is None else names[slowest],
        "quadratic_share": fine.quadratic,
    }


def _step_error(runs: _Runs) -> float:
    """Error of the slope of −ln H from step and grid, relative."""
    return sum(runs.errors(_slope)) / abs(_slope(runs.fine))


def _slope(run: _Relaxation) -> float:
    return fit_decay(run.s, run.entropy).rate


def _warn_of_line(line: DecayRate, s_end: float) -> None:
    """Say what stands in for the rate of a mode, and what would do better."""
    warnings.warn(
        f"no slowest mode stands out in a run to s = {s_end:.4g}: the rate of H is the "
        f"slope of ln H, {line}; `s_end={2 * s_end:.4g}` would resolve it if modes are "
        'apart, and the part "gap" is half of it without a run.',
        UserWarning,
        stacklevel=2,
    )


def _slowest(rates: Array, errors: Array, apparent: Array) -> int | None:
    """The slowest of the classes; None if another one may be slower.

    Next to an essential spectrum, or at a double eigenvalue, no mode may stand out in
    a class. Unless the whole of it falls clearly faster, the rate of the other classes
    would be no answer then.
    """
    known = np.isfinite(rates) & np.isfinite(errors)
    if not known.any():
        return None
    slowest = int(np.argmin(np.where(known, rates, np.inf)))
    rivals = ~known & (apparent < _CLEARLY * rates[slowest])
    return None if rivals.any() else slowest


def _extrapolated(
    coarse: SlowestMode, fine: SlowestMode, other: SlowestMode
) -> tuple[complex, float]:
    """Eigenvalue at ds → 0 and the error of its real part: step, grid and subspace.

    Frequencies are known up to multiples of 2π over the spacing of the densities.
    """
    change = fine.eigenvalue - coarse.eigenvalue
    grid = _GRID_FACTOR * abs(other.rate - coarse.rate)
    error = abs(change.real) / 3 + grid + max(coarse.error, fine.error)
    return fine.eigenvalue + change / 3, error


def _description(plan: Plan, fine: _Relaxation) -> dict[str, Any]:
    return {
        "s_end": plan.s_end,
        "ds": plan.ds,
        "half_width": np.array(plan.grid.half_widths),
        "cells": np.array(plan.grid.shape),
        "entropy_start": float(fine.entropy[0]),
        "entropy_end": float(fine.entropy[-1]),
        "boundary_mass": fine.boundary_mass,
    }
