"""Feet of the backward characteristics of (7) in (ξ, α)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.at_points import gradient_at

# Planes of constant ξ1 traced together: temporaries stay a small part of a density.
CELLS_PER_SLAB = 8192


@dataclass(frozen=True)
class Feet:
    """Where the characteristics through the cell centres started, a step earlier.

    Attributes
    ----------
    places : ndarray, shape (3, n1, n2, n_alpha)
        Feet in index units.
    growth : ndarray, shape (n1, n2, n_alpha) or (1, 1, 1)
        Factor the unknown collects on the way; a single one for none.
    ds : float
        Length of the step.
    """

    places: Array
    growth: Array
    ds: float


class Characteristics:
    """dξ = (τ(α) − γ′) ds, dα = −∇B·τ⊥ ds, traced backward by one Runge-Kutta step.

    Classical fourth order in ds, with the reference curve taken at its exact
    position. Along the way the logarithm of the unknown changes by the reaction
    term: w·∇B with w = −γ′ for h = e^{B} p, and −∇B·τ for p itself. Feet depend on s
    only when γ′ does; otherwise they are computed once, and never changed: threads
    may share them.

    Parameters
    ----------
    model : LayDownModel
    grid : PhaseSpaceGrid
    balanced : bool
        Reaction of h = e^{B} p, instead of p.

    Raises
    ------
    TypeError, ValueError
        If ∇B is no pair of finite numbers on the way to a foot.
    """

    def __init__(
        self, model: LayDownModel, grid: PhaseSpaceGrid, balanced: bool
    ) -> None:
        self.model, self.grid, self.balanced = model, grid, balanced
        self.reacts = not (balanced and model.curve.fixed)
        self._shared: Feet | None = None

    @property
    def n_arrays(self) -> float:
        """Densities held: three coordinates and the growth where there is one."""
        return 4.0 if self.reacts else 3.0

    def feet(self, s: float, ds: float, held: Feet | None = None) -> Feet:
        """Feet at s of the characteristics that arrive at the centres at s + ds.

        Parameters
        ----------
        s, ds : float
        held : Feet, optional
            Those of the step before in the same run. Where feet depend on s these
            arrays are written again; where they do not, they serve again.
        """
        if not self.model.curve.autonomous:
            return self._trace_all(s, ds, held)
        for known in (held, self._shared):
            if known is not None and known.ds == ds:
                return known
        # Its memory is given back, if nobody uses it, before as much is taken.
        self._shared = known = None
        self._shared = found = self._trace_all(0.0, ds, None)
        return found

    def _trace_all(self, s: float, ds: float, held: Feet | None) -> Feet:
        shape = self.grid.shape
        if held is None:
            growth = np.ones(shape if self.reacts else (1, 1, 1))
            feet = Feet(np.empty((3, *shape)), growth, ds)
        else:
            feet = replace(held, ds=ds)
        planes = max(1, CELLS_PER_SLAB // (shape[1] * shape[2]))
        for start in range(0, shape[0], planes):
            self._trace_slab(slice(start, min(start + planes, shape[0])), s, ds, feet)
        return feet

    def _trace_slab(self, slab: slice, s: float, ds: float, feet: Feet) -> None:
        xi1, xi2, alpha = self.grid.mesh()
        arrival = np.broadcast_arrays(xi1[slab], xi2, alpha)
        start1, start2, turned, growth = self._runge_kutta(arrival, s, ds)
        d1, d2, d_alpha = self.grid.spacing
        feet.places[0, slab] = (start1 - self.grid.xi1[0]) / d1
        feet.places[1, slab] = (start2 - self.grid.xi2[0]) / d2
        feet.places[2, slab] = (turned - self.grid.alpha[0]) / d_alpha
        if self.reacts:
            # Beyond all numbers the density is too, which ends the run.
            with np.errstate(over="ignore"):
                feet.growth[slab] = np.exp(growth)

    def _runge_kutta(
        self, arrival: tuple[Array, ...], s: float, ds: float
    ) -> tuple[Array, Array, Array, Array]:
        # The fibre point η = ξ + γ moves with τ alone, so γ enters through its
        # position only, never through a derivative.
        xi1, xi2, alpha = arrival
        stages = []
        offset: tuple[Array | float, ...] = (0.0, 0.0, 0.0)
        for back, weight in ((0.0, 0.5), (0.5, 0.5), (0.5, 1.0), (1.0, 0.0)):
            moved1, moved2 = self.model.curve.displacement(s + ds - back * ds, s + ds)
            rates = self._rates(
                xi1 - offset[0] + moved1, xi2 - offset[1] + moved2, alpha - offset[2],
                s + ds - back * ds,
            )  # fmt: skip
            stages.append(rates)
            offset = tuple(weight * ds * rate for rate in rates[:3])
        path1, path2, turn, growth = (
            ds / 6 * (a + 2 * b + 2 * c + d) for a, b, c, d in zip(*stages, strict=True)
        )
        moved1, moved2 = self.model.curve.displacement(s, s + ds)
        return xi1 - path1 + moved1, xi2 - path2 + moved2, alpha - turn, growth

    def _rates(
        self, xi1: Array, xi2: Array, alpha: Array, s: float
    ) -> tuple[Array, ...]:
        cosine, sine = np.cos(alpha), np.sin(alpha)
        force1, force2 = gradient_at(self.model.potential, xi1, xi2, "foot")
        turn = force1 * sine - force2 * cosine
        if self.balanced:
            speed1, speed2 = self.model.curve.velocity(s)
            reaction = -(speed1 * force1 + speed2 * force2)
        else:
            reaction = -(force1 * cosine + force2 * sine)
        return cosine, sine, turn, reaction
