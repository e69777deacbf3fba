"""⟨f⟩(g), averages over the orbits of the motion without noise."""

import numpy as np
import pytest
from energy_processes import PROCESSES

from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess

SHARES = np.array([0.05, 0.3, 0.7, 0.95])
PROCESS = EnergyProcess(QuadraticPotential(), 1.0)


@pytest.mark.parametrize("name", PROCESSES)
def test_the_variance_is_the_average_of_the_squared_cotangent(name):
    process = PROCESSES[name]
    g = SHARES * process.g_max

    def integrand(r, beta):
        return 1.0 / np.tan(beta) ** 2

    average = process.noise**2 * g**2 * process.orbit_average(integrand, g)
    # The same points as the closed form.
    np.testing.assert_allclose(average, process.variance(g), rtol=1e-9)


@pytest.mark.parametrize("name", PROCESSES)
def test_a_derivative_along_the_motion_has_the_average_zero(name):
    # d(r cos β)/ds = 1 - r B'(r) sin²β along (13).
    process = PROCESSES[name]

    def derivative(r, beta):
        slope = process.potential.radial_derivative(r)
        return 1.0 - r * slope * np.sin(beta) ** 2

    averages = process.orbit_average(derivative, SHARES * process.g_max)
    np.testing.assert_allclose(averages, 0.0, atol=1e-7)


def test_it_agrees_with_a_mean_along_the_integrated_orbit():
    for g in (0.2, -0.2):
        orbit = PROCESS.orbit(g, 1025)

        def f(r, beta):
            return np.exp(-r) * np.sin(beta) + np.cos(beta) ** 2

        along = np.mean(f(orbit.r[:-1], orbit.beta[:-1]))
        # The orbit is integrated to 1e-12, and means of periodic functions converge
        # geometrically.
        assert PROCESS.orbit_average(f, g) == pytest.approx(along, abs=1e-9)


def test_a_constant_is_its_own_average_in_any_shape():
    g = np.array([[0.1, 0.2], [-0.3, 0.5]])
    averages = PROCESS.orbit_average(lambda r, beta: np.full(r.shape, 2.5), g)
    assert averages.shape == g.shape
    np.testing.assert_allclose(averages, 2.5, rtol=1e-14)


@pytest.mark.parametrize("g", [0.0, PROCESS.g_max, [0.1, 0.0]])
def test_orbits_without_a_period_or_an_extent_are_refused(g):
    with pytest.raises(ValueError, match="`g` must be neither 0 nor ±g_max"):
        PROCESS.orbit_average(lambda r, beta: r, g)


def test_energies_outside_are_refused():
    with pytest.raises(ValueError, match="`g` must lie in"):
        PROCESS.orbit_average(lambda r, beta: r, 1.0)
