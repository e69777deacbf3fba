"""Richardson extrapolation in ds of two runs, and the error estimates it gives."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from fpsolve.density.negative_cells import add_cells
from fpsolve.density.smooth.lag import allowance, curvature_lag
from fpsolve.density.solution import Solution
from fpsolve.evolution.richardson import extrapolated_series, gain_of
from fpsolve.evolution.series import is_extrapolated
from fpsolve.evolution.stored import CombinedDensities, LazyDensities
from fpsolve.grids import diagnostics
from fpsolve.model.smooth import SmoothLayDownModel

__all__ = ["WINDOW", "extrapolated", "resolved"]


# Beyond these the angle forgets its direction, or the nozzle turns, within a step: the
# expansion in ds does not hold, and neither does the gain of an order.
LARGEST_DIFFUSION, LARGEST_TURN = 5.0, 3.0
# Half width of the window of an estimate, relative to that of the box: a quarter turn
# of a fibre, for a box of four to eight throwing ranges, lasts longer.
WINDOW = 1 / 6


def extrapolated(coarse: Solution, fine: Solution, order: int) -> Solution:
    """u = (2^q u_{ds/2} − u_{ds})/(2^q − 1), estimate |u_{ds/2} − u_{ds}|/(2^q − 1).

    Densities and every scalar series (entropy, dissipation, mass, moments) are
    extrapolated separately, scalars being those of the two runs, which are
    non-negative where the scheme is; an extrapolated density need not be. The
    estimate belongs to the finer run and bounds the error of the extrapolated values
    as long as the runs are in the asymptotic range and interpolation errors do not
    dominate. Where the difference of a scalar changes its sign it says nothing: the
    estimate is the largest within a sixth of the half width of the box, but at the
    start, which both runs share. Out of the
    asymptotic range (A² ds > 5, or a nozzle that turns by more than 3 rad in ds) it is
    the whole difference, which covers from order one on, and a warning says so. For a
    smooth fibre see `curvature_lag`.

    Parameters
    ----------
    coarse, fine : Solution
        The same stops with ds and ds/2.
    order : int
        Order q of the scheme in ds.
    """
    gain = gain_of(order)
    allowed = gain if resolved(coarse) else 1.0
    lag: dict[str, float] = {}
    model: Any = coarse.model
    if isinstance(model, SmoothLayDownModel):
        allowed = max(allowed, allowance(model, coarse.ds, gain))
        lag = curvature_lag(model, coarse.grid, coarse.ds)
    reach = WINDOW * min(fine.grid.half_widths)
    series, errors = extrapolated_series(
        fine.series, coarse.series, gain, reach, allowed, is_extrapolated
    )
    distances = [
        min(allowed, 1.0) * diagnostics.l1_distance(p, q, fine.grid)
        for p, q in zip(fine.densities, coarse.densities, strict=True)
    ]
    errors["density_l1"] = np.array(distances)
    for name, more in lag.items():
        where = fine.saved_s if name == "density_l1" else fine.s
        errors[name] = errors[name] + more * (where > fine.s[0])
    provenance = dict(fine.provenance)
    for name in ("wall_seconds", "cpu_seconds", "n_steps"):
        provenance[name] = fine.provenance[name] + coarse.provenance[name]
    provenance["extrapolated"] = True
    found = replace(
        fine,
        ds=coarse.ds,
        densities=_combined(fine.densities, coarse.densities, gain),
        series=series,
        errors=errors,
        provenance=provenance,
    )
    return add_cells(found, (coarse, fine))


def resolved(coarse: Solution) -> bool:
    """Whether errors are a power of ds; a warning tells if not."""
    model, ds = coarse.model, coarse.ds
    if model is None:
        return True
    turn = abs(getattr(model.curve, "angular_speed", 0.0)) * ds
    diffusion = model.noise**2 * ds
    if diffusion <= LARGEST_DIFFUSION and turn <= LARGEST_TURN:
        return True
    longest = ds / max(diffusion / LARGEST_DIFFUSION, turn / LARGEST_TURN)
    warnings.warn(
        f"`ds` = {ds:g} is long: A² ds = {diffusion:.3g} (at most "
        f"{LARGEST_DIFFUSION:g}) and the nozzle turns by {turn:.3g} (at most "
        f"{LARGEST_TURN:g}); errors of the extrapolated run may exceed their "
        f"estimates; take ds below {longest:.3g}",
        UserWarning,
        stacklevel=5,
    )
    return False


def _combined(fine: Any, coarse: Any, gain: float) -> Any:
    """(1 + g) p − g q in the memory of both, or when it is read."""
    if isinstance(fine, LazyDensities):
        return CombinedDensities(fine, coarse, gain)
    fine *= 1.0 + gain
    coarse *= gain
    fine -= coarse
    return fine
