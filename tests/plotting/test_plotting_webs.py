"""Figures of webs show the web, its numbers with their errors, and a true scale."""

import numpy as np
import pytest
from matplotlib.image import imread
from straight_fibres import web_of_sticks

from fpsolve import plotting
from fpsolve.plotting.web_image import WebImage, round_length
from fpsolve.plotting.web_quality import zones_for
from fpsolve.web.statistics.formation import STRAIGHT_FIBRES
from fpsolve.web.statistics.orientation import orientation_rose
from fpsolve.web.statistics.spectrum import power_spectrum
from fpsolve.web.statistics.zones import coefficient_of_variation


@pytest.fixture(scope="module")
def web():
    generator = np.random.default_rng(1)
    density = web_of_sticks(generator, (80, 200), 30.0, 1.0) / 0.05
    angle = generator.normal(0.0, 0.5, density.shape)
    direction = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    tensor = direction[..., :, None] * direction[..., None, :]
    return WebImage(density, 0.05, orientation=tensor, title="$A = 1$")


@pytest.fixture(scope="module")
def woven(web):
    """The same web, of a pixel of a tenth of a millimetre, with its mass."""
    density = web.density * 0.05 / 1e-4
    return WebImage(density, 1e-4, "m", mass=2e-3 * density)


def test_the_mean_density_lets_a_little_more_than_half_of_the_light_pass(web):
    axes = plotting.plot_web(web).axes[0]
    light = axes.images[0].get_array()
    mean = np.log(light).mean()
    # ln 0.55, exactly: light falls exponentially with the density.
    assert mean == pytest.approx(np.log(0.55), rel=1e-12)
    assert axes.get_title() == "$A = 1$"
    # Machine direction to the right, whatever the scale bar needs below.
    assert axes.get_xlim() == (0.0, 10.0)
    assert axes.get_ylim() == (0.0, 4.0)


def test_webs_below_each_other_share_one_scale_of_grey(web):
    double = WebImage(2 * web.density, web.pixel)
    first, second = plotting.plot_web([web, double], titles=["one", "two"]).axes
    light = first.images[0].get_array()
    np.testing.assert_allclose(second.images[0].get_array(), light**2, rtol=1e-12)
    assert [axes.get_title() for axes in (first, second)] == ["one", "two"]


def test_the_scale_bar_has_the_length_that_it_says(web, woven):
    for image, label in ((web, "length 2"), (woven, "5 mm")):
        axes = plotting.plot_web(image).axes[0]
        bar = axes.lines[0].get_xdata()
        assert bar[1] - bar[0] == pytest.approx(float(label.split()[label[0] == "l"]))
        assert [text.get_text() for text in axes.texts] == [label]
    assert [round_length(x) for x in (0.1, 0.3, 0.99, 4.99, 70.0)] == [
        0.1, 0.2, 0.5, 2.0, 50.0,
    ]  # fmt: skip


def test_mass_is_shown_in_grams_where_it_is_known_and_as_length_where_not(web, woven):
    axes, bar = plotting.plot_mass(woven).axes
    np.testing.assert_array_equal(axes.images[0].get_array(), woven.mass)
    assert bar.get_ylabel() == "mass per area in g/m²"
    assert axes.get_xlabel() == "machine direction in mm"
    assert axes.get_ylim() == (0.0, pytest.approx(8.0))
    axes, bar = plotting.plot_mass(web).axes
    np.testing.assert_array_equal(axes.images[0].get_array(), web.density)
    assert bar.get_ylabel() == "laid length per area"


