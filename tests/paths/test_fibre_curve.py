"""Fibre curves: what is computed of points, and what is refused."""

import numpy as np
import pytest
import xarray as xr

import fpsolve as fp
from fpsolve.errors import FileFormatError

BELT = fp.MovingBelt(0.2)


def circle(n, radius=2.0, ds=0.1):
    """Points of a circle at arclengths i ds."""
    angle = ds * np.arange(n) / radius
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def uneven(n):
    """Points of the unit circle at unequal distances, and their angles."""
    angle = np.linspace(0.0, 6.0, n)
    angle = angle + 0.05 * np.sin(7 * angle)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1), angle


def test_a_straight_fibre_has_one_angle_and_no_curvature():
    s = 0.1 * np.arange(20)
    fibre = fp.FibreCurve(np.stack([0.6 * s, 0.8 * s], axis=-1), 0.1)
    # Differences of numbers of size 2 by 0.1: rounding of 2e-15.
    np.testing.assert_allclose(fibre.angles[0], np.arctan2(0.8, 0.6), atol=1e-14)
    np.testing.assert_allclose(fibre.curvatures[0], 0.0, atol=1e-12)


def test_the_chords_of_a_circle_turn_as_the_circle_does_beyond_full_turns():
    fibre = fp.FibreCurve(circle(400), 0.1)
    # α at the middle of a chord is exactly that of the circle there.
    exact = np.pi / 2 + (np.arange(399) + 0.5) * 0.1 / 2.0
    np.testing.assert_allclose(fibre.angles[0], exact, atol=1e-12)
    np.testing.assert_allclose(fibre.curvatures[0], 0.5, atol=1e-10)


def test_deviations_are_from_the_curve_at_the_arclengths_of_every_fibre():
    nozzle = fp.RotatingNozzle(0.1, 2.0, 0.5, 0.3)
    pieces = [circle(50), circle(30)]
    fibre = fp.FibreCurve(pieces, 0.1, nozzle, s_start=[0.0, 7.0])
    for k, (start, piece) in enumerate(zip((0.0, 7.0), pieces, strict=True)):
        s = start + 0.1 * np.arange(len(piece))
        gamma = np.stack(nozzle.position(s), axis=-1)
        np.testing.assert_allclose(fibre.deviations[k], piece - gamma, atol=1e-15)


def test_paths_become_fibres_of_the_same_points():
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.5, 1.0, BELT)
    paths = fp.sample_paths(model, 3, 2.0, 0.05, seed=1, save_at=0.1 * np.arange(21))
    fibre = fp.FibreCurve.from_paths(paths)
    assert fibre.curve == BELT
    for k, piece in enumerate(fibre.pieces):
        np.testing.assert_array_equal(piece, paths.eta[:, k])
        np.testing.assert_allclose(fibre.deviations[k], paths.xi[:, k], atol=1e-15)
    uneven_s = fp.sample_paths(model, 3, 2.0, 0.05, seed=1, save_at=[0, 0.1, 1, 1.5, 2])
    with pytest.raises(ValueError, match="`save_at` must be at equal distances"):
        fp.FibreCurve.from_paths(uneven_s)


def test_resampling_to_equal_arclength_is_of_order_four_and_its_error_covers():
    errors, told = [], []
    for n in (100, 200, 400):
        points, angle = uneven(n)
        fibre = fp.FibreCurve.from_points(points, 0.01)
        s = fibre.arclengths[0] + angle[0]
        exact = np.stack([np.cos(s), np.sin(s)], axis=-1)
        errors.append(np.sqrt(np.mean(np.sum((fibre.eta - exact) ** 2, axis=1))))
        told.append(fibre.resampling_error)
    assert np.all(np.array(told) > errors)
    # At every halving; a not-a-knot spline loses a little at its ends.
    assert np.all(np.diff(np.log2(errors)) < -3.7)
    assert np.all(np.diff(np.log2(told)) < -3.7)


def test_points_whose_arclengths_are_known_are_resampled_by_them():
    # Slack: the points of a string that is longer than the line that it lies on would
    # be refused, so that arclengths are those of a circle here.
    points, angle = uneven(400)
    fibre = fp.FibreCurve.from_points(points, 0.02, s=angle)
    assert fibre.s_start[0] == angle[0]
    exact = np.stack([np.cos(fibre.arclengths[0]), np.sin(fibre.arclengths[0])], axis=1)
    # (0.02)⁴/384 of a cubic spline, at the largest spacing, with its ends.
    assert np.abs(fibre.eta - exact).max() < 1e-7


