"""A fibre in motion: what is conserved, orders in the step, small vibrations."""

import math
from functools import cache

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.fibre import Clamped, Free, Hinged, String, equilibrium, modes, simulate

MATERIAL = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}
NOWHERE = (0.0, 0.0, 0.0)


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def cantilever(n_edges=16, **options):
    return String(
        1.0, **MATERIAL, start=Clamped(NOWHERE, (1, 0, 0)), end=Free(),
        n_edges=n_edges, **options,
    )  # fmt: skip


def test_the_energy_of_a_falling_fibre_is_kept_to_rounding():
    # Straight and horizontal at first, it falls and whips.
    motion = simulate(cantilever(), 1.0, 1000, estimate_error=False)
    assert motion.kinetic.max() > 5e-3
    # 1000 steps of a residual of 1e-12 edges times the forces of an edge.
    assert np.ptp(motion.energy) < 1e-11 * motion.kinetic.max()
    assert motion.stretched.max() <= 1e-12
    assert motion.iterations[1:].max() <= 6


def test_a_chain_without_stiffness_keeps_its_energy_too():
    chain = String(1.0, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), Free(), n_edges=6)
    level = np.linspace(NOWHERE, [1.0, 0, 0], 7)
    motion = simulate(chain, 2.0, 1000, shape=level, estimate_error=False)
    assert np.ptp(motion.energy) < 1e-10 * motion.kinetic.max()


def test_implicit_euler_loses_energy_at_every_step():
    motion = simulate(cantilever(), 0.5, 200, theta=1.0, estimate_error=False)
    assert (np.diff(motion.energy[1:]) < 0).all()


def test_a_free_fibre_falls_as_everything_does():
    free = String(1.0, **MATERIAL, start=Free(), end=Free(), n_edges=8)
    motion = simulate(free, 1.0, 10)
    fallen = motion.r[-1] - motion.r[0]
    # The scheme is exact for constant acceleration.
    np.testing.assert_allclose(fallen, [[0, 0, -9.81 / 2]] * 9, atol=1e-10)
    assert np.nanmax(motion.largest_tension) < 1e-12
    assert motion.position_error < 1e-10


def test_a_free_fibre_keeps_its_momentum_and_its_spin():
    rng = np.random.default_rng(3)
    free = String(1.0, **MATERIAL, start=Free(), end=Free(), gravity=NOWHERE, n_edges=8)
    angles = np.cumsum(rng.normal(scale=0.3, size=8))
    edges = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1) / 8
    shape = np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])
    velocity = np.array([1.0, 2.0, 3.0]) + np.cross([3.0, -1.0, 5.0], shape)
    motion = simulate(
        free, 0.5, 400, shape=shape, velocity=velocity, save_every=40,
        estimate_error=False,
    )  # fmt: skip
    mass = free.masses[:, None]
    momentum = (mass * motion.v).sum(axis=1)
    spin = np.cross(motion.r, mass * motion.v).sum(axis=1)
    for kept in (momentum, spin):
        # Rounding of 400 steps.
        np.testing.assert_allclose(kept, kept[[0]].repeat(len(kept), 0), atol=1e-11)
    # It bends meanwhile.
    assert np.ptp(motion.potential) > 1e-3 * motion.kinetic[0]


def soft_fibre_after(n_steps, **options):
    held = Clamped(NOWHERE, (1, 0, 0))
    soft = String(1.0, 2e-3, 1000.0, 1e7, held, Free(), n_edges=6)
    return simulate(soft, 0.2, n_steps, **options)


@cache
def nearly_exact():
    # 1/64 of the error of 400 steps at order 2.
    return soft_fibre_after(3200, estimate_error=False).r[-1]


@pytest.mark.parametrize(("theta", "order"), [(0.5, 2), (1.0, 1)])
def test_positions_are_of_the_declared_order_in_the_step(theta, order):
    exact = nearly_exact()
    motions = [soft_fibre_after(n, theta=theta) for n in (50, 100, 200, 400)]
    errors = [np.linalg.norm(one.r[-1] - exact, axis=1).max() for one in motions]
    # At order 1 the longest step damps more than the terms of second order allow.
    assert (abs(orders(errors) - order) < (0.1 if order == 2 else 0.3)).all(), errors
    assert errors[-1] < (2e-6 if order == 2 else 2e-3)
    for motion, error in zip(motions, errors, strict=True):
        assert error <= motion.position_error <= 5 * error


@pytest.mark.parametrize("theta", [0.5, 0.6])
def test_a_tolerance_takes_steps_in_halves_until_the_error_has_fallen(theta):
    exact = soft_fibre_after(3200, theta=theta, estimate_error=False).r[-1]
    errors = []
    for tolerance in (1e-4, 1e-5, 1e-6):
        motion = soft_fibre_after(6, theta=theta, tolerance=tolerance)
        errors.append(np.linalg.norm(motion.r[-1] - exact, axis=1).max())
        assert errors[-1] <= motion.position_error < 10 * errors[-1]
    # Of local errors of order 3 or 2 the powers 2/3 and 1/2: factors of 4.6 and 3.2.
    factors = np.array(errors[:-1]) / errors[1:]
    assert (factors > 2).all(), errors
    assert motion.iterations[1:].max() > 40
    if theta == 0.5:
        # Whatever the steps, whose residuals add up.
        assert np.ptp(motion.energy) < 1e-11 * motion.kinetic.max()


