"""Galerkin matrices and eigenfunctions against the definition of the generator."""

import itertools

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.spectral import Sector, spectrum
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.bases.tensor import TensorDiscretisation

ODD, EVEN, ONE = Sector(0, -1), Sector(0, 1), Sector(1)


def quadratic(noise, sigma=1.0):
    return fp.LayDownModel(fp.QuadraticPotential(sigma, sigma), noise)


GRID = fp.PhaseSpaceGrid(9.0, (48, 48, 16))
CASES = [
    (HermiteDiscretisation(1.0, 0.8), [EVEN, ODD, ONE, Sector(3)], 1.0, 0.0),
    (HermiteDiscretisation(0.8, 0.8), [ONE], 0.8, 0.0),
    (TensorDiscretisation(1.0, 0.8, 0.7), None, 0.8, 0.0),
    (TensorDiscretisation(1.0, 0.8, 0.7, 0.3), None, 0.8, 0.3),
]


@pytest.mark.parametrize(("basis", "sectors", "sigma2", "speed"), CASES)
def test_the_matrix_is_the_generator_by_quadrature_of_its_definition(
    basis, sectors, sigma2, speed
):
    sigma1 = sigma2 if isinstance(basis, HermiteDiscretisation) else 1.0
    potential = fp.QuadraticPotential(sigma1, sigma2)
    curve = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    model = fp.LayDownModel(potential, basis.noise, curve)
    truncation = Truncation(3, 2)
    for sector in basis.sectors() if sectors is None else sectors:
        matrix = basis.matrix(sector, *truncation).toarray()
        functions = [
            basis.values(column, sector, truncation, GRID)
            for column in np.eye(len(matrix))
        ]
        # The trapezoidal rule is exact to rounding for these functions.
        root = np.sqrt(model.equilibrium(*GRID.plane()) * GRID.cell_volume)[..., None]
        weighted = np.array([root * f for f in functions]).reshape(len(matrix), -1)
        gram = weighted.conj() @ weighted.T
        np.testing.assert_allclose(gram, np.eye(len(matrix)), rtol=0, atol=1e-12)
        images = np.array([(root * generator(model, f)).ravel() for f in functions])
        np.testing.assert_allclose(
            weighted.conj() @ images.T, matrix, rtol=0, atol=1e-11
        )


def generator(model, f):
    """L f by Fourier differentiation of f √p_S, which vanishes at the boundary."""
    xi1, xi2, alpha = GRID.mesh()
    slope1, slope2 = model.potential.gradient(xi1, xi2)
    root = np.exp(-0.5 * model.potential.value(xi1, xi2))
    u = f * root
    # ∇f = (∇u + ½ ∇B u)/√p_S
    gradient1 = derivative(u, 0) + 0.5 * slope1 * u
    gradient2 = derivative(u, 1) + 0.5 * slope2 * u
    cosine, sine = np.cos(alpha), np.sin(alpha)
    turning = -slope1 * sine + slope2 * cosine
    speed = model.belt_speed
    image = (cosine + speed) * gradient1 + sine * gradient2
    image = image - turning * derivative(u, 2) + model.diffusivity * derivative(u, 2, 2)
    return image / root


