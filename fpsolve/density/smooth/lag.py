"""What an extrapolated run of a smooth fibre says of its own errors."""

from __future__ import annotations

import math
from typing import Any

from fpsolve.density.error_laws import mean_square_force
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["allowance", "curvature_lag"]

# Between these shares of R an error in ds is no power of it: the curvature begins, or
# has ceased, to be resolved.
RESOLVED, SLAVED, BETWEEN = 0.25, 20.0, 4.0
# Shares of the leading terms that the palindrome misses of κ where ds is not short
# against R, measured for B = |ξ|²/2, A = 1 and 3, 1e-3 ≤ R ≤ 1.
IN_DENSITY, IN_MEAN, IN_SQUARE = 0.1, 0.1, 0.1


def allowance(model: SmoothLayDownModel, ds: float, gain: float) -> float:
    """Estimated error over the difference of two runs: the gain of the order, or four.

    Four covers what was measured where a step is about as long as R.
    """
    share = ds / model.relaxation_length
    return BETWEEN if RESOLVED < share < SLAVED else gain


def curvature_lag(model: SmoothLayDownModel, grid: Any, ds: float) -> dict[str, float]:
    """What two runs with steps that are not short against R miss alike.

    The density of (ξ, α) is of order two at every R, but that of κ given both is
    right up to a share R F, F the force, where κ forgets itself within a step. Of E κ²
    that is A²/2 times the mean of ∂F/∂α.
    """
    square = mean_square_force(model, grid)
    length = model.relaxation_length
    # Below, it falls like ds², and the combination of the runs is rid of it.
    share = min(1.0, (ds / (2.0 * length)) ** 2) * (ds > RESOLVED * length)
    force = math.sqrt(square)
    return {
        "density_l1": IN_DENSITY * share * length * force,
        "mean_kappa": IN_MEAN * share * length * square,
        "mean_kappa2": IN_SQUARE * share * 0.5 * model.noise**2 * force,
    }
