"""The orientation of a web is that of its fibres."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import fpsolve as fp
from fpsolve.web.statistics.orientation import (
    machine_cross_ratio,
    mean_orientation,
    orientation_rose,
)


def tensors(angle):
    direction = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    return direction[..., :, None] * direction[..., None, :]


def random_web(generator, shape=(48, 96), stretch=0.5):
    """One fibre per pixel, of random length, its angle of density 1 + 2 q cos 2θ."""
    angle = generator.uniform(0, np.pi, (2, *shape))
    accept = generator.uniform(0, 1 + stretch, shape) < 1 + stretch * np.cos(
        2 * angle[0]
    )
    # What is refused turns by a right angle, which mirrors cos 2θ: the mean stays.
    angle = np.where(accept, angle[0], angle[0] + np.pi / 2)
    return generator.gamma(2.0, size=shape), tensors(angle), angle


def test_parallel_fibres_have_the_ratio_of_their_angle():
    web = np.random.default_rng(1).uniform(1, 2, (20, 30))
    found = machine_cross_ratio(web, 1.0, tensors(np.full(web.shape, 0.3)))
    assert float(found) == pytest.approx(1 / np.tan(0.3) ** 2, rel=1e-12)
    assert found.standard_error < 1e-10


def test_the_mean_is_over_length_and_not_over_pixels():
    web = np.array([[3.0, 1.0, 0.0]])
    orientation = tensors(np.array([[0.0, np.pi / 2, 0.7]]))
    # Where there is no fibre there is no direction.
    orientation[0, 2] = np.nan
    mean = mean_orientation(web, 1.0, orientation)
    assert np.abs(mean - np.diag([0.75, 0.25])).max() < 1e-15


def test_errors_cover_the_ratio_of_independent_pixels():
    generator, found = np.random.default_rng(2), []
    for _ in range(150):
        web, orientation, _ = random_web(generator)
        found.append(machine_cross_ratio(web, 1.0, orientation))
    # Turned by the rule above, E cos 2θ is q/(1 + q); MD/CD = (1 + c)/(1 - c).
    mean = 0.5 / 1.5
    truth = (1 + mean) / (1 - mean)
    inside = [low <= truth <= high for low, high in (one.interval() for one in found)]
    # Of 150, 142.5 ± 2.7 are expected.
    assert np.mean(inside) > 0.95 - 4 * 0.018
    errors = [one.standard_error for one in found]
    assert 0.85 < np.mean(errors) / np.std(found) < 1.2


def test_the_rose_is_the_density_of_angles_where_pixels_hold_one_fibre():
    web, orientation, angle = random_web(np.random.default_rng(3))
    rose = orientation_rose(web, 1.0, orientation, n_bins=12)
    edges = np.pi / 12 * (np.arange(13) - 0.5)
    turned = (angle + np.pi / 24) % np.pi - np.pi / 24
    counts, _ = np.histogram(turned, edges, weights=web)
    assert np.allclose(rose.values, counts / web.sum() / (np.pi / 12), rtol=1e-12)
    assert np.sum(rose.values) * np.pi / 12 == pytest.approx(1.0, rel=1e-12)
    # f = (1 + 2 c cos 2θ)/π, with c as above, in twelve bins: 4 standard errors.
    law = (1 + 2 / 3 * np.cos(2 * rose.coordinate)) / np.pi
    assert (np.abs(rose.values - law) < 4 * rose.standard_errors + 0.003).all()
    assert (rose.standard_errors < 0.1 * law.max()).all()


def test_the_rose_has_the_tensor_of_the_web_where_fibres_cross():
    generator = np.random.default_rng(4)
    first, second = (random_web(generator) for _ in range(2))
    web = first[0] + second[0]
    lengths = [part[0][..., None, None] for part in (first, second)]
    both = lengths[0] * first[1] + lengths[1] * second[1]
    orientation = both / web[..., None, None]
    rose = orientation_rose(web, 1.0, orientation, n_bins=720)
    mean = mean_orientation(web, 1.0, orientation)
    width = np.pi / 720
    # Bins blur an angle by at most half their width.
    cosine = np.sum(rose.values * np.cos(2 * rose.coordinate)) * width
    sine = np.sum(rose.values * np.sin(2 * rose.coordinate)) * width
    assert abs(cosine - (mean[0, 0] - mean[1, 1])) < width
    assert abs(sine - 2 * mean[0, 1]) < width


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"orientation": np.ones((4, 6, 2))}, "`orientation` must be of shape"),
        ({"orientation": np.full((4, 6, 2, 2), np.nan)}, "must have trace 1 .* nan at"),
        ({"orientation": np.ones((4, 6, 2, 2))}, "must have trace 1 .* got 2 at pixel"),
        ({"n_bins": 1}, "`n_bins` must be at least 2, got 1"),
    ],
)
def test_what_is_no_orientation_is_refused(change, message):
    chosen = {"orientation": tensors(np.zeros((4, 6))), "n_bins": 4, **change}
    with pytest.raises(ValueError, match=message):
        orientation_rose(np.ones((4, 6)), 1.0, **chosen)


def test_the_structure_tensor_of_the_picture_sees_the_same_orientation():
    # A second method, of image analysis: where lines do not cross, gradients of the
    # brightness are normal to them, so that ⟨τ⊗τ⟩ = 1 - ⟨∇m⊗∇m⟩/⟨|∇m|²⟩.
    belt = fp.MovingBelt(0.6)
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 1.0, 0.6, belt)
    web = fp.lay_web(model, width=24.0, length=24.0, spacing=2.0, pixel=0.05, seed=1)
    # Blurred over one pixel and a half, a twentieth of the radius of the fibre.
    gradients = np.stack([
        gaussian_filter(web.length_density, 1.5, order=order).ravel()
        for order in ((0, 1), (1, 0))
    ])  # fmt: skip
    square = gradients @ gradients.T
    expected = np.eye(2) - square / np.trace(square)
    # Fibres do cross: of twelve webs both differ by 0.005 in the mean square.
    np.testing.assert_allclose(web.mean_orientation, expected, rtol=0, atol=0.02)
    # Far from the half of a web without direction.
    assert web.mean_orientation[0, 0] > 0.6
