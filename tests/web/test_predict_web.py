"""Predicted webs: quadrature with known answers, laws of webs, and paths."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import erf

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent.fibre import fibre_of
from fpsolve.web import coherent, predict
from fpsolve.web.band_power import band_power
from fpsolve.web.even import EvenNodes
from fpsolve.web.table import AXES, N_NODES, Source, SpectrumTable
from fpsolve.web.zone_variance import window_integrals, zone_variance

ISOTROPIC = fp.QuadraticPotential()
BELT = fp.LayDownModel(ISOTROPIC, 2.0, fp.MovingBelt(0.2))
SLOW = fp.LayDownModel(ISOTROPIC, 2.0, fp.MovingBelt(1e-6))
STRAIGHT = 4 / math.pi * (math.log(1 + math.sqrt(2)) + (1 - math.sqrt(2)) / 3)


class GaussianSource(Source):
    """Ŝ = e^{−|k|²/2} in place of that of a fibre."""

    def __call__(self, k1, k2):
        return np.exp(-0.5 * (k1**2 + k2**2)), np.zeros(k1.shape)


class GaussianTable(SpectrumTable):
    """Its table; κ Ŝ → 0."""

    def _law(self, k1, k2):
        return np.zeros(k1.shape)


@pytest.fixture(scope="module")
def gaussian():
    ladder = fibre_of(BELT)
    table = SpectrumTable.of(ladder, 1e-3)
    made = GaussianTable(GaussianSource(ladder, 1e-12), table.nodes)
    return made.finer("along").finer("shortness").finer("shortness")


@pytest.fixture(scope="module")
def prediction():
    zones = [0.01, 0.5, 1.0, 2.0]
    bands = [(0.5, 2.0), (2.0, 8.0), (0.5, 8.0)]
    return fp.predict_web(BELT, spacing=0.5, zones=zones, bands=bands, tolerance=0.01)


@pytest.mark.parametrize("scale", [0.05, 1.0])
def test_even_polynomials_converge_geometrically(scale):
    """For 1/(0.09 + k²) each doubling of the nodes at least squares the error."""
    k = np.linspace(0, 1, 301)
    errors = []
    for n in (9, 17, 33):
        nodes = EvenNodes(1.0, scale, n)
        values = 1 / (0.09 + nodes.points**2)
        errors.append(np.abs(nodes.at(k) @ values * (0.09 + k**2) - 1).max())
    assert errors[2] < 1e-5
    assert errors[1] < errors[0] / 4
    # A constant and k² are two of the polynomials where the map is linear.
    nodes = EvenNodes(1.0, 1e6, 5)
    assert nodes.at(k) @ nodes.points**2 == pytest.approx(k**2, abs=1e-9)
    assert set(nodes.points) <= set(nodes.finer().points)


def test_the_window_of_a_zone_has_the_integral_of_its_side():
    """∫₀^∞ sinc²(k x/2) dk = π/x; of the tail 2/(x² K) is left, to 1/(K x)²."""
    for side in (0.3, 40.0):
        _, weights = window_integrals(side, 0.0, 500 / side)
        left = 2 / (side**2 * 500 / side)
        assert weights.sum() + left == pytest.approx(math.pi / side, rel=1e-5)


@pytest.mark.parametrize("side", [0.05, 0.5, 2.0, 20.0])
def test_zones_of_a_gaussian_spectrum_have_their_exact_variance(gaussian, side):
    """In space: E (1 − |r|/x)₊/x of a normal r along each axis."""
    normal = math.exp(-0.5 * side**2) - 1
    mean = erf(side / math.sqrt(2)) / side + 2 * normal / (
        side**2 * math.sqrt(2 * math.pi)
    )
    value, changes, _ = zone_variance(gaussian, side)
    # Of Ŝ = e^{−k²/2} itself 4 % lie outside the rectangle, where polynomials of 1/κ
    # converge slowly to what is flat at 0.
    assert value == pytest.approx(mean**2, rel=2e-4)
    assert abs(value - mean**2) <= sum(changes.values()) + 1e-9


def test_bands_of_a_gaussian_spectrum_have_their_exact_power(gaussian):
    """∫ k e^{−k²/2} dk/2π between 2π/longest and 2π/shortest."""
    low, high = 0.5, 4.0
    exact = (math.exp(-0.5 * low**2) - math.exp(-0.5 * high**2)) / (2 * math.pi)
    power, error = band_power(gaussian, 2 * math.pi / low, 2 * math.pi / high)
    assert power == pytest.approx(exact, rel=2e-3)
    assert abs(power - exact) <= error


def test_a_slow_belt_leaves_the_strips_of_a_gaussian_law():
    """φ(0, k2) = e^{−k2²/2} at rest: strips 2 e^{−2π²/d²}, and Jacobi's identity."""
    ladder, spacing = fibre_of(SLOW), 3.0
    amplitudes, errors = coherent.strips(ladder, spacing, 3)
    exact = 2 * np.exp(-2 * math.pi**2 * np.arange(1, 4) ** 2 / spacing**2)
    # The belt changes the law by O(v²).
    assert np.abs(amplitudes - exact) == pytest.approx(0, abs=1e-6)
    assert (errors <= 1e-6).all()
    # Zones of no size see every strip whole: Σ 2 e^{−(2πj/d)²}.
    variance, _ = coherent.regular_positions(ladder, spacing, 1e-6)
    assert variance == pytest.approx(float((exact**2).sum() / 2), rel=1e-6)
    # Poisson's sum: 1 + 2 Σ |φ(2πj/d)|² = d Σ of the law of ξ2 − ξ2' at the positions.
    j = np.arange(-6, 7)
    law = np.exp(-((j * spacing) ** 2) / 4) / math.sqrt(4 * math.pi)
    assert 1 + variance == pytest.approx(spacing * law.sum(), rel=1e-6)
    # Random ones: d ∫ |φ|² dk2/2π is the term j = 0 of that sum.
    single, _ = coherent.random_positions(ladder, spacing, 1e-6)
    assert single == pytest.approx(spacing * law[6], rel=1e-6)


