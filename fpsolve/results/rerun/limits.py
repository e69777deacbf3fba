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
    process = _process(solution, given)
    check_run(solution, run, overrides)
    grid = process.grid(solution.grid.n_cells, solution.grid.signed)
    found: EnergySolution = process.solve(start, **{"grid": grid, **run, **given})
    return found


def _process(solution: EnergySolution, given: dict[str, Any]) -> Any:
    """The process of the run, of another potential or noise if these are given."""
    from fpsolve.reduced.energy.process import EnergyProcess

    known = solution.process
    described = solution.provenance.get("process_description", {})
    noise = given.pop("noise", described.get("noise") if known is None else known.noise)
    if "potential" not in given and known is None:
        raise own_code("potential", described.get("formula", ""))
    return EnergyProcess(
        given.pop("potential", getattr(known, "potential", None)), noise
    )
