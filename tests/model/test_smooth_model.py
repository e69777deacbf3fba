"""The smooth model (22): what it is made of, what it says of itself, its limit."""

import json
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import fpsolve as fp
from fpsolve.evolution.call import described
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.model.reading import model_from_dict

SMOOTH = fp.SmoothLayDownModel(
    fp.QuadraticPotential(1.0, 2.0), 0.5, 1.5, fp.MovingBelt(0.1)
)
GRID = fp.PhaseSpaceGrid(4.0, (8, 8, 8))
amplitudes = st.floats(1e-3, 1e3)


@given(length=amplitudes, noise=amplitudes)
def test_both_amplitudes_describe_one_model(length, noise):
    by_angle = fp.SmoothLayDownModel(fp.FreePotential(), length, noise)
    curvature_noise = by_angle.curvature_noise
    by_curvature = fp.SmoothLayDownModel(
        fp.FreePotential(), length, curvature_noise=curvature_noise
    )
    # A division and a multiplication.
    assert by_curvature.noise == pytest.approx(noise, rel=1e-15)
    expected = curvature_noise**2 * length / 2
    assert by_angle.curvature_variance == pytest.approx(expected, rel=1e-15)


@given(
    xi1=st.floats(-4, 4), xi2=st.floats(-4, 4),
    alpha=st.floats(0, 7), kappa=st.floats(-9, 9),
)  # fmt: skip
def test_the_drift_moves_the_angle_by_the_curvature_and_relaxes_the_curvature(
    xi1, xi2, alpha, kappa
):
    *motion, turn, relaxation = SMOOTH.drift(xi1, xi2, alpha, kappa)
    force = SMOOTH.white_noise_limit.drift(xi1, xi2, alpha)[2]
    assert turn == kappa
    # Minus the gradient: (22) prints κ + τ⊥·∇B, and -∇B·τ⊥ is the drift of (6).
    assert relaxation == pytest.approx((force - kappa) / 0.5, abs=1e-13)
    assert motion == [math.cos(alpha) + 0.1, math.sin(alpha)]


def test_the_white_noise_limit_is_the_basic_model_with_the_same_noise():
    limit = fp.LayDownModel(
        fp.QuadraticPotential(1.0, 2.0), noise=1.5, curve=fp.MovingBelt(0.1)
    )
    assert SMOOTH.white_noise_limit == limit
    assert SMOOTH.belt_speed == 0.1


def test_the_equations_are_those_of_the_paper_in_numbers():
    # K = 1.5/0.5 = 3, K²/2 = 4.5.
    assert SMOOTH.equation.startswith(
        "∂ₛp + (τ(α) + 0.1 e₁)·∇p + κ ∂_α p - ∂_κ((κ + ∇B·τ⊥) p)/0.5 = 4.5 ∂_κκ p, B ="
    )
    assert SMOOTH.process_equation.startswith(
        "dξ = (τ(α) + 0.1 e₁) ds, dα = κ ds, dκ = -(κ + ∇B(ξ)·τ⊥(α))/0.5 ds + 3 dW, B"
    )
    assert repr(SMOOTH).endswith(f"curve=MovingBelt(speed=0.1))\n  {SMOOTH.equation}")
    assert SMOOTH._repr_latex_().startswith(
        r"$\partial_s p + (\tau(\alpha) + 0.1\,e_1)"
    )
    assert len(SMOOTH.process_latex) == 3


def test_without_noise_and_with_unit_length_the_equations_say_less():
    calm = fp.SmoothLayDownModel(fp.QuadraticPotential(), 1.0, 0.0)
    assert "- ∂_κ((κ + ∇B·τ⊥) p) = 0, B" in calm.equation
    assert "dκ = -(κ + ∇B(ξ)·τ⊥(α)) ds, B" in calm.process_equation
    assert calm.latex.endswith(r"\tau^\perp) p) = 0")


def test_a_model_comes_back_from_its_dictionary_and_from_a_pickle():
    written = json.loads(json.dumps(SMOOTH.to_dict()))
    assert model_from_dict(written) == SMOOTH
    assert pickle.loads(pickle.dumps(SMOOTH)) == SMOOTH
    assert described(SMOOTH, "model", {}) == {"$model": SMOOTH.to_dict()}
    basic = SMOOTH.white_noise_limit
    assert model_from_dict(json.loads(json.dumps(basic.to_dict()))) == basic


def test_models_that_differ_are_told_apart():
    longer = replace(SMOOTH, relaxation_length=0.6)
    # A, not K, is what stays when another length is put in its place.
    assert longer.noise == SMOOTH.noise
    models = [SMOOTH, longer, SMOOTH.white_noise_limit]
    assert len({digest_or_none(model) for model in models}) == 3
    assert len(set(models)) == 3


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"noise": 1.0, "curvature_noise": 1.0}, TypeError, "`noise` and `curv.* both"),
        ({}, TypeError, "exactly one of `noise` and `curvature_noise` .* neither"),
        ({"noise": -1.0}, ValueError, "`noise` must be non-negative"),
        ({"curvature_noise": -1.0}, ValueError, "`curvature_noise` must be non-neg"),
        ({"noise": 1e61}, ValueError, "`noise` must be at most"),
        ({"curvature_noise": math.nan}, ValueError, "`curvature_noise` must be non-n"),
        ({"noise": 1.0, "curve": 0.1}, TypeError, "`curve` must be a Curve, got 0.1"),
    ],
)
def test_wrong_amplitudes_and_curves_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        fp.SmoothLayDownModel(fp.QuadraticPotential(), 1.0, **arguments)


@pytest.mark.parametrize("length", [0.0, -1.0, math.nan, math.inf])
def test_a_relaxation_length_must_be_positive(length):
    with pytest.raises(ValueError, match=r"`relaxation_length` must be pos.* LayDo"):
        fp.SmoothLayDownModel(fp.QuadraticPotential(), length, 1.0)


@pytest.mark.parametrize("length", [1e-16, 1e16])
def test_an_extreme_relaxation_length_is_refused(length):
    with pytest.raises(ValueError, match="`relaxation_length` must lie between 1e-15"):
        fp.SmoothLayDownModel(fp.QuadraticPotential(), length, 1.0)


def test_a_potential_must_be_one():
    with pytest.raises(TypeError, match="`potential` must be a Potential, got 3"):
        fp.SmoothLayDownModel(3, 1.0, 1.0)


def test_what_is_for_the_basic_model_only_says_so_and_names_the_limit():
    with pytest.raises(
        TypeError, match=r"(?s)LayDownModel, got Smooth.*`white_noise_lim"
    ):
        fp.drift_kick(SMOOTH, GRID)


def test_a_process_with_a_relaxation_length_has_the_smooth_model():
    process = fp.Process(4e-3, 8e-3, 20.0, 0.1, 2.0, relaxation_length=2e-3)
    basic = fp.Process(4e-3, 8e-3, 20.0, 0.1, 2.0).model
    assert process.model.relaxation_length == 0.5
    assert process.model.white_noise_limit == basic
    # κ in 1/m: K* = √σ1³ K with K = A/R in m^-3/2.
    expected = np.sqrt(4e-3) ** 3 * 20.0 / 2e-3
    assert process.model.curvature_noise == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("length", "message"),
    [(0.0, "must be positive"), (2.0, "at most 0.5 m.*millimetr")],
)
def test_a_relaxation_length_that_is_a_slip_of_units_is_refused(length, message):
    with pytest.raises(ValueError, match=f"`relaxation_length` .*{message}"):
        fp.Process(4e-3, 8e-3, 20.0, 0.1, 2.0, relaxation_length=length)
