"""Pieces of fibre on a raster: exact clipping, conservation to the last count."""

from itertools import pairwise

import numpy as np
import pytest

from fpsolve._kernels import raster as kernels
from fpsolve._kernels.raster import UNIT


def laid(corners, shape, periodic=False, first_column=0):
    """Counts of the pieces between corners (along, across), and counts outside."""
    image = np.zeros((*shape, kernels.N_COUNTED), np.int64)
    raster = kernels.Raster(1.0, 0.0, first_column, periodic)
    outside = [
        kernels.lay_piece(tuple(start), tuple(end), raster, image)
        for start, end in pairwise(corners)
    ]
    return image, sum(outside)


def test_a_piece_within_a_pixel_is_counted_there_as_a_whole():
    image, outside = laid([(1.25, 0.5), (1.75, 0.75)], (2, 3))
    assert outside == 0
    assert image[0, 1, 0] == UNIT == image[..., 0].sum()
    # The direction is (2, 1)/√5: exact to the rounding of half a count.
    assert image[0, 1, 1] == round(0.8 * UNIT)
    assert image[0, 1, 2] == round(0.4 * UNIT)


@pytest.mark.parametrize("turned", [False, True])
def test_a_straight_fibre_is_cut_where_it_leaves_a_pixel(turned):
    # From (0.5, 0.25) to (3.5, 1.75) it meets the lines x = 1, 2, 3 at the shares 1/6,
    # 1/2, 5/6 and y = 1 at 1/2, in the corner (2, 1).
    ends = [(0.5, 0.25), (3.5, 1.75)]
    image, outside = laid(ends[::-1] if turned else ends, (2, 4))
    expected = np.array([[1 / 6, 1 / 3, 0, 0], [0, 0, 1 / 3, 1 / 6]])
    # Cuts are rounded to a count: half a count at both ends of a part.
    np.testing.assert_allclose(image[..., 0] / UNIT, expected, rtol=0, atol=1 / UNIT)
    assert image[..., 0].sum() == UNIT
    assert outside == 0


def test_a_fibre_along_an_edge_belongs_to_the_pixel_above_it():
    image, _ = laid([(0.0, 1.0), (2.0, 1.0)], (2, 2))
    np.testing.assert_array_equal(image[..., 0], [[0, 0], [UNIT // 2, UNIT // 2]])
    np.testing.assert_array_equal(image[1, :, 1], UNIT // 2)


def test_what_is_outside_of_the_window_is_counted_as_such():
    image, outside = laid([(-1.0, 0.5), (3.0, 0.5)], (1, 2))
    np.testing.assert_array_equal(image[0, :, 0], UNIT // 4)
    assert outside == UNIT // 2
    _, outside = laid([(-3.0, 5.5), (-1.0, 0.5)], (1, 2))
    assert outside == UNIT


def test_a_periodic_web_continues_on_its_other_side():
    image, outside = laid([(0.5, -0.5), (0.5, 2.5)], (2, 1), periodic=True)
    # A unit over three pixels: half in each of the outer ones, which are rows 1 and 0.
    assert outside == 0
    np.testing.assert_allclose(image[:, 0, 0] / UNIT, [0.5, 0.5], atol=1 / UNIT)


def test_a_window_that_begins_later_holds_the_same_counts():
    rng = np.random.default_rng(5)
    corners = rng.uniform(0, 6, (40, 2))
    whole, _ = laid(corners, (6, 6))
    part, outside = laid(corners, (6, 2), first_column=3)
    np.testing.assert_array_equal(part, whole[:, 3:5])
    assert outside + part[..., 0].sum() == 39 * UNIT


def test_no_count_is_lost_or_made_however_a_fibre_runs():
    rng = np.random.default_rng(1)
    corners = rng.uniform(-3, 12, (3000, 2))
    # Corners of pixels, and lines along their edges, are the worst of them.
    corners[::3] = np.rint(corners[::3])
    corners[::7, 0] = corners[1::7, 0][: corners[::7].shape[0]]
    image, outside = laid(corners, (9, 8))
    assert image[..., 0].sum() + outside == 2999 * UNIT
    # τ₁τ₁ is between nothing and all, |τ₁τ₂| at most half (and half a count a part).
    length, first, mixed = np.moveaxis(image, -1, 0)
    assert (first >= 0).all()
    assert (first <= length).all()
    assert (abs(mixed) <= length // 2 + 3000).all()


def test_the_raster_agrees_with_sorted_cuts():
    from straight_fibres import raster as oracle

    rng = np.random.default_rng(3)
    starts, angles = rng.uniform(0, 8, (200, 2)), rng.uniform(0, 2 * np.pi, 200)
    lengths = rng.uniform(0.01, 9, 200)
    expected = oracle(starts, angles, lengths, (8, 8))
    found = np.zeros((8, 8))
    for start, angle, length in zip(starts, angles, lengths, strict=True):
        end = start[::-1] + length * np.array([np.cos(angle), np.sin(angle)])
        image, _ = laid([start[::-1], end], (8, 8))
        found += image[..., 0] * (length / UNIT)
    # Counts are rounded by half at each end of a part: 9/2³⁶ for a part, and up to
    # twenty parts in a pixel.
    np.testing.assert_allclose(found, expected, rtol=0, atol=20 * 9 / UNIT)
