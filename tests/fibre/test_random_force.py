"""Noise on a fibre: the exact response of small vibrations, laws of what is drawn."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov

from fpsolve.fibre import (
    Clamped,
    Free,
    Hinged,
    RandomForce,
    String,
    equilibrium,
    modes,
    simulate,
)
from fpsolve.fibre.forces import Forces
from fpsolve.fibre.random_force import Draws, correlated_step
from fpsolve.fibre.theta_step import ThetaStep

NOWHERE = (0.0, 0.0, 0.0)
MATERIAL = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}
AMPLITUDE, DAMPING = 3e-4, 0.002


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def cantilever(n_edges=6):
    return String(
        1.0, **MATERIAL, start=Clamped(NOWHERE, (1, 0, 0)), end=Free(),
        gravity=NOWHERE, n_edges=n_edges,
    )  # fmt: skip


def hanging(n_edges=6):
    return String(
        1.0, 1e-3, 1000.0, 0.0, Hinged(NOWHERE), Free(), n_edges=n_edges
    )  # fmt: skip


def straight(string):
    direction = [1.0, 0, 0] if string.youngs_modulus else [0, 0, -1.0]
    return string.s[:, None] * np.array(direction)


@cache
def linear_step(string, dt, theta):
    """(y, ∂_t y) → B (y, ∂_t y) + N f of small displacements across a straight fibre.

    Differences of the step itself, which is odd in y: what is of third order in the
    displacement is taken away by twice as large ones.
    """
    step = ThetaStep(string, dt, theta, DAMPING)
    rest, n = straight(string), string.n_edges
    tension = equilibrium(string, shape=rest).tension
    small = 1e-3 * string.edge
    softest = np.abs(response(string)).max()
    sizes = small, small / dt, small * max(string.masses[1] / dt**2, 1 / softest)

    def change(row, node, size):
        ends = []
        for given in np.zeros((2, 3, n + 1, 3)):
            given[row, node, 1] = size * (-1) ** len(ends)
            r, v, _, _ = step(rest + given[0], given[1], tension, 0.0, given[2])
            ends.append(np.concatenate([r[1:, 1], v[1:, 1]]))
        return (ends[0] - ends[1]) / (2 * size)

    found = np.array([
        (4 * change(row, node, size) - change(row, node, 2 * size)) / 3
        for row, size in enumerate(sizes) for node in range(1, n + 1)
    ]).T  # fmt: skip
    return found[:, : 2 * n], found[:, 2 * n :]


def stationary(string, dt, theta):
    """Covariance of (y, ∂_t y) that white noise leaves for ever, by one step."""
    moved, pushed = linear_step(string, dt, theta)
    lengths = string.masses[1:] / string.line_density
    drawn = pushed * (AMPLITUDE * np.sqrt(lengths / dt))
    return solve_discrete_lyapunov(moved, drawn @ drawn.T)


def response(string):
    """K⁻¹: displacements across a straight fibre at rest by unit forces."""
    tension = equilibrium(string, shape=straight(string)).tension
    stiffness = Forces(string).stiffness(tension)[1::3, 1::3].toarray()
    return np.linalg.inv(stiffness[1:, 1:])


@pytest.mark.parametrize("string", [cantilever(), hanging()])
@pytest.mark.parametrize("steps", [0.05, 5.0])
def test_steps_of_one_half_have_the_exact_response_to_noise_at_every_length(
    string, steps
):
    # Of periods of the slowest vibration: the longest leaves none resolved.
    period = 1 / modes(equilibrium(string, shape=straight(string)), 1).frequencies[0]
    found = stationary(string, steps * period, 0.5)
    n = string.n_edges
    expected = AMPLITUDE**2 / (2 * DAMPING) * response(string)
    # Differences of one step leave 1e-12, and Lyapunov's equation divides by its decay.
    size = np.abs(expected).max()
    np.testing.assert_allclose(found[:n, :n], expected, atol=1e-9 * size)
    # Every node has the same energy of motion.
    energy = np.diag(string.masses[1:]) @ found[n:, n:]
    np.testing.assert_allclose(
        energy, AMPLITUDE**2 / (2 * DAMPING) * np.eye(n),
        atol=1e-9 * energy[0, 0],
    )  # fmt: skip


def test_noise_displaces_a_cantilever_by_its_green_function():
    # A² G(s, s)/(2c) with G(s, s) = s³/(3 EI), at order 2 in the edges.
    errors = []
    for n_edges in (8, 16, 32):
        rod = cantilever(n_edges)
        found = np.diag(response(rod))
        exact = rod.s[1:] ** 3 / (3 * rod.bending_stiffness)
        errors.append(np.abs(found - exact).max() / exact[-1])
    assert (abs(orders(errors) - 2) < 0.1).all(), errors


def discrete_law(omega, gamma, strength, dt, theta):
    """⟨x²⟩, ⟨v²⟩ of x'' = −ω² x − γ x' + σ ξ by the θ-scheme: the solution of
    −(AP + PA^T) + δ A P A^T = σ² e₂ ⊗ e₂, δ = (2θ − 1) Δ."""
    d = (2 * theta - 1) * dt
    below = 2 * gamma + 2 * omega**2 * d + gamma**2 * d
    below += 1.5 * gamma * omega**2 * d**2 + 0.5 * omega**4 * d**3
    v = strength**2 / below
    return v * (1 + gamma * d / 2 + omega**2 * d**2 / 2) / omega**2, v


@pytest.mark.parametrize("theta", [0.6, 1.0])
def test_other_steps_lose_what_the_formula_of_their_scheme_says(theta):
    rod = cantilever()
    vibrations = modes(equilibrium(rod), 12)
    period = 2 * math.pi / vibrations.angular_frequencies[0]
    dt, gamma = 0.02 * period, DAMPING / rod.line_density
    found = stationary(rod, dt, theta)
    # Every mode has the same noise; both directions across count once.
    strength = AMPLITUDE / rod.line_density**0.5
    tip = 0.0
    for omega, shape in zip(
        vibrations.angular_frequencies, vibrations.displacements, strict=True
    ):
        tip += discrete_law(omega, gamma, strength, dt, theta)[0] * shape[-1, 1] ** 2
    np.testing.assert_allclose(found[5, 5], tip, rtol=1e-8)
    kept = tip / (AMPLITUDE**2 / (2 * DAMPING) * response(rod)[-1, -1])
    # A fiftieth of the period is a practical step: this is what it costs.
    assert kept < (0.8 if theta == 1.0 else 0.95)


def draws(law, n_edges=8, dt=0.1, seed=5, pieces=1):
    string = cantilever(n_edges)
    return Draws(law, string, None, dt, seed, pieces)


def drawn(source, n_steps):
    nodes = np.zeros((source.string.n_edges + 1, 3))
    return np.array([source.value(i + 1, nodes, nodes, 0.0) for i in range(n_steps)])


def test_white_noise_gives_every_piece_of_fibre_momentum_of_its_length_and_time():
    source = draws(RandomForce(2.0), n_edges=100)
    forces = drawn(source, 400)
    lengths = source.string.masses / source.string.line_density
    # Of momentum: A² h Δ; at an end half of an edge.
    scaled = forces * source.dt / (2.0 * np.sqrt(lengths * source.dt))[:, None]
    n = scaled.size
    # Five standard errors.
    assert abs((scaled**2).mean() - 1) < 5 * math.sqrt(2 / n)
    assert abs((scaled[:, [0, -1]] ** 2).mean() - 1) < 5 * math.sqrt(2 / (6 * 400))
    assert abs((scaled[1:] * scaled[:-1]).mean()) < 5 / math.sqrt(n)
    assert abs((scaled[:, 1:] * scaled[:, :-1]).mean()) < 5 / math.sqrt(n)


@pytest.mark.parametrize("time", [0.0, 0.3])
def test_a_step_of_two_pieces_has_the_noise_of_both(time):
    law = RandomForce(2.0, correlation_time=time)
    fine = drawn(draws(law, dt=0.1), 10)
    coarse = drawn(draws(law, dt=0.2, pieces=2), 5)
    np.testing.assert_allclose(coarse, 0.5 * (fine[::2] + fine[1::2]), rtol=1e-12)


def test_noise_is_repeated_by_its_seed_and_another_for_another():
    law = RandomForce(1.0)
    np.testing.assert_array_equal(drawn(draws(law), 3), drawn(draws(law), 3))
    assert (drawn(draws(law), 3) != drawn(draws(law, seed=6), 3)).all()


@pytest.mark.parametrize("time", [1e-3, 0.05, 1.0, 1e4])
def test_correlated_noise_has_the_law_of_its_process_whatever_the_step(time):
    dt = 0.1
    mean, moved = correlated_step(dt, time)
    variance = 1 / (2 * time)
    # The process stays stationary, and the mean of it over a step is that of
    # e^{−|t|/τ}/(2τ): 2/Δ² ∫ (Δ − t) e^{−t/τ}/(2τ) dt.
    assert math.isclose(moved[0] ** 2 * variance + moved[1] ** 2, variance)
    whole = mean[0] ** 2 * variance + mean[1] ** 2 + mean[2] ** 2
    x = dt / time
    exact = (1 - (1 - math.exp(-x)) / x) / dt if x > 1e-3 else variance * (1 - x / 3)
    # The formula loses digits of x², the series is good to x².
    assert math.isclose(whole, exact, rel_tol=1e-9)
    # Both together at the end: 1/(2Δ) (1 − e^{−Δ/τ}).
    together = moved[0] * mean[0] * variance + moved[1] * mean[1]
    assert math.isclose(together, -math.expm1(-x) / (2 * dt), rel_tol=1e-12)


def oscillator(omega, gamma, time, dt):
    """⟨x²⟩, ⟨v²⟩ of x'' = −ω² x − γ x' + η with steps of ½ and the noise of a step."""
    a = np.array([[0.0, 1.0], [-(omega**2), -gamma]])
    left = np.eye(2) - dt / 2 * a
    mean, moved = correlated_step(dt, time)
    moves = np.zeros((3, 3))
    moves[:2, :2] = np.linalg.solve(left, np.eye(2) + dt / 2 * a)
    push = np.linalg.solve(left, [0.0, dt])
    moves[:2, 2], moves[2, 2] = push * mean[0], moved[0]
    noise = np.concatenate([np.outer(push, mean[1:]), moved[None, 1:]])
    return np.diag(solve_discrete_lyapunov(moves, noise @ noise.T))[:2]


