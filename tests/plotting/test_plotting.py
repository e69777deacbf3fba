"""Figures show what their titles and axes say, and reach the disk whole."""

from dataclasses import replace

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.mathtext import MathTextParser
from PIL import Image
from solutions import relaxing_solution

from fpsolve import plotting
from fpsolve.model.curves import MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential, QuadraticPotential
from fpsolve.plotting import maps, style
from fpsolve.plotting.entropy import fitted_rate


@pytest.fixture(scope="module")
def solution():
    return relaxing_solution()


@pytest.fixture(scope="module")
def belt_solution():
    return relaxing_solution(
        LayDownModel(QuadraticPotential(1.0, 2.0), 0.7, MovingBelt(0.1))
    )


@pytest.fixture(scope="module")
def free_solution():
    return relaxing_solution(LayDownModel(FreePotential(), noise=1.0), errors=False)


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def title(figure):
    return figure.get_suptitle()


def test_maps_show_the_chosen_densities_on_one_scale(solution):
    figure = plotting.plot_marginals(solution, at=(0.0, 5.0))
    first, last, bar = figure.axes
    assert [axes.get_title() for axes in (first, last)] == ["$s = 0$", "$s = 5$"]
    np.testing.assert_array_equal(
        last.images[0].get_array(), solution.marginal("xi", 5.0).T
    )
    limits = {axes.images[0].get_clim() for axes in (first, last)}
    assert limits == {(0.0, solution.marginal("xi", 0.0).max())}
    assert bar.get_ylabel() == r"$\int p\;\mathrm{d}\alpha$"
    assert first.get_xlabel() == r"$\xi_1$"
    assert first.get_ylabel() == r"$\xi_2$"


def test_maps_are_at_most_eight(solution):
    many = relaxing_solution(saved=tuple(np.arange(0.0, 5.1, 0.25)), errors=False)
    figure = plotting.plot_marginals(many)
    titles = [axes.get_title() for axes in figure.axes if axes.images]
    assert len(titles) == 8
    assert titles[0] == "$s = 0$"
    assert titles[-1] == "$s = 5$"


def test_contours_enclose_half_and_all_but_a_twentieth_of_the_equilibrium(solution):
    fine = np.linspace(-6, 6, 601)
    density = np.exp(-0.5 * (fine[:, None] ** 2 + fine[None, :] ** 2))
    outer, inner = maps.enclosing_levels(density)
    # The level that encloses the share q of a Gaussian is 1 - q of its peak; the
    # cells of area 4e-4 bound the error.
    assert inner == pytest.approx(0.5, abs=1e-3)
    assert outer == pytest.approx(0.05, abs=1e-3)
    figure = plotting.plot_marginals(solution)
    assert "contours: $p_S$" in title(figure)
    assert len(figure.axes[0].collections) == 1


def test_without_an_equilibrium_there_are_no_contours(free_solution):
    figure = plotting.plot_marginals(free_solution)
    assert len(figure.axes[0].collections) == 0
    assert "contours" not in title(figure)


def test_the_window_holds_all_but_a_thousandth_of_every_map(solution):
    marginals = [solution.marginal("xi", s) for s in solution.saved_s]
    width1, width2 = maps.visible_region(solution.grid, marginals)
    xi1, xi2 = solution.grid.plane()
    inside = (abs(xi1) <= width1) & (abs(xi2) <= width2)
    for values in marginals:
        # One thousandth in either direction.
        assert (values * inside).sum() >= (1 - 2e-3) * values.sum()


def test_peaks_that_differ_much_share_a_square_root_scale():
    flat, peaked = np.full((4, 4), 0.1), np.full((4, 4), 1.0)
    assert type(maps.colour_scale([flat, peaked])).__name__ == "PowerNorm"
    assert type(maps.colour_scale([flat, flat])).__name__ == "Normalize"


