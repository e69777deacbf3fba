"""Repeat a run of the full equation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fpsolve.density.schemes.dictionaries import scheme_from_dict
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.density.solution import Solution
from fpsolve.density.solve import solve
from fpsolve.errors import NotRepeatableError
from fpsolve.results.rerun.costs import check_run
from fpsolve.results.rerun.missing import own_code, unrecorded

__all__ = ["repeat_solution"]

# What a command line adds to the provenance.
NOTES = ("configuration", "suggested")
_SCHEME = ("model", "grid", "scheme")


def repeat_solution(solution: Solution, overrides: dict[str, Any]) -> Solution:
    """Call `solve` as it was called, with the overrides."""
    given = dict(overrides)
    parts = {name: given.pop(name) for name in _SCHEME if name in given}
    run = solution.provenance.get("run")
    p0 = given.pop("p0", solution.initial_density)
    if run is None or p0 is None:
        raise unrecorded("how the run began", "`fpsolve.solve`")
    check_run(solution, run, overrides)
    if run.get("observe") and "observe" not in given:
        raise own_code("observe", ", ".join(run["observe"]))
    arguments = {**run, "reference": solution.reference, **given}
    new = solve(_scheme(solution, parts), p0, **arguments)
    if overrides.keys() - {"progress", "model"}:
        return new
    notes = {name: solution.provenance[name] for name in NOTES
             if name in solution.provenance}  # fmt: skip
    return replace(new, provenance={**new.provenance, **notes})


def _scheme(solution: Solution, given: dict[str, Any]) -> Scheme:
    """The scheme of the run, on another model or grid if these are given."""
    if "scheme" in given:
        scheme: Scheme = given["scheme"]
        return scheme
    model = given.get("model", solution.model)
    if model is None:
        description = solution.provenance.get("model_description", "")
        raise own_code("model", description)
    try:
        return scheme_from_dict(
            solution.scheme, model, given.get("grid", solution.grid)
        )
    except (KeyError, ValueError) as error:
        raise NotRepeatableError(
            f"the scheme could not be made again: {error} Pass it as "
            "`fpsolve.rerun(file, scheme=...)`."
        ) from None