def test_a_fibre_that_was_resampled_says_by_how_much_it_is_off():
    fibre = fp.FibreCurve(circle(401, ds=0.05), 0.05).resampled(0.08)
    exact = circle(len(fibre.eta), ds=0.08)
    off = np.sqrt(np.mean(np.sum((fibre.eta - exact) ** 2, axis=1)))
    assert 0 < off < fibre.resampling_error < 1e-5


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
def test_a_table_of_text_is_read_whatever_is_between_its_columns(mark, tmp_path):
    points = circle(60)
    rows = [mark.join(("s", "x", "y"))]
    rows += [mark.join(f"{x:.12g}" for x in (0.1 * i, *point))
             for i, point in enumerate(points)]  # fmt: skip
    path = tmp_path / "fibre.csv"
    path.write_text("# by the camera\n" + "\n".join(rows) + "\n")
    fibre = fp.FibreCurve.read_csv(path, curve=BELT)
    assert fibre.ds == pytest.approx(0.1, rel=1e-12)
    # Twelve digits.
    np.testing.assert_allclose(fibre.eta, points, atol=1e-11)
    metres = fp.FibreCurve.read_csv(path, unit=1e-3)
    np.testing.assert_allclose(metres.eta, 1e3 * points, atol=1e-8)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_commas_between_semicolons_are_decimal_ones(mark, tmp_path):
    points = np.round(circle(60), 4)
    rows = [mark.join(f"{x:.4f}" for x in point).replace(".", ",") for point in points]
    (tmp_path / "fibre.csv").write_text(f"x{mark}y\n" + "\n".join(rows))
    fibre = fp.FibreCurve.read_csv(tmp_path / "fibre.csv", 0.1)
    np.testing.assert_array_equal(fibre.eta, points)


def test_the_rounding_of_a_table_is_the_error_of_its_points(tmp_path):
    straight = np.outer(0.1 * np.arange(60), (0.6, 0.8))
    # Rounded to four digits, chords are longer than Δs by up to 1e-4: no misfit.
    rows = "\n".join(f"{x:.4f},{y:.4f}" for x, y in 1.00037 * straight)
    (tmp_path / "fibre.csv").write_text(rows)
    ds = 0.1 * 1.00037
    fibre = fp.FibreCurve.read_csv(tmp_path / "fibre.csv", ds)
    assert fibre.position_error == pytest.approx(1e-4 / 12**0.5, rel=1e-12)
    metres = fp.FibreCurve.read_csv(tmp_path / "fibre.csv", 1e3 * ds, unit=1e-3)
    assert metres.position_error == pytest.approx(0.1 / 12**0.5, rel=1e-12)
    with pytest.raises(ValueError, match="no fibre is shorter than its chord"):
        fp.FibreCurve.read_csv(tmp_path / "fibre.csv", ds, position_error=0.0)


def test_a_table_holds_several_fibres_by_their_numbers(tmp_path):
    rows = ["fibre,eta1,eta2"]
    for number, n in ((1, 20), (2, 30)):
        rows += [f"{number},{x:.15g},{y:.15g}" for x, y in circle(n)]
    path = tmp_path / "fibres.csv"
    path.write_text("\n".join(rows))
    fibre = fp.FibreCurve.read_csv(path, 0.1)
    assert fibre.lengths.tolist() == [20, 30]
    with pytest.raises(ValueError, match="`ds` must be given where there is no column"):
        fp.FibreCurve.read_csv(path)


def test_a_table_of_unequal_steps_is_resampled(tmp_path):
    points, angle = uneven(300)
    path = tmp_path / "fibre.csv"
    np.savetxt(path, np.column_stack([angle, points]), header="s x y", comments="")
    fibre = fp.FibreCurve.read_csv(path, 0.02)
    assert fibre.resampling_error > 0
    with pytest.raises(ValueError, match="the steps of `s` differ"):
        fp.FibreCurve.read_csv(path)


def test_a_dataset_is_read_with_its_arclengths(tmp_path):
    points = circle(40)
    columns = {"s": 0.1 * np.arange(40), "x": points[:, 0], "y": points[:, 1]}
    dataset = xr.Dataset({name: ("point", values) for name, values in columns.items()})
    path = tmp_path / "fibre.nc"
    dataset.to_netcdf(path, engine="h5netcdf")
    for source in (dataset, path):
        np.testing.assert_array_equal(fp.FibreCurve.from_xarray(source).eta, points)
    with pytest.raises(FileFormatError, match="columns must be eta1, eta2 or x, y"):
        fp.FibreCurve.from_xarray(dataset.drop_vars("y"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it holds no row of numbers"),
        ("x,y\n1,2\n3\n", "row 2 is no 2 numbers"),
        ("x,y\n1,a\n", "row 1 is no 2 numbers"),
        ("u,w\n1,2\n", "columns must be eta1, eta2 or x, y, and are u, w"),
    ],
)
def test_a_table_that_is_none_says_where(text, said, tmp_path):
    path = tmp_path / "wrong.csv"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=said):
        fp.FibreCurve.read_csv(path, 0.1)


HOLE = circle(20)
HOLE[7, 1] = np.nan


