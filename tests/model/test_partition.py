"""Z and its error: exact values of many shapes, wherever their wells lie."""

import math
from functools import cache

import numpy as np
import pytest
from mixtures import Mixture, random_mixture, two_wells
from scipy import stats

import fpsolve as fp
from fpsolve.model.potentials.nodes import gibbs_nodes
from fpsolve.model.potentials.partition import normalisation_of
from fpsolve.paths import EquilibriumLaw


@pytest.mark.parametrize("seed", range(30))
def test_z_of_a_mixture_is_one_to_the_error_reported(seed):
    mixture = random_mixture(seed)
    found = normalisation_of(mixture.value)
    # Rounding of the value itself, a few units, is not an error of the quadrature.
    miss = abs(math.expm1(found.log_value + mixture.constant))
    assert miss <= found.error + 1e-13
    assert found.error < 1e-6


def ring(radius, width, centre):
    def value(xi1, xi2):
        return ((np.hypot(xi1 - centre, xi2) - radius) / width) ** 2 / 2

    ratio = radius / width
    tail = ratio * math.sqrt(2 * math.pi) * stats.norm.cdf(ratio)
    return value, 2 * math.pi * width**2 * (math.exp(-(ratio**2) / 2) + tail)


SHAPES = {
    "Gaussian": (lambda x, y: (x * x + y * y) / 2, 2 * math.pi),
    "tiny": (lambda x, y: (x * x + y * y) / 2e-12, 2e-12 * math.pi),
    "off centre": (lambda x, y: ((x - 1e4) ** 2 + y * y) / 2, 2 * math.pi),
    "long valley": (lambda x, y: (x * x + (y / 1e3) ** 2) / 2, 2e3 * math.pi),
    "diagonal valley": (
        lambda x, y: ((x - y) ** 2 + ((x + y) / 100) ** 2) / 4,
        200 * math.pi,
    ),
    "curved valley": (
        lambda x, y: x * x / 2 + 50 * (y - x * x) ** 2,
        2 * math.pi / 10,
    ),
    "ring": ring(50.0, 0.5, 10.0),
    "plateau": (
        lambda x, y: np.maximum(np.hypot(x, y) - 5, 0.0) ** 2,
        math.pi * 26 + 5 * math.pi**1.5,
    ),
    "kinks": (lambda x, y: np.abs(x - 0.3) + np.abs(y - 0.17), 4.0),
    "wall": (
        lambda x, y: np.hypot(x, y) ** 400 / 400,
        2 * math.pi * 400 ** (2 / 400 - 1) * math.gamma(2 / 400),
    ),
    "square wall": (lambda x, y: x**60 + y**60, (2 * math.gamma(1 + 1 / 60)) ** 2),
    "six logarithms": (lambda x, y: 6 * np.log1p(np.hypot(x, y)), math.pi / 10),
    # The tail beyond all rings is a power, a fifth of the whole in the second case.
    "three logarithms": (lambda x, y: 1.5 * np.log1p(x * x + y * y), 2 * math.pi),
    "hardly": (
        lambda x, y: 2.1 * np.log1p(np.hypot(x, y)),
        2 * math.pi * (1 / 0.1 - 1 / 1.1),
    ),
    "two wells": (two_wells(16.0).value, 1.0),
    "two far wells": (two_wells(1e5).value, 1.0),
    "narrow and far": (two_wells(50.0, width=0.1).value, 1.0),
}


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_z_of_shapes_known_in_closed_form(name):
    value, exact = SHAPES[name]
    found = normalisation_of(value)
    assert found.integral * math.exp(-found.lowest) == pytest.approx(
        exact, rel=found.error + 1e-13
    )
    assert found.error < 1e-6


def test_what_has_no_integral_is_told_from_what_has_no_accuracy():
    for endless in (
        lambda x, y: 0 * x,
        lambda x, y: x * x / 2 + 0 * y,
        lambda x, y: -(x * x) - y * y,
        lambda x, y: -np.exp(np.hypot(x, y)),
        lambda x, y: 2 * np.log1p(np.hypot(x, y)),
    ):
        assert normalisation_of(endless).integral == math.inf
    # A jump across the cells: the error falls like their size only.
    with pytest.raises(ValueError, match=r"got 2\.10.* with error .*smooth B, scale"):
        normalisation_of(lambda x, y: x * x + y * y + 2 * (x + y > 0.3))


def test_a_formula_that_overflows_far_out_is_not_asked_there():
    cut = normalisation_of(
        lambda x, y: np.where(np.hypot(x, y) < 400, (x * x + y * y) / 2, np.nan)
    )
    assert cut.log_value == pytest.approx(math.log(2 * math.pi), abs=1e-12)


@pytest.mark.parametrize("distance", [16.0, 18.0, 300.0])
def test_the_equilibrium_law_visits_every_well_with_its_weight(distance):
    n = 40_000
    law = EquilibriumLaw(two_wells(distance).potential())
    xi, _ = law.sample(np.random.default_rng(1), n)
    far = xi[:, 0] > distance / 2
    # Four standard errors of a share of 0.7.
    assert abs(far.mean() - 0.7) < 4 * math.sqrt(0.21 / n)
    for part in (xi[far, 0] - distance, xi[far, 1], *xi[~far].T):
        assert stats.kstest(part, "norm").pvalue > 1e-3


