"""Decay rates of the limit equation against the exact ones."""

import numpy as np
import pytest
from orders import assert_order, measure_order

from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import LinearPotential, PowerPotential, QuadraticPotential
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit, OrnsteinUhlenbeckLimit
from fpsolve.reduced.hydrodynamic.spectrum import symmetrised

MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))
LIMIT = HydrodynamicLimit(MODEL)
EXACT = OrnsteinUhlenbeckLimit(MODEL)
GRID = PlaneGrid((6.0, 5.0), (48, 48))


def test_rates_of_the_quadratic_potential_are_sums_with_order_two():
    exact = EXACT.eigenvalues(6)

    def errors(n):
        grid = PlaneGrid((6.5, 5.0), (n, n))
        return np.abs(LIMIT.spectrum(grid, 6).eigenvalues - exact)

    for k in range(1, 6):
        # Modes of higher degree oscillate more: the coarsest grid is fine enough for
        # the band of 0.3. Ceiling: twice the error of the fifth mode.
        assert_order(measure_order(lambda n, k=k: errors(n)[k], 32, 2), 2, 4e-3)


def test_the_error_estimate_is_the_error_to_leading_order():
    spectrum = LIMIT.spectrum(GRID, 6)
    true = np.abs(spectrum.eigenvalues - EXACT.eigenvalues(6))
    # The next term of the expansion is of order h² = 0.06 relative.
    np.testing.assert_allclose(spectrum.errors[1:], true[1:], rtol=0.15)
    assert spectrum.gap == spectrum.eigenvalues[1]
    assert spectrum.gap_error == spectrum.errors[1]
    assert spectrum.eigenvalues[0] == 0.0


def test_the_gap_is_the_exact_one_without_a_grid_and_near_it_on_one():
    assert LIMIT.gap() == pytest.approx(0.25, rel=1e-15)
    # Order 2 with h = 0.25.
    assert LIMIT.gap(GRID) == pytest.approx(0.25, rel=0.02)
    slow = LayDownModel(QuadraticPotential(1.0, 2.0), 2.0)
    assert HydrodynamicLimit(slow).gap() == pytest.approx(0.25 / 4, rel=1e-15)


def test_a_belt_moves_the_density_but_not_the_rates_of_a_quadratic_potential():
    at_rest = HydrodynamicLimit(LayDownModel(QuadraticPotential(1.0, 0.8), 2.0))
    moved = 0.4
    cells = (64, 48)
    # A box shifted with the mean, by a whole number of cells of 0.2.
    grid = PlaneGrid((6.4, 4.8), cells)
    values = at_rest.spectrum(grid, 5).eigenvalues
    shifted = LIMIT.spectrum(grid, 5).eigenvalues
    assert moved == pytest.approx(float(EXACT.stationary_mean[0]))
    # The walls are seven standard deviations away: e^{-18} times the size of a mode.
    np.testing.assert_allclose(shifted, values, atol=1e-6)


def test_the_linear_potential_has_the_gap_two_ninths_below_its_continuum():
    # ε = 1/4 and slope 1: 2/9 ε twice, from the sectors ±1, and the continuum from ε/4.
    limit = HydrodynamicLimit(LayDownModel(LinearPotential(), 2.0))
    exact = 2 / 9 / 4
    wide = limit.spectrum(PlaneGrid(30.0, (120, 120)), 6)
    # In the linear potential the modes decay as e^{−r/3}: the box changes them by
    # e^{−2L/3}; the kink leaves order two in h = 0.5 with a constant of 1/100.
    assert wide.eigenvalues[1] == pytest.approx(exact, rel=0.02)
    assert wide.eigenvalues[2] == pytest.approx(wide.eigenvalues[1], rel=1e-9)
    values = []
    for half_width, n in ((12.0, 48), (24.0, 96), (48.0, 192)):
        values.append(limit.spectrum(PlaneGrid(half_width, (n, n)), 6).eigenvalues)
    # The isolated pair hardly notices the box; what the box discretises of the
    # continuum falls towards its lower end, which cells of 0.5 lower by 5 %.
    assert values[2][1] == pytest.approx(values[1][1], rel=1e-2)
    assert values[0][5] > values[1][5] > values[2][5] > 0.95 * 0.25 / 4
    assert values[1][5] - values[2][5] > 3 * abs(values[1][1] - values[2][1])


