"""(A²/2)(J u')' = -λ S u: exact modes, orthogonality, residuals, errors."""

import numpy as np
import pytest
from energy_processes import NOISE, PROCESSES, spectrum_of
from orders import assert_order, measure_order

from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess
from fpsolve.reduced.energy import spectrum as module
from fpsolve.reduced.energy.elements import Elements, graded_faces
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.spectrum import spectrum

FAMILIES = ("even", "odd")
RATE = NOISE**2 / 2


@pytest.fixture(params=PROCESSES, ids=str)
def process(request):
    return PROCESSES[request.param]


def nodes_on_graded_elements(process, low=0.0):
    """Gauss points and weights from `low` to g_max, where S is steep at both ends."""
    faces = graded_faces(process.g_max - low, 18, 12) + low
    return Elements(faces, 12).quadrature()


def test_the_first_odd_mode_is_the_energy_itself(process):
    found = spectrum_of(process, "odd")
    # E G decays at A²/2 exactly.
    assert found.eigenvalues[0] == pytest.approx(RATE, rel=1e-12)
    g = process.g_max * np.linspace(-1.0, 1.0, 21)
    # Eigenvectors have half the digits that eigenvalues have, and a bit more.
    shape = found.eigenfunction(0, g) / found.eigenfunction(0, process.g_max)
    np.testing.assert_allclose(shape, g / process.g_max, atol=1e-10)


def test_the_first_even_mode_is_constant(process):
    found = spectrum_of(process, "even")
    assert found.eigenvalues[0] == 0.0
    assert found.errors[0] == 0.0
    g = process.g_max * np.linspace(-1.0, 1.0, 7)
    np.testing.assert_array_equal(found.eigenfunction(0, g), np.ones(7))


@pytest.mark.parametrize("family", FAMILIES)
def test_eigenfunctions_are_orthonormal_in_the_stationary_law(process, family):
    found = spectrum_of(process, family)
    g, weights = nodes_on_graded_elements(process)
    modes = np.array([found.eigenfunction(index, g) for index in range(4)])
    share = process.stationary_density(g) * weights
    # The quadrature is graded to the logarithm in S; the first element, 1e-10 of the
    # interval, has the rest.
    np.testing.assert_allclose((modes * share) @ modes.T, np.eye(4), atol=1e-8)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_flux_of_an_eigenfunction_balances_its_decay(process, family):
    # (A²/2) J u' = λ ∫ S u from g to g_max: the equation integrated once, with u' by
    # sixth-order differences.
    found = spectrum_of(process, family)
    for index, rate in enumerate(found.eigenvalues[:3]):
        for share in (0.15, 0.6):
            g = share * process.g_max
            h = 2e-3 * process.g_max
            ahead, back = (
                found.eigenfunction(index, g + side * h * np.arange(1, 4))
                for side in (1, -1)
            )
            slope = (ahead - back) @ np.array([3 / 4, -3 / 20, 1 / 60]) / h
            flux = RATE * float(process.action(g)) * slope
            x, weights = nodes_on_graded_elements(process, g)
            mass = weights @ (process.period(x) * found.eigenfunction(index, x))
            scale = rate * process._averages.total
            # Differences of u/h leave rounding of 1e-10/2e-3 of λ = 5.
            assert flux == pytest.approx(rate * mass, abs=1e-6 * scale + 1e-9)


@pytest.mark.parametrize("family", FAMILIES)
def test_finite_volumes_converge_to_the_eigenvalues_with_order_two(family):
    process = PROCESSES["quadratic"]
    exact = np.sort(
        np.concatenate([process.eigenvalues(3, "even"), process.eigenvalues(3, "odd")])
    )
    wanted = {"even": 2, "odd": 3}[family]

    def error(n):
        matrix = process.grid(n, signed=True).generator(NOISE).toarray()
        found = np.sort(-np.linalg.eigvals(matrix).real)
        return abs(found[wanted] / exact[wanted] - 1)

    # Ascending: 0, odd, even, odd, ... so 2 is the first even, 3 the second odd rate.
    assert_order(measure_order(error, 20, 3), declared=2, ceiling=6e-4)


def test_both_families_alternate(process):
    # Sturm-Liouville with Neumann and Dirichlet conditions at 0.
    even, odd = (spectrum_of(process, family).eigenvalues for family in FAMILIES)
    assert np.all(even < odd)
    assert np.all(odd[:-1] < even[1:])


def test_rates_scale_like_the_squared_noise():
    one, other = (EnergyProcess(QuadraticPotential(), noise) for noise in (0.2, 2.0))
    for family in FAMILIES:
        np.testing.assert_allclose(
            other.eigenvalues(4, family), 100 * one.eigenvalues(4, family), rtol=1e-14
        )


