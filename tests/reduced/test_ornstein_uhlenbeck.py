"""The exact Ornstein-Uhlenbeck solution of remark 3.7."""

import math

import numpy as np
import pytest

from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit

MODEL = LayDownModel(QuadraticPotential(1.2, 0.7), 2.0, MovingBelt(0.1))
PROCESS = OrnsteinUhlenbeckLimit(MODEL, (1.0, -0.5), [[0.5, 0.2], [0.2, 0.4]])
GRID = PlaneGrid(12.0, (360, 360))


def test_for_unit_throwing_ranges_the_stationary_law_is_that_of_the_remark():
    model = LayDownModel(QuadraticPotential(), 3.0, MovingBelt(0.2))
    process = OrnsteinUhlenbeckLimit(model)
    # A²v, one product.
    np.testing.assert_allclose(process.stationary_mean, [1.8, 0.0], rtol=1e-15)
    np.testing.assert_array_equal(process.stationary_variance, [1.0, 1.0])
    np.testing.assert_allclose(process.mean(1e4), [1.8, 0.0], rtol=1e-14)
    np.testing.assert_allclose(process.covariance(1e4), np.eye(2), rtol=1e-14)


def test_the_density_solves_the_limit_equation():
    # Central differences of step 1e-3 at points where the density is not small: their
    # error is 1e-6 of derivatives of size one.
    limit, h = HydrodynamicLimit(MODEL), 1e-3
    x, y, s = np.array([0.3, 1.2, -0.8]), np.array([-0.4, 0.2, 0.5]), 0.7
    p = PROCESS.density

    def flux(x, y):
        drift1, drift2 = limit.drift(x, y)
        slope1 = (p(x + h, y, s) - p(x - h, y, s)) / (2 * h)
        slope2 = (p(x, y + h, s) - p(x, y - h, s)) / (2 * h)
        value, epsilon = p(x, y, s), limit.epsilon
        return epsilon * slope1 - drift1 * value, epsilon * slope2 - drift2 * value

    right = (flux(x + h, y)[0] - flux(x - h, y)[0]) / (2 * h)
    right += (flux(x, y + h)[1] - flux(x, y - h)[1]) / (2 * h)
    left = (p(x, y, s + h) - p(x, y, s - h)) / (2 * h)
    np.testing.assert_allclose(left, right, rtol=0, atol=2e-6)
    assert np.abs(left).min() > 1e-4


@pytest.mark.parametrize("s", [0.0, 0.5, 4.0])
def test_moments_and_mass_are_those_of_the_density(s):
    # The midpoint rule is spectrally accurate for a Gaussian this well resolved.
    p = PROCESS.density(*GRID.mesh(), s) * GRID.cell_area
    xi1, xi2 = np.broadcast_arrays(*GRID.mesh())
    mean, covariance = PROCESS.mean(s), PROCESS.covariance(s)
    assert p.sum() == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose([(p * xi1).sum(), (p * xi2).sum()], mean, atol=1e-12)
    mixed = (p * (xi1 - mean[0]) * (xi2 - mean[1])).sum()
    np.testing.assert_allclose(mixed, covariance[0, 1], atol=1e-12)
    square = (p * (xi1 - mean[0]) ** 2).sum()
    np.testing.assert_allclose(square, covariance[0, 0], atol=1e-12)


@pytest.mark.parametrize("s", [0.0, 0.5, 4.0])
def test_the_entropy_in_closed_form_is_the_integral(s):
    p = PROCESS.density(*GRID.mesh(), s)
    reference = HydrodynamicLimit(MODEL).equilibrium(*GRID.mesh())
    held = p > 1e-250
    terms = p[held] * np.log(p[held] / reference[held]) * GRID.cell_area
    # The midpoint rule again.
    assert PROCESS.relative_entropy(s) == pytest.approx(terms.sum(), rel=1e-11)


def test_moments_take_arrays_of_s_and_late_entropies_keep_their_digits():
    s = np.array([0.0, 1.0, 2.0])
    assert PROCESS.mean(s).shape == (3, 2)
    assert PROCESS.covariance(s).shape == (3, 2, 2)
    np.testing.assert_array_equal(PROCESS.covariance(s)[1], PROCESS.covariance(1.0))
    # At late s the slowest term decays as e^{−2 k₁ s}, k₁ = 1/(A²σ₁²).
    early, late = PROCESS.relative_entropy(np.array([100.0, 101.0]))
    # The next term is e^{−2 k₁ 100} = 1e-15 smaller; entropies are about 1e-15.
    assert early / late == pytest.approx(math.exp(2 * PROCESS.rates[0]), rel=1e-6)


def test_the_exact_transition_has_the_law_of_the_density(rng):
    n, s = 200_000, 1.5
    start = rng.multivariate_normal(
        PROCESS.mean_at_start, PROCESS.covariance_at_start, size=n
    )
    # In two stretches: the law must not depend on where paths were stopped.
    xi = PROCESS.transition(PROCESS.transition(start, 0.4, rng), s - 0.4, rng)
    covariance = PROCESS.covariance(s)
    error = np.sqrt(np.diag(covariance) / n)
    # Four standard errors; the seed is fixed.
    assert np.all(np.abs(xi.mean(axis=0) - PROCESS.mean(s)) < 4 * error)
    scale = np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    assert np.all(np.abs(np.cov(xi.T) - covariance) < 4 * scale * math.sqrt(2 / n))


def test_eigenvalues_are_sums_of_the_two_rates():
    k1, k2 = PROCESS.rates
    expected = sorted(i * k1 + j * k2 for i in range(6) for j in range(6))[:6]
    np.testing.assert_allclose(PROCESS.eigenvalues(6), expected, rtol=1e-15)


def test_what_has_no_such_limit_is_refused():
    with pytest.raises(ValueError, match="`potential` must be quadratic for an Ornst"):
        OrnsteinUhlenbeckLimit(LayDownModel(LinearPotential(), 1.0))
    with pytest.raises(ValueError, match="`noise` must be positive for the limit of"):
        OrnsteinUhlenbeckLimit(LayDownModel(QuadraticPotential(), 0.0))
    nozzle = RotatingNozzle(speed=0.1, radius=1.0, angular_speed=1.0)
    with pytest.raises(ValueError, match="`curve` must move at constant speed, got"):
        OrnsteinUhlenbeckLimit(LayDownModel(QuadraticPotential(), 1.0, nozzle))
    with pytest.raises(ValueError, match="`mean` must be two numbers, got 1"):
        OrnsteinUhlenbeckLimit(MODEL, 1.0)
    with pytest.raises(ValueError, match="`variance` must be positive"):
        OrnsteinUhlenbeckLimit(MODEL, variance=-1.0)
    with pytest.raises(ValueError, match="`s` must be non-negative and finite, got -1"):
        PROCESS.mean(-1.0)
    with pytest.raises(ValueError, match="`n` must be at least 1, got 0"):
        PROCESS.eigenvalues(0)