def test_the_gap_of_the_linear_potential_converges_to_two_ninths():
    limit = HydrodynamicLimit(LayDownModel(LinearPotential(), 1.0))

    def error(n):
        return abs(limit.spectrum(PlaneGrid(30.0, (n, n)), 2).gap - 2 / 9)

    # At the kink of B the order of the fluxes is still two, up to a logarithm. The
    # error changes sign on coarser grids, where it is not yet a power of h.
    coarse, fine = error(120), error(240)
    assert fine < coarse / 2.5
    assert fine < 1e-3


def test_the_symmetrised_matrix_is_symmetric_and_similar_to_the_generator():
    limit = HydrodynamicLimit(LayDownModel(PowerPotential(3.0), 1.0, MovingBelt(0.2)))
    grid = PlaneGrid(2.5, (9, 8))
    generator = limit.generator(grid)
    matrix = symmetrised(generator).toarray()
    np.testing.assert_array_equal(matrix, matrix.T)
    expected = np.sort(np.linalg.eigvals(-generator.toarray()).real)
    # Dense eigenvalues are exact to EPS times the largest, 60, times the condition of
    # the eigenvectors, the ratio of √π: 1e4.
    np.testing.assert_allclose(np.linalg.eigvalsh(matrix), expected, atol=1e-9)
    found = limit.spectrum(grid, 6).eigenvalues
    np.testing.assert_allclose(found, expected[:6], atol=1e-9)


def test_modes_are_orthonormal_and_decay_at_their_rates():
    spectrum = LIMIT.spectrum(GRID, 4)
    steady = LIMIT.steady_state(GRID).density
    np.testing.assert_allclose(spectrum.density_modes[0], steady, rtol=1e-10)
    modes, area = spectrum.density_modes, GRID.cell_area
    products = np.einsum("kij,lij,ij->kl", modes, modes, 1.0 / steady) * area
    np.testing.assert_allclose(products, np.eye(4), atol=1e-9)
    start = steady + 0.2 * modes[1]
    run = LIMIT.solve(
        start, (0.0, 2.0), 0.05, grid=GRID, extrapolate=True, method="sdirk2"
    )
    expected = steady + 0.2 * modes[1] * np.exp(-2.0 * spectrum.gap)
    # Extrapolated steps: an error of the order (gap ds)³.
    np.testing.assert_allclose(run.densities[-1], expected, atol=1e-7)


def test_eigenfunctions_of_the_quadratic_potential_are_hermite_polynomials():
    spectrum = LIMIT.spectrum(PlaneGrid((6.0, 5.0), (96, 96)), 2)
    xi1, _ = spectrum.grid.mesh()
    function = spectrum.eigenfunction(1)
    inside = np.abs(spectrum.grid.xi1) < 2.0
    middle = np.abs(spectrum.grid.xi2) < 2.0
    expected = np.broadcast_to(xi1 - EXACT.stationary_mean[0], (96, 96))
    sign = np.sign(function[70, 48])
    # (ξ1 − m)/σ1 has norm 1; order 2 with h = 0.125.
    np.testing.assert_allclose(
        sign * function[np.ix_(inside, middle)],
        expected[np.ix_(inside, middle)],
        atol=5e-3,
    )
    assert np.all(np.isfinite(function))


def test_a_spectrum_is_repeatable():
    first, second = (LIMIT.spectrum(GRID, 3) for _ in range(2))
    np.testing.assert_array_equal(first.density_modes, second.density_modes)


def test_numbers_that_a_grid_cannot_give_are_refused():
    with pytest.raises(ValueError, match="`n_eigenvalues` must be at least 2, got 1"):
        LIMIT.spectrum(GRID, 1)
    with pytest.raises(ValueError, match="`n_eigenvalues` must be below the number of"):
        LIMIT.spectrum(PlaneGrid(4.0, (6, 6)), 9)
    with pytest.raises(
        TypeError, match=r"`n_eigenvalues` must be an integer, got 2\.5"
    ):
        LIMIT.spectrum(GRID, 2.5)
