"""Figures of paths show what their titles and axes say."""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.image import imread

import fpsolve as fp
from fpsolve import plotting
from fpsolve.plotting.style import COLOURS

NOISES = (0.0, 0.1, 1.0, 2.0, 5.0, 10.0)
START = ((1.5, 0.0), np.pi / 2)
GRID = fp.PhaseSpaceGrid((4.0, 5.0), (8, 10, 6))


def sampled(potential=None, noise=1.0, curve=None, n_paths=1, s_end=6.0, **options):
    model = fp.LayDownModel(
        fp.QuadraticPotential() if potential is None else potential,
        noise,
        fp.FixedBelt() if curve is None else curve,
    )
    chosen = {"seed": 11, "initial": START, **options}
    return fp.sample_paths(model, n_paths, s_end, 0.05, **chosen)


@pytest.fixture(scope="module")
def figure_4():
    return [sampled(noise=noise, s_end=20.0) for noise in NOISES]


@pytest.fixture(scope="module")
def ensemble():
    return sampled(
        curve=fp.MovingBelt(0.1),
        n_paths=200,
        save_at=np.arange(25) * 0.25,
        histogram=GRID,
    )


@pytest.fixture(scope="module")
def nozzles():
    curves = (
        fp.MovingBelt(0.1),
        fp.RotatingNozzle(0.1, 2.0, 0.5),
        fp.OscillatingNozzle(0.1, 2.0, 0.5),
    )
    return [sampled(curve=curve, s_end=40.0) for curve in curves]


def lines_of(axes, colour):
    return [line for line in axes.lines if line.get_color() == COLOURS[colour]]


def whole(figure):
    """Whether nothing is cut off at the border."""
    figure.canvas.draw()
    box = figure.get_tightbbox()
    return (
        min(box.x0, box.y0) >= 0
        and box.x1 <= figure.get_figwidth()
        and box.y1 <= figure.get_figheight()
    )


def test_figure_4_has_a_panel_for_every_noise_on_equal_axes(figure_4):
    figure = plotting.plot_trajectories(figure_4)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [f"$A = {noise:g}$" for noise in NOISES]
    limits = {(axes.get_xlim(), axes.get_ylim()) for axes in figure.axes}
    assert len(limits) == 1
    (low, high), vertical = limits.pop()
    assert (low, high) == vertical == (-high, high)
    assert all(axes.get_aspect() == 1 for axes in figure.axes)
    title = figure.get_suptitle()
    assert "length $20$" in title
    assert "95 %" in title
    # The noises are those of the panels.
    assert "A =" not in title


def test_every_step_of_a_path_is_drawn_from_its_start(figure_4):
    figure = plotting.plot_trajectories(figure_4)
    for axes, paths in zip(figure.axes, figure_4, strict=True):
        (path,) = lines_of(axes, "blue")
        np.testing.assert_array_equal(path.get_xydata(), paths.replay(0).xi)
        (dot,) = lines_of(axes, "black")
        np.testing.assert_array_equal(dot.get_xydata(), [[1.5, 0.0]])


def border_of(paths):
    """Vertices of the dashed line."""
    axes = plotting.plot_trajectories(paths).axes[0]
    (border,) = axes.collections
    assert border.get_linestyle()[0][1] is not None
    return border.get_paths()[0].vertices


def test_the_dashed_circle_holds_95_per_cent_of_the_standard_normal_law():
    radius = np.hypot(*border_of(sampled()).T)
    # P(|ξ| < r) = 1 - exp(-r²/2); 400 cells across 6.75 or more are 0.02 wide.
    np.testing.assert_allclose(radius, np.sqrt(-2 * np.log(0.05)), atol=0.02)


def test_the_dashed_line_is_an_ellipse_for_two_throwing_ranges():
    xi1, xi2 = border_of(sampled(fp.QuadraticPotential(1.0, 0.5))).T
    expected = np.sqrt(-2 * np.log(0.05))
    # A cell of 0.02 counts twice across the shorter range.
    np.testing.assert_allclose(np.hypot(xi1, xi2 / 0.5), expected, atol=0.04)


def test_the_dashed_circle_follows_the_potential():
    # P(|ξ| < r) = 1 - (1 + r) e^{-r} for B = |ξ|, 0.95 at r = 4.74386; the square
    # holds all but a thousandth and has cells of at most 0.09.
    radius = np.hypot(*border_of(sampled(fp.LinearPotential())).T)
    np.testing.assert_allclose(radius, 4.74386, atol=0.1)


