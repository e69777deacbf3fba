"""Designs of moving nozzles: known valleys, real patterns, laid webs."""

import math
from dataclasses import replace

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import plotting, studies
from fpsolve.errors import ToleranceError
from fpsolve.studies.nozzles import patterns
from fpsolve.studies.nozzles.confirm import laid_squares
from fpsolve.studies.nozzles.valleys import RESOLUTION

QUADRATIC = fp.QuadraticPotential()
SWINGING = fp.LayDownModel(QUADRATIC, 1.5, fp.OscillatingNozzle(0.05, 1.0, 0.3))
TURNING = fp.LayDownModel(QUADRATIC, 1.5, fp.EllipticNozzle(0.05, 0.5, 1.0, -0.3))
OMEGA = {"angular_speed": (0.1, 1.0)}


class KnownPattern:
    """CV of a law in closed form in place of a pattern, each with its error."""

    def __init__(self, law, error=1e-6):
        self.law, self.error = law, error

    def __call__(self, model, *, spacing, phases, tolerance):
        self.found = self.law(model.curve)
        if self.found is None:
            raise ToleranceError(1.0, 0.1, "nothing")
        return self

    def coefficient_of_variation(self, zone):
        return zone * self.found, zone * self.error


@pytest.fixture
def known(monkeypatch):
    """Designs nozzles of a law in closed form; laying none."""

    def designed(law, bounds=OMEGA, model=TURNING, error=1e-6, **options):
        monkeypatch.setattr(patterns, "mean_pattern", KnownPattern(law, error))
        options = {"spacing": 2.0, "n_webs": 0, **options}
        return studies.design_nozzles(model, [1.0, 2.0], bounds=bounds, **options)

    return designed


def two_valleys(curve):
    """The deeper one at ω = 0.6, another one at 0.2."""
    y = math.log(abs(curve.angular_speed))
    away = [abs(y - math.log(at)) + depth for at, depth in ((0.6, 0.1), (0.2, 0.2))]
    return min(away)


def test_the_deeper_of_two_valleys_is_found(known):
    design = known(two_valleys)
    # Two simplices of the resolution: their corners are all that was computed.
    assert abs(math.log(design.values[0] / 0.6)) < RESOLUTION
    assert design.active == ()
    # The model of the optimum turns the way that it did.
    assert design.model.curve.angular_speed == pytest.approx(-design.values[0])
    np.testing.assert_allclose(design.pattern_cv, [0.1, 0.2], atol=2 * RESOLUTION)
    assert design.ranges[0, 0] < 0.6 < design.ranges[1, 0]
    # Both valleys were searched.
    searched = design.points[design.n_scanned :, 0]
    assert np.abs(np.log(searched / 0.2)).min() < RESOLUTION


def test_two_numbers_have_their_optimum_where_the_law_has_it(known):
    def bowl(curve):
        y = np.log([abs(curve.angular_speed) / 0.4, curve.radius2 / 1.5])
        return 0.1 + y[0] ** 2 + y[1] ** 2 + 0.5 * y[0] * y[1]

    bounds = {"radius2": (0.5, 3.0), **OMEGA}
    design = known(bowl, bounds)
    assert design.names == ("angular_speed", "radius2")
    # Where CV is flat, 2e-3 above the lowest is 0.03 of a logarithm away.
    np.testing.assert_allclose(design.values, [0.4, 1.5], rtol=0.03)
    assert design.n_scanned == 49


def test_a_bound_that_holds_the_optimum_is_named(known):
    design = known(lambda curve: 0.1 / abs(curve.angular_speed))
    assert design.active == ("angular_speed at its upper bound",)
    assert design.values[0] == pytest.approx(1.0, rel=1e-12)
    assert design.ranges[1, 0] == pytest.approx(1.0, rel=1e-12)


def test_where_errors_hide_the_optimum_its_range_is_wide_and_the_search_short(known):
    sharp, blurred = (known(two_valleys, error=error) for error in (1e-6, 0.15))
    assert np.ptp(blurred.ranges) > 0.5 > 10 * np.ptp(sharp.ranges)
    # The other valley cannot be told from this one.
    assert blurred.ranges[0, 0] < 0.2 < 0.6 < blurred.ranges[1, 0]
    assert len(blurred.points) < len(sharp.points)