def test_a_chain_whips_in_steps_that_are_halved_where_it_turns_around():
    chain = String(1.0, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), Free(), n_edges=8)
    level = np.linspace(NOWHERE, [1.0, 0, 0], 9)
    with pytest.raises(fp.EdgeLengthError):
        simulate(chain, 1.0, 4, shape=level, estimate_error=False)
    motion = simulate(chain, 1.0, 4, shape=level, tolerance=1e-3, estimate_error=False)
    assert motion.stretched.max() <= 1e-12
    assert np.ptp(motion.energy) < 1e-10 * motion.kinetic.max()


def test_a_small_vibration_is_that_of_the_modes():
    rod = cantilever(8, gravity=NOWHERE)
    rest = equilibrium(rod)
    found = modes(rest, 1)
    omega, mode = found.angular_frequencies[0], found.displacements[0]
    # Edges turn, they do not stretch.
    small = 1e-4 / np.abs(mode).max()
    turned = np.diff(rest.r + small * mode, axis=0)
    turned *= rod.edge / np.linalg.norm(turned, axis=1, keepdims=True)
    shape = np.concatenate([np.zeros((1, 3)), np.cumsum(turned, axis=0)])
    n_steps = 60
    dt = 2 * np.pi / omega / 20
    motion = simulate(rod, n_steps * dt, n_steps, shape=shape, save_every=1)
    across = (motion.r - rest.r) @ (mode[-1] / np.linalg.norm(mode[-1]))
    # Of the θ-scheme with ½: tan(ω'Δ/2) = ωΔ/2.
    slowed = 2 / dt * math.atan(omega * dt / 2)
    expected = across[0, -1] * np.cos(slowed * motion.t)
    # What is not linear is of order 3 in the amplitude; stiffer modes are not excited.
    np.testing.assert_allclose(across[:, -1], expected, atol=1e-8)


def test_damping_slows_a_free_fibre_exponentially():
    free = String(1.0, **MATERIAL, start=Free(), end=Free(), gravity=NOWHERE, n_edges=4)
    rate = 3.0
    errors = []
    for n_steps in (10, 20, 40):
        motion = simulate(
            free, 1.0, n_steps, velocity=[1.0, 0, 0],
            damping=rate * free.line_density,
        )  # fmt: skip
        errors.append(abs(motion.v[-1, 0, 0] - math.exp(-rate)))
    # ((1 − rΔ/2)/(1 + rΔ/2))^n.
    assert (abs(orders(errors) - 2) < 0.02).all(), errors
    assert errors[-1] < 8e-5


def test_a_damped_fibre_comes_to_rest():
    rod = cantilever(8)
    rest = equilibrium(rod)
    critical = 2 * rod.line_density * modes(rest, 1).angular_frequencies[0]
    motion = simulate(rod, 5.0, 400, theta=1.0, damping=critical, estimate_error=False)
    np.testing.assert_allclose(motion.r[-1], rest.r, atol=1e-6)


def test_a_fibre_at_rest_stays_there():
    rest = equilibrium(cantilever(8))
    motion = simulate(rest.string, 1.0, 20, shape=rest.r)
    # Forces of 1e-10 of the weight are left, and act for a second.
    np.testing.assert_allclose(motion.r[-1], rest.r, atol=1e-8)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"t_end": 0.0}, "`t_end` must be positive"),
        ({"n_steps": 0}, "`n_steps` must be"),
        ({"theta": 0.4}, "`theta` must lie between 0.5 and 1, got 0.4"),
        ({"theta": math.nan}, "`theta` must lie between"),
        ({"damping": -1.0}, "`damping` must be non-negative"),
        ({"save_every": 0}, "`save_every` must be"),
        ({"tolerance": 0.0}, "`tolerance` must be positive"),
        ({"velocity": [1.0, 0.0]}, r"`velocity` must have the shape \(9, 3\) or"),
        ({"velocity": [1.0, 0.0, 0.0]}, "`velocity` must vanish at an end"),
        (
            {"velocity": np.linspace(NOWHERE, [1.0, 0, 0], 9)},
            "`velocity` must not stretch the fibre, got 0.12 m/s along an edge",
        ),
    ],
)
def test_what_cannot_move_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        simulate(cantilever(8), **{"t_end": 1.0, "n_steps": 4} | options)


def test_a_step_that_is_far_too_long_says_so():
    chain = String(1.0, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), Free(), n_edges=32)
    level = np.linspace(NOWHERE, [1.0, 0, 0], 33)
    with pytest.raises(fp.EdgeLengthError, match="take more `n_steps`") as caught:
        simulate(chain, 100.0, 2, shape=level)
    assert caught.value.dt == 50.0
