"""Orders are read off errors whose orders are known."""

import numpy as np
import pytest

from fpsolve.studies.limits.orders import fitted_order, observed_orders

EPSILON = 2.0 ** -np.arange(1, 6)


def test_a_power_has_its_order_between_all_neighbours_and_in_the_fit():
    error = 3.0 * EPSILON**2.5
    orders = observed_orders(EPSILON, error)
    assert np.isnan(orders[0])
    # Rounding of logarithms only.
    np.testing.assert_allclose(orders[1:], 2.5, rtol=1e-13)
    fit = fitted_order(EPSILON, error)
    assert fit.order == pytest.approx(2.5, rel=1e-12)
    assert fit.constant == pytest.approx(3.0, rel=1e-12)
    assert fit.standard_error < 1e-6
    assert fit.n_points == 5


def test_the_order_of_the_noise_does_not_matter():
    error = EPSILON**2 * (1 + EPSILON)
    forwards = observed_orders(EPSILON, error)[1:]
    backwards = observed_orders(EPSILON[::-1], error[::-1])[1:]
    np.testing.assert_allclose(forwards, backwards[::-1], rtol=1e-13)
    one, other = fitted_order(EPSILON, error), fitted_order(EPSILON[::-1], error[::-1])
    assert one.order == pytest.approx(other.order, rel=1e-12)


def test_a_next_term_bends_the_line_and_the_standard_error_says_so():
    fit = fitted_order(EPSILON, EPSILON**2 * (1 + 2 * EPSILON))
    # ln(1 + 2ε) adds at most one to the slope, and less at every halving.
    assert 2.0 < fit.order < 3.0
    assert 0.01 < fit.standard_error < 0.5
    orders = observed_orders(EPSILON, EPSILON**2 * (1 + 2 * EPSILON))[1:]
    assert np.all(np.diff(orders) < 0)
    assert orders[-1] > 2.0


def test_points_at_the_floor_are_left_out():
    floor = 1e-3
    error = EPSILON**2 + floor
    fit = fitted_order(EPSILON, error, floor)
    # 2⁻¹⁰ is the floor itself, 2⁻⁸ and above exceed three times it.
    assert fit.n_points == 4
    by_point = fitted_order(EPSILON, error, np.full(5, floor))
    assert by_point == fit
    assert fitted_order(EPSILON, error).order < fit.order


def test_what_vanishes_has_no_order():
    orders = observed_orders(EPSILON, [1.0, 0.0, 0.25, np.nan, 1.0])
    assert np.isnan(orders).all()
    fit = fitted_order(EPSILON, np.zeros(5))
    assert np.isnan(fit.order)
    assert fit.n_points == 0
    assert str(fit) == "nan ± nan"


def test_two_points_have_a_slope_but_no_scatter():
    fit = fitted_order([0.5, 0.25], [1.0, 0.25])
    assert fit.order == pytest.approx(2.0)
    assert np.isnan(fit.standard_error)
    assert str(fit) == "2.00 ± nan"


@pytest.mark.parametrize("function", [observed_orders, fitted_order])
def test_bad_arguments_are_named(function):
    with pytest.raises(ValueError, match="`epsilon` and `error` must be sequences of"):
        function([1.0, 0.5], [1.0])
    with pytest.raises(ValueError, match="`epsilon` must be positive, got 0"):
        function([1.0, 0.0], [1.0, 1.0])


def test_neighbours_must_differ():
    with pytest.raises(ValueError, match="`epsilon` must change between neighbours"):
        observed_orders([0.5, 0.5], [1.0, 1.0])
