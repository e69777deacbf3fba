"""The contract of every operator: linear, the identity at ds = 0, a flow."""

import numpy as np
import pytest
from applied_operators import applied, kicked_by_full_matrices
from orders import assert_order, measure_order
from problems import AngularHeat

from fpsolve.density.schemes import drift_kick, rotation_table, semi_lagrangian
from fpsolve.density.schemes.characteristics import Characteristics
from fpsolve.density.schemes.diffusion import ImplicitDiffusion
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.stencils import shift_taps
from fpsolve.density.schemes.translation import Translation
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential, LinearPotential, QuadraticPotential

GRID = PhaseSpaceGrid((3.0, 2.5), (8, 10, 12))
MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 0.7, RotatingNozzle(0.1, 0.5, 1.0))
LINEAR = {
    "translation": Translation(MODEL, GRID),
    "rotation and diffusion of p": RotationDiffusion(MODEL, GRID),
    "rotation and diffusion of h": RotationDiffusion(MODEL, GRID, balanced=True),
    "Crank-Nicolson": ImplicitDiffusion(MODEL, GRID, 0.5),
    "backward Euler": ImplicitDiffusion(MODEL, GRID, 1.0, compact=False),
}
# Their limited variants: positive homogeneous only.
LIMITED = {
    "positive translation": Translation(MODEL, GRID, positive=True),
    "positive rotation": RotationDiffusion(MODEL, GRID, positive=True),
}
OPERATORS = {**LINEAR, **LIMITED}


