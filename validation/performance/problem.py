"""The benchmark problem: B = |ξ|²/2, noise A, v = 0, one off-centre start.

Everything here is independent of fpsolve, so that the peers and the reference share
the statement of the problem with our schemes and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import i0e

HALF_WIDTH = 6.0
MEAN = (1.5, 0.0)
VARIANCE = 0.25
ANGLE = np.pi / 2
CONCENTRATION = 4.0


class LeftOutError(Exception):
    """A solver that is not run on a grid; the message is the reason for the table."""


@dataclass(frozen=True)
class Problem:
    """Equation (9) for B = |ξ|²/2 at one noise, from `initial_density` to s_end.

    Attributes
    ----------
    noise, s_end : float
    """

    noise: float = 1.0
    s_end: float = 1.0

    @property
    def diffusivity(self) -> float:
        """A²/2."""
        return self.noise**2 / 2


def cell_centres(
    half_width: float, shape: tuple[int, int, int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates (xi1, xi2, alpha) of a cell-centred grid, three 1-D arrays."""
    n1, n2, n_alpha = shape
    xi1 = -half_width + (np.arange(n1) + 0.5) * (2 * half_width / n1)
    xi2 = -half_width + (np.arange(n2) + 0.5) * (2 * half_width / n2)
    return xi1, xi2, (np.arange(n_alpha) + 0.5) * (2 * np.pi / n_alpha)


def open_mesh(
    xi1: np.ndarray, xi2: np.ndarray, alpha: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give three 1-D coordinate arrays the shapes (n1,1,1), (1,n2,1), (1,1,n_alpha)."""
    return xi1[:, None, None], xi2[None, :, None], alpha[None, None, :]


def initial_density(xi1: np.ndarray, xi2: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """p0 = N(ξ; mean, variance) · exp(k cos(α − angle)) / (2π I₀(k)), broadcast.

    Normalised on R² x [0, 2π).
    """
    distance = (xi1 - MEAN[0]) ** 2 + (xi2 - MEAN[1]) ** 2
    plane = np.exp(-distance / (2 * VARIANCE)) / (2 * np.pi * VARIANCE)
    angular = np.exp(CONCENTRATION * (np.cos(alpha - ANGLE) - 1))
    return plane * angular / (2 * np.pi * i0e(CONCENTRATION))


def torque(xi1: np.ndarray, xi2: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """∇B·τ⊥ = ξ₂ cos α − ξ₁ sin α; the angle moves with minus this velocity."""
    return xi2 * np.cos(alpha) - xi1 * np.sin(alpha)


@dataclass(frozen=True)
class Result:
    """The density one solver produced at one s, and what it cost.

    Attributes
    ----------
    solver : str
        Name for the table.
    axes : tuple of ndarray
        Coordinates (xi1, xi2, alpha) at which `density` holds, uniformly spaced.
    density : ndarray, shape (n1, n2, n_alpha)
    step : str
        Step in s, as printed.
    cpu, wall : float
        Process CPU seconds (all threads) and elapsed seconds, from the first step to
        the last.
    setup : float
        Process CPU seconds before the first step: compilation, tables, factorisation.
    note : str
    told : float, optional
        What the solver says of its error.
    """

    solver: str
    axes: tuple[np.ndarray, np.ndarray, np.ndarray]
    density: np.ndarray
    step: str
    cpu: float
    wall: float
    setup: float = 0.0
    note: str = ""
    told: float | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each axis."""
        return self.density.shape

    @property
    def cell_volume(self) -> float:
        """Volume of one cell of the (uniform) grid."""
        return float(np.prod([axis[1] - axis[0] for axis in self.axes]))

    def l1_error(self, reference: np.ndarray) -> float:
        """Σ |p − p_ref| · cell volume on the solver's own grid."""
        return float(np.abs(self.density - reference).sum() * self.cell_volume)

    @property
    def mass(self) -> float:
        """Σ p · cell volume."""
        return float(self.density.sum() * self.cell_volume)
