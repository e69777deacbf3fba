"""How well the large-noise study resolves the full equation, part by part."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from fpsolve.model.persistence import Persistence
from fpsolve.model.potentials.potential import Potential
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.limits.large_noise_cases import resolution_for

__all__ = ["Settings", "options_of", "settings_of"]

# The stationary density keeps the bias of the splitting in ds: half the step.
_STATIONARY_TURN = 0.5


@dataclass(frozen=True)
class Settings:
    """How well the full equation is resolved.

    Attributes
    ----------
    cell : float
        Cell width over that of the features, half the deviation of e^{−B}.
    n_alpha : int
        Angles.
    turn : float
        A² ds.
    mean : float
        Tolerance of `spectral_steady_state` at a fixed speed.
    """

    cell: float = 0.4
    n_alpha: int = 16
    turn: float = 0.5
    mean: float = 1e-8


QUICK = Settings(cell=0.5, turn=0.8, mean=1e-6)
# A density with a curvature has a score of cells for every one without.
CURVED, CURVED_QUICK = Settings(cell=0.9), Settings(cell=1.1, n_alpha=12, turn=0.8)


def settings_of(quick: bool, bending: float) -> Settings:
    """How well the full equation is resolved."""
    if bending:
        return CURVED_QUICK if quick else CURVED
    return QUICK if quick else Settings()


def options_of(
    potential: Potential,
    pull: float,
    law: GaussianLaw,
    slow_length: float,
    speed: float,
    settings: Settings,
    bending: float,
) -> dict[str, dict[str, Any]]:
    """Arguments of every part besides potential and noise."""
    uniform = replace(law, angle=None, concentration=0.0)
    cells = settings.cell, settings.n_alpha, settings.turn
    factor = Persistence(1.0, 2 * bending).factor
    options: dict[str, dict[str, Any]] = {
        "gap": {}, "fixed_speed": {"speed": speed, "tolerance": settings.mean},
    }  # fmt: skip
    for place, w in (("belt", pull), ("rest", 0.0)):
        resolution = resolution_for(potential, w, law, *cells, factor)
        shared: dict[str, Any] = {"pull": w, "resolution": resolution}
        if bending:
            shared["bending"] = bending
        timed = {**shared, "slow_length": slow_length}
        options[f"{place}_directed"] = {**timed, "law": law}
        options[f"{place}_uniform"] = {**timed, "law": uniform}
        if w == pull:
            finer = replace(resolution, turn=_STATIONARY_TURN * resolution.turn)
            options["stationary"] = {**shared, "resolution": finer}
    return options
