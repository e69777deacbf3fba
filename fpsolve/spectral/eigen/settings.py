"""What is asked of a spectrum, checked, and what it is where nothing is asked."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fpsolve._support.checks import check_integer, check_positive, check_real, shown
from fpsolve._support.memory import allowed_memory
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.bases.placement import is_round
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.work import DEFAULT_WORK, Work

__all__ = [
    "FINEST",
    "accepted_for",
    "check_tolerance",
    "checked_sectors",
    "essential_of",
    "memory_of",
    "tolerance_for",
    "work_for",
]

# What a spectrum may use unless told otherwise: degrees up to about 500 of the
# quadratic potential, about a minute. Of a smooth fibre, with three coordinates, up to
# about 50.
DEFAULT_MEMORY, SMOOTH_MEMORY = 2**28, 2**31
# Of which a fibre with three coordinates takes more, and half the time for each.
SMOOTH_WORK = 2 * DEFAULT_WORK
# Errors relative to the rate that most models reach in seconds.
BASIC, SMOOTH = 1e-10, 1e-6
# The same on belts and about unequal throwing ranges, where indices are coupled.
COUPLED = 1e-4
# What will do for them where nothing is asked, when the work ends before.
LARGEST = 1e-3
# Rounding alone leaves about this, relative to the rate.
FINEST = 1e-13


def checked_sectors(sectors: Any) -> tuple[Sector, ...]:
    """The sectors as a tuple; TypeError unless it is a series of them."""
    known = list(sectors) if isinstance(sectors, Iterable) else []
    if not known or not all(isinstance(one, Sector) for one in known):
        raise TypeError(
            f"`sectors` must be a series of Sector, got {shown(sectors)}; leave it "
            "out to search in all of them."
        )
    return tuple(known)


def tolerance_for(model: FibreModel, tolerance: float | None) -> float:
    """The tolerance as a float, checked; where none is given what the basis reaches."""
    if tolerance is None:
        if not isinstance(model, SmoothLayDownModel):
            return BASIC
        return SMOOTH if is_round(model) else COUPLED
    return check_tolerance(tolerance)


def accepted_for(model: FibreModel, tolerance: float | None) -> float:
    """Error, relative to the rate, that is accepted when the work ends before."""
    best_effort = tolerance is None and isinstance(model, SmoothLayDownModel)
    return LARGEST if best_effort else 0.0


def check_tolerance(tolerance: float) -> float:
    """The tolerance as a float, checked."""
    tolerance = check_real("tolerance", tolerance)
    if not FINEST <= tolerance <= 0.1:
        raise ValueError(
            f"`tolerance` must lie in [{FINEST:g}, 0.1], got {tolerance:g}; double "
            "precision leaves no more digits."
        )
    return tolerance


def memory_of(limit: int | None, model: FibreModel) -> int:
    """Bytes for the largest basis."""
    if limit is None:
        smooth = isinstance(model, SmoothLayDownModel)
        default = SMOOTH_MEMORY if smooth else DEFAULT_MEMORY
        return min(default, int(allowed_memory()))
    return check_integer("memory_limit", limit, 1)


def work_for(model: FibreModel, limit: float | None) -> Work:
    """What a spectrum may cost."""
    if limit is None:
        smooth = isinstance(model, SmoothLayDownModel)
        return Work(SMOOTH_WORK if smooth else DEFAULT_WORK)
    return Work(check_positive("work_limit", limit))


def essential_of(model: FibreModel) -> float | None:
    """Right end of the essential spectrum, None without one."""
    if isinstance(model.potential, QuadraticPotential) or not model.potential.isotropic:
        return None
    from fpsolve.spectral.bases.essential import asymptotic_slope, essential_threshold

    return essential_threshold(asymptotic_slope(model.potential), model.noise)
