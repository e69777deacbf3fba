"""The noise of turbulent air: drag times fluctuations, from k and ε at every node."""

import math

import numpy as np
import pytest

from fpsolve.fibre import (
    AirFlow,
    Clamped,
    Free,
    String,
    TurbulenceSpectrum,
    TurbulentForce,
    drag_force,
    simulate,
)
from fpsolve.fibre.turbulent_air import smallest_energy, white_amplitudes

NOWHERE = (0.0, 0.0, 0.0)
AIR = {"density": 1.2, "viscosity": 1.5e-5}
ROUGH = {"k": 10.0, "dissipation": 1e4}
WIND = np.array([20.0, 0.0, 5.0])


def fibre(n_edges=4):
    return String(
        0.1, 20e-6, 900.0, 3e9, Clamped(NOWHERE, (0, 0, 1)), Free(), n_edges=n_edges
    )


def straight(string):
    return string.s[:, None] * np.array([0.0, 0.0, 1.0])


def strengths(law, air, velocity=NOWHERE):
    string = fibre()
    v = np.broadcast_to(np.array(velocity), (5, 3))
    return law.amplitudes(string, air, straight(string), v, 0.0)


def slope_of_drag(axis, size=1e-4):
    """∂f/∂v of a fibre along z in the wind, by differences."""
    step = size * np.eye(3)[axis]
    ends = [
        drag_force(WIND + sign * step, [0.0, 0, 1], diameter=20e-6, **AIR)
        for sign in (1, -1)
    ]
    return (ends[0] - ends[1]) / (2 * size)


@pytest.mark.parametrize("frozen", [False, True])
def test_the_noise_is_the_slope_of_the_drag_times_the_fluctuations(frozen):
    air = AirFlow(tuple(WIND), **AIR, **ROUGH)
    found = strengths(TurbulentForce(1.2, frozen=frozen), air)
    spectrum = TurbulenceSpectrum(**ROUGH, viscosity=1.5e-5, kolmogorov_constant=1.2)
    # Along the fibre z, along the flow across it x, along y.
    along, flow, normal = spectrum.decaying_amplitudes(20.0, 1e-3)
    if frozen:
        along = flow = float(spectrum.frozen_amplitude(20.0))
        normal = 0.0
    slope = np.stack([slope_of_drag(axis) for axis in range(3)], axis=-1)
    expected = slope @ np.diag([flow, normal, along])
    size = np.abs(expected).max()
    # Differences of 1e-6 of the Reynolds number.
    np.testing.assert_allclose(found, [expected] * 5, atol=3e-5 * size)


def test_only_the_velocity_of_the_air_past_the_fibre_counts():
    air = AirFlow(tuple(WIND), **AIR, **ROUGH)
    carried = AirFlow(tuple(WIND + 7), **AIR, **ROUGH)
    law = TurbulentForce()
    np.testing.assert_allclose(
        strengths(law, carried, (7.0, 7.0, 7.0)), strengths(law, air), rtol=1e-12
    )


def test_air_that_moves_with_the_fibre_shakes_it_alike_in_both_directions():
    air = AirFlow((0.0, 0.0, 3.0), **AIR, **ROUGH)
    found = strengths(TurbulentForce(decay_time=1e-3), air)[2]
    assert found[0, 0] == pytest.approx(found[1, 1], rel=1e-12)
    assert found[0, 0] > 0
    assert np.abs(found - np.diag(np.diag(found))).max() < 1e-12 * found[0, 0]


def test_another_spectrum_for_every_node_has_the_amplitudes_of_one():
    rng = np.random.default_rng(0)
    dissipation = 10 ** rng.uniform(-1, 6, 40)
    above = np.concatenate([[1e-12, 1e-6, 1e-3], rng.uniform(0, 10, 37)])
    options = {"viscosity": 1.5e-5, "constant": 1.2}
    k = smallest_energy(dissipation, **options) * np.exp(above)
    speed, time = 10 ** rng.uniform(-4, 2.5, 40), k / dissipation
    found = white_amplitudes(k, dissipation, speed, decay_time=time, **options)
    frozen = white_amplitudes(k, dissipation, speed, decay_time=None, **options)
    for i in range(40):
        one = TurbulenceSpectrum(k[i], dissipation[i], 1.5e-5, 1.2)
        exact = one.decaying_amplitudes(speed[i], time[i])
        # As declared, of a table against a quadrature.
        assert (np.abs(found[:, i] - exact) < 1e-8 * exact[0]).all()
        assert frozen[0, i] == pytest.approx(one.frozen_amplitude(speed[i]), rel=1e-8)
    np.testing.assert_array_equal(frozen[1], frozen[0])
    assert not frozen[2].any()
    still = white_amplitudes(k, dissipation, 0 * k, decay_time=time, **options)
    np.testing.assert_allclose(still[1:], [still[0] / np.sqrt(2)] * 2, rtol=1e-8)


def moved(air, law, seed=4):
    return simulate(
        fibre(8), 2e-3, 40, air=air, turbulence=law, seed=seed, theta=0.5,
        shape=straight(fibre(8)), estimate_error=False,
    ).r[-1]  # fmt: skip


def test_air_without_turbulence_moves_the_fibre_as_its_drag_does():
    calm = AirFlow((2.0, 0.0, 0.0), **AIR)
    still = simulate(
        fibre(8), 2e-3, 40, air=calm, shape=straight(fibre(8)), estimate_error=False
    )
    np.testing.assert_array_equal(moved(calm, TurbulentForce()), still.r[-1])
    # Rough at a half of the fibre only: that half is shaken first.
    half = AirFlow(
        (2.0, 0.0, 0.0), **AIR,
        k=lambda r, t: np.where(r[:, 2] > 0.05, 1e-2, 0.0),
        dissipation=lambda r, t: np.ones(len(r)),
    )  # fmt: skip
    away = np.linalg.norm(moved(half, TurbulentForce()) - still.r[-1], axis=1)
    assert away[-1] > 10 * away[1] > 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: TurbulentForce(0.0), "`kolmogorov_constant` must be positive"),
        (lambda: TurbulentForce(decay_time=-1.0), "`decay_time` must be positive"),
        (
            lambda: TurbulentForce(frozen=True, decay_time=1.0),
            "`decay_time` must be None for frozen eddies, got 1",
        ),
        (
            lambda: TurbulentForce(correlation_time=math.nan),
            "`correlation_time` must be",
        ),
        (lambda: moved(None, TurbulentForce()), "`air` must be given with a"),
        (
            lambda: moved(
                AirFlow((1.0, 0, 0), k=1e-4, dissipation=1.0), TurbulentForce()
            ),
            r"`k` of the air must be 0 or at least 0.0073.*, got 0.0001 at \(0, 0, 0\)",
        ),
        (
            lambda: moved(AirFlow(NOWHERE, **ROUGH), TurbulentForce(frozen=True)),
            "`frozen` must be False where the air does not move",
        ),
    ],
)
def test_what_is_no_turbulent_air_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
