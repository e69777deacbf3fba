"""Eigenvalues of B = ‖ξ‖ at little noise, next to an essential spectrum."""

from dataclasses import replace

import numpy as np

import fpsolve as fp
from fpsolve.spectral.bases.radial import RadialDiscretisation
from fpsolve.spectral.bases.sectors import Sector, Truncation
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse
from fpsolve.spectral.eigen.refinement import Refinement
from fpsolve.spectral.eigen.survey import Mode, Scale
from fpsolve.spectral.work import Work

ODD, ONE = Sector(0, -1), Sector(1)
LINEAR = fp.LinearPotential()


def test_an_eigenvalue_next_to_a_continuum_is_followed_at_little_cost():
    # Near A = 0.6 the pair of M = ±1 is slower than all but one, and at four fifths of
    # its distance from 0 a continuum begins.
    model = fp.LayDownModel(LINEAR, 0.6)
    asked = {"sectors": (ODD, ONE), "tolerance": 1e-9, "work_limit": 2e9}
    found = fp.spectrum(model, 3, **asked)
    # To 3e-11 from bases with functions of r^{1/2}, r^{1/3}, r^{1/4} that grow like
    # exp(B/4), exp(0.4 B) and exp(0.3 B).
    exact = -0.23334225739 + 0.16596241073j
    assert abs(found.eigenvalues[0] + 0.18) <= found.errors[0]
    assert abs(found.eigenvalues[1] - exact) <= found.errors[1] + 3e-11
    assert found.errors[1] <= 1e-9 * 0.2334


def test_the_nearest_eigenvalue_is_the_same_with_and_without_its_neighbours():
    matrix = RadialDiscretisation(LINEAR, 0.6).matrix(ONE, 22, 14)
    inverse = ShiftedInverse(matrix, -0.2331 + 0.16597j, Work())
    all_of_them, _ = inverse.eigenpairs(4)
    cost = inverse.work.spent
    values, vectors = inverse.nearest(4, None, 0.07)
    # A twentieth of all of them, and the first to rounding.
    assert inverse.work.spent - cost < 0.2 * cost
    assert abs(values[0] - all_of_them[0]) < 1e-13
    residual = matrix @ vectors[:, 0] - values[0] * vectors[:, 0]
    assert np.linalg.norm(residual) < 1e-12
    # The distance of the neighbour, which is at 0.208, is known roughly.
    assert 0.1 < abs(values[1] - values[0]) < 0.4
    # Asked for what lies within 0.3, all are found.
    values, _ = inverse.nearest(4, None, 0.3)
    np.testing.assert_allclose(values, all_of_them, rtol=0, atol=1e-12)


def test_a_refusal_says_how_many_eigenvalues_stand_still():
    search = Refinement(RadialDiscretisation(LINEAR, 0.6), 6, 1e-10, Scale(1.0, 0.1), 1)
    still = Mode(-0.2 + 0.1j, np.ones(1), ONE, Truncation(1, 1), change=1e-5)
    moving = replace(still, eigenvalue=-0.3 + 0j, change=0.05)
    assert "slowest 2 are" in search.fewer([still, moving])
    assert "resolved" not in search.fewer([moving, still])
    assert "resolved" not in search.fewer(3 * [still])
