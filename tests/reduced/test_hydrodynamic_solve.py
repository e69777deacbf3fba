"""Runs of the limit equation: orders at every halving, series, the result."""

import numpy as np
import pytest
from orders import assert_order, measure_order

import fpsolve as fp
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit

MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))
EXACT = OrnsteinUhlenbeckLimit(MODEL, (1.0, -0.5), [[0.5, 0.2], [0.2, 0.4]])
GRID = PlaneGrid((5.0, 4.0), (40, 32))


def l1(p, q, grid):
    return float(np.abs(p - q).sum()) * grid.cell_area


def test_the_fluxes_are_of_order_two_at_every_halving():
    limit = HydrodynamicLimit(MODEL)

    def error(n):
        grid = PlaneGrid((6.0, 5.0), (n, n))
        run = limit.solve(
            EXACT.density, (0.0, 2.0), 0.1, grid=grid, extrapolate=True, method="sdirk2"
        )
        return l1(run.densities[-1], EXACT.density(*grid.mesh(), 2.0), grid)

    # Steps contribute 1e-5 after extrapolation. Ceiling: twice the 2.2e-3 measured.
    assert_order(measure_order(error, 16, 2), 2, 4.5e-3)


@pytest.mark.parametrize(
    ("method", "extrapolate", "order", "ceiling"),
    [
        ("backward_euler", False, 1, 1e-2),
        ("backward_euler", True, 2, 6e-5),
        ("sdirk2", False, 2, 5e-5),
        ("sdirk2", True, 3, 6e-8),
    ],
)
def test_the_steps_have_their_order_at_every_halving(
    method, extrapolate, order, ceiling
):
    limit = HydrodynamicLimit(MODEL)
    arguments = {"grid": GRID, "save_at": (2.0,)}
    best = limit.solve(
        EXACT.density,
        (0.0, 2.0),
        1 / 256,
        method="sdirk2",
        extrapolate=True,
        **arguments,
    )

    def error(n):
        run = limit.solve(
            EXACT.density,
            (0.0, 2.0),
            2.0 / n,
            method=method,
            extrapolate=extrapolate,
            **arguments,
        )
        return l1(run.densities[-1], best.densities[-1], GRID)

    # The reference has an error of 1e-10. Ceilings: twice what was measured.
    assert_order(measure_order(error, 8, 2), order, ceiling)


def test_estimates_of_extrapolated_runs_bound_the_errors():
    limit = HydrodynamicLimit(MODEL)
    arguments = {
        "grid": GRID,
        "extrapolate": True,
        "method": "sdirk2",
        "record_every": 4,
    }
    run = limit.solve(EXACT.density, (0.0, 2.0), 1 / 8, **arguments)
    best = limit.solve(EXACT.density, (0.0, 2.0), 1 / 128, **arguments)
    # Every series but s, the mass, which is kept, and the minimum, of the finer run.
    assert run.errors.keys() - {"density_l1"} == run.series.keys() - {
        "s", "mass", "minimum",
    }  # fmt: skip
    for name, estimate in run.errors.items():
        if name in run.series:
            last = abs(run.series[name][-1] - best.series[name][-1])
            assert 0 < last < estimate[-1], name
    distance = l1(run.densities[-1], best.densities[-1], GRID)
    assert 0 < distance < run.errors["density_l1"][-1]


@pytest.mark.parametrize("mass", [0.01, 100.0])
def test_estimates_of_means_are_those_of_a_density_of_any_mass(mass):
    limit = HydrodynamicLimit(MODEL)
    start = GRID.evaluate(EXACT.density)
    one, other = (
        limit.solve(P0, (0.0, 0.5), 1 / 4, grid=GRID, extrapolate=True)
        for P0 in (start, mass * start)
    )
    for name in ("mean_xi1", "mean_xi2", "variance_xi1", "covariance", "boundary_mass"):
        # Rounding of sums over the cells.
        np.testing.assert_allclose(
            other.errors[name], one.errors[name], rtol=1e-9, atol=1e-12
        )


