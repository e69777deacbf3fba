"""∂ₛ𝒫 = ∇·(εF∇ + ε∇B − v e₁)𝒫: potential, drift, equilibrium and generator."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid, plane_of
from fpsolve.model.fibre import FibreModel
from fpsolve.reduced.hydrodynamic.effective_potential import check_limit
from fpsolve.reduced.hydrodynamic.scharfetter_gummel import generator

__all__ = ["LimitEquation"]


class LimitEquation:
    """∂ₛ𝒫 = εF ∇·(∇𝒫 + 𝒫∇Φ), Φ = (B − v ξ1/ε)/F, ε = 1/A²; see `HydrodynamicLimit`.

    Parameters
    ----------
    model : LayDownModel or SmoothLayDownModel

    Attributes
    ----------
    model : LayDownModel or SmoothLayDownModel
    epsilon : float
    diffusivity : float
        εF.
    """

    def __init__(self, model: FibreModel) -> None:
        self._phi = check_limit(model)
        self.model = model
        self.epsilon = 1.0 / model.noise**2
        self.diffusivity = self.epsilon * self._phi.temperature

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.model!r})"

    def effective_potential(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """Φ = (B − v ξ1/ε)/F, in the broadcast shape of the arguments."""
        return self._phi.value(xi1, xi2)

    def drift(self, xi1: ArrayLike, xi2: ArrayLike) -> tuple[Array, Array]:
        """−ε∇B + v e₁, two arrays in the broadcast shape."""
        slope1, slope2 = self._phi.gradient(xi1, xi2)
        return -self.diffusivity * slope1, -self.diffusivity * slope2

    def equilibrium(self, xi1: ArrayLike, xi2: ArrayLike) -> Array:
        """𝒫_S = c exp(−(B − v ξ1/ε)/F), normalised on the plane.

        On a moving belt it depends on the noise.
        """
        return self._phi.density(xi1, xi2)

    def generator(self, grid: PlaneGrid | PhaseSpaceGrid) -> Any:
        """Q of dm/ds = Q m for cell masses m, a sparse (n1 n2, n1 n2) array.

        See `scharfetter_gummel.generator` for what is exact.
        """
        plane = plane_of(grid)
        return generator(self._phi.on(plane), plane.spacing, self.diffusivity)
