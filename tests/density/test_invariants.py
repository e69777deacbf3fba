"""What every run keeps: mass, equilibrium, the law of its entropy, sign, symmetry."""

from functools import cache

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import Equilibrium, asymmetric_start

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.diagnostics import l1_distance
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import (
    EllipticNozzle,
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
    TabulatedCurve,
)
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)

SCHEMES = {
    "drift-kick": (drift_kick, {}),
    "drift-kick positive": (drift_kick, {"positive": True}),
    "drift-kick balanced": (drift_kick, {"balanced": True}),
    "drift-kick positive and balanced": (
        drift_kick, {"positive": True, "balanced": True},
    ),
    "semi-Lagrangian": (semi_lagrangian, {}),
    "semi-Lagrangian quintic": (semi_lagrangian, {"interpolation_order": 6}),
    "semi-Lagrangian limited": (semi_lagrangian, {"limited": True}),
    "semi-Lagrangian of first order": (
        semi_lagrangian, {"splitting": "lie", "diffusion": "backward_euler"},
    ),
    "semi-Lagrangian p-form": (semi_lagrangian, {"form": "p"}),
}  # fmt: skip
# Those that evolve h = p/p_S, for which p_S is a constant.
WELL_BALANCED = [
    name
    for name, (scheme, options) in SCHEMES.items()
    if options.get("balanced") or (scheme is semi_lagrangian and "form" not in options)
]
# Of these the ones whose values stay within bounds without any noise.
STABLE = [name for name in WELL_BALANCED if name != "drift-kick balanced"]
# Of these the ones that take ten times as long as the rest, and lose nothing at the
# edge of a small box: where no accuracy is asked for, their grids have fewer cells.
SLOW = [name for name in WELL_BALANCED if name.startswith("semi-Lagrangian")]
GRID = PhaseSpaceGrid(6.0, (24, 24, 16))
# Fewer cells of the same box where no accuracy is asked for, over as many steps.
COARSE = PhaseSpaceGrid(6.0, (16, 16, 16))
COSH = CallablePotential(
    lambda x, y: 0.5 * x**2 + np.log(np.cosh(y)) + 0.2 * y**2,
    lambda x, y: (x, np.tanh(y) + 0.4 * y),
)


def build(name, model, grid=GRID):
    scheme, options = SCHEMES[name]
    return scheme(model, grid, **options)


def smooth_start(grid=GRID):
    return initial.gaussian(grid, (1.5, 0.0), 0.5, np.pi / 2, 2.0)


def sharp_start(grid):
    """One on a box in phase space, zero elsewhere."""
    return initial.from_function(
        grid,
        lambda x, y, a: 1.0 * (abs(x - 1) < 0.8) * (abs(y) < 0.8) * (abs(a - 1) < 0.5),
    )


@cache
def long_run(name, curve):
    """From a smooth start to s = 50, in 250 steps; the same for several tests."""
    model = LayDownModel(QuadraticPotential(), 1.0, curve)
    box = (5.0, (16, 16, 12)) if name in SLOW else (6.0, (20, 20, 16))
    grid = PhaseSpaceGrid(*box)
    return solve(build(name, model, grid), smooth_start(grid), (0.0, 50.0), 0.2)


@pytest.mark.parametrize("curve", [FixedBelt(), MovingBelt(0.1)], ids=repr)
@pytest.mark.parametrize("name", SCHEMES)
def test_mass_is_kept_to_1e_13_over_an_arclength_of_50(name, curve):
    # 250 steps; each sums weights with an error of a fraction of an eps, and these
    # errors may have one sign: 250 · 2 shifts · 1e-16. Measured 1.4e-14 for the plain
    # drift-kick scheme, 7e-16 for the others.
    mass = long_run(name, curve).mass
    assert np.abs(mass / mass[0] - 1).max() <= 1e-13


