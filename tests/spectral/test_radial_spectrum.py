"""The generator in radial bases for isotropic potentials; its essential spectrum."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh_tridiagonal
from scipy.sparse import csc_array, diags_array, eye_array, kron
from scipy.sparse.linalg import ArpackNoConvergence, eigs

import fpsolve as fp
from fpsolve.spectral.bases.essential import asymptotic_slope, essential_threshold
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.radial import RadialDiscretisation
from fpsolve.spectral.bases.radial_basis import radial_basis, smooth_in_square
from fpsolve.spectral.bases.sectors import Sector, Truncation

EVEN, ODD, ONE, TWO = Sector(0, 1), Sector(0, -1), Sector(1), Sector(2)
LINEAR = fp.LinearPotential()
QUARTIC = fp.PowerPotential(4.0)
USERS_QUADRATIC = fp.IsotropicPotential(lambda r: 0.5 * r**2, lambda r: r)
# Smooth, with a slope that tends to 1.
HYPERBOLA = fp.IsotropicPotential(
    lambda r: np.hypot(1, r) - 1, lambda r: r / np.hypot(1, r)
)
MIXED = fp.IsotropicPotential(lambda r: r + r**2 / 4, lambda r: 1 + r / 2)
POTENTIALS = {
    "linear": LINEAR,
    "power 3/2": fp.PowerPotential(1.5),
    "cubic": fp.PowerPotential(3.0, scale=2.0),
    "quartic": QUARTIC,
    "hyperbola": HYPERBOLA,
    "mixed": MIXED,
}
every_potential = pytest.mark.parametrize(
    "potential", POTENTIALS.values(), ids=POTENTIALS.keys()
)


def nearest_eigenpairs(matrix, shift, n):
    """The eigenpairs nearest to a shift, nearest first."""
    start = np.random.default_rng(0).standard_normal(matrix.shape[0])
    if np.imag(shift):
        matrix = matrix.astype(complex)
    try:
        values, vectors = eigs(
            matrix, n, sigma=shift, v0=start, ncv=max(40, 4 * n), maxiter=20, tol=1e-14
        )
    except ArpackNoConvergence as error:
        # Clusters of the essential spectrum are too ill-conditioned to converge.
        values, vectors = error.eigenvalues, error.eigenvectors
    order = np.argsort(np.abs(values - shift))
    return values[order], vectors[:, order]


def eigenpairs(potential, noise, sector, truncation, n=3, shift=None):
    """The eigenvalues nearest to a shift, by default just right of 0."""
    matrix = RadialDiscretisation(potential, noise).matrix(sector, *truncation)
    shift = 0.05 * min(noise**2, noise**-2) if shift is None else shift
    return nearest_eigenpairs(matrix, shift, n)


@cache
def eigenvalue(potential, noise, sector, truncation=(24, 12)):
    """The slowest one other than 0, if it is real and nothing complex is nearer."""
    values, _ = eigenpairs(potential, noise, sector, truncation)
    return values[np.abs(values) > 1e-9][0]


@every_potential
def test_radial_functions_are_orthonormal(potential):
    basis = radial_basis(potential, 48)
    for angular in (0, 1, -3, 8):
        values, _ = basis.weighted(angular, 48)
        # Rounding of the three-term recurrence, about a hundred steps.
        assert np.abs(values @ values.T - np.eye(len(values))).max() < 1e-13


@every_potential
def test_radial_functions_are_the_same_away_from_the_rule(potential):
    basis = radial_basis(potential, 24)
    inner = basis.rule.r < 0.4 * basis.rule.r[-1]
    r, root = basis.rule.r[inner], np.exp(0.5 * basis.rule.log_weight[inner])
    for angular in (0, 1, 3):
        for exact, found in zip(
            basis.weighted(angular, 24), basis.evaluate(r, angular, 24), strict=True
        ):
            # The same recurrence, at arguments that differ by rounding.
            assert np.abs(exact[:, inner] - root * found).max() < 1e-9 * exact.max()


@every_potential
def test_the_two_couplings_are_negative_adjoints(potential):
    # From (k, l) to (k + 1, l - 1) as computed, and the way back from its own formula.
    basis, degree = radial_basis(potential, 24), 20
    r, slope = basis.rule.r, basis.rule.slope
    for k, angular in ((2, 1), (0, 3), (-3, 0), (5, -4)):
        up = basis.raising(k, angular, degree)
        source, derivative = basis.weighted(angular - 1, degree)
        image, _ = basis.weighted(angular, degree)
        tilt = (angular - 1) / r + (k + 1) * slope
        down = image @ (0.5 * (derivative - tilt * source)).T
        down = down[: up.shape[1], : up.shape[0]]
        # Rounding of quadratures whose terms are up to 1e4.
        assert np.abs(down + up.T).max() < 1e-11 * max(1.0, np.abs(up).max())


@every_potential
def test_the_weight_of_the_rule_is_the_density(potential):
    rule = radial_basis(potential, 24).rule
    weight = np.exp(rule.log_weight)
    assert abs(np.sum(weight) - 1) < 1e-13
    for power in (0, 2, 5):
        # By integration by parts, ∫ (r B' - m - 2) r^m r e^{-B} dr = 0.
        moment = weight * rule.r**power
        balance = moment @ (rule.slope * rule.r - power - 2)
        # Rounding of a sum over a thousand nodes.
        assert abs(balance) < 1e-11 * np.sum(moment)


def test_smoothness_at_the_origin_is_recognised():
    assert smooth_in_square(fp.PowerPotential(6.0))
    assert smooth_in_square(USERS_QUADRATIC)
    assert smooth_in_square(
        fp.IsotropicPotential(
            lambda r: r**4 - np.cos(r), lambda r: 4 * r**3 + np.sin(r)
        )
    )
    assert not smooth_in_square(MIXED)
    assert not smooth_in_square(fp.PowerPotential(2.5))
    assert not smooth_in_square(
        fp.IsotropicPotential(lambda r: r**3 / 3, lambda r: r**2)
    )


@pytest.mark.parametrize("potential", [fp.PowerPotential(2.0), USERS_QUADRATIC])
@pytest.mark.parametrize("sector", [EVEN, ODD, ONE, TWO])
def test_the_quadratic_potential_gives_the_matrix_of_hermite_functions(
    potential, sector
):
    radial = RadialDiscretisation(potential, 1.3).matrix(sector, 30, 20)
    hermite = HermiteDiscretisation(1.0, 1.3).matrix(sector, 30, 20)
    # The same basis up to signs; entries up to 50, by quadrature.
    assert np.abs(np.abs(radial) - np.abs(hermite)).max() < 1e-12


def test_a_users_quadratic_potential_gives_the_known_eigenvalues():
    for noise, sector, shift, exact in (
        (1.0, ONE, 0.64j, -0.37429405 + 0.64087459j),
        (3.0, ONE, 0.0, -0.11326199),
    ):
        size = (48, 24)
        found, _ = eigenpairs(USERS_QUADRATIC, noise, sector, size, 2, shift + 0.01)
        # The digits of the independent prototype.
        assert abs(found[0] - exact) < 1e-8
        matrix = HermiteDiscretisation(1.0, noise).matrix(sector, *size)
        hermite, _ = nearest_eigenpairs(matrix, shift + 0.01, 2)
        assert abs(found[0] - hermite[0]) < 1e-12


@every_potential
@pytest.mark.parametrize("noise", [0.5, 1.0, 2.5])
def test_half_the_noise_squared_is_an_eigenvalue_of_every_potential(potential, noise):
    exact = -0.5 * noise**2
    # Off it, so that the matrix may be factored.
    shift = 0.99 * exact
    values, vectors = eigenpairs(potential, noise, ODD, (32, 16), 1, shift)
    # Truncation of functions that are not polynomials: G = e^{-B} (...).
    assert abs(values[0] - exact) < 1e-9
    discretisation = RadialDiscretisation(potential, noise)
    size = Truncation(32, 16)
    residual = discretisation.residual(vectors[:, 0], values[0], ODD, size)
    # e^{-B} by polynomials of degree 32 in L²(e^{-B}); its square bounds the error.
    assert residual < 1e-4
    grid = fp.PhaseSpaceGrid(half_width=2.0, shape=(8, 8, 12))
    found = discretisation.values(vectors[:, 0], ODD, size, grid)

    def g(xi1, xi2, alpha):
        away = xi1 * np.sin(alpha) - xi2 * np.cos(alpha)
        return np.exp(-potential.value(xi1, xi2)) * away

    # In L²(μ): polynomials are free to go wrong where e^{-B} is small.
    weight = np.exp(-0.5 * potential.value(*grid.plane()))[:, :, None]
    exact, found = weight * grid.evaluate(g), weight * found
    factor = np.vdot(exact, found) / np.vdot(exact, exact)
    # The root of the error of the eigenvalue, at worst.
    assert np.abs(found - factor * exact).max() < 3e-5 * np.abs(found).max()


@pytest.mark.parametrize("sector", [EVEN, ODD, ONE, TWO])
@pytest.mark.parametrize("potential", [QUARTIC, LINEAR], ids=["quartic", "linear"])
def test_residuals_are_those_of_the_equation(potential, sector):
    # L f - λ f from its definition in polar coordinates, β = α - φ: L f =
    # cos β f_r + (sin β/r)(i M f - f_β) + B' sin β f_β + D f_ββ for f e^{iMφ}, with a
    # rule of its own in r, the trapezoid rule in β and numbers from `evaluate` only.
    noise, size = 0.9, Truncation(16, 9)
    discretisation = RadialDiscretisation(potential, noise)
    matrix = discretisation.matrix(sector, *size)
    # For the linear potential isolated ones: others reach out to infinity.
    shift = -0.3 + 0.1j if potential is QUARTIC else -0.4 if sector == ODD else -0.26
    values, vectors = nearest_eigenpairs(matrix, shift, 1)
    value, vector = values[0], vectors[:, 0]
    found = discretisation.residual(vector, value, sector, size)

    x, w = np.polynomial.legendre.leggauss(40)
    end = 4.0 if potential is QUARTIC else 1000.0
    edges = np.linspace(0.0, math.sqrt(end), 61)
    half = 0.5 * np.diff(edges)
    t = (half[:, None] * x + 0.5 * (edges[1:] + edges[:-1])[:, None]).ravel()
    r, weight = t**2, (half[:, None] * w).ravel() * 2 * t**3
    weight = weight * np.exp(-potential.radial_value(r))
    weight *= 2 * math.pi / potential.partition_function
    beta = np.arange(48) * (2 * math.pi / 48)
    basis = radial_basis(potential, size.degree)
    k_all = discretisation.harmonics(sector, size)
    f, f_r, f_beta, f_betabeta = np.zeros((4, len(r), len(beta)), complex)
    for k in np.unique(k_all):
        part = vector[k_all == k]
        g, slope = basis.evaluate(r, sector.M - k, size.degree)
        g, slope = part @ g[: len(part)], part @ slope[: len(part)]
        waves = [(1.0, k)]
        if sector.parity and k:
            waves = [(math.sqrt(0.5), k), (sector.parity * math.sqrt(0.5), -k)]
        for factor, n in waves:
            wave = factor * np.exp(1j * n * beta)
            f += np.outer(g, wave)
            f_r += np.outer(slope, wave)
            f_beta += np.outer(g, 1j * n * wave)
            f_betabeta -= np.outer(g, n**2 * wave)
    r = r[:, None]
    image = np.cos(beta) * f_r + np.sin(beta) / r * (1j * sector.M * f - f_beta)
    image += potential.radial_derivative(r) * np.sin(beta) * f_beta
    image += 0.5 * noise**2 * f_betabeta
    # Weighted before it is squared, for f grows like e^{0.4 r}.
    root = np.sqrt(weight)[:, None]
    square = np.sum(np.mean(np.abs(root * (image - value * f)) ** 2, axis=1))
    norm = np.sum(np.mean(np.abs(root * f) ** 2, axis=1))
    # What lies beyond the end of the rule, relative.
    assert abs(norm - 1) < 1e-7
    assert abs(found - math.sqrt(square / norm)) < 1e-6 * found


def test_residuals_in_an_enlarged_basis_are_exact_for_a_polynomial():
    discretisation = RadialDiscretisation(QUARTIC, 1.0)
    size = Truncation(16, 8)
    for sector in (EVEN, ODD, ONE):
        values, vectors = eigenpairs(QUARTIC, 1.0, sector, size)
        value, vector = values[-1], vectors[:, -1]
        large = discretisation.enlarged(size)
        longer = discretisation.embed(vector, sector, size, large)
        defect = discretisation.matrix(sector, *large) @ longer - value * longer
        exact = discretisation.residual(vector, value, sector, size)
        # Rounding of both.
        assert abs(np.linalg.norm(defect) - exact) < 1e-10


@every_potential
@pytest.mark.parametrize("sector", [EVEN, ODD, ONE])
def test_bases_are_nested(potential, sector):
    discretisation = RadialDiscretisation(potential, 1.0)
    small, large = Truncation(7, 4), Truncation(10, 6)
    outer = discretisation.matrix(sector, *large)
    n = len(discretisation.harmonics(sector, small))
    columns = np.array(
        [discretisation.embed(row, sector, small, large) for row in np.eye(n)]
    )
    inner = discretisation.matrix(sector, *small).toarray()
    # Entries below 1e-14 of a block are dropped.
    assert np.abs(columns @ outer @ columns.T - inner).max() < 1e-11


@pytest.mark.parametrize("sector", [EVEN, ODD, TWO])
def test_values_have_the_norm_of_their_coefficients(sector):
    discretisation = RadialDiscretisation(QUARTIC, 1.0)
    size = Truncation(8, 4)
    n = len(discretisation.harmonics(sector, size))
    vector = np.random.default_rng(1).standard_normal(n) * (1 + 0.5j)
    # The trapezoid rule is exact to rounding for such a function.
    grid = fp.PhaseSpaceGrid(half_width=4.0, shape=(80, 80, 16))
    values = discretisation.values(vector, sector, size, grid)
    weight = fp.LayDownModel(QUARTIC, 1.0).equilibrium(*grid.plane())
    square = np.sum(np.abs(values) ** 2 * weight[:, :, None]) * grid.cell_volume
    assert abs(square / np.vdot(vector, vector).real - 1) < 1e-9


def test_values_exist_at_the_origin():
    discretisation = RadialDiscretisation(LINEAR, 1.0)
    size = Truncation(6, 3)
    grid = fp.PhaseSpaceGrid(half_width=2.0, shape=(5, 5, 4))
    for sector in (EVEN, ONE):
        n = len(discretisation.harmonics(sector, size))
        assert np.isfinite(discretisation.values(np.ones(n), sector, size, grid)).all()


def finite_differences(potential, noise, M, n_r, n_beta, end):
    """L in (r, β), central differences of fourth order in r, Fourier in β.

    For w = e^{-B/2} f, which vanishes at the end; across the origin (-r, β) is the
    point (r, β + π), where f e^{iMφ} has the other sign if M is odd.
    """
    h = end / n_r
    r = (np.arange(n_r) + 0.5) * h
    weights = np.array([1, -8, 0, 8, -1]) / (12 * h)
    line = diags_array(weights, offsets=[-2, -1, 0, 1, 2], shape=(2 * n_r, 2 * n_r))
    line = line.tocsc()[n_r:]
    outward, through = line[:, n_r:], line[:, :n_r][:, ::-1]
    n = n_beta
    turn = np.fft.ifft(
        1j * np.fft.fftfreq(n, 1 / n)[:, None] * np.fft.fft(np.eye(n), axis=0), axis=0
    )
    half_turn = (-1) ** M * np.roll(np.eye(n), n // 2, axis=1)
    beta = np.arange(n) * (2 * math.pi / n)
    cosine, sine = np.diag(np.cos(beta)), np.diag(np.sin(beta))
    slope = potential.radial_derivative(r)
    matrix = kron(outward, cosine) + kron(through, cosine @ half_turn)
    matrix += kron(diags_array(slope), 0.5 * cosine + sine @ turn)
    matrix += kron(diags_array(1 / r), sine @ (1j * M * np.eye(n) - turn))
    matrix += kron(eye_array(n_r), 0.5 * noise**2 * turn @ turn)
    return csc_array(matrix)


@pytest.mark.parametrize("noise", [0.8, 2.0])
@pytest.mark.parametrize("M", [0, 1, 2])
@pytest.mark.parametrize("name", ["quartic", "power 3/2"])
def test_eigenvalues_agree_with_finite_differences(name, M, noise):
    potential = POTENTIALS[name]
    sectors = [EVEN, ODD] if M == 0 else [Sector(M)]
    shift = 0.05 if noise > 1 else 0.05 + 0.7j
    exact = np.concatenate(
        [eigenpairs(potential, noise, s, (30, 16), 2, shift)[0] for s in sectors]
    )
    end = 3.2 if name == "quartic" else 12.0
    matrix = finite_differences(potential, noise, M, 120, 24, end)
    found = eigs(matrix, k=6, sigma=shift, return_eigenvectors=False)
    nearest = exact[np.argmin(np.abs(exact - shift))]
    exact = exact[np.abs(exact - shift) < 1.5 * abs(nearest - shift) + 0.1]
    for value in exact:
        # Fourth order at 38 points per unit; B' of the power 3/2 has an infinite slope
        # at the origin, which leaves the order three halves, and ten per unit.
        allowed = 1e-4 if name == "quartic" else 4e-3
        assert np.abs(found - value).min() < allowed * max(1.0, abs(value))


def poincare_constant(potential, end, n):
    """First eigenvalue of -Δ + ∇B·∇ among the functions f(r) e^{iφ}, by differences.

    Divergence form on cells of [0, end]; second order, extrapolated from n and 2n.
    """

    def lowest(n):
        h = end / n
        face = np.arange(n + 1) * h
        r = face[:-1] + 0.5 * h
        density = r * np.exp(-potential.radial_value(r))
        flux = face * np.exp(-potential.radial_value(face)) / h**2
        flux[-1] = 0
        diagonal = (flux[1:] + flux[:-1]) / density + 1 / r**2
        beside = -flux[1:-1] / np.sqrt(density[1:] * density[:-1])
        return eigh_tridiagonal(
            diagonal, beside, select="i", select_range=(0, 0), eigvals_only=True
        )[0]

    return (4 * lowest(2 * n) - lowest(n)) / 3


@pytest.mark.parametrize(
    ("potential", "end"),
    [(QUARTIC, 5.0), (fp.PowerPotential(1.5), 25.0), (MIXED, 12.0)],
)
def test_at_large_noise_the_rate_is_the_poincare_constant(potential, end):
    constant = poincare_constant(potential, end, 4000)
    rates = [-(noise**2) * eigenvalue(potential, noise, ONE).real for noise in (16, 32)]
    # The first correction is of order A⁻⁴ and removed; 1e-6 for the differences, which
    # kinks at the origin deprive of their order.
    assert abs((16 * rates[1] - rates[0]) / 15 / constant - 1) < 2e-6


def test_at_large_noise_the_linear_potential_is_a_plane_hydrogen_atom():
    # -Δ + ∂_r on L²(r e^{-r}) has the eigenvalues (1 - (2n + 1)⁻²)/4, n >= |l|.
    noise = 30.0
    for sector, n in ((EVEN, 1), (ONE, 1), (TWO, 2), (Sector(3), 3)):
        exact = (1 - (2 * n + 1) ** -2.0) / 4
        rate = -(noise**2) * eigenvalue(LINEAR, noise, sector).real
        # The correction of order A⁻⁴ is 1e-6 at most.
        assert abs(rate - exact) < 1e-6


def test_eigenvalues_of_the_linear_potential_do_not_depend_on_the_basis():
    # Digits that three truncations, and bases with other growth and other roots of r,
    # agree on at A = 1 and at the crossing near A = 0.8.
    for noise, sector, exact in (
        (1.0, ONE, -0.2179629240),
        (1.0, EVEN, -0.2193084954),
        (1.0, TWO, -0.2256401569),
        (0.8, ONE, -0.3244875204),
        (0.8, EVEN, -0.3238382658),
        (0.8, TWO, -0.3229983223),
    ):
        found = eigenvalue(LINEAR, noise, sector, (28, 16))
        assert abs(found - exact) < 2e-10, (noise, sector)


def test_the_best_noise_of_the_linear_potential_is_a_crossing():
    # -A²/2 of M = 0 odd falls with the noise, M = ±2 rises: they meet at this noise.
    noise = 0.8021925977
    shift = -0.31
    found, _ = eigenpairs(LINEAR, noise, TWO, (28, 16), 1, shift)
    assert abs(found[0] + 0.5 * noise**2) < 1e-9
    for sector in (EVEN, ONE, Sector(3), Sector(4)):
        others, _ = eigenpairs(LINEAR, noise, sector, (20, 12), 1, shift)
        assert others[0].real < -0.3224


@pytest.mark.parametrize("sector", [EVEN, ONE, TWO, Sector(3)])
@pytest.mark.parametrize("noise", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("name", ["linear", "power 3/2", "cubic"])
def test_no_eigenvalue_near_zero_is_spurious(name, noise, sector):
    # A space for the harmonic 0 that its neighbours do not control gives real
    # eigenvalues that drift with the truncation (see RadialBasis.count).
    potential = POTENTIALS[name]
    coarse, fine = (
        eigenpairs(potential, noise, sector, size, n)[0]
        for size, n in (((14, 10), 2), ((18, 12), 6))
    )
    for value in coarse:
        assert np.abs(fine - value).min() < 1e-2 * abs(value) + 1e-12, value


@pytest.mark.parametrize("noise", [0.3, 0.7, 1.0, 2.0, 10.0])
@pytest.mark.parametrize("slope", [1.0, 2.5])
def test_the_threshold_is_the_top_of_the_operator_on_the_circle(noise, slope):
    k = np.arange(-60.0, 61)

    def real_parts(kappa):
        # κ cos β + K sin β ∂_β + D ∂_ββ on harmonics, k to k ± 1 by (κ ± K k)/2.
        up, down = 0.5 * (kappa + slope * k[:-1]), 0.5 * (kappa - slope * k[1:])
        decay = np.diag(-0.5 * noise**2 * k**2)
        values = np.linalg.eigvals(decay + np.diag(up, -1) + np.diag(down, 1))
        return np.sort(values.real)[::-1]

    threshold = essential_threshold(slope, noise)
    # At small noise the matrix is far from normal: rounding times its condition.
    allowed = 1e-10 if noise > 0.6 else 1e-5 if noise < 0.5 and slope == 1 else 1e-2
    allowed *= slope
    assert abs(real_parts(slope / 2)[0] - threshold) < allowed
    # Largest for real κ, and there smallest at K/2.
    for frequency in (0.1, 0.5, 2.0):
        assert real_parts(slope / 2 + 1j * frequency)[0] < threshold + allowed
    for kappa in (0.0, 0.3 * slope, 0.9 * slope):
        assert real_parts(kappa)[0] > threshold - allowed
    # K = slope is K = 1 with lengths in units of 1/slope.
    scaled = slope * essential_threshold(1.0, noise / math.sqrt(slope))
    assert abs(threshold / scaled - 1) < 1e-12


def test_the_threshold_has_its_asymptotes():
    slope = 1.5
    large = essential_threshold(slope, 12.0)
    expansion = -(slope**2) / (4 * 12**2) + slope**4 / (64 * 12**6)
    # The next term is of order A⁻¹⁰; the Mathieu function is good to 1e-12.
    assert abs(large - expansion) < 1e-11
    small = essential_threshold(slope, 0.1)
    # -K/2 + A²/8 and a correction of order A⁴.
    assert abs(small + slope / 2 - 0.1**2 / 8) < 1e-5


def test_functions_odd_in_the_angle_have_a_threshold_of_their_own():
    for noise in (0.7, 1.0, 3.0):
        k = np.arange(1.0, 61)
        up, down = 0.5 * (0.5 + k[:-1]), 0.5 * (0.5 - k[1:])
        matrix = np.diag(-0.5 * noise**2 * k**2) + np.diag(up, -1) + np.diag(down, 1)
        exact = np.linalg.eigvals(matrix).real.max()
        # The condition of the matrix at A = 0.7.
        assert abs(essential_threshold(1.0, noise, parity=-1) - exact) < 1e-9
        odd = essential_threshold(1.0, noise, parity=-1)
        assert odd < essential_threshold(1.0, noise, parity=1)


def test_eigenvalues_accumulate_at_the_threshold_and_do_not_cross_it_by_much():
    # Beyond the threshold the truncated spectrum is a cluster that never converges.
    noise, threshold = 2.0, essential_threshold(1.0, 2.0)
    for sector in (EVEN, ONE):
        coarse, fine = (
            eigenpairs(LINEAR, noise, sector, size, 12)[0].real
            for size in ((16, 8), (32, 8))
        )
        isolated = [np.sum(values > threshold) for values in (coarse, fine)]
        assert isolated[1] > isolated[0] > 3


def test_the_limit_of_the_slope_decides_whether_there_is_a_threshold():
    assert asymptotic_slope(fp.LinearPotential(2.0)) == 2.0
    assert asymptotic_slope(HYPERBOLA) == 1.0
    assert asymptotic_slope(fp.PowerPotential(1.01)) == math.inf
    assert asymptotic_slope(QUARTIC) == math.inf
    assert asymptotic_slope(MIXED) == math.inf
    assert essential_threshold(math.inf, 1.0) is None
    weak = fp.IsotropicPotential(
        lambda r: 4 * np.log1p(r**2), lambda r: 8 * r / (1 + r**2)
    )
    assert asymptotic_slope(weak) == 0.0
    assert essential_threshold(asymptotic_slope(weak), 1.0) == 0.0
    with pytest.raises(ValueError, match="must grow at least in proportion to"):
        RadialDiscretisation(weak, 1.0).matrix(ONE, 8, 4)


def test_scales_may_be_large_or_small():
    unit = eigenvalue(QUARTIC, 1.0, ONE)
    for scale in (1e-3, 1e3):
        potential = fp.PowerPotential(4.0, scale=scale)
        noise = 1 / math.sqrt(scale)
        values, _ = eigenpairs(potential, noise, ONE, (24, 12), 3, 0.05 / scale)
        assert abs(scale * values[0] - unit) < 1e-11


def test_an_unconserved_index_is_refused():
    with pytest.raises(ValueError, match="`sector` must have an angular index M"):
        RadialDiscretisation(LINEAR, 1.0).matrix(Sector(parity=1), 8, 4)
