"""Densities as fields of py-pde and back: nothing is lost, misfits are refused."""

import numpy as np
import pde
import pytest

from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import from_pde_field, to_pde_field

FULL_TURN = (0.0, 2 * np.pi)


class TestFields:
    @pytest.mark.parametrize(
        "grid",
        [PhaseSpaceGrid((3.0, 2.5), (6, 7, 8)), PlaneGrid((3.0, 2.5), (6, 7))],
        ids=["phase space", "plane"],
    )
    def test_a_density_comes_back_bit_by_bit_with_its_grid(self, grid, rng):
        p = rng.normal(size=grid.shape)
        field = to_pde_field(p, grid, label="p")
        back, found = from_pde_field(field)
        np.testing.assert_array_equal(back, p)
        assert found == grid
        assert back.flags.c_contiguous
        assert not np.shares_memory(back, field.data)
        assert field.label == "p"

    def test_the_cells_are_the_same_in_both_packages(self, uneven_grid):
        field = to_pde_field(np.ones(uneven_grid.shape), uneven_grid)
        axes = uneven_grid.xi1, uneven_grid.xi2, uneven_grid.alpha
        for theirs, ours in zip(field.grid.axes_coords, axes, strict=True):
            # Both compute lower + (i + 1/2) Δ, in their own order of operations.
            np.testing.assert_allclose(theirs, ours, rtol=0, atol=4e-16 * 6)
        assert field.integral == pytest.approx(8 * 3.0 * 2.5 * np.pi, rel=1e-14)
        assert all(field.grid.periodic)

    def test_the_plane_is_closed(self):
        grid = PlaneGrid(2.0, (4, 4))
        assert not any(to_pde_field(np.ones(grid.shape), grid).grid.periodic)

    def test_a_density_of_another_shape_is_refused(self, uneven_grid):
        with pytest.raises(GridMismatchError, match=r"shape \(6, 7, 8\) of the grid"):
            to_pde_field(np.ones((6, 7)), uneven_grid)

    def test_another_grid_is_refused(self):
        grid = pde.UnitGrid([4, 4])
        with pytest.raises(TypeError, match=r"`grid` must be a PhaseSpaceGrid or a Pl"):
            to_pde_field(np.ones((4, 4)), grid)

    @pytest.mark.parametrize("kind", [pde.VectorField, pde.Tensor2Field])
    def test_fields_of_another_rank_are_refused(self, kind):
        with pytest.raises(TypeError, match=r"must be a pde.ScalarField, got \w+Field"):
            from_pde_field(kind(pde.UnitGrid([4, 4])))

    def test_complex_fields_are_refused(self):
        field = pde.ScalarField(pde.UnitGrid([4, 4]), 1j)
        with pytest.raises(
            TypeError, match=r"must be real, got complex; take its real"
        ):
            from_pde_field(field)

    def test_grids_that_are_not_cartesian_are_refused(self):
        field = pde.ScalarField(pde.PolarSymGrid(2.0, 8))
        with pytest.raises(TypeError, match=r"CartesianGrid, got PolarSymGrid; to_pde"):
            from_pde_field(field)

    @pytest.mark.parametrize(
        ("bounds", "periodic", "message"),
        [
            ([(-1, 1)], True, r"\(ξ₁, ξ₂\) or \(ξ₁, ξ₂, α\), got 1 of them"),
            ([(-1, 1), (-1, 1)], True, r"must be closed, .* pass periodic=False"),
            ([(-1, 1), (-1, 1), FULL_TURN], False, r"must be periodic along all of ξ₁"),
            (
                [(-1, 1), (-1, 1), FULL_TURN],
                [True, True, False],
                r"got periodic = \[True, True, False\]; pass periodic=True",
            ),
            ([(-1, 1), (0, 2)], False, r"centred, -L to L .*, got 0 to 2; shift its"),
            ([(-1, 1), (-1, 1), (0, 6)], True, r"over α from 0 to 2π, got 0 to 6; ang"),
            (
                [(-1, 1), (-1, 1), (-np.pi, np.pi)],
                True,
                r"over α from 0 to 2π, got -3.14159 to 3.14159",
            ),
        ],
    )
    def test_other_boxes_are_refused(self, bounds, periodic, message):
        grid = pde.CartesianGrid(bounds, 4, periodic=periodic)
        with pytest.raises(ValueError, match=message):
            from_pde_field(pde.ScalarField(grid))