@pytest.mark.parametrize("name", WELL_BALANCED)
@pytest.mark.parametrize("noise", [0.0, 3.0])
def test_equilibrium_stays_to_1e_13_over_an_arclength_of_50(noise, name):
    grid = COARSE if noise > 0 or name in SLOW else GRID
    problem = Equilibrium(LayDownModel(QuadraticPotential(), noise), grid)
    p0 = problem.initial()
    solution = solve(build(name, problem.model, grid), p0, (0.0, 50.0), 0.1)
    # 500 steps of a few eps each; 1.5e-14 measured.
    assert l1_distance(solution.final, p0, grid) <= 1e-13
    # Relative to p itself in every cell, tails of 1e-16 included. Without noise nothing
    # damps rounding in the corners, where the force turns by 0.8 rad a step: 2.5e-13
    # with shears, and more on fewer cells.
    assert np.abs(solution.final / p0 - 1).max() <= 1e-12
    # H, a sum of non-negative terms of second order in p/p_S − 1: rounding of the sum.
    floor = solution.entropy_floor
    assert np.abs(solution.relative_entropy - floor).max() <= 2e-15


@pytest.mark.parametrize("name", WELL_BALANCED)
def test_relative_entropy_never_grows_and_tends_to_that_of_the_grid(name):
    solution = long_run(name, FixedBelt())
    entropy = solution.relative_entropy
    # Rounding of the sum of H, whose first value is 1.9.
    assert np.diff(entropy).max() <= 2e-15
    assert abs(entropy[-1] - solution.entropy_floor) <= 2e-15
    assert entropy[0] > 1.0


# Name: order of the scheme, ceiling of the defect at ds = 1/64 for the start below
# (measured 1.7e-4 and 3.4e-3 for a dissipation that starts at 0.13).
ENTROPY_LAW = {
    "drift-kick": (2, 5e-4),
    "drift-kick positive": (2, 5e-4),
    "drift-kick balanced": (2, 5e-4),
    "semi-Lagrangian quintic": (2, 5e-4),
    "semi-Lagrangian of first order": (1, 1e-2),
}


@pytest.mark.parametrize("name", ENTROPY_LAW)
def test_entropy_falls_by_its_dissipation_to_the_order_of_the_scheme(name):
    # dH/ds = −D ∫ p (∂_α ln(p/p_S))² by the trapezoidal rule over every step.
    order, ceiling = ENTROPY_LAW[name]
    # Characteristics on fewer cells, whose error in Δξ does not show at these steps
    # either: orders within 0.05 of those on (40, 40, 32).
    cells = (32, 32, 24) if name.startswith("semi-Lagrangian") else (40, 40, 32)
    grid = PhaseSpaceGrid(5.5, cells)
    law = LayDownModel(QuadraticPotential(), 1.5)
    p0 = asymmetric_start(grid, law.potential)
    # Order 14 where it can be had, so that Δξ does not show.
    scheme, options = SCHEMES[name]
    if scheme is drift_kick:
        options = {**options, "interpolation_order": 14}
    scheme = scheme(law, grid, **options)

    def defect(n_steps):
        solution = solve(scheme, p0, (0.0, 1.0), 1.0 / n_steps)
        dissipation = solution.entropy_dissipation
        rate = np.diff(solution.relative_entropy) * n_steps
        return np.abs(rate + (dissipation[:-1] + dissipation[1:]) / 2).max()

    assert_order(measure_order(defect, first=16), order, ceiling)


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize("noise", [0.0, 0.05, 3.0])
@pytest.mark.parametrize(
    "potential", [QuadraticPotential(), LinearPotential()], ids=repr
)
def test_positive_drift_kick_never_goes_below_zero(potential, noise, balanced):
    half_width = 5.0 if isinstance(potential, QuadraticPotential) else 14.0
    grid = PhaseSpaceGrid(half_width, (24, 24, 16))
    model = LayDownModel(potential, noise)
    scheme = drift_kick(model, grid, positive=True, balanced=balanced)
    # The limiter moves much of a start this sharp: the circulation goes.
    solution = solve(
        scheme, sharp_start(grid), (0.0, 5.0), 0.1, circulation_tolerance=1.0
    )
    # Not even by rounding: a flux between 0 and its donor leaves a difference that
    # rounds to no less than 0, and the row limiter ends with max(·, 0).
    assert solution.minimum.min() >= 0.0


