"""The contract of every reference curve, and what is particular to each."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import (
    EllipticNozzle,
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
    TabulatedCurve,
    curve_from_dict,
)
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential
from fpsolve.paths import sample_paths

TABLE_S = np.linspace(-10.0, 1010.0, 2041)
NAMED = [
    FixedBelt(),
    MovingBelt(speed=0.1),
    RotatingNozzle(speed=0.1, radius=2.0, angular_speed=0.5, phase=0.3),
    OscillatingNozzle(speed=0.0, amplitude=2.0, angular_speed=0.05),
    EllipticNozzle(speed=-0.2, radius1=2.0, radius2=0.5, angular_speed=-0.7, phase=1.0),
]
TABULATED = TabulatedCurve(TABLE_S, np.cos(TABLE_S / 5), -0.01 * TABLE_S)
FAMILY = [*NAMED, TABULATED]

arclengths = st.floats(0.0, 1000.0)


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
@given(s=arclengths)
def test_velocity_is_the_derivative_of_the_position(curve, s):
    step = 1e-4
    velocity = curve.velocity(s)
    # Truncation step² γ'''/6, below 1e-8 here; rounding eps |γ|/step = 2e-10.
    for axis in range(2):
        difference = curve.position(s + step)[axis] - curve.position(s - step)[axis]
        assert velocity[axis] == pytest.approx(difference / (2 * step), abs=1e-8)


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
@given(s0=arclengths, s1=arclengths)
def test_displacement_is_the_difference_of_positions(curve, s0, s1):
    displacement = curve.displacement(s0, s1)
    for axis in range(2):
        difference = curve.position(s1)[axis] - curve.position(s0)[axis]
        # Positions reach 200, angles 700: rounding of the difference, some 1e-13.
        assert displacement[axis] == pytest.approx(float(difference), abs=1e-11)


@pytest.mark.parametrize("curve", NAMED, ids=repr)
@given(s0=st.floats(1e5, 1e6), step=st.floats(1e-7, 1e-5))
def test_displacement_over_a_short_step_far_out_keeps_its_digits(curve, s0, step):
    s1 = s0 + step
    # (γ(s1) - γ(s0)) through two positions of size 1e5 would be wrong by 1e-11.
    midpoint = curve.velocity(0.5 * (s0 + s1))
    for part, slope in zip(curve.displacement(s0, s1), midpoint, strict=True):
        # Midpoint rule: step³ γ'''/24 < 1e-16; the angle ωs is only known to
        # eps * 7e5 = 1e-10, which turns the velocity by that much.
        assert part == pytest.approx(float(slope) * (s1 - s0), rel=1e-8, abs=1e-15)


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
def test_displacement_consists_of_plain_floats(curve):
    assert [type(part) for part in curve.displacement(0.0, 1.0)] == [float, float]


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
@pytest.mark.parametrize("shape", [(), (4,), (2, 3)])
def test_position_and_velocity_have_the_shape_of_s(curve, shape):
    s = np.arange(math.prod(shape)).reshape(shape)
    for array in (*curve.position(s), *curve.velocity(s)):
        assert np.shape(array) == shape
        assert array.dtype == np.float64


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
def test_a_curve_is_autonomous_when_its_velocity_is_constant(curve):
    velocities = np.array(curve.velocity(np.linspace(0.0, 50.0, 101)))
    constant = bool(np.all(velocities == velocities[:, :1]))
    assert curve.autonomous is constant
    assert curve.fixed is bool(np.all(velocities == 0))


@pytest.mark.parametrize("curve", NAMED, ids=repr)
def test_the_belt_speed_is_the_mean_of_minus_the_first_velocity(curve):
    # The mean over whole periods of every nozzle above.
    periods = 2 * math.pi * 20 * 7
    along, across = curve.displacement(0.0, periods / 0.7)
    assert along / (periods / 0.7) == pytest.approx(-curve.speed, abs=1e-12)
    assert across == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("curve", FAMILY, ids=lambda curve: type(curve).__name__)
def test_a_dictionary_brings_the_curve_back_through_json(curve):
    copy = curve_from_dict(json.loads(json.dumps(curve.to_dict())))
    assert copy == curve
    assert hash(copy) == hash(curve)


@pytest.mark.parametrize("curve", NAMED, ids=repr)
def test_repr_reads_as_the_constructor(curve):
    assert eval(repr(curve)) == curve


@pytest.mark.parametrize("curve", FAMILY, ids=repr)
def test_latex_is_one_balanced_formula(curve):
    assert curve.latex.count("{") == curve.latex.count("}")
    assert curve._repr_latex_() == f"$\\gamma(s) = {curve.latex}$"


def test_formulas_show_the_actual_parameters():
    assert [curve.formula for curve in FAMILY] == [
        "0",
        "-0.1 s e₁",
        "-0.1 s e₁ + (2 cos(0.5 s + 0.3), 2 sin(0.5 s + 0.3))",
        "(0, 2 sin(0.05 s))",
        "0.2 s e₁ + (2 cos(-0.7 s + 1), 0.5 sin(-0.7 s + 1))",
        "cubic spline through 2041 points",
    ]
    assert MovingBelt(0.0).formula == "0"
    assert RotatingNozzle(0.0, 1.0, 2.0, -1.0).formula == (
        "(1 cos(2 s - 1), 1 sin(2 s - 1))"
    )


def test_latex_shows_the_actual_parameters():
    assert MovingBelt(0.1).latex == r"-0.1\,s\,e_1"
    assert OscillatingNozzle(0.1, 2.0, 0.05).latex == (
        r"-0.1\,s\,e_1 + (0,\ 2\sin(0.05 s))"
    )


@given(
    speed=st.floats(-0.9, 0.9),
    radius=st.floats(0.0, 5.0),
    angular_speed=st.floats(-3.0, 3.0),
    phase=st.floats(-7.0, 7.0),
    s=st.floats(0.0, 100.0),
)
def test_rotation_and_oscillation_are_special_ellipses(
    speed, radius, angular_speed, phase, s
):
    rotating = RotatingNozzle(speed, radius, angular_speed, phase)
    oscillating = OscillatingNozzle(speed, radius, angular_speed, phase)
    for nozzle, radius1 in ((rotating, radius), (oscillating, 0.0)):
        ellipse = EllipticNozzle(speed, radius1, radius, angular_speed, phase)
        assert nozzle.position(s) == ellipse.position(s)
        assert nozzle.velocity(s) == ellipse.velocity(s)


def test_a_nozzle_at_rest_leaves_the_belt_alone():
    for nozzle in (RotatingNozzle(0.1, 2.0, 0.0), OscillatingNozzle(0.1, 0.0, 3.0)):
        assert nozzle.autonomous
        assert not nozzle.fixed
        assert nozzle.velocity(3.0) == MovingBelt(0.1).velocity(3.0)
    assert RotatingNozzle(0.0, 2.0, 0.0).fixed


def test_a_belt_of_speed_zero_is_fixed():
    assert MovingBelt(0.0).fixed
    assert FixedBelt().speed == 0
    assert not MovingBelt(1e-300).fixed


def test_a_table_reproduces_a_cubic_curve():
    s = np.array([0.0, 0.7, 1.0, 2.5, 3.0])
    curve = TabulatedCurve(s, 0.01 * s**3 - 0.2 * s, 0.1 * s**2)
    fine = np.linspace(0.0, 3.0, 31)
    # Not-a-knot splines contain the cubics: rounding only.
    np.testing.assert_allclose(
        curve.position(fine), [0.01 * fine**3 - 0.2 * fine, 0.1 * fine**2], atol=1e-14
    )
    np.testing.assert_allclose(
        curve.velocity(fine), [0.03 * fine**2 - 0.2, 0.2 * fine], atol=1e-13
    )


def test_a_table_of_a_rotation_converges_to_it_with_order_four():
    nozzle = RotatingNozzle(0.1, 2.0, 0.5)
    fine = np.linspace(2.0, 18.0, 801)
    errors = []
    for n in (41, 81, 161):
        s = np.linspace(0.0, 20.0, n)
        table = TabulatedCurve(s, *nozzle.position(s))
        deviation = np.array(table.position(fine)) - np.array(nozzle.position(fine))
        errors.append(np.max(np.abs(deviation)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # Fourth order in the interior; 0.2 is the distance to the asymptotic rate.
    np.testing.assert_allclose(orders, 4.0, atol=0.2)


def test_the_speed_of_a_table_is_its_mean():
    assert TabulatedCurve([0.0, 2.0], [1.0, 0.5], [0.0, 3.0]).speed == 0.25


def test_a_table_of_one_point_is_fixed():
    curve = TabulatedCurve([0.0, 1.0, 2.0], [3.0] * 3, [4.0] * 3)
    assert curve.fixed
    assert curve.autonomous


def test_the_rounded_end_of_a_table_is_inside():
    curve = TabulatedCurve([0.0, 1.0], [0.0, 0.0], [0.0, 1.0])
    assert curve.position(1.0 + 1e-12)[1] == pytest.approx(1.0, abs=2e-12)


LATE = np.linspace(5.0, 7.0, 9)


@pytest.mark.parametrize("height", [0.0, 0.3], ids=["of one point", "of a curve"])
def test_a_table_that_begins_late_is_one_that_begins_at_zero_later(height):
    grid = PhaseSpaceGrid(5.0, (8, 8, 8))
    p0 = initial.gaussian(grid, (0.3, 0.0), 1.0)

    def run(scheme, s, **options):
        curve = TabulatedCurve(s, 0.2 + 0.0 * s, height * np.sin(s - s[0]))
        model = LayDownModel(QuadraticPotential(), 1.0, curve)
        span = float(s[0]), float(s[0]) + 1.0
        density = solve(
            scheme(model, grid, **options),
            p0,
            span,
            0.25,
            boundary_tolerance=1.0,
            mass_tolerance=1.0,
        ).final
        paths = sample_paths(model, 3, span[1], 0.25, seed=1, s_start=span[0])
        return density, paths.xi

    for scheme, options in (
        (drift_kick, {"balanced": True}),
        (semi_lagrangian, {"adjusted": False}),
    ):
        late, early = run(scheme, LATE, **options), run(scheme, LATE - 5.0, **options)
        for one, other in zip(late, early, strict=True):
            # Arclengths up to 7 are rounded to 9e-16 at every step.
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-13)


@pytest.mark.parametrize("speed", [0.0, 0.1])
def test_a_run_that_leaves_its_table_is_refused_before_it_begins(speed, tmp_path):
    curve = TabulatedCurve(LATE, -speed * LATE, 0.0 * LATE)
    model = LayDownModel(QuadraticPotential(), 1.0, curve)
    grid = PhaseSpaceGrid(5.0, (8, 8, 8))
    p0 = initial.gaussian(grid, (0.0, 0.0), 1.0)
    folder = tmp_path / "checkpoint"
    for start, end in ((0.0, 1.0), (6.5, 7.5), (4.5, 5.5)):
        both = (
            rf"from s = {start:g} to {end:g}, .* a table from 5 to 7; extend the table"
        )
        with pytest.raises(ValueError, match=both):
            solve(drift_kick(model, grid), p0, (start, end), 0.25, checkpoint=folder)
        with pytest.raises(ValueError, match=both):
            sample_paths(model, 3, end, 0.25, seed=1, s_start=start)
    assert not folder.exists()
    paths = sample_paths(model, 3, 6.0, 0.25, seed=1, s_start=5.0)
    with pytest.raises(ValueError, match=r"from s = 5 to 8, .* from 5 to 7;"):
        paths.continued(8.0)


def test_a_table_of_one_point_stands_still_at_every_arclength():
    curve = TabulatedCurve(LATE, 1.0 + 0.0 * LATE, 2.0 + 0.0 * LATE)
    assert curve.displacement(0.0, 1.0) == (0.0, 0.0)
    assert np.array_equal(curve.velocity([0.0, 6.0]), np.zeros((2, 2)))


def test_a_table_is_described_not_printed():
    assert repr(TABULATED) == "TabulatedCurve(<2041 points, s from -10 to 1010>)"


@pytest.mark.parametrize("outside", [-0.1, 1.1, math.nan])
def test_outside_its_table_a_curve_is_unknown(outside):
    curve = TabulatedCurve([0.0, 1.0], [0.0, 0.0], [0.0, 1.0])
    message = rf"covers \[0, 1\], got {outside:g}; extend the table\.$"
    with pytest.raises(ValueError, match=message):
        curve.position([0.5, outside])


@pytest.mark.parametrize("wrong", [1.0, -1.0, 1.5, math.nan])
def test_the_belt_is_slower_than_the_fibre(wrong):
    for build in (
        MovingBelt,
        lambda v: RotatingNozzle(v, 1.0, 1.0),
        lambda v: OscillatingNozzle(v, 1.0, 1.0),
        lambda v: EllipticNozzle(v, 1.0, 1.0, 1.0),
    ):
        with pytest.raises(ValueError, match=r"^`speed` must "):
            build(wrong)


def test_the_error_of_a_fast_belt_states_the_identity_behind_it():
    message = (
        "^`speed` must lie strictly between -1 and 1, got 1.5; E cos α = -v in the "
        "stationary state, so a faster belt tears the fibre.$"
    )
    with pytest.raises(ValueError, match=message):
        MovingBelt(1.5)
    with pytest.raises(ValueError, match="`speed` must be finite, got nan"):
        MovingBelt(math.nan)


@pytest.mark.parametrize("wrong", [-1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("build", "name"),
    [
        (lambda r: RotatingNozzle(0.1, r, 1.0), "radius"),
        (lambda r: OscillatingNozzle(0.1, r, 1.0), "amplitude"),
        (lambda r: EllipticNozzle(0.1, r, 1.0, 1.0), "radius1"),
        (lambda r: EllipticNozzle(0.1, 1.0, r, 1.0), "radius2"),
    ],
)
def test_radii_are_non_negative(build, name, wrong):
    message = f"^`{name}` must be non-negative and finite, got {wrong:g}.$"
    with pytest.raises(ValueError, match=message):
        build(wrong)


def test_angles_are_finite():
    with pytest.raises(ValueError, match="`angular_speed` must be finite, got inf"):
        RotatingNozzle(0.1, 1.0, math.inf)
    with pytest.raises(ValueError, match="`phase` must be finite, got nan"):
        RotatingNozzle(0.1, 1.0, 1.0, math.nan)


def test_a_table_is_checked():
    with pytest.raises(
        ValueError, match=r"^`gamma2` must have the shape .* got \(3,\)"
    ):
        TabulatedCurve([0, 1], [0, 0], [0, 0, 0])
    with pytest.raises(ValueError, match=r"^`s` must have .* n >= 2, got \(1,\)"):
        TabulatedCurve([0], [0], [0])
    with pytest.raises(ValueError, match=r"^`gamma1` must be finite, got NaN or inf"):
        TabulatedCurve([0, 1], [0, math.nan], [0, 0])
    with pytest.raises(ValueError, match=r"^`s` must be strictly increasing"):
        TabulatedCurve([0, 1, 1], [0, 0, 0], [0, 0, 0])
    with pytest.raises(ValueError, match=r"^`speed` must lie strictly .* got 2;"):
        TabulatedCurve([0, 1], [0, -2], [0, 0])


def test_unknown_kinds_and_parameters_are_named_with_the_known_ones():
    with pytest.raises(
        ValueError, match=r"one of 'fixed_belt', 'moving_belt', .*'jet'"
    ):
        curve_from_dict({"kind": "jet"})
    with pytest.raises(ValueError, match="`moving_belt` must be speed, got velocity:"):
        curve_from_dict({"kind": "moving_belt", "velocity": 0.1})
    with pytest.raises(ValueError, match="`fixed_belt` must be none, got speed:"):
        curve_from_dict({"kind": "fixed_belt", "speed": 0.1})