def test_without_an_equilibrium_there_is_no_circle():
    figure = plotting.plot_trajectories(sampled(fp.FreePotential()))
    assert len(figure.axes[0].collections) == 0
    assert "95" not in figure.get_suptitle()


def test_another_path_of_an_ensemble_can_be_drawn(ensemble):
    fixed = sampled(n_paths=3)
    (path,) = lines_of(plotting.plot_trajectories(fixed, k=2).axes[0], "blue")
    np.testing.assert_array_equal(path.get_xydata(), fixed.replay(2).xi)
    with pytest.raises(ValueError, match=r"`k` must be below the number of paths 3"):
        plotting.plot_trajectories(fixed, k=3)


def test_panels_that_cannot_be_compared_are_refused():
    message = r"`paths` must have one potential and one curve in common, got several;"
    with pytest.raises(ValueError, match=message):
        plotting.plot_trajectories([sampled(), sampled(fp.LinearPotential())])
    with pytest.raises(ValueError, match=message):
        plotting.plot_trajectories([sampled(), sampled(curve=fp.MovingBelt(0.1))])
    for plot in (plotting.plot_trajectories, plotting.plot_nozzles):
        with pytest.raises(
            ValueError, match=r"must hold at least one ensemble to draw"
        ):
            plot([])


def test_a_fibre_lies_about_its_reference_curve(nozzles):
    paths = nozzles[1]
    (axes,) = plotting.plot_fibre(paths).axes
    trajectory = paths.replay(0)
    (fibre,), (curve,) = lines_of(axes, "blue"), lines_of(axes, "vermilion")
    np.testing.assert_array_equal(fibre.get_xydata(), trajectory.eta)
    position = np.stack(paths.model.curve.position(trajectory.s), axis=-1)
    np.testing.assert_array_equal(curve.get_xydata(), position)
    # η - γ = ξ, to the rounding of numbers up to ten.
    np.testing.assert_allclose(
        fibre.get_xydata() - curve.get_xydata(), trajectory.xi, atol=1e-14
    )
    assert axes.get_aspect() == 1
    assert (axes.get_xlabel(), axes.get_ylabel()) == (r"$\eta_1$", r"$\eta_2$")


def test_a_curve_that_is_one_point_is_drawn_as_one():
    (axes,) = plotting.plot_fibre(sampled()).axes
    (curve,) = lines_of(axes, "vermilion")
    assert curve.get_marker() == "."


def test_nozzles_are_named_and_share_their_scale(nozzles):
    figure = plotting.plot_nozzles(nozzles)
    names = [axes.get_title().partition(":")[0] for axes in figure.axes]
    assert names == ["transversal", "rotating", "oscillating"]
    assert len({axes.get_xlim() for axes in figure.axes}) == 1
    assert all(axes.get_aspect() == 1 for axes in figure.axes)
    for axes, paths in zip(figure.axes, nozzles, strict=True):
        (fibre,) = lines_of(axes, "blue")
        np.testing.assert_array_equal(fibre.get_xydata(), paths.replay(0).eta)
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 2


def test_an_ensemble_shows_its_histograms(ensemble):
    figure = plotting.plot_ensemble(ensemble)
    left, right, *_ = figure.axes
    histogram = ensemble.histogram()
    (image,) = left.images
    # One histogram summed over the angle in two ways, to rounding.
    np.testing.assert_allclose(
        image.get_array(), histogram.marginal("xi").T, rtol=1e-12, atol=0
    )
    band, steps = right.patches
    np.testing.assert_allclose(
        steps.get_data().values, histogram.marginal("alpha"), rtol=1e-12
    )
    share = histogram.counts.sum(axis=(0, 1)) / 200
    error = np.sqrt(share * (1 - share) / 200) / GRID.spacing[2]
    np.testing.assert_allclose(
        band.get_data().values - steps.get_data().values, error, rtol=1e-9
    )
    assert left.get_title() == "$s = 6$;  contours: $p_S$"
    assert figure.get_suptitle().endswith("$v = 0.1$;  200 paths")


def test_an_ensemble_can_be_shown_elsewhere(ensemble):
    left = plotting.plot_ensemble(ensemble, s=1.5).axes[0]
    assert left.get_title().startswith("$s = 1.5$")
    expected = ensemble.histogram(s=1.5).marginal("xi").T
    np.testing.assert_allclose(left.images[0].get_array(), expected, rtol=1e-12)
    with pytest.raises(ValueError, match=r"`s` must be one of the saved values"):
        plotting.plot_ensemble(ensemble, s=1.6)