def test_small_zones_see_straight_fibres(prediction):
    """CV² → 0.946402 v d/x up to O(x), the anisotropy O(v²) of the angle, and 1 %."""
    assert pytest.approx(0.946402, abs=1e-6) == STRAIGHT
    assert prediction.cv[0] / prediction.small_zone_law()[0] == pytest.approx(
        1, abs=0.015
    )


@pytest.mark.nightly
def test_cv_goes_with_the_root_of_the_spacing():
    """Exactly, but for the strips, which fine spacing has not."""
    options = {"zones": [0.5, 2.0], "tolerance": 0.05}
    fine, coarse = (fp.predict_web(BELT, spacing=d, **options) for d in (0.1, 0.4))
    assert coarse.cv == pytest.approx(2 * fine.cv, rel=1e-9)
    assert coarse.mean == pytest.approx(1 / (0.2 * 0.4))


def test_a_process_is_predicted_in_metres(prediction):
    """σ = 4 mm: the same numbers for lengths that are so much shorter."""
    process = fp.Process(4e-3, 4e-3, 2.0 / math.sqrt(4e-3), 0.2, 20.0)
    web = fp.predict_web(process, spacing=2e-3, zones=4e-3 * prediction.zones[1:],
                         bands=[(2e-3, 8e-3)], tolerance=0.02)  # fmt: skip
    away = np.abs(web.cv - prediction.cv[1:])
    assert (away <= web.errors + prediction.errors[1:]).all()
    assert web.cloudiness[0] == pytest.approx(prediction.cloudiness[0], rel=0.02)
    assert web.mean == pytest.approx(1 / (0.2 * 2e-3))
    assert web.length == 4e-3


def test_bands_add_up(prediction):
    first, second, both = prediction.cloudiness
    errors = prediction.cloudiness_errors
    assert abs(first + second - both) <= errors.sum()
    assert both == pytest.approx(first + second, rel=1e-4)


def test_tolerances_cover_the_distance_to_finer_predictions(prediction):
    coarse = fp.predict_web(BELT, spacing=0.5, zones=prediction.zones, tolerance=0.05)
    assert (coarse.errors <= 0.05 * coarse.cv).all()
    assert (
        np.abs(coarse.cv - prediction.cv) <= coarse.errors + prediction.errors
    ).all()


def test_a_belt_that_runs_backwards_lays_the_same_web():
    backwards = replace(BELT, curve=fp.MovingBelt(-0.2))
    k1, k2 = np.array([0.0, 0.7, 2.0, 5.0]), np.array([1.0, 0.7, 1.5, 3.0])
    there, back = (fp.web_spectrum(model, k1, k2) for model in (BELT, backwards))
    assert np.asarray(back) == pytest.approx(np.asarray(there), rel=1e-9)


