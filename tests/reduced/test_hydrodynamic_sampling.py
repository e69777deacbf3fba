"""Paths of dξ = (−ε∇B + v e₁) ds + √(2ε) dW against exact laws, in standard errors."""

import math

import numpy as np
import pytest

from fpsolve.errors import NonFinitePathError
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import PowerPotential, QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit

MODEL = LayDownModel(QuadraticPotential(1.2, 0.7), 2.0, MovingBelt(0.1))
LIMIT = HydrodynamicLimit(MODEL)
CUBIC = HydrodynamicLimit(LayDownModel(PowerPotential(3.0), 1.5, MovingBelt(0.2)))
# A fixed seed; four standard errors fail once in 16 000 comparisons.
MANY = 4.0


def test_exact_paths_have_the_moments_of_the_exact_law():
    paths = LIMIT.sample(
        200_000, 3.0, seed=1, initial=(1.0, -0.5), save_at=(0.5, 1.0, 3.0)
    )
    assert paths.method == "exact"
    assert paths.xi.shape == (3, 200_000, 2)
    # A point start is the limit of narrow Gaussians.
    exact = OrnsteinUhlenbeckLimit(MODEL, (1.0, -0.5), 1e-12)
    mean, error = paths.mean()
    assert np.all(np.abs(mean - exact.mean(paths.s)) < MANY * error)
    covariance, error = paths.covariance()
    assert np.all(np.abs(covariance - exact.covariance(paths.s)) < MANY * error)


def test_heun_is_weakly_of_order_two_at_every_halving():
    # From far away the drift is all that matters: E ξ1 − m = d e^{−k s}, k = 1/A² = 1.
    # Heun multiplies the distance by 1 − h + h²/2, an error of d h²/6 e^{−1}.
    model = LayDownModel(QuadraticPotential(), 1.0)
    n_paths, distance = 100_000, 400.0
    biases, errors = [], []
    for n in (2, 4, 8):
        paths = HydrodynamicLimit(model).sample(
            n_paths, 1.0, 1 / n, seed=n, initial=(distance, 0.0), method="heun"
        )
        mean, error = paths.mean()
        biases.append(abs(mean[0, 0] - distance * math.exp(-1.0)))
        errors.append(error[0, 0])
    biases, errors = np.array(biases), np.array(errors)
    # The error of an order from those of the two biases.
    spread = np.hypot(errors[:-1] / biases[:-1], errors[1:] / biases[1:]) / math.log(2)
    orders = np.log2(biases[:-1] / biases[1:])
    # 0.3 is the next term at h = 1/2, as in tests/support/orders.py.
    assert np.all(np.abs(orders - 2) < 0.3 + MANY * spread)
    assert np.all(MANY * spread < 0.1)


def test_heun_has_the_variance_of_the_exact_law():
    paths = LIMIT.sample(100_000, 4.0, 0.25, seed=3, initial=(0.0, 0.0), method="heun")
    exact = OrnsteinUhlenbeckLimit(MODEL, (0.0, 0.0), 1e-12)
    covariance, error = paths.covariance()
    # Bias: k h = 0.13 squared over 12, below the standard error of 4e-3.
    assert np.all(
        np.abs(covariance[0] - exact.covariance(4.0)) < MANY * error[0] + 2e-3
    )


def test_paths_of_another_potential_follow_the_limit_equation():
    # Moments from the finite volumes: order 2 in h = 0.1, error below 1e-3.
    grid = PlaneGrid(4.5, (90, 90))
    run = CUBIC.solve(
        lambda x, y: np.exp(-((x - 1.0) ** 2 + y**2) / 0.5),
        (0.0, 2.0),
        0.05,
        grid=grid,
        extrapolate=True,
        method="sdirk2",
    )
    paths = CUBIC.sample(
        100_000,
        2.0,
        0.02,
        seed=5,
        initial=lambda rng, n: rng.normal((1.0, 0.0), 0.5, size=(n, 2)),
    )
    assert paths.method == "heun"
    mean, error = paths.mean()
    assert abs(mean[0, 0] - run.mean_xi1[-1]) < MANY * error[0, 0] + 1e-3
    assert abs(mean[0, 1]) < MANY * error[0, 1]
    covariance, error = paths.covariance()
    expected = run.variance_xi1[-1], run.variance_xi2[-1]
    found, spread = np.diag(covariance[0]), np.diag(error[0])
    assert np.all(np.abs(found - expected) < MANY * spread + 1e-3)


