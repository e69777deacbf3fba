"""Fibres in front of a flow: what is drawn where, and what is refused."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.fibre import AirFlow

CURVES = [np.array([[0.0, 0.1, 1.0], [0.2, 0.3, 0.5], [0.0, 0.2, 0.0]])] * 2


def rising(r, t):
    """|u| = 2 + z + t, with a part that is aside of the plane."""
    found = np.zeros_like(r)
    found[:, 1] = 2 + r[:, 2] + t
    return found


def test_fibres_are_white_before_the_speed_of_the_air():
    figure = fp.plotting.plot_fibres_in_flow(CURVES, AirFlow(rising), t=3.0)
    axes = figure.axes[0]
    assert [line.get_color() for line in axes.lines] == ["white", "white"]
    seen = 100 * CURVES[0][:, [0, 2]]
    np.testing.assert_array_equal(axes.lines[0].get_xydata(), seen)
    speed = np.asarray(axes.collections[0].get_array())
    # From a twentieth of the height below the fibres to one above them.
    assert speed.min() == pytest.approx(5 - 0.05)
    assert speed.max() == pytest.approx(5 + 1.05)
    assert (np.diff(speed.reshape(160, 160), axis=0) > 0).all()


@pytest.mark.parametrize(
    ("fibres", "air", "error", "message"),
    [
        ([], AirFlow(rising), ValueError, "`fibres` must not be empty"),
        ([[0.0, 1.0, 2.0]], AirFlow(rising), ValueError, r"shape \(n, 3\), got \(3,"),
        ([CURVES[0] * np.nan], AirFlow(rising), ValueError, "`fibres` must"),
        (CURVES, rising, TypeError, "`air` must be"),
    ],
)
def test_what_is_no_fibre_in_a_flow_is_refused(fibres, air, error, message):
    with pytest.raises(error, match=message):
        fp.plotting.plot_fibres_in_flow(fibres, air)
