"""The equations for py-pde: what is exact, orders of convergence, agreement."""

import pickle

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import (
    DecayingCirculation,
    Equilibrium,
    FreeStreaming,
    asymmetric_start,
)

from fpsolve import diagnostics
from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import FokkerPlanckPDE, HydrodynamicPDE, to_pde_field
from fpsolve.model.curves import MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, QuadraticPotential

BELT = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))


def run(equation, p0, grid, s, **options):
    """py-pde's classical Runge-Kutta method, in steps that are stable on the grid."""
    n_steps = int(np.ceil(s / equation.explicit_step(grid)))
    options = {"dt": s / n_steps, "solver": "runge-kutta", **options}
    field = to_pde_field(p0, grid)
    return equation.solve(field, s, backend="numpy", tracker=None, **options).data


def ornstein_uhlenbeck(grid, s, mean=(1.0, -0.5), variance=0.3, model=BELT):
    """The Gaussian that the hydrodynamic limit makes of a Gaussian, B quadratic.

    Component i: mean → A²v σ₁² (i = 1) or 0 and variance → σᵢ², with the rates
    ε/σᵢ² and 2ε/σᵢ² (Remark 3.7 of the paper).
    """
    sigmas = model.potential.sigma1, model.potential.sigma2
    targets = model.noise**2 * model.belt_speed * sigmas[0] ** 2, 0.0
    density = 1.0
    for xi, start, sigma, target in zip(
        grid.mesh(), mean, sigmas, targets, strict=True
    ):
        decay = np.exp(-s / (model.noise * sigma) ** 2)
        spread = sigma**2 + (variance - sigma**2) * decay**2
        away = xi - target - (start - target) * decay
        density = density * np.exp(-(away**2) / (2 * spread))
        density /= np.sqrt(2 * np.pi * spread)
    return density