def test_limited_characteristics_with_backward_euler_never_go_below_zero(model):
    # A convex combination of limited values, and the inverse of an M-matrix; the
    # initial density is smooth enough for a weight θ in [0, 1].
    scheme = semi_lagrangian(
        model, GRID, limited=True, diffusion="backward_euler", compact=False
    )
    solution = solve(scheme, smooth_start(), (0.0, 5.0), 0.1)
    assert solution.theta.min() >= 0.0
    assert solution.theta.max() <= 1.0
    # Rounding of the tridiagonal solver relative to p ≤ 1.
    assert solution.minimum.min() >= -1e-16


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("name", STABLE)
def test_the_balanced_forms_are_stable_at_low_noise(name, noise):
    # The p-form of the characteristics blows up here, on the smaller grid the sooner;
    # for h the maximum principle of the equation holds up to the overshoot of the
    # interpolation.
    grid = PhaseSpaceGrid(5.0, (24, 24, 16) if name in SLOW else (32, 32, 24))
    p0 = initial.gaussian(grid, (1.0, 0.0), 0.5, np.pi / 2, 2.0)
    model = LayDownModel(QuadraticPotential(), noise)
    # Limiting every row at each step costs the most: 0.095 of the circulation.
    solution = solve(
        build(name, model, grid), p0, (0.0, 10.0), 0.125, circulation_tolerance=0.1
    )
    equilibrium = model.equilibrium(*grid.plane())[:, :, None]
    largest = (p0 / equilibrium).max()
    # 1.0 is the maximum principle, the rest the overshoot of a cell or two.
    assert np.abs(solution.final / equilibrium).max() <= 1.5 * largest


