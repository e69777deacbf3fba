"""A fibre that is spun: its momentum, the catenary, steps in halves, noise."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import fpsolve as fp
from fpsolve._kernels.impact import arrest
from fpsolve.fibre import AirFlow, Belt, Free, Nozzle, String, lay_down
from fpsolve.fibre.fed_chain import FedChain, FedStep
from fpsolve.fibre.halving import Halving

THREAD = {"diameter": 2e-4, "density": 1000.0}
TILTED = (0.1, 0.03, -1.0)
NOWHERE = (0.0, 0.0, 0.0)


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def hanging(nozzle, stiffness=1e7, length=0.2, n_edges=10, **options):
    return String(length, **THREAD, youngs_modulus=stiffness, start=nozzle, end=Free(),
                  n_edges=n_edges, **options)  # fmt: skip


def test_a_fibre_that_is_fed_straight_down_hangs_by_its_weight():
    string = hanging(Nozzle(NOWHERE, (0, 0, -1), 2.0))
    motion = lay_down(string, 0.25, 200, estimate_error=False)
    # 25 edges of 2 cm have come out; each moves as it did when it left the nozzle.
    assert motion.fed == pytest.approx(0.5, rel=1e-15)
    assert len(motion.r[-1]) == 10 + 25 + 1
    np.testing.assert_allclose(motion.last.v, [[0, 0, -2.0]] * 36, atol=1e-11)
    length = 0.2 + 2.0 * motion.t
    np.testing.assert_allclose(motion.r[-1][-1], [0, 0, -0.7], atol=1e-11)
    # Of whole edges, and half of the weight of the first node is the nozzle's.
    edges = np.floor(length[:-1] / string.edge + 1e-9)
    weight = string.line_density * 9.81 * string.edge * (edges - 0.5)
    np.testing.assert_allclose(motion.largest_tension[1:], weight, rtol=1e-10)


def test_edges_come_out_with_their_length_however_much_has_come_out_before():
    nozzle = Nozzle((0.1, 0.2, 0.5), (0.6, 0, -0.8), 40.0)
    string = hanging(nozzle, length=0.02, n_edges=10)
    # After a kilometre, whose last digits are 1e-13 m: 6e-11 of an edge of 2 mm.
    newest = 500_000
    t = string.edge * (newest + 1.001 - 10) / 40.0
    step = FedStep(string, None, 0.6, None)
    first = step.held(newest, t)[0]
    r = first + string.s[:, None] * np.array(nozzle.direction)
    chain = FedChain(
        r, 0 * r, np.zeros(10), np.zeros(11, bool), np.full((11, 3), np.nan), newest
    )
    fed = step.after_feeding(chain, t)
    assert len(fed.r) == 12
    edge = np.linalg.norm(fed.r[1] - fed.r[0])
    # Rounding of places of half a metre.
    assert edge / string.edge == pytest.approx(1.0, abs=2e-13)


def test_what_comes_out_brings_its_momentum():
    nozzle = Nozzle(NOWHERE, (0.6, 0, -0.8), 1.0, (0.05, 0.02), 30.0)
    string = hanging(nozzle, stiffness=0.0)
    step = FedStep(string, None, 0.6, None)
    r = string.s[:, None] * np.array(nozzle.direction) + nozzle.at(0.0)[0]
    v = np.tile(nozzle.at(0.0)[1], (11, 1))
    chain = FedChain(
        r, v, np.zeros(10), np.zeros(11, bool), np.full((11, 3), np.nan), 10
    )
    mass, dt = string.line_density * string.edge, 1e-3
    worst, momentum, given = 0.0, mass * v[1:].sum(axis=0) - mass * v[-1] / 2, 0.0
    for number in range(100):
        new, _ = step(chain, number * dt, dt)
        # The scheme changes momentum by mean velocities, θ of the new and the rest of
        # the old, and by the pull of the nozzle along its edge in between.
        masses = step.numbers(new.tension.size).masses[1:, None]
        middle = 0.6 * new.r + 0.4 * chain.r
        pull = -new.tension[0] * (middle[1] - middle[0]) / string.edge
        weight = masses.sum() * np.array([0, 0, -9.81])
        given = given + dt * (pull + weight)
        fed = step.after_feeding(new, (number + 1) * dt)
        if fed is not new:
            given = given + mass * nozzle.at((number + 1) * dt)[1]
        chain = fed
        masses = step.numbers(chain.tension.size).masses[1:, None]
        found = (masses * chain.v[1:]).sum(axis=0)
        worst = max(worst, np.abs(found - momentum - given).max())
    assert chain.newest == 15
    # Residuals of Newton's method: 1e-9 of an edge over a step, of the chain's mass.
    assert worst < 1e-9 * 15 * mass
    # It has swung meanwhile.
    assert np.abs(chain.v[1:, 1]).max() > 0.1


A, HEIGHT, SPEED = 0.1, 0.2, 1.0


def sunk(x):
    """The catenary z = a (cosh(x/a) − 1), which touches the belt at 0."""
    return A * (np.cosh(np.minimum(x, 0.0) / A) - 1)


def catenary(n_edges):
    """Edges of one length from a height to the belt, four more on it, their length."""
    reach = A * math.acosh(1 + HEIGHT / A)

    def up(edge):
        x = [0.0]
        for _ in range(n_edges):
            last = x[-1]

            def off(y, last=last):
                return math.hypot(y - last, sunk(y) - sunk(last)) - edge

            x.append(brentq(off, last - edge, last, xtol=1e-16))
        return np.array(x)

    whole = math.sqrt(HEIGHT * (HEIGHT + 2 * A))
    edge = brentq(lambda h: up(h)[-1] + reach, 0.9 * whole / n_edges,
                  1.1 * whole / n_edges, xtol=1e-15)  # fmt: skip
    x = np.concatenate([up(edge)[::-1], edge * np.arange(1, 5)])
    return edge, np.stack([x, 0 * x, np.where(x < 0, sunk(x), 0.0)], axis=1)


def test_a_chain_fed_as_fast_as_the_belt_stays_the_catenary_that_moves_along_itself():
    # T = ρA (g (a + z) + V²): the speed adds to the tension, the shape stays.
    errors, tensions, scatters = [], [], []
    for n_edges in (8, 16, 32):
        edge, shape = catenary(n_edges)
        tangent = np.gradient(shape, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        slope = math.sinh(math.acosh(1 + HEIGHT / A))
        nozzle = Nozzle(tuple(shape[0]), (1.0, 0.0, -slope), SPEED)
        string = hanging(nozzle, 0.0, edge * (n_edges + 4), n_edges + 4)
        motion = lay_down(
            string, 0.3, round(2.4 / edge), belt=Belt(SPEED), shape=shape,
            velocity=SPEED * tangent, save_every=1, estimate_error=False,
        )  # fmt: skip
        errors.append(max(np.abs(r[:, 2] - sunk(r[:, 0])).max() for r in motion.r))
        expected = string.line_density * (9.81 * (A + HEIGHT) + SPEED**2)
        # After the first third, in which what began as a polygon settles.
        pulls = motion.nozzle_tension[len(motion.t) // 3 :] / expected - 1
        tensions.append(abs(pulls.mean()))
        scatters.append(pulls.std())
    # Twice the length has been spun; nodes come in and land one at a time.
    assert (orders(errors) > 1.7).all(), errors
    assert errors[-1] < 2.5e-4
    # The mean pull at the nozzle has an error of the steps as well, 0.6 % here; that
    # of the first edge is off by half of its weight and bend, 3 %.
    assert max(tensions) < 0.01, tensions
    assert (orders(scatters) > 0.6).all(), scatters
    assert scatters[-1] < 0.03


def test_an_arrest_is_the_nearest_motion_that_stretches_no_edge():
    rng = np.random.default_rng(7)
    r, v = rng.normal(size=(2, 8, 3))
    masses, held = rng.uniform(1, 2, 8), np.zeros(8, dtype=bool)
    held[[0, 4, 5]] = True
    edges = np.diff(r, axis=0)
    rows = np.zeros((7, 8, 3))
    rows[np.arange(7), np.arange(7)] = -edges
    rows[np.arange(7), np.arange(1, 8)] = edges
    # By least squares in the velocities that may change, without the edge that is held.
    counted = [0, 1, 2, 3, 5, 6]
    free = np.repeat(~held, 3)
    inner = rows.reshape(7, -1)[counted][:, free]
    weights = np.repeat(masses, 3)[free]
    wrong = rows.reshape(7, -1)[counted] @ v.ravel()
    impulses = np.linalg.solve(inner @ (inner / weights).T, -wrong)
    expected = v.ravel().copy()
    expected[free] += (inner.T @ impulses) / weights
    for function in (arrest, arrest.py_func):
        found = v.copy()
        function(r, masses, held, found)
        np.testing.assert_allclose(found.ravel(), expected, atol=1e-13)


def test_the_error_covers_what_shorter_steps_change_before_anything_buckles():
    nozzle = Nozzle((0, 0, 0.3), (0, 0, -1), 1.0, (0.02, 0.0), 10.0)
    string = hanging(nozzle, n_edges=10)
    exact = lay_down(string, 0.1, 1600, estimate_error=False)
    motions = [lay_down(string, 0.1, n) for n in (50, 100, 200)]
    errors = [one.distance(exact) for one in motions]
    # Of order 1 with θ = 0.6, less what 1600 steps are off themselves.
    assert ((orders(errors) > 0.9) & (orders(errors) < 1.4)).all(), errors
    for motion, error in zip(motions, errors, strict=True):
        assert error <= motion.position_error < 4 * error


def test_a_tolerance_halves_steps_until_the_error_has_fallen():
    nozzle = Nozzle((0, 0, 0.3), (0, 0, -1), 1.0, (0.02, 0.0), 10.0)
    string = hanging(nozzle, n_edges=10)
    exact = lay_down(string, 0.1, 1600, estimate_error=False)
    errors = []
    for tolerance in (4e-5, 2.5e-6, 1.6e-7):
        motion = lay_down(string, 0.1, 10, tolerance=tolerance)
        errors.append(motion.distance(exact))
        assert errors[-1] <= motion.position_error < 8 * errors[-1]
    # Of steps a quarter as long at order 1, but for what halves leave: 1.5 and 2.3.
    assert (orders(errors) > 1.3).all(), errors
    assert motion.rejected.sum() > 50


class Isotropic:
    """Noise of one strength everywhere."""

    def __init__(self, amplitude, correlation_time=0.0):
        self.amplitude, self.correlation_time = amplitude, correlation_time

    def amplitudes(self, string, air, r, v, t):
        return np.broadcast_to(self.amplitude * np.eye(3), (len(r), 3, 3))


def test_turbulence_lays_one_fibre_for_every_seed():
    string = hanging(Nozzle((0, 0, 0.22), (0, 0, -1), 1.0), 1e8)
    noise = {"turbulence": Isotropic(2e-5), "air": AirFlow(NOWHERE)}
    laid = [
        lay_down(
            string, 0.5, 250, belt=Belt(0.2), seed=seed, estimate_error=False, **noise
        )
        for seed in (1, 1, 2)
    ]
    np.testing.assert_array_equal(laid[0].landed, laid[1].landed)
    assert laid[0].distance(laid[2]) > 0.01
    # It has left the vertical line of the nozzle to all sides.
    assert np.ptp(laid[0].landed[:, 1]) > 0.01
    assert laid[0].stretched.max() <= 1e-12


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"seed": 1}, TypeError, "`turbulence` and `seed` must be given together"),
        ({"turbulence": Isotropic(1.0)}, TypeError, "got `turbulence` alone"),
        ({"turbulence": 1.0, "seed": 1}, TypeError, "must be a `RandomForce` or a"),
        ({"turbulence": Isotropic(1.0), "seed": -1}, ValueError, "`seed` must be"),
    ],
)
def test_noise_that_cannot_be_drawn_is_refused(options, error, message):
    with pytest.raises(error, match=message):
        lay_down(hanging(Nozzle(NOWHERE, TILTED, 1.0)), 1.0, 2, **options)


def test_a_step_is_halved_by_halves_and_no_part_is_computed_twice():
    seen = []

    def step(state, t, dt):
        seen.append((t, dt))
        return state + dt

    def distance(before, one, other):
        # Steps of more than ¼ that begin before ½ are too long.
        _, dt = seen[-1]
        return 1.0 if before < 0.5 and 2 * dt > 0.25 else 0.0

    halving = Halving(step, distance, 0.5)
    assert halving(0.0, 0.0, 1.0) == 1.0
    # One whole step, two halves, and of the first of these two halves, and so on.
    assert seen == [
        (0.0, 1.0), (0.0, 0.5), (0.5, 0.5), (0.0, 0.25), (0.25, 0.25),
        (0.0, 0.125), (0.125, 0.125), (0.25, 0.25), (0.25, 0.125), (0.375, 0.125),
        (0.5, 0.5), (0.5, 0.25), (0.75, 0.25),
    ]  # fmt: skip
    assert halving.rejected == 2


def test_a_step_that_never_becomes_accurate_or_possible_says_so():
    halving = Halving(lambda state, t, dt: state, lambda *states: 0.3, 0.2)
    with pytest.raises(
        fp.errors.ToleranceError, match=r"0.2 not reached: .* 0.3; enlarge"
    ):
        halving(0.0, 0.0, 1.0)
    halving.distance = lambda *states: math.nan
    with pytest.raises(fp.errors.ToleranceError):
        halving(0.0, 0.0, 1.0)

    def impossible(state, t, dt):
        raise fp.EdgeLengthError(t, dt, 0.1)

    with pytest.raises(fp.EdgeLengthError) as caught:
        Halving(impossible, lambda *states: 0.0, math.inf)(0.0, 0.0, 1.0)
    assert caught.value.dt == 2.0**-12
