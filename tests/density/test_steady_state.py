"""Stationary densities: explicit on a fixed belt, iterated on a moving one."""

import re
import warnings

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.density.stationary.coarser import carried, coarser_grid
from fpsolve.density.stationary.requirements import check_stationary
from fpsolve.errors import ToleranceError

GRID = fp.PhaseSpaceGrid(5.5, (44, 44, 32))


def moving(noise=1.0, speed=0.1, potential=None):
    potential = potential or fp.QuadraticPotential()
    return fp.LayDownModel(potential, noise, fp.MovingBelt(speed))


@pytest.fixture(scope="module")
def on_the_belt():
    return fp.steady_state(moving(), GRID, ds=0.1, extrapolate=True)


@pytest.fixture(scope="module")
def fast():
    """A = 3, v = 1/9: a step as usual is wrong by 5e-3 in L1 here."""
    model = moving(noise=3.0, speed=1 / 9)
    return model, fp.spectral_steady_state(model, tolerance=1e-9)


def apart(state, reference):
    """L1 distance to a density that is known, outside of the box included."""
    exact = reference.density(state.grid)
    inside = fp.diagnostics.l1_distance(state.density, exact, state.grid)
    return inside + max(0.0, 1 - fp.diagnostics.mass(exact, state.grid))


@pytest.mark.parametrize("noise", [0.3, 4.0])
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
    grid = fp.PhaseSpaceGrid(5.5, (28, 28, 16))
    scheme = fp.drift_kick(moving(), grid)
    finer = fp.steady_state(scheme, ds=0.05, error_tolerance=0.1)
    solution = fp.solve(scheme, finer.density, (0.0, 2.0), 0.05, record_every=20)
    change = fp.diagnostics.l1_distance(solution.final, finer.density, grid)
    # Twice the stride of one at 1e-9 each, and as much again for the records.
    assert change < 5e-9


def test_the_mean_direction_balances_the_belt(on_the_belt):
    moments = on_the_belt.moments()
    # E cos α = −v and E sin α = 0 for every potential; what is left is estimated by
    # the result itself.
    assert (
        abs(moments["mean_cos_alpha"] + 0.1)
        < (on_the_belt.moment_errors["mean_cos_alpha"])
    )
    assert abs(moments["mean_sin_alpha"]) < 1e-12


def test_mass_is_one_and_the_belt_moves_the_mean_forward(on_the_belt):
    mass = fp.diagnostics.mass(on_the_belt.density, GRID)
    assert abs(mass - 1) < 1e-13
    # A²v to leading order for large noise; at A = 1 a quarter more.
    assert 0.1 < on_the_belt.moments()["mean_xi1"] < 0.15
    marginal = on_the_belt.marginal("xi1")
    assert marginal.shape == GRID.xi1.shape


@pytest.mark.parametrize("shape", [(40, 40, 24), (25, 25, 16)])
def test_what_a_result_states_covers_density_and_moments(fast, shape):
    model, exact = fast
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        state = fp.steady_state(model, fp.PhaseSpaceGrid(6.5, shape))
    assert apart(state, exact) < state.error
    assert state.error == pytest.approx(sum(state.errors.values()))
    for name, value in state.moments().items():
        assert abs(value - exact.moments[name]) < state.moment_errors[name], name


def test_the_tolerance_is_met_by_default_where_the_grid_allows_it(fast):
    model, exact = fast
    state = fp.steady_state(model, fp.PhaseSpaceGrid(6.5, (44, 44, 28)))
    # filterwarnings = error: no warning was given.
    assert apart(state, exact) < state.error < 1e-4
    text = repr(state)
    assert "E ξ1 = 1.0122" in text
    assert "grid" in text
    assert f"L1 error {state.error:.1g}" in text


def test_steps_are_shortened_as_far_as_the_tolerance_asks(fast):
    model, _ = fast
    grid = fp.PhaseSpaceGrid(6.5, (24, 24, 16))
    plain = fp.steady_state(model, grid, error_tolerance=0.05, tolerance=1e-6)
    with pytest.warns(UserWarning, match="L1 error"):
        finer = fp.steady_state(model, grid, error_tolerance=1e-5, tolerance=1e-6)
    assert finer.ds < plain.ds
    # A fifth of the tolerance belongs to the step.
    assert finer.errors["step"] < 2e-6 < plain.errors["step"]


def test_a_single_step_states_how_far_it_is_from_shorter_ones(fast):
    model, _ = fast
    grid = fp.PhaseSpaceGrid(6.5, (24, 24, 16))
    with pytest.warns(UserWarning, match="shorten `ds` = 0.125"):
        single = fp.steady_state(model, grid, ds=1 / 8)
    with pytest.warns(UserWarning, match="cells would do"):
        several = fp.steady_state(model, grid)
    assert not single.extrapolated
    assert several.extrapolated
    distance = fp.diagnostics.l1_distance(single.density, several.density, grid)
    # The estimate adds a quarter for the error of what it is compared with.
    assert distance < single.errors["step"] < 1.5 * distance