@pytest.mark.parametrize("name", LINEAR)
def test_operators_are_linear(name, rng):
    p, q = rng.normal(size=(2, *GRID.shape))
    together = applied(LINEAR[name], 2.0 * p - 3.0 * q)
    apart = 2.0 * applied(LINEAR[name], p) - 3.0 * applied(LINEAR[name], q)
    # Rounding of sums of at most 12 terms of size 3, times 5.
    np.testing.assert_allclose(together, apart, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_scale_with_their_argument(name, rng):
    p = rng.uniform(size=GRID.shape)
    # A factor of two commutes with every rounding.
    operator = OPERATORS[name]
    assert np.array_equal(applied(operator, 2.0 * p), 2.0 * applied(operator, p))


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_are_the_identity_for_no_step(name, rng):
    p = rng.uniform(0.1, 1.0, GRID.shape)
    # To Fourier modes and back, or a tridiagonal matrix and its inverse: rounding.
    np.testing.assert_allclose(
        applied(OPERATORS[name], p, ds=0.0), p, rtol=0, atol=1e-14
    )


@pytest.mark.parametrize("scheme", [drift_kick, semi_lagrangian])
@pytest.mark.parametrize("form", ["plain", "balanced"])
def test_schemes_are_the_identity_for_no_step(scheme, form, rng):
    options = {"balanced": form == "balanced"}
    if scheme is semi_lagrangian:
        options = {"form": "h" if form == "balanced" else "p"}
    scheme = scheme(MODEL, GRID, **options)
    p = rng.uniform(0.1, 1.0, GRID.shape)
    state = scheme.start(p)
    scheme.advance(state, 0.3, 0.0)
    np.testing.assert_allclose(scheme.density(state), p, rtol=1e-13)


@pytest.mark.parametrize("name", OPERATORS)
def test_operators_keep_what_they_say(name, rng):
    # Mass of every row for what acts on the angle, of every angle for the translation;
    # constants where h is meant.
    p = rng.uniform(0.1, 1.0, GRID.shape)
    operator = OPERATORS[name]
    one = applied(operator, np.ones(GRID.shape))
    if name == "rotation and diffusion of h":
        moved1, moved2 = MODEL.curve.displacement(0.3, 0.5)
        slope1, slope2 = MODEL.potential.gradient(*GRID.plane())
        # Constants times the reaction e^{−Δγ·∇B}, which is that of h = e^{B} p.
        reaction = np.exp(-(moved1 * slope1 + moved2 * slope2))[:, :, None]
        np.testing.assert_allclose(one, reaction + 0 * one, rtol=1e-14)
        return
    axes = (0, 1) if "translation" in name else 2
    np.testing.assert_allclose(
        applied(operator, p).sum(axis=axes), p.sum(axis=axes), rtol=1e-14
    )
    if "rotation" not in name:
        np.testing.assert_allclose(one, 1.0, rtol=0, atol=1e-15)


@pytest.mark.parametrize("speed", [0.0, 0.4])
def test_translations_compose_up_to_interpolation(speed):
    # Two shifts make one: exact in s, order 16 in Δξ on a Gaussian of 2.8 cells.
    grid = PhaseSpaceGrid(6.0, (48, 48, 8))
    translate = Translation(
        LayDownModel(FreePotential(), 0.0, MovingBelt(speed)), grid, 16
    )
    p = grid.evaluate(lambda x, y, a: np.exp(-(x**2) - y**2) + 0 * a)
    halves = applied(translate, applied(translate, p, 0.0, 0.35), 0.35, 0.35)
    # 2.4e-7 measured.
    whole = applied(translate, p, 0.0, 0.7)
    np.testing.assert_allclose(halves, whole, rtol=0, atol=1e-6)


def test_diffusion_of_the_angle_is_exact_in_the_drift_kick_scheme():
    # With B = 0 the kick is diffusion alone, exact for every mode and step.
    for mode in (1, 3, 7):
        problem = AngularHeat(1.3, PhaseSpaceGrid(3.0, (4, 4, 16)), mode)
        kick = RotationDiffusion(problem.model, problem.grid)
        result = applied(kick, problem.initial(), 0.0, 0.9)
        np.testing.assert_allclose(result, problem.density(0.9), rtol=0, atol=1e-15)


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize("n_alpha", [4, 6, 8, 10, 12, 18])
def test_folded_rows_in_quads_give_what_full_matrices_give(n_alpha, balanced, rng):
    # Quarters of the circle with a half cell over, rows that share no matrix, and a
    # batch that is not full.
    grid = PhaseSpaceGrid((3.0, 2.5), (5, 7, n_alpha))
    kick = RotationDiffusion(LayDownModel(QuadraticPotential(1.0, 0.8), 0.7), grid)
    kick.balanced = balanced
    p = rng.normal(size=grid.shape)
    # Rounding of sums of at most 18 terms of size one.
    np.testing.assert_allclose(
        applied(kick, p), kicked_by_full_matrices(kick, p, 0.2), rtol=0, atol=1e-13
    )


@pytest.mark.parametrize("shape", [(4, 5, 4), (9, 7, 6), (6, 13, 18)])
@pytest.mark.parametrize("ds", [0.3, -2.0, 9.0])
def test_translations_are_their_taps_on_any_grid(shape, ds, rng):
    # Sizes that are no multiple of a block; shifts within a cell, beyond a period, and
    # to one side only.
    grid = PhaseSpaceGrid((3.0, 2.5), shape)
    translate = Translation(MODEL, grid, 6)
    p, expected = rng.normal(size=shape), np.zeros(shape)
    taps1, taps2 = (shift_taps(part, 6) for part in translate.shifts(0.3, ds))
    for t, weight1 in enumerate(taps1[1], taps1[0]):
        for u, weight2 in enumerate(taps2[1], taps2[0]):
            expected += weight1 * weight2 * np.roll(p, (t, u), axis=(0, 1))
    # Rounding of sums of 36 products, weights up to 1.
    np.testing.assert_allclose(
        applied(translate, p, 0.3, ds), expected, rtol=0, atol=2e-14
    )


@pytest.mark.parametrize("balanced", [False, True])
def test_kicks_depend_on_the_direction_of_the_force_through_a_turn_only(balanced):
    # Where the force is (F, 0) and where it is (0, F): the same, a quarter turn apart.
    grid = PhaseSpaceGrid(3.0, (8, 8, 16))
    kick = RotationDiffusion(LayDownModel(QuadraticPotential(), 0.7), grid, balanced)
    row = 1.0 + 0.5 * np.cos(grid.alpha - 0.4)
    p = np.ascontiguousarray(np.broadcast_to(row, grid.shape))
    turned = np.ascontiguousarray(np.broadcast_to(np.roll(row, 4), grid.shape))
    one, other = applied(kick, p), applied(kick, turned)
    # The cell at (x, y) and the one at (−y, x).
    np.testing.assert_allclose(np.roll(one[6, 5], 4), other[2, 6], rtol=0, atol=1e-14)


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize(
    "potential", [QuadraticPotential(), LinearPotential()], ids=repr
)
def test_interpolated_matrices_agree_with_the_exact_ones(
    potential, balanced, rng, monkeypatch
):
    grid = PhaseSpaceGrid(6.0, (24, 26, 32))
    model = LayDownModel(potential, 0.5)
    exact = RotationDiffusion(model, grid, balanced)
    interpolated = RotationDiffusion(model, grid, balanced)
    assert exact.table(0.2).coefficients.shape[1] == 1
    monkeypatch.setattr(rotation_table, "LARGEST_TABLE", 0.0)
    assert interpolated.table(0.2).coefficients.shape[1] == rotation_table.NODES
    smooth = grid.evaluate(
        lambda x, y, a: np.exp(-(x**2) - y**2) * (1.2 + np.cos(a - x))
    )
    rough = rng.uniform(size=grid.shape)
    # Chebyshev interpolation of degree 7: 8e-10 for the highest modes, which noise
    # excites, and next to rounding for those a smooth density has (1.5e-13 measured).
    for p, atol in ((smooth, 1e-12), (rough, 1e-8)):
        one, other = applied(exact, p), applied(interpolated, p)
        np.testing.assert_allclose(one, other, rtol=0, atol=atol)
    # What is kept exactly stays so: the weights of the interpolation sum to one.
    ones = np.ones(grid.shape)
    if balanced:
        kept = applied(interpolated, ones), ones
    else:
        kept = applied(interpolated, rough).sum(axis=2), rough.sum(axis=2)
    np.testing.assert_allclose(*kept, rtol=1e-13)


def test_feet_are_traced_to_fourth_order():
    # B = |ξ|²/2 without noise against steps 16 times as small.
    model = LayDownModel(QuadraticPotential(), 0.0, RotatingNozzle(0.1, 0.5, 1.0))
    grid = PhaseSpaceGrid(2.0, (6, 6, 8))
    exact = traced(model, grid, 256)

    def error_of(n_steps):
        return np.abs(traced(model, grid, n_steps) - exact).max()

    # 7.3e-6 measured.
    assert_order(measure_order(error_of, first=4), 4, 2e-5)


def traced(model, grid, n_steps):
    """Feet at s = 0 of the characteristics through the centres at s = 1."""
    ds, places = 1.0 / n_steps, grid.mesh()
    tracer = Characteristics(model, grid, balanced=True)
    places = np.broadcast_arrays(*places)
    for step in reversed(range(n_steps)):
        places = tracer._runge_kutta(tuple(places), step * ds, ds)[:3]
    return np.array(places)
