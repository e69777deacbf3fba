"""Stationary densities: explicit on a fixed belt, iterated on a moving one."""

import numpy as np
import pytest

import fpsolve as fp

GRID = fp.PhaseSpaceGrid(5.5, (44, 44, 32))


def moving(noise=1.0, speed=0.1, potential=None):
    potential = potential or fp.QuadraticPotential()
    return fp.LayDownModel(potential, noise, fp.MovingBelt(speed))


@pytest.fixture(scope="module")
def on_the_belt():
    return fp.steady_state(moving(), GRID, ds=0.1, extrapolate=True)


@pytest.mark.parametrize("noise", [0.0, 0.3, 4.0])
def test_on_a_fixed_belt_the_density_is_the_equilibrium_for_every_noise(noise):
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.6), noise)
    state = fp.steady_state(model, GRID, ds=0.1)
    expected = fp.initial.equilibrium(GRID, model.potential)
    np.testing.assert_array_equal(state.density, expected)
    # The balanced scheme keeps constants to rounding: ten steps of about 1e-16.
    assert state.residual < 1e-13


def test_the_residual_is_that_of_the_scheme_it_is_asked_about():
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
    plain = fp.steady_state(fp.drift_kick(model, GRID), ds=0.1)
    # The plain form moves the equilibrium by its splitting error, 1e-3 at this ds.
    assert 1e-6 < plain.residual < 1e-2


def test_the_iteration_reaches_the_residual_it_states(on_the_belt):
    assert on_the_belt.residual <= 1e-9
    scheme = fp.drift_kick(moving(), GRID, balanced=True)
    finer = fp.steady_state(scheme, ds=0.05)
    solution = fp.solve(scheme, finer.density, (0.0, 2.0), 0.05, record_every=20)
    change = fp.diagnostics.l1_distance(solution.final, finer.density, GRID)
    # Twice the stride of one at 1e-9 each, and as much again for the records.
    assert change < 5e-9


def test_the_mean_direction_balances_the_belt(on_the_belt):
    moments = on_the_belt.moments()
    # E cos α = −v and E sin α = 0 for every potential; what is left is the error in
    # ds, estimated by the result itself, and what the box cuts off, below 1e-5.
    assert abs(moments["mean_cos_alpha"] + 0.1) < on_the_belt.error + 1e-5
    assert abs(moments["mean_sin_alpha"]) < 1e-12


def test_mass_is_one_and_the_belt_moves_the_mean_forward(on_the_belt):
    mass = fp.diagnostics.mass(on_the_belt.density, GRID)
    assert abs(mass - 1) < 1e-13
    # A²v to leading order for large noise; at A = 1 a quarter more.
    assert 0.1 < on_the_belt.moments()["mean_xi1"] < 0.15
    marginal = on_the_belt.marginal("xi1")
    assert marginal.shape == GRID.xi1.shape


def test_without_noise_speed_or_confinement_there_is_no_stationary_density():
    with pytest.raises(ValueError, match="`noise` must be positive on a moving belt"):
        fp.steady_state(moving(noise=0.0), GRID)
    free = fp.LayDownModel(fp.FreePotential(), 1.0)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.steady_state(free, GRID)
    curve = fp.RotatingNozzle(0.1, 0.5, 1.0)
    rotating = fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)
    with pytest.raises(ValueError, match="`curve` must move at constant speed"):
        fp.steady_state(rotating, GRID)


def test_a_weak_linear_potential_loses_the_fibre_to_the_belt():
    # I1(2/9)/I0(2/9) = 0.1104 for A = 3: a belt at 0.2 is too fast.
    weak = moving(noise=3.0, speed=0.2, potential=fp.LinearPotential())
    with pytest.raises(ValueError, match=r"`speed` must be below .* = 0\.1104 for the"):
        fp.steady_state(weak, GRID)


def test_arguments_that_cannot_work_are_named():
    with pytest.raises(TypeError, match="`grid` is needed with a model"):
        fp.steady_state(moving())
    with pytest.raises(ValueError, match="`tolerance` must be positive, got nan"):
        fp.steady_state(moving(), GRID, tolerance=float("nan"))
    with pytest.raises(ValueError, match="`ds` must be positive, got 0"):
        fp.steady_state(moving(), GRID, ds=0.0)
    positive = fp.drift_kick(moving(), GRID, positive=True)
    with pytest.raises(ValueError, match="`scheme` must be linear"):
        fp.steady_state(positive)
    other = fp.PhaseSpaceGrid(5.0, (44, 44, 32))
    with pytest.raises(ValueError, match="`grid` must be the scheme's own"):
        fp.steady_state(fp.drift_kick(moving(), GRID), other)


def test_a_residual_out_of_reach_is_an_error_with_its_numbers():
    coarse = fp.PhaseSpaceGrid(5.5, (16, 16, 8))
    with pytest.raises(fp.SteadyStateError, match="steady state not reached") as caught:
        fp.steady_state(moving(), coarse, ds=0.25, tolerance=1e-30)
    assert caught.value.residual > caught.value.tolerance == 1e-30


def test_a_box_that_cuts_the_density_off_is_refused():
    small = fp.PhaseSpaceGrid(1.5, (16, 16, 16))
    with pytest.raises(fp.DomainTooSmallError, match="enlarge `half_width`"):
        fp.steady_state(fp.LayDownModel(fp.QuadraticPotential(), 1.0), small, ds=0.1)