@pytest.mark.parametrize(
    ("eta", "ds", "options", "said"),
    [
        (HOLE, 0.1, {}, r"`eta` must be finite, got nan at index \(7, 1\)"),
        (circle(20).T, 0.1, {}, r"`eta` must have the shape \(n, 2\)"),
        (circle(4), 0.1, {}, "`eta` must have at least 5 points a fibre, got 4"),
        (circle(20), 0.09, {}, "no fibre is shorter than its chord"),
        (circle(20), 0.2, {}, "about the distance of neighbouring points"),
        (circle(20), np.nan, {}, "`ds` must be positive and finite"),
        (circle(20), 0.1, {"position_error": -1.0}, "`position_error` must be non-neg"),
        (circle(20), 0.1, {"s_start": [0.0, 1.0]}, "one for each of the 1 fibres"),
        (circle(20), 0.1, {"lengths": [9, 9]}, "the numbers of all 20 points"),
    ],
)
def test_points_that_are_no_fibre_are_refused(eta, ds, options, said):
    with pytest.raises(ValueError, match=said):
        fp.FibreCurve(eta, ds, **options)


def test_scatter_of_the_points_makes_a_chord_longer_than_the_fibre():
    rng = np.random.default_rng(1)
    scattered = circle(200) + 0.003 * rng.standard_normal((200, 2))
    with pytest.raises(ValueError, match="Pass the `position_error`"):
        fp.FibreCurve(scattered, 0.1)
    assert fp.FibreCurve(scattered, 0.1, position_error=0.003).check_turns() < 0.15


def test_an_angle_that_cannot_be_unwrapped_is_refused():
    model = fp.LayDownModel(fp.QuadraticPotential(), 4.0)
    paths = fp.sample_paths(model, 1, 20.0, 0.01, seed=1, save_at=0.02 * np.arange(900))
    fine = fp.FibreCurve.from_paths(paths)
    # A √(2Δs/3), the turn from chord to chord of the basic model; its standard error
    # over 900 chords is 2 %, and chords of the sampler's half steps turn less.
    assert fine.check_turns() == pytest.approx(4 * np.sqrt(2 * 0.02 / 3), rel=0.1)
    coarse = fp.FibreCurve(fine.eta[::4], 0.08, position_error=0.02)
    with pytest.raises(ValueError, match="the angle cannot be unwrapped"):
        coarse.angles  # noqa: B018


def test_without_a_reference_curve_there_are_no_deviations():
    fibre = fp.FibreCurve(circle(20), 0.1)
    with pytest.raises(ValueError, match="`curve` must be known for deviations"):
        fibre.deviations  # noqa: B018
    assert len(fibre.with_curve(BELT).deviations[0]) == 20


# Curves that are nearly as long as the fibre, so that it may lie on them.
NOZZLES = {
    "rotating": fp.RotatingNozzle(0.0, 1.9, 0.5, 0.7),
    "oscillating": fp.OscillatingNozzle(0.6, 1.7, 0.5, 0.7),
}


@pytest.mark.parametrize("motion", NOZZLES)
def test_a_nozzle_is_found_within_the_standard_errors_of_its_fit(motion):
    # Points that scatter independently about γ: 20 fits of two numbers, whose mean
    # square in units of the errors is 1 ± 0.22, up to 20 blocks for each error.
    made, s, z = NOZZLES[motion], 0.4 * np.arange(800), []
    gamma = np.stack(made.position(s), axis=-1) + np.array([0.3, -0.2])
    for seed in range(20):
        noise = 0.05 * np.random.default_rng(seed).standard_normal(gamma.shape)
        fibre = fp.FibreCurve(gamma + noise, 0.4, position_error=0.05)
        fit = fp.fit_curve(fibre, 0.5, made.speed, motion=motion, centre=True)
        true = max(made.radii)
        z += [(fit.radius - true) / fit.radius_error]
        z += [(fit.phase - 0.7) / fit.phase_error]
        assert fit.centre == pytest.approx((0.3, -0.2), abs=0.02)
        assert np.abs(fit.fibre.deviations[0]).max() < 0.4
    assert 0.4 < np.mean(np.square(z)) < 2.0


def test_the_fit_of_a_nozzle_is_shifted_by_the_lag_of_the_fibre():
    nozzle = fp.RotatingNozzle(0.0, 4.0, 0.02)
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, nozzle)
    paths = fp.sample_paths(
        model, 24, 1257.0, 0.1, seed=1, save_at=0.5 * np.arange(2514)
    )
    fit = fp.fit_curve(fp.FibreCurve.from_paths(paths), 0.02)
    # On a belt of speed ωr = 0.08 the mean of ξ is 0.1033, by remark 3.7 and its
    # correction; the phase of E η is behind by that over r.
    belt = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.08))
    mean = fp.spectral_steady_state(belt, tolerance=1e-4).moments["mean_xi1"]
    assert abs(fit.phase + mean / 4.0) < 4 * fit.phase_error


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((0.0,), "`angular_speed` must not be 0"),
        ((0.5, 1.5), "`speed` must lie strictly between -1 and 1"),
        ((0.5,), "must cover at least 8 periods of its nozzle"),
    ],
)
def test_a_fit_that_has_no_sense_is_refused(arguments, said):
    with pytest.raises(ValueError, match=said):
        fp.fit_curve(fp.FibreCurve(circle(200), 0.1), *arguments)