def test_series_tend_to_the_exact_moments_and_entropy_with_order_two():
    limit = HydrodynamicLimit(MODEL)
    covariance = EXACT.covariance(2.0)
    expected = {
        "mean_xi1": EXACT.mean(2.0)[0],
        "mean_xi2": EXACT.mean(2.0)[1],
        "variance_xi1": covariance[0, 0],
        "variance_xi2": covariance[1, 1],
        "covariance": covariance[0, 1],
        "relative_entropy": EXACT.relative_entropy(2.0),
    }

    def errors(n):
        grid = PlaneGrid((6.0, 5.0), (n, n))
        run = limit.solve(
            EXACT.density, (0.0, 2.0), 0.1, grid=grid, extrapolate=True, method="sdirk2"
        )
        return {name: abs(run.series[name][-1] - expected[name]) for name in expected}

    coarse, fine = errors(32), errors(64)
    for name, value in expected.items():
        # Order 2 is a factor of four; the finest errors are below a percent of one.
        assert fine[name] < coarse[name] / 3.0, name
        assert fine[name] < 0.01 * max(abs(value), 0.1), name


def test_a_solution_shows_its_densities_and_series():
    solution = HydrodynamicLimit(MODEL).solve(
        EXACT.density,
        (0.0, 1.0),
        0.25,
        grid=GRID,
        save_at=(0.0, 0.5),
        record_every=2,
        method="sdirk2",
    )
    assert solution.densities.shape == (2, 40, 32)
    np.testing.assert_array_equal(solution.density(0.5), solution.densities[1])
    np.testing.assert_array_equal(solution.s, [0.0, 0.5, 1.0])
    assert "relative_entropy" in dir(solution)
    assert repr(solution).startswith("HydrodynamicSolution(to s = 1, sdirk2, ds = 0.25")
    assert solution.provenance["n_steps"] == 4
    with pytest.raises(
        ValueError, match=r"`s` must be one of the saved values 0, 0\.5, "
    ):
        solution.density(0.7)
    with pytest.raises(
        AttributeError, match="no attribute 'theta'; its series are s, "
    ):
        solution.theta  # noqa: B018


def test_the_entropy_decays_at_twice_the_gap():
    limit = HydrodynamicLimit(MODEL)
    solution = limit.solve(EXACT.density, (0.0, 40.0), 0.2, grid=GRID, method="sdirk2")
    rate = solution.entropy_rate((25.0, 40.0))
    # Order 2 in h = 0.25 for the gap of the grid.
    assert rate.rate == pytest.approx(2 * limit.gap(GRID), rel=1e-3)


def test_the_dataset_holds_densities_series_and_errors_with_labels():
    solution = HydrodynamicLimit(MODEL).solve(
        EXACT.density, (0.0, 1.0), 0.25, grid=GRID, extrapolate=True, method="sdirk2"
    )
    dataset = solution.to_xarray()
    assert dict(dataset["density"].sizes) == {"s": 1, "xi1": 40, "xi2": 32}
    np.testing.assert_array_equal(dataset["xi1"], GRID.xi1)
    np.testing.assert_array_equal(dataset["mean_xi1"], solution.mean_xi1)
    assert dict(dataset["density_l1_error"].sizes) == {"s": 1}
    assert dataset["relative_entropy_error"].sizes == {"s_step": 5}
    assert dataset["relative_entropy"].attrs["long_name"].endswith("H(𝒫|𝒫_S)")
    assert dataset.attrs["method"] == "sdirk2"


def test_a_phase_space_grid_stands_for_its_plane():
    limit = HydrodynamicLimit(MODEL)
    grid = PhaseSpaceGrid((5.0, 4.0), (40, 32, 8))
    solution = limit.solve(EXACT.density, (0.0, 0.5), 0.25, grid=grid)
    assert solution.grid == GRID
    assert limit.steady_state(grid).grid == GRID
    assert fp.HydrodynamicLimit is HydrodynamicLimit
    assert repr(limit).startswith("HydrodynamicLimit(LayDownModel(potential=")


def test_a_run_tells_how_far_it_is_and_begins_positive_by_default():
    told = []
    solution = HydrodynamicLimit(MODEL).solve(
        EXACT.density,
        (0.0, 1.0),
        0.5,
        grid=GRID,
        progress=lambda *what: told.append(what),
    )
    assert told == [(1, 2, 0.5), (2, 2, 1.0)]
    assert solution.method == "backward_euler"