def test_points_that_are_not_known_are_counted_and_never_chosen(known):
    def fast_is_unknown(curve):
        return None if abs(curve.angular_speed) > 0.7 else 1 / abs(curve.angular_speed)

    design = known(fast_is_unknown)
    assert design.n_unknown > 0
    assert np.isnan(design.points_cv[design.points[:, 0] > 0.7]).all()
    assert design.values[0] <= 0.7
    with pytest.raises(ToleranceError, match="no pattern of the scan is known"):
        known(lambda curve: None)


def test_the_pattern_of_the_optimum_is_that_of_its_model():
    design = studies.design_nozzles(
        SWINGING, 0.5, spacing=4.0, bounds={"amplitude": (1.4, 1.42)}, n_scan=3,
        n_webs=0, tolerance=0.05,
    )  # fmt: skip
    pattern = fp.mean_pattern(design.model, spacing=4.0, tolerance=0.05)
    assert design.pattern_cv[0] == pattern.coefficient_of_variation(0.5)[0]
    assert design.model.curve.amplitude == design.values[0]
    assert np.isnan(design.z).all()


@pytest.mark.parametrize("phases", ["in phase", (0.0, 2.0)])
def test_what_two_laid_rows_share_is_the_pattern(phases):
    zone, spacing = 0.8, 4.0
    pattern = fp.mean_pattern(SWINGING, spacing=spacing, phases=phases, tolerance=0.01)
    value, error = pattern.coefficient_of_variation(zone)
    given = phases if isinstance(phases, str) else np.array(phases)
    squares, errors = laid_squares(SWINGING, np.array([zone]), spacing, given, 6, 3)
    away = squares[0, 0] - value**2
    # Student's distribution of six webs is beyond 6.9 once in a thousand.
    assert abs(away) < 6.9 * math.hypot(errors[0, 0], 2 * value * error)
    # A pattern that can be seen, and fibres that vary about it.
    assert value**2 > 3 * errors[0, 0]
    assert squares[1, 0] > squares[0, 0] + 3 * errors[1, 0]


def test_a_design_of_two_numbers_is_drawn(known, tmp_path):
    bounds = {"radius2": (0.5, 3.0), **OMEGA}
    design = known(lambda curve: 0.1 + curve.radius2, bounds, n_scan=3)
    figure = plotting.plot_nozzle_design(design)
    assert "radius" not in repr(figure.axes[0].get_xlabel())
    assert f"A = {design.model.noise:g}" in figure.get_suptitle()
    design.save(tmp_path / "nozzles.nc")
    again = fp.load(tmp_path / "nozzles.nc")
    assert again.names == design.names
    np.testing.assert_array_equal(again.points, design.points)
    assert repr(again) == repr(design)


def test_arguments_that_cannot_work_are_named():
    def refused(message, kind=ValueError, model=SWINGING, zones=1.0, **options):
        asked = {"spacing": 2.0, "bounds": OMEGA, **options}
        with pytest.raises(kind, match=message):
            studies.design_nozzles(model, zones, **asked)

    refused("got `|must be of one or two", bounds={})
    refused("got 'omega'.*OscillatingNozzle", bounds={"omega": (0.1, 1.0)})
    refused("got 'radius'", bounds={"radius": (0.1, 1.0)})
    three = {"radius1": (0.1, 1.0), "radius2": (0.1, 1.0), **OMEGA}
    refused("must be of one or two", model=TURNING, bounds=three)
    refused("must be a mapping", TypeError, bounds=[0.1, 1.0])
    refused(r"must be \(lowest, highest\)", bounds={"angular_speed": (1.0, 0.1)})
    refused("must be positive", bounds={"angular_speed": (0.0, 0.1)})
    refused("`zones` must be sides", zones=-1.0)
    refused("`zones` must be sides", zones=[])
    refused("`zones` must be finite", zones=math.nan)
    refused("`spacing` must be positive", spacing=math.nan)
    refused("got 'independent'", phases="independent")
    refused("`n_scan` must be", n_scan=2)
    refused("`n_webs` must be 0 or at least 2", n_webs=1)
    belt = replace(SWINGING, curve=fp.MovingBelt(0.1))
    refused("`curve` must be a nozzle that moves", model=belt)
