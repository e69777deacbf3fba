"""Errors of identified parameters in predicted webs: slopes against parameters."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from known_identifications import known_identification
from web_numbers import NUMBERS, choose_few_nodes, choose_one_truncation, model_of

import fpsolve as fp
from fpsolve.web.prediction import WebPrediction
from fpsolve.web.table import AXES, N_NODES

NOISE, SPEED, SIGMA1, SIGMA2, SPACING = NUMBERS.tolist()
PARAMETERS = {"sigma1": SIGMA1, "sigma2": SIGMA2, "noise": NOISE}
FOUND = known_identification(model_of(NUMBERS))
COVARIANCE = FOUND.covariance
SPREAD = np.sqrt(np.diag(COVARIANCE))
ZONES = [0.3, 4.0]


def identified(covariance=COVARIANCE, **changes):
    return replace(FOUND, covariance=covariance, **changes)


def cv_of(sigma1, sigma2, noise):
    """Of a web whose variation is known."""
    return np.array(
        [0.2 * noise**0.3 / np.sqrt(sigma1 * sigma2), 0.1 * np.exp(-noise) * sigma2]
    )


@pytest.fixture
def web():
    small, large = cv_of(*PARAMETERS.values())
    slopes = np.array([
        [0.3 * small / NOISE, -large], [0.0, 0.0], [-0.5 * small / SIGMA1, 0.0],
        [-0.5 * small / SIGMA2, large / SIGMA2], [0.0, 0.0],
    ])  # fmt: skip
    none, two = np.zeros(0), np.zeros(2)
    return WebPrediction(
        model_of(NUMBERS), SPACING, 1.0, "random", np.array(ZONES),
        np.array([small, large]), two, none, none, none, none, none, none, np.eye(2),
        np.zeros((2, 2)), ("noise", "belt_speed", "sigma1", "sigma2", "spacing"),
        slopes, np.zeros((5, 2)),
    )  # fmt: skip


def test_carried_errors_are_those_of_drawn_parameters(web):
    drawn = np.random.default_rng(5).multivariate_normal(
        list(PARAMETERS.values()), COVARIANCE, 20_000
    )
    spread = np.std(cv_of(*drawn.T), axis=1)
    # The spread of 20000 numbers has an error of 1/√40000, three of which are 1.5 %;
    # the second order over 0.08 of A, where CV goes with e^(-A), is 0.08².
    np.testing.assert_allclose(identified().cv_errors(web), spread, rtol=0.022)


def test_carried_errors_are_stored_with_the_prediction(web, tmp_path):
    carried = identified().carry_errors(web)
    np.testing.assert_array_equal(carried.carried_errors, identified().cv_errors(web))
    assert web.carried_errors is None
    np.testing.assert_array_equal(
        carried.to_xarray().carried_error, carried.carried_errors
    )
    loaded = fp.load(carried.save(tmp_path / "prediction.nc"))
    np.testing.assert_array_equal(loaded.carried_errors, carried.carried_errors)
    assert fp.load(web.save(tmp_path / "without.nc")).carried_errors is None
    page = fp.report(carried, tmp_path / "page.html").read_text("utf-8")
    assert "by those of the identified parameters" in page
    assert f"{carried.carried_errors[1]:.2g}" in page


def test_errors_of_the_slopes_make_carried_errors_larger(web):
    wrong = 0.1 * np.abs(web.gradient)
    sure, unsure = (
        identified().cv_errors(one)
        for one in (web, replace(web, gradient_errors=wrong))
    )
    # Each slope may be off by a tenth in either direction.
    signs = np.array(list(product([-1, 1], repeat=5)))
    worst = [
        identified().cv_errors(replace(web, gradient=web.gradient + one * wrong))
        for one in signs[:, :, None]
    ]
    assert (unsure >= np.max(worst, axis=0)).all()
    assert (unsure <= 1.5 * sure).all()


def predicted(values, tolerance=0.02, **options):
    sigma1, sigma2, noise = values
    return fp.predict_web(
        model_of([noise, SPEED, sigma1, sigma2]), spacing=SPACING, zones=ZONES,
        tolerance=tolerance, **options,
    )  # fmt: skip


@pytest.mark.nightly
def test_carried_errors_are_half_the_spread_of_opposite_parameters():
    """√Σ of ((CV(θ + L) − CV(θ − L))/2)² over the columns L of √Σ."""
    values = np.array(list(PARAMETERS.values()))
    halves = [
        0.5 * (predicted(values + one).cv - predicted(values - one).cv)
        for one in np.linalg.cholesky(COVARIANCE).T
    ]
    expected = np.sqrt(np.sum(np.square(halves), axis=0))
    web = predicted(values, gradients=True)
    carried = identified().cv_errors(web)
    # Of third order over 4 per cent, a few times 0.04².
    assert (carried >= 0.99 * expected).all()
    # What was added for errors of the slopes holds what they are.
    slack = SPREAD @ web.gradient_errors[[2, 3, 0]]
    assert (carried - expected <= 2 * slack + 0.01 * expected).all()


@pytest.mark.nightly
def test_carried_errors_are_those_of_predictions_of_drawn_parameters(monkeypatch):
    choose_few_nodes(monkeypatch)
    values = list(PARAMETERS.values())
    drawn = np.random.default_rng(7).multivariate_normal(values, COVARIANCE, 40)
    # Between few nodes CV of large zones is not known well enough.
    found = np.array([predicted(one, 0.5).cv[0] for one in drawn])
    web = predicted(values, 0.5, gradients=True)
    linear = drawn @ web.gradient[[2, 3, 0], 0]
    # What CV does beyond its slopes is a twentieth, the largest relative error.
    assert np.std(found) == pytest.approx(np.std(linear), rel=0.05)
    slack = SPREAD @ web.gradient_errors[[2, 3, 0], 0]
    carried = identified().cv_errors(web)[0] - slack
    # The standard deviation of 40 Gaussian numbers has an error of 1/√78.
    assert np.std(found, ddof=1) == pytest.approx(carried, rel=3 / np.sqrt(78))


def test_carried_errors_are_proportional_to_those_of_the_parameters(web):
    twice = identified(4 * COVARIANCE).cv_errors(web)
    np.testing.assert_allclose(twice, 2 * identified().cv_errors(web), rtol=1e-12)


def test_carried_errors_do_not_know_the_unit_of_length(web):
    """σ in metres, A in m^-1/2 and a prediction of the process: the same."""
    unit = 5e-3
    factors = np.array([unit, unit, unit**-0.5])
    values = dict(zip(PARAMETERS, factors * [*PARAMETERS.values()], strict=True))
    covariance = factors[:, None] * COVARIANCE * factors
    found = identified(covariance, parameters=values)
    scale = np.array([unit**-0.5, 1.0, unit, unit, unit])[:, None]
    metres = replace(
        web, length=unit, gradient=web.gradient / scale,
        gradient_errors=web.gradient_errors / scale,
    )  # fmt: skip
    expected = identified().cv_errors(web)
    np.testing.assert_allclose(found.cv_errors(metres), expected, rtol=1e-12)


SMOOTH = fp.SmoothLayDownModel(fp.QuadraticPotential(1.0), 0.5, 1.0, fp.MovingBelt(0.1))
WIDE = np.diag([0.1, 0.5 * SIGMA2, 0.1]) ** 2


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (known_identification(SMOOTH), "one with sigma1, sigma2, noise and"),
        (identified(undetermined={"sigma1": "it is long"}), "sigma1 is not determined"),
        (identified(WIDE), "sigma2 has a standard error of 50 %"),
        (identified(COVARIANCE * np.nan), "sigma1 has a standard error of nan %"),
        (identified(parameters={**PARAMETERS, "noise": 3.0}), "of the identified"),
    ],
)
def test_errors_that_cannot_be_carried_are_refused(web, found, said):
    with pytest.raises(ValueError, match=said):
        found.cv_errors(web)


def test_a_prediction_that_has_no_slopes_is_refused(web):
    with pytest.raises(ValueError, match="`prediction` must have gradients"):
        identified().cv_errors(replace(web, gradient=None))
    with pytest.raises(TypeError, match="`prediction` must be"):
        identified().cv_errors(0.1)


def smooth_of(sigma1, sigma2, noise, curvature):
    """The smooth model of what is identified."""
    return fp.SmoothLayDownModel(
        fp.QuadraticPotential(sigma1, sigma2), noise / curvature, noise,
        fp.MovingBelt(SPEED),
    )  # fmt: skip


SMOOTH_VALUES = np.array([1.0, 0.8, 3.0, 10.0])


@pytest.fixture
def smooth_web():
    """CV = 0.2 A^0.3 R^0.5/√(σ1 σ2), whose slopes are known."""
    model = smooth_of(*SMOOTH_VALUES)
    sigma1, sigma2, noise, _ = SMOOTH_VALUES
    cv = 0.2 * noise**0.3 * 0.3**0.5 / np.sqrt(sigma1 * sigma2)
    shares = [0.3 / noise, 0.0, -0.5 / sigma1, -0.5 / sigma2, 0.5 / 0.3, 0.0]
    none = np.zeros(0)
    return WebPrediction(
        model, SPACING, 1.0, "random", np.ones(1), np.array([cv]), np.zeros(1), none,
        none, none, none, none, none, np.eye(2), np.zeros((2, 2)),
        ("noise", "belt_speed", "sigma1", "sigma2", "relaxation_length", "spacing"),
        cv * np.array(shares)[:, None], np.zeros((6, 1)),
    )  # fmt: skip


def test_errors_of_smooth_fibres_are_those_of_drawn_noises_of_the_curvature(smooth_web):
    """R = A/K has the errors of both: log CV = 0.8 log A − 0.5 log K − ½ log(σ1 σ2)."""
    found = known_identification(smooth_web.model)
    powers = np.array([-0.5, -0.5, 0.8, -0.5])
    shares = powers / SMOOTH_VALUES
    expected = smooth_web.cv * np.sqrt(shares @ found.covariance @ shares)
    np.testing.assert_allclose(found.cv_errors(smooth_web), expected, rtol=1e-12)
    unit = 5e-3
    factors = unit ** np.array([1.0, 1.0, -0.5, -1.5])
    metres = replace(
        found, covariance=factors[:, None] * found.covariance * factors,
        parameters=dict(zip(found.parameters, factors * SMOOTH_VALUES, strict=True)),
    )  # fmt: skip
    scale = unit ** np.array([-0.5, 0.0, 1.0, 1.0, 1.0, 1.0])[:, None]
    of_process = replace(smooth_web, length=unit, gradient=smooth_web.gradient / scale)
    np.testing.assert_allclose(metres.cv_errors(of_process), expected, rtol=1e-12)


@pytest.mark.nightly
def test_errors_of_smooth_fibres_are_half_the_spread_of_opposite_parameters(
    monkeypatch,
):
    """√Σ of ((CV(θ + L) − CV(θ − L))/2)² over the columns L of √Σ.

    Of one truncation between nodes that leave less than a per cent.
    """
    for axis in AXES:
        monkeypatch.setitem(N_NODES, axis, 7)
    choose_one_truncation(monkeypatch)

    def smooth_cv(values, **options):
        return fp.predict_web(
            smooth_of(*values), spacing=SPACING, zones=0.7, tolerance=0.5, **options
        )

    web = smooth_cv(SMOOTH_VALUES, gradients=True)
    found = known_identification(web.model)
    halves = [
        0.5 * (smooth_cv(SMOOTH_VALUES + one).cv - smooth_cv(SMOOTH_VALUES - one).cv)
        for one in np.linalg.cholesky(found.covariance).T
    ]
    expected = np.sqrt(np.sum(np.square(halves)))
    carried = found.cv_errors(web)[0]
    slack = np.sqrt(np.diag(found.covariance)) @ [
        web.gradient_errors[2, 0], web.gradient_errors[3, 0],
        web.gradient_errors[0, 0] + web.gradient_errors[4, 0] / 10.0,
        web.gradient_errors[4, 0] * 0.03,
    ]  # fmt: skip
    # Of third order over 5 per cent, and what moving nodes change.
    assert carried - slack == pytest.approx(expected, rel=0.05)
