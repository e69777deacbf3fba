"""Steps for a cross-check: small against the statistical error, and fitting s."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fpsolve._support.arrays import Array
from fpsolve.density.suggestions import suggest_step
from fpsolve.evolution.schedule import step_dividing
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel

__all__ = ["common_step", "paths_step", "solver_step", "step_bias"]

# A step this many times smaller than needed is a sign that the arclengths have no
# sensible common divisor.
MOST_DIVISIONS = 50
# Bias of the paths, relative to the standard error, at which their step is small
# enough; and how often it is halved to get there.
NEGLIGIBLE, MOST_HALVINGS = 0.1, 4


def solver_step(
    model: LayDownModel, grid: PhaseSpaceGrid, s: Array, n_paths: int
) -> float:
    """Step whose L1 error is 1/√N before extrapolation, dividing every s."""
    suggested = suggest_step(model, grid, min(0.1, 1.0 / math.sqrt(n_paths)))
    return common_step(s, float(suggested))


def common_step(s: Array, longest: float) -> float:
    """Longest step, at most `longest`, of which every s is a multiple.

    Raises
    ------
    ValueError
        If there is none that is not far smaller.
    """
    step = step_dividing(s, longest, MOST_DIVISIONS)
    if step is None:
        raise ValueError(
            f"`s` must be multiples of one step near {longest:.3g}, got "
            f"{', '.join(f'{one:g}' for one in s)}; round them, or give `ds`."
        )
    return step


def step_bias(ds: float, solver_ds: float, error: float) -> float:
    """Bias of paths with step ds: the density's error at solver_ds/2, times (h/h′)².

    The sampler's splitting is the palindrome of `drift_kick`: with the same step,
    both have the same law, up to the interpolation on the grid. The Richardson
    estimate of a density's run is therefore also that of the bias of the paths. For
    the density of another scheme of order two it is the right order of magnitude.

    Parameters
    ----------
    ds : float
        Step of the paths.
    solver_ds : float
        Longer step of the extrapolated run.
    error : float
        Its Richardson estimate, which belongs to solver_ds/2.
    """
    return error * (2 * ds / solver_ds) ** 2


def paths_step(
    solver_ds: float,
    moments: Mapping[str, float],
    errors: Mapping[str, float],
    n_paths: int,
) -> float:
    """Half the step of the density, halved until the bias is negligible.

    Negligible is a tenth of the standard error of every moment, estimated from the
    moments of the density (for variances as if ξ were Gaussian, which is enough to
    choose a step).
    """
    ds = solver_ds / 2
    worst = max(
        (
            errors[name] * math.sqrt(n_paths) / deviation
            for name, deviation in _deviations(moments).items()
            if deviation > 0 and not math.isnan(errors[name])
        ),
        default=0.0,
    )
    for _ in range(MOST_HALVINGS):
        if worst * (2 * ds / solver_ds) ** 2 <= NEGLIGIBLE:
            break
        ds /= 2
    return ds


def _deviations(moments: Mapping[str, float]) -> dict[str, float]:
    """Standard deviation of what a moment is the mean of."""
    variance1, variance2 = moments["variance_xi1"], moments["variance_xi2"]
    # E cos² is at most 1, so these are bounds from below of the resolution.
    cosine, sine = moments["mean_cos_alpha"], moments["mean_sin_alpha"]
    return {
        "mean_xi1": math.sqrt(variance1),
        "mean_xi2": math.sqrt(variance2),
        "variance_xi1": math.sqrt(2) * variance1,
        "variance_xi2": math.sqrt(2) * variance2,
        "mean_cos_alpha": math.sqrt(max(0.0, 0.5 * (1 - cosine**2))),
        "mean_sin_alpha": math.sqrt(max(0.0, 0.5 * (1 - sine**2))),
    }
