"""The cells of the ξ plane."""

import json
import math

import numpy as np
import pytest

from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid

GRID = PlaneGrid(half_width=(3.0, 2.0), shape=(6, 7))


def test_the_cells_are_those_of_the_phase_space_grid():
    grid = PhaseSpaceGrid((3.0, 2.0), (6, 7, 8))
    plane = PlaneGrid.of(grid)
    assert plane == GRID
    np.testing.assert_array_equal(plane.xi1, grid.xi1)
    np.testing.assert_array_equal(plane.xi2, grid.xi2)
    assert plane.cell_area == grid.cell_area


def test_centres_are_the_formula_of_the_first_line_and_fill_the_box():
    expected = [-3.0 + (i + 0.5) * 1.0 for i in range(6)]
    np.testing.assert_allclose(GRID.xi1, expected, rtol=0, atol=1e-15)
    assert GRID.spacing == (1.0, 4 / 7)
    # A product of a few factors.
    assert GRID.cell_area * GRID.n_cells == pytest.approx(24.0, rel=1e-14)
    assert GRID.n_cells == 42
    assert GRID.nbytes == 8 * 42
    assert [axis.shape for axis in GRID.mesh()] == [(6, 1), (1, 7)]
    with pytest.raises(ValueError, match="read-only"):
        GRID.xi1[0] = 0.0


def test_equal_numbers_make_equal_grids_and_json_brings_them_back():
    assert PlaneGrid((2.0, 2.0), (4, 4)) == PlaneGrid(2, [4, 4])
    assert hash(PlaneGrid((2.0, 2.0), (4, 4))) == hash(PlaneGrid(2, (4, 4)))
    assert PlaneGrid.from_dict(json.loads(json.dumps(GRID.to_dict()))) == GRID
    with pytest.raises(ValueError, match="parameters of `grid` must be half_width"):
        PlaneGrid.from_dict({"half_width": 2.0, "cells": (4, 4)})


def test_a_refined_grid_fills_the_same_box_with_twice_the_cells():
    assert GRID.refined() == PlaneGrid((3.0, 2.0), (12, 14))


def test_arrays_are_checked_and_functions_evaluated_on_the_cells():
    values = GRID.evaluate(lambda xi1, xi2: xi1 + 10 * xi2)
    assert values[2, 3] == GRID.xi1[2] + 10 * GRID.xi2[3]
    assert GRID.check(values) is values
    assert GRID.check(values.astype(np.float32)).dtype == np.float64
    with pytest.raises(GridMismatchError, match=r"`P` must have the shape \(6, 7\) of"):
        GRID.check(values.T, "P")
    with pytest.raises(TypeError, match="`p` must hold floating-point numbers"):
        GRID.check(np.ones((6, 7), dtype=int))
    with pytest.raises(TypeError, match="`f` must return real numbers, got complex128"):
        GRID.evaluate(lambda xi1, xi2: xi1 * 1j)
    with pytest.raises(GridMismatchError, match=r"`f` must have the shape \(6, 7\)"):
        GRID.evaluate(lambda xi1, xi2: np.ones(3))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, (4, 4)), "`half_width` must be positive and finite, got 0"),
        ((math.nan, (4, 4)), "`half_width` must be positive and finite, got nan"),
        (((1.0, 2.0, 3.0), (4, 4)), "`half_width` must be one number or two, got 3"),
        ((1.0, (4, 4, 4)), r"`shape` must be two integers \(n_xi1, n_xi2\), got"),
        ((1.0, (1, 4)), r"`shape\[0\] \(n_xi1\)` must be at least 2, got 1"),
    ],
)
def test_arguments_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        PlaneGrid(*arguments)


def test_a_number_of_cells_must_be_an_integer():
    with pytest.raises(TypeError, match=r"`shape\[1\] \(n_xi2\)` must be an integer"):
        PlaneGrid(1.0, (4, 4.5))