def test_the_response_to_correlated_noise_tends_to_that_to_white_noise():
    omega, gamma = 2.0, 0.5
    white = np.array([1 / omega**2, 1.0]) / (2 * gamma)
    times = np.array([0.02, 0.01, 0.005])
    found = []
    for time in times:
        longer, shorter = (oscillator(omega, gamma, time, time / n) for n in (10, 20))
        # Without the error of order 2 of the step.
        found.append((4 * shorter - longer) / 3)
        exact = white / (1 + gamma * time + (omega * time) ** 2)
        exact[0] *= 1 + gamma * time
        # Of the error of order 4 that is left, (Δ/τ)⁴/1000.
        np.testing.assert_allclose(found[-1], exact, rtol=1e-7)
    lost = 1 - np.array(found) / white
    # The mean square displacement at order 2 in the correlation time, that of the
    # velocity at order 1.
    assert (abs(orders(lost[:, 0]) - 2) < 0.05).all(), lost
    assert (abs(orders(lost[:, 1]) - 1) < 0.12).all(), lost


def test_a_run_is_repeated_bit_by_bit_and_keeps_its_edges():
    law = RandomForce(1e-3)
    string = cantilever(4)
    first, again, other = (
        simulate(
            string, 0.05, 20, turbulence=law, seed=seed, damping=0.01,
            estimate_error=False,
        )
        for seed in (1, 1, 2)
    )  # fmt: skip
    np.testing.assert_array_equal(first.r, again.r)
    assert (first.r[-1, 1:] != other.r[-1, 1:]).all()
    assert first.stretched.max() <= 1e-12


