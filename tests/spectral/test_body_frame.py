"""Bases of a smooth fibre in its own frame, against the definition of the generator."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.spectral import Sector
from fpsolve.spectral.bases.body_frame import BodyFrameDiscretisation
from fpsolve.spectral.bases.sectors import Truncation

ODD, EVEN, ONE = Sector(0, -1), Sector(0, 1), Sector(1)
SIGMA = 0.8
MODEL = fp.SmoothLayDownModel(fp.QuadraticPotential(SIGMA, SIGMA), 0.3, noise=1.5)
BASIS = BodyFrameDiscretisation(MODEL)
SMALL = Truncation(2, 2, 2)
GRID = fp.SmoothPhaseSpaceGrid(7.0, 20.0, (28, 28, 10, 36))


def functions(sector, truncation=SMALL, dual=False):
    size = BASIS.matrix(sector, *truncation).shape[0]
    values = BASIS.dual_values if dual else BASIS.values
    return [values(row, sector, truncation, GRID) for row in np.eye(size)]


@pytest.mark.parametrize(
    "sector", [EVEN, ODD, pytest.param(ONE, marks=pytest.mark.nightly)]
)
def test_the_matrix_is_the_generator_by_quadrature_of_its_definition(sector):
    matrix = BASIS.matrix(sector, *SMALL).toarray()
    observables, densities = functions(sector), functions(sector, dual=True)
    densities = np.array(densities).reshape(len(matrix), -1) * GRID.cell_volume
    # The trapezoidal rule in products of Gaussians: exact to the tails in the box.
    pairing = densities @ np.array(observables).reshape(len(matrix), -1).T
    np.testing.assert_allclose(pairing, np.eye(len(matrix)), rtol=0, atol=1e-10)
    images = np.array([generator(f).ravel() for f in observables])
    np.testing.assert_allclose(densities @ images.T, matrix, rtol=0, atol=1e-8)


def generator(f):
    """L f by Fourier differentiation of f times a Gaussian, which ends in the box."""
    xi1, xi2, alpha, kappa = GRID.mesh()
    position, curvature = 2.5, 12.0
    root = np.exp(-(xi1**2 + xi2**2) / position - kappa**2 / curvature)
    u = f * root
    gradient = [
        derivative(u, at) + 2 * x / position * u for at, x in ((0, xi1), (1, xi2))
    ]
    along_kappa = derivative(u, 3) + 2 * kappa / curvature * u
    twice = derivative(u, 3, 2) + 4 * kappa / curvature * derivative(u, 3)
    twice = twice + (2 / curvature + (2 * kappa / curvature) ** 2) * u
    motion1, motion2, turn, force = MODEL.drift(xi1, xi2, alpha, kappa)
    image = motion1 * gradient[0] + motion2 * gradient[1] + turn * derivative(u, 2)
    image = image + force * along_kappa + 0.5 * MODEL.curvature_noise**2 * twice
    return image / root


def derivative(u, axis, order=1):
    n, step = GRID.shape[axis], GRID.spacing[axis]
    frequency = 2 * np.pi * np.fft.fftfreq(n, step)
    frequency[n // 2] = 0.0
    shape = [1, 1, 1, 1]
    shape[axis] = n
    factor = ((1j * frequency) ** order).reshape(shape)
    return np.fft.ifft(factor * np.fft.fft(u, axis=axis), axis=axis)


@pytest.mark.parametrize("sector", [EVEN, ODD, ONE])
def test_the_generator_maps_a_basis_into_the_enlarged_one(sector):
    small, large = Truncation(4, 4, 3), Truncation(7, 7, 8)
    matrix, outer = BASIS.matrix(sector, *small), BASIS.matrix(sector, *large)
    enlarged = BASIS.enlarged(small)
    for vector in np.eye(matrix.shape[0]):
        image = outer @ BASIS.embed(vector, sector, small, large)
        inner = BASIS.matrix(sector, *enlarged)
        exact = inner @ BASIS.embed(vector, sector, small, enlarged)
        # The same sums of a few products: rounding of entries of size 10.
        found = BASIS.embed(exact, sector, enlarged, large)
        np.testing.assert_allclose(found, image, rtol=0, atol=1e-12)
        projected = BASIS.embed(matrix @ vector, sector, small, large)
        kept = projected != 0
        np.testing.assert_allclose(image[kept], projected[kept], rtol=0, atol=1e-12)


def test_units_of_length_scale_the_matrix():
    """ξ = σξ', R = σR', κ = κ'/σ and A = A'/√σ: L = L'/σ."""
    unit = fp.SmoothLayDownModel(
        fp.QuadraticPotential(1.0, 1.0), 0.3 / SIGMA, noise=1.5 * SIGMA**0.5
    )
    for sector in (EVEN, ONE):
        scaled = BodyFrameDiscretisation(unit).matrix(sector, *SMALL) / SIGMA
        matrix = BASIS.matrix(sector, *SMALL)
        # Rounding of entries of size 10.
        assert abs(matrix - scaled).max() < 1e-13


def test_the_size_of_a_sector_is_known_without_its_functions():
    for sector in (EVEN, ODD, ONE):
        for truncation in (Truncation(4, 4, 3), Truncation(5, 5, 6)):
            counted = len(BASIS.harmonics(sector, truncation))
            assert BASIS.size(sector, truncation) == counted


def test_moments_are_those_of_the_density_on_a_grid():
    truncation = Truncation(4, 4, 4)
    vector = np.random.default_rng(3).standard_normal(BASIS.size(EVEN, truncation))
    found = BASIS.stationary_moments(vector, truncation)
    p = BASIS.dual_values(vector, EVEN, truncation, GRID)
    # A combination of real functions: rounding of numbers of size one.
    assert np.abs(p.imag).max() < 1e-14 * np.abs(p.real).max()
    xi1, _, alpha, kappa = GRID.mesh()
    mass = GRID.cell_volume * p.real.sum()
    # The trapezoidal rule: the tails of w^ϑ in the box, 1e-10 of the whole.
    assert found["mass"] == pytest.approx(mass, rel=1e-8)
    for name, f in (
        ("variance_xi1", xi1**2),
        ("mean_kappa2", kappa**2),
        ("mean_cos_alpha", np.cos(alpha)),
    ):
        mean = GRID.cell_volume * (p.real * f).sum() / mass
        assert found[name] == pytest.approx(mean, rel=1e-7, abs=1e-9)
