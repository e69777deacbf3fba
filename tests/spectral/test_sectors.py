"""Sectors of the angular index: operator, starts, values, bounds and solutions."""

import math

import numpy as np
import pytest
from scipy.special import ive, jv

import fpsolve as fp
from fpsolve._kernels import sector_evolution, sector_values, sectors
from fpsolve.errors import ToleranceError
from fpsolve.paths import GaussianLaw
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.evolution import quadrature, rings, sector_transient
from fpsolve.spectral.evolution.projection import DensityStart, GaussianStart
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion
from fpsolve.spectral.evolution.sector_start import of_density, of_gaussian, turned

# Without any symmetry, and expressible by few coefficients.
LAW = GaussianLaw((0.5, -0.3), ((0.7, 0.1), (0.1, 0.6)), 0.8, 1.0)
MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
ROOTS = np.sqrt(np.arange(200.0))


def equation(noise, sigma=1.0):
    return sectors.Equation(1 / (math.sqrt(2) * sigma), noise**2 / 2, ROOTS)


def scattered(counts, seed=0):
    """A sector with every coefficient different."""
    counts = np.asarray(counts)
    c = np.zeros((2, counts.size, counts.max() + 4))
    rng = np.random.default_rng(seed)
    for row, n in enumerate(counts):
        c[:, row, 1 : 1 + n] = rng.standard_normal((2, n))
    return c, counts


COUNTS = [0, 4, 8, 12, 8, 8, 4, 0]
ODD = [0, 4, 8, 12, 8, 8, 4, 4, 0]


@pytest.mark.parametrize("index", [0, 2, 5])
def test_the_operator_is_the_transpose_of_the_generators_matrix(index):
    # `HermiteDiscretisation` shares nothing with the kernel but the basis.
    noise, sigma = 1.1, 0.8
    c, counts = scattered(ODD)
    out = np.zeros_like(c)
    alone = 1.0, 0.0, 0.0
    sectors.apply_sector(
        c, counts, index, equation(noise, sigma), alone, out, (0.0, 0.0), out
    )
    size = Truncation(40, 12)
    basis = HermiteDiscretisation(sigma, noise)
    sector = Sector(index) if index else Sector(0)
    states = basis.states(sector, size)
    matrix = basis.matrix(sector, *size).toarray()
    place, vector = {}, np.zeros(matrix.shape[0])
    for row in range(1, counts.size - 1):
        k = row - 1 - (counts.size - 3) // 2
        for m in range(counts[row]):
            found = np.flatnonzero(
                (states.k == k) & (np.minimum(states.m, states.n) == m)
            )
            place[row, m] = found[0]
            vector[found[0]] = c[0, row, m + 1]
    image = matrix.T @ vector
    for (row, m), where in place.items():
        # Sums of five terms of size 30.
        assert out[0, row, m + 1] == pytest.approx(image[where], abs=1e-12)


def test_compiled_kernels_equal_their_source():
    c, counts = scattered(ODD)
    given = equation(1.3)
    compiled, source, total = (np.ones_like(c) for _ in range(3))
    arguments = c, counts, 3, given, (0.5, 0.2, -1.0)
    sectors.apply_sector(*arguments, compiled, (0.3, 0.7), total)
    again = np.ones_like(c)
    sectors.apply_sector.py_func(*arguments, source, (0.3, 0.7), again)
    np.testing.assert_allclose(compiled, source, rtol=0, atol=1e-13)
    np.testing.assert_allclose(total, again, rtol=0, atol=1e-13)
    for name in ("flux", "half_axes"):
        kernel = getattr(sectors, name)
        given_to = (c, counts, 3, given) if name == "flux" else (counts, 3, given)
        np.testing.assert_allclose(
            kernel(*given_to), kernel.py_func(*given_to), rtol=1e-13
        )
    allowance = sector_evolution.Allowance(1.0, 0.02, 1e6, 1e9)
    run = (c, counts, 3, given, 0.02, allowance)
    for one, other in zip(
        sector_evolution.evolve_sector(*run),
        sector_evolution.evolve_sector.py_func(*run), strict=True,
    ):  # fmt: skip
        np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-12)
    moved, n = sectors.advance_sector.py_func(c, counts, 3, given, 0.05, 1e-12)
    assert n > 4
    # Another order of truncation only.
    np.testing.assert_allclose(
        moved, sectors.advance_sector(c, counts, 3, given, 0.05, 1e-12)[0], atol=1e-11
    )


