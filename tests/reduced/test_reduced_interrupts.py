"""Ctrl-C during a run of either limit leaves what was recorded until then."""

import numpy as np
import pytest

from fpsolve.errors import RunInterrupted
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit

POTENTIAL = QuadraticPotential()
PROCESS = EnergyProcess(POTENTIAL, 1.0)
LIMIT = HydrodynamicLimit(LayDownModel(POTENTIAL, 2.0, MovingBelt(0.1)))
SAVES = (0.0, 0.5, 1.0)


def energy(**options):
    grid = PROCESS.grid(20)
    return PROCESS.solve(0.3, (0.0, 1.0), 0.125, grid=grid, save_at=SAVES, **options)


def plane(**options):
    grid = PlaneGrid(5.0, (16, 16))
    start = LIMIT.equilibrium(*grid.mesh()) * (1.0 + 0.1 * grid.mesh()[0])
    return LIMIT.solve(start, (0.0, 1.0), 0.125, grid=grid, save_at=SAVES, **options)


def stopped_after(n):
    """A progress callback that interrupts once n steps are done."""

    def report(n_done, n_total, s):
        if n_done >= n:
            raise KeyboardInterrupt

    return report


@pytest.mark.parametrize("solve", [energy, plane])
def test_a_stopped_run_leaves_series_and_laws_so_far(solve):
    with pytest.raises(RunInterrupted) as caught:
        solve(progress=stopped_after(5))
    partial, complete = caught.value.solution, solve()
    np.testing.assert_array_equal(partial.s, complete.s[:6])
    np.testing.assert_array_equal(
        partial.relative_entropy, complete.relative_entropy[:6]
    )
    np.testing.assert_array_equal(partial.saved_s, [0.0, 0.5])
    np.testing.assert_array_equal(partial.density(0.5), complete.density(0.5))


@pytest.mark.parametrize("solve", [energy, plane])
def test_a_stop_in_the_second_run_of_an_extrapolation_leaves_the_first(solve):
    # The first run has 8 steps, the second 16.
    with pytest.raises(RunInterrupted) as caught:
        solve(extrapolate=True, progress=stopped_after(10))
    partial, plain = caught.value.solution, solve()
    assert partial.errors is None
    np.testing.assert_array_equal(partial.density(1.0), plain.density(1.0))
