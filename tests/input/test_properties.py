"""What holds for every model, grid and step, and what no model may do: crash."""

import warnings

import numpy as np
import pytest
import strategies as given_
from hypothesis import given
from hypothesis import strategies as st

from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.errors import MassCorrectionError, MassDriftError
from fpsolve.grids.diagnostics import l1_distance
from fpsolve.grids.initial import equilibrium
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import FixedBelt, MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit
from fpsolve.spectral.evolution.quadratic import check_model

N_STEPS = 4
# A density may leave any of these boxes; here that is no matter.
FREELY = {
    f"{name}_tolerance": np.inf
    for name in ("boundary", "negative", "entropy", "circulation")
}


@pytest.fixture(autouse=True)
def quiet():
    """A coarse cell may hold less or more of a start, or of p_S, than there is."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "`grid` must have cells that", UserWarning)
        warnings.filterwarnings("ignore", "the sampled Gaussian had mass", UserWarning)
        yield


def run(scheme, p0, ds, s0=0.0, **options):
    span = (s0, s0 + N_STEPS * ds)
    return solve(scheme, p0, span, ds, **FREELY, **options)


def assert_announced(error):
    """An error that the docstring of `solve` lists, and not one of numpy."""
    if isinstance(error, MassCorrectionError):
        assert not 0 <= error.theta <= 1
    elif isinstance(error, MassDriftError):
        assert abs(error.drift) > error.tolerance
    else:
        assert str(error).startswith("`p0` must"), error


@given_.few(0.2)
@given(given_.models, given_.grids, given_.drift_kick_options, given_.steps,
       given_.starts)  # fmt: skip
def test_drift_kick_keeps_mass_and_sign_for_every_model(
    model, grid, options, ds, start
):
    p0 = given_.start(grid, *start)
    scheme = drift_kick(model, grid, **options)
    solution, error = given_.outcome(lambda: run(scheme, p0, ds))
    if error:
        # The balanced form refuses starts far above the equilibrium, and steps with
        # too large a correction; nothing else stops a run.
        assert options["balanced"], error
        assert_announced(error)
        return
    # Rounding of the sums over 2048 cells and 4 steps, or of the factor that restores.
    assert np.abs(solution.mass / solution.mass[0] - 1).max() <= 1e-13
    assert np.isfinite(solution.final).all()
    if options["positive"]:
        # The α step multiplies by exact matrices, whose rows cancel to rounding.
        assert solution.minimum.min() >= -1e-16 * p0.max()


@given_.few(0.2)
@given(given_.models, given_.grids, given_.semi_lagrangian_options, given_.steps,
       given_.starts)  # fmt: skip
def test_characteristics_keep_mass_or_say_why_not(model, grid, options, ds, start):
    p0 = given_.start(grid, *start)
    tolerance = 1e-10 if options["adjusted"] else np.inf
    scheme = semi_lagrangian(model, grid, **options)
    solution, error = given_.outcome(
        lambda: run(scheme, p0, ds, mass_tolerance=tolerance)
    )
    if error:
        assert_announced(error)
        return
    assert np.isfinite(solution.final).all()
    if options["adjusted"]:
        assert np.abs(solution.mass / solution.mass[0] - 1).max() <= 1e-10


@given_.few(0.1)
@given(given_.potentials, given_.noises, given_.grids, st.booleans(), given_.steps)
def test_the_equilibrium_of_every_potential_stays(potential, noise, grid, positive, ds):
    model = LayDownModel(potential, noise, FixedBelt())
    p0 = equilibrium(grid, potential)
    scheme = drift_kick(model, grid, balanced=True, positive=positive)
    final = run(scheme, p0, ds).final
    # p_S is a constant h = 1: weights that sum to one to a few eps, four steps.
    assert l1_distance(final, p0, grid) <= 1e-13


@given_.few(0.1)
@given(given_.potentials, given_.noises, given_.belts, given_.grids,
       st.booleans(), given_.steps, given_.starts)  # fmt: skip
def test_what_is_mirrored_at_the_belt_stays_mirrored(
    potential, noise, belt, grid, positive, ds, start
):
    # All potentials here are even in ξ2. (ξ2, α) → −(ξ2, α) reverses two axes.
    scheme = drift_kick(LayDownModel(potential, noise, belt), grid, positive=positive)
    p0 = given_.start(grid, *start)
    mirrored = run(scheme, p0[:, ::-1, ::-1], ds).final
    expected = run(scheme, p0, ds).final[:, ::-1, ::-1]
    # The same sums in another order.
    assert np.abs(mirrored - expected).max() <= 1e-13 * p0.max()


@given_.few(0.1)
@given(given_.isotropic_potentials, given_.noises, given_.steps, given_.starts,
       st.integers(4, 8), st.integers(2, 4))  # fmt: skip
def test_what_is_turned_by_a_right_angle_stays_turned(
    potential, noise, ds, start, half, quarter
):
    grid = PhaseSpaceGrid(6.0, (2 * half, 2 * half, 4 * quarter))
    scheme = drift_kick(LayDownModel(potential, noise), grid)
    p0 = given_.start(grid, *start)

    def turned(p):
        return np.roll(np.rot90(p, 1, axes=(0, 1)), quarter, axis=2)

    first, second = run(scheme, turned(p0), ds).final, turned(run(scheme, p0, ds).final)
    assert np.abs(first - second).max() <= 1e-13 * p0.max()


@given_.few(0.2)
@given(given_.potentials, given_.noises, given_.belts, given_.grids, given_.steps,
       st.integers(-8, 8))  # fmt: skip
def test_when_a_run_begins_does_not_matter_on_a_belt(
    potential, noise, belt, grid, ds, begin
):
    scheme = drift_kick(LayDownModel(potential, noise, belt), grid)
    p0 = given_.start(grid)
    # Steps are powers of two, and so are all arclengths: the same numbers.
    assert np.array_equal(run(scheme, p0, ds).final, run(scheme, p0, ds, begin).final)


@given_.few(0.1)
@given(given_.models, given_.grids, given_.steps, given_.starts,
       given_.between(0.1, 10.0), given_.between(0.1, 10.0))  # fmt: skip
def test_the_plain_scheme_is_linear(model, grid, ds, start, a, b):
    scheme = drift_kick(model, grid)
    p, q = given_.start(grid, *start), given_.start(grid)
    both = run(scheme, a * p + b * q, ds).final
    apart = a * run(scheme, p, ds).final + b * run(scheme, q, ds).final
    # Rounding, and the factor below 1e-12 that takes mass errors of rounding out.
    assert np.abs(both - apart).max() <= 1e-12 * (a * p.max() + b * q.max())


@given_.few(0.1)
@given(given_.potentials, given_.between(0.5, 5.0), given_.belts,
       st.tuples(cells := st.integers(4, 16), cells),
       given_.between(1e-3, 1e3))  # fmt: skip
def test_the_limit_of_large_noise_keeps_mass_sign_and_the_law_of_entropy(
    potential, noise, belt, shape, ds
):
    model = LayDownModel(potential, noise, belt)
    limit, error = given_.outcome(lambda: HydrodynamicLimit(model))
    if error:
        # A linear pull weaker than the belt confines nothing.
        assert "confine" in str(error) or "belt" in str(error)
        return
    grid = PlaneGrid(5.0, shape)
    found = limit.solve(
        lambda x, y: np.exp(-((x - 0.5) ** 2) - y**2), (0.0, 3 * ds), ds, grid=grid,
        boundary_tolerance=1e3,
    )  # fmt: skip
    assert np.abs(found.mass / found.mass[0] - 1).max() <= 1e-12
    assert found.minimum.min() >= 0
    # Backward Euler lets the entropy fall at every step, whatever ds; rounding of it.
    entropy = found.relative_entropy
    assert np.diff(entropy).max() <= 1e-13 * max(1.0, entropy[0])


@given_.few(0.1)
@given(given_.models)
def test_models_that_the_expansion_does_not_solve_are_named(model):
    _, error = given_.outcome(lambda: check_model(model))
    if error:
        assert "got" in str(error)
    else:
        assert isinstance(model.curve, FixedBelt | MovingBelt) or model.curve.autonomous
        assert model.noise > 0
