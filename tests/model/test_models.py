"""The continuous problem: drift, equilibrium, and how a model shows itself."""

import doctest
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fpsolve.model.curves import (
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
)
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    FreePotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)

MODEL = LayDownModel(QuadraticPotential(), noise=1.0)
POTENTIALS = [
    QuadraticPotential(0.7, 1.9),
    LinearPotential(1.5),
    PowerPotential(exponent=4),
]
coordinates = st.floats(-4.0, 4.0)
angles = st.floats(0.0, 2 * math.pi)


@given(xi1=coordinates, xi2=coordinates, alpha=angles, s=st.floats(0.0, 100.0))
def test_drift_is_tangent_minus_curve_velocity_and_the_restoring_turn(
    xi1, xi2, alpha, s
):
    curve = RotatingNozzle(0.1, 2.0, 0.5)
    model = LayDownModel(QuadraticPotential(1.0, 2.0), 1.0, curve)
    drift = model.drift(xi1, xi2, alpha, s)
    expected = (
        math.cos(alpha) + 0.1 + 2.0 * 0.5 * math.sin(0.5 * s),
        math.sin(alpha) - 2.0 * 0.5 * math.cos(0.5 * s),
        # -∇B·τ⊥ with ∇B = (ξ1, ξ2/4), τ⊥ = (-sin, cos)
        xi1 * math.sin(alpha) - xi2 / 4 * math.cos(alpha),
    )
    # A few operations on numbers of size 4.
    assert drift == pytest.approx(expected, abs=1e-14)


@given(speed=st.floats(-0.9, 0.9), alpha=angles)
def test_a_belt_carries_the_deviation_along_its_own_direction(speed, alpha):
    # Minus γ', not plus: equation (17) has τ + v e1.
    model = LayDownModel(FreePotential(), 0.0, MovingBelt(speed))
    dxi1, dxi2, dalpha = model.drift(0.0, 0.0, alpha)
    assert dxi1 == math.cos(alpha) + speed
    assert dxi2 == math.sin(alpha)
    assert dalpha == 0


@pytest.mark.parametrize("potential", POTENTIALS, ids=repr)
@given(r=st.floats(0.1, 3.0), phi=angles, alpha=angles)
def test_the_fixed_belt_drift_conserves_the_equilibrium(potential, r, phi, alpha):
    # Stationarity of (9): ∇·(b p_S) = τ·∇p_S - ∂_α(∇B·τ⊥) p_S = 0, by differences.
    model = LayDownModel(potential, noise=1.0)
    xi1, xi2, step = r * math.cos(phi), r * math.sin(phi), 1e-5

    def flux(axis, shift):
        point = np.array([xi1, xi2, alpha])
        point[axis] += shift
        return model.drift(*point)[axis] * model.equilibrium(*point[:2])

    divergence = sum(
        (flux(axis, step) - flux(axis, -step)) / (2 * step) for axis in range(3)
    )
    # Truncation step² p_S'''/6 with p_S''' of a few 100, rounding eps/step: 1e-8.
    assert divergence == pytest.approx(0.0, abs=1e-8)


@given(xi1=coordinates, xi2=coordinates, alpha=angles)
def test_without_noise_the_energy_is_conserved_by_isotropic_potentials(xi1, xi2, alpha):
    # G = e^{-B} (ξ1 sin α - ξ2 cos α): b·∇G = 0.
    model = LayDownModel(PowerPotential(3), noise=0.0)
    step = 1e-5

    def energy(x, y, a):
        weight = math.exp(-model.potential.value(x, y))
        return weight * (x * math.sin(a) - y * math.cos(a))

    point = np.array([xi1, xi2, alpha])
    change = 0.0
    for axis, speed in enumerate(model.drift(*point)):
        ahead, behind = point.copy(), point.copy()
        ahead[axis] += step
        behind[axis] -= step
        change += speed * (energy(*ahead) - energy(*behind)) / (2 * step)
    # Truncation step² G''' times the drift, below 1e-8; rounding eps/step times 16.
    assert change == pytest.approx(0.0, abs=2e-8)


def test_drift_keeps_the_shapes_it_needs():
    xi1, xi2, alpha = np.ones((6, 1, 1)), np.ones((1, 7, 1)), np.ones((1, 1, 8))
    shapes = [part.shape for part in MODEL.drift(xi1, xi2, alpha)]
    assert shapes == [(1, 1, 8), (1, 1, 8), (6, 7, 8)]


@pytest.mark.parametrize("potential", POTENTIALS, ids=repr)
def test_the_equilibrium_has_mass_one_on_the_plane_times_the_circle(potential):
    model = LayDownModel(potential, noise=3.0, curve=MovingBelt(0.1))
    # Midpoint rule on [-30, 30]²: beyond, exp(-45) is left; inside, second order at
    # the kink of |ξ| with h = 0.05, smaller than 1e-4.
    centres = -30 + 0.05 * (np.arange(1200) + 0.5)
    density = model.equilibrium(centres[:, None], centres[None, :])
    mass = 2 * math.pi * 0.05**2 * density.sum()
    assert mass == pytest.approx(1.0, abs=1e-4)


def test_the_equilibrium_of_the_standard_potential_is_gaussian():
    assert MODEL.equilibrium(0.0, 0.0) == pytest.approx(1 / (2 * math.pi) ** 2)


def test_an_equilibrium_needs_a_belt_at_rest_and_a_potential_that_confines():
    quadratic = QuadraticPotential()
    assert LayDownModel(quadratic, 1.0).has_equilibrium
    assert LayDownModel(quadratic, 1.0, MovingBelt(0.0)).has_equilibrium
    assert not LayDownModel(quadratic, 1.0, MovingBelt(0.1)).has_equilibrium
    assert not LayDownModel(FreePotential(), 1.0).has_equilibrium


