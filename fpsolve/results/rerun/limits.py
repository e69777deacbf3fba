"""Repeat a run of one of the two limits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fpsolve.results.rerun.costs import check_run
from fpsolve.results.rerun.missing import own_code, unrecorded

if TYPE_CHECKING:
    from fpsolve.reduced.energy.solution import EnergySolution
    from fpsolve.reduced.hydrodynamic.solution import HydrodynamicSolution

__all__ = ["repeat_energy", "repeat_hydrodynamic"]


def repeat_hydrodynamic(
    solution: HydrodynamicSolution, overrides: dict[str, Any]
) -> HydrodynamicSolution:
    """Call `HydrodynamicLimit.solve` as it was called, with the overrides."""
    from fpsolve.reduced.hydrodynamic.limit import HydrodynamicLimit

    given, run = dict(overrides), solution.provenance.get("run")
    known = None if solution.limit is None else solution.limit.model
    model = given.pop("model", known)
    if model is None:
        raise own_code("model", solution.provenance.get("model_description", ""))
    start = given.pop("P0", solution.initial_density)
    if run is None or start is None:
        raise unrecorded("how the run began", "`HydrodynamicLimit.solve`")
    check_run(solution, run, overrides)
    again = {"grid": solution.grid, **run, **given}
    return HydrodynamicLimit(model).solve(start, **again)


def repeat_energy(
    solution: EnergySolution, overrides: dict[str, Any]
) -> EnergySolution:
    """Call `EnergyProcess.solve` as it was called, with the overrides."""
    given, run = dict(overrides), solution.provenance.get("run")
    start = given.pop("start", solution.initial_masses)
    if run is None or start is None:
        raise unrecorded("how the run began", "`EnergyProcess.solve`")
    check_run(solution, run, overrides)
    found: EnergySolution = solution.process.solve(
        start, **{"grid": solution.grid, **run, **given}
    )
    return found