def derivative(u, axis, order=1):
    n, step = GRID.shape[axis], GRID.spacing[axis]
    frequency = 2 * np.pi * np.fft.fftfreq(n, step)
    frequency[n // 2] = 0.0
    shape = [1, 1, 1]
    shape[axis] = n
    factor = ((1j * frequency) ** order).reshape(shape)
    return np.fft.ifft(factor * np.fft.fft(u, axis=axis), axis=axis)


SMALL = fp.PhaseSpaceGrid(0.48, (24, 24, 48))
MODELS = {
    "isotropic": quadratic(1.2, 0.9),
    "anisotropic": fp.LayDownModel(fp.QuadraticPotential(1.0, 0.8), 2.0),
    "belt": fp.LayDownModel(fp.QuadraticPotential(1.0, 0.9), 2.0, fp.MovingBelt(0.2)),
    "quartic": fp.LayDownModel(fp.PowerPotential(4.0), 1.5),
}


@pytest.mark.parametrize("name", MODELS)
def test_eigenfunctions_satisfy_the_equations_pointwise(name):
    model = MODELS[name]
    found = spectrum(model, 3, tolerance=1e-6)
    xi1, xi2, alpha = SMALL.mesh()
    slope1, slope2 = model.potential.gradient(xi1, xi2)
    force = -(slope1 * -np.sin(alpha) + slope2 * np.cos(alpha))
    wind = np.cos(alpha) + model.belt_speed, np.sin(alpha)
    for i, value in enumerate(found.eigenvalues):
        f = found.eigenfunction(i, SMALL)
        d1, d2, da, daa = differences(f)
        image = wind[0] * d1 + wind[1] * d2 + force * da + model.diffusivity * daa
        # The defect is that of the truncation, near the origin no larger than in L²(μ)
        # (measured: 0.7 of it); sixth-order differences at spacing 0.04 leave 1e-8.
        error = np.abs(image - value * f)[INNER].max()
        assert error < (2 * found.residuals[i] + 1e-7) * np.abs(f).max()
        p = found.density_mode(i, SMALL)
        d1, d2, _, daa = differences(p)
        kick = differences(force * p)[2]
        image = -wind[0] * d1 - wind[1] * d2 - kick + model.diffusivity * daa
        error = np.abs(image - value * p)[INNER].max()
        # On a belt the eigenfunction of L* is another function, resolved less well:
        # the drift shifts the density against p_S (measured: 80 times the residual).
        factor = 200 if model.belt_speed else 2
        assert error < (factor * found.residuals[i] + 1e-7) * np.abs(p).max()


INNER = (slice(3, -3), slice(3, -3), slice(None))


def differences(f):
    """∂₁, ∂₂ by sixth-order differences, ∂_α and ∂_αα by Fourier's."""
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    first = []
    for axis in (0, 1):
        shifts = zip(weights, range(3, -4, -1), strict=True)
        moved = sum(weight * np.roll(f, shift, axis) for weight, shift in shifts)
        first.append(moved / SMALL.spacing[axis])
    k = np.fft.fftfreq(48, 1 / 48)
    spectral = np.fft.fft(f, axis=2)
    angular = [np.fft.ifft((1j * k) ** order * spectral, axis=2) for order in (1, 2)]
    return *first, *angular


def test_eigenfunctions_are_normalised_and_density_modes_carry_no_mass():
    found = spectrum(quadratic(1.0), 3, tolerance=1e-8)
    reference = quadratic(1.0).equilibrium(*GRID.plane())[..., None]
    wide = fp.PhaseSpaceGrid(9.0, (48, 48, 64))
    volume = wide.cell_volume
    for i in range(3):
        f, p = found.eigenfunction(i, wide), found.density_mode(i, wide)
        assert np.sum(np.abs(f) ** 2 * reference) * volume == pytest.approx(1, abs=1e-8)
        assert abs(p.sum() * volume) < 1e-8


def test_tensor_and_complex_hermite_bases_hold_the_same_spectrum():
    # Both span all polynomials up to the degree times all harmonics.
    degree, harmonics, noise = 5, 3, 0.9
    tensor = TensorDiscretisation(1.0, 1.0, noise)
    ito = HermiteDiscretisation(1.0, noise)
    ours = [
        np.linalg.eigvals(tensor.matrix(sector, degree, harmonics).toarray())
        for sector in tensor.sectors()
    ]
    theirs = []
    for sector in (EVEN, ODD, *map(Sector, range(1, degree + harmonics + 1))):
        values = np.linalg.eigvals(ito.matrix(sector, degree, harmonics).toarray())
        theirs += [values] * sector.multiplicity
    ours, theirs = np.concatenate(ours), np.concatenate(theirs)
    assert len(ours) == len(theirs) == 21 * 7
    # Characteristic sums: unlike single eigenvalues insensitive to multiple ones.
    for power in (1, 2, 3, 4):
        assert np.sum(ours**power) == pytest.approx(np.sum(theirs**power), rel=1e-10)


@pytest.mark.parametrize("basis", [CASES[0][0], CASES[3][0]], ids=["Itô", "tensor"])
def test_bases_are_nested(basis):
    small, large = Truncation(4, 2), Truncation(7, 5)
    for sector in itertools.islice(basis.sectors(), 2):
        size = len(basis.harmonics(sector, small))
        rows = [basis.embed(unit, sector, small, large) for unit in np.eye(size)]
        inner = np.array(rows) @ basis.matrix(sector, *large) @ np.array(rows).T
        outer = basis.matrix(sector, *small).toarray()
        np.testing.assert_allclose(inner, outer, rtol=0, atol=1e-15)