def far_from_straight(pieces, seed, time, n_fine=256):
    """Tip of a fibre that noise moves by a tenth of its length, in the same noise."""
    string = cantilever(4)
    n_steps, r = n_fine // pieces, straight(string)
    dt = 0.25 / n_steps
    source = Draws(RandomForce(3e-3, time), string, None, dt, seed, pieces)
    step, v, tension = ThetaStep(string, dt, 0.5, 0.01), 0 * r, np.zeros(4)
    for number in range(n_steps):
        force = source.value(number + 1, r, v, number * dt)
        r, v, tension, _ = step(r, v, tension, number * dt, force)
    return r


@pytest.mark.parametrize(("time", "order"), [(0.0, 1), (0.05, 2)])
def test_large_motions_in_the_same_noise_tend_to_each_other(time, order):
    errors = []
    for seed in range(4):
        found = [far_from_straight(n, seed, time) for n in (1, 4, 8, 16)]
        away = [np.linalg.norm(one - found[0], axis=1).max() for one in found[1:]]
        # What `simulate` says of steps of 4 and 8 pieces.
        for error, one, half in zip(away, found[1:], found[2:], strict=False):
            assert error < 2 * np.linalg.norm(one - half, axis=1).max()
        errors.append(away)
        assert np.abs(found[0] - straight(cantilever(4))).max() > 0.03
    typical = np.sqrt((np.array(errors) ** 2).mean(axis=0))[::-1]
    # Random numbers of four seeds; means of a process over steps are of order 2.
    assert (orders(typical) > order - 0.3).all(), typical


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: RandomForce(-1.0), ValueError, "`amplitude` must be non-negative"),
        (lambda: RandomForce(math.nan), ValueError, "`amplitude` must be"),
        (lambda: RandomForce(1.0, -1.0), ValueError, "`correlation_time` must be non"),
        (
            lambda: simulate(cantilever(), 1.0, 2, turbulence=RandomForce(1.0)),
            TypeError,
            "must be given together, got `turbulence` alone",
        ),
        (
            lambda: simulate(cantilever(), 1.0, 2, seed=1),
            TypeError,
            "must be given together, got `seed` alone",
        ),
        (
            lambda: simulate(cantilever(), 1.0, 2, turbulence=1.0, seed=1),
            TypeError,
            "`turbulence` must be a `RandomForce`",
        ),
        (
            lambda: simulate(
                cantilever(), 1.0, 2, turbulence=RandomForce(1.0), seed=-1
            ),
            ValueError,
            "`seed` must be at least 0",
        ),
    ],
)
def test_what_is_no_noise_is_refused(call, error, message):
    with pytest.raises(error, match=message):
        call()
