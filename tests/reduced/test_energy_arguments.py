"""What an energy process refuses: potentials, noises and energies, and why."""

import math

import numpy as np
import pytest
from energy_processes import PROCESSES

from fpsolve.model.potentials import (
    FreePotential,
    IsotropicPotential,
    QuadraticPotential,
)
from fpsolve.reduced.energy import EnergyProcess


def two_wells(r):
    # r B' - 1 = (y + 1) y (y - 1) in y = ln r: circles at 1/e, 1 and e.
    y = np.log(np.maximum(r, 1e-300))
    return y + y**4 / 4 - y**2 / 2


def two_wells_derivative(r):
    y = np.log(r)
    return (1.0 + y**3 - y) / r


@pytest.mark.parametrize(
    ("potential", "message"),
    [
        (
            QuadraticPotential(1.0, 2.0),
            r"`potential` must be isotropic for an energy .*, got Quadratic.*\(13\)",
        ),
        (FreePotential(), r"single well.*exactly one radius, got FreePotential.*none"),
        (
            IsotropicPotential(two_wells, two_wells_derivative),
            r"exactly one radius, got .* with 0\.\d+, (0\.9|1)\d*, 2\.\d+; the energy",
        ),
        (
            IsotropicPotential(
                lambda r: 0.9 * np.log1p(r**2), lambda r: 1.8 * r / (1 + r**2)
            ),
            r"`potential` must be normalisable for an energy .*, got .*; choose one",
        ),
    ],
)
def test_a_potential_without_one_well_is_refused(potential, message):
    with pytest.raises(ValueError, match=message):
        EnergyProcess(potential, 1.0)


def test_a_function_is_not_a_potential():
    with pytest.raises(
        TypeError, match=r"must be a Potential, got .*IsotropicPotential"
    ):
        EnergyProcess(two_wells, 1.0)


@pytest.mark.parametrize("noise", [0.0, -1.0, math.nan, math.inf])
def test_noise_must_be_positive(noise):
    with pytest.raises(ValueError, match="`noise` must be positive and finite, got"):
        EnergyProcess(QuadraticPotential(), noise)


@pytest.mark.parametrize("g", [0.7, -0.7, math.nan, [0.1, 0.7]])
def test_energies_outside_are_refused_with_the_interval(g):
    process = PROCESSES["quadratic"]
    for function in (process.period, process.variance, process.turning_points):
        with pytest.raises(
            ValueError, match=r"`g` must lie in \[-0\.6065\d*, 0\.6065\d*\], .*`g_max`"
        ):
            function(g)
    with pytest.raises(ValueError, match=r"`g` must lie in \[0, 0\.6065"):
        process.stationary_density(-0.1)


def test_the_orbit_of_energy_zero_does_not_close():
    with pytest.raises(ValueError, match="`g` must not be 0 for an orbit, got 0"):
        PROCESSES["quadratic"].orbit(0.0)
    with pytest.raises(ValueError, match="`n_points` must be at least 2, got 1"):
        PROCESSES["quadratic"].orbit(0.1, 1)


def test_the_process_says_what_it_is():
    text = "EnergyProcess(LinearPotential(slope=1.0), noise=1.3)"
    assert repr(PROCESSES["linear"]) == text
