"""Fibres in flowing air: speed of fall, angle of a towed fibre, tables of flows."""

import math

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

import fpsolve as fp
from fpsolve._kernels.chain import Iterate, Step
from fpsolve.fibre import (
    AirFlow,
    Free,
    Hinged,
    String,
    drag_force,
    simulate,
)
from fpsolve.fibre.newton import Wind, no_pull
from fpsolve.fibre.theta_step import string_chain

NOWHERE = (0.0, 0.0, 0.0)
AIR = {"density": 1.2, "viscosity": 1.5e-5}
THIN = {"diameter": 20e-6, "density": 900.0, "youngs_modulus": 0.0}


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def drag(velocity, tangent):
    return drag_force(velocity, tangent, diameter=THIN["diameter"], **AIR)


def table(**units):
    """A flow that is linear in every coordinate, as a table of it."""
    x, y, z = np.linspace(-1, 1, 3), np.linspace(-1, 1, 4), np.linspace(-2, 1, 5)
    places = np.meshgrid(x, y, z, indexing="ij")
    fields = {
        name: (("x", "y", "z"), linear(places)[i])
        for i, name in enumerate(("velocity_x", "velocity_y", "velocity_z"))
    }
    found = xr.Dataset(fields, coords={"x": x, "y": y, "z": z})
    for name, unit in units.items():
        found[name].attrs["units"] = unit
    return found


def linear(places):
    x, y, z = places
    return np.stack([1 + x - z, 2 * y + 0 * x, 3.0 - z + x * 0.5])


