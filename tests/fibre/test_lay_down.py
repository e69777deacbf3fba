"""A fibre that is laid on a belt: what lies, what stands, what is refused."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.fibre import AirFlow, Belt, Clamped, Free, Nozzle, String, lay_down
from fpsolve.fibre.fed_chain import put_down

THREAD = {"diameter": 2e-4, "density": 1000.0}
TILTED = (0.1, 0.03, -1.0)
NOWHERE = (0.0, 0.0, 0.0)


def hanging(nozzle, stiffness=1e7, length=0.2, n_edges=10, **options):
    return String(length, **THREAD, youngs_modulus=stiffness, start=nozzle, end=Free(),
                  n_edges=n_edges, **options)  # fmt: skip


@pytest.fixture(scope="module")
def coiled():
    """2.5 m of a fibre laid in loops on a belt of a third of its speed."""
    string = hanging(Nozzle((0, 0, 0.3), TILTED, 1.0), 1e8, n_edges=20)
    return lay_down(
        string, 2.5, 1250, belt=Belt(0.3, height=0.05), save_every=10,
        estimate_error=False,
    )  # fmt: skip


def test_every_piece_of_the_fibre_is_in_the_nozzle_in_the_air_or_on_the_belt(coiled):
    last, string = coiled.last, coiled.string
    assert last.newest == string.n_edges + 250
    # Up to the last node in the air, that in the nozzle being the first.
    in_air = np.flatnonzero(~last.laid)[-1] + 1
    assert len(coiled.landed) + in_air == last.newest + 1
    assert coiled.free_length[-1] < 0.5
    assert coiled.rejected.sum() < 10


def test_edges_keep_their_length_in_the_air_and_on_the_belt(coiled):
    assert coiled.stretched.max() <= 1e-12
    edges = np.linalg.norm(np.diff(coiled.landed, axis=0), axis=1)
    # Of one edge; coordinates of a metre are rounded to 1e-16.
    assert np.abs(edges / coiled.string.edge - 1).max() < 1e-12


def test_nothing_is_below_the_belt(coiled):
    heights = [float(r[:, 2].min()) for r in coiled.r]
    assert min(heights) >= 0.05
    assert heights[-1] == 0.05


def test_what_lies_moves_with_the_belt_and_lands_in_turn(coiled):
    last = coiled.last
    np.testing.assert_array_equal(
        last.v[last.laid], [[0.3, 0, 0]] * int(last.laid.sum())
    )
    # Places on the belt do not change: the lab sees them move.
    lying = last.r[last.laid] - [0.3 * coiled.t[-1], 0, 0]
    np.testing.assert_allclose(lying[:, :2], last.on_belt[last.laid, :2], atol=1e-15)
    # Loops may land before what hangs behind them, by less than two turns.
    assert np.diff(coiled.landing_times).min() > -0.1
    assert coiled.landing_times[-1] > 2.4


def test_the_laid_curve_lies_about_where_the_nozzle_was(coiled):
    curve = coiled.laid_curve(skip=0.5)
    assert curve.ds == coiled.string.edge
    assert curve.curve == fp.MovingBelt(0.3)
    assert curve.s_start[0] > 0.5
    (xi,) = curve.deviations
    np.testing.assert_allclose(xi.mean(axis=0), 0.0, atol=1e-12)
    # Loops of three centimetres, no drift over 2 m of fibre.
    assert np.abs(xi).max() < 0.1
    assert fp.studies.functional(curve)


def test_a_moving_nozzle_is_the_reference_curve_of_what_it_lays():
    nozzle = Nozzle((0, 0, 0.15), (0, 0, -1), 1.0, (0.1, 0.05), 3.0, phase=0.3)
    string = hanging(nozzle, length=0.1, n_edges=10)
    motion = lay_down(string, 2.5, 1250, belt=Belt(0.2), estimate_error=False)
    curve = motion.laid_curve(skip=0.3)
    assert curve.curve == fp.EllipticNozzle(0.2, 0.1, 0.05, 3.0, 0.3)
    (xi,) = curve.deviations
    # Its loops are of a centimetre, on curves of ten and five.
    assert np.sqrt((xi**2).mean(axis=0)).max() < 0.02
    assert np.ptp(curve.eta[:, 1]) > 0.07
    # Where no reference curve is known there is none.
    fast = lay_down(
        hanging(Nozzle((0, 0, 0.3), TILTED, 1.0)), 0.2, 100, belt=Belt(-1.0),
        estimate_error=False,
    )  # fmt: skip
    with pytest.raises(ValueError, match="speed"):
        _ = fast.reference_curve


def test_the_same_arguments_lay_the_same_fibre_to_the_last_bit():
    string = hanging(Nozzle((0, 0, 0.22), TILTED, 1.0), length=0.2)
    first, second = (
        lay_down(string, 0.3, 30, belt=Belt(0.3), air=AirFlow((0.1, 0, -0.5)))
        for _ in range(2)
    )
    assert first.rejected.sum() > 0
    np.testing.assert_array_equal(first.landed, second.landed)
    np.testing.assert_array_equal(first.last.r, second.last.r)
    assert first.position_error == second.position_error > 0


def test_loops_that_stand_are_left_behind_after_the_settling_time():
    string = hanging(Nozzle((0, 0, 0.3), TILTED, 1.0), 1e9, n_edges=20)
    tall, flat = (
        lay_down(string, 1.0, 300, belt=Belt(0.0, 0.0, time), estimate_error=False)
        for time in (math.inf, 0.2)
    )
    assert tall.free_length[-1] > 0.6 > 0.5 > flat.free_length[-1]
    assert len(flat.landed) > len(tall.landed) + 30
    # Under where they stand: nearer to each other than along the fibre.
    edges = np.linalg.norm(np.diff(flat.landed, axis=0), axis=1) / string.edge
    assert edges.max() < 1 + 1e-12
    assert edges.min() < 0.9


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Belt(0.1, settling_time=0.0), "`settling_time` must be positive"),
        (
            lambda: lay_down(
                hanging(Nozzle(NOWHERE, TILTED, 1.0)), 1.0, 2, tolerance=0.0
            ),
            "`tolerance` must be positive",
        ),
        (
            lambda: lay_down(hanging(Clamped(NOWHERE, (0, 0, -1))), 1.0, 2),
            "`string` must have a `Nozzle` as its start and a free end",
        ),
        (lambda: Nozzle(NOWHERE, (0, 0, -1), 0.0), "`speed` must be positive"),
        (
            lambda: Nozzle(NOWHERE, (0, 0, -1), 1.0, (1.0, math.nan)),
            "`radii` must",
        ),
        (
            lambda: Nozzle(NOWHERE, (0, 0, -1), 1.0, (1.0, 2.0, 3.0)),
            "`radii` must be two numbers",
        ),
        (lambda: Belt(math.inf), "`speed` must be finite"),
        (
            lambda: lay_down(
                hanging(Nozzle((0, 0, 0.1), TILTED, 1.0)), 1.0, 2, belt=Belt(0.1)
            ),
            "`shape` must not be below the belt at 0 m",
        ),
        (
            lambda: lay_down(
                hanging(Nozzle((0, 0, 1), (0, 0, -1), 1.0)), 1.0, 2, belt=Belt(0.1)
            ),
            "`string` must not hang straight above the belt.* tilt",
        ),
        (
            lambda: lay_down(hanging(Nozzle(NOWHERE, TILTED, 1.0)), 1.0, 2, theta=0.4),
            "`theta` must lie between 0.5 and 1, got 0.4",
        ),
        (
            lambda: lay_down(
                hanging(Nozzle(NOWHERE, TILTED, 1.0)), 1.0, 2, velocity=[1.0]
            ),
            r"`velocity` must have the shape \(11, 3\) or",
        ),
        (
            lambda: fp.fibre.simulate(hanging(Nozzle(NOWHERE, TILTED, 1.0)), 1.0, 2),
            "`string` must not be held by a nozzle.* `lay_down`",
        ),
        (
            lambda: lay_down(
                hanging(Nozzle((0, 0, 0.3), TILTED, 1.0)), 0.1, 50, belt=Belt(0.1)
            ).laid_curve(skip=0.1),
            "`skip` must leave five nodes on the belt, got 0.1 m of",
        ),
    ],
)
def test_what_cannot_be_laid_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("options", [{"belt": 0.3}, {"air": (1.0, 0, 0)}])
def test_what_is_of_another_kind_is_refused(options):
    with pytest.raises(TypeError, match=f"`{next(iter(options))}` must be"):
        lay_down(hanging(Nozzle((0, 0, 1), TILTED, 1.0)), 1.0, 2, **options)


def test_a_soft_fibre_heaps_on_a_belt_at_rest_and_keeps_its_length():
    # Edges are as long as its loops: nodes come to lie on each other, and between.
    string = hanging(Nozzle((0, 0, 0.3), TILTED, 1.0), n_edges=20)
    motion = lay_down(string, 0.9, 600, belt=Belt(0.0), estimate_error=False)
    last = motion.last
    # What stands in arcs is kept, with all that lies before it.
    assert last.laid.sum() + len(motion.landed) > 60
    assert motion.stretched.max() <= 1e-12
    assert np.abs(last.r[last.laid]).max() < 0.1


@pytest.mark.parametrize(
    ("first", "second", "last", "expected"),
    [
        # Two edges of 5 over a distance of 6, on the side of the node.
        ((0, 0), (3.0, 1.0, 4.0), (6, 0), (3, 4)),
        ((0, 0), (3.0, -1.0, 4.0), (6, 0), (3, -4)),
        # Both ends at one place, and stretched to the whole.
        ((1, 1), (1.0, 3.0, 1.0), (1, 1), (1, 6)),
        ((0, 0), (5.0, 0.0, 0.0), (10, 0), (5, 0)),
        ((0, 0), (3.0, 0.0, 4.0), (6, 0), (3, 4)),
        ((0, 0), (0.0, 0.0, 5.0), (0, 0), (5, 0)),
    ],
)
def test_a_node_between_two_that_lie_is_put_down_beside_them(
    first, second, last, expected
):
    three = np.array([(*first, 0.0), second, (*last, 0.0)], dtype=float)
    found = put_down(three, 5.0)
    np.testing.assert_allclose(found, [*expected, 0.0], atol=1e-15)


def test_a_belt_that_tears_at_the_fibre_stops_the_run():
    string = hanging(Nozzle((0, 0, 0.25), TILTED, 1.0))
    with pytest.raises(fp.EdgeLengthError, match="take more `n_steps`"):
        lay_down(string, 2.0, 500, belt=Belt(3.0), estimate_error=False)
