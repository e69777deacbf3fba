"""What has no hydrodynamic limit, and what does not fit, is refused."""

import math

import numpy as np
import pytest

from fpsolve.errors import DomainTooSmallError, GridMismatchError
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import Curve, MovingBelt, RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    FreePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit

MODEL = LayDownModel(QuadraticPotential(1.0, 0.8), 2.0, MovingBelt(0.1))
GRID = PlaneGrid((5.0, 4.0), (40, 32))


def narrow(xi1, xi2):
    return np.exp(-8 * ((xi1 - 0.7) ** 2 + (xi2 + 0.4) ** 2))


class SidewaysCurve(MovingBelt):
    """A belt of a user's own that also moves across."""

    def velocity(self, s):
        return np.full(np.shape(s), -self.speed), np.full(np.shape(s), 0.1)


class FastCurve(MovingBelt):
    """A curve of a user's own that forgot to check its speed."""

    def __post_init__(self):
        pass


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (
            LayDownModel(QuadraticPotential(), 0.0),
            r"`noise` must be positive for the limit of large noise, got 0; its small "
            r"parameter is ε = 1/A²\. For small noise see EnergyProcess\.",
        ),
        (
            LayDownModel(
                QuadraticPotential(),
                1.0,
                RotatingNozzle(speed=0.1, radius=1.0, angular_speed=1.0),
            ),
            r"`curve` must move at constant speed, got RotatingNozzle.*; the limit is "
            r"derived for γ' = −v e₁: use FixedBelt or MovingBelt\.",
        ),
        (
            LayDownModel(QuadraticPotential(), 1.0, SidewaysCurve(0.1)),
            "`curve` must move at constant speed, got SidewaysCurve",
        ),
        (
            LayDownModel(QuadraticPotential(), 1.0, FastCurve(1.5)),
            "`speed` must lie strictly between -1 and 1, got 1.5; a faster belt tears",
        ),
        (
            LayDownModel(FreePotential(), 1.0),
            r"`potential` must confine, got FreePotential\(\): exp\(-B\) has no finite",
        ),
        (
            LayDownModel(LinearPotential(2.0), 2.0, MovingBelt(0.5)),
            r"`speed` must be small enough for exp\(-B \+ A²v ξ1\) to be integrable, "
            r"below K/A² = 0.5, got 0.5 with A = 2 and LinearPotential\(slope=2.0\); "
            "slow the belt, lower the noise, or choose a potential that grows faster",
        ),
        (
            LayDownModel(PowerPotential(1.0, 0.5), 2.0, MovingBelt(-0.6)),
            "to be integrable, below K/A² = 0.5, got -0.6 with A = 2",
        ),
        (
            LayDownModel(
                IsotropicPotential(lambda r: 2 * r, lambda r: 2.0 + 0 * r),
                2.0,
                MovingBelt(0.6),
            ),
            r"`speed` must be small enough for exp\(-B \+ A²v ξ1\) to be integrable",
        ),
    ],
)
def test_models_without_a_limit_are_refused_with_the_condition(model, message):
    assert issubclass(FastCurve, Curve)
    with pytest.raises(ValueError, match=message):
        HydrodynamicLimit(model)


def test_just_below_the_limiting_speed_the_limit_exists():
    model = LayDownModel(LinearPotential(2.0), 2.0, MovingBelt(0.4999))
    assert HydrodynamicLimit(model).equilibrium(0.0, 0.0) > 0


def test_arguments_of_other_kinds_are_refused():
    with pytest.raises(
        TypeError, match=r"`model` must be a LayDownModel or a Smooth.*1"
    ):
        HydrodynamicLimit(1)
    limit = HydrodynamicLimit(MODEL)
    start = GRID.evaluate(narrow)
    with pytest.raises(TypeError, match="`grid` must be a PlaneGrid or a PhaseSpaceGr"):
        limit.steady_state((4, 4))
    with pytest.raises(GridMismatchError, match=r"`P0` must have the shape \(40, 32\)"):
        limit.solve(start.T, (0.0, 1.0), 0.5, grid=GRID)
    with pytest.raises(ValueError, match="`P0` must be finite, got NaN or infinity"):
        limit.solve(start * np.nan, (0.0, 1.0), 0.5, grid=GRID)
    with pytest.raises(ValueError, match="`P0` must have positive mass, got 0"):
        limit.solve(0.0 * start, (0.0, 1.0), 0.5, grid=GRID)
    with pytest.raises(ValueError, match="`ds` must divide the span 1 into whole"):
        limit.solve(start, (0.0, 1.0), 0.3, grid=GRID)
    with pytest.raises(ValueError, match="`method` must be one of 'backward_euler', "):
        limit.solve(start, (0.0, 1.0), 0.5, grid=GRID, method="heun")
    with pytest.raises(ValueError, match="`boundary_tolerance` must be positive and"):
        limit.solve(start, (0.0, 1.0), 0.5, grid=GRID, boundary_tolerance=math.nan)
    with pytest.raises(ValueError, match="`grid` must be given for a potential that"):
        HydrodynamicLimit(LayDownModel(LinearPotential(), 1.0)).gap()


def test_a_box_that_is_too_small_is_noticed_and_the_run_comes_along():
    limit, grid = HydrodynamicLimit(MODEL), PlaneGrid(2.0, (20, 20))
    with pytest.raises(DomainTooSmallError, match=r"boundary mass .* exceeds toler"):
        limit.steady_state(grid)
    with pytest.raises(DomainTooSmallError, match="enlarge `half_width`") as caught:
        limit.solve(narrow, (0.0, 5.0), 0.5, grid=grid)
    assert caught.value.s > 0
    assert caught.value.solution.s[-1] == 5.0
