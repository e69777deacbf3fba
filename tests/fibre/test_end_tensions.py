"""The tension at the ends of a fibre: order 2 in the edges, at rest and in motion."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

import fpsolve as fp
from fpsolve.fibre import Clamped, Free, Hinged, String, equilibrium, simulate

EDGES = (16, 32, 64, 128)
GRAVITY = 9.81
NOWHERE = (0.0, 0.0, 0.0)
FREE = Free()
LEVEL = Clamped(NOWHERE, (1, 0, 0))
SOFT = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def chain(n_edges, end=FREE, length=1.0, **options):
    return String(length, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), end, n_edges=n_edges,
                  **options)  # fmt: skip


def pull_of_the_clamp():
    """−EI κ² of the heavy elastica, θ″ = −q (s − 1) cos θ, whose clamp is level."""
    fibre = String(1.0, **SOFT, start=LEVEL)
    q = fibre.line_density * GRAVITY / fibre.bending_stiffness
    s = np.linspace(0, 1, 41)
    found = solve_bvp(
        lambda s, y: np.stack([y[1], -q * (s - 1) * np.cos(y[0])]),
        lambda first, last: np.array([first[0], last[1]]),
        s, np.stack([-1.5 * np.sqrt(s), s - 1]), tol=1e-10, max_nodes=100_000,
    )  # fmt: skip
    assert found.success
    return -fibre.bending_stiffness * found.y[1, 0] ** 2


def test_a_catenary_pulls_at_its_ends_to_order_two():
    # T = ρA g c cosh(x/c).
    c = brentq(lambda c: 2 * c * math.sinh(0.5 / c) - 1.5, 0.05, 10)
    errors = []
    for n in EDGES:
        rest = equilibrium(chain(n, Hinged((1.0, 0, 0)), 1.5))
        exact = rest.string.line_density * GRAVITY * c * math.cosh(0.5 / c)
        off = np.abs(rest.end_tension - exact)
        assert (off <= rest.end_tension_error).all()
        assert (rest.end_tension_error < 5 * off).all()
        errors.append(off.max() / exact)
    assert (abs(orders(errors) - 2) < 0.1).all(), errors
    # That of the first edge, half an edge below, is off by 0.7 % there.
    assert errors[-1] < 2e-6


def test_a_chain_that_hangs_pulls_with_its_weight_however_few_edges_it_has():
    hanging = equilibrium(chain(5))
    weight = hanging.string.line_density * GRAVITY
    # Of forces 1e-10 is left.
    np.testing.assert_allclose(hanging.end_tension, [weight, 0.0], atol=1e-9 * weight)
    assert np.isinf(hanging.end_tension_error).all()


def test_a_clamp_pulls_at_a_soft_fibre_to_order_two():
    exact, errors = pull_of_the_clamp(), []
    for n in EDGES:
        rest = equilibrium(String(1.0, **SOFT, start=LEVEL, n_edges=n))
        errors.append(abs(rest.end_tension[0] - exact))
        assert errors[-1] <= rest.end_tension_error[0]
        assert rest.end_tension[1] == rest.end_tension_error[1] == 0.0
    # Bent within four of the longest edges: orders 1.70, 1.83, 1.91.
    found = orders(errors)
    assert (np.diff(found) > 0).all(), found
    assert found[0] > 1.65
    assert 1.85 < found[-1] < 2.05
    assert errors[-1] < 3e-4 * abs(exact)
    # The other way round it is the same fibre.
    turned = String(
        1.0, **SOFT, start=Free(), end=Clamped(NOWHERE, (-1, 0, 0)), n_edges=n
    )
    found = equilibrium(turned).end_tension
    assert found[1] == pytest.approx(rest.end_tension[0], rel=1e-5)


def test_a_chain_that_turns_about_its_end_pulls_at_it_to_order_two():
    # T(0) = ρA ω² L²/2; chords of the circle are off by (ωΔ)²/4 = 5e-6 at most.
    errors = []
    for n in (8, 16, 32):
        weightless = chain(n, gravity=NOWHERE)
        shape = weightless.s[:, None] * np.array([1.0, 0, 0])
        motion = simulate(
            weightless, 0.1, 64, shape=shape, velocity=3.0 * shape[:, [1, 0, 2]]
        )
        exact = weightless.line_density * 9.0 / 2
        errors.append(abs(motion.end_tension[-1, 0] / exact - 1))
        assert (motion.end_tension[1:, 1] == 0).all()
        # From step to step it does not change.
        assert motion.end_tension_error[0] < 1e-5 * exact
    assert (abs(orders(errors) - 2) < 0.05).all(), errors
    assert errors[-1] < 1e-3


@cache
def swinging(n_steps, theta=0.5, n_edges=8, **options):
    stiff = String(1.0, **SOFT, start=Hinged(NOWHERE), n_edges=n_edges)
    level = stiff.s[:, None] * np.array([1.0, 0, 0])
    return simulate(stiff, 0.3, n_steps, shape=level, theta=theta, **options)


@pytest.mark.parametrize(("theta", "order"), [(0.5, 2), (0.6, 1)])
def test_the_pull_of_a_swinging_fibre_is_of_the_order_of_the_scheme(theta, order):
    fine = swinging(1600, theta, estimate_error=False).end_tension
    errors = []
    for n in (100, 200, 400):
        motion = swinging(n, theta)
        # At θ of the last step; the reference there, between two of its own.
        at = 1600 - 1600 / n * (1 - theta) + (1 - theta)
        exact = np.interp(at, np.arange(1601), fine[:, 0])
        errors.append(abs(motion.end_tension[-1, 0] - exact))
        assert errors[-1] <= motion.end_tension_error[0] < 12 * errors[-1]
    assert (abs(orders(errors) - order) < 0.5).all(), errors


def test_a_tolerance_finds_the_pull_in_the_last_of_its_steps():
    exact = swinging(1600, estimate_error=False).end_tension[-1, 0]
    motion = swinging(6, tolerance=1e-5)
    assert abs(motion.end_tension[-1, 0] - exact) <= motion.end_tension_error[0]


def test_the_middle_of_a_fibre_that_turns_in_free_fall_is_pulled_by_its_halves():
    # T = ρA ω² L²/8: half of the mass goes around at a quarter of the length.
    for n in (4, 10):
        free = String(1.0, **SOFT, start=FREE, end=FREE, n_edges=n)
        shape = (free.s - 0.5)[:, None] * np.array([1.0, 0, 0])
        motion = simulate(free, 0.01, 10, shape=shape, velocity=3 * shape[:, [1, 0, 2]])
        exact = free.line_density * 9.0 / 8
        # Not of order 2 but exact; Newton's method leaves 1e-12 of an edge.
        assert motion.largest_tension[-1] == pytest.approx(exact, rel=1e-9)
        assert (motion.end_tension[1:] == 0).all()


def test_the_tension_at_the_ends_is_kept_in_a_file(tmp_path):
    motion = swinging(50)
    loaded = fp.load(motion.save(tmp_path / "motion.nc"))
    np.testing.assert_array_equal(loaded.end_tension, motion.end_tension)
    np.testing.assert_array_equal(loaded.end_tension_error, motion.end_tension_error)