def quarter_turn(p):
    """p at (−ξ2, ξ1, α + π/2) from p at (ξ1, ξ2, α)."""
    return np.roll(np.rot90(p, 1, axes=(0, 1)), p.shape[2] // 4, axis=2)


def reflection(p):
    """p at (ξ1, −ξ2, −α) from p at (ξ1, ξ2, α)."""
    return p[:, ::-1, ::-1]


def test_a_quarter_turn_of_an_array_is_one_of_phase_space():
    grid = PhaseSpaceGrid(2.0, (6, 6, 8))
    f = grid.evaluate(lambda x, y, a: x + 10 * y + np.cos(a))
    # (ξ1, ξ2, α) = (y, −x, α − π/2) is where the turned function looks.
    turned = grid.evaluate(lambda x, y, a: y - 10 * x + np.cos(a - np.pi / 2))
    np.testing.assert_allclose(quarter_turn(f), turned, rtol=0, atol=1e-14)


@pytest.mark.parametrize("name", [name for name in SCHEMES if "positive" not in name])
def test_a_quarter_turn_of_the_start_turns_the_result(model, name):
    check_symmetry(build(name, model), smooth_start(), quarter_turn)


@pytest.mark.parametrize("balanced", [False, True])
def test_clamped_fluxes_know_the_axes_no_more_than_undershoots_do(model, balanced):
    # Fluxes are clamped direction by direction, so a quarter turn shows, but only by
    # what the clamp acts on: the negative values the scheme would have without it.
    plain = drift_kick(model, GRID, balanced=balanced)
    undershoot = -solve(plain, smooth_start(), (0.0, 1.0), 0.1).minimum.min()
    scheme = drift_kick(model, GRID, balanced=balanced, positive=True)
    check_symmetry(scheme, smooth_start(), quarter_turn, atol=undershoot)


@pytest.mark.parametrize("curve", [FixedBelt(), MovingBelt(0.2)], ids=repr)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_reflection_of_the_start_reflects_the_result(name, curve):
    # Also for an anisotropic potential and a belt, which share this symmetry.
    model = LayDownModel(QuadraticPotential(1.0, 0.8), 1.0, curve)
    check_symmetry(
        build(name, model), asymmetric_start(GRID, model.potential), reflection
    )


def check_symmetry(scheme, p0, symmetry, atol=0.0):
    span, ds = (0.0, 1.0), 0.1
    result = solve(scheme, p0, span, ds).final
    image = solve(scheme, np.ascontiguousarray(symmetry(p0)), span, ds).final
    # Rounding of 10 steps: cosines of mirrored angles differ in the last digit, and
    # e^{B} ≤ e^{36} multiplies nothing that is not multiplied by e^{−B} again.
    assert np.abs(symmetry(result) - image).max() <= 1e-13 * result.max() + atol


POTENTIALS = {
    "anisotropic": (QuadraticPotential(1.0, 0.7), 5.0),
    "linear": (LinearPotential(), 14.0),
    "r^1.5": (PowerPotential(1.5), 10.0),
    "r⁴/4": (PowerPotential(4.0), 2.8),
    "isotropic": (
        IsotropicPotential(
            lambda r: np.hypot(1, 2 * r), lambda r: 4 * r / np.hypot(1, 2 * r)
        ),
        8.0,
    ),
    "callable": (COSH, 6.0),
}
# The p-form of the characteristics is refused where forces of 60 in the corners turn
# the angle by radians within a step.
RUNS = [
    (name, potential)
    for name in SCHEMES
    for potential in POTENTIALS
    if (name, potential) != ("semi-Lagrangian p-form", "r⁴/4")
]


@pytest.mark.parametrize(("name", "potential"), RUNS)
def test_every_potential_runs_and_approaches_its_equilibrium(name, potential):
    potential, half_width = POTENTIALS[potential]
    grid = PhaseSpaceGrid(half_width, (24, 24, 16))
    model = LayDownModel(potential, 1.0)
    p0 = far_start(grid, potential)
    solution = solve(build(name, model, grid), p0, (0.0, 2.0), 0.1)
    assert solution.status == "finished"
    # H starts near 0.5 and loses half of it for all these potentials, to within the
    # excess of 0.01 to 0.04 that the p-forms keep on such coarse grids.
    excess = solution.relative_entropy - solution.entropy_floor
    assert excess[0] > 0.4
    assert excess[-1] < 0.75 * excess[0]


def far_start(grid, potential):
    """p0 ∝ e^{−B} h with a bounded h, far from constant."""

    def density(xi1, xi2, alpha):
        swirl = np.exp(-(xi1**2 + xi2**2) / 4.0)
        exponent = 2.0 * swirl * np.cos(alpha - 0.7) + np.tanh(xi1 - 0.3 * xi2)
        return np.exp(exponent - potential.value(xi1, xi2))

    return initial.from_function(grid, density)


STOPS = np.linspace(0.0, 2.0, 21)
CURVES = [
    MovingBelt(0.2),
    RotatingNozzle(0.1, 0.5, 1.0),
    OscillatingNozzle(0.1, 0.5, 1.0, 0.3),
    EllipticNozzle(0.1, 0.5, 0.3, 1.0),
    TabulatedCurve(STOPS, -0.1 * STOPS, 0.3 * np.sin(STOPS)),
]


@pytest.mark.parametrize("name", SCHEMES)
@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: type(curve).__name__)
def test_every_curve_runs_and_moves_the_mean_as_its_velocity_says(model, name, curve):
    # d E ξ/ds = E τ − γ′ for every potential: exact in law, and the mean direction is
    # recorded, so its integral is checked by the trapezoidal rule (ds²/12 = 8e-4) up to
    # the interpolation on this coarse grid, and ds/2 for the first order.
    moving = LayDownModel(model.potential, 1.0, curve)
    scheme = build(name, moving)
    solution = solve(scheme, smooth_start(), (0.0, 2.0), 0.1)
    moved1, moved2 = curve.displacement(0.0, 2.0)
    for mean, direction, moved in (
        (solution.mean_xi1, solution.mean_cos_alpha, moved1),
        (solution.mean_xi2, solution.mean_sin_alpha, moved2),
    ):
        path = np.trapezoid(direction, solution.s)
        allowed = 2e-2 if scheme.order == 2 else 5e-2
        assert mean[-1] - mean[0] == pytest.approx(path - moved, abs=allowed)


def test_a_stationary_belt_turns_the_mean_direction_to_minus_its_speed():
    # E cos α = −v, E sin α = 0 for any B: follows from d E ξ/ds = 0.
    speed = 0.2
    grid = PhaseSpaceGrid(6.0, (32, 32, 24))
    model = LayDownModel(QuadraticPotential(), 1.0, MovingBelt(speed))
    p0 = asymmetric_start(grid, model.potential)
    solution = solve(drift_kick(model, grid), p0, (0.0, 40.0), 0.1, record_every=100)
    # e^{−gap · 40} is 1e-6 (the gap is about 0.35); a stationary state of the scheme
    # has mean displacement zero per step, with angles at half steps: ds² = 1e-2 · 1e-2.
    assert solution.mean_cos_alpha[-1] == pytest.approx(-speed, abs=1e-3)
    assert solution.mean_sin_alpha[-1] == pytest.approx(0.0, abs=1e-5)
