"""Order in ds of every composition, at every halving."""

import functools

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import AngularHeat, DecayingCirculation, asymmetric_start

from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.schemes.diffusion import ImplicitDiffusion
from fpsolve.density.solve import solve
from fpsolve.grids.diagnostics import l1_distance
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import FixedBelt, MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    IsotropicPotential,
    PowerPotential,
    QuadraticPotential,
)

# Boxes beyond which e^{−B} < 1e−10, and interpolation of order 14, so that what is
# left of the error comes from ds.
STIFFENING = IsotropicPotential(
    lambda r: 0.5 * r**2 + 0.125 * r**4, lambda r: r + 0.5 * r**3
)
CIRCULATIONS = {
    "quadratic, A = 1": DecayingCirculation(
        QuadraticPotential(), 1.0, PhaseSpaceGrid(7.0, (40, 40, 24))
    ),
    "quadratic, A = 0.3": DecayingCirculation(
        QuadraticPotential(), 0.3, PhaseSpaceGrid(7.0, (40, 40, 24))
    ),
    "r⁴/4, A = 1": DecayingCirculation(
        PowerPotential(4.0), 1.0, PhaseSpaceGrid(3.3, (40, 40, 24))
    ),
    "r²/2 + r⁴/8, A = 2": DecayingCirculation(
        STIFFENING, 2.0, PhaseSpaceGrid(3.4, (40, 40, 24))
    ),
}
# Errors at ds = 1/16 were 3.6e-4 to 1.2e-3 plain and 2.7e-5 to 1.8e-4 balanced.
VARIANTS = {
    "plain": ({}, 3e-3),
    "positive": ({"positive": True}, 3e-3),
    "balanced": ({"balanced": True}, 3e-4),
    "positive and balanced": ({"positive": True, "balanced": True}, 3e-4),
}
CURVES = [FixedBelt(), MovingBelt(0.2), RotatingNozzle(0.1, 0.5, 1.0)]


def error_against(exact, scheme, p0, s_end=1.0):
    """Error in L¹ at s_end as a function of the number of steps."""

    def error_of(n_steps):
        solution = solve(scheme, p0, (0.0, s_end), s_end / n_steps)
        return l1_distance(solution.final, exact, scheme.grid)

    return error_of


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", CIRCULATIONS)
def test_drift_kick_is_of_its_declared_order_on_the_exact_circulation(name, variant):
    problem, (options, ceiling) = CIRCULATIONS[name], VARIANTS[variant]
    scheme = drift_kick(problem.model, problem.grid, interpolation_order=14, **options)
    error_of = error_against(problem.density(1.0), scheme, problem.initial())
    assert_order(measure_order(error_of, first=4), scheme.order, ceiling)


@functools.cache
def generic_case(curve):
    """An asymmetric start, and its density at s = 1 extrapolated to 1e-6 in ds."""
    model = LayDownModel(QuadraticPotential(), 1.5, curve)
    grid = PhaseSpaceGrid(5.5, (48, 48, 32))
    p0 = asymmetric_start(grid, model.potential)
    scheme = drift_kick(model, grid, interpolation_order=16)
    # The estimate, 9e-5, belongs to the finer run; the extrapolated density is of
    # order 4 and better by two digits.
    reference = solve(scheme, p0, (0.0, 1.0), 1 / 16, extrapolate=True, record_every=16)
    return model, grid, p0, reference.final


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("curve", CURVES, ids=repr)
def test_drift_kick_is_of_its_declared_order_for_every_curve(curve, variant):
    model, grid, p0, exact = generic_case(curve)
    scheme = drift_kick(model, grid, interpolation_order=14, **VARIANTS[variant][0])
    # 2.9e-4 to 1.5e-3 measured.
    assert_order(
        measure_order(error_against(exact, scheme, p0), first=2), scheme.order, 3e-3
    )


# (splitting, diffusion): declared order, ceiling at ds = 1/8 (3.3e-4 to 7e-4 measured
# for the second order, 2.6e-3 to 1.0e-2 for the first).
PAIRINGS = {
    ("strang", "crank_nicolson"): (2, 1.5e-3),
    ("strang", "backward_euler"): (1, 2.5e-2),
    ("lie", "crank_nicolson"): (1, 2.5e-2),
    ("lie", "backward_euler"): (1, 2.5e-2),
}


