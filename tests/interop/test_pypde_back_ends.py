"""The equations on the back ends of py-pde; compiling takes most of the time."""

import numpy as np
import pde
import pytest
from problems import asymmetric_start

from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import FokkerPlanckPDE, HydrodynamicPDE, to_pde_field
from fpsolve.model.curves import MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

BELT = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))


def bump(xi1, xi2):
    return np.exp(-((xi1 - 0.8) ** 2) - (xi2 + 0.4) ** 2)


@pytest.mark.nightly
def test_numba_computes_the_same_rate_of_the_full_equation(uneven_grid):
    equation = FokkerPlanckPDE(BELT)
    field = to_pde_field(asymmetric_start(uneven_grid, BELT.potential), uneven_grid)
    compiled = equation.make_pde_rhs(field, backend="numba")
    plain = equation.evolution_rate(field).data
    # A handful of roundings per cell, of terms as large as the largest.
    error = np.abs(compiled(field.data, 0.0) - plain).max()
    assert error <= 1e-14 * np.abs(plain).max()


@pytest.mark.nightly
def test_numba_solves_the_hydrodynamic_limit():
    grid = PlaneGrid(4.0, (8, 9))
    equation = HydrodynamicPDE(BELT)
    field = to_pde_field(grid.evaluate(bump), grid)
    options = {"t_range": 0.1, "dt": 0.01, "solver": "euler", "tracker": None}
    compiled = equation.solve(field, backend="numba", **options)
    plain = equation.solve(field, backend="numpy", **options)
    np.testing.assert_allclose(compiled.data, plain.data, rtol=1e-13, atol=1e-16)


def test_a_curve_of_varying_velocity_falls_back_to_numpy(uneven_grid):
    curve = RotatingNozzle(0.1, 0.5, 2.0)
    equation = FokkerPlanckPDE(LayDownModel(QuadraticPotential(), 1.0, curve))
    field = to_pde_field(np.ones(uneven_grid.shape), uneven_grid)
    assert equation.determine_backend(field, "auto").name == "numpy"
    with pytest.raises(NotImplementedError, match=r"'numpy' for a curve of varying"):
        equation.make_evolution_rate(field, pde.get_backend("numba"))


def test_other_back_ends_are_declined(uneven_grid):
    field = to_pde_field(np.ones(uneven_grid.shape), uneven_grid)
    with pytest.raises(NotImplementedError, match=r"'numpy' or 'numba', got 'scipy"):
        FokkerPlanckPDE(BELT).make_evolution_rate(field, pde.get_backend("scipy"))
