"""A fibre on the belt is drawn with as much length as its title says."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.plotting.fibre_curve import MOST_POINTS

DS = 0.05


def straight(n_points):
    """A fibre along the first axis."""
    return np.stack([DS * np.arange(n_points), np.zeros(n_points)], axis=1)


@pytest.mark.parametrize(
    ("pieces", "title"),
    [
        ((201,), "length 10"),
        ((MOST_POINTS + 2001,), "length 200 of 300"),
        ((201, 401), "length 10 of 30"),
    ],
)
def test_title_says_the_length_that_is_drawn_and_that_of_all_fibres(pieces, title):
    curves = [straight(n_points) for n_points in pieces]
    fibre = fp.FibreCurve(curves if len(curves) > 1 else curves[0], DS)
    figure = fp.plotting.plot_fibre_curve(fibre)
    assert figure.axes[0].get_title() == title
    # Δs between n points is there n − 1 times; 199.95 is rounded to four digits.
    drawn = figure.axes[0].lines[0].get_xdata()
    assert np.ptp(drawn) == pytest.approx(float(title.split()[1]), abs=0.051)
