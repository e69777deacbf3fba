"""Bases of smooth fibres on belts and about unequal ranges, against the generator."""

import numpy as np
import pytest
from fourier import derivative

import fpsolve as fp
from fpsolve.spectral import Sector
from fpsolve.spectral.bases.body_frame import BodyFrameDiscretisation
from fpsolve.spectral.bases.coupled import CoupledDiscretisation
from fpsolve.spectral.bases.placement import Placement, first_placement
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.bases.weights import Weight

MODEL = fp.SmoothLayDownModel(
    fp.QuadraticPotential(1.1, 0.8), 0.3, 1.5, fp.MovingBelt(0.3)
)
PLACE = Placement(0.4, (1.1, 0.9), 0.75, Weight(3.0, 0.85))
BASIS = CoupledDiscretisation(MODEL, PLACE)
EVEN, ODD = Sector(parity=1), Sector(parity=-1)
SMALL = Truncation(2, 1, 1)
GRID = fp.SmoothPhaseSpaceGrid((8.4, 6.6), 16.0, (32, 32, 12, 32))


def on_grid(values, sector):
    size = BASIS.matrix(sector, *SMALL).shape[0]
    return [values(row, sector, SMALL, GRID) for row in np.eye(size)]


@pytest.mark.nightly
@pytest.mark.parametrize("sector", [EVEN, ODD])
def test_the_matrix_is_the_generator_by_quadrature_of_its_definition(sector):
    matrix = BASIS.matrix(sector, *SMALL).toarray()
    observables = on_grid(BASIS.values, sector)
    densities = np.array(on_grid(BASIS.dual_values, sector)).reshape(len(matrix), -1)
    densities *= GRID.cell_volume
    # The trapezoidal rule in products of Gaussians: exact to the tails in the box.
    pairing = densities @ np.array(observables).reshape(len(matrix), -1).T
    np.testing.assert_allclose(pairing, np.eye(len(matrix)), rtol=0, atol=1e-8)
    images = np.array([generator(f).ravel() for f in observables])
    # The same for products with ξ and κ and for derivatives of up to second order.
    np.testing.assert_allclose(densities @ images.T, matrix, rtol=0, atol=1e-6)


def generator(f):
    """L f by Fourier differentiation of f times a Gaussian, which ends in the box."""
    xi1, xi2, alpha, kappa = GRID.mesh()
    position, curvature = 3.0, 12.0
    root = np.exp(-((xi1 - 0.4) ** 2 + xi2**2) / position - kappa**2 / curvature)
    u = f * root
    along1 = derivative(u, GRID, 0) + 2 * (xi1 - 0.4) / position * u
    along2 = derivative(u, GRID, 1) + 2 * xi2 / position * u
    first = derivative(u, GRID, 3)
    along_kappa = first + 2 * kappa / curvature * u
    twice = derivative(u, GRID, 3, 2) + 4 * kappa / curvature * first
    twice = twice + (2 / curvature + (2 * kappa / curvature) ** 2) * u
    motion1, motion2, turn, force = MODEL.drift(xi1, xi2, alpha, kappa)
    image = motion1 * along1 + motion2 * along2 + turn * derivative(u, GRID, 2)
    image = image + force * along_kappa + 0.5 * MODEL.curvature_noise**2 * twice
    return image / root


@pytest.mark.parametrize("sector", [EVEN, ODD])
def test_the_generator_maps_a_basis_into_the_enlarged_one(sector):
    small = Truncation(3, 2, 2)
    large, larger = BASIS.enlarged(small), Truncation(6, 6, 6)
    inner, outer = BASIS.matrix(sector, *large), BASIS.matrix(sector, *larger)
    for vector in np.eye(BASIS.matrix(sector, *small).shape[0])[::5]:
        image = inner @ BASIS.embed(vector, sector, small, large)
        exact = outer @ BASIS.embed(vector, sector, small, larger)
        # Sums of a few products of size 10, and none beyond the enlarged basis.
        found = BASIS.embed(image, sector, large, larger)
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12)


def test_on_a_belt_at_rest_even_and_odd_indices_part():
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(1.1, 0.8), 0.3, 1.5)
    rest = CoupledDiscretisation(model, first_placement(model))
    size = Truncation(3, 5, 3)
    parted = list(rest.sectors())
    assert len(parted) == 4
    for parity in (1, -1):
        whole = rest.matrix(Sector(parity=parity), *size)
        parts = [rest.matrix(one, *size) for one in parted if one.parity == parity]
        values = np.concatenate([np.linalg.eigvals(one.toarray()) for one in parts])
        everything = np.linalg.eigvals(whole.toarray())
        # One distance for every eigenvalue; they are not normal: rounding 1e-15 of
        # entries of size 10 moves them by its cube root in the worst case.
        distance = np.abs(everything[:, None] - values).min(axis=1)
        assert len(values) == len(everything)
        assert distance.max() < 1e-4


def test_a_round_potential_at_rest_has_uncoupled_indices():
    """Diagonal blocks are the sectors of the isotropic basis, and all there is."""
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(0.8, 0.8), 0.3, 1.5)
    plain, coupled = (
        BodyFrameDiscretisation(model),
        CoupledDiscretisation(model, first_placement(model)),
    )
    size = Truncation(3, 4, 3)
    matrix = coupled.matrix(ODD, *size)
    offsets = coupled.states(ODD, size).offsets
    rest = 0.0
    for index, start, stop in zip(range(5), offsets[:-1], offsets[1:], strict=True):
        sector = Sector(index) if index else Sector(0, -1)
        block = matrix[start:stop, start:stop]
        # The same numbers but for the order of their products.
        assert abs(block - plain.matrix(sector, *size)).max() < 1e-12
        rest += abs(block).sum()
    assert abs(matrix).sum() == pytest.approx(rest, rel=1e-14)
