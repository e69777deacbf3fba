"""A grid that says why it is as it is, and what grids for a tolerance share."""

from __future__ import annotations

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.nodes import gibbs_nodes
from fpsolve.model.potentials.potential import Potential

__all__ = ["SuggestedGrid", "box_half_widths", "check_normalisable", "share_outside"]

# Share of the tolerance spent on what the box cuts off; never so much that the
# boundary mass would stop a run at its default tolerance of 1e-3.
BOX_SHARE = 0.1
LARGEST_LOSS = 5e-5


class SuggestedGrid(PhaseSpaceGrid):
    """A grid that knows why: a PhaseSpaceGrid with a `reason`.

    Attributes
    ----------
    reason : str
        What set the box and each number of cells.
    """

    reason: str

    @classmethod
    def because(
        cls, half_width: tuple[float, float], shape: tuple[int, int, int], reason: str
    ) -> SuggestedGrid:
        """The grid with its reason."""
        grid = cls(half_width, shape)
        object.__setattr__(grid, "reason", reason)
        return grid


def share_outside(tolerance: float) -> float:
    """Share of e^{−B} that a box may cut off."""
    return min(BOX_SHARE * tolerance, LARGEST_LOSS)


def box_half_widths(potential: Potential, lost: float) -> tuple[float, float]:
    """Half widths outside which e^{−B} has the share `lost`, direction by direction."""
    return gibbs_nodes(potential).half_widths(lost)


def check_normalisable(model: FibreModel) -> None:
    """Raise unless e^{−B} has a mass that a box can hold."""
    if not model.potential.normalisable:
        raise ValueError(
            f"`potential` must confine, got {model.potential!r}; without a "
            "normalisable exp(-B) no box is large enough, choose one by hand."
        )