@pytest.mark.parametrize("form", ["h", "p"])
@pytest.mark.parametrize("pairing", PAIRINGS, ids=" and ".join)
def test_semi_lagrangian_is_of_its_declared_order(pairing, form):
    check_semi_lagrangian(FixedBelt(), pairing, form)


@pytest.mark.parametrize("form", ["h", "p"])
@pytest.mark.parametrize("curve", CURVES[1:], ids=repr)
def test_semi_lagrangian_of_second_order_is_so_for_moving_curves(curve, form):
    check_semi_lagrangian(curve, ("strang", "crank_nicolson"), form)


def check_semi_lagrangian(curve, pairing, form):
    model, grid, p0, exact = generic_case(curve)
    splitting, diffusion = pairing
    scheme = semi_lagrangian(
        model, grid, form=form, splitting=splitting, diffusion=diffusion,
        interpolation_order=6,
    )  # fmt: skip
    order, ceiling = PAIRINGS[pairing]
    assert scheme.order == order
    # Larger steps than elsewhere: every step interpolates, which leaves 2e-5.
    error_of = error_against(exact, scheme, p0)
    assert_order(measure_order(error_of, first=2), order, ceiling)


@pytest.mark.parametrize(("diffusion", "order", "ceiling"), [
    ("crank_nicolson", 2, 1e-3), ("backward_euler", 1, 2e-2),
])  # fmt: skip
def test_on_the_circulation_advection_and_diffusion_commute(diffusion, order, ceiling):
    # G is constant along characteristics and an eigenfunction of ∂_αα, so the order
    # of the time stepping of the diffusion is all that a Lie splitting shows.
    problem = DecayingCirculation(
        QuadraticPotential(), 2.0, PhaseSpaceGrid(6.0, (48, 48, 32))
    )
    scheme = semi_lagrangian(
        problem.model, problem.grid, splitting="lie", diffusion=diffusion,
        interpolation_order=6,
    )  # fmt: skip
    error_of = error_against(problem.density(1.0), scheme, problem.initial())
    assert_order(measure_order(error_of, first=2), order, ceiling)


@pytest.mark.parametrize(("implicitness", "order", "ceiling"), [
    (0.5, 2, 2e-4), (1.0, 1, 2e-2),
])  # fmt: skip
def test_implicit_diffusion_alone_has_the_order_of_its_weight(
    implicitness, order, ceiling
):
    # 128 angles: the error in Δα, (mΔα)⁴/240 m²D, is 5e-7 for mode 2.
    problem = AngularHeat(1.0, PhaseSpaceGrid(3.0, (4, 4, 128)))
    diffuse = ImplicitDiffusion(problem.model, problem.grid, implicitness)

    def error_of(n_steps):
        p = problem.initial()
        for _ in range(n_steps):
            diffuse(p, 0.0, 1.0 / n_steps, p)
        return np.abs(p - problem.density(1.0)).max() / problem.initial().max()

    assert_order(measure_order(error_of, first=8), order, ceiling)


@pytest.mark.parametrize(("compact", "order", "ceiling"), [
    (True, 4, 5e-5), (False, 2, 1e-2),
])  # fmt: skip
def test_the_compact_laplacian_has_two_orders_more_in_the_angle(
    compact, order, ceiling
):
    # The rate of decay of mode 3 against m²D. A step of 1e-4 leaves (m²D ds)²/12 =
    # 1.7e-8 of Crank-Nicolson in it. The error is (mΔα)⁴/240 or (mΔα)²/12 relative.
    def error_of(n_alpha):
        problem = AngularHeat(1.0, PhaseSpaceGrid(3.0, (4, 4, n_alpha)), mode=3)
        diffuse = ImplicitDiffusion(problem.model, problem.grid, 0.5, compact)
        wave = np.cos(3 * problem.grid.alpha)
        p = np.ascontiguousarray(np.broadcast_to(wave, problem.grid.shape))
        out = np.empty_like(p)
        diffuse(p, 0.0, 1e-4, out)
        rate = -np.log(out[0, 0] @ wave / (wave @ wave)) / 1e-4
        return abs(rate / (9 * problem.model.diffusivity) - 1)

    assert_order(measure_order(error_of, first=24), order, ceiling)
