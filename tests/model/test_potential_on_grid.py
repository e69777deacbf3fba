"""A potential is looked at where it is used: value, gradient, shape, kind of number."""

from dataclasses import dataclass

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import initial
from fpsolve.interop.differences import phase_space_rate, plane_rate
from fpsolve.model.potentials import Potential
from fpsolve.model.potentials.at_points import gradient_at, value_at

ODD = fp.PhaseSpaceGrid(3.0, (9, 9, 8))
EVEN = fp.PhaseSpaceGrid(3.0, (8, 8, 8))


def distance(x, y):
    return np.sqrt(x**2 + y**2)


def towards(x, y):
    """∇‖ξ‖ by hand: 0/0 at the origin."""
    with np.errstate(invalid="ignore"):
        return x / distance(x, y), y / distance(x, y)


KINK = fp.CallablePotential(distance, towards)
OVERFLOWING = fp.PowerPotential(400.0)
USES = {
    "drift_kick": lambda model, grid: fp.drift_kick(model, grid),
    "balanced": lambda model, grid: fp.drift_kick(model, grid, balanced=True),
    "semi_lagrangian": lambda model, grid: fp.semi_lagrangian(model, grid),
    "suggest_step": lambda model, grid: fp.suggest_step(model, grid),
    "steady_state": lambda model, grid: fp.steady_state(
        # Of a small box; what is asked is whether it answers at all.
        model,
        grid,
        boundary_tolerance=1.0,
        error_tolerance=1.0,
    ),
    "differences": lambda model, grid: plane_rate(model, fp.PlaneGrid.of(grid)),
}
# Differences take ∇B between the cells.
ON_CELLS = [name for name in USES if name != "differences"]


@pytest.mark.parametrize("use", ON_CELLS)
def test_a_kink_at_a_node_is_refused_with_the_cell_and_a_remedy(use):
    model = fp.LayDownModel(KINK, 1.0)
    with pytest.raises(ValueError, match=r"`potential` must be finite wherever it is used, got ∇B = nan, nan at xi = \(0, 0\), cell \(4, 4\); define it there \(`np.where`\), or take an even number of cells"):  # fmt: skip  # noqa: E501
        USES[use](model, ODD)
    assert USES[use](model, EVEN) is not None


@pytest.mark.parametrize("use", ON_CELLS)
def test_an_overflow_far_out_is_refused_with_the_cell_and_a_remedy(use):
    model = fp.LayDownModel(OVERFLOWING, 1.0)
    wide = fp.PhaseSpaceGrid(6.5, (8, 8, 8))
    with pytest.raises(ValueError, match=r"got (B = inf|∇B = -?inf, -?inf) at xi = \(-5\.6875, -5\.6875\), cell \(0, 0\); it overflows there: choose a smaller `half_width`"):  # fmt: skip  # noqa: E501
        USES[use](model, wide)


def test_differences_between_cells_look_at_the_faces():
    model = fp.LayDownModel(OVERFLOWING, 1.0)
    wide = fp.PlaneGrid(6.5, (8, 8))
    with pytest.raises(ValueError, match=r"got ∇B = .* face \(0, 0\); it overflows"):
        plane_rate(model, wide)
    steep = fp.LayDownModel(fp.PowerPotential(60.0), 1.0)
    with pytest.raises(ValueError, match=r"`grid` must resolve exp\(-B\), got B that changes by [\d.e+]+ in half a cell; take more cells"):  # fmt: skip  # noqa: E501
        phase_space_rate(steep, fp.PhaseSpaceGrid(2.5, (16, 16, 8)))


def test_the_value_is_looked_at_too():
    hollow = fp.CallablePotential(
        lambda x, y: np.where(distance(x, y) < 3.5, x**2 + y**2, np.inf),
        lambda x, y: (2 * x, 2 * y),
    )
    model, wide = fp.LayDownModel(hollow, 1.0), fp.PhaseSpaceGrid(4.0, (8, 8, 8))
    p0 = initial.gaussian(wide, variance=0.5)
    match = r"got B = inf at xi = \(-3\.5, -3\.5\), cell \(0, 0\); it overflows there"
    with pytest.raises(ValueError, match=match):
        fp.solve(fp.drift_kick(model, wide), p0, (0.0, 1.0), 0.5)
    with pytest.raises(ValueError, match=match):
        initial.equilibrium(wide, hollow)
    plane = fp.PlaneGrid.of(wide)
    with pytest.raises(ValueError, match=match):
        fp.HydrodynamicLimit(model).steady_state(plane)


def test_radial_potentials_define_the_force_at_the_origin():
    for potential in (fp.LinearPotential(), fp.PowerPotential(1.0)):
        assert gradient_at(potential, *ODD.plane())[0][4, 4] == 0.0