def test_zones_of_simulated_fibres_agree_within_standard_errors(prediction):
    """CV² = v d ∫ ds E K_x(η_s − η_0) less the same for independent fibres.

    K_x is the overlap of two zones, ξ of another path at the same lag stands for the
    independent copy; strips of d = 0.5 have an amplitude below 1e-30.
    """
    v, spacing, side, ds, steps, n = 0.2, 0.5, 1.0, 1 / 16, 1600, 1600
    s = 15.0 + ds * np.arange(steps)
    initial = EquilibriumLaw(ISOTROPIC)
    paths = fp.sample_paths(BELT, n, s[-1], ds, seed=11, initial=initial, save_at=s)
    xi1, xi2 = np.moveaxis(np.asarray(paths.xi), 2, 0)
    begins = np.arange(0, steps - 800, 80)
    variance = np.zeros(n)
    for lag in range(800):
        weight = ds * (1 if lag == 0 else 2)
        same, other = (
            overlap(xi1[begins + lag][:, of] - xi1[begins] - v * lag * ds, side)
            * overlap(xi2[begins + lag][:, of] - xi2[begins], side)
            for of in (np.arange(n), np.roll(np.arange(n), 1))
        )
        variance += weight * (same - other).mean(axis=0)
    estimate, error = variance.mean(), variance.std(ddof=1) / math.sqrt(n)
    expected = prediction.cv[2] ** 2 / (v * spacing)
    # The lag 50 lays the fibre 10 σ further; ds = 1/16 is one in 16 of the zone.
    assert estimate == pytest.approx(expected, abs=3 * error)
    assert error < 0.03 * expected


@pytest.mark.nightly
def test_laid_webs_of_a_quartic_potential_vary_as_predicted():
    """Of one web of 160 by 40, with the standard errors of its blocks."""
    model = fp.LayDownModel(fp.PowerPotential(4), 2.0, fp.MovingBelt(0.2))
    zones = np.array([0.5, 1.0, 2.0])
    prediction = fp.predict_web(model, spacing=0.25, zones=zones, tolerance=0.02)
    web = fp.lay_web(model, width=40.0, length=160.0, spacing=0.25, pixel=0.25,
                     seed=3, ds=1 / 32)  # fmt: skip
    for zone, cv, error in zip(zones, prediction.cv, prediction.errors, strict=True):
        laid = web.coefficient_of_variation(float(zone))
        off = abs(float(laid) - cv)
        assert off <= 3 * math.hypot(laid.standard_error, error)


def overlap(distance, side):
    return np.maximum(0.0, 1.0 - np.abs(distance) / side) / side


def test_orientation_is_that_of_the_paths(prediction):
    s = np.arange(20.0, 60.0, 4.0)
    initial = EquilibriumLaw(ISOTROPIC)
    paths = fp.sample_paths(
        BELT, 4000, s[-1], 0.125, seed=2, initial=initial, save_at=s
    )
    cosines = np.cos(2 * np.asarray(paths.alpha)).mean(axis=0)
    error = cosines.std(ddof=1) / math.sqrt(cosines.size)
    expected = prediction.orientation[0, 0] - prediction.orientation[1, 1]
    assert cosines.mean() == pytest.approx(expected, abs=3 * error)
    assert np.trace(prediction.orientation) == pytest.approx(1, abs=1e-14)
    assert prediction.machine_cross_ratio > 1


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"spacing": 0.0}, ValueError, "`spacing` must be positive"),
        ({"spacing": math.nan}, ValueError, "`spacing` must be positive"),
        ({"zones": []}, ValueError, "`zones` must name a side"),
        ({"zones": [1.0, -1.0]}, ValueError, "`zones` must lie between"),
        ({"zones": math.nan}, ValueError, "`zones` must be finite"),
        ({"positions": "staggered"}, ValueError, "`positions` must be one of"),
        ({"bands": [(2.0, 1.0)]}, ValueError, "`bands` must be pairs"),
        ({"bands": [1.0, 2.0]}, ValueError, "`bands` must be pairs"),
        ({"tolerance": 0.0}, ValueError, "`tolerance` must be positive"),
        ({"model": fp.LayDownModel(ISOTROPIC, 1.0)}, ValueError, "a belt in motion"),
        (
            {"model": fp.LayDownModel(ISOTROPIC, 0.0, fp.MovingBelt(0.1))},
            ValueError,
            "`noise` must be positive",
        ),
        ({"model": "web"}, TypeError, "`model` must be a LayDownModel"),
    ],
)
def test_what_is_no_web_is_refused(change, error, words):
    arguments = {"model": BELT, "spacing": 0.5, "zones": 1.0} | change
    with pytest.raises(error, match=words):
        fp.predict_web(arguments.pop("model"), **arguments)


def test_a_table_that_is_not_fine_enough_is_refused(monkeypatch):
    monkeypatch.setattr(predict, "MOST_NODES", 3)
    for axis in AXES:
        monkeypatch.setitem(N_NODES, axis, 4)
    with pytest.raises(ToleranceError, match="raise `tolerance`") as raised:
        fp.predict_web(BELT, spacing=0.5, zones=0.01, tolerance=0.02)
    assert raised.value.reached > 0.02
