"""Var ξ and the gap of smooth fibres to first order in R, against what is known."""

import math
import pickle

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import studies
from fpsolve.errors import ToleranceError
from fpsolve.studies.constants.relaxation_slopes import Slope

UNIT = fp.QuadraticPotential()


def model(noise, sigma=1.0):
    return fp.LayDownModel(fp.QuadraticPotential(sigma, sigma), noise)


@pytest.mark.parametrize(
    ("noise", "value"), [(1.0, 1.20768669), (2.0, 2.24053166), (5.0, 12.5399574)]
)
def test_the_slope_of_the_variance_is_that_of_an_independent_computation(noise, value):
    # Of the curvature's own equation at small R; all digits that were kept.
    found = studies.variance_slope(model(noise))
    assert found == pytest.approx(value, rel=5e-9)
    assert found.error < 1e-9


def test_the_slope_of_a_rate_is_that_of_an_independent_computation():
    found = studies.gap_slope(model(3.0))
    assert -found == pytest.approx(0.0127984857, rel=5e-9)
    assert found.error < 1e-9


@pytest.mark.parametrize("noise", [0.3, 0.5])
def test_for_little_noise_the_slope_of_the_gap_is_a_third(noise):
    # The mode e^{−B} ξ·τ⊥ of the rate A²/2: λ' = 1 − E r⁴/E r² under r e^{−3r²/2} dr,
    # which is 1 − 4/3.
    found = studies.gap_slope(model(noise))
    assert float(found) == pytest.approx(1 / 3, rel=1e-11)
    assert abs(found - 1 / 3) <= found.error


def test_for_large_noise_both_slopes_are_those_of_the_hydrodynamic_limit():
    # Var ξ₁ = ₁F₁(1; a+1; a) = 1 + a + …, a = A²R/2, and rates that do not know of R;
    # corrections O(A⁻²) of the slope A²/2, so O(A⁻⁴) of it.
    found = np.array([studies.variance_slope(model(noise)) for noise in (8.0, 16.0)])
    excess = found / (np.array([8.0, 16.0]) ** 2 / 2) - 1
    assert (excess > 0).all()
    assert math.log2(excess[0] / excess[1]) == pytest.approx(4.0, abs=0.05)
    slopes = [-studies.gap_slope(model(noise)) for noise in (8.0, 16.0)]
    # A relative change of the rate A⁻² by R A⁻², which is itself R A² times A⁻⁴.
    assert math.log2(slopes[0] / slopes[1]) == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("sigma", [0.5, 2.0])
def test_slopes_of_another_size_of_the_pattern_follow_by_scaling(sigma):
    # ξ = σ x, s = σ t, R = σ P, A = a/√σ: Var ξ = σ² Var x, and rates over σ.
    noise = 2.0
    scaled = model(noise / math.sqrt(sigma), sigma)
    variance, gap = (
        studies.variance_slope(model(noise)),
        studies.gap_slope(model(noise)),
    )
    assert studies.variance_slope(scaled) == pytest.approx(sigma * variance, rel=1e-10)
    assert studies.gap_slope(scaled) == pytest.approx(gap / sigma**2, rel=1e-10)


def test_a_smooth_model_stands_for_its_limit():
    smooth = fp.SmoothLayDownModel(UNIT, 0.3, 2.0)
    assert studies.variance_slope(smooth) == studies.variance_slope(model(2.0))
    assert studies.gap_slope(smooth) == studies.gap_slope(model(2.0))


def test_a_slope_is_a_float_that_keeps_its_error():
    found = pickle.loads(pickle.dumps(Slope(1.5, 1e-9)))
    assert (found, found.error) == (1.5, 1e-9)


def test_the_error_contains_what_another_tolerance_changes():
    rough, fine = (
        studies.variance_slope(model(0.7), tolerance=tolerance)
        for tolerance in (1e-2, 1e-10)
    )
    assert rough.error > fine.error
    assert 0 < abs(rough - fine) <= rough.error


def test_models_without_these_derivatives_are_refused():
    for function in (studies.variance_slope, studies.gap_slope):
        with pytest.raises(ValueError, match="`potential` must be ‖ξ‖²/"):
            function(fp.LayDownModel(fp.QuadraticPotential(1.0, 0.5), 1.0))
        with pytest.raises(ValueError, match="`curve` must be a belt at rest for deri"):
            function(fp.LayDownModel(UNIT, 1.0, fp.MovingBelt(0.1)))
        with pytest.raises(
            ValueError, match="`noise` must be positive, got 0; without"
        ):
            function(fp.LayDownModel(UNIT, 0.0))
        with pytest.raises(TypeError, match="`model` must be a LayDownModel or a "):
            function(1.0)
        with pytest.raises(ValueError, match="`tolerance` must be"):
            function(model(1.0), tolerance=math.nan)
    with pytest.raises(ToleranceError, match="enlarge `tolerance`, or the noise, "):
        studies.variance_slope(model(0.1))