def test_a_series_is_the_exponential_of_the_matrix():
    from scipy.linalg import expm

    c, counts = scattered(ODD)
    given, inside = equation(1.3), []
    for row, n in enumerate(counts):
        inside += [(row, m + 1) for m in range(n)]
    matrix = np.zeros((len(inside), len(inside)))
    for column, where in enumerate(inside):
        unit, image = np.zeros_like(c), np.zeros_like(c)
        unit[(0, *where)] = 1.0
        sectors.apply_sector(
            unit, counts, 2, given, (1.0, 0.0, 0.0), image, (0.0, 0.0), image
        )
        matrix[:, column] = [image[(0, *one)] for one in inside]
    # Statement of the module: the box holds the numerical range.
    real, imaginary = sectors.half_axes(counts, 2, given)
    skew = 0.5 * (matrix - matrix.T)
    assert np.linalg.norm(skew, 2) <= imaginary <= 1.4 * np.linalg.norm(skew, 2)
    assert np.linalg.eigvalsh(0.5 * (matrix + matrix.T)).min() >= -2 * real - 1e-12
    for ds in (0.01, 0.3):
        moved, _ = sectors.advance_sector(c, counts, 2, given, ds, 1e-13)
        vector = expm(ds * matrix) @ [c[(0, *one)] for one in inside]
        found = [moved[(0, *one)] for one in inside]
        np.testing.assert_allclose(found, vector, rtol=0, atol=1e-11)


@pytest.mark.parametrize("argument", [1e-3, 0.7, 12.0, 90.0])
def test_coefficients_of_the_series_are_bessel_functions(argument):
    n = np.arange(30)
    twice = np.where(n == 0, 1.0, 2.0)
    for sign, values in ((-1.0, jv(n, argument)), (1.0, ive(n, argument))):
        shift = 0.0 if sign < 0 else -argument
        found = sectors.chebyshev_coefficients(shift, argument, sign, 0.0)
        np.testing.assert_allclose(found[:30], twice * values, rtol=1e-11, atol=1e-15)
        source = sectors.chebyshev_coefficients.py_func(shift, argument, sign, 0.0)
        np.testing.assert_allclose(found, source, rtol=1e-12, atol=1e-300)


