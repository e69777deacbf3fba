"""The call of `sample_paths` that gives the paths of an ensemble."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve.evolution.call import KEPT, USER_CODE, Call, Kept, described
from fpsolve.paths.ensemble import Ensemble, GivenStart
from fpsolve.paths.law_dataset import FORMULAS
from fpsolve.paths.laws import DensityLaw

__all__ = ["call_of"]


def call_of(ensemble: Ensemble) -> Call:
    """Return the one call that gives them all, also those that went on from others."""
    schedule = ensemble.schedule
    return Call.of("sample_paths", {
        "model": ensemble.model,
        "n_paths": ensemble.n_paths,
        "s_end": schedule.end,
        "ds": schedule.ds,
        "seed": ensemble.seed,
        "initial": _described_law(ensemble.law),
        "save_at": [schedule.s(step) for step in schedule.saves],
        "s_start": schedule.start,
        "method": ensemble.method,
        "histogram": ensemble.grid,
        "keep": ensemble.keep,
    })  # fmt: skip


def _described_law(law: Any) -> Any:
    """The law of the start, with what the paths hold of it left to them."""
    if isinstance(law, GivenStart):
        return tuple(Kept(f"initial.{name}", one) for name, one in law.parts.items())
    if type(law) is DensityLaw:
        p = Kept("initial.p", np.asarray(law.p))
        return {"$density_law": {"grid": law.grid, "p": p}}
    if type(law) in FORMULAS:
        return law
    # None, where it could not be read back.
    code = {USER_CODE: ""} if law is None else described(law, "initial", {})
    return {**code, KEPT: "initial"}
