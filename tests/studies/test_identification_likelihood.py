"""Parameters by the likelihood of chord angles: estimates and their errors."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.studies.identification.bootstrap import bootstrapped, replicas
from fpsolve.studies.identification.chord_law import Parameters
from fpsolve.studies.identification.chords import chords_of
from fpsolve.studies.identification.coordinates import interval
from fpsolve.studies.identification.determined import loose_strengths
from fpsolve.studies.identification.likelihood import Likelihood
from fpsolve.studies.identification.likelihood_basic import (
    basic_maximum,
    estimate_basic,
)
from fpsolve.studies.identification.likelihood_smooth import (
    estimate_smooth,
    smooth_maximum,
)
from fpsolve.studies.identification.synthetic import laid_fibres

BELT = fp.MovingBelt(0.3)
POTENTIAL = fp.QuadraticPotential(1.0, 0.7)
BASIC = fp.LayDownModel(POTENTIAL, 1.0, BELT)
SMOOTH = fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0, BELT)
TRUTH = {"sigma1": 1.0, "sigma2": 0.7, "noise": 1.0, "curvature_noise": 2.0}


def curves(model, n_fibres, length, ds, seed, position_error=0.0):
    n_points = round(length / ds) + 1
    eta = laid_fibres(
        model, n_fibres, n_points, ds, seed=seed, position_error=position_error
    )
    return [
        fp.FibreCurve(one, ds, model.curve, position_error=position_error)
        for one in eta
    ]


@pytest.fixture(scope="module")
def basic_curves():
    return curves(BASIC, 6, 400.0, 0.2, 11)


@pytest.fixture(scope="module")
def smooth_curves():
    return curves(SMOOTH, 6, 400.0, 0.2, 12)


def scores(estimate):
    """(found - true)/(standard error) where the likelihood is even."""
    errors = np.sqrt(np.diagonal(estimate.covariance))
    found = []
    for (name, value), error in zip(estimate.parameters.items(), errors, strict=True):
        if name.startswith("sigma"):
            found.append((value**-2 - TRUTH[name] ** -2) / (2 * value**-3 * error))
        else:
            found.append(math.log(value / TRUTH[name]) * value / error)
    return found


def test_the_force_changes_with_the_chord_as_its_slope_says(smooth_curves):
    curve = smooth_curves[0]
    eta, xi = curve.pieces[0][:6], curve.deviations[0][:6]
    gamma, turn = eta - xi, 1e-5
    turned = []
    for angle in (-turn, turn):
        c, s = math.cos(angle), math.sin(angle)
        moved = eta.copy()
        moved[5] = eta[4] + np.array([[c, -s], [s, c]]) @ (eta[5] - eta[4])
        turned.append(chords_of(moved, gamma, curve.ds))
    exact = chords_of(eta, gamma, curve.ds)
    names = (
        ("forces", "slopes"),
        ("bending", "bending_slopes"),
        ("drift", "drift_slopes"),
    )
    for name, slope in names:
        before, after = (getattr(one, name)[4] for one in turned)
        # Differences of order 2 over 1e-5.
        difference = (after - before) / (2 * turn)
        assert getattr(exact, slope)[4] == pytest.approx(difference, rel=1e-6, abs=1e-8)


def test_the_basic_law_is_the_limit_of_the_smooth_one(basic_curves):
    likelihood = Likelihood.of(basic_curves[0])
    at = (1.0, 2.0, math.log(1.1))
    basic = likelihood(np.array(at))
    lengths = (4e-4, 1e-4, 1e-6)
    away = [abs(likelihood(np.array([*at, math.log(R)])) - basic) for R in lengths]
    # Of first order in R/Δs, beside what lower orders of the first chord leave.
    assert away[1] < 0.5 * away[0]
    assert away[2] < 0.02 * away[0]
    assert away[0] < 0.1


def test_several_fibres_are_as_likely_as_each_by_itself(smooth_curves):
    both = fp.FibreCurve([one.eta for one in smooth_curves[:2]], 0.2, BELT)
    at = np.array([1.0, 2.0, 0.1, -0.6])
    parts = [Likelihood.of(one)(at) for one in smooth_curves[:2]]
    assert Likelihood.of(both)(at) == pytest.approx(sum(parts), rel=1e-13)


@pytest.mark.parametrize("which", ["basic", "smooth"])
def test_true_parameters_are_within_what_the_errors_say(
    which, basic_curves, smooth_curves
):
    smooth = which == "smooth"
    estimate, data = (
        (estimate_smooth, smooth_curves) if smooth else (estimate_basic, basic_curves)
    )
    z = np.array([scores(estimate(curve)) for curve in data])
    # Six fibres: a mean of 3.5/√6, and the bias of Δs = 0.2, a quarter of an error.
    assert np.abs(z.mean(axis=0)).max() < 3.5 / math.sqrt(6) + 0.25
    # χ² of 6 degrees beyond 24.1 comes once in 2000, below 0.2 as well.
    squares = (z**2).sum(axis=0)
    assert squares.min() > 0.2
    assert squares.max() < 24.1


def test_errors_are_those_of_the_expected_information(basic_curves):
    curve = basic_curves[0]
    found = estimate_basic(curve)
    n = len(curve.eta) - 2
    error = math.sqrt(found.covariance[2, 2]) / found.parameters["noise"]
    # Cramér-Rao: a variance of n Gaussian numbers. The force depends on A by the
    # Jacobian only.
    assert error == pytest.approx((2 * n) ** -0.5, rel=0.03)
    # Of 1/σ², A²/∫f² ds: both forces together, which are nearly orthogonal.
    forces = Likelihood.of(curve).fibres[0].forces
    bound = np.linalg.inv(curve.ds * forces.T @ forces) * found.parameters["noise"] ** 2
    slope = np.diag(
        [-0.5 * found.parameters[name] ** 3 for name in ("sigma1", "sigma2")]
    )
    expected = np.sqrt(np.diagonal(slope @ bound @ slope))
    observed = np.sqrt(np.diagonal(found.covariance)[:2])
    # Chord by chord the sums are means over two, which lose O(Δs²) of the force.
    assert observed == pytest.approx(expected, rel=0.1)


def test_innovations_are_white(smooth_curves):
    likelihood = Likelihood.of(smooth_curves[1])
    at = Parameters((1.0, 0.7**-2), 1.0, 0.5)
    z = likelihood.densities(at)[0]
    n = len(z)
    assert abs(z.mean()) < 3.5 / math.sqrt(n)
    assert abs(z.var() - 1) < 3.5 * math.sqrt(2 / n)
    for lag in (1, 2, 3):
        assert abs(np.mean(z[lag:] * z[:-lag])) < 3.5 / math.sqrt(n)


def test_the_beginning_of_a_fibre_is_as_likely_as_the_rest():
    # What is known of κ before the first chord: its spread by noise and by force, the
    # latter the larger one here. Without it the first innovations reach 10.
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 5.0, 2.0, BELT)
    at = Parameters((1.0, 1.0), 2.0, 5.0)
    first = np.array(
        [
            Likelihood.of(one).densities(at)[0, 0]
            for one in curves(model, 24, 5.0, 0.1, 2)
        ]
    )
    # 24 squares of normal numbers.
    assert np.mean(first**2) < 1 + 3.5 * math.sqrt(2 / 24)


def test_likelihoods_choose_the_model_that_made_the_fibre(basic_curves, smooth_curves):
    smooth, basic = (f(smooth_curves[0]) for f in (estimate_smooth, estimate_basic))
    # Of smooth fibres by hundreds; of basic ones a parameter more is worth about ½.
    assert smooth.log_likelihood > basic.log_likelihood + 100
    smooth, basic = (f(basic_curves[0]) for f in (estimate_smooth, estimate_basic))
    assert -0.1 < smooth.log_likelihood - basic.log_likelihood < 5


def test_a_relaxation_length_below_the_distance_of_points_is_left_open(basic_curves):
    found = estimate_smooth(basic_curves[0])
    assert "take points closer together" in found.undetermined["curvature_noise"]
    assert set(found.undetermined) == {"curvature_noise"}
    assert np.isfinite(found.covariance[:3, :3]).all()


def test_of_a_relaxation_length_beyond_the_fibre_only_the_curvature_noise_is_known():
    # A fibre of two relaxation lengths: R and A = RK are known to a factor, K is. It
    # goes so far that filters of short lengths, tried first, have no digits left.
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 50.0, 25.0, BELT)
    found = estimate_smooth(curves(model, 3, 100.0, 0.1, 6)[1])
    assert "known to a factor only" in found.undetermined["noise"]
    assert "curvature_noise" not in found.undetermined
    error = math.sqrt(found.covariance[3, 3])
    assert error < 0.03
    assert abs(found.parameters["curvature_noise"] - 0.5) < 3.5 * error


def test_a_short_noisy_fibre_does_not_determine_the_throwing_range():
    # Standard errors of 1/σ² are A√(2/L) = 2 here, and 1/σ² is 1.
    model = fp.LayDownModel(fp.QuadraticPotential(), 6.0)
    maxima = [
        basic_maximum(Likelihood.of(one)) for one in curves(model, 6, 18.0, 0.012, 3)
    ]
    open_ = set()
    for found in maxima:
        errors = np.sqrt(np.diagonal(found.covariance()))
        reasons = loose_strengths(found.at[:2], errors[:2], 18.0)
        open_ |= set(reasons)
        assert all("is not told from 0" in reason for reason in reasons.values())
    assert open_ == {"sigma1", "sigma2"}


def test_a_fibre_that_is_driven_away_is_refused():
    # dα = +∇B·τ⊥ ds + dW: every range the square root of a negative number.
    rng, ds, alpha, xi = np.random.default_rng(8), 0.02, 0.0, np.array([1.0, 1.0])
    eta = [xi]
    for noise in rng.standard_normal(400):
        alpha += ds * (xi[1] * math.cos(alpha) - xi[0] * math.sin(alpha))
        alpha += 0.3 * math.sqrt(ds) * noise
        xi = xi + ds * np.array([math.cos(alpha), math.sin(alpha)])
        eta.append(xi)
    driven = fp.FibreCurve(np.array(eta), ds, fp.FixedBelt())
    with pytest.raises(ValueError, match="must show that the fibre is drawn back"):
        estimate_basic(driven)


def test_errors_of_points_are_told_from_the_noise_of_the_fibre():
    # 0.005 of points 0.2 apart: angles of chords scatter by 0.035, their increments by
    # √6 · 0.025 = 0.06, beside 0.2 of the fibre itself.
    (curve,) = curves(SMOOTH, 1, 400.0, 0.2, 21, position_error=0.005)
    told = estimate_smooth(curve)
    assert np.abs(scores(told)).max() < 3.5
    # Taken as exact, the scatter is curvature that relaxes at once. Such a curve is
    # refused, for its chords are longer than Δs; the likelihood itself does not know.
    untold = smooth_maximum(Likelihood(Likelihood.of(curve).fibres, curve.ds))
    length = told.parameters["noise"] / told.parameters["curvature_noise"]
    assert math.exp(untold.at[3]) < 0.8 * length


def test_unknown_reference_curves_and_coarse_points_are_refused(basic_curves):
    with pytest.raises(ValueError, match="`curve` must be known"):
        estimate_basic(fp.FibreCurve(basic_curves[0].eta, 0.2))
    with pytest.raises(TypeError, match="`curve` must be a FibreCurve"):
        estimate_smooth(basic_curves[0].eta)
    coarse = fp.FibreCurve(basic_curves[0].eta[::4], 0.8, BELT)
    with pytest.raises(ValueError, match="the angle cannot be unwrapped"):
        estimate_basic(coarse)


def test_intervals_are_even_where_the_likelihood_is():
    low, high = interval("sigma1", 1.0, 0.1, 1.96)
    assert low**-2 - 1 == pytest.approx(1 - high**-2) == pytest.approx(2 * 0.196)
    assert interval("sigma2", 1.0, 0.3, 1.96)[1] == math.inf
    low, high = interval("noise", 2.0, 0.2, 1.0)
    assert low * high == pytest.approx(4.0)
    assert high == pytest.approx(2 * math.exp(0.1))


def test_the_bootstrap_finds_the_errors_of_the_likelihood(basic_curves):
    found = estimate_basic(basic_curves[1])
    again = bootstrapped(found, basic_curves[1], estimate_basic, 24, seed=4)
    ratio = np.sqrt(np.diagonal(again.covariance) / np.diagonal(found.covariance))
    # A standard deviation of 24 numbers is good to 0.15 of itself; 3.5 of these.
    assert ratio == pytest.approx(np.ones(3), abs=0.53)
    drawn, same = (replicas(found, basic_curves[1], 2, seed=4) for _ in range(2))
    for one, other in zip(drawn, same, strict=True):
        assert np.array_equal(one.eta, other.eta)
    with pytest.raises(ValueError, match="`n` must be at least 10"):
        bootstrapped(found, basic_curves[1], estimate_basic, 3, seed=1)
