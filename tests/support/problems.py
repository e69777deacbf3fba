"""Problems with a known answer, as objects: initial density, density(s) or moments.

Formulas are those of the basic model: τ = (cos α, sin α), τ⊥ = (−sin α, cos α),
D = A²/2. None of them needs a run of the solver.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from fpsolve import initial
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import FixedBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential


@dataclass(frozen=True)
class DecayingCirculation:
    """p = p_S [1 + q e^{−A²s/2} G], G = e^{−B} (ξ₁ sin α − ξ₂ cos α), B isotropic.

    L G = −(A²/2) G for every isotropic B: an exact solution of (9). Exercises
    translation, rotation and diffusion together; G alone is constant along
    characteristics. `share` is q relative to the largest value that keeps p ≥ 0,
    1/max(r e^{−B}), which is e^{B(1)} where B′(1) = 1.
    """

    potential: object
    noise: float
    grid: PhaseSpaceGrid
    share: float = 0.9

    @property
    def model(self):
        return LayDownModel(self.potential, self.noise)

    def invariant(self):
        """G on the grid."""
        xi1, xi2, alpha = self.grid.mesh()
        weight = np.exp(-self.potential.value(xi1, xi2))
        return weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))

    def largest_invariant(self):
        """max r e^{−B(r)}."""
        radial = self.potential.radial_value
        found = minimize_scalar(
            lambda r: float(radial(r)) - np.log(r), bounds=(1e-3, 20), method="bounded"
        )
        return float(np.exp(-found.fun))

    def density(self, s):
        amplitude = self.share / self.largest_invariant()
        decay = np.exp(-self.model.diffusivity * s)
        equilibrium = self.model.equilibrium(*self.grid.plane())[:, :, None]
        return equilibrium * (1.0 + amplitude * decay * self.invariant())

    def initial(self):
        return self.density(0.0)


@dataclass(frozen=True)
class Equilibrium:
    """p_S = e^{−B}/(2πZ), restricted to the box: stays for ever on a fixed belt."""

    model: LayDownModel
    grid: PhaseSpaceGrid

    def density(self, s):
        return initial.equilibrium(self.grid, self.model.potential)

    def initial(self):
        return self.density(0.0)


@dataclass(frozen=True)
class PersistentRandomWalk:
    """B = 0: E cos(α_s − α_0) = e^{−Ds}, E|ξ_s − ξ_0|² = (2/D)(s − (1 − e^{−Ds})/D).

    From a Gaussian in ξ, centred and independent of a von Mises angle, so that
    E|ξ_s|² = E|ξ_0|² + E|ξ_s − ξ_0|². Exercises translation and diffusion.
    """

    noise: float
    grid: PhaseSpaceGrid
    variance: float = 0.25
    angle: float = 0.6
    concentration: float = 3.0

    @property
    def model(self):
        return LayDownModel(FreePotential(), self.noise)

    def initial(self):
        return initial.gaussian(
            self.grid, (0.0, 0.0), self.variance, self.angle, self.concentration
        )

    def direction(self, s, start):
        """(E cos α, E sin α) at s from their values at 0."""
        return np.asarray(start) * np.exp(-self.model.diffusivity * s)

    def mean(self, s, start):
        """E ξ at s from (E cos α, E sin α) at 0."""
        diffusivity = self.model.diffusivity
        return np.asarray(start) * -np.expm1(-diffusivity * s) / diffusivity

    def mean_square(self, s):
        """E|ξ_s − ξ_0|²."""
        diffusivity = self.model.diffusivity
        lag = -np.expm1(-diffusivity * s) / diffusivity
        return 2.0 / diffusivity * (s - lag)


@dataclass(frozen=True)
class TracedCharacteristics:
    """A = 0: p is carried along orbits; on a fixed belt p e^{B} is constant on them.

    The density at a point is found by integrating the orbit through it backwards with
    an eighth-order Runge-Kutta method to a tolerance of 1e-11, by scipy: nothing of
    the solver is used. `start` is p0 as a function of (ξ₁, ξ₂, α).
    """

    potential: object
    grid: PhaseSpaceGrid
    start: object
    curve: object = field(default_factory=FixedBelt)

    @property
    def model(self):
        return LayDownModel(self.potential, 0.0, self.curve)

    def initial(self):
        return self.grid.evaluate(self.start)

    def density(self, s, every=1):
        """Values at all angles, in one of `every` cells along ξ₁ and along ξ₂."""
        cells = np.broadcast_arrays(*self.grid.mesh())
        arrival = [part[::every, ::every] for part in cells]
        shape = arrival[0].shape
        growth = np.zeros(arrival[0].size)
        unknowns = np.concatenate([*(part.ravel() for part in arrival), growth])
        traced = solve_ivp(
            self._backwards(s), (0.0, s), unknowns, "DOP853", rtol=1e-11, atol=1e-11
        )
        xi1, xi2, alpha, growth = traced.y[:, -1].reshape(4, *shape)
        return self.start(xi1, xi2, alpha) * np.exp(growth)

    def _backwards(self, end):
        def rates(back, unknowns):
            xi1, xi2, alpha, _ = unknowns.reshape(4, -1)
            drift = self.model.drift(xi1, xi2, alpha, end - back)
            slope1, slope2 = self.potential.gradient(xi1, xi2)
            # The divergence of the drift is ∂_α(−∇B·τ⊥) = ∇B·τ.
            growth = -(slope1 * np.cos(alpha) + slope2 * np.sin(alpha))
            steps = [-np.broadcast_to(rate, xi1.shape) for rate in drift]
            return np.concatenate([*steps, growth])

        return rates


@dataclass(frozen=True)
class FreeStreaming:
    """B = 0, A = 0: p(ξ, α, s) = p0(ξ − τ(α) s + γ(s) − γ(0), α), for any curve.

    Exercises the translation alone. A Gaussian in ξ, modulated in α.
    """

    grid: PhaseSpaceGrid
    variance: float = 0.5
    curve: object = field(default_factory=FixedBelt)

    @property
    def model(self):
        return LayDownModel(FreePotential(), 0.0, self.curve)

    def density(self, s):
        xi1, xi2, alpha = self.grid.mesh()
        moved1, moved2 = self.curve.displacement(0.0, s)
        start1 = xi1 - np.cos(alpha) * s + moved1
        start2 = xi2 - np.sin(alpha) * s + moved2
        square = (start1**2 + start2**2) / self.variance
        angular = (1.0 + 0.5 * np.cos(alpha - 1.0)) / (2 * np.pi)
        return np.exp(-square / 2) / (2 * np.pi * self.variance) * angular

    def initial(self):
        return self.density(0.0)


@dataclass(frozen=True)
class AngularHeat:
    """Mode m of the angle decays as e^{−m²Ds} at fixed ξ. Exercises the diffusion."""

    noise: float
    grid: PhaseSpaceGrid
    mode: int = 2

    @property
    def model(self):
        return LayDownModel(FreePotential(), self.noise)

    def density(self, s):
        xi1, xi2, alpha = self.grid.mesh()
        decay = np.exp(-(self.mode**2) * self.model.diffusivity * s)
        wave = 1.0 + 0.8 * decay * np.cos(self.mode * alpha - 0.4)
        return np.exp(-(xi1**2 + 2 * xi2**2)) * wave

    def initial(self):
        return self.density(0.0)


@dataclass(frozen=True)
class FrozenRotation:
    """Fixed ξ, A = 0: tan((α − φ)/2) grows by e^{|∇B|s}, ∇B = |∇B|(cos φ, sin φ).

    Exercises the rotation alone. The density is carried by that flow with its
    Jacobian: p(α) = p0(β)/[cosh g + cos(α − φ) sinh g], g = |∇B| s, β the foot.
    `start` is p0 as a function of α.
    """

    potential: object
    grid: PhaseSpaceGrid
    start: object

    @property
    def model(self):
        return LayDownModel(self.potential, 0.0)

    def foot(self, s):
        """The angle from which the flow arrives, and dβ/dα there."""
        xi1, xi2, alpha = self.grid.mesh()
        slope1, slope2 = self.potential.gradient(xi1, xi2)
        strength, direction = np.hypot(slope1, slope2) * s, np.arctan2(slope2, slope1)
        half = (alpha - direction) / 2
        # tan(β/2) = e^{−g} tan(α/2), written without the pole of the tangent.
        foot = 2 * np.arctan2(np.exp(-strength) * np.sin(half), np.cos(half))
        spread = np.cosh(strength) + np.cos(alpha - direction) * np.sinh(strength)
        return foot + direction, 1.0 / spread

    def density(self, s):
        foot, jacobian = self.foot(s)
        return self.start(foot) * jacobian

    def observable(self, s):
        """The same start as a function carried along, without the Jacobian."""
        return self.start(self.foot(s)[0])

    def initial(self):
        alpha = self.grid.mesh()[2]
        return np.ascontiguousarray(np.broadcast_to(self.start(alpha), self.grid.shape))


def asymmetric_start(grid, potential):
    """p0 ∝ e^{−B} h with a smooth h ≥ 0.3 that shares no symmetry with the problem."""

    def density(xi1, xi2, alpha):
        bump = np.exp(-((xi1 - 0.5) ** 2 + (xi2 + 0.3) ** 2) / 3.0)
        swirl = np.exp(-(xi1**2 + xi2**2) / 4.0)
        ratio = 1.0 + 0.4 * bump * np.cos(alpha - 0.7) + 0.3 * swirl * np.sin(2 * alpha)
        return np.exp(-potential.value(xi1, xi2)) * ratio

    return initial.from_function(grid, density)
