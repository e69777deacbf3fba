"""How long a run to equilibrium is, on which grid, and what it is compared with."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fpsolve.density.suggestions import suggest_step
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.constants.poincare import poincare_constant
from fpsolve.studies.suggested_grid import suggest_grid

__all__ = ["N_SAVED", "Plan", "plan_relaxation"]

# Saved densities, whose spacing is that of the modes.
N_SAVED = 32
# e^{−B} at the edge of the box relative to its largest, and for the comparison.
_EDGE, _COMPARED_EDGE = 2e-7, 1e-5
# Cells of the comparison are longer by this factor.
_COARSER = 4 / 3
# Largest A² ds: Strang splitting resolves the angular diffusion.
_TURN = 0.8
# Angles by the least noise they suit; the comparison has a quarter fewer.
_ANGLES = ((4.0, 16), (1.0, 24), (0.3, 32), (0.1, 64), (0.0, 128))


@dataclass(frozen=True)
class Plan:
    """Grid, step and length of a run to equilibrium, and the grid it is compared with.

    Attributes
    ----------
    grid, compared : PhaseSpaceGrid
    ds : float
    spacing : float
        Arclength between two saved densities.
    """

    grid: PhaseSpaceGrid
    compared: PhaseSpaceGrid
    ds: float
    spacing: float

    @property
    def s_end(self) -> float:
        """Arclength at the end of the run."""
        return N_SAVED * self.spacing


def plan_relaxation(
    model: LayDownModel, tolerance: float, e_folds: float, s_end: float | None = None
) -> Plan:
    """Plan a run in which H falls by about e^{−e_folds}.

    The rate expected for its length interpolates the asymptotes: 1/(2/A² + A²/Λ).

    Parameters
    ----------
    model : LayDownModel
    tolerance : float
        L1 error that cells and step aim at; see `suggest_grid`.
    e_folds : float
    s_end : float, optional
        Length of the run instead of the one expected.
    """
    suggested = suggest_grid(model, tolerance)
    cell = max(suggested.spacing[:2])
    angles = next(n for least, n in _ANGLES if model.noise >= least)
    grid = _grid(model.potential, cell, angles, _EDGE)
    compared = _grid(model.potential, cell * _COARSER, 3 * angles // 4, _COMPARED_EDGE)
    ds = min(float(suggest_step(model, grid, tolerance)), _TURN / model.noise**2)
    if s_end is None:
        poincare = poincare_constant(model.potential)
        expected = 1 / (2 / model.noise**2 + model.noise**2 / poincare)
        s_end = e_folds / (2 * expected)
    spacing = s_end / N_SAVED
    return Plan(grid, compared, spacing / math.ceil(spacing / ds), spacing)


def _grid(
    potential: Potential, cell: float, angles: int, edge: float
) -> PhaseSpaceGrid:
    """Cells of about that size in a box at whose edge e^{−B} is small."""
    half1, half2 = (_half_width(potential, axis, edge) for axis in (0, 1))
    n1, n2 = (4 * math.ceil(2 * half / (4 * cell)) for half in (half1, half2))
    return PhaseSpaceGrid((half1, half2), (n1, n2, 4 * math.ceil(angles / 4)))


def _half_width(potential: Potential, axis: int, edge: float) -> float:
    places = np.geomspace(1e-3, 1e4, 20_000)
    point = (places, 0.0) if axis == 0 else (0.0, places)
    with np.errstate(over="ignore"):
        value = potential.value(*point)
    lowest = min(float(value.min()), float(potential.value(0.0, 0.0)))
    # Beyond the last place inside: B may rise and fall again on the way.
    inside = np.flatnonzero(value - lowest <= -math.log(edge))
    if not (inside.size and inside[-1] + 1 < places.size):
        raise ValueError(
            f"`potential` must have its throwing range between {places[0]:g} and "
            f"{places[-1]:g}, got {potential!r}; scale it to one."
        )
    return round(float(places[inside[-1] + 1]), 3)
