"""The discrete phase space."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid

GRID = PhaseSpaceGrid(half_width=(3.0, 2.0), shape=(6, 7, 8))

grids = st.builds(
    PhaseSpaceGrid,
    half_width=st.floats(0.1, 50.0) | st.tuples(*[st.floats(0.1, 50.0)] * 2),
    shape=st.tuples(*[st.integers(4, 40)] * 3),
)


@given(grid=grids)
def test_cell_centres_are_the_formula_of_the_first_line(grid):
    (width1, width2), (step1, step2, step_alpha) = grid.half_widths, grid.spacing
    for centres, start, step, n in (
        (grid.xi1, -width1, step1, grid.shape[0]),
        (grid.xi2, -width2, step2, grid.shape[1]),
        (grid.alpha, 0.0, step_alpha, grid.shape[2]),
    ):
        assert centres.shape == (n,)
        # Rounding of start + (i + 1/2) step: a few eps of the half width.
        expected = [start + (i + 0.5) * step for i in range(n)]
        np.testing.assert_allclose(centres, expected, rtol=0, atol=1e-14 * (1 + -start))


@given(grid=grids)
def test_the_cells_fill_the_box(grid):
    width1, width2 = grid.half_widths
    area = 4 * width1 * width2
    n_plane = grid.shape[0] * grid.shape[1]
    # Products of a few factors: a few eps.
    assert grid.cell_area * n_plane == pytest.approx(area, rel=1e-14)
    assert grid.cell_volume * grid.n_cells == pytest.approx(
        2 * math.pi * area, rel=1e-14
    )


@given(grid=grids)
def test_centres_are_symmetric_about_the_origin_and_miss_it_when_even(grid):
    for centres, n in ((grid.xi1, grid.shape[0]), (grid.xi2, grid.shape[1])):
        # Rounding at the size of the half width, 50 at most.
        np.testing.assert_allclose(centres, -centres[::-1], rtol=0, atol=1e-13)
        if n % 2 == 0:
            assert np.min(np.abs(centres)) > 0.49 * (centres[1] - centres[0])


@given(grid=grids)
def test_a_dictionary_brings_the_grid_back_through_json(grid):
    copy = PhaseSpaceGrid.from_dict(json.loads(json.dumps(grid.to_dict())))
    assert copy == grid
    assert hash(copy) == hash(grid)


@given(grid=grids)
def test_repr_reads_as_the_constructor(grid):
    assert eval(repr(grid)) == grid


def test_equal_half_widths_make_equal_grids():
    assert PhaseSpaceGrid((6, 6), (8, 8, 8)) == PhaseSpaceGrid(6.0, [8, 8, 8])
    assert PhaseSpaceGrid(6.0, (8, 8, 8)) != PhaseSpaceGrid(6.0, (8, 8, 9))


def test_memory_of_a_density_is_that_of_its_array():
    assert GRID.n_cells == 6 * 7 * 8
    assert GRID.nbytes == np.zeros(GRID.shape).nbytes


def test_mesh_and_plane_broadcast_in_the_order_of_the_indices():
    assert [array.shape for array in GRID.mesh()] == [(6, 1, 1), (1, 7, 1), (1, 1, 8)]
    assert [array.shape for array in GRID.plane()] == [(6, 1), (1, 7)]
    xi1, xi2, alpha = (
        np.broadcast_to(array, GRID.shape)[3, 4, 5] for array in GRID.mesh()
    )
    assert (xi1, xi2, alpha) == (GRID.xi1[3], GRID.xi2[4], GRID.alpha[5])


def test_centres_cannot_be_written():
    for centres in (GRID.xi1, GRID.xi2, GRID.alpha):
        with pytest.raises(ValueError, match="read-only"):
            centres[0] = 0.0


def test_check_returns_the_array_itself_when_nothing_is_to_be_done():
    p = np.ones(GRID.shape)
    assert GRID.check(p) is p


def test_check_converts_layout_and_precision():
    for p in (
        np.ones(GRID.shape, dtype=np.float32),
        np.asfortranarray(np.ones(GRID.shape)),
    ):
        checked = GRID.check(p)
        assert checked.dtype == np.float64
        assert checked.flags.c_contiguous
        assert np.array_equal(checked, p)


def test_check_refuses_another_shape_and_another_kind():
    message = r"^`p0` must have the shape \(6, 7, 8\) of the grid, got \(8, 7, 6\)\.$"
    with pytest.raises(GridMismatchError, match=message) as caught:
        GRID.check(np.ones((8, 7, 6)), "p0")
    assert (caught.value.expected, caught.value.got) == ((6, 7, 8), (8, 7, 6))
    message = r"^`p` must hold floating-point numbers, got int64; convert it with"
    with pytest.raises(TypeError, match=message):
        GRID.check(np.ones(GRID.shape, dtype=np.int64))
    with pytest.raises(TypeError, match="got complex128"):
        GRID.check(np.ones(GRID.shape, dtype=complex))


def test_evaluate_samples_a_function_at_the_centres():
    values = GRID.evaluate(lambda xi1, xi2, alpha: xi1 + 10 * xi2 + 100 * alpha)
    assert values.shape == GRID.shape
    assert values.flags.c_contiguous
    assert values[2, 3, 4] == GRID.xi1[2] + 10 * GRID.xi2[3] + 100 * GRID.alpha[4]


def test_evaluate_broadcasts_and_gives_memory_of_its_own():
    values = GRID.evaluate(lambda xi1, xi2, alpha: xi1)
    values[0, 0, 0] = 7.0
    assert GRID.xi1[0] != 7.0
    assert values[0, 1, 0] == GRID.xi1[0]
    assert np.array_equal(GRID.evaluate(lambda *_: 1), np.ones(GRID.shape))


def test_evaluate_refuses_what_does_not_fit():
    with pytest.raises(GridMismatchError, match=r"`f` must have the shape .* \(5,\)"):
        GRID.evaluate(lambda *_: np.ones(5))
    with pytest.raises(TypeError, match="`f` must return real numbers, got complex128"):
        GRID.evaluate(lambda xi1, xi2, alpha: xi1 + 1j)


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, math.inf])
def test_half_widths_are_positive(wrong):
    message = f"^`half_width` must be positive and finite, got {wrong:g}.$"
    for half_width in (wrong, (1.0, wrong)):
        with pytest.raises(ValueError, match=message):
            PhaseSpaceGrid(half_width, (8, 8, 8))


def test_half_widths_are_one_number_or_two():
    with pytest.raises(ValueError, match="must be one number or two, got 3 of them"):
        PhaseSpaceGrid((1.0, 2.0, 3.0), (8, 8, 8))
    with pytest.raises(
        TypeError, match="`half_width` must be a real number, got 'six'"
    ):
        PhaseSpaceGrid("six", (8, 8, 8))


def test_neither_argument_has_a_default():
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        PhaseSpaceGrid(6.0)


def test_the_shape_is_three_integers():
    with pytest.raises(ValueError, match=r"`shape` must be three integers .* got 64"):
        PhaseSpaceGrid(6.0, 64)
    with pytest.raises(ValueError, match=r"`shape` must be three integers .* \(8, 8\)"):
        PhaseSpaceGrid(6.0, (8, 8))
    with pytest.raises(TypeError, match=r"\(n_xi2\)` must be an integer, got 8\.0"):
        PhaseSpaceGrid(6.0, (8, 8.0, 8))
    with pytest.raises(TypeError, match=r"\(n_alpha\)` must be an integer, got True"):
        PhaseSpaceGrid(6.0, (8, 8, True))
    message = r"^`shape\[0\] \(n_xi1\)` must be at least 4, got 3\.$"
    with pytest.raises(ValueError, match=message):
        PhaseSpaceGrid(6.0, (3, 8, 8))


def test_an_unknown_parameter_of_a_stored_grid_is_named():
    with pytest.raises(ValueError, match="`grid` must be half_width, shape, got width"):
        PhaseSpaceGrid.from_dict({"width": 6.0})