def test_the_variation_is_drawn_with_errors_beside_straight_fibres_and_prediction(web):
    figure = plotting.plot_variation(
        web, [0.1, 0.2, 0.5], predicted=([0.1, 1.0], [0.9, 0.2])
    )
    axes = figure.axes[0]
    straight, predicted, *_ = axes.lines
    found = coefficient_of_variation(web.density, web.pixel, [0.1, 0.2, 0.5])
    (drawn,) = axes.containers
    np.testing.assert_array_equal(drawn[0].get_ydata(), found.values)
    ends = np.array([segment[:, 1] for segment in drawn[2][0].get_segments()])
    half = np.diff(ends, axis=1)[:, 0] / 2
    np.testing.assert_allclose(half, found.standard_errors, rtol=1e-12)
    assert list(predicted.get_ydata()) == [0.9, 0.2]
    law = np.sqrt(STRAIGHT_FIBRES / (web.density.mean() * found.coordinate))
    np.testing.assert_allclose(straight.get_ydata(), law, rtol=1e-14)


def test_zones_are_round_and_lie_between_pixel_and_web(web):
    assert zones_for(web) == pytest.approx([0.05, 0.1, 0.2, 0.5, 1.0])
    assert zones_for(WebImage(np.ones((3, 3)), 0.07)) == pytest.approx([0.07])


def test_the_rose_has_a_bar_for_every_direction_and_its_opposite(web):
    axes = plotting.plot_rose(web, n_bins=12).axes[0]
    rose = orientation_rose(web.density, web.pixel, web.orientation, n_bins=12)
    heights = [patch.get_height() for patch in axes.patches[:24]]
    np.testing.assert_allclose(heights, np.tile(rose.values, 2), rtol=1e-14)
    isotropic = [line for line in axes.lines if line.get_label() == "isotropic"]
    assert set(isotropic[0].get_ydata()) == {1 / np.pi}


def test_the_spectrum_is_that_of_one_fibre_in_the_units_shown(web, woven):
    for image, factor in ((web, 1.0), (woven, 1e3)):
        figure = plotting.plot_web_spectrum(image)
        found = power_spectrum(image.density, image.pixel)
        axes = figure.axes[1]
        ring = axes.containers[0][0]
        one = factor * found.radial.values / found.mean
        np.testing.assert_allclose(ring.get_ydata(), one, rtol=1e-12)
        np.testing.assert_allclose(
            ring.get_xdata(), found.radial.coordinate / factor, rtol=1e-12
        )
    assert axes.get_xlabel() == r"$\|k\|$ in mm$^{-1}$"


def test_the_picture_of_a_web_has_a_dot_for_every_pixel(woven, tmp_path):
    path = plotting.save_web_png(woven, tmp_path / "web.png", opacity=1e-4)
    picture = imread(path)[..., 0]
    assert picture.shape == (80 + 40, 200)
    # The first row is the farthest in cross direction; the map of greys has 256 steps
    # of 1/255, and the file rounds once more.
    light = np.exp(-1e-4 * woven.density)[::-1]
    assert np.abs(picture[:80] - light).max() <= 2 / 255
    # 5 mm of the bar are 50 dots.
    black = np.sum(picture[80:] < 0.5, axis=1)
    assert np.max(black) == 50


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda w: plotting.plot_web([]),
            "`web` must be a web or some of them, got no",
        ),
        (lambda w: plotting.plot_web(w, opacity=0), "`opacity` must be positive and"),
        (lambda w: plotting.plot_web(w, titles=[]), "`titles` must be one for each of"),
        (lambda w: plotting.plot_variation(w, 9.0), "`zone` must fit at least twice"),
        (
            lambda w: plotting.plot_rose(WebImage(w.density, 1.0)),
            "`web` must have an orientation for a rose, got none",
        ),
        (
            lambda w: plotting.save_web_png(WebImage(np.ones((9, 9)), 1.0), "a.png"),
            "`web` must have 40 to 65494 pixels along a side of its picture, got 9",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(web, call, message):
    with pytest.raises(ValueError, match=message):
        call(web)


def test_what_is_no_web_has_no_figures():
    for plot in (plotting.plot_web, plotting.plot_mass, plotting.plot_variation,
                 plotting.plot_rose, plotting.plot_web_spectrum):  # fmt: skip
        with pytest.raises(TypeError, match="`web` must be a Web, got 3"):
            plot(3.0)
