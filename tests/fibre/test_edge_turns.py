"""Noise turns edges by a known angle in a step: too much is warned of, and refused."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import fibre
from fpsolve.fibre.edge_turns import EdgeTurns, edge_turn
from fpsolve.fibre.random_force import Draws
from fpsolve.fibre.theta_step import ThetaStep

SPUN = fibre.String(
    0.2, 2e-4, 1000.0, 1e8, n_edges=10, end=fibre.Free(),
    start=fibre.Nozzle((0.0, 0.0, 0.25), (0.1, 0.03, -1.0), 1.0),
)  # fmt: skip
# Steps of 10 ms, edges of 2 cm.
T_END, N_STEPS = 0.2, 20


def turn_of(amplitude, string=SPUN, dt=T_END / N_STEPS, drag=0.0, time=0.0, theta=0.6):
    one = np.ones(1)
    return edge_turn(string, dt, theta, amplitude * one, drag * one, time)


def laid(turn, n_steps=N_STEPS, air=None):
    law = fibre.RandomForce(turn / turn_of(1.0))
    return fibre.lay_down(
        SPUN, T_END, n_steps, belt=fibre.Belt(0.3), turbulence=law, seed=1, air=air,
        estimate_error=False,
    )  # fmt: skip


def judge(law, air):
    return EdgeTurns(law, SPUN, air, 0.6, T_END, N_STEPS)


def test_without_stiffness_and_air_the_angle_is_that_of_free_nodes():
    """√2 A (Δ/h)^{3/2}/ρA; the stiffness of 1e-20 Pa moves less than rounding."""
    soft, dt = replace(SPUN, youngs_modulus=1e-20), 1e-3
    expected = math.sqrt(2) * 3e-6 * (dt / soft.edge) ** 1.5 / soft.line_density
    assert turn_of(3e-6, soft, dt) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("stiffness", "damping", "time"),
    [(1e8, 0.0, 0.0), (1e9, 0.0, 0.0), (1e8, 0.02, 0.0), (1e8, 0.0, 5e-3)],
)
def test_edges_of_a_straight_fibre_turn_by_that_angle_in_a_step(
    stiffness, damping, time
):
    """Of one step of the scheme itself; noise so weak that edges stay straight."""
    string = fibre.String(
        4.0, 2e-4, 1000.0, stiffness, fibre.Free(), fibre.Free(), n_edges=400,
        gravity=(0.0, 0.0, 0.0),
    )  # fmt: skip
    dt, law = 4e-3, fibre.RandomForce(1e-10, time)
    step = ThetaStep(string, dt, 0.6, damping)
    r = string.s[:, None] * np.array([1.0, 0.0, 0.0])
    v, rest = np.zeros_like(r), np.zeros(400)
    squares = []
    for seed in range(4):
        force = Draws(law, string, None, dt, seed).value(1, r, v, 0.0)
        moved = step(r, v, rest, 0.0, force)[1]
        # The ends, where half as much is moved, are left out.
        turned = dt * np.diff(moved[:, 1:], axis=0)[20:-20] / string.edge
        squares.append((turned**2).mean())
    found, exact = (
        math.sqrt(np.mean(squares)),
        turn_of(1e-10, string, dt, damping, time),
    )
    # 2880 angles, neighbours in part alike: 4 % are three standard errors and more.
    assert found == pytest.approx(exact, rel=0.04)
    # What holds the fibre back counts.
    assert exact < 0.8 * turn_of(1e-10, replace(string, youngs_modulus=1e-20), dt)


def test_noise_that_turns_edges_by_more_than_half_a_radian_is_warned_of_once():
    said = (
        r"`turbulence` of .* turns edges by 0\.6 rad in a step of 0\.01 s from t = 0 s"
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        laid(0.6)
    (told,) = caught
    assert told.category is UserWarning
    assert told.filename == __file__
    with pytest.warns(UserWarning, match=said):
        laid(0.6)
    number = int(str(told.message).split("at least ")[1].split()[0])
    assert number > N_STEPS
    # Warnings are errors in these tests.
    laid(0.6, number)
    laid(0.49)


def test_noise_that_turns_edges_by_more_than_two_radians_is_refused():
    with pytest.raises(
        fp.NoiseStrengthError, match=r"turns edges by 2\.1 rad"
    ) as caught:
        laid(2.1)
    error = caught.value
    assert error.turn == pytest.approx(2.1)
    assert error.solution.t.size == 1
    enough = turn_of(error.amplitude, dt=T_END / error.n_steps)
    assert 0.45 < enough <= 0.5
    with pytest.raises(fp.NoiseStrengthError, match=r"turns edges by 1e\+30 rad"):
        laid(1e30)


def test_air_that_brakes_the_fibre_lets_it_bear_more_noise():
    law = fibre.RandomForce(0.6 / turn_of(1.0))
    r = fibre.equilibrium(SPUN).r
    v, free = np.zeros_like(r), np.ones(len(r), dtype=bool)
    strengths = law.amplitudes(SPUN, None, r, v, 0.0)
    with pytest.warns(UserWarning, match=r"turns edges by 0\.6 rad"):
        judge(law, None).check(strengths, r, v, 0.0, free)
    # Warnings are errors in these tests.
    judge(law, fibre.AirFlow((0.0, 50.0, 0.0))).check(strengths, r, v, 0.0, free)


def test_what_lies_does_not_count():
    law = fibre.RandomForce(0.49 / turn_of(1.0))
    r = fibre.equilibrium(SPUN).r
    strengths = law.amplitudes(SPUN, None, r, 0 * r, 0.0).copy()
    strengths[-3:] *= 1e3
    free = np.arange(len(r)) < len(r) - 3
    judge(law, None).check(strengths, r, 0 * r, 0.0, free)
    with pytest.raises(fp.NoiseStrengthError, match="turns edges by"):
        judge(law, None).check(strengths, r, 0 * r, 0.0, ~free)


def test_the_repetition_with_half_of_the_steps_is_not_judged():
    law = fibre.RandomForce(0.49 / turn_of(1.0))
    found = fibre.lay_down(SPUN, T_END, N_STEPS, turbulence=law, seed=1)
    assert np.isfinite(found.position_error)
