"""Parameters that numbers allow: against least squares, and where numbers fold."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.studies.identification import curve_search
from fpsolve.studies.identification.curve_search import CurveSearch
from fpsolve.studies.identification.functional_estimate import estimate_by_functional
from fpsolve.studies.identification.quasi_newton import Search
from fpsolve.studies.identification.second_order import allowed, fitted, widened

RNG = np.random.default_rng(7)
POINTS = 0.5 * RNG.standard_normal((60, 2))
COVARIANCE = np.array([[0.04, 0.01, 0.0], [0.01, 0.09, 0.0], [0.0, 0.0, 0.01]])
SLOPES = np.array([[1.0, 0.3], [-0.5, 2.0], [0.0, 0.1]])


def with_covariance(means):
    return fitted(POINTS, means, np.tile(COVARIANCE, (len(POINTS), 1, 1)))


def test_a_parabola_and_its_chance_are_fitted_exactly():
    x, y = POINTS.T
    means = np.stack([1 + x * y, y**2 - x, 2 * x], axis=1)
    scaled = np.exp(0.3 * x)[:, None, None] * COVARIANCE
    response = fitted(POINTS, means, scaled)
    np.testing.assert_allclose(response.mean(POINTS), means, atol=1e-12)
    expected = np.sqrt(np.einsum("ijj->ij", scaled))
    np.testing.assert_allclose(response.spread(POINTS), expected, rtol=1e-12)
    wider = widened(response, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(wider.spread(POINTS), expected * [1, 2, 3], rtol=1e-12)


def test_what_a_parabola_misses_counts_as_chance():
    cubic = POINTS[:, :1] ** 3 * np.ones(3)
    given = np.sqrt(np.diag(COVARIANCE))
    assert np.all(with_covariance(cubic).spread(POINTS).mean(axis=0) > given)


def test_numbers_that_are_linear_allow_the_least_squares_and_their_covariance():
    data = SLOPES @ [0.1, -0.2] + np.array([0.05, -0.1, 0.02])
    found = allowed(with_covariance(POINTS @ SLOPES.T), data, 1)
    weighted = np.linalg.solve(COVARIANCE, SLOPES).T
    exact = np.linalg.inv(weighted @ SLOPES)
    least = exact @ weighted @ data
    # 4000 draws, of which more than half count by Student's law, and a rim at 3.5
    # standard deviations of the points: 0.1 is five standard errors of the mean, and
    # 15 % five of a variance.
    errors = np.sqrt(np.diag(exact))
    assert found.settled
    assert np.all(np.abs(found.mean - least) < 0.1 * errors)
    np.testing.assert_allclose(np.diag(found.covariance), np.diag(exact), rtol=0.15)


def test_both_parameters_of_one_number_are_allowed_where_it_folds():
    x, y = POINTS.T
    means = np.stack([x**2, y, np.zeros_like(x)], axis=1)
    response = with_covariance(means)
    found = allowed(response, np.array([0.36, 0.1, 0.0]), 1)
    # x = ± 0.6: half of the distance is the standard deviation, beside the error of
    # 0.2/(2·0.6) of either and what lies between; by quadrature of the density below.
    grid = np.linspace(-2, 2, 801)
    # y is integrated over, which leaves the variance of the first number.
    density = np.exp(-0.5 * (0.36 - grid**2) ** 2 / COVARIANCE[0, 0])
    exact = np.sum(density * grid**2) / np.sum(density)
    # The mean lies between the two, to 0.6/√(draws that count) each.
    assert abs(found.mean[0]) < 0.1
    assert found.covariance[0, 0] == pytest.approx(exact, rel=0.15)


def smooth_fibre(noise, length):
    potential, belt = fp.QuadraticPotential(1.0, 1.5), fp.MovingBelt(0.1)
    model = fp.SmoothLayDownModel(potential, 0.5, noise, belt)
    n = round(length / 0.1) + 1
    paths = fp.sample_paths(
        model, 1, 0.1 * (n - 1), 0.05, seed=2, save_at=0.1 * np.arange(n),
        initial=fp.paths.EquilibriumLaw(potential),
    )  # fmt: skip
    return fp.FibreCurve.from_paths(paths)


@pytest.mark.parametrize(("noise", "answers"), [(0.5, False), (1.0, True)])
def test_the_largest_turn_answers_to_noise_only_where_there_is_enough(noise, answers):
    # ∂ log max Γ_α/∂ log A is -0.03 at A = 0.5 and 0.20 at A = 1, each ± 0.03 with so
    # many points; 0.1 lies three standard errors from both.
    search = Search(smooth_fibre(1.0, 200.0), 4, 48, 200_000, 1)
    logs = np.log([1.0, 1.5, noise, 2 * noise])
    assert search._answers(logs) is answers


def test_parameters_that_do_not_settle_are_refused(monkeypatch):
    monkeypatch.setattr(curve_search, "N_APPROACH", 0)
    monkeypatch.setattr(curve_search, "MOST_ROUNDS", 0)
    search = Search(smooth_fibre(0.5, 200.0), 4, 40, 200_000, 1)
    with pytest.raises(ToleranceError, match="those of no parameters near its own"):
        CurveSearch(search).run()


@pytest.mark.nightly
def test_a_fibre_that_circles_is_identified_by_its_curves():
    found = estimate_by_functional(smooth_fibre(0.5, 600.0), "smooth", seed=1)
    assert "were met instead" in found.notes[0]
    true = {"sigma1": 1.0, "sigma2": 1.5, "noise": 0.5, "curvature_noise": 1.0}
    errors = np.sqrt(np.diag(found.covariance))
    for (name, value), error in zip(true.items(), errors, strict=True):
        # One of four beyond 3.5 standard errors once in 500 times.
        assert abs(np.log(found.parameters[name] / value)) < 3.5 * error / value, name
        assert error < 0.25 * value, name
    assert found.undetermined == {}