class TestFullEquation:
    @pytest.mark.parametrize(
        "options",
        [
            {},
            {"solver": "euler"},
            {"adaptive": True, "tolerance": 1e-6},
            {"solver": "crank-nicolson", "maxerror": 1e-12},
            {"solver": "scipy", "method": "RK45", "dt": None},
            {"solver": "adams-bashforth"},
        ],
        ids=lambda options: " ".join(map(str, options.values())) or "runge-kutta",
    )
    def test_solvers_of_py_pde_keep_the_mass(self, options):
        grid = PhaseSpaceGrid(4.0, (10, 9, 8))
        model = LayDownModel(LinearPotential(), 0.7, RotatingNozzle(0.1, 0.3, 0.8))
        p0 = asymmetric_start(grid, model.potential)
        equation = FokkerPlanckPDE(model)
        p = run(equation, p0, grid, 0.5, **options)
        # 720 cells of sums and some 20 steps, each with a rounding of 1e-16.
        assert diagnostics.mass(p, grid) == pytest.approx(1.0, abs=1e-14)
        assert diagnostics.l1_distance(p, p0, grid) > 0.1

    @pytest.mark.parametrize("n", [8, 16, 32])
    @pytest.mark.parametrize(
        "potential",
        [QuadraticPotential(1.0, 0.8), LinearPotential()],
        ids=["quadratic", "linear"],
    )
    def test_the_equilibrium_is_stationary_on_every_grid(self, potential, n):
        grid = PhaseSpaceGrid(5.0, (n, n, n))
        model = LayDownModel(potential, 0.7)
        p = Equilibrium(model, grid).initial()
        rate = FokkerPlanckPDE(model).evolution_rate(to_pde_field(p, grid))
        # Fluxes of size p/Δ cancel: a rounding of 1e-16 times 1/Δ, n/10 here, a few
        # of them; by order two alone the rate would be 2e-2 at n = 32.
        assert diagnostics.l1_distance(rate.data, 0.0, grid) < 1e-15 * n

    def test_transport_is_antisymmetric_and_noise_dissipates(self, uneven_grid, rng):
        # In ∫ p q/p_S: exactly zero for A = 0, whatever p, and negative for A > 0.
        potential = QuadraticPotential(1.0, 0.8)
        p = rng.normal(size=uneven_grid.shape)
        field = to_pde_field(p, uneven_grid)
        weight = np.exp(-potential.value(*uneven_grid.plane()))[:, :, None]
        change = {}
        for noise in (0.0, 1.0):
            equation = FokkerPlanckPDE(LayDownModel(potential, noise))
            terms = p / weight * equation.evolution_rate(field).data
            change[noise] = terms.sum() / np.abs(terms).sum()
        # 336 terms that cancel, each with some roundings of 1e-16.
        assert abs(change[0.0]) < 1e-14
        assert change[1.0] < -0.1

    def test_converges_to_the_exact_circulation_with_order_two(self):
        def error_of(n):
            grid = PhaseSpaceGrid(5.0, (n, n, n))
            problem = DecayingCirculation(QuadraticPotential(), 1.0, grid)
            p = run(FokkerPlanckPDE(problem.model), problem.initial(), grid, 0.2)
            return diagnostics.l1_distance(p, problem.density(0.2), grid)

        assert_order(measure_order(error_of, 16), declared=2, ceiling=1.2e-3)

    def test_converges_to_our_solution_on_a_moving_belt_with_order_two(self):
        model = LayDownModel(QuadraticPotential(), 1.0, MovingBelt(0.2))

        def error_of(n):
            grid = PhaseSpaceGrid(5.0, (n, n, n))
            p0 = asymmetric_start(grid, model.potential)
            theirs = run(FokkerPlanckPDE(model), p0, grid, 0.2)
            # Interpolation of order eight and extrapolation in ds: its own error is
            # two orders of magnitude below the differences measured.
            ours = solve(drift_kick(model, grid), p0, (0.0, 0.2), 0.1, extrapolate=True)
            return diagnostics.l1_distance(theirs, ours.final, grid)

        assert_order(measure_order(error_of, 16), declared=2, ceiling=8e-4)

    def test_follows_a_rotating_nozzle_with_order_two(self):
        curve = RotatingNozzle(0.1, 0.5, 2.0)

        def error_of(n):
            problem = FreeStreaming(PhaseSpaceGrid(5.0, (n, n, 8)), 1.0, curve)
            grid = problem.grid
            p = run(FokkerPlanckPDE(problem.model), problem.initial(), grid, 1.0)
            return diagnostics.l1_distance(p, problem.density(1.0), grid)

        assert_order(measure_order(error_of, 24), declared=2, ceiling=8e-3)

    def test_the_declared_step_is_stable_and_four_times_it_is_not(self, model):
        grid = PhaseSpaceGrid(4.0, (12, 12, 12))
        equation = FokkerPlanckPDE(model)
        step = equation.explicit_step(grid)
        p0 = asymmetric_start(grid, model.potential)
        options = {"solver": "runge-kutta", "backend": "numpy", "tracker": None}
        field = to_pde_field(p0, grid)
        stable = equation.solve(field, 400 * step, dt=step, **options)
        assert np.abs(stable.data).max() < 2 * p0.max()
        with pytest.raises(FloatingPointError):
            equation.solve(field, 4000 * step, dt=4 * step, **options)

    def test_shows_the_equation_it_stands_for(self, model):
        assert FokkerPlanckPDE(model).expression == model.equation

    def test_survives_pickling(self, model, uneven_grid):
        equation = FokkerPlanckPDE(model)
        field = to_pde_field(
            asymmetric_start(uneven_grid, model.potential), uneven_grid
        )
        rate = equation.evolution_rate(field)
        again = pickle.loads(pickle.dumps(equation)).evolution_rate(field)
        np.testing.assert_array_equal(again.data, rate.data)

    def test_knows_whether_the_rate_depends_on_s(self, model):
        nozzle = LayDownModel(model.potential, 1.0, RotatingNozzle(0.1, 0.5, 2.0))
        assert FokkerPlanckPDE(nozzle).explicit_time_dependence
        assert not FokkerPlanckPDE(model).explicit_time_dependence

    def test_is_made_of_a_model(self):
        with pytest.raises(
            TypeError, match=r"`model` must be a LayDownModel, got 1.0;"
        ):
            FokkerPlanckPDE(1.0)

    def test_does_not_live_on_the_plane(self, model):
        grid = PlaneGrid(2.0, (4, 4))
        field = to_pde_field(np.ones(grid.shape), grid)
        with pytest.raises(
            ValueError, match=r"PhaseSpaceGrid for .* is for Hydrodynam"
        ):
            FokkerPlanckPDE(model).evolution_rate(field)


