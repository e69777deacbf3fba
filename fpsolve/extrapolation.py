"""Richardson extrapolation in ds of two runs, and the error estimates it gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve import diagnostics
from fpsolve.densities import CombinedDensities, LazyDensities
from fpsolve.solution import Solution

__all__ = ["extrapolated"]

# These are not approximations of anything that depends on ds: the coordinate, and
# what describes the finer run itself.
NOT_EXTRAPOLATED = (
    "s",
    "minimum",
    "negative_mass",
    "boundary_mass",
    "mass_correction",
    "theta",
)


def extrapolated(coarse: Solution, fine: Solution, order: int) -> Solution:
    """u = (2^q u_{ds/2} − u_{ds})/(2^q − 1), estimate |u_{ds/2} − u_{ds}|/(2^q − 1).

    Densities and every scalar series (entropy, dissipation, mass, moments) are
    extrapolated separately, scalars being those of the two runs, which are
    non-negative where the scheme is; an extrapolated density need not be. The
    estimate belongs to the finer run and bounds the error of the extrapolated values
    as long as the runs are in the asymptotic range and interpolation errors do not
    dominate.

    Parameters
    ----------
    coarse, fine : Solution
        The same stops with ds and ds/2.
    order : int
        Order q of the scheme in ds.
    """
    gain = 1.0 / (2**order - 1)
    series, errors = dict(fine.series), {}
    for name, values in fine.series.items():
        change = values - coarse.series[name]
        errors[name] = gain * np.abs(change)
        if name not in NOT_EXTRAPOLATED:
            series[name] = values + gain * change
    distances = [
        gain * diagnostics.l1_distance(p, q, fine.grid)
        for p, q in zip(fine.densities, coarse.densities, strict=True)
    ]
    errors["density_l1"] = np.array(distances)
    provenance = dict(fine.provenance)
    for name in ("wall_seconds", "cpu_seconds", "n_steps"):
        provenance[name] = fine.provenance[name] + coarse.provenance[name]
    provenance["extrapolated"] = True
    return replace(
        fine,
        ds=coarse.ds,
        densities=_combined(fine.densities, coarse.densities, gain),
        series=series,
        errors=errors,
        provenance=provenance,
    )


def _combined(fine: Any, coarse: Any, gain: float) -> Any:
    """(1 + g) p − g q in the memory of both, or when it is read."""
    if isinstance(fine, LazyDensities):
        return CombinedDensities(fine, coarse, gain)
    fine *= 1.0 + gain
    coarse *= gain
    fine -= coarse
    return fine