def test_a_gaussian_has_the_same_coefficients_in_both_bases():
    start = GaussianStart(LAW, MODEL.potential)
    found, rest = of_gaussian(start, 1e-13)
    assert rest < 1e-12
    circles = turned(start.expansion(40, 12))
    compared = 0
    for index, counts in enumerate(found.counts):
        harmonics = (counts.size - 3) // 2
        for k in range(0, min(harmonics, 12) + 1):
            angular = index - k
            for m in range((40 - abs(angular)) // 2 + 1):
                a, b = m + max(angular, 0), m + max(-angular, 0)
                expected = circles[a, b, k]
                assert abs(found.at(index, k, m) - expected) < 1e-13
                compared += abs(expected) > 1e-6
    assert compared > 500


def test_a_density_on_a_grid_has_the_coefficients_of_its_law():
    grid = fp.PhaseSpaceGrid(7.0, (56, 56, 32))
    p0 = fp.initial.gaussian(grid, LAW.mean, LAW.variance, LAW.angle, 1.0)
    found, _ = of_density(DensityStart(grid, p0, MODEL.potential, 1e-7), 1e-9)
    exact, _ = of_gaussian(GaussianStart(LAW, MODEL.potential), 1e-13)
    for index, k, m in ((0, 0, 0), (0, 3, 1), (0, -3, 1), (2, -1, 0), (1, 2, 3)):
        # The box cuts p0 e^{B/2} off at 1e-9.
        assert abs(found.at(index, k, m) - exact.at(index, k, m)) < 1e-8


def test_values_on_a_grid_are_those_of_the_products():
    start = GaussianStart(LAW, MODEL.potential)
    found, _ = of_gaussian(start, 1e-12)
    # A box off centre and angles that fold the harmonics.
    grid = fp.PhaseSpaceGrid((3.0, 4.0), (10, 12, 6))
    exact = quadrature.density_on(start.expansion(60, 20), grid, MODEL.potential)
    p = rings.density_on(found, grid, 1.0)
    np.testing.assert_allclose(p, exact, rtol=0, atol=1e-12)


def test_the_entropy_on_rings_is_the_closed_form_with_an_error_that_covers():
    start = GaussianStart(LAW, MODEL.potential)
    found, _ = of_gaussian(start, 1e-13)
    for tolerance in (1e-3, 1e-6, 1e-10):
        entropy = rings.relative_entropy(found, tolerance, 1e-13)
        away = abs(entropy.value - start.relative_entropy)
        # 1e-12 of the truncation, as ln h is of size ten.
        assert away <= entropy.doubt + 1e-12
        assert entropy.doubt <= 3 * tolerance
    # ‖ln h‖ from sums over a grid: p_S decays by e^{−32} to its edges.
    grid = fp.PhaseSpaceGrid(8.0, (64, 64, 32))
    xi1, xi2, alpha = grid.mesh()
    away1, away2 = xi1 - 0.5, xi2 + 0.3
    inverse = np.linalg.inv(LAW.variance)
    exponent = (
        inverse[0, 0] * away1**2 + 2 * inverse[0, 1] * away1 * away2
        + inverse[1, 1] * away2**2
    )  # fmt: skip
    logarithm = (
        -0.5 * exponent - 0.5 * math.log(np.linalg.det(LAW.variance))
        + 0.5 * (xi1**2 + xi2**2) + np.cos(alpha - 0.8) - math.log(ive(0, 1.0)) - 1.0
    )  # fmt: skip
    weight = np.exp(-0.5 * (xi1**2 + xi2**2)) / (4 * math.pi**2) * grid.cell_volume
    norm = math.sqrt(float((logarithm**2 * weight).sum()))
    squares = entropy.norms**2
    whole = squares[0] + 2 * squares[1:].sum() + entropy.rest**2
    assert math.sqrt(whole) == pytest.approx(norm, rel=1e-6)


def test_what_an_error_of_h_does_to_the_entropy_is_bounded():
    # h = 1 + a cos φ beside 1 + (a + e) cos φ: H = ∫ h ln h, and all of it in M = ±1.
    for a, e in ((0.3, 1e-3), (0.9, 1e-4), (1.0, 1e-5)):
        phi = 2 * np.pi * (np.arange(20000) + 0.5) / 20000
        h, other = 1 + a * np.cos(phi), np.maximum(1 + (a + e) * np.cos(phi), 1e-300)
        error = e / math.sqrt(2)
        logarithm = np.log(np.maximum(h, error))
        norms = np.array([
            abs(logarithm.mean()), abs((logarithm * np.exp(1j * phi)).mean())
        ])  # fmt: skip
        threshold = math.sqrt(error)
        empty = float((h <= threshold).mean())
        entropy = rings.Entropy(0.0, 0.0, norms, 0.0, threshold, empty)
        moved = abs((other * np.log(other) - h * np.log(h)).mean())
        # ±1 share the norm of the error.
        found = entropy.error(np.array([0.0, error / math.sqrt(2)]), 0.0)
        assert moved <= found
        # First order, but for what is below the threshold.
        assert found <= 1.6 * moved


def test_kernels_of_values_equal_their_source():
    c, counts = scattered(ODD)
    functions = rings.circular_functions(10, 12, np.array([0.5, 1.0, 2.0, 3.0]))
    one, other = (np.zeros((2, counts.size, 4)) for _ in range(2))
    sector_values.sums_on_rings(c, counts, 2, functions, one)
    sector_values.sums_on_rings.py_func(c, counts, 2, functions, other)
    np.testing.assert_allclose(one, other, atol=1e-14)
    waves = np.random.default_rng(1).standard_normal((2, 3, 5)) + 0.5j
    ring, turn = np.array([0, 1, 1]), np.exp(1j * np.array([0.1, 2.0, 3.0]))
    found, again = (np.empty((3, 5), complex) for _ in range(2))
    sector_values.sums_at_points(waves, ring, turn, found)
    sector_values.sums_at_points.py_func(waves, ring, turn, again)
    np.testing.assert_allclose(found, again, atol=1e-14)
    excess = np.array([-2.0, -1.0, -0.5, -1e-3, 0.0, 1e-9, 5e-3, 3.0])
    out, source = np.empty(8), np.empty(8)
    logs, same = excess.copy(), excess.copy()
    sector_values.entropy_integrand(logs, 1e-5, out)
    sector_values.entropy_integrand.py_func(same, 1e-5, source)
    np.testing.assert_allclose(out, source, rtol=1e-14, atol=1e-30)
    np.testing.assert_allclose(logs, same, rtol=1e-14, atol=1e-16)
    u = np.maximum(excess, -1.0)
    exact = np.where(u > -1, (1 + u) * np.log1p(np.maximum(u, -0.9)) - u, 1.0)
    np.testing.assert_allclose(out, exact, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(logs, np.log(np.maximum(1 + u, 1e-5)), atol=1e-14)


def test_a_rule_of_n_nodes_integrates_polynomials_of_degree_n():
    for n in (4, 8, 16):
        x, weights = rings.clenshaw_curtis(n)
        for power in range(n + 1):
            exact = 2.0 / (power + 1) if power % 2 == 0 else 0.0
            assert weights @ x**power == pytest.approx(exact, abs=1e-14)


def differences(one, other):
    """Norm of what two sectors differ by."""
    counts = np.zeros(max(one[1].size, other[1].size), np.int64)
    counts[1:-1] = max(one[1].max(), other[1].max())
    inside = [sectors.within(*each, counts) for each in (one, other)]
    return float(np.linalg.norm(inside[0] - inside[1]))


@pytest.mark.parametrize("noise", [0.3, 1.0, 4.0])
def test_the_error_of_a_sector_covers_what_it_lost(noise):
    found, _ = of_gaussian(GaussianStart(LAW, MODEL.potential), 1e-14)
    given = equation(noise)._replace(roots=np.sqrt(np.arange(2000.0)))
    for index in (0, 3):
        start = found.values[index], found.counts[index]
        exact = None
        for norm in (1e-12, 1e-9, 1e-6, 1e-3):
            allowance = sector_evolution.Allowance(norm, 1.0, 1e7, 1e10)
            c, counts, error, _, ended = sector_evolution.evolve_sector(
                *start, index, given, 1.0, allowance
            )
            assert ended == sector_evolution.DONE
            assert error <= norm
            exact = exact or (c, counts)
            # 1e-12 of the reference and of rounding.
            assert differences((c, counts), exact) <= error + 2e-12


@pytest.mark.parametrize("noise", [1.5, 1.75, 2.0])
def test_series_have_enough_terms_where_the_box_is_as_high_as_wide(noise):
    # There polynomials grow with every term, by the half axes over the focus.
    found, _ = of_gaussian(GaussianStart(LAW, MODEL.potential), 1e-14)
    given = equation(noise)._replace(roots=np.sqrt(np.arange(2000.0)))
    for index in (0, 3):
        for norm in (1e-6, 1e-9, 1e-12):
            allowance = sector_evolution.Allowance(norm, 3.0, 1e7, 1e10)
            start = found.values[index], found.counts[index]
            run = sector_evolution.evolve_sector(*start, index, given, 3.0, allowance)
            assert run[-1] == sector_evolution.DONE


def test_sectors_give_what_products_give(monkeypatch):
    # The other path shares neither basis, kernel, quadrature nor error estimate.
    stops = 0.0, 0.4
    found = fp.spectral_solve(MODEL, LAW, stops, tolerance=1e-11)
    assert isinstance(found._expansions[0], SectorExpansion)
    monkeypatch.setattr(sector_transient, "applies", lambda model: False)
    other = fp.spectral_solve(MODEL, LAW, stops, tolerance=1e-11)
    assert not isinstance(other._expansions[0], SectorExpansion)
    grid = fp.PhaseSpaceGrid(5.0, (12, 12, 8))
    for name, values in found.series.items():
        np.testing.assert_allclose(
            values, other.series[name], rtol=0, atol=1e-11, err_msg=name
        )
    for s in stops:
        np.testing.assert_allclose(
            found.density(s, grid), other.density(s, grid), rtol=0, atol=1e-11
        )


@pytest.mark.parametrize("noise", [0.7, 4.0])
def test_bounds_hold_and_are_within_the_tolerance(noise):
    model = fp.LayDownModel(fp.QuadraticPotential(0.9, 0.9), noise)
    stops = (0.0, 0.1, 0.4)
    sharp = fp.spectral_solve(model, LAW, stops, tolerance=1e-8)
    for tolerance in (1e-2, 1e-4, 1e-6):
        found = fp.spectral_solve(model, LAW, stops, tolerance=tolerance)
        for name, errors in found.errors.items():
            size = np.maximum(1.0, np.abs(found.series[name]))
            assert np.all(errors <= tolerance * size), name
            away = np.abs(found.series[name] - sharp.series[name])
            assert np.all(away <= errors + sharp.errors[name]), name


def test_what_is_told_of_the_entropy_is_not_far_from_its_error():
    law = GaussianLaw((1.5, 0.0), 0.25, math.pi / 2, 4.0)
    sharp = fp.spectral_solve(MODEL, law, (0.2, 1.0, 5.0), tolerance=1e-9)
    for tolerance in (1e-5, 1e-6):
        found = fp.spectral_solve(MODEL, law, (0.2, 1.0, 5.0), tolerance=tolerance)
        away = np.abs(found.relative_entropy - sharp.relative_entropy)
        told = found.errors["relative_entropy"]
        assert np.all(away <= told)
        # Bounds alone are 270 to 1000 times the error.
        assert np.all(told <= 200 * away)


def test_the_mass_is_one_to_rounding():
    for noise in (0.9, 8.0):
        model = fp.LayDownModel(fp.QuadraticPotential(), noise)
        found = fp.spectral_solve(model, LAW, (1.0, 9.0), tolerance=1e-3)
        assert np.abs(found.mass - 1.0).max() < 1e-13
        assert np.all(found.errors["mass"] < 2e-13)


def test_much_and_little_noise_end_within_the_work():
    for noise, s in ((1e5, 0.3), (1e59, 0.3), (0.01, 3.0)):
        model = fp.LayDownModel(fp.QuadraticPotential(), noise)
        with pytest.raises(ToleranceError, match=r"takes work of .* or more, where"):
            fp.spectral_solve(model, LAW, s, tolerance=1e-3, work_limit=1e7)


def test_counts_beyond_the_roots_or_the_memory_end_a_sector():
    c, counts = scattered(ODD)
    for roots, largest in ((16, 1e6), (200, 10.0)):
        few = equation(1.0)._replace(roots=np.sqrt(np.arange(float(roots))))
        allowance = sector_evolution.Allowance(1.0, 1.0, largest, 1e9)
        ended = sector_evolution.evolve_sector(c, counts, 3, few, 1.0, allowance)
        assert ended[-1] == sector_evolution.TOO_LARGE
        assert not sector_evolution.fits.py_func(counts, 3, few, largest)


def test_a_needle_is_left_to_the_products():
    start = GaussianStart(GaussianLaw((1.0, 0.0), 0.01, 0.0, 1.0), MODEL.potential)
    assert of_gaussian(start, 1e-6) is None
    blunt = GaussianStart(GaussianLaw((1.0, 0.0), 0.5, 0.0, 1e6), MODEL.potential)
    assert of_gaussian(blunt, 1e-6) is None