def test_narrow_wells_and_rings_are_sampled_as_they_are():
    n = 40_000
    mixture = Mixture((0.2, 0.8), ((3, 4), (-1, 0)), (0.0009 * np.eye(2), np.eye(2)))
    xi, _ = EquilibriumLaw(mixture.potential()).sample(np.random.default_rng(2), n)
    near = np.hypot(xi[:, 0] - 3, xi[:, 1] - 4) < 0.15
    assert abs(near.mean() - 0.2) < 4 * math.sqrt(0.16 / n)
    assert stats.kstest((xi[near, 0] - 3) / 0.03, "norm").pvalue > 1e-3
    circle = fp.IsotropicPotential(
        lambda r: 200 * (r - 5) ** 2, lambda r: 400 * (r - 5)
    )
    xi, _ = EquilibriumLaw(circle).sample(np.random.default_rng(3), n)
    # r exp(-200 (r - 5)²): mean 5 + variance/5, variance 1/400 to the next order.
    r = np.hypot(*xi.T)
    assert abs(r.mean() - 5.0005) < 4 * 0.05 / math.sqrt(n)
    assert stats.kstest(np.arctan2(xi[:, 1], xi[:, 0]) / np.pi, "uniform",
                        (-1, 2)).pvalue > 1e-3  # fmt: skip


def test_a_potential_with_a_power_tail_is_integrated_but_not_sampled():
    slow = fp.IsotropicPotential(
        lambda r: 1.5 * np.log1p(r**2), lambda r: 3 * r / (1 + r**2)
    )
    assert slow.partition_function == pytest.approx(2 * math.pi, rel=1e-9)
    with pytest.raises(ValueError, match=r"must grow fast enough to be sampled, got"):
        EquilibriumLaw(slow)


def test_nodes_know_moments_and_what_lies_outside():
    nodes = gibbs_nodes(two_wells(8.0).potential())
    assert nodes.mean() == pytest.approx((5.6, 0.0), abs=1e-9)
    exact = math.sqrt(1 + 0.21 * 64), 1.0
    assert nodes.deviations() == pytest.approx(exact, rel=1e-9)
    # Wells apart: E|∂B|² is that of one of them, but for what lies on the saddle, an
    # e^{-8} of it or so with slopes of four.
    assert nodes.mean_square_forces() == pytest.approx((1.0, 1.0), rel=5e-3)
    outside = 0.7 * stats.norm.sf(2.0) + 0.3 * stats.norm.sf(10.0)
    # A node in twenty falls on one side of the edge or the other.
    assert nodes.outside((10.0, 50.0)) == pytest.approx(outside, rel=0.1)


@cache
def results(constant):
    """Of every kind, for a potential to which so much is added."""
    potential = fp.CallablePotential(
        lambda x, y: ((x - 0.5) ** 2 + 2 * y * y) / 2 + constant,
        lambda x, y: (x - 0.5, 2 * y),
    )
    grid = fp.PhaseSpaceGrid(6.0, (24, 24, 8))
    model = fp.LayDownModel(potential, 1.0)
    p0 = fp.initial.gaussian(grid)
    run = fp.solve(fp.drift_kick(model, grid), p0, (0.0, 0.5), 0.25)
    points, _ = EquilibriumLaw(potential).sample(np.random.default_rng(1), 100)
    moving = fp.LayDownModel(potential, 1.0, fp.MovingBelt(0.1))
    return (
        model.equilibrium(*grid.plane()),
        run.relative_entropy,
        points,
        fp.HydrodynamicLimit(moving).equilibrium(*grid.plane()),
        np.array(fp.suggest_grid(model).half_widths),
    )


@pytest.mark.parametrize("constant", [-1e4, -800.0, 800.0, 1e4])
def test_nothing_depends_on_a_constant_added_to_b(constant):
    # B is known to the rounding of the constant, 1e4 eps.
    for one, other in zip(results(0.0), results(constant), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-11)


def test_rates_do_not_depend_on_a_constant_added_to_b():
    def model(by):
        quartic = fp.IsotropicPotential(lambda r: r**4 / 4 + by, lambda r: r**3)
        return fp.LayDownModel(quartic, 1.0)

    gaps = [float(fp.spectral_gap(model(by))) for by in (0.0, -1e4)]
    assert gaps[0] == pytest.approx(gaps[1], rel=1e-10)


@pytest.mark.parametrize("constant", [-800.0, 800.0])
def test_energies_beyond_floats_are_refused(constant):
    deep = fp.IsotropicPotential(lambda r: r**2 / 2 + constant, lambda r: r)
    with pytest.raises(ValueError, match=r"near zero at its minimum .* subtract the"):
        fp.EnergyProcess(deep, 0.1)
