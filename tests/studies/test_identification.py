"""Identification by the functional: what is found of synthetic data, and its errors."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import plotting
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.goodness import compare_with_surrogate
from fpsolve.studies.identification.increments import Squares, lags_up_to
from fpsolve.studies.identification.quasi_newton import corrected
from fpsolve.studies.identification.sampling_error import bootstrap_covariance, larger

BELT = fp.MovingBelt(0.1)
POTENTIAL = fp.QuadraticPotential(1.0, 1.5)
MODELS = {
    "basic": fp.LayDownModel(POTENTIAL, 1.0, BELT),
    "smooth": fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0, BELT),
}
TRUE = {"sigma1": 1.0, "sigma2": 1.5, "noise": 1.0, "curvature_noise": 2.0}


@cache
def fibre(name, length=600.0, ds=0.1, seed=3):
    model, n = MODELS[name], round(length / ds) + 1
    paths = fp.sample_paths(
        model, 1, ds * (n - 1), ds / 4, seed=seed, save_at=ds * np.arange(n),
        initial=fp.paths.EquilibriumLaw(POTENTIAL),
    )  # fmt: skip
    return fp.FibreCurve.from_paths(paths)


@cache
def found(name, model):
    return fp.identify(fibre(name), model=model, method="functional", seed=1)


@pytest.mark.parametrize(
    "name", ["smooth", pytest.param("basic", marks=pytest.mark.nightly)]
)
def test_parameters_of_synthetic_data_are_found_within_their_errors(name):
    result = found(name, name)
    errors = result.standard_errors
    for parameter, value in result.parameters.items():
        # Four parameters of two models: beyond 3.5 standard errors one in 270 times.
        assert abs(value - TRUE[parameter]) < 3.5 * errors[parameter], parameter
        # And the errors say something: 600 σ are a hundred independent parts or more.
        assert errors[parameter] < 0.25 * value
    assert result.undetermined == {}
    for parameter, (low, high) in result.interval(0.9999).items():
        assert low < TRUE[parameter] < high


def test_a_true_model_is_not_rejected():
    # p-values of six tests of a true model, each at least 1/129.
    assert min(found("smooth", "smooth").p_values.values()) > 0.01


@pytest.mark.nightly
def test_the_basic_model_is_rejected_for_smooth_data():
    wrong = found("smooth", "basic").p_values
    # Fibres of the basic model have no curvature: no surrogate is as far off.
    assert wrong["curvature increments"] < 0.02


def test_bands_hold_the_mean_and_are_those_of_the_data_for_the_true_model():
    result = found("smooth", "smooth")
    for data, mean, low, high in (result.angle_bands, result.curvature_bands):
        assert np.all((low < mean) & (mean < high))
        # 95 % at every lag, all of which depend on each other.
        assert np.mean((low <= data) & (data <= high)) > 0.5


def test_an_identification_is_told_by_its_numbers_and_drawn_beside_others():
    smooth = found("smooth", "smooth")
    rough = replace(smooth, model=MODELS["basic"])
    assert "sigma1 = " in repr(smooth)
    assert len(plotting.plot_identified_fibres(smooth, rough).axes) == 3
    assert len(plotting.plot_increments(smooth, rough).axes) == 2
    assert smooth.aic is None
    assert replace(smooth, log_likelihood=-10.0).aic == 28.0


def test_an_interval_of_a_level_that_is_none_is_refused():
    with pytest.raises(ValueError, match="`level` must lie between 0 and 1"):
        found("smooth", "smooth").interval(1.0)


def test_an_interval_is_that_of_a_gaussian_logarithm():
    result = found("smooth", "smooth")
    low, high = result.interval(0.95)["noise"]
    z = 1.959963984540054 * result.standard_errors["noise"]
    value = result.parameters["noise"]
    assert np.log(high / low) == pytest.approx(2 * z / value, rel=1e-12)
    assert np.sqrt(low * high) == pytest.approx(value, rel=1e-12)


def test_an_interval_by_likelihood_is_the_one_whose_coverage_was_measured():
    result = replace(found("smooth", "smooth"), method="likelihood")
    value, error = result.parameters["sigma1"], result.standard_errors["sigma1"]
    low, high = result.interval(0.95)["sigma1"]
    # ± z errors of 1/σ², which is 2 error/σ³ to first order.
    z = 1.959963984540054 * 2 * error / value**3
    assert [low**-2, high**-2] == pytest.approx([value**-2 + z, value**-2 - z])
    # By the functional it is that of 1/σ, and without an upper end where that is not
    # told from zero.
    plain = found("smooth", "smooth").interval(0.95)["sigma1"]
    assert np.mean(np.reciprocal(plain)) == pytest.approx(1 / value)
    wide = replace(found("smooth", "smooth"), covariance=np.eye(4)).interval(0.95)
    assert wide["sigma1"][1] == np.inf


SHORT = fibre("smooth").eta[:200]


@pytest.mark.parametrize(
    ("given", "options", "error", "said"),
    [
        (SHORT, {}, ValueError, "`ds` must be given with points"),
        (SHORT, {"ds": 0.1}, ValueError, "`curve` must be known for deviations"),
        (SHORT, {"ds": 0.1, "curve": BELT}, ValueError, "at least 100 throwing ranges"),
        (fibre("smooth"), {"ds": 0.1}, ValueError, "must not be given with a fibre"),
        (fibre("smooth"), {"model": "rough"}, ValueError, "`model` must be one of"),
        (fibre("smooth"), {"method": "eye"}, ValueError, "`method` must be one of"),
        (fibre("smooth"), {"k_max": 601}, ValueError, "a tenth of the points"),
        (fibre("smooth"), {"seed": -1}, ValueError, "`seed` must be at least 0"),
        ("a fibre", {"ds": 0.1}, TypeError, "`eta` must hold real numbers"),
    ],
)
def test_what_cannot_be_identified_is_refused(given, options, error, said):
    with pytest.raises(error, match=said):
        fp.identify(given, **{"method": "functional", **options})


def test_a_direction_in_which_nothing_changes_is_not_followed():
    # The second parameter moves nothing: its slope is noise.
    step = corrected(np.array([[1.0, 0.0], [0.0, 1e-3]]), np.array([0.1, 0.1]))
    np.testing.assert_allclose(step, [0.1, 0.0], atol=1e-15)
    far = corrected(np.eye(2), np.array([3.0, -3.0]))
    np.testing.assert_allclose(far, [0.5, -0.5])


def test_the_larger_of_two_covariances_keeps_correlations():
    first, other = np.array([[4.0, 1.0], [1.0, 1.0]]), np.diag([1.0, 9.0])
    both = larger(first, other)
    np.testing.assert_allclose(np.diag(both), [4.0, 9.0])
    assert both[0, 1] / 6.0 == pytest.approx(1.0 / 2.0)
    assert larger(first, None) is first


def test_the_bootstrap_has_the_spread_of_surrogates():
    data, lags = fibre("smooth"), lags_up_to(10)
    known = Estimate(TRUE, np.diag([1e-4] * 4), MODELS["smooth"])
    drawn = bootstrap_covariance(data, lags, 1)
    surrogates = compare_with_surrogate(data, known, lags, 2).surrogates
    log_sigma = 0.5 * np.log(surrogates.xi[2:4])
    # 40 blocks of 15 σ, which forget each other: their spread is known to 11 %, that of
    # 128 surrogates to 6 %; in squares twice that, and three standard errors of it.
    ratio = np.diag(drawn)[:2] / log_sigma.var(axis=1, ddof=1)
    assert np.all((ratio > 0.3) & (ratio < 1.9))


def test_means_of_all_fibres_are_pooled():
    many = Squares(np.arange(10.0).reshape(5, 2), np.ones((3, 2)), np.ones((3, 2)))
    np.testing.assert_allclose(many.pooled().xi[:, 0], np.arange(5) * 2 + 0.5)


@pytest.mark.nightly
def test_by_likelihood_the_true_model_has_the_smaller_aic():
    data = fibre("smooth")
    smooth, basic = (fp.identify(data, model=name) for name in ("smooth", "basic"))
    assert smooth.method == "likelihood"
    for parameter, value in smooth.parameters.items():
        error = smooth.standard_errors[parameter]
        # One of four beyond 3.5 standard errors once in 500 times.
        assert abs(value - TRUE[parameter]) < 3.5 * error, parameter
    assert smooth.aic == pytest.approx(8 - 2 * smooth.log_likelihood)
    # Smooth fibres of R = 5 Δs do not look like rough ones: far more than by chance.
    assert smooth.aic < basic.aic - 100
    assert min(smooth.p_values.values()) > 0.01


@pytest.mark.nightly
def test_below_a_nozzle_and_with_scattered_points_errors_hold():
    nozzle = fp.RotatingNozzle(0.1, 2.0, 0.2, 0.4)
    model = fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0, nozzle)
    paths = fp.sample_paths(
        model, 1, 800.0, 0.025, seed=5, save_at=0.1 * np.arange(8001),
        initial=fp.paths.EquilibriumLaw(POTENTIAL),
    )  # fmt: skip
    scatter = 0.01 * np.random.default_rng(5).standard_normal((8001, 2))
    eta = paths.eta[:, 0] + scatter
    data = fp.FibreCurve(eta, 0.1, nozzle, position_error=0.01)
    result = fp.identify(data, method="functional", seed=2)
    for parameter, value in result.parameters.items():
        # One of four beyond 3.5 standard errors once in 500 times.
        error = result.standard_errors[parameter]
        assert abs(value - TRUE[parameter]) < 3.5 * error, parameter
