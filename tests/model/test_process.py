"""SI units and back."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fpsolve.model.curves import FixedBelt, MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.model.process import Process

PROCESS = Process(
    sigma1=4e-3, sigma2=8e-3, noise=20.0, speed_ratio=0.1, spinning_speed=2.0
)

processes = st.builds(
    Process,
    sigma1=st.floats(1e-3, 50e-3),
    sigma2=st.floats(1e-3, 50e-3),
    noise=st.floats(1.0, 50.0),
    speed_ratio=st.floats(0.01, 0.25),
    spinning_speed=st.floats(0.1, 100.0),
)


@given(process=processes)
def test_the_dimensionless_model_is_that_of_remark_3_1(process):
    assert process.model == LayDownModel(
        QuadraticPotential(1.0, process.sigma2 / process.sigma1),
        noise=math.sqrt(process.sigma1) * process.noise,
        curve=MovingBelt(process.speed_ratio),
    )


def test_a_process_in_numbers():
    # σ1 = 4 mm: A* = √0.004 · 20 = 1.2649, one unit of s takes 4 mm / (2 m/s) = 2 ms.
    assert PROCESS.model.noise == pytest.approx(1.2649, abs=5e-5)
    assert PROCESS.model.potential == QuadraticPotential(1.0, 2.0)
    assert PROCESS.length == 4e-3
    assert PROCESS.time == 2e-3
    assert PROCESS.to_metres(3.0) == pytest.approx(12e-3)
    assert PROCESS.to_seconds(10.0) == pytest.approx(20e-3)
    assert PROCESS.rate_per_metre(0.3) == pytest.approx(75.0)
    assert PROCESS.rate_per_second(0.3) == pytest.approx(150.0)
    assert PROCESS.area_density(1.0) == pytest.approx(62_500.0)


@given(process=processes, s=st.floats(0.0, 1e4), rate=st.floats(0.0, 10.0))
def test_decay_over_a_length_is_the_same_in_all_units(process, s, rate):
    exponent = rate * s
    metres, seconds = process.to_metres(s), process.to_seconds(s)
    # A handful of multiplications and divisions.
    assert process.rate_per_metre(rate) * metres == pytest.approx(exponent, rel=1e-14)
    assert process.rate_per_second(rate) * seconds == pytest.approx(exponent, rel=1e-14)
    assert process.from_metres(metres) == pytest.approx(s, rel=1e-14)
    assert seconds * process.spinning_speed == pytest.approx(float(metres), rel=1e-14)


@given(process=processes)
def test_the_noise_gains_the_same_angle_in_both_units(process):
    # A² s is the variance of the angle that the noise alone adds over a length s.
    s = 7.0
    in_metres = process.noise**2 * process.to_metres(s)
    assert in_metres == pytest.approx(process.model.noise**2 * s, rel=1e-14)


@given(process=processes)
def test_the_mass_on_an_area_is_the_same_in_both_units(process):
    p, area = 0.3, 5.0
    square_metres = process.to_metres(1.0) * process.to_metres(area)
    assert process.area_density(p) * square_metres == pytest.approx(p * area)


def test_conversions_take_arrays():
    s = np.array([[0.0, 1.0], [2.0, 3.0]])
    np.testing.assert_allclose(PROCESS.to_seconds(s), 2e-3 * s, rtol=1e-15)


def test_a_belt_at_rest_and_a_process_without_noise_are_limiting_cases():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        process = Process(4e-3, 4e-3, noise=0.0, speed_ratio=0.0, spinning_speed=2.0)
    assert process.model.curve == FixedBelt()
    assert process.model.noise == 0


@pytest.mark.parametrize(
    ("slip", "message"),
    [
        ({"sigma1": 0.4}, "`sigma1` is 0.4 m, outside .* 0.001 to 0.05 m; millimetres"),
        ({"sigma2": 4e-4}, "`sigma2` is 0.0004 m, outside the industrial range"),
        (
            {"noise": 0.3},
            r"`noise` is 0.3 m\^-1/2, outside .* 1 to 50 m.*; the dimension",
        ),
        (
            {"speed_ratio": 0.5},
            "`speed_ratio` is 0.5, outside .* 0.01 to 0.25; per cent",
        ),
    ],
)
def test_a_likely_slip_of_units_is_reported(slip, message):
    numbers = {
        "sigma1": 4e-3,
        "sigma2": 4e-3,
        "noise": 20.0,
        "speed_ratio": 0.1,
        "spinning_speed": 2.0,
    }
    with pytest.warns(UserWarning, match=message) as caught:
        Process(**(numbers | slip))
    assert [warning.filename for warning in caught] == [__file__]


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan])
@pytest.mark.parametrize("name", ["sigma1", "sigma2", "spinning_speed"])
def test_lengths_and_speeds_are_positive(name, wrong):
    numbers = {
        "sigma1": 4e-3,
        "sigma2": 4e-3,
        "noise": 20.0,
        "speed_ratio": 0.1,
        "spinning_speed": 2.0,
    }
    message = f"^`{name}` must be positive and finite, got {wrong:g}.$"
    with pytest.raises(ValueError, match=message):
        Process(**(numbers | {name: wrong}))


def test_noise_and_speed_ratio_are_checked():
    with pytest.raises(ValueError, match="`noise` must be non-negative and finite"):
        Process(4e-3, 4e-3, -1.0, 0.1, 2.0)
    with pytest.raises(
        ValueError, match="`speed_ratio` must lie strictly between -1 an"
    ):
        Process(4e-3, 4e-3, 20.0, 10.0, 2.0)
