"""What cells below zero, and their like above, do to entropies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.solution import Solution
from fpsolve.density.unresolved import cells_error
from fpsolve.model.potentials.at_points import value_at

__all__ = ["add_cells"]

# −ln of the least p_S under the logarithm.
_DEEPEST = 690.0


def add_cells(solution: Solution, runs: Sequence[Solution]) -> Solution:
    """Add to errors what the cells leave: to those of densities and of entropies.

    Of densities it is `unresolved`.

    H and its dissipation are those of max(p, 0). A trigonometric interpolant leaves
    errors e of both signs in cells where p vanishes, with ∫ max(−e, 0) = δ, the
    `negative_mass`, and as much above. There they count with H, at most
    δ (1 + max(B − min B)) where p_S is smallest, and with the dissipation
    2A² ∫ (∂_α √e)², at most 16 A² δ/dα², both signs together. Piecewise
    interpolation falls with p and leaves nothing there to speak of.

    Parameters
    ----------
    solution : Solution
    runs : sequence of Solution
        What was combined. Their errors in ξ and α, and so their δ, are nearly the
        same; the largest counts.
    """
    if solution.scheme["options"].get("translation") != "fourier":
        return solution
    errors: dict[str, Array] = dict(solution.errors or {})
    model: Any = solution.model
    mass = np.max([one.series["negative_mass"] for one in runs], axis=0)
    depth = np.ptp(value_at(model.potential, *solution.grid.plane()))
    more = {
        "relative_entropy": 2.0 * (1.0 + min(float(depth), _DEEPEST)) * mass,
        "entropy_dissipation": 16.0
        * (model.noise / solution.grid.spacing[2]) ** 2
        * mass,
    }
    more["density_l1"] = cells_error(solution)
    for name, values in more.items():
        errors[name] = errors[name] + values
    return replace(solution, errors=errors)
