"""Small solutions, put together by hand where a run would be a detour."""

import numpy as np

from fpsolve import initial
from fpsolve.density.recorder import Recorder
from fpsolve.density.solution import Solution
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

RATE = 0.6
PROVENANCE = {
    "versions": {"python": "3.11.0", "fpsolve": "0.1.0", "numpy": "2.1.0"},
    "date": "2026-01-01T00:00:00+00:00",
    "wall_seconds": 1.5,
    "cpu_seconds": 1.25,
    "n_steps": 40,
}


def relaxing_solution(
    model=None,
    shape=(12, 14, 8),
    saved=(0.0, 1.0, 2.0, 5.0),
    errors=True,
    half_width=(5.0, 6.0),
    **changes,
):
    """p = e^{-λs} p0 + (1 - e^{-λs}) e^{-B}/Z: a density that forgets its start."""
    model = LayDownModel(QuadraticPotential(), noise=1.0) if model is None else model
    grid = PhaseSpaceGrid(half_width, shape)
    start = initial.gaussian(
        grid, (1.5, 0.0), variance=1.0, angle=np.pi / 2, concentration=2.0
    )
    end = initial.equilibrium(grid, model.potential)
    recorder, densities = Recorder(model, grid), []
    for s in np.linspace(0.0, 5.0, 41):
        share = np.exp(-RATE * s)
        p = share * start + (1 - share) * end
        recorder.record(p, s, {"mass_correction": 0.0})
        if s in saved:
            densities.append(p)
    series = recorder.series()
    parts = {
        "model": model,
        "grid": grid,
        "scheme": {"name": "drift_kick", "order": 2, "options": {"positive": False}},
        "ds": 0.125,
        "series": series,
        "saved_s": np.array(saved),
        "densities": np.array(densities).reshape(-1, *shape),
        "entropy_floor": recorder.floor(),
        "errors": estimates(series, len(saved)) if errors else None,
        "provenance": dict(PROVENANCE),
    }
    return Solution(**{**parts, **changes})


def estimates(series, n_saved):
    """Error estimates of one per cent, as `solve(..., extrapolate=True)` attaches."""
    per_series = {name: 0.01 * np.abs(values) for name, values in series.items()}
    return {**per_series, "density_l1": np.full(n_saved, 1e-4)}