@pytest.mark.parametrize(
    "gradient",
    [
        lambda x, y: np.array([x, 2.0 * y]),
        lambda x, y: [x, 2.0 * y],
        lambda x, y: np.stack([x, y]) * np.array([1.0, 2.0]).reshape(2, *x.ndim * [1]),
    ],
    ids=["array", "list", "stacked"],
)
def test_a_gradient_may_be_one_array(gradient):
    # Accepted when it was built, and an error of numpy's on the first grid, before.
    one = fp.CallablePotential(lambda x, y: 0.5 * x**2 + y**2, gradient)
    pair = fp.CallablePotential(lambda x, y: 0.5 * x**2 + y**2, lambda x, y: (x, 2 * y))
    p0 = initial.gaussian(EVEN, variance=0.5)
    run = {"s_span": (0.0, 1.0), "ds": 0.5, "boundary_tolerance": 1.0}
    first, second = (
        fp.solve(fp.drift_kick(fp.LayDownModel(B, 1.0), EVEN), p0, **run).final
        for B in (one, pair)
    )
    np.testing.assert_array_equal(first, second)


def test_functions_see_points_of_one_shape_and_cannot_change_them():
    seen = []

    def value(x, y):
        seen.append((x.shape, y.shape, x.flags.writeable))
        return np.linalg.norm(np.array([x, y]), axis=0) ** 2 / 2

    potential = fp.CallablePotential(value, lambda x, y: (x, y))
    del seen[:]
    found = value_at(potential, *EVEN.plane())
    assert seen == [((8, 8), (8, 8), False)]
    np.testing.assert_allclose(found, np.hypot(*EVEN.plane()) ** 2 / 2, rtol=1e-15)


@dataclass(frozen=True)
class Handmade(Potential):
    """A potential whose functions are given unchecked."""

    values: object
    slopes: object
    formula, latex = "B", "B"

    def value(self, xi1, xi2):
        return self.values(xi1, xi2)

    def gradient(self, xi1, xi2):
        return self.slopes(xi1, xi2)


def square(x, y):
    return x**2 + y**2


@pytest.mark.parametrize(
    ("slopes", "error", "match"),
    [
        (lambda x, y: 2 * (x + y), ValueError, r"must return the pair .*got ndarray"),
        (lambda x, y: None, ValueError, r"must return the pair .*got NoneType"),
        (
            lambda x, y: (x, 1j * y),
            TypeError,
            r"`gradient` of the potential must return real numbers, got complex128",
        ),
        (lambda x, y: (x, "no"), TypeError, r"must return real numbers, got <U2"),
        (
            lambda x, y: (x[:-1] + y, y),
            ValueError,
            r"must work elementwise, got shape \(7, 8\) for points of shape \(8, 8\)",
        ),
        (
            lambda x, y: 2 * np.array([x, y]),
            ValueError,
            r"elementwise on arrays that broadcast, got ValueError \(.*\) for shapes "
            r"\(8, 1\) and \(1, 8\)",
        ),
        (lambda x, y: (x, y[0, 99]), ValueError, r"got IndexError"),
    ],
)
def test_what_a_class_of_ones_own_returns_is_checked(slopes, error, match):
    model = fp.LayDownModel(Handmade(square, slopes), 1.0)
    for build in (fp.drift_kick, fp.semi_lagrangian):
        with pytest.raises(error, match=match):
            build(model, EVEN)


def test_single_precision_and_whole_numbers_become_double():
    exact = Handmade(square, lambda x, y: (2 * x, 2 * y))
    coarse = Handmade(
        lambda x, y: np.float32(x**2 + y**2),
        lambda x, y: (np.float32(2 * x), np.zeros(np.shape(y), int)),
    )
    assert value_at(coarse, *EVEN.plane()).dtype == np.float64
    slope1, slope2 = gradient_at(coarse, *EVEN.plane())
    assert slope1.dtype == slope2.dtype == np.float64
    assert slope1.shape == slope2.shape == (8, 8)
    np.testing.assert_allclose(slope1, gradient_at(exact, *EVEN.plane())[0], rtol=1e-7)


def test_points_may_be_single_numbers():
    assert value_at(fp.QuadraticPotential(), 1.0, 2.0) == 2.5
    slope1, slope2 = gradient_at(fp.QuadraticPotential(), 1.0, 2.0)
    assert (float(slope1), float(slope2)) == (1.0, 2.0)
    with pytest.raises(ValueError, match=r"at xi = \(0, 0\), cell \(\)"):
        gradient_at(KINK, 0.0, 0.0)


def test_a_force_whose_square_overflows_where_the_density_is_gives_no_step():
    narrow = fp.LayDownModel(fp.QuadraticPotential(1e-75, 1e-75), 1.0)
    wide = fp.PhaseSpaceGrid(1e6, (8, 8, 8))
    with pytest.raises(ValueError, match=r"`grid` must resolve exp\(-B\), got a mean square of the force beyond all numbers; take more cells"):  # fmt: skip  # noqa: E501
        fp.suggest_step(narrow, wide)
    # Where no density is it does not matter.
    assert 0 < fp.suggest_step(fp.LayDownModel(fp.PowerPotential(300.0), 1.0), EVEN) < 1
