"""A fibre at rest: catenary, heavy elastica, buckled column; order 2 in the edge."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

import fpsolve as fp
from fpsolve.fibre import Clamped, Equilibrium, Free, Hinged, String, equilibrium, modes

EDGES = (16, 32, 64, 128)
GRAVITY = 9.81
# A fibre of 1 m whose weight bends it far: ρA g L³/EI = 39.24.
SOFT = {"diameter": 2e-3, "density": 1000.0, "youngs_modulus": 1e9}
# A chain that hangs between two points of one height.
LENGTH, APART = 1.5, 1.0


def orders(errors):
    """Observed orders at every halving."""
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def column(load, n_edges, lean=0.0):
    """A fibre that stands on a clamp with ρA g L³/EI = load."""
    weight = 1000.0 * math.pi * 1e-6 / 4 * GRAVITY
    modulus = weight / load * 64 / (math.pi * 1e-12)
    upright = Clamped((0, 0, 0), (0, 0, 1))
    return String(1.0, 1e-3, 1000.0, modulus, upright, Free(), n_edges=n_edges)


@cache
def catenary(n_edges):
    chain = String(
        LENGTH, 1e-3, 1000.0, 0.0, Hinged((0, 0, 0)), Hinged((APART, 0, 0)),
        n_edges=n_edges,
    )  # fmt: skip
    return equilibrium(chain)


@cache
def elastica(n_edges):
    clamped = Clamped((0, 0, 0), (1, 0, 0))
    return equilibrium(String(1.0, **SOFT, start=clamped, end=Free(), n_edges=n_edges))


@cache
def tip_of_the_elastica():
    """x and z of the free end by collocation: θ″ = −q (1 − s) cos θ."""
    q = elastica(16).string.line_density * GRAVITY
    q /= elastica(16).string.bending_stiffness

    def slopes(s, y):
        return np.stack([y[1], -q * (s - 1) * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])])

    def ends(first, last):
        return np.array([first[0], last[1], first[2], first[3]])

    s = np.linspace(0, 1, 41)
    guess = np.stack([-1.5 * np.sqrt(s), 0 * s, 0.3 * s, -0.9 * s])
    found = solve_bvp(slopes, ends, s, guess, tol=1e-10, max_nodes=100_000)
    assert found.success
    return np.array([found.y[2, -1], 0.0, found.y[3, -1]])


def scale_of_the_catenary():
    """c of z = c cosh(x/c)."""
    return brentq(lambda c: 2 * c * math.sinh(APART / 2 / c) - LENGTH, 0.05, 10)


def test_a_hanging_chain_is_a_catenary_to_order_two():
    c = scale_of_the_catenary()
    sag = c * (math.cosh(APART / 2 / c) - 1)
    errors = [abs(-catenary(n).r[:, 2].min() - sag) for n in EDGES]
    assert (abs(orders(errors) - 2) < 0.05).all(), errors
    assert errors[-1] < 2.1e-5


def test_its_tension_is_the_weight_below_and_the_same_pull_everywhere():
    c, chain = scale_of_the_catenary(), catenary(128)
    weight = chain.string.line_density * GRAVITY
    edges = np.diff(chain.r, axis=0) / chain.string.edge
    level = chain.tension * edges[:, 0]
    # Every node balances its weight, which has no horizontal part, to 1e-10 of the
    # weight of the whole; they add up over 64 nodes.
    np.testing.assert_allclose(level, level[0], rtol=3e-8)
    # Of order 2: 3e-5 at 128 edges.
    assert level[0] == pytest.approx(weight * c, rel=1e-4)


def test_a_soft_fibre_bends_as_the_elastica_to_order_two():
    errors = [np.linalg.norm(elastica(n).r[-1] - tip_of_the_elastica()) for n in EDGES]
    # The clamped end has a layer of bending as thick as four edges of the coarsest.
    assert (abs(orders(errors) - 2) < 0.2).all(), errors
    assert errors[-1] < 1.2e-4


@pytest.mark.parametrize("n_edges", EDGES)
def test_errors_cover(n_edges):
    c = scale_of_the_catenary()
    sag = c * (math.cosh(APART / 2 / c) - 1)
    found = catenary(n_edges)
    assert abs(-found.r[:, 2].min() - sag) <= found.position_error
    bent = elastica(n_edges)
    away = np.linalg.norm(bent.r[-1] - tip_of_the_elastica())
    assert away <= bent.position_error < 10 * away


@pytest.mark.parametrize("found", [catenary, elastica])
def test_edges_keep_their_length(found):
    rest = found(64)
    lengths = np.linalg.norm(np.diff(rest.r, axis=0), axis=1)
    np.testing.assert_allclose(lengths, rest.string.edge, rtol=1e-12)
    assert rest.residual <= 1e-10


def test_rest_is_a_minimum_of_the_energy_among_shapes_of_the_same_length():
    from fpsolve.fibre.forces import Forces

    rest = elastica(32)
    forces = Forces(rest.string)
    least = forces.energy(rest.r)
    rng = np.random.default_rng(5)
    for _ in range(5):
        angles = 0.02 * rng.normal(size=(rest.string.n_edges, 1))
        edges = np.diff(rest.r, axis=0)
        turned = np.cos(angles) * edges + np.sin(angles) * np.cross(edges, [0, 1, 0])
        r = np.concatenate([np.zeros((1, 3)), np.cumsum(turned, axis=0)])
        assert forces.energy(r) > least


def test_it_does_not_matter_which_end_is_called_the_start():
    n = 32
    turned = String(
        1.0, **SOFT, start=Free(), end=Clamped((0, 0, 0), (-1, 0, 0)), n_edges=n
    )
    # To the residual allowed times the compliance of a fibre that is 39 times too soft.
    np.testing.assert_allclose(equilibrium(turned).r[::-1], elastica(n).r, atol=1e-7)


def test_the_shape_turns_with_everything_that_holds_it():
    rng = np.random.default_rng(2)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    n = 16
    other = String(
        1.0, **SOFT, start=Clamped((0, 0, 0), turn @ [1.0, 0, 0]), end=Free(),
        gravity=turn @ [0.0, 0, -GRAVITY], n_edges=n,
    )  # fmt: skip
    np.testing.assert_allclose(equilibrium(other).r, elastica(n).r @ turn.T, atol=1e-7)


def test_a_column_that_is_too_heavy_leans_and_is_stable_then():
    upright = equilibrium(column(10.0, 32))
    assert not modes(upright, 1).stable
    angle = 0.05
    edges = np.array([math.sin(angle), 0, math.cos(angle)]) / 32
    shape = np.arange(33)[:, None] * edges
    leaning = equilibrium(column(10.0, 32), shape=shape)
    assert leaning.r[-1, 0] > 0.3
    # Without friction it may turn about the vertical: one ω² is 0 to rounding.
    squares = modes(leaning, 2).squares
    assert abs(squares[0]) < 1e-6 * squares[1]
    assert squares[1] > 0


def test_the_fewest_edges_have_no_error():
    rest = equilibrium(String(1.0, **SOFT, n_edges=4))
    assert isinstance(rest, Equilibrium)
    assert rest.position_error == math.inf


def test_an_iteration_that_does_not_end_says_what_is_left(monkeypatch):
    monkeypatch.setattr("fpsolve.fibre.rest.MOST_STEPS", 3)
    with pytest.raises(
        fp.EquilibriumError, match="no position of rest was found: a force of"
    ) as caught:
        equilibrium(elastica(16).string)
    assert caught.value.residual > caught.value.tolerance


STRAIGHT = np.linspace([0.0, 0, 0], [0, 0, -1.0], 17)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: String(0.0, 1e-3, 1.0, 1.0), ValueError, "`length` must be positive"),
        (lambda: String(1.0, math.nan, 1.0, 1.0), ValueError, "`diameter` must be"),
        (
            lambda: String(1.0, 1e-3, 1.0, -1.0),
            ValueError,
            "`youngs_modulus` must be non-negative",
        ),
        (lambda: String(1.0, 1e-3, 1.0, 1.0, n_edges=3), ValueError, "`n_edges` must"),
        (
            lambda: String(1.0, 1e-3, 1.0, 1.0, start="held"),
            TypeError,
            r"`start` must be `Free\(\)`, `Hinged\(position\)` or `Clamped",
        ),
        (
            lambda: String(1.0, 1e-3, 1.0, 1.0, Hinged((0, 0, 0)), Hinged((0, 0, 1.0))),
            ValueError,
            "`length` must be above the distance 1 of the ends, got 1; the fibre does",
        ),
        (
            lambda: String(1.0, 1e-3, 1.0, 1.0, gravity=(0, 1)),
            ValueError,
            "`gravity` must be three numbers",
        ),
        (
            lambda: Clamped((0, 0, 0), (0, 0, 0)),
            ValueError,
            "`direction` must not vanish",
        ),
        (lambda: Hinged((0, math.inf, 0)), ValueError, "`position` must"),
        (
            lambda: equilibrium(String(1.0, 1e-3, 1.0, 1.0, Free(), Free())),
            ValueError,
            "`start` and `end` must not both be free",
        ),
        (
            lambda: equilibrium(elastica(16).string, shape=STRAIGHT[:-1]),
            ValueError,
            "`shape` must be the positions of 17 nodes",
        ),
        (
            lambda: equilibrium(elastica(16).string, shape=2 * STRAIGHT),
            ValueError,
            "`shape` must have edges of 0.0625, got one that is off by a part of 1",
        ),
        (
            lambda: equilibrium(elastica(16).string, shape=STRAIGHT + 1),
            ValueError,
            "`shape` must have its start at",
        ),
        (lambda: modes(elastica(16).string), TypeError, "`equilibrium` must be an"),
        (lambda: modes(elastica(16), 0), ValueError, "`n` must be"),
    ],
)
def test_what_cannot_rest_is_refused(call, error, message):
    with pytest.raises(error, match=message):
        call()
