"""Grids of phase space as JSON-able dictionaries, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

__all__ = ["grid_from_dict"]


def grid_from_dict(parameters: Mapping[str, Any]) -> Any:
    """Return the grid that `to_dict` described; ValueError for other names."""
    if "kappa_half_width" in parameters:
        return SmoothPhaseSpaceGrid.from_dict(parameters)
    return PhaseSpaceGrid.from_dict(parameters)