class TestHydrodynamicLimit:
    def test_the_mass_stays_in_a_closed_box_that_cuts_the_density(self):
        grid = PlaneGrid((1.5, 1.2), (13, 10))
        p0 = ornstein_uhlenbeck(grid, 0.0)
        p = run(HydrodynamicPDE(BELT), p0, grid, 2.0)
        # Sums over 130 cells at some 50 steps, rounded at 1e-16 each.
        assert p.sum() == pytest.approx(p0.sum(), rel=1e-14)
        # A fifth of the mass would have left through open walls.
        assert np.abs(p - p0).sum() > 0.2 * p0.sum()

    def test_the_equilibrium_is_stationary_to_second_order(self):
        def rate_of(n):
            grid = PlaneGrid(5.0, (n, n))
            xi1, xi2 = grid.mesh()
            exponent = BELT.noise**2 * BELT.belt_speed * xi1
            density = np.exp(exponent - BELT.potential.value(xi1, xi2))
            density /= density.sum() * grid.cell_area
            rate = HydrodynamicPDE(BELT).evolution_rate(to_pde_field(density, grid))
            return float(np.abs(rate.data).sum()) * grid.cell_area

        assert_order(measure_order(rate_of, 16), declared=2, ceiling=4.5e-3)

    def test_agrees_with_the_exact_gaussian_with_order_two(self):
        def error_of(n):
            grid = PlaneGrid(5.0, (n, n))
            p = run(HydrodynamicPDE(BELT), ornstein_uhlenbeck(grid, 0.0), grid, 1.0)
            exact = ornstein_uhlenbeck(grid, 1.0)
            return float(np.abs(p - exact).sum()) * grid.cell_area

        assert_order(measure_order(error_of, 16), declared=2, ceiling=6e-3)

    def test_the_declared_step_is_stable_and_four_times_it_is_not(self):
        grid = PlaneGrid(4.0, (16, 16))
        equation = HydrodynamicPDE(BELT)
        step = equation.explicit_step(grid)
        field = to_pde_field(ornstein_uhlenbeck(grid, 0.0), grid)
        options = {"solver": "runge-kutta", "backend": "numpy", "tracker": None}
        stable = equation.solve(field, 400 * step, dt=step, **options)
        assert np.abs(stable.data).max() < field.data.max()
        with pytest.raises(FloatingPointError):
            equation.solve(field, 4000 * step, dt=4 * step, **options)

    def test_shows_the_equation_it_stands_for(self):
        expression = HydrodynamicPDE(BELT).expression
        assert expression.startswith("∂ₛ𝒫 = ∇·(0.25 ∇𝒫 + (0.25 ∇B - 0.1 e₁) 𝒫), B = ")

    def test_needs_noise(self):
        with pytest.raises(ValueError, match=r"`noise` must be positive for the limit"):
            HydrodynamicPDE(LayDownModel(QuadraticPotential(), 0.0))

    def test_needs_a_belt(self):
        curve = RotatingNozzle(0.1, 0.5, 2.0)
        with pytest.raises(
            ValueError, match=r"`curve` must be a fixed or a moving bel"
        ):
            HydrodynamicPDE(LayDownModel(QuadraticPotential(), 1.0, curve))

    def test_does_not_live_in_phase_space(self, uneven_grid):
        field = to_pde_field(np.ones(uneven_grid.shape), uneven_grid)
        with pytest.raises(
            ValueError, match=r"PlaneGrid for this .* is for FokkerPlan"
        ):
            HydrodynamicPDE(BELT).evolution_rate(field)
