"""Paths of nozzles that each move in their own way, by kernels and step by step."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import NonFinitePathError
from fpsolve.evolution.schedule import Schedule
from fpsolve.paths.ensemble import Ensemble
from fpsolve.paths.forcing import OwnMotion
from fpsolve.web.plan import ensemble_of

KNOWN = fp.QuadraticPotential()
OWN = fp.CallablePotential(lambda x, y: (x**2 + y**2) / 2, lambda x, y: (x, y))
CURVE = fp.RotatingNozzle(0.3, 1.0, 0.7)
PARTS = (fp.RotatingNozzle(0.0, 1.0, 0.7), fp.OscillatingNozzle(0.0, 0.5, 0.4))
N, STEPS, DS = 70, 9, 0.125


def model_of(name, potential):
    if name == "basic":
        return fp.LayDownModel(potential, 1.2, CURVE)
    return fp.SmoothLayDownModel(potential, 0.5, 1.2, CURVE)


def ensemble(name, potential) -> Ensemble:
    return ensemble_of(model_of(name, potential), N, DS, STEPS, 3)


def motion():
    return OwnMotion(PARTS, np.random.default_rng(2).normal(size=(2, N)))


def advanced(of, state):
    """The state after all steps, and after each of them."""
    state, trace = state.copy(), np.empty((STEPS, *state.shape))
    of.integrator.advance(state, 5, 2, STEPS, trace, motion())
    np.testing.assert_array_equal(trace[-1], state)
    return trace


@pytest.mark.parametrize("name", ["basic", "smooth"])
def test_a_potential_of_the_users_own_moves_paths_as_the_compiled_one(name):
    state = ensemble(name, KNOWN).initial_state(0, N)
    traces = [advanced(ensemble(name, one), state) for one in (KNOWN, OWN)]
    # The same formulas, rounded otherwise.
    np.testing.assert_allclose(*traces, rtol=0, atol=1e-12)


def test_the_own_motion_is_subtracted_from_paths_that_nothing_else_moves():
    free = fp.LayDownModel(fp.FreePotential(), 0.0, CURVE)
    schedule, law = Schedule(0.0, DS, STEPS, (), ()), fp.paths.GaussianLaw()
    free = Ensemble(free, N, schedule, 3, "splitting", law)
    state, own = free.initial_state(0, N), motion()
    trace = advanced(free, state)
    start, end = 2 * DS, (2 + STEPS) * DS
    added = sum(
        weight * np.array(part.displacement(start, end))[:, None]
        for part, weight in zip(PARTS, own.weights, strict=True)
    )
    common = np.array(CURVE.displacement(start, end))[:, None]
    expected = state[:2] + STEPS * DS * state[2:4] - common - added
    np.testing.assert_allclose(trace[-1, :2], expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["basic", "smooth"])
def test_a_path_that_is_not_finite_is_named_by_its_number(name):
    of = ensemble(name, KNOWN)
    state = of.initial_state(0, N)
    state[0, 13] = np.nan
    with pytest.raises(NonFinitePathError) as caught:
        of.integrator.advance(state, 5, 2, STEPS, None, motion())
    assert caught.value.path == 18
