"""A step from the measured error laws, with the reason in words."""

from __future__ import annotations

import math
from typing import Any

from fpsolve._support.checks import check_real
from fpsolve.density.error_laws import (
    INTERPOLATION_COEFFICIENT,
    feature_width,
    mean_square_force,
    splitting_coefficient,
    unit_of_length,
)  # fmt: skip
from fpsolve.grids.phase_space import check_grid
from fpsolve.grids.smooth import check_smooth_grid
from fpsolve.model.laydown import LayDownModel, check_model
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["SuggestedStep", "suggest_step"]

# Relaxation lengths below are not resolved: the density of (ξ, α) does not need it.
LEAST_RESOLVED = 0.1


class SuggestedStep(float):
    """A step ds that knows why: a float with a `reason`.

    Attributes
    ----------
    reason : str
        The error law, its numbers, and what else limits the step.
    """

    reason: str

    def __new__(cls, ds: float, reason: str) -> SuggestedStep:
        """Make a step with its reason."""
        step = super().__new__(cls, ds)
        step.reason = reason
        return step

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        return float(self), self.reason


def suggest_step(
    model: LayDownModel | SmoothLayDownModel, grid: Any, tolerance: float = 1e-2
) -> SuggestedStep:
    """Step ds with C ds² ≤ tolerance, C = 0.4 (1/ℓ² + κ) + 0.18 A²/ℓ, κ = ½ E|∇B|².

    ℓ is the size of the pattern, the power of four nearest the deviation of e^{−B}/Z:
    1 for deviations between 1/2 and 2 (remark 3.1: the law has no unit of its own).

    The law bounds the L1 error of one run of either scheme of order 2 (Strang) over a
    few ℓ of s; with `solve(..., extrapolate=True)` the same step gives a far
    smaller error and an estimate of it. Large noise is thereby resolved as well
    (ds ≤ 3/A²). The step is 1/m with an integer m, so that it divides whole spans.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel
        Of a smooth fibre also ds ≤ R/4, where R is at least 0.1: the law is that of the
        limit of small R.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
        Tells where the force is averaged, and whether the interpolation keeps up.
    tolerance : float
        L1 error to aim at.

    Returns
    -------
    SuggestedStep
        A float; `.reason` says why.
    """
    if isinstance(model, SmoothLayDownModel):
        return _smooth_step(model, grid, tolerance)
    check_model(model)
    check_grid(grid)
    check_tolerance(tolerance)
    mean_force = mean_square_force(model, grid)
    length = unit_of_length(model.potential)
    law = splitting_coefficient(model, mean_force, length)
    if not math.isfinite(law):
        raise ValueError(
            "`grid` must resolve exp(-B), got a mean square of the force beyond all "
            "numbers; take more cells, or a smaller `half_width`."
        )
    longest = min(1.0, length)
    finest = 3.0 / max(model.noise * model.noise, 1e-6)
    wanted = min(math.sqrt(tolerance / law), finest, longest)
    ds = 1.0 / math.ceil(1.0 / wanted)
    cell = max(grid.spacing[:2])
    steps = length / ds
    reach = INTERPOLATION_COEFFICIENT * (cell / feature_width(model)) ** 8 * steps
    reason = (
        f"the splitting error is at most {law:.2g} ds² (κ = {mean_force / 2:.2g}, "
        f"A = {model.noise:g}), so ds = {ds:.3g} keeps it below {tolerance:g}"
    )
    if reach > tolerance:
        reason += (
            f"; the cells of {cell:.3g} are too coarse for that: the interpolation "
            f"error is about {reach:.1g}, refine the grid"
        )
    return SuggestedStep(ds, reason + ".")


def _smooth_step(
    model: SmoothLayDownModel, grid: Any, tolerance: float
) -> SuggestedStep:
    """The step of the limit R → 0, a quarter of R where that is not many steps."""
    check_smooth_grid(grid)
    limit = suggest_step(model.white_noise_limit, grid.phase_space, tolerance)
    longest = model.relaxation_length / 4
    if model.relaxation_length < LEAST_RESOLVED or limit <= longest:
        return limit
    ds = 1.0 / math.ceil(1.0 / longest)
    return SuggestedStep(ds, f"a quarter of R resolves the curvature; {limit.reason}")


def check_tolerance(tolerance: float) -> None:
    """Raise unless 0 < tolerance < 1."""
    tolerance = check_real("tolerance", tolerance)
    if not 0 < tolerance < 1:
        raise ValueError(
            f"`tolerance` must lie between 0 and 1, got {tolerance:g}; it is an L1 "
            "error of a probability density."
        )