def test_paths_are_repeatable_and_stop_where_they_are_asked_to():
    starts = np.zeros((3, 2))
    first, second = (
        CUBIC.sample(3, 1.0, 0.25, seed=7, initial=starts, save_at=(0.0, 0.5, 1.0))
        for _ in range(2)
    )
    np.testing.assert_array_equal(first.xi, second.xi)
    np.testing.assert_array_equal(first.xi[0], starts)
    np.testing.assert_array_equal(first.s, [0.0, 0.5, 1.0])
    assert first.ds == 0.25
    assert first.n_paths == 3
    exact = LIMIT.sample(3, 1.0, seed=7, initial=starts, save_at=(0.0, 1.0))
    np.testing.assert_array_equal(exact.xi[0], starts)


def test_starts_drawn_from_a_density_have_its_moments():
    grid = PlaneGrid((5.0, 4.0), (50, 40))
    exact = OrnsteinUhlenbeckLimit(MODEL, (1.0, -0.5), [[0.5, 0.2], [0.2, 0.4]])
    paths = LIMIT.sample(
        100_000,
        1.0,
        seed=11,
        initial=(grid, exact.density(*grid.mesh())),
        save_at=(0.0,),
    )
    mean, error = paths.mean()
    assert np.all(np.abs(mean[0] - exact.mean_at_start) < MANY * error[0])
    covariance, error = paths.covariance()
    # Even places in cells of 0.2 add 0.2²/12 to both variances.
    expected = exact.covariance_at_start + 0.2**2 / 12 * np.eye(2)
    assert np.all(np.abs(covariance[0] - expected) < MANY * error[0])
    with pytest.raises(ValueError, match="`initial` must be a non-negative, finite de"):
        LIMIT.sample(2, 1.0, seed=1, initial=(grid, -np.ones(grid.shape)))


def test_what_cannot_be_sampled_is_refused():
    with pytest.raises(ValueError, match="`ds` must be given for the method 'heun'"):
        CUBIC.sample(10, 1.0, seed=1, initial=(0.0, 0.0))
    with pytest.raises(ValueError, match="`method` must be 'heun' for a potential tha"):
        CUBIC.sample(10, 1.0, 0.1, seed=1, initial=(0.0, 0.0), method="exact")
    with pytest.raises(ValueError, match="`method` must be one of 'exact', 'heun', go"):
        CUBIC.sample(10, 1.0, 0.1, seed=1, initial=(0.0, 0.0), method="euler")
    with pytest.raises(ValueError, match="`n_paths` must be at least 2, got 1"):
        LIMIT.sample(1, 1.0, seed=1, initial=(0.0, 0.0))
    with pytest.raises(
        ValueError, match=r"`initial` must be a point \(xi1, xi2\) or h"
    ):
        LIMIT.sample(4, 1.0, seed=1, initial=np.zeros((3, 2)))
    with pytest.raises(ValueError, match="`initial` must be finite, got NaN or infini"):
        LIMIT.sample(4, 1.0, seed=1, initial=(np.nan, 0.0))
    with pytest.raises(ValueError, match="`s_end` must be positive and finite, got 0"):
        LIMIT.sample(4, 0.0, seed=1, initial=(0.0, 0.0))
    with pytest.raises(
        ValueError, match=r"`save_at` must hold numbers in \[0, 1\], go"
    ):
        LIMIT.sample(4, 1.0, seed=1, initial=(0.0, 0.0), save_at=(2.0,))


def test_a_path_that_runs_away_is_reported():
    with pytest.raises(
        NonFinitePathError, match="path 0 cannot go on at s = "
    ) as caught:
        CUBIC.sample(2, 100.0, 5.0, seed=1, initial=[(20.0, 0.0), (0.0, 0.0)])
    assert caught.value.path == 0
