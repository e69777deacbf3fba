"""Repeat paths, path by path."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fpsolve.paths.ensemble import GivenStart
from fpsolve.paths.result import Paths
from fpsolve.paths.sampling import sample_paths
from fpsolve.results.rerun.costs import check_paths
from fpsolve.results.rerun.missing import own_code

__all__ = ["repeat_paths"]

NOTES = ("configuration",)


def repeat_paths(paths: Paths, overrides: dict[str, Any]) -> Paths:
    """Call `sample_paths` as it was called, or once for paths that went on."""
    given = dict(overrides)
    model = given.pop("model", paths.ensemble.model)
    if model is None:
        raise own_code("model", paths.provenance.get("model_description", ""))
    check_paths(paths, overrides)
    new = sample_paths(model, **{**_arguments(paths, "initial" in given), **given})
    if given.keys() - {"progress", "client"}:
        return new
    notes = {name: paths.provenance[name] for name in NOTES
             if name in paths.provenance}  # fmt: skip
    return replace(new, provenance={**new.provenance, **notes})


def _arguments(paths: Paths, has_start: bool) -> dict[str, Any]:
    """Arguments of `sample_paths` but the model."""
    ensemble, schedule = paths.ensemble, paths.ensemble.schedule
    # Of an interrupted sampling the result is smaller than what was asked for.
    asked = paths.provenance.get("asked", {})
    n_steps = asked.get("n_steps", schedule.n_steps)
    law: Any = ensemble.law
    if law is None and not has_start:
        description = paths.provenance.get("initial_description", {})
        raise own_code("initial", str(description.get("description", "")))
    return {
        "n_paths": asked.get("n_paths", ensemble.n_paths),
        "s_end": schedule.s(n_steps),
        "ds": schedule.ds,
        "seed": ensemble.seed,
        "initial": (law.xi, law.alpha) if isinstance(law, GivenStart) else law,
        "save_at": [schedule.s(k) for k in asked.get("saves", schedule.saves)],
        "s_start": schedule.start,
        "method": ensemble.method,
        "histogram": ensemble.grid,
        "keep": ensemble.keep,
    }