def test_moments_are_drawn_with_bands_of_one_standard_error(ensemble):
    position = plotting.plot_ensemble(ensemble).axes[-3]
    value, error = ensemble.moments()["mean_xi1"]
    (mean,) = lines_of(position, "blue")
    np.testing.assert_array_equal(mean.get_ydata(), value)
    edges = position.collections[0].get_paths()[0].vertices[:, 1]
    assert edges.max() == pytest.approx((value + error).max(), rel=1e-12)
    assert edges.min() == pytest.approx((value - error).min(), rel=1e-12)


def test_positions_are_counted_in_a_box_that_holds_them_all():
    paths = sampled(n_paths=50, save_at=(3.0, 6.0))
    image = plotting.plot_ensemble(paths).axes[0].images[0]
    left, right, bottom, top = image.get_extent()
    cell = (right - left) * (top - bottom) / image.get_array().size
    assert image.get_array().sum() * cell == pytest.approx(1.0, rel=1e-12)


def test_without_positions_and_histogram_the_moments_are_left():
    figure = plotting.plot_ensemble(sampled(n_paths=50, keep=False))
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "position",
        "spread",
        "direction",
    ]
    # One point has neither line nor band: it has a bar.
    assert len(figure.axes[0].containers) == 2
    assert figure.axes[0].get_xlim() == (5.5, 6.5)


def test_at_one_arclength_the_histograms_are_left():
    figure = plotting.plot_ensemble(sampled(n_paths=50))
    assert "position" not in [axes.get_ylabel() for axes in figure.axes]


def test_a_single_path_has_no_errors_to_draw():
    # NaN is drawn as nothing, and nothing warns.
    plotting.plot_ensemble(sampled(save_at=(3.0, 6.0))).canvas.draw()


def test_the_figures_written_depend_on_what_is_there(ensemble, tmp_path, undrawn):
    def names(paths):
        return [path.name for path in plotting.save_figures(paths, tmp_path)]

    assert names(ensemble) == ["ensemble.png", "fibre.png"]
    assert names(sampled(n_paths=5)) == ["ensemble.png", "trajectory.png"]
    # The law of the start is known, so that a path can be run again.
    assert names(sampled(keep=False)) == ["ensemble.png", "trajectory.png"]
    unknown = replace(ensemble, ensemble=replace(ensemble.ensemble, model=None))
    assert names(unknown) == ["ensemble.png"]


def test_figures_are_whole_and_as_wide_as_a_column_or_a_page(
    figure_4, ensemble, nozzles
):
    figures = {
        plotting.plot_trajectories(figure_4): 7.0,
        plotting.plot_trajectories(figure_4[:2]): 7.0,
        plotting.plot_trajectories(figure_4[2]): 3.4,
        plotting.plot_fibre(nozzles[0]): 7.0,
        # Four units by four.
        plotting.plot_fibre(sampled(s_end=60.0)): 3.4,
        plotting.plot_nozzles(nozzles): 7.0,
        plotting.plot_ensemble(ensemble): 7.0,
    }
    for figure, width in figures.items():
        assert figure.get_figwidth() == width
        assert whole(figure)


def test_pictures_are_not_empty(ensemble, tmp_path):
    for path in plotting.save_figures(ensemble, tmp_path):
        pixels = imread(path)
        assert pixels.shape[1] in (680, 1400)
        assert 0.005 < np.mean(pixels[..., :3].min(axis=2) < 0.6) < 0.9


def test_the_style_of_the_user_is_left_alone(figure_4, ensemble):
    before = dict(mpl.rcParams)
    plotting.plot_trajectories(figure_4)
    plotting.plot_ensemble(ensemble)
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize("name", plotting.__all__)
def test_every_figure_is_reached_from_the_package(name):
    assert callable(getattr(plotting, name))


def test_unknown_figures_are_attribute_errors():
    with pytest.raises(AttributeError, match=r"has no attribute 'plot_knot'"):
        plotting.plot_knot  # noqa: B018


def test_figures_of_smooth_fibres_name_both_lengths_and_draw_no_equilibrium():
    models = [
        fp.SmoothLayDownModel(fp.QuadraticPotential(), r, 1.0) for r in (1e-4, 1.0)
    ]
    paths = [
        fp.sample_paths(model, 30, 2.0, 0.1, seed=1, save_at=(1.0, 2.0))
        for model in models
    ]
    figure = plotting.plot_trajectories(paths)
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == ["$A = 1$,  $R = 0.0001$", "$A = 1$,  $R = 1$"]
    assert "p_S" not in figure.get_suptitle()
    ensemble = plotting.plot_ensemble(paths[0])
    assert not any("p_S" in axes.get_title() for axes in ensemble.axes)