def test_rates_do_not_depend_on_the_unit_of_length():
    other = EnergyProcess(QuadraticPotential(50.0, 50.0), NOISE)
    for family in FAMILIES:
        # Rounding of ln 50 in every energy.
        np.testing.assert_allclose(
            other.eigenvalues(4, family),
            PROCESSES["quadratic"].eigenvalues(4, family),
            rtol=1e-11,
        )


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("degree", [5, 7, 9])
def test_the_error_estimate_is_honest(monkeypatch, family, degree):
    process = PROCESSES["flat"]
    exact = process.eigenvalues(5, family)
    monkeypatch.setattr(module, "_DEGREE", degree)
    monkeypatch.setattr(module, "_DEGREE_PER_EIGENVALUE", 0)
    coarse = process.spectrum(5, family)
    wrong = np.abs(coarse.eigenvalues - exact)
    assert np.all(wrong <= coarse.errors + 1e-12 * exact)
    # Low degrees are visibly wrong, so that the line above says something.
    assert wrong[-1] > 1e-12 * exact[-1] or degree > 7


def test_the_estimates_of_the_default_degree_are_close_to_rounding(process):
    for family in FAMILIES:
        found = spectrum_of(process, family)
        assert np.all(found.errors <= 1e-10 * RATE + 1e-10 * found.eigenvalues)


def test_more_eigenvalues_do_not_change_the_first(process):
    for family in FAMILIES:
        few, many = process.spectrum(2, family), spectrum_of(process, family)
        allowed = few.errors + many.errors[:2]
        assert np.all(np.abs(few.eigenvalues - many.eigenvalues[:2]) <= allowed)
        assert few.eigenvalues.shape == few.errors.shape == (2,)
    assert process.eigenvalues(1, "even").tolist() == [0.0]


def test_eigenfunctions_have_the_symmetry_of_their_family():
    process = PROCESSES["linear"]
    g = np.array([[0.05, 0.2], [0.3, 0.0]])
    for family, sign in zip(FAMILIES, (1.0, -1.0), strict=True):
        found = process.spectrum(2, family)
        values = found.eigenfunction(1, g)
        assert values.shape == g.shape
        np.testing.assert_array_equal(found.eigenfunction(1, -g), sign * values)
        assert float(found.eigenfunction(1, process.g_max)) > 0


def test_a_mode_of_index_k_has_k_zeros_inside(process):
    g = process.g_max * np.linspace(1e-3, 1.0, 2000)
    for family in FAMILIES:
        found = spectrum_of(process, family)
        for index in range(4):
            signs = np.sign(found.eigenfunction(index, g))
            assert np.count_nonzero(np.diff(signs)) == index


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((0,), ValueError, "`n` must be at least 1, got 0"),
        ((1.5,), TypeError, r"`n` must be an integer, got 1\.5"),
        ((2, "left"), ValueError, "`family` must be 'even' or 'odd', got 'left'"),
    ],
)
def test_wrong_arguments_are_named(arguments, error, message):
    with pytest.raises(error, match=message):
        PROCESSES["quadratic"].eigenvalues(*arguments)


def test_unknown_modes_and_energies_are_refused():
    found = PROCESSES["quadratic"].spectrum(2)
    for index in (2, -1):
        with pytest.raises(IndexError, match="`index` must be at least 0 and below 2"):
            found.eigenfunction(index, 0.1)
    with pytest.raises(ValueError, match=r"`g` must lie in \[-0\.606"):
        found.eigenfunction(0, 0.7)
    assert repr(found).startswith("EnergySpectrum(even: 0, 2.3163868")


def test_the_full_model_has_these_rates_at_little_noise():
    # Real eigenvalues over A² of the full generator, which averages nothing, in the
    # sectors that are functions of r and β only; the odd one is exact at any noise.
    # Measured difference of the even one at A = 0.4: 1.2e-3, of higher order in A.
    limit = EnergyProcess(QuadraticPotential(), 1.0)
    model, both = LayDownModel(QuadraticPotential(), 0.4), (Sector(0, 1), Sector(0, -1))
    full = spectrum(model, 6, sectors=both, tolerance=1e-6)
    rates = {
        str(sector): -value.real / 0.4**2
        for value, sector in zip(full.eigenvalues, full.sectors, strict=True)
        if abs(value.imag) < 1e-9
    }
    assert rates["M = 0 odd"] == pytest.approx(0.5, rel=1e-5)
    assert rates["M = 0 even"] == pytest.approx(limit.eigenvalues(2)[1], rel=3e-3)