def test_angles_are_drawn_with_the_uniform_density(solution):
    axes = plotting.plot_angle(solution).axes[0]
    assert labels(axes)[0] == "$s = 0$"
    assert labels(axes)[-1] == r"$1/(2\pi)$"
    *_, uniform = axes.lines
    assert set(uniform.get_ydata()) == {1 / (2 * np.pi)}
    x, y = axes.lines[0].get_data()
    np.testing.assert_allclose(x[1:-1], solution.grid.alpha, rtol=1e-14)
    np.testing.assert_array_equal(y[1:-1], solution.marginal("alpha", 0.0))
    # One cell more on either side, which is periodic.
    assert (y[0], y[-1]) == (y[-2], y[1])
    assert axes.get_xlabel() == r"angle $\alpha$"


def test_the_entropy_falls_on_a_logarithmic_axis(solution):
    axes = plotting.plot_entropy(solution).axes[0]
    assert axes.get_yscale() == "log"
    entropy, dissipation, _ = axes.lines
    expected = solution.relative_entropy - solution.entropy_floor
    np.testing.assert_array_equal(entropy.get_ydata(), expected)
    np.testing.assert_array_equal(dissipation.get_ydata(), solution.entropy_dissipation)
    assert len(axes.collections) == 1
    names = labels(axes)
    largest = solution.errors["relative_entropy"].max()
    assert 0.01 < largest <= 0.02
    assert names[0] == r"$H(p\,|\,p_S)$"
    assert names[1] == r"error $\leq 2\cdot 10^{-2}$"
    assert names[2] == "dissipation"
    assert r"\lambda =" in names[3]
    assert r"\pm" in names[3]
    assert axes.get_xlabel() == r"arclength $s$"


def test_the_rate_in_the_legend_is_the_fitted_one(solution):
    fit = fitted_rate(solution)
    assert fit == solution.entropy_rate()
    label = labels(plotting.plot_entropy(solution).axes[0])[3]
    written = float(label.partition(r"\lambda = ")[2].split()[0])
    # As many digits as the standard error leaves: half a unit of its first digit.
    assert written == pytest.approx(fit.rate, abs=fit.standard_error)


def test_on_a_moving_belt_no_rate_is_fitted(belt_solution):
    assert fitted_rate(belt_solution) is None
    assert len(plotting.plot_entropy(belt_solution).axes[0].lines) == 2


def test_without_estimates_there_is_no_band():
    axes = plotting.plot_entropy(relaxing_solution(errors=False)).axes[0]
    assert len(axes.collections) == 0


def test_an_entropy_that_does_not_exist_is_refused(free_solution):
    with pytest.raises(ValueError, match=r"must have a relative entropy to show"):
        plotting.plot_entropy(free_solution)


def test_moments_are_drawn_with_their_estimates(solution):
    position, spread, direction = plotting.plot_moments(solution).axes
    np.testing.assert_array_equal(position.lines[0].get_ydata(), solution.mean_xi1)
    np.testing.assert_array_equal(spread.lines[2].get_ydata(), solution.covariance)
    assert labels(direction) == [
        r"$\mathrm{E}\,\cos\alpha$",
        r"$\mathrm{E}\,\sin\alpha$",
    ]
    assert len(position.collections) == 2


def test_the_belt_speed_is_drawn_as_the_limit_of_the_direction(belt_solution):
    *_, direction = plotting.plot_moments(belt_solution).axes
    assert labels(direction)[-1] == "$-v = -0.1$"
    assert set(direction.lines[-1].get_ydata()) == {-0.1}


def test_rounding_errors_of_moments_do_not_fill_a_panel(free_solution):
    *_, direction = plotting.plot_moments(free_solution).axes
    bottom, top = direction.get_ylim()
    assert top - bottom >= 0.1


def test_titles_state_the_parameters(solution, belt_solution):
    assert title(plotting.plot_moments(solution)).endswith("$A = 1$")
    assert title(plotting.plot_moments(belt_solution)).endswith("$v = 0.1$")
    nozzle = LayDownModel(QuadraticPotential(), 1.0, RotatingNozzle(0.1, 0.5, 2.0))
    shown = title(plotting.plot_moments(replace(solution, model=nozzle)))
    assert r"$\gamma(s) =$" in shown
    unknown = title(plotting.plot_moments(replace(solution, model=None)))
    assert unknown == "$B$ from the user's own functions"