def test_a_grid_too_coarse_is_named_with_one_that_would_do(fast):
    model, exact = fast
    with pytest.warns(UserWarning, match="above `error_tolerance` = 0.001") as caught:
        state = fp.steady_state(
            model, fp.PhaseSpaceGrid(6.5, (24, 24, 12)), error_tolerance=1e-3
        )
    assert 1e-4 < apart(state, exact) < state.error
    numbers = re.search(
        r"half widths \((.*), (.*)\) and \((.*), (.*), (.*)\) cells",
        str(caught[0].message),
    )
    half1, half2, *shape = map(float, numbers.groups())
    proposed = fp.PhaseSpaceGrid((half1, half2), tuple(map(int, shape)))
    assert (24, 24, 12) < proposed.shape < (48, 48, 32)
    assert fp.steady_state(model, proposed, error_tolerance=1e-3).error < 1e-3


def test_a_box_too_small_is_told_by_what_comes_back_over_its_edge(fast):
    model, exact = fast
    with pytest.warns(UserWarning, match="half widths"):
        state = fp.steady_state(model, fp.PhaseSpaceGrid(4.8, (32, 32, 20)))
    assert state.errors["box"] > 10 * state.errors["grid"]
    assert 1e-3 < apart(state, exact) < state.error


def test_what_resolves_nothing_is_refused():
    coarse = fp.PhaseSpaceGrid(5.5, (12, 12, 8))
    with pytest.raises(ToleranceError, match="a grid of about half widths") as caught:
        fp.steady_state(moving(speed=0.5), coarse)
    assert caught.value.reached > 0.1 > caught.value.tolerance == 1e-4
    tiny = fp.PhaseSpaceGrid(5.5, (16, 16, 4))
    with pytest.raises(ValueError, match="`grid` must have at least 6 cells in every"):
        fp.steady_state(moving(), tiny)


def test_a_scheme_of_ones_own_comes_with_its_error_too():
    grid = fp.PhaseSpaceGrid(5.0, (20, 20, 12))
    scheme = fp.semi_lagrangian(moving(), grid, interpolation_order=6)
    own = fp.steady_state(scheme, tolerance=1e-5, error_tolerance=0.1)
    exact = fp.spectral_steady_state(moving(), tolerance=1e-8)
    assert 1e-4 < apart(own, exact) < own.error < 0.1


def test_on_a_fixed_belt_the_error_is_what_the_box_leaves_out():
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
    grid = fp.PhaseSpaceGrid(3.8, (20, 20, 8))
    with pytest.warns(UserWarning, match="box 0.00"):
        state = fp.steady_state(model, grid)
    exact = model.equilibrium(*grid.plane())[:, :, None]
    outside = 1 - float(exact.sum()) * 8 * grid.cell_volume
    inside = fp.diagnostics.l1_distance(state.density, exact + 0 * state.density, grid)
    assert outside > 2e-4
    assert inside + outside <= state.error
    assert (
        abs(state.moments()["variance_xi1"] - 1) < (state.moment_errors["variance_xi1"])
    )


def test_densities_are_carried_between_grids_as_trigonometric_polynomials():
    fine = fp.PhaseSpaceGrid((np.pi, 2.0), (16, 13, 12))
    coarse = coarser_grid(fine, 2 / 3)
    assert coarse.shape == (10, 7, 8)
    first, second = (
        1 + np.cos(3 * one.mesh()[0]) * np.sin(2 * one.mesh()[2])
        + np.sin(np.pi * one.mesh()[1])
        for one in (coarse, fine)
    )  # fmt: skip
    # Sums of a few ten terms of size one.
    np.testing.assert_allclose(carried(first, fine.shape), second, atol=1e-13)


def test_without_noise_speed_or_confinement_there_is_no_stationary_density():
    for belt in (fp.MovingBelt(0.1), fp.FixedBelt()):
        still = fp.LayDownModel(fp.QuadraticPotential(), 0.0, belt)
        with pytest.raises(
            ValueError, match="`noise` must be positive, got 0; without"
        ):
            fp.steady_state(still, GRID)
    free = fp.LayDownModel(fp.FreePotential(), 1.0)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.steady_state(free, GRID)
    curve = fp.RotatingNozzle(0.1, 0.5, 1.0)
    rotating = fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)
    with pytest.raises(ValueError, match="`curve` must move at constant speed"):
        fp.steady_state(rotating, GRID)


def test_a_weak_linear_potential_loses_the_fibre_to_the_belt():
    # I1(2/9)/I0(2/9) = 0.1104 for A = 3: a belt at 0.2 is too fast.
    aside = fp.CallablePotential(
        lambda x, y: np.hypot(x - 1, y),
        lambda x, y: ((x - 1) / np.hypot(x - 1, y), y / np.hypot(x - 1, y)),
    )
    for potential in (fp.LinearPotential(), fp.PowerPotential(1.0), aside):
        weak = moving(noise=3.0, speed=0.2, potential=potential)
        with pytest.raises(ValueError, match=r"`speed` must be below .* = 0\.1104 for"):
            fp.steady_state(weak, GRID)
    # Where B grows faster, every belt is held.
    check_stationary(moving(noise=3.0, speed=0.9, potential=fp.PowerPotential(1.5)))


def test_arguments_that_cannot_work_are_named():
    with pytest.raises(TypeError, match="`grid` is needed with a model"):
        fp.steady_state(moving())
    with pytest.raises(ValueError, match="`tolerance` must be positive, got nan"):
        fp.steady_state(moving(), GRID, tolerance=float("nan"))
    with pytest.raises(ValueError, match="`ds` must be positive, got 0"):
        fp.steady_state(moving(), GRID, ds=0.0)
    with pytest.raises(ValueError, match="`error_tolerance` must be positive, got -1"):
        fp.steady_state(moving(), GRID, error_tolerance=-1.0)
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
