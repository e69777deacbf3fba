"""The measured error laws: what step, cells and angles cost in accuracy."""

from __future__ import annotations

import math

import numpy as np

from fpsolve.grids.smooth import AnyGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at, value_at
from fpsolve.model.potentials.nodes import GibbsNodes, gibbs_nodes
from fpsolve.model.potentials.potential import Potential

__all__ = [
    "INTERPOLATION_COEFFICIENT", "KINK_COEFFICIENT", "angles_for", "feature_width",
    "feature_width_of", "mean_square_force", "slope_at_origin",
    "splitting_coefficient", "unit_of_length", "unit_of_nodes",
]  # fmt: skip

# Upper bounds of ‖p − p_exact‖₁ ≤ C ds², C = 0.4 (1/ℓ² + κ) + 0.18 A²/ℓ, over s ≤ 3ℓ
# and 0.3 ≤ A√ℓ ≤ 10; measured by validation/error_laws.py for patterns of ℓ = 1.
FORCE_COEFFICIENT = 0.4
NOISE_COEFFICIENT = 0.18
# ‖error‖₁ ≤ 0.06 (Δξ/w)⁸ / ds of eight-point interpolation, for a density whose
# narrowest feature has standard deviation w.
INTERPOLATION_COEFFICIENT = 0.06
# ‖error‖₁ ≤ 0.2 (K Δξ)² where |∇B| jumps at the origin to K, as for B = K|ξ|: the
# kink lowers the order of every scheme to two there.
KINK_COEFFICIENT = 0.2
# A start half as wide as the equilibrium, as in the examples; with little noise the
# density filaments and features become narrower, by A^0.35 at s = 3.
FEATURE = 0.5
FILAMENTS = 0.35
LEAST_NOISE = 0.05
# A deviation this many times the width of one well is that of several.
WELLS = 1 / 0.6


def splitting_coefficient(
    model: LayDownModel, mean_force: float, length: float = 1.0
) -> float:
    """C of the splitting error C ds², for a pattern of the given size."""
    spread = NOISE_COEFFICIENT * model.noise * model.noise / length
    return FORCE_COEFFICIENT * (1 / length**2 + mean_force / 2) + spread


def unit_of_length(potential: Potential) -> float:
    """ℓ of the error laws: 1 for a potential that has no pattern."""
    return unit_of_nodes(gibbs_nodes(potential)) if potential.normalisable else 1.0


def unit_of_nodes(nodes: GibbsNodes) -> float:
    """The power of four nearest the smaller deviation, so that scaling is exact."""
    deviation = min(nodes.deviations())
    return 4.0 ** round(math.log(deviation, 4.0)) if deviation > 0 else 1.0


def mean_square_force(model: FibreModel, grid: AnyGrid) -> float:
    """∫ |∇B|² e^{−B} dξ / ∫ e^{−B} dξ on the grid."""
    xi1, xi2 = grid.plane()
    potential = value_at(model.potential, xi1, xi2)
    force1, force2 = gradient_at(model.potential, xi1, xi2)
    weight = np.exp(potential.min() - potential)
    with np.errstate(over="ignore"):
        # A square that overflows counts only where there is weight.
        squared = np.where(weight > 0, force1**2 + force2**2, 0.0)
        return float((weight * squared).sum() / weight.sum())


def feature_width(model: LayDownModel) -> float:
    """Half the smaller standard deviation of e^{−B}, less where noise is small."""
    if not model.potential.normalisable:
        return FEATURE * narrowing(model.noise)
    nodes = gibbs_nodes(model.potential)
    return feature_width_of(nodes, model.noise * math.sqrt(unit_of_nodes(nodes)))


def feature_width_of(nodes: GibbsNodes, noise: float) -> float:
    """The same; of one well where there are several, of the wall where it is steep.

    The noise is A√ℓ, without dimension.
    """
    widths = [
        deviation if deviation < WELLS / math.sqrt(force) else 1 / math.sqrt(force)
        for deviation, force in zip(
            nodes.deviations(), nodes.mean_square_forces(), strict=True
        )
    ]
    return FEATURE * narrowing(noise) * min(widths)


def narrowing(noise: float) -> float:
    """What little noise makes of the width of a feature."""
    return min(1.0, math.pow(max(noise, LEAST_NOISE), FILAMENTS))


def slope_at_origin(potential: Potential, length: float) -> float:
    """|∇B| just off the origin of an isotropic potential, zero if B is smooth there.

    `length` is the size of the pattern, on which B changes by about one.
    """
    if not potential.isotropic:
        return 0.0
    slope = float(np.hypot(*potential.gradient(1e-6 * length, 0.0)))
    return slope if slope * length > 1e-3 else 0.0


def angles_for(noise: float) -> int:
    """Angles whose error stays below that of the interpolation.

    Measured for B = |ξ|²/2 by validation/error_laws.py: 24 angles leave 3e-7 at
    A = 1, 48 leave 5e-5 at A = 0.3; below, the density filaments in α as in ξ.
    """
    return 32 if noise >= 1 else 64 if noise >= 0.3 else 128
