"""The contract of every potential, and what is particular to each."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import dblquad, quad

from fpsolve.model.potentials import (
    CallablePotential,
    FreePotential,
    IsotropicPotential,
    LinearPotential,
    Potential,
    PowerPotential,
    QuadraticPotential,
    potential_from_dict,
)


def double_well(xi1, xi2):
    return (xi1**2 - 4) ** 2 / 8 + xi2**2 / 2


def double_well_gradient(xi1, xi2):
    return (xi1**2 - 4) * xi1 / 2, xi2


def soft_linear(r):
    return np.sqrt(1 + r**2)


def soft_linear_derivative(r):
    return r / np.sqrt(1 + r**2)


NAMED = [
    QuadraticPotential(),
    QuadraticPotential(sigma1=0.7, sigma2=1.9),
    LinearPotential(),
    LinearPotential(slope=2.5),
    PowerPotential(exponent=1.5),
    PowerPotential(exponent=4, scale=1.3),
    FreePotential(),
]
USER = [
    IsotropicPotential(soft_linear, soft_linear_derivative),
    CallablePotential(double_well, double_well_gradient),
]
FAMILY = NAMED + USER
ISOTROPIC = [potential for potential in FAMILY if potential.isotropic]
NORMALISABLE = [p for p in FAMILY if not isinstance(p, FreePotential)]

away_from_origin = st.tuples(
    st.floats(0.05, 5.0), st.floats(0.0, 2 * math.pi, exclude_max=True)
).map(lambda polar: (polar[0] * math.cos(polar[1]), polar[0] * math.sin(polar[1])))


# --- the contract -------------------------------------------------------------------


@pytest.mark.parametrize("potential", FAMILY, ids=repr)
@given(point=away_from_origin)
def test_gradient_is_the_derivative_of_the_value(potential, point):
    xi1, xi2 = point
    step = 1e-5
    differences = (
        (potential.value(xi1 + step, xi2) - potential.value(xi1 - step, xi2)),
        (potential.value(xi1, xi2 + step) - potential.value(xi1, xi2 - step)),
    )
    # Central differences: truncation step² B'''/6, largest for the linear potential
    # at r = 0.05 where B''' is about 3 K/r² = 3000: 5e-8; rounding eps B/step: 3e-9.
    tolerance = 1e-7
    for slope, difference in zip(
        potential.gradient(xi1, xi2), differences, strict=True
    ):
        assert slope == pytest.approx(
            difference / (2 * step), rel=tolerance, abs=tolerance
        )


@pytest.mark.parametrize("potential", FAMILY, ids=repr)
def test_value_and_gradient_are_float64_and_broadcast(potential):
    xi1, xi2 = np.arange(5)[:, None], np.arange(3)[None, :]
    slopes = potential.gradient(xi1, xi2)
    for array in (potential.value(xi1, xi2), *slopes):
        assert array.shape == (5, 3)
        assert array.dtype == np.float64
        assert np.all(np.isfinite(array))
        array[0, 0] = 7.0  # nobody else's memory, and not read-only


@pytest.mark.parametrize("potential", FAMILY, ids=repr)
def test_the_origin_is_an_equilibrium_or_a_kink_with_gradient_zero(potential):
    assert potential.gradient(0.0, 0.0) == (0.0, 0.0)


@pytest.mark.parametrize("potential", NORMALISABLE, ids=repr)
def test_partition_function_is_the_integral_over_the_plane(potential):
    integral, error = dblquad(
        # Even in both variables, hence four times one quadrant; at 40 the slowest,
        # exp(-r), has lost all but 2e-16 of its mass.
        lambda xi2, xi1: 4 * math.exp(-potential.value(xi1, xi2)),
        *(0, 40, 0, 40),
        epsabs=1e-8,
        epsrel=1e-8,
    )
    # The relative error the independent quadrature was asked for, ten times.
    assert error < 1e-6
    assert potential.partition_function == pytest.approx(integral, rel=1e-7)
    assert potential.normalisable


@pytest.mark.parametrize("potential", ISOTROPIC, ids=repr)
@given(r=st.floats(0.0, 5.0), angle=st.floats(0.0, 2 * math.pi))
def test_an_isotropic_potential_depends_on_the_distance_only(potential, r, angle):
    xi1, xi2 = r * math.cos(angle), r * math.sin(angle)
    # Rounding of the rotation, amplified by the slope: a few eps times r B'(r).
    tolerance = 1e-12 * (1 + r * abs(float(potential.radial_derivative(r))))
    assert potential.value(xi1, xi2) == pytest.approx(
        float(potential.radial_value(r)), abs=tolerance
    )


@pytest.mark.parametrize("potential", ISOTROPIC, ids=repr)
@given(r=st.floats(0.01, 5.0))
def test_the_gradient_on_the_first_axis_is_the_radial_derivative(potential, r):
    slope1, slope2 = potential.gradient(r, 0.0)
    assert slope1 == pytest.approx(float(potential.radial_derivative(r)), rel=1e-14)
    assert slope2 == 0


@pytest.mark.parametrize("potential", FAMILY, ids=repr)
def test_potentials_are_hashable_values(potential):
    assert potential == potential
    assert hash(potential) == hash(potential)
    assert potential not in [other for other in FAMILY if other is not potential]
    assert isinstance(potential, Potential)
    with pytest.raises(AttributeError):
        potential.sigma1 = 3.0


@pytest.mark.parametrize("potential", NAMED, ids=repr)
def test_repr_reads_as_the_constructor(potential):
    assert eval(repr(potential)) == potential


@pytest.mark.parametrize("potential", NAMED, ids=repr)
def test_a_dictionary_brings_the_potential_back_through_json(potential):
    description = json.loads(json.dumps(potential.to_dict()))
    assert potential_from_dict(description) == potential


@pytest.mark.parametrize("potential", FAMILY, ids=repr)
def test_latex_is_one_balanced_formula(potential):
    assert potential.latex.count("{") == potential.latex.count("}")
    assert "$" not in potential.latex
    assert potential._repr_latex_() == f"$B(\\xi) = {potential.latex}$"


# --- particular potentials ----------------------------------------------------------


def test_formulas_show_the_actual_parameters():
    assert QuadraticPotential().formula == "(ξ₁² + ξ₂²)/2"
    assert QuadraticPotential(2, 3).formula == "(ξ₁²/2² + ξ₂²/3²)/2"
    assert LinearPotential().formula == "‖ξ‖"
    assert LinearPotential(2).formula == "2 ‖ξ‖"
    assert PowerPotential(4).formula == "‖ξ‖^4/4"
    assert PowerPotential(4, scale=2).formula == "(‖ξ‖/2)^4/4"
    assert FreePotential().formula == "0"
    assert [potential.formula for potential in USER] == ["B(‖ξ‖)", "B(ξ)"]


def test_latex_shows_the_actual_parameters():
    assert QuadraticPotential(1, 3).latex == (
        r"\frac12\left(\xi_1^2 + \frac{\xi_2^2}{3^2}\right)"
    )
    assert LinearPotential(2).latex == r"2\,\|\xi\|"
    assert PowerPotential(4, scale=2).latex == r"\frac{(\|\xi\|/2)^{4}}{4}"


def test_powers_contain_the_linear_and_the_quadratic_potential():
    r = np.linspace(0.0, 5.0, 11)
    for power, special in (
        (PowerPotential(1, scale=0.4), LinearPotential(2.5)),
        (PowerPotential(2, scale=1.7), QuadraticPotential(1.7, 1.7)),
    ):
        # Same formula evaluated in another order: a few rounding errors.
        np.testing.assert_allclose(power.value(r, 0), special.value(r, 0), rtol=1e-14)
        assert power.partition_function == pytest.approx(
            special.partition_function, rel=1e-14
        )


@given(exponent=st.floats(1.0, 20.0), scale=st.floats(0.1, 10.0))
def test_the_partition_function_of_a_power_is_a_gamma_function(exponent, scale):
    power = PowerPotential(exponent, scale)
    radial, _ = quad(
        lambda r: r * math.exp(-power.radial_value(scale * r)), 0, 50, epsrel=1e-12
    )
    # quad's own tolerance with a margin; at 50 scales exp(-r) is below 1e-21.
    assert power.partition_function == pytest.approx(
        2 * math.pi * scale**2 * radial, rel=1e-9
    )


def test_dimensionless_potentials_have_slope_one_at_one():
    for potential in (QuadraticPotential(), LinearPotential(), PowerPotential(3)):
        assert potential.radial_derivative(1.0) == 1.0


def test_the_slope_of_the_linear_potential_at_zero_is_its_limit():
    assert LinearPotential(2.5).radial_derivative(0.0) == 2.5


def test_a_profile_singular_at_zero_is_not_asked_there():
    cusp = IsotropicPotential(np.sqrt, lambda r: 0.5 / np.sqrt(r))
    with np.errstate(all="raise"):
        assert cusp.gradient(0.0, 0.0) == (0.0, 0.0)


def test_an_anisotropic_quadratic_potential_has_no_radial_profile():
    potential = QuadraticPotential(1, 2)
    with pytest.raises(ValueError, match="`potential` must be isotropic"):
        potential.radial_value(1.0)
    with pytest.raises(ValueError, match=r"got QuadraticPotential\(sigma1=1.0, sig"):
        potential.radial_derivative(1.0)


def test_the_free_potential_is_not_normalisable():
    assert FreePotential().partition_function == math.inf
    assert not FreePotential().normalisable


def test_a_gradient_may_return_constants():
    channel = CallablePotential(lambda x, y: x + 0 * y, lambda x, y: (1.0, 0.0))
    slope1, slope2 = channel.gradient(np.zeros((2, 1)), np.zeros(3))
    assert np.array_equal(slope1, np.ones((2, 3)))
    assert np.array_equal(slope2, np.zeros((2, 3)))


# --- partition functions of user potentials -----------------------------------------


def test_a_valley_that_never_closes_is_not_normalisable():
    channel = CallablePotential(lambda x, y: x**2 / 2 + 0 * y, lambda x, y: (x, 0 * y))
    assert channel.partition_function == math.inf


def test_a_potential_that_falls_without_bound_is_not_normalisable():
    hill = IsotropicPotential(lambda r: -(r**2), lambda r: -2 * r)
    assert hill.partition_function == math.inf


@pytest.mark.parametrize("shift", [0.3, 5.0, 50.0])
def test_the_partition_function_does_not_depend_on_where_the_minimum_is(shift):
    moved = CallablePotential(
        lambda x, y: ((x - shift) ** 2 + y**2) / 2, lambda x, y: (x - shift, y)
    )
    # The accuracy promised for smooth potentials, ten times.
    assert moved.partition_function == pytest.approx(2 * math.pi, rel=1e-10)


@pytest.mark.parametrize("ratio", [1.0, 10.0, 100.0])
def test_the_partition_function_of_a_long_valley_is_found(ratio):
    valley = CallablePotential(
        lambda x, y: (x**2 + (y / ratio) ** 2) / 2, lambda x, y: (x, y / ratio**2)
    )
    assert valley.partition_function == pytest.approx(2 * math.pi * ratio, rel=1e-10)


def test_a_slow_logarithm_is_integrated_and_a_slower_one_refused():
    steep = IsotropicPotential(lambda r: 6 * np.log1p(r), lambda r: 6 / (1 + r))
    # ∫ 2π r (1 + r)^-6 dr = 2π (1/4 - 1/5); the tail left out is below 1e-18.
    assert steep.partition_function == pytest.approx(2 * math.pi / 20, rel=1e-10)
    flat = IsotropicPotential(lambda r: 2 * np.log1p(r), lambda r: 2 / (1 + r))
    assert flat.partition_function == math.inf


def test_a_kink_across_the_rings_keeps_the_accuracy_promised():
    kinked = CallablePotential(
        lambda x, y: np.abs(x - 0.3) + np.abs(y),
        lambda x, y: (np.sign(x - 0.3), np.sign(y)),
    )
    assert kinked.partition_function == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize("constant", [-1e4, -800.0, 800.0, 1e4])
def test_a_constant_added_to_b_is_subtracted_from_the_logarithm_of_z(constant):
    lifted = IsotropicPotential(lambda r: constant + r, np.ones_like)
    assert lifted.normalisable
    # B is known to the rounding of the constant.
    assert lifted.log_partition_function == pytest.approx(
        math.log(2 * math.pi) - constant, rel=1e-15, abs=1e-11
    )
    pattern = r"`partition_function` must be within .* subtract the minimum of B, or"
    with pytest.raises(ValueError, match=pattern):
        _ = lifted.partition_function


def test_a_potential_that_is_nan_far_out_is_refused():
    broken = IsotropicPotential(
        lambda r: np.where(r < 4, r**2 / 2, np.nan), lambda r: r
    )
    with pytest.raises(ValueError, match="`value` must be a number, got NaN at radius"):
        _ = broken.partition_function


def test_a_potential_too_rough_to_integrate_is_refused():
    def steps(xi1, xi2):
        return 5.0 * (np.floor(37 * np.abs(xi1 - 0.31 + xi2**2 / 7)) % 2)

    rough = CallablePotential(
        lambda x, y: x**2 + y**2 + steps(x, y), lambda x, y: (2 * x, 2 * y)
    )
    with pytest.raises(ValueError, match=r"got .* with error .*; smooth B, scale it"):
        _ = rough.partition_function


# --- errors -------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("build", "name"),
    [
        (lambda x: QuadraticPotential(sigma1=x), "sigma1"),
        (lambda x: QuadraticPotential(sigma2=x), "sigma2"),
        (lambda x: LinearPotential(slope=x), "slope"),
        (lambda x: PowerPotential(2, scale=x), "scale"),
    ],
)
def test_scales_are_positive_and_finite(build, name, wrong):
    message = f"^`{name}` must be positive and finite, got {wrong:g}.$"
    with pytest.raises(ValueError, match=message):
        build(wrong)


@pytest.mark.parametrize("wrong", [1e-200, 1e200])
def test_scales_whose_squares_are_no_floats_are_refused(wrong):
    for build in (QuadraticPotential, LinearPotential, lambda x: PowerPotential(2, x)):
        with pytest.raises(ValueError, match=r"must lie between 1e-75 and 1e\+75, got"):
            build(wrong)


@pytest.mark.parametrize("wrong", [0.99, -2.0, math.nan, math.inf])
def test_an_exponent_is_at_least_one(wrong):
    with pytest.raises(ValueError, match=f"at least 1 and finite, got {wrong:g}; belo"):
        PowerPotential(exponent=wrong)


@pytest.mark.parametrize("wrong", ["1", None, [1.0, 2.0], True, 1j])
def test_parameters_are_numbers(wrong):
    with pytest.raises(TypeError, match=r"^`sigma1` must be a real number, got "):
        QuadraticPotential(sigma1=wrong)


def test_user_functions_are_callable():
    with pytest.raises(TypeError, match=r"^`value` must be callable, got 1.0\.$"):
        IsotropicPotential(1.0, np.ones_like)
    with pytest.raises(TypeError, match=r"^`derivative` must be callable, got None"):
        IsotropicPotential(np.abs, None)
    with pytest.raises(TypeError, match=r"^`gradient` must be callable, got 'no'"):
        CallablePotential(double_well, "no")


def test_a_scalar_function_is_refused_with_the_way_out():
    with pytest.raises(ValueError, match=r"`value` must work elementwise .* raised Ty"):
        IsotropicPotential(math.sqrt, np.ones_like)
    with pytest.raises(ValueError, match=r"use numpy functions and `np\.where`\.$"):
        CallablePotential(lambda x, y: x if x > y else y, double_well_gradient)


def test_a_function_that_reduces_is_refused():
    with pytest.raises(
        ValueError, match=r"elementwise, got shape \(2,\) for arguments"
    ):
        IsotropicPotential(lambda r: r[:2], np.ones_like)


def test_a_gradient_is_a_pair():
    with pytest.raises(ValueError, match=r"must return the pair .*, got float"):
        CallablePotential(double_well, lambda x, y: 1.0)
    with pytest.raises(ValueError, match=r"must return the pair .*, got tuple"):
        CallablePotential(double_well, lambda x, y: (x, y, x))


def test_user_functions_return_real_numbers():
    with pytest.raises(TypeError, match="`value` must return real numbers, got compl"):
        IsotropicPotential(lambda r: r + 0j, np.ones_like)


def test_user_functions_are_finite_at_the_probes():
    with pytest.raises(
        ValueError, match=r"`derivative` must be finite, got nan at r ="
    ):
        IsotropicPotential(np.abs, lambda r: np.where(r > 1, np.nan, 1.0))
    with pytest.raises(ValueError, match=r"`value` must be finite, got inf at xi = \("):
        CallablePotential(lambda x, y: x + np.inf, double_well_gradient)


def test_a_wrong_derivative_is_named_with_both_numbers_and_the_point():
    with pytest.raises(
        ValueError,
        match=r"`derivative` must be the derivative of `value`, got -0\.0531 where "
        r"central differences give 0\.0531 at r = 0\.0531\.$",
    ):
        IsotropicPotential(lambda r: r**2 / 2, lambda r: -r)
    with pytest.raises(ValueError, match=r"^`gradient\[1\]` must be .* at xi = \("):
        CallablePotential(lambda x, y: x**2 / 2 + y**2, lambda x, y: (x, y))


@given(factor=st.floats(0.5, 2.0).filter(lambda factor: abs(factor - 1) > 1e-3))
def test_a_gradient_wrong_by_a_thousandth_is_noticed(factor):
    with pytest.raises(ValueError, match="must be the derivative of `value`"):
        IsotropicPotential(soft_linear, lambda r: factor * soft_linear_derivative(r))


@given(scale=st.floats(0.05, 20.0), exponent=st.floats(1.0, 8.0))
def test_a_right_gradient_is_accepted_on_every_scale(scale, exponent):
    power = PowerPotential(exponent, scale)
    potential = IsotropicPotential(power.radial_value, power.radial_derivative)
    assert potential.value(1.0, 1.0) == power.value(1.0, 1.0)


def test_dictionaries_of_functions_are_refused():
    for potential in USER:
        description = json.loads(json.dumps(potential.to_dict()))
        assert description["kind"] == "callable"
        with pytest.raises(ValueError, match=r"must not be made of functions .* build"):
            potential_from_dict(description)


def test_unknown_kinds_and_parameters_are_named_with_the_known_ones():
    with pytest.raises(
        ValueError,
        match="must be one of 'quadratic', 'linear', 'power', 'free', got 'cubic'",
    ):
        potential_from_dict({"kind": "cubic"})
    with pytest.raises(
        ValueError, match="parameters of `quadratic` must be sigma1, sigma2, got sigma:"
    ):
        potential_from_dict({"kind": "quadratic", "sigma": 1.0})
    with pytest.raises(ValueError, match="missing a required argument: 'exponent'"):
        potential_from_dict({"kind": "power"})


@pytest.mark.parametrize("parent", [QuadraticPotential, LinearPotential])
def test_closed_forms_are_not_inherited_by_other_values(parent):
    # Z, spectra and limits of the parent would be used with them.
    with pytest.raises(TypeError, match="`Stiff` must be derived from Potential t"):
        type("Stiff", (parent,), {"gradient": lambda self, xi1, xi2: (xi1, xi2)})
    named = type("Named", (parent,), {"formula": "B"})
    assert named().partition_function == parent().partition_function
