"""Wells between the nodes of the quadrature: named, met on a grid, or refused."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from mixtures import Mixture

import fpsolve as fp
from fpsolve.model.potentials import Potential
from fpsolve.model.potentials.evidence import check_wells_met
from fpsolve.model.potentials.partition import normalisation_of
from fpsolve.paths import EquilibriumLaw
from fpsolve.reduced.hydrodynamic.effective_potential import EffectivePotential

GRID = fp.PhaseSpaceGrid(6.0, (64, 64, 4))
# The centre of a cell.
PLACE = (float(GRID.xi1[45]), float(GRID.xi2[40]))


def narrow(width=1e-3, share=0.4, place=PLACE):
    """A well of width one at the origin, and a narrow one far from it; Z = 1."""
    covariances = np.eye(2), width**2 * np.eye(2)
    return Mixture((1 - share, share), ((0.0, 0.0), place), covariances)


def scattered(seed):
    """Two to four wells of widths 0.003 to 2, up to a hundred apart."""
    rng = np.random.default_rng(seed)
    k, reach = rng.integers(2, 5), 10 ** rng.uniform(0, 2)
    widths = 10 ** rng.uniform(-2.5, 0.3, k)
    covariances = widths[:, None, None] ** 2 * np.eye(2)
    return Mixture(rng.dirichlet(np.ones(k)), reach * rng.normal(size=(k, 2)),
                   covariances)  # fmt: skip


@pytest.mark.parametrize("seed", [0, 12, 28, 112, 146, 256])
def test_z_counts_every_well_whose_place_is_named(seed):
    mixture = scattered(seed)
    found = normalisation_of(mixture.value, well_places=mixture.means)
    # Rounding of the value: places a hundred units away, in units of widths of 0.003.
    assert abs(math.expm1(found.log_value)) <= found.error + 1e-12
    assert found.error < 1e-10


def test_the_place_of_a_well_need_not_be_exact():
    mixture = narrow()
    for widths in (0.5, 3.0):
        place = np.array([PLACE]) + widths * 1e-3 * np.array([0.6, -0.8])
        found = normalisation_of(mixture.value, well_places=place)
        assert found.log_value == pytest.approx(0.0, abs=1e-10)


def test_naming_what_is_found_anyway_changes_nothing():
    mixture = narrow(width=0.5)
    found = normalisation_of(mixture.value)
    named = normalisation_of(mixture.value, well_places=mixture.means)
    assert found.log_value == pytest.approx(named.log_value, abs=1e-11)


@pytest.mark.parametrize("ratio", [2e-3, 5e-3])
def test_a_well_is_found_alone_from_a_five_hundredth_of_its_distance_on(ratio):
    rng = np.random.default_rng(3)
    for _ in range(3):
        r, angle = 10 ** rng.uniform(-0.5, 1.5), rng.uniform(0, 2 * np.pi)
        place = r * math.cos(angle), r * math.sin(angle)
        found = normalisation_of(narrow(ratio * r, 0.3, place).value)
        assert abs(math.expm1(found.log_value)) <= found.error + 1e-12


@pytest.fixture(scope="module")
def unnamed():
    return narrow().potential()


def test_a_well_that_the_grid_meets_and_z_misses_is_refused(unnamed):
    """The offset of H was wrong by ln Z, and H fell below zero, without a word."""
    assert math.exp(unnamed.log_partition_function) == pytest.approx(0.6, abs=1e-9)
    model = fp.LayDownModel(unnamed, 1.0)
    message = (
        rf"must count every well, got one at about xi = \({PLACE[0]:.6g}, "
        rf"{PLACE[1]:.6g}\).* integral of 1\.66667 times .* name the place, `well_p"
    )
    with pytest.raises(ValueError, match=message):
        model.equilibrium(*GRID.plane())
    with pytest.raises(ValueError, match="must count every well"):
        model.equilibrium(*PLACE)
    moving = fp.LayDownModel(unnamed, 1.0, fp.MovingBelt(0.01))
    with pytest.raises(ValueError, match="must count every well"):
        fp.HydrodynamicLimit(moving).equilibrium(*GRID.plane())
    p0 = fp.initial.gaussian(GRID)
    with pytest.raises(ValueError, match="must count every well"):
        fp.solve(fp.drift_kick(model, GRID), p0, (0.0, 0.1), 0.1)


def test_named_on_the_potential_it_is_counted_everywhere():
    mixture = narrow(width=0.01)
    named = fp.CallablePotential(mixture.value, mixture.gradient, well_places=[PLACE])
    assert named.log_partition_function == pytest.approx(0.0, abs=1e-10)
    assert f"well_places=[({PLACE[0]}, {PLACE[1]})]" in repr(named)
    assert named == fp.CallablePotential(
        named._value, named._gradient, well_places=np.array([PLACE])
    )
    assert named != mixture.potential()
    check_wells_met(named, *GRID.plane())
    # ∫ e^{−B + wξ₁} is the moment generating function of the mixture.
    phi = EffectivePotential(named, 0.01)
    wide = 0.6 * math.exp(0.01**2 / 2)
    far = 0.4 * math.exp(0.01 * PLACE[0] + (0.01 * 0.01) ** 2 / 2)
    assert phi.log_normalisation == pytest.approx(math.log(wide + far), abs=1e-10)
    n = 10_000
    xi, _ = EquilibriumLaw(named).sample(np.random.default_rng(1), n)
    near = np.hypot(*(xi - PLACE).T) < 0.1
    # Four standard errors of a share of 0.4.
    assert abs(near.mean() - 0.4) < 4 * math.sqrt(0.24 / n)


def test_a_narrow_ring_has_a_radius_to_be_named():
    radius, width = 3.0, 1e-5

    def share(r):
        return 1e3 * np.exp(-((r - radius) ** 2) / (2 * width**2))

    def value(r):
        return r**2 / 2 - np.log1p(share(r))

    def derivative(r):
        return r + share(r) * (r - radius) / width**2 / (1 + share(r))

    plain = fp.IsotropicPotential(value, derivative)
    named = fp.IsotropicPotential(value, derivative, well_radii=[radius])
    # The ring adds ∫ r e^{−r²/2} share(r) dr, 2π of it, to the order width³.
    ring = 1e3 * math.sqrt(2 * math.pi) * width * radius * math.exp(-(radius**2) / 2)
    exact = 2 * math.pi * (1 + ring)
    assert named.partition_function == pytest.approx(exact, rel=1e-9)
    assert "well_radii=[3.0]" in repr(named)
    assert plain.partition_function < exact * (1 - 1e-6)
    with pytest.raises(ValueError, match="must count every well"):
        check_wells_met(plain, np.array([0.0, radius]), 0.0)
    check_wells_met(named, np.array([0.0, radius]), 0.0)


@pytest.mark.parametrize(
    ("places", "error"),
    [
        ([1.0, 2.0], ValueError),
        ([(1.0, 2.0, 3.0)], ValueError),
        ([(1.0, math.nan)], ValueError),
        ([("x", 2.0)], TypeError),
    ],
)
def test_a_place_is_a_pair_of_numbers(places, error):
    mixture = narrow()
    with pytest.raises(error, match=r"`well_places` must (be finite places|hold real)"):
        fp.CallablePotential(mixture.value, mixture.gradient, well_places=places)
    with pytest.raises(ValueError, match="`well_radii` must be finite"):
        fp.IsotropicPotential(lambda r: r**2, lambda r: 2 * r, well_radii=[math.inf])


@pytest.mark.parametrize("seed", [3, 7])
def test_a_rough_landscape_is_its_own_evidence(seed):
    """Many low places on the grid, all of them counted: nothing is refused."""
    rng = np.random.default_rng(seed)
    k1, k2, phase = rng.uniform(2, 5, (3, 4))

    def value(x, y):
        waves = zip(k1, k2, phase, strict=True)
        return (x * x + y * y) / 2 + sum(np.cos(a * x + b * y + c) for a, b, c in waves)

    potential = fp.CallablePotential(value, lambda x, y: _slopes(value, x, y))
    check_wells_met(potential, *GRID.plane())


def _slopes(value, x, y, h=1e-5):
    return (
        (value(x + h, y) - value(x - h, y)) / (2 * h),
        (value(x, y + h) - value(x, y - h)) / (2 * h),
    )


def test_cells_too_coarse_for_p_s_are_told():
    """Z is right, but the cell on the well counts it for its whole area."""
    mixture = narrow(width=0.02)
    named = fp.CallablePotential(mixture.value, mixture.gradient, well_places=[PLACE])
    model = fp.LayDownModel(named, 1.0)
    p0 = fp.initial.gaussian(GRID)
    # The sum over the cells: 0.6, and the peak 0.4/(2π 0.02²) on one cell.
    mass = 0.6 + 0.4 * GRID.spacing[0] * GRID.spacing[1] / (2 * math.pi * 0.02**2)
    with pytest.warns(UserWarning, match=rf"resolve p_S, got a mass of {mass:.4g}"):
        run = fp.solve(fp.drift_kick(model, GRID), p0, (0.0, 0.1), 0.1)
    assert run.entropy_floor == pytest.approx(-math.log(mass), rel=1e-9)


@dataclass(frozen=True)
class Spring(Potential):
    """B = ‖ξ‖²/(2c²), whose Z the class says itself."""

    scale: float
    said: float
    formula = latex = "B"

    @property
    def partition_function(self):
        """Z."""
        return self.said

    def value(self, xi1, xi2):
        """B."""
        return (np.square(xi1) + np.square(xi2)) / (2 * self.scale**2)

    def gradient(self, xi1, xi2):
        """∇B."""
        pair = np.broadcast_arrays(xi1, xi2)
        return tuple(one / self.scale**2 for one in pair)


@pytest.mark.parametrize("scale", [1e-20, 1.0, 1e30])
def test_the_z_of_an_own_class_is_that_of_its_potential(scale):
    right = 2 * math.pi * scale**2
    assert Spring(scale, right).log_partition_function == math.log(right)
    for wrong in (2 * right, right * (1 + 1e-5)):
        with pytest.raises(ValueError, match="must be the integral of exp"):
            _ = Spring(scale, wrong).normalisation
    with pytest.raises(ValueError, match="`partition_function` must be positive and"):
        _ = Spring(scale, -right).normalisation


@dataclass(frozen=True)
class Claim(Potential):
    """B = (ξ₁² + k ξ₂²)/2, of which isotropy and a slope are claimed."""

    stiffness: float = 4.0
    isotropic: bool = False
    slope: float = 1.0
    scale: float = 1.0
    formula = latex = "B"

    def value(self, xi1, xi2):
        """B."""
        squares = np.square(xi1) + self.stiffness * np.square(xi2)
        return squares / (2 * self.scale**2)

    def gradient(self, xi1, xi2):
        """∇B, times a factor in one direction."""
        one, two = np.broadcast_arrays(xi1, xi2)
        return self.slope * one / self.scale**2, self.stiffness * two / self.scale**2


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e4])
def test_a_class_that_says_it_is_isotropic_is_taken_at_its_values(scale):
    """Z was that of the profile at one angle: 2π instead of π."""
    with pytest.raises(ValueError, match="`isotropic` must be false unless B depends"):
        _ = Claim(4.0, True, scale=scale).partition_function
    exact = math.pi * scale**2
    assert Claim(scale=scale).partition_function == pytest.approx(exact, rel=1e-10)
    assert Claim(1.0, True, scale=scale).partition_function == pytest.approx(2 * exact)


@pytest.mark.parametrize("slope", [-1.0, 2.0, 0.0])
@pytest.mark.parametrize("scale", [1e-6, 1.0, 10.0])
def test_a_class_whose_gradient_is_another_is_no_model(slope, scale):
    """H rose, which the run saw; averages over paths are wrong without a word."""
    message = (
        r"`gradient` of the potential must be that of its `value`, got component 0"
    )
    with pytest.raises(ValueError, match=message):
        fp.LayDownModel(Claim(slope=slope, scale=scale), 1.0)
    assert fp.LayDownModel(Claim(scale=scale), 1.0)


def test_a_gradient_of_fine_ripples_is_that_of_its_potential():
    """Differences over steps longer than the ripples say nothing."""

    class Ripples(Claim):
        def value(self, xi1, xi2):
            return super().value(xi1, xi2) + 0.1 * np.sin(np.divide(xi1, 1e-5))

        def gradient(self, xi1, xi2):
            one, two = super().gradient(xi1, xi2)
            return one + 1e4 * np.cos(np.divide(xi1, 1e-5)), two

    assert fp.LayDownModel(Ripples(), 1.0)
