"""How the angle is forgotten: exact for B = 0, of order ε² in the plane otherwise."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import initial
from fpsolve.errors import GridMismatchError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, InitialLayer

GRID = PhaseSpaceGrid(5.0, (40, 40, 16))
ANGLE = 0.6


def directed(grid, concentration=3.0):
    return initial.gaussian(grid, (0.4, -0.2), 0.4, ANGLE, concentration)


def test_for_no_potential_the_mean_is_the_exact_one_for_all_s():
    # E(ξ_s − ξ_0) = (2/A²)(1 − e^{−A²s/2}) E τ for B = 0. The slow part keeps its mean,
    # for the slow equation is then diffusion alone.
    noise = 2.0
    p0 = directed(GRID)
    layer = InitialLayer(p0, GRID, noise)
    xi1, xi2 = GRID.plane()
    area, volume = GRID.cell_area, GRID.cell_volume
    for axis, (xi, wave) in enumerate(
        ((xi1, np.cos(GRID.alpha)), (xi2, np.sin(GRID.alpha)))
    ):
        direction = (p0 * wave).sum() * volume
        start = (layer.density_at_start * xi).sum() * area
        slow = (layer.corrected_start * xi).sum() * area
        assert abs(direction) > 0.3, axis
        # Rounding; the start vanishes at the walls.
        assert slow - start == pytest.approx(2 / noise**2 * direction, abs=1e-12)
        for s in (0.0, 0.3, 2.0):
            held = (layer.density(s) * xi[:, :, None]).sum() * volume
            expected = 2 / noise**2 * -math.expm1(-(noise**2) * s / 2) * direction
            assert slow + held - start == pytest.approx(expected, abs=1e-12)


def test_the_layer_carries_no_mass_and_the_corrected_start_has_all_of_it():
    layer = InitialLayer(directed(GRID), GRID, 1.5)
    # Sums of 25 000 terms; fluxes telescope.
    assert layer.corrected_start.sum() * GRID.cell_area == pytest.approx(1.0, abs=1e-13)
    for s in (0.0, 1.0):
        assert abs(layer.density(s).sum()) * GRID.cell_volume < 1e-13


def test_at_the_start_the_slow_part_and_the_layer_are_the_given_density():
    p0 = directed(GRID)
    layer = InitialLayer(p0, GRID, 1.5)
    slow = np.repeat(layer.corrected_start[:, :, None] / (2 * math.pi), 16, axis=2)
    np.testing.assert_allclose(slow + layer.density(0.0), p0, atol=1e-15)


@pytest.mark.parametrize("harmonic", [1, 2, 3])
def test_every_harmonic_dies_at_its_own_rate(harmonic):
    xi1, xi2, alpha = GRID.mesh()
    plane = np.exp(-(xi1**2) - xi2**2)
    p0 = plane * (1.0 + 0.5 * np.cos(harmonic * alpha - 0.4))
    layer = InitialLayer(p0, GRID, 1.5)
    wave = np.exp(-1j * harmonic * GRID.alpha)
    before, after = (layer.density(s) @ wave for s in (0.0, 0.7))
    # A transform of 16 values.
    decay = math.exp(-(harmonic**2) * 1.5**2 * 0.7 / 2)
    np.testing.assert_allclose(after, decay * before, atol=1e-14)
    assert layer.length == pytest.approx(2 / 1.5**2)


def test_a_start_without_direction_is_not_corrected():
    p0 = initial.gaussian(GRID, (0.5, 0.0), 0.5)
    layer = InitialLayer(p0, GRID, 1.0)
    np.testing.assert_allclose(
        layer.corrected_start, layer.density_at_start, atol=1e-15
    )


def plane_errors(noise, corrected):
    """L¹ errors in the plane and of p after the layer and in the middle of it."""
    model = LayDownModel(QuadraticPotential(), noise)
    limit = HydrodynamicLimit(model)
    p0 = directed(GRID, 1.0)
    # A unit of slow arclength, and the arclength of the layer.
    stops = (2.0 / noise**2, 0.5 * noise**2)
    ds = stops[0] / 20
    full = fp.solve(
        fp.drift_kick(model, GRID, balanced=True),
        p0,
        (0.0, stops[1]),
        ds,
        save_at=stops,
        extrapolate=True,
        record_every=20,
    )
    layer = limit.initial_layer(p0, GRID)
    start = layer.corrected_start if corrected else layer.density_at_start
    slow = limit.solve(
        start, (0.0, stops[1]), ds, grid=GRID, save_at=stops, method="sdirk2"
    )
    found = []
    for s in stops:
        p = limit.reconstruct(slow.density(s), GRID)
        if corrected:
            p = p + layer.density(s)
        gap = p - full.density(s)
        plane = np.abs(gap.sum(axis=2) * GRID.spacing[2]).sum() * GRID.cell_area
        found += [plane, np.abs(gap).sum() * GRID.cell_volume]
    return found


def test_the_corrected_start_makes_the_plane_density_accurate_to_second_order():
    # ε = 1/4 and 1/8, belt at rest, compared with the full equation at the end of the
    # layer and at s = 1/(2ε). Cells of 0.25 contribute about 2e-3 to errors of 4e-2 and
    # 1e-2 in the plane, and higher powers of ε as much; orders 1 and 2 are told apart.
    coarse, fine = (
        np.array(plane_errors(noise, True)) for noise in (2.0, 2.0 * 2**0.5)
    )
    raw = np.array(plane_errors(2.0 * 2**0.5, False))
    plane_early, joint_early, plane_late, joint_late = np.log2(coarse / fine)
    assert plane_early > 1.6
    assert joint_early > 0.7
    assert plane_late > 1.6
    assert joint_late > 1.6
    # Without the correction the displacement 2ε E τ is missing for ever.
    assert raw[2] > 5 * fine[2]


def test_arguments_are_checked():
    p0 = directed(GRID)
    with pytest.raises(GridMismatchError, match="`p0` must have the shape"):
        InitialLayer(p0[:-1], GRID, 1.0)
    with pytest.raises(ValueError, match="`noise` must be positive and finite, got 0"):
        InitialLayer(p0, GRID, 0.0)
    with pytest.raises(ValueError, match="`s` must be non-negative and finite, got -1"):
        InitialLayer(p0, GRID, 1.0).density(-1.0)