def test_diffusivity_is_half_the_squared_noise():
    assert LayDownModel(QuadraticPotential(), noise=3.0).diffusivity == 4.5


def test_the_belt_is_at_rest_unless_said():
    assert MODEL.curve == FixedBelt()
    assert MODEL.belt_speed == 0
    assert LayDownModel(QuadraticPotential(), 1.0, MovingBelt(0.2)).belt_speed == 0.2


@pytest.mark.parametrize("potential", [*POTENTIALS, FreePotential()], ids=repr)
@pytest.mark.parametrize(
    "curve", [FixedBelt(), MovingBelt(0.1), OscillatingNozzle(0.1, 2, 0.5)], ids=repr
)
def test_a_dictionary_brings_the_model_back_through_json(potential, curve):
    model = LayDownModel(potential, noise=0.3, curve=curve)
    copy = LayDownModel.from_dict(json.loads(json.dumps(model.to_dict())))
    assert copy == model
    assert hash(copy) == hash(model)


def test_repr_shows_the_parameters_and_the_equation():
    assert repr(MODEL) == (
        "LayDownModel(potential=QuadraticPotential(sigma1=1.0, sigma2=1.0), "
        "noise=1.0, curve=FixedBelt())\n"
        "  ∂ₛp + τ(α)·∇p - ∂_α(∇B·τ⊥ p) = 0.5 ∂_αα p, B = (ξ₁² + ξ₂²)/2"
    )


def test_the_equation_follows_the_curve_and_the_noise():
    linear = LinearPotential()
    equations = [
        LayDownModel(linear, 2.0, MovingBelt(0.1)).equation,
        LayDownModel(linear, 2.0, MovingBelt(-0.1)).equation,
        LayDownModel(linear, 0.0, OscillatingNozzle(0.1, 2, 0.5)).equation,
    ]
    turn = "∂_α(∇B·τ⊥ p)"
    assert equations == [
        f"∂ₛp + (τ(α) + 0.1 e₁)·∇p - {turn} = 2 ∂_αα p, B = ‖ξ‖",
        f"∂ₛp + (τ(α) - 0.1 e₁)·∇p - {turn} = 2 ∂_αα p, B = ‖ξ‖",
        f"∂ₛp + (τ(α) - γ'(s))·∇p - {turn} = 0, B = ‖ξ‖, "
        "γ(s) = -0.1 s e₁ + (0, 2 sin(0.5 s))",
    ]


def test_latex_shows_the_same_equation():
    turn = r"\partial_\alpha(\nabla B\cdot\tau^\perp p)"
    assert MODEL._repr_latex_() == (
        r"$\partial_s p + \tau(\alpha)\cdot\nabla_\xi p - "
        rf"{turn} = 0.5\,\partial_{{\alpha\alpha}} p,\qquad "
        r"B(\xi) = \frac12\left(\xi_1^2 + \xi_2^2\right)$"
    )
    belt = LayDownModel(LinearPotential(), 0.0, MovingBelt(0.1))
    assert belt._repr_latex_() == (
        r"$\partial_s p + (\tau(\alpha) + 0.1\,e_1)\cdot\nabla_\xi p - "
        rf"{turn} = 0,\qquad B(\xi) = \|\xi\|$"
    )
    swinging = LayDownModel(LinearPotential(), 1.0, OscillatingNozzle(0.0, 2, 0.5))
    assert r"(\tau(\alpha) - \gamma'(s))\cdot" in swinging._repr_latex_()
    assert swinging._repr_latex_().endswith(r"\gamma(s) = (0,\ 2\sin(0.5 s))$")


@pytest.mark.parametrize("wrong", [-1.0, math.nan, math.inf])
def test_noise_is_non_negative(wrong):
    message = f"^`noise` must be non-negative and finite, got {wrong:g}.$"
    with pytest.raises(ValueError, match=message):
        LayDownModel(QuadraticPotential(), wrong)


def test_a_model_is_made_of_a_potential_a_number_and_a_curve():
    with pytest.raises(
        TypeError, match=r"`potential` must be a Potential, got 1.0; wrap"
    ):
        LayDownModel(1.0, 1.0)
    with pytest.raises(TypeError, match="`noise` must be a real number, got None"):
        LayDownModel(QuadraticPotential(), None)
    with pytest.raises(
        TypeError, match=r"`curve` must be a Curve, got 0.1; use MovingBel"
    ):
        LayDownModel(QuadraticPotential(), 1.0, 0.1)


def test_without_a_confining_potential_there_is_no_equilibrium_density():
    with pytest.raises(
        ValueError, match=r"normalisable .* got FreePotential\(\); choose"
    ):
        LayDownModel(FreePotential(), 1.0).equilibrium(0.0, 0.0)


def test_a_model_of_functions_is_described_but_not_read_back():
    flat = CallablePotential(lambda x, y: x**2 + y**2, lambda x, y: (2 * x, 2 * y))
    description = LayDownModel(flat, 1.0).to_dict()
    with pytest.raises(ValueError, match="must not be made of functions"):
        LayDownModel.from_dict(json.loads(json.dumps(description)))


def test_unknown_and_missing_parameters_of_a_stored_model_are_named():
    with pytest.raises(
        ValueError, match="`model` must be potential, noise, curve, got"
    ):
        LayDownModel.from_dict({"noise": 1.0})


def test_the_examples_of_the_model_page_run_as_printed():
    page = Path(__file__).parents[2] / "docs" / "model.md"
    result = doctest.testfile(str(page), module_relative=False)
    assert result.attempted > 0
    assert result.failed == 0