@pytest.mark.parametrize("tangent", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_a_fibre_falls_as_fast_as_drag_balances_its_weight(tangent):
    fibre = String(0.02, **THIN, start=Free(), end=Free(), n_edges=8)
    shape = np.linspace(NOWHERE, 0.02 * np.array(tangent), 9)
    motion = simulate(
        fibre, 4.0, 400, shape=shape, air=AirFlow(NOWHERE), estimate_error=False
    )
    weight = fibre.line_density * 9.81
    speed = brentq(lambda u: drag([0, 0, u], tangent)[2] - weight, 1e-4, 5.0)
    # It has stopped accelerating: relaxation takes 6 and 11 ms.
    np.testing.assert_allclose(
        motion.v[-1], [[0, 0, -speed]] * 9, rtol=1e-9, atol=1e-12
    )


def test_a_fibre_that_is_towed_has_the_angle_of_balance():
    fibre = String(0.1, **THIN, start=Hinged(NOWHERE), end=Free(), n_edges=8)
    motion = simulate(
        fibre, 1.0, 300, theta=1.0, air=AirFlow((1.0, 0, 0)), estimate_error=False
    )
    weight = np.array([0, 0, -9.81 * fibre.line_density])

    def across(angle):
        tangent = np.array([math.sin(angle), 0, -math.cos(angle)])
        normal = np.array([math.cos(angle), 0, math.sin(angle)])
        return (drag([1.0, 0, 0], tangent) + weight) @ normal

    angle = brentq(across, 0.1, 1.57)
    edges = np.diff(motion.r[-1], axis=0) / fibre.edge
    # What is left of the swing after 1 s, which decays within 0.1 s.
    expected = [[math.sin(angle), 0, -math.cos(angle)]] * 8
    np.testing.assert_allclose(edges, expected, atol=1e-6)


def test_the_slope_of_the_force_is_its_derivative():
    rng = np.random.default_rng(1)
    velocity, tangent = rng.normal(size=(2, 6, 3))
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    # Of w from 1e-3, below the joint to Stokes's limit, to 1e3.
    velocity *= np.geomspace(1e-3, 1e3, 6)[:, None]
    air = AirFlow((5.0, 0, 0))
    force, slope = air.pull(20e-6, velocity, tangent)
    np.testing.assert_allclose(force, drag(velocity, tangent), rtol=1e-13)
    size = np.abs(slope).max(axis=(1, 2))
    for axis in range(3):
        step = np.zeros((6, 3))
        step[:, axis] = 1e-5 * np.linalg.norm(velocity, axis=1)
        ahead, _ = air.pull(20e-6, velocity + step, tangent)
        behind, _ = air.pull(20e-6, velocity - step, tangent)
        found = (ahead - behind) / (2 * step[:, [axis]])
        # Differences of 1e-6 in w inside, of 1e-5 here.
        assert (np.abs(found - slope[:, :, axis]).max(axis=1) < 1e-5 * size).all()
    assert (np.linalg.eigvalsh(0.5 * (slope + slope.swapaxes(1, 2))) > 0).all()


def test_motion_in_a_flow_is_of_order_two_in_the_step():
    fibre = String(0.05, **THIN, start=Hinged(NOWHERE), end=Free(), n_edges=6)
    air = AirFlow(lambda r, t: linear(r.T).T * (1 + math.sin(40 * t)))

    def after(n_steps):
        return simulate(fibre, 0.0125, n_steps, air=air)

    exact = simulate(fibre, 0.0125, 416, air=air, estimate_error=False).r[-1]
    motions = [after(n) for n in (26, 52, 104)]
    errors = [np.linalg.norm(one.r[-1] - exact, axis=1).max() for one in motions]
    assert (abs(orders(errors) - 2) < 0.25).all(), errors
    for motion, error in zip(motions, errors, strict=True):
        assert error <= motion.position_error < 6 * error
        assert motion.iterations[1:].max() <= 8


def test_a_table_of_a_linear_flow_is_that_flow():
    air = AirFlow.from_dataset(table(x="m", velocity_z="m/s"), **AIR)
    rng = np.random.default_rng(2)
    r = rng.uniform(-0.9, 0.9, size=(20, 3))
    np.testing.assert_allclose(air.at(r, 0.0), linear(r.T).T, rtol=1e-13, atol=1e-13)


def test_a_fibre_that_leaves_the_table_is_stopped():
    air = AirFlow.from_dataset(table())
    fibre = String(1.5, **THIN, start=Hinged(NOWHERE), end=Free(), n_edges=8)
    with pytest.raises(
        fp.FlowRangeError, match="outside of the table of the flow"
    ) as e:
        simulate(fibre, 5.0, 500, air=air, estimate_error=False)
    assert max(np.abs(e.value.position)) > 1


def test_an_iteration_that_strays_from_the_table_fails_its_step_and_not_the_run():
    fibre = String(0.5, **THIN, start=Hinged(NOWHERE), end=Free(), n_edges=4)
    wind, chain = Wind(AirFlow.from_dataset(table()), fibre), string_chain(fibre)
    r, still = fibre.s[:, None] * np.array([0.0, 0.0, -1.0]), np.zeros((5, 3))
    within, astray = (Iterate(r, still, one, np.zeros(4)) for one in (still, still + 9))
    step, pull = Step(0.1, 0.5, 0.0), no_pull(chain.masses)
    assert wind.meets(chain, step, within, 0.0, pull, 2)
    assert not wind.meets(chain, step, astray, 0.0, pull, 2)
    with pytest.raises(fp.FlowRangeError, match="enlarge the table"):
        wind.meets(chain, step, astray, 0.0, pull, 1)


def test_the_same_flow_as_numbers_function_and_table_moves_a_fibre_alike():
    fibre = String(0.05, **THIN, start=Hinged(NOWHERE), end=Free(), n_edges=4)
    steady = table()
    for name, value in zip(("x", "y", "z"), (2.0, 1.0, 0.5), strict=True):
        steady[f"velocity_{name}"][:] = value
    flows = (
        AirFlow((2.0, 1.0, 0.5)),
        AirFlow(lambda r, t: np.broadcast_to([2.0, 1.0, 0.5], r.shape)),
        AirFlow.from_dataset(steady),
    )
    motions = [simulate(fibre, 0.02, 20, air=air).r[-1] for air in flows]
    np.testing.assert_array_equal(motions[0], motions[1])
    np.testing.assert_allclose(motions[0], motions[2], atol=1e-13)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: AirFlow((1.0, 2.0)), ValueError, "`velocity` must be three numbers"),
        (lambda: AirFlow((1.0, 2.0, math.nan)), ValueError, "`velocity` must"),
        (lambda: AirFlow(NOWHERE, density=0.0), ValueError, "`density` must be pos"),
        (
            lambda: AirFlow(NOWHERE, slenderness=0.5),
            ValueError,
            "`slenderness` must be",
        ),
        (
            lambda: AirFlow.from_dataset(table().drop_vars("velocity_y")),
            ValueError,
            "`table` must have x, y, z, .* without velocity_y",
        ),
        (
            lambda: AirFlow.from_dataset(table(velocity_x="km/h")),
            ValueError,
            "`velocity_x` of the table must be in .*m.*s.*, got km/h; convert",
        ),
        (
            lambda: AirFlow.from_dataset(table().isel(x=slice(None, None, -1))),
            ValueError,
            "`table` must have rising coordinates",
        ),
        (
            lambda: simulate(
                String(0.05, **THIN), 1.0, 2, air=AirFlow(lambda r, t: r[:, 0])
            ),
            ValueError,
            r"`velocity` must return finite numbers of the shape \(65, 3\)",
        ),
        (
            lambda: simulate(String(0.05, **THIN), 1.0, 2, air=(1.0, 0, 0)),
            TypeError,
            "`air` must be an `AirFlow`",
        ),
    ],
)
def test_what_is_no_flow_is_refused(call, error, message):
    with pytest.raises(error, match=message):
        call()
