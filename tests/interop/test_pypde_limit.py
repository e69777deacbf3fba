"""The hydrodynamic limit by py-pde and by our finite volumes, which share no code."""

import numpy as np
import pde
import pytest
from orders import assert_order, measure_order

from fpsolve.errors import DomainTooSmallError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import HydrodynamicPDE, from_pde_field, to_pde_field
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, PowerPotential, QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit

MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))


def bump(xi1, xi2):
    return np.exp(-((xi1 - 0.8) ** 2) / 0.8 - (xi2 + 0.4) ** 2 / 0.6)


def start_on(grid):
    density = grid.evaluate(bump)
    return density / (density.sum() * grid.cell_area)


def by_py_pde(model, grid, s, **options):
    equation = HydrodynamicPDE(model)
    n_steps = int(np.ceil(s / equation.explicit_step(grid)))
    options = {"dt": s / n_steps, "solver": "runge-kutta", **options}
    field = to_pde_field(start_on(grid), grid)
    return equation.solve(field, s, backend="numpy", tracker=None, **options).data


@pytest.mark.parametrize(
    ("potential", "half_width", "ceiling"),
    [
        (QuadraticPotential(1.0, 0.8), 5.0, 8e-3),
        (PowerPotential(4, 1.0), 3.0, 8e-3),
    ],
    ids=["quadratic", "quartic"],
)
def test_both_converge_to_each_other_with_order_two(potential, half_width, ceiling):
    model = LayDownModel(potential, 2.0, MovingBelt(0.1))

    def difference(n):
        grid = PlaneGrid(half_width, (n, n))
        # Extrapolated: the steps in s are no part of the difference.
        ours = HydrodynamicLimit(model).solve(
            start_on(grid), (0.0, 2.0), 0.0625, grid=grid, method="sdirk2",
            extrapolate=True, boundary_tolerance=0.01,
        )  # fmt: skip
        theirs = by_py_pde(model, grid, 2.0)
        return float(np.abs(theirs - ours.densities[-1]).sum()) * grid.cell_area

    assert_order(measure_order(difference, 16), declared=2, ceiling=ceiling)


def test_both_agree_where_the_potential_has_a_kink():
    model = LayDownModel(LinearPotential(), 2.0, MovingBelt(0.05))
    grid = PlaneGrid(10.0, (64, 64))
    ours = HydrodynamicLimit(model).solve(
        start_on(grid), (0.0, 2.0), 0.0625, grid=grid, boundary_tolerance=0.1
    )
    theirs = by_py_pde(model, grid, 2.0)
    # Both of order two away from the kink, with cells of 0.31.
    assert np.abs(theirs - ours.densities[-1]).sum() * grid.cell_area < 2e-2


class TestFiniteVolumesAsSolver:
    GRID = PlaneGrid(5.0, (20, 18))

    def solve(self, **options):
        field = to_pde_field(start_on(self.GRID), self.GRID)
        options = {
            "t_range": 1.0, "dt": 0.125, "solver": "scharfetter-gummel",
            "tracker": None, **options,
        }  # fmt: skip
        equation = HydrodynamicPDE(MODEL)
        return equation.solve(field, **options), equation.diagnostics

    @pytest.mark.parametrize(
        "options",
        [{}, {"method": "sdirk2"}, {"method": "backward_euler"}],
        ids=["default", "sdirk2", "backward_euler"],
    )
    def test_the_run_equals_ours(self, options):
        storage = pde.MemoryStorage()
        _, info = self.solve(tracker=storage.tracker(0.5), **options)
        ours = HydrodynamicLimit(MODEL).solve(
            start_on(self.GRID), (0.0, 1.0), 0.125, grid=self.GRID,
            save_at=[0.0, 0.5, 1.0], **options,
        )  # fmt: skip
        assert storage.times == list(ours.saved_s)
        for stored, density in zip(storage, ours.densities, strict=True):
            values, grid = from_pde_field(stored)
            # Ours advances masses and takes the rounding of their sum out.
            np.testing.assert_allclose(values, density, rtol=1e-12, atol=1e-18)
            assert grid == self.GRID
        assert info["solver"]["steps"] == 8
        assert info["solver"]["options"] == {"method": ours.method}

    def test_no_step_is_too_long(self):
        final, _ = self.solve(t_range=200.0, dt=50.0, method="backward_euler")
        assert final.data.min() >= 0.0
        assert final.integral == pytest.approx(1.0, rel=1e-12)

    def test_other_equations_are_refused(self):
        field = to_pde_field(start_on(self.GRID), self.GRID)
        with pytest.raises(TypeError, match=r"a HydrodynamicPDE .*got Diffusio"):
            pde.DiffusionPDE().solve(field, 1.0, dt=0.1, solver="scharfetter-gummel")

    def test_phase_space_is_refused(self):
        grid = PhaseSpaceGrid(2.0, (4, 4, 4))
        field = to_pde_field(np.ones(grid.shape), grid)
        with pytest.raises(ValueError, match=r"PlaneGrid .*got those of a Phas"):
            HydrodynamicPDE(MODEL).solve(
                field, 1.0, dt=0.1, solver="scharfetter-gummel", tracker=None
            )

    def test_unknown_methods_are_refused(self):
        with pytest.raises(ValueError, match=r"`method` must be one of 'backward"):
            self.solve(method="euler")

    def test_the_step_has_no_default(self):
        with pytest.raises(
            ValueError, match=r"`dt` must be given .* compare with half"
        ):
            self.solve(dt=None)

    def test_a_box_too_small_stops_the_run(self):
        grid = PlaneGrid(1.0, (8, 8))
        field = to_pde_field(start_on(grid), grid)
        with pytest.raises(DomainTooSmallError, match="box of half width 1 is too"):
            HydrodynamicPDE(MODEL).solve(
                field, 1.0, dt=0.125, solver="scharfetter-gummel", tracker=None
            )
