"""Stationary densities on a belt between sectors, against elimination and laws."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import GaussianLaw
from fpsolve.spectral.evolution import quadrature
from fpsolve.spectral.evolution.null_vector import stationary, truncation_limits
from fpsolve.spectral.evolution.projection import GaussianStart
from fpsolve.spectral.evolution.sector_start import turned, turned_back
from fpsolve.spectral.evolution.sector_steady import SectorsOnBelt, memory_of


def belt(noise, speed, sigma=1.0):
    return fp.LayDownModel(
        fp.QuadraticPotential(sigma, sigma), noise, fp.MovingBelt(speed)
    )


def test_turning_the_basis_there_and_back_changes_nothing():
    law = GaussianLaw((0.5, -0.3), ((0.7, 0.1), (0.1, 0.6)), 0.8, 1.0)
    start = GaussianStart(law, fp.QuadraticPotential())
    h = start.expansion(60, 5)
    circles = turned(h)
    # Unitary at every degree: the norm over both signs of k is kept.
    weight = np.where(np.arange(6) == 0, 1.0, 2.0)
    norm = (np.abs(circles) ** 2 * weight).sum()
    assert norm == pytest.approx(h.energies().sum(), rel=1e-13)
    np.testing.assert_allclose(
        turned_back(circles).values, h.values, rtol=0, atol=1e-13
    )


@pytest.mark.parametrize(
    ("noise", "speed", "sigma"), [(1.0, 0.3, 1.0), (2.0, -0.5, 0.7)]
)
def test_sectors_and_elimination_find_the_same_density(noise, speed, sigma):
    model = belt(noise, speed, sigma)
    grid = fp.PhaseSpaceGrid(4.0, (16, 16, 8))
    distances = []
    for degree in (34, 44):
        found = SectorsOnBelt(model, degree).stationary()
        other = stationary(model, truncation_limits(degree))
        p, q = (quadrature.density_on(h, grid, model.potential) for h in (found, other))
        distances.append(fp.diagnostics.l1_distance(p, q, grid))
    one, two = (quadrature.moments(h, model.potential) for h in (found, other))
    for name, value in one.items():
        # Two truncations of other shapes; 3e-10 measured.
        assert value == pytest.approx(two[name], abs=2e-9), name
    # Statement 5, exact in every truncation.
    assert one["mean_cos_alpha"] == pytest.approx(-speed, abs=1e-12)
    # Densities take more degrees than moments: they come nearer, each from its side.
    assert distances[1] < 0.7 * distances[0] < 1e-2


def test_little_noise_takes_a_hundredth_of_the_memory():
    model = belt(0.5, 0.1)
    # Elimination ends at 5.7e-5 within 256 MiB.
    found = fp.spectral_steady_state(model, tolerance=1e-6, memory_limit=100 * 2**20)
    assert found.truncation[0] > 60
    assert max(found.errors.values()) <= 1e-6
    # By degrees 148 and 193: 0.04926017181.
    assert abs(found.moments["mean_xi1"] - 0.04926017181) <= found.errors["mean_xi1"]
    assert found.moments["mean_cos_alpha"] == pytest.approx(-0.1, abs=1e-12)


@pytest.mark.nightly
def test_little_noise_is_known_to_eight_digits_within_256_mebibytes():
    found = fp.spectral_steady_state(belt(0.5, 0.1), memory_limit=256 * 2**20)
    assert max(found.errors.values()) <= 1e-8
    assert found.moments["mean_xi1"] == pytest.approx(0.04926017181, abs=1e-8)


def test_the_memory_is_told_before_it_is_taken():
    # 2700 bytes an unknown, and the cubes of two expansions.
    assert 9e7 < memory_of(114) < 2**28 < memory_of(250)
    with pytest.raises(ToleranceError, match="raise `memory_limit` or `tolerance`"):
        fp.spectral_steady_state(belt(0.2, 0.5), memory_limit=30 * 2**20)
    assert math.isfinite(memory_of(400))
