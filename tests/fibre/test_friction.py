"""Coulomb friction on the belt: what slides, what sticks, what is pulled, and rest."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve._kernels.chain import Iterate, Step
from fpsolve._kernels.friction import AIR, SLIDES, STICKS
from fpsolve.fibre import Belt, Free, Hinged, Nozzle, String, lay_down
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.friction import ground_under, rubbed_step
from fpsolve.fibre.theta_step import string_chain

G, MU = 9.81, 0.3
NOWHERE = (0.0, 0.0, 0.0)
THREAD = {"diameter": 2e-4, "density": 1000.0}


def lying(length=0.1, n_edges=8, stiffness=1e8, start=Free(), **options):  # noqa: B008
    string = String(length, **THREAD, youngs_modulus=stiffness, start=start, end=Free(),
                    n_edges=n_edges, **options)  # fmt: skip
    return string, string.s[:, None] * np.array([1.0, 0, 0])


class Lying:
    """A fibre that lies on a belt from the beginning, step by step, without impacts."""

    def __init__(self, string, belt, r, v=None, dt=0.01, theta=0.5):
        self.string, self.belt, self.step = string, belt, Step(dt, theta, 0.0)
        self.chain, self.t = string_chain(string), 0.0
        self.r, self.v = r.copy(), np.zeros(r.shape) if v is None else v.copy()
        self.tension, self.state = np.zeros(len(r) - 1), np.full(len(r), STICKS)
        self.iterations = 0

    def go(self, force=None):
        dt, theta = self.step.dt, self.step.theta
        moved = dt * self.v
        carried = np.tile([self.belt.speed * dt, 0.0], (len(self.r), 1))
        ground = ground_under(self.belt, self.chain.fixed, self.state, carried)
        iterate = Iterate(self.r, self.v, moved, self.tension.copy())
        self.iterations = rubbed_step(
            self.chain, self.step, iterate, None, self.t, force, ground
        )
        self.r, self.t = self.r + moved, self.t + dt
        self.v = self.v + (moved / dt - self.v) / theta
        self.state, self.tension = ground.state, iterate.tension
        self.v[self.state == STICKS] = [self.belt.speed, 0.0, 0.0]
        self.v[self.state != AIR, 2] = 0.0
        self.v[self.chain.fixed] = 0.0
        return self


@pytest.mark.parametrize("theta", [0.5, 0.6])
def test_a_straight_fibre_on_a_moving_belt_takes_v_over_mu_g_to_move_with_it(theta):
    string, r = lying()
    stop = 0.5 / (MU * G)
    for dt in (0.02, 0.01, 0.005, 0.0025):
        fibre = Lying(string, Belt(0.5, friction=MU), r, dt=dt, theta=theta)
        while fibre.t < 0.25:
            fibre.go()
            if fibre.t < stop:
                assert (fibre.state == SLIDES).all()
                np.testing.assert_allclose(fibre.v[:, 0], MU * G * fibre.t, rtol=1e-10)
        moved = 0.5 * (fibre.t - 0.5 * stop)
        # Exact until it sticks, which it does in one step: what is missed there is at
        # most μ g Δ²/8 with θ = ½, and besides (θ − ½) v Δ of implicit Euler's part.
        allowed = MU * G * dt**2 / 8 + (theta - 0.5) * 0.5 * dt
        assert np.abs(fibre.r - r - [moved, 0, 0]).max() <= allowed
        assert (fibre.state == STICKS).all()
        np.testing.assert_array_equal(fibre.v, [[0.5, 0, 0]] * 9)


def test_a_belt_that_starts_faster_than_mu_g_leaves_the_fibre_behind():
    for share, slides in ((0.999, False), (1.001, True)):
        # In the frame of the belt it is pulled to the other side.
        string, r = lying(gravity=(share * MU * G, 0, -G))
        fibre = Lying(string, Belt(0.0, friction=MU), r)
        for _ in range(5):
            fibre.go()
        if slides:
            away = 0.5 * (share - 1) * MU * G * fibre.t**2
            # Newton's method leaves 1e-9 of an edge.
            np.testing.assert_allclose(fibre.r - r, [[away, 0, 0]] * 9, atol=1e-11)
        else:
            np.testing.assert_array_equal(fibre.r, r)


def test_a_fibre_held_on_a_moving_belt_is_pulled_by_what_lies_behind():
    for n_edges in (4, 8, 16):
        string, r = lying(n_edges=n_edges, start=Hinged(NOWHERE))
        fibre = Lying(string, Belt(0.5, friction=MU), r)
        fibre.go().go()
        behind = string.length - (string.s[:-1] + string.edge / 2)
        weight = MU * string.line_density * G
        # T = μ ρA g (L − s), exact in the middle of the edges.
        np.testing.assert_allclose(fibre.tension, weight * behind, rtol=1e-9)
        # The front of what slides goes on by one node in an iteration, once.
        assert fibre.iterations <= 2


def test_friction_holds_a_pull_until_it_exceeds_that_of_the_whole_fibre():
    string, r = lying(n_edges=10, stiffness=0.0)
    belt, whole = Belt(0.0, friction=MU), MU * string.line_density * G * 0.1
    fibre, force = Lying(string, belt, r), np.zeros((11, 3))
    for share in (0.22, 0.47, 0.83):
        force[0, 0] = -share * whole
        fibre.go(force)
        # What holds lies next to the pull: T falls by μ ρA g h from edge to edge.
        middle = 0.05 + 0.1 * np.arange(10)
        expected = np.maximum(share - middle, 0.0) * whole
        np.testing.assert_allclose(fibre.tension, expected, atol=0.051 * whole)
        assert (np.diff(fibre.tension) <= 1e-12 * whole).all()
        # To Newton's 1e-9 of an edge.
        np.testing.assert_allclose(fibre.r, r, atol=1e-11)
    force[0, 0] = -1.5 * whole
    start = fibre.t
    for _ in range(3):
        fibre.go(force)
    # Exact: half of the largest friction is left to move the mass.
    moved = -0.5 * 0.5 * MU * G * (fibre.t - start) ** 2
    np.testing.assert_allclose(fibre.r - r, [[moved, 0, 0]] * 11, atol=1e-10)


def test_a_rod_that_spins_on_the_belt_slows_down_to_order_two_in_the_edges():
    # dω/dt = −3 μ g/L, the torque μ ρA g L²/4 over ρA L³/12.
    errors = []
    for n_edges in (4, 8, 16):
        string, r = lying(n_edges=n_edges, stiffness=1e10)
        r = r - [0.05, 0, 0]
        fibre = Lying(
            string, Belt(0.0, friction=MU), r, 20.0 * r[:, [1, 0, 2]], dt=5e-4
        )
        for _ in range(50):
            fibre.go()
        spin = string.masses @ np.cross(fibre.r, fibre.v)[:, 2]
        speed = spin / (string.line_density * 0.1**3 / 12)
        errors.append(abs(speed - (20.0 - 3 * MU * G / 0.1 * fibre.t)))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Half-edges at the ends have 2/n² of the moment of inertia too much, the torque
    # none; the rod is a little bent.
    assert (abs(orders - 2) < 0.02).all(), errors
    assert errors[-1] < 0.2


def test_energy_falls_at_every_step_until_the_fibre_is_at_rest():
    string, r = lying(n_edges=12, stiffness=1e7)
    forces = Forces(string)
    angles = 0.3 * np.sin(np.arange(12))
    edges = string.edge * np.stack([np.cos(angles), np.sin(angles), 0 * angles], -1)
    r = np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])
    v = np.array([0.3, 0.1, 0.0]) + np.cross([0, 0, 8.0], r)
    fibre = Lying(string, Belt(0.0, friction=MU), r, v, dt=1e-3)
    energies, scale = [], 0.5 * string.masses @ (v**2).sum(axis=1)
    for _ in range(500):
        fibre.go()
        kinetic = 0.5 * string.masses @ (fibre.v**2).sum(axis=1)
        energies.append(kinetic + forces.energy(fibre.r))
        if (fibre.state == STICKS).all():
            break
    # Newton's residuals; with θ = ½ nothing but friction takes energy.
    assert np.diff(energies).max() < 1e-9 * scale
    assert energies[-1] < energies[0] - 0.5 * scale
    assert (fibre.state == STICKS).all()
    assert not fibre.v.any()
    rest = fibre.r
    fibre.go()
    np.testing.assert_array_equal(fibre.r, rest)


def spun(speed=1.0):
    nozzle = Nozzle((0, 0, 0.22), (0.1, 0.03, -1.0), speed)
    return String(0.2, **THREAD, youngs_modulus=1e7, start=nozzle, end=Free(),
                  n_edges=10)  # fmt: skip


def test_a_belt_faster_than_the_fibre_is_spun_rubs_along_it():
    # Without a limit of friction such a belt tears at it (test_lay_down.py).
    motion = lay_down(
        spun(), 0.6, 300, belt=Belt(3.0, friction=1.0), estimate_error=False
    )
    last = motion.last
    assert last.laid.sum() > 8
    assert last.sliding[last.laid].all()
    # It goes on with the speed with which it is spun, not with the belt's.
    assert last.v[last.laid, 0].max() < 1.5
    assert last.r[:, 2].min() == 0.0
    assert motion.stretched.max() <= 1e-12


@pytest.mark.nightly
def test_a_fibre_that_rubs_is_laid_kept_and_gone_on_with_to_the_same_bits(tmp_path):
    given = {"belt": Belt(0.3, friction=0.5), "estimate_error": False}
    whole = lay_down(spun(), 0.2, 60, **given)
    assert whole.last.sliding.any()
    assert whole.stretched.max() <= 1e-12
    assert fp.compare(whole, fp.load(whole.save(tmp_path / "whole.nc"))).equal

    def stop(done, total, t):
        if done == 45:
            raise KeyboardInterrupt

    part = tmp_path / "part.nc"
    with pytest.raises(fp.RunInterrupted):
        lay_down(spun(), 0.2, 60, **given, progress=stop, checkpoint=part)
    resumed = lay_down(spun(), 0.2, 60, **given, checkpoint=part)
    for name in ("r", "v", "tension", "laid", "sliding", "on_belt"):
        np.testing.assert_array_equal(
            getattr(resumed.last, name), getattr(whole.last, name)
        )
    np.testing.assert_array_equal(resumed.landed, whole.landed)


@pytest.mark.parametrize("friction", [-1.0, math.nan])
def test_friction_that_pushes_is_refused(friction):
    with pytest.raises(ValueError, match="`friction` must be non-negative, got"):
        Belt(0.1, friction=friction)


def test_friction_that_is_not_settled_says_how_many_nodes_are_left(monkeypatch):
    monkeypatch.setattr("fpsolve.fibre.friction.MOST_ITERATIONS", -33)
    string, r = lying()
    fibre = Lying(string, Belt(0.5, friction=MU), r)
    with pytest.raises(fp.FrictionError, match="9 nodes change between") as caught:
        fibre.go()
    assert caught.value.left == 9
