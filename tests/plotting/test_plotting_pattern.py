"""Figures of periodic densities and of the patterns that they lay down."""

from dataclasses import replace

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import plotting
from fpsolve.web.pattern import MeanPattern


def waves(amplitude):
    values = np.array([[0.0, amplitude / 2, 0.0], [0.0, 1.0, 0.0],
                       [0.0, amplitude / 2, 0.0]], dtype=complex)  # fmt: skip
    return MeanPattern(2.0, 1.0, 1.0, 10.0, values, 0 * values.real, "in phase")


def test_patterns_are_drawn_two_by_two_on_one_scale():
    figure = plotting.plot_pattern(
        [waves(0.2), waves(0.6), waves(0.1)], 4.0, 2.0, ("one", "two", "three")
    )
    maps = [axes for axes in figure.axes if axes.images]
    assert [axes.get_title() for axes in maps] == ["one", "two", "three"]
    limits = {axes.images[0].get_clim() for axes in maps}
    # The highest wave is that of 1 + 0.6; the points of the map meet its crest.
    ((low, high),) = limits
    assert low == 0.0
    assert high == pytest.approx(1.6, abs=1e-3)
    drawn = maps[1].images[0].get_array()
    # Two periods along the belt, none across it.
    assert np.ptp(drawn, axis=0).max() < 1e-12
    assert np.argmax(np.abs(np.fft.rfft(drawn[0, :-1] - 1.0))) == 2


def test_one_pattern_needs_no_list_and_sizes_are_checked():
    assert len(plotting.plot_pattern(waves(0.2), 4.0, 2.0).axes) == 2
    # By default a square that holds two cells, or twenty of their shorter side.
    for pattern, side in ((waves(0.2), 4.0), (replace(waves(0.2), width=0.1), 2.0)):
        drawn = plotting.plot_pattern(pattern).axes[0]
        assert (drawn.get_xlim(), drawn.get_ylim()) == ((0.0, side), (0.0, side))
    with pytest.raises(ValueError, match="`length` must be positive"):
        plotting.plot_pattern(waves(0.2), np.nan, 2.0)
    with pytest.raises(TypeError, match="`patterns` must be a MeanPattern, got 3"):
        plotting.plot_pattern([3], 1.0, 2.0)


def test_a_periodic_density_is_shown_at_four_phases_with_its_means():
    model = fp.LayDownModel(
        fp.QuadraticPotential(), 1.5, fp.RotatingNozzle(0.2, 0.5, 1.0)
    )
    grid = fp.PhaseSpaceGrid(5.5, (24, 24, 12))
    state = fp.periodic_state(model, grid, n_phases=8, error_tolerance=0.5)
    figure = plotting.plot_periodic_state(state)
    maps = [axes for axes in figure.axes if axes.images]
    assert [axes.get_title() for axes in maps] == [
        f"$s = {state.s[j]:g}$" for j in (0, 2, 4, 6)
    ]
    lines = [line for axes in figure.axes for line in axes.lines if len(axes.lines) > 1]
    np.testing.assert_array_equal(
        lines[0].get_ydata(), state.moments()["mean_xi1"]
    )  # fmt: skip
    with pytest.raises(TypeError, match="it is what `periodic_state` returns"):
        plotting.plot_periodic_state(3)