def test_titles_can_be_drawn_by_matplotlib(solution, belt_solution):
    for one in (solution, belt_solution):
        parsed = MathTextParser("path").parse(style.parameters(one))
        assert parsed.width > 0


def test_figures_stay_out_of_pyplot_and_leave_the_style_alone(solution):
    style_before, figures_before = dict(mpl.rcParams), plt.get_fignums()
    plotting.plot_overview(solution)
    assert dict(mpl.rcParams) == style_before
    # Examples run by other tests may have opened figures of their own.
    assert plt.get_fignums() == figures_before


def test_figures_are_as_wide_as_a_column_or_a_page(solution):
    for plot, width in {
        plotting.plot_angle: 3.4,
        plotting.plot_entropy: 3.4,
        plotting.plot_moments: 7.0,
        plotting.plot_marginals: 7.0,
        plotting.plot_overview: 7.0,
    }.items():
        assert plot(solution).get_figwidth() == width


def test_nothing_is_cut_off_at_the_border(solution, belt_solution):
    for one in (solution, belt_solution):
        figure = plotting.plot_overview(one)
        figure.canvas.draw()
        box = figure.get_tightbbox()
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.get_figwidth()
        assert box.y1 <= figure.get_figheight()


def test_all_figures_are_written_at_paper_size(solution, tmp_path):
    paths = plotting.save_figures(solution, tmp_path / "new")
    assert [path.name for path in paths] == [
        "overview.png",
        "marginals.png",
        "angle.png",
        "entropy.png",
        "moments.png",
    ]
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == sorted(
        path.name for path in paths
    )
    for path in paths:
        # 200 dots per inch of one column or a page, and not an empty sheet.
        pixels = imread(path)
        assert pixels.shape[1] in (680, 1400)
        assert 0.02 < np.mean(pixels[..., :3].min(axis=2) < 0.5) < 0.9


def test_only_possible_figures_are_written(free_solution, tmp_path):
    bare = replace(
        free_solution, saved_s=np.empty(0), densities=np.empty((0, 12, 14, 8))
    )
    paths = plotting.save_figures(bare, tmp_path)
    assert [path.name for path in paths] == ["moments.png"]


def test_maps_need_a_saved_density(solution):
    bare = replace(solution, saved_s=np.empty(0), densities=np.empty((0, 12, 14, 8)))
    with pytest.raises(
        ValueError, match=r"must hold a saved density to show, got none"
    ):
        plotting.plot_marginals(bare)
    with pytest.raises(ValueError, match=r"`s` must be one of the saved values"):
        plotting.plot_angle(solution, at=[0.7])


def test_a_movie_has_a_frame_for_every_saved_density(solution, tmp_path):
    path = plotting.movie(solution, tmp_path / "run.gif", fps=4)
    with Image.open(path) as frames:
        assert frames.n_frames == len(solution.saved_s)
        assert frames.info["duration"] == 250
    assert list(tmp_path.iterdir()) == [path]


def test_a_movie_without_an_entropy_shows_the_spread(free_solution, tmp_path):
    path = plotting.movie(free_solution, tmp_path / "run.gif")
    assert path.stat().st_size > 10_000


def test_a_movie_needs_two_densities_a_known_kind_and_a_rate(solution, tmp_path):
    single = relaxing_solution(saved=(5.0,), errors=False)
    with pytest.raises(ValueError, match=r"must hold at least two saved densities"):
        plotting.movie(single, tmp_path / "run.gif")
    with pytest.raises(ValueError, match=r"must end in \.gif or \.mp4, got `run\.avi`"):
        plotting.movie(solution, tmp_path / "run.avi")
    for fps in (0.0, np.nan):
        with pytest.raises(ValueError, match=r"`fps` must be positive, got"):
            plotting.movie(solution, tmp_path / "run.gif", fps=fps)
    assert list(tmp_path.iterdir()) == []


def test_a_movie_as_mp4_needs_ffmpeg(solution, tmp_path, monkeypatch):
    from matplotlib.animation import FFMpegWriter

    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with pytest.raises(ValueError, match=r"must end in \.gif where ffmpeg is not"):
        plotting.movie(solution, tmp_path / "run.mp4")
