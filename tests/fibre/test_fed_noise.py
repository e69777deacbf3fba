"""Noise pulls at a fibre that is spun: every node has its own, and keeps it."""

import numpy as np
import pytest

from fpsolve import fibre
from fpsolve.fibre.fed_chain import FedChain
from fpsolve.fibre.fed_noise import FedDraws

SPUN = fibre.String(
    0.2, 2e-4, 1000.0, 1e8, n_edges=10, end=fibre.Free(),
    start=fibre.Nozzle((0.0, 0.0, 0.25), (0.1, 0.03, -1.0), 1.0),
)  # fmt: skip
BELT = fibre.Belt(0.3)
NOISE = fibre.RandomForce(3e-6)


def laid(seed=1, turbulence=NOISE, n_steps=60, **options):
    return fibre.lay_down(
        SPUN, 0.3, n_steps, belt=BELT, turbulence=turbulence, seed=seed,
        estimate_error=False, **options,
    )  # fmt: skip


def chain_of(n_nodes, newest):
    r = np.zeros((n_nodes, 3))
    r[:, 2] = -SPUN.edge * np.arange(n_nodes)
    bare = np.full((n_nodes, 3), np.nan)
    flags = np.zeros(n_nodes, dtype=bool)
    return FedChain(r, 0 * r, np.zeros(n_nodes - 1), flags, bare, newest)


def test_a_seed_repeats_the_fibre_bit_by_bit_and_another_lays_another():
    one, same, other = laid(1), laid(1), laid(2)
    for mine, its in zip(one.r, same.r, strict=True):
        np.testing.assert_array_equal(mine, its)
    np.testing.assert_array_equal(one.landed, same.landed)
    assert one.distance(other) > 1e-3
    # Noise does not stretch the fibre.
    assert one.stretched.max() < 1e-12


def test_noise_of_no_strength_is_none():
    with_it = laid(1, fibre.RandomForce(0.0))
    without = laid(None, None)
    for mine, its in zip(with_it.r, without.r, strict=True):
        np.testing.assert_array_equal(mine, its)


def test_a_node_keeps_its_noise_when_others_come_and_go():
    draws = FedDraws(NOISE, SPUN, None, 0.01, seed=4, n_nodes=50)
    draws.draw(1)
    masses = SPUN.line_density * SPUN.edge * np.ones(12)
    before = draws.force(chain_of(11, 10), masses[:11], 0.0)
    # One node more at the nozzle, and two fewer at the end.
    after = draws.force(chain_of(10, 11), masses[:10], 0.0)
    np.testing.assert_array_equal(after[1:], before[:9])
    draws.draw(2)
    assert (draws.force(chain_of(11, 10), masses[:11], 0.01) != before).all()


def test_one_long_step_is_driven_by_the_noise_of_two_short_ones():
    short = FedDraws(NOISE, SPUN, None, 0.01, seed=4, n_nodes=50)
    long = FedDraws(NOISE, SPUN, None, 0.02, seed=4, n_nodes=50, pieces=2)
    chain, masses = chain_of(11, 10), SPUN.masses
    momentum = np.zeros((11, 3))
    for number in (1, 2):
        short.draw(number)
        momentum += 0.01 * short.force(chain, masses, 0.0)
    long.draw(1)
    np.testing.assert_allclose(0.02 * long.force(chain, masses, 0.0), momentum)


@pytest.mark.parametrize("correlation_time", [0.0, 0.02])
def test_momenta_of_pieces_have_the_variance_of_the_noise(correlation_time):
    """A² h Δ of white noise; correlated, A² h (Δ − τ(1 − e^{−Δ/τ}))."""
    law = fibre.RandomForce(3e-6, correlation_time)
    dt, n = 0.01, 2000
    draws = FedDraws(law, SPUN, None, dt, seed=1, n_nodes=n)
    draws.draw(1)
    masses = np.full(n, SPUN.line_density * SPUN.edge)
    drawn = dt * draws.force(chain_of(n, n - 1), masses, 0.0)
    time = dt
    if correlation_time:
        time -= correlation_time * -np.expm1(-dt / correlation_time)
    exact = law.amplitude**2 * SPUN.edge * time
    # 6000 independent normal numbers: four standard errors of their variance.
    assert np.mean(drawn**2) == pytest.approx(exact, rel=4 * np.sqrt(2 / drawn.size))


def test_more_nodes_in_the_air_than_noises_are_refused():
    draws = FedDraws(NOISE, SPUN, None, 0.01, seed=4, n_nodes=10)
    draws.draw(1)
    with pytest.raises(ValueError, match="at most 10 nodes in the air, got 11"):
        draws.force(chain_of(11, 10), SPUN.masses, 0.0)


def test_noise_and_its_seed_are_given_together():
    with pytest.raises(TypeError, match="must be given together"):
        laid(None)
    with pytest.raises(TypeError, match="must be a `RandomForce` or a `Turb"):
        laid(1, "gusts")
