"""What random combinations of the public API found, each as a law.

The generator is `validation/reliability/attack.py`.
"""

import re
import warnings
from functools import cache

import numpy as np
import pytest
from scipy.special import i0e, i1e
from scipy.stats import multivariate_normal
from solutions import relaxing_solution
from typer.testing import CliRunner

import fpsolve as fp
from fpsolve import diagnostics, initial, plotting, studies
from fpsolve.cli import app
from fpsolve.density import error_laws
from fpsolve.density.recorder import Recorder
from fpsolve.density.stationary.start import concentration_of
from fpsolve.model.curves import FixedBelt, MovingBelt, RotatingNozzle
from fpsolve.studies import suggested_grid
from fpsolve.studies.rates.bounds import averaging_bound, hypocoercive_bound

GRID = fp.PhaseSpaceGrid(5.0, (9, 8, 8))
CURVES = [FixedBelt(), MovingBelt(0.3), RotatingNozzle(0.1, 0.5, 2.0)]


@pytest.mark.parametrize(
    ("variance", "concentration"), [(1e-5, 1.0), (1.0, 1e12)], ids=["plane", "angle"]
)
def test_a_start_that_no_cell_sees_is_refused(variance, concentration):
    """It had a mass of 0 and became NaN, with no more than a warning."""
    with pytest.raises(ValueError, match=r"must leave mass on the cells, got .*refine"):
        initial.gaussian(GRID, (0.7, 0.3), variance, 0.1, concentration)


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: curve.kind)
@pytest.mark.parametrize("s", ["x", None, 1j, np.nan, np.inf, [0.0, np.nan]], ids=repr)
def test_a_curve_refuses_what_is_no_arclength(curve, s):
    for question in (curve.position, curve.velocity):
        with pytest.raises((TypeError, ValueError), match=r"`s` must (hold|be)"):
            question(s)


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: curve.kind)
def test_a_displacement_is_between_two_numbers(curve):
    with pytest.raises(TypeError, match="`s1` must be a real number, got 'x'"):
        curve.displacement(0.0, "x")
    with pytest.raises(ValueError, match="`s0` must be finite, got nan"):
        curve.displacement(np.nan, 1.0)


def test_a_drift_has_a_direction_that_is_a_number():
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
    with pytest.raises(TypeError, match="`alpha` must hold real numbers"):
        model.drift(0.0, 0.0, FixedBelt())


def test_a_marginal_is_that_of_a_density_on_the_grid():
    with pytest.raises(fp.GridMismatchError, match=r"`p` must have the shape"):
        diagnostics.marginal(np.ones((2, 3)), GRID)
    with pytest.raises(ValueError, match=r"`p` must have the shape"):
        diagnostics.marginal((np.nan, 0.0), GRID, "alpha")


def test_a_frame_of_a_movie_ends():
    """A GIF cannot say more than 65535 hundredths of a second."""
    with pytest.raises(ValueError, match=r"`fps` must be at least 0.0015, got 1e-12"):
        plotting.movie(relaxing_solution(), "film.gif", fps=1e-12)


def test_the_figure_of_a_comparison_is_not_that_of_a_result():
    with pytest.raises(TypeError, match="`comparison` must be a Comparison"):
        plotting.plot_comparison(relaxing_solution())


TOO_QUIET = [1e-61, 1e-160, 1e-300, 5e-324]


@pytest.mark.parametrize("noise", TOO_QUIET)
def test_a_noise_has_powers_that_are_numbers(noise):
    """They ended in an OverflowError, a ZeroDivisionError, or a rate of 0."""
    potential = fp.QuadraticPotential()
    told = "`noise` must be at least 1e-60, got .*and 0 means none"
    for make in (
        fp.LayDownModel,
        fp.EnergyProcess,
        averaging_bound,
        hypocoercive_bound,
    ):
        with pytest.raises(ValueError, match=told):
            make(potential, noise)


@pytest.mark.parametrize("noise", [*TOO_QUIET, 1e61])
def test_so_has_every_noise_of_a_study(noise):
    studied = (
        lambda noises: studies.rate_versus_noise(fp.QuadraticPotential(), noises),
        lambda noises: studies.small_noise_limit(fp.QuadraticPotential(), noises),
        lambda noises: studies.large_noise_limit(fp.QuadraticPotential(), noises),
        lambda noises: studies.small_noise_spectrum(fp.QuadraticPotential(), noises),
        lambda noises: studies.ergodic_averages(
            fp.QuadraticPotential(), noises, s_end=4.0, n_paths=40, seed=1
        ),
    )
    for study in studied:
        with pytest.raises(ValueError, match=r"`noises` must be at (least|most) 1e"):
            study([noise])


def test_the_quietest_and_the_loudest_model_still_have_limits():
    """At the ends of what is allowed nothing overflows."""
    for noise in (1e-60, 1e60):
        limit = fp.HydrodynamicLimit(fp.LayDownModel(fp.QuadraticPotential(), noise))
        assert limit.gap() == pytest.approx(noise**-2, rel=1e-12)
        process = fp.EnergyProcess(fp.QuadraticPotential(), noise)
        rate = process.eigenvalues(1, "odd")[0]
        assert rate == pytest.approx(0.5 * noise**2, rel=1e-9)


@pytest.mark.parametrize(
    ("potential", "noise"),
    [
        (fp.QuadraticPotential(), 9e-4),
        (fp.QuadraticPotential(0.01, 0.01), 9e-3),
        (fp.LinearPotential(), 1e-30),
        (fp.PowerPotential(3.0), 1e59),
    ],
    ids=["quadratic", "narrow", "linear", "power"],
)
def test_a_spectrum_that_rounding_hides_is_refused(potential, noise):
    """These searched for ever, or ended in "Factor is exactly singular"."""
    with pytest.raises(ValueError, match=r"`noise` must be at (least|most) .* lost in"):
        fp.spectral_gap(fp.LayDownModel(potential, noise))


@pytest.mark.parametrize(
    ("noise", "curve"),
    [
        (20.0, FixedBelt()),
        (1e3, MovingBelt(-0.3)),
        (0.7, RotatingNozzle(0.0, 0.6, 60.0)),
    ],
    ids=["A = 20", "A = 1000", "ω = 60"],
)
def test_estimates_cover_where_a_step_sees_neither_noise_nor_nozzle(noise, curve):
    """A third of the change is the error for order 2; here the order is 1."""
    model = fp.LayDownModel(fp.QuadraticPotential(), noise, curve)
    grid = fp.PhaseSpaceGrid(6.0, (32, 32, 16))
    p0 = initial.gaussian(grid, (0.5, 0.3), 0.6, 0.5, 1.0)
    scheme, span, ds = fp.drift_kick(model, grid), (0.0, 0.5), 0.25
    with pytest.warns(UserWarning, match="`ds` = 0.25 is long"):
        run = fp.solve(scheme, p0, span, ds, extrapolate=True)
    exact = fp.solve(scheme, p0, span, ds / 16).final
    error = diagnostics.l1_distance(run.final, exact, grid)
    estimate = run.errors["density_l1"][0]
    # A sixteenth of the step leaves an eighth of the estimate in `exact`.
    assert error < 1.1 * estimate
    assert error > estimate / 3


@pytest.mark.parametrize("sigma", [4.0**-8, 1 / 64, 64.0])
@pytest.mark.parametrize(
    ("potential", "noise", "curve"),
    [
        (lambda sigma: fp.QuadraticPotential(1.5 * sigma, 1.5 * sigma), 2.0, 0.0),
        (lambda sigma: fp.LinearPotential(1.323 / sigma), 0.4966, 0.0),
        (lambda sigma: fp.PowerPotential(2.126, sigma), 0.5945, 0.9),
    ],
    ids=["quadratic", "linear", "on a fast belt"],
)
def test_the_suggested_grid_has_no_unit_of_length(potential, noise, curve, sigma):
    """Remark 3.1: ξ ~ σ, A ~ 1/√σ; the noise entered the cells with its unit."""

    def suggested(scale):
        amplitude = noise / scale**0.5
        model = fp.LayDownModel(potential(scale), amplitude, MovingBelt(curve))
        return fp.suggest_grid(model, 0.3, s_end=2 * scale if curve else None)

    plain, scaled = suggested(1.0), suggested(sigma)
    # Scaling by a power of four is exact.
    assert scaled.shape == plain.shape
    assert scaled.half_widths == tuple(sigma * half for half in plain.half_widths)


def test_the_law_of_the_suggested_step_has_no_unit_of_length():
    """C ds² is a number: κ, 1 and A² have three different units."""
    law, force = error_laws.splitting_coefficient, 0.7
    for sigma in (1 / 64, 64.0):
        model = fp.LayDownModel(fp.QuadraticPotential(), 1.5 / sigma**0.5)
        scaled = law(model, force / sigma**2, sigma) * sigma**2
        plain = law(fp.LayDownModel(fp.QuadraticPotential(), 1.5), force)
        # Rounding of a few operations.
        assert scaled == pytest.approx(plain, rel=1e-14)


@pytest.mark.parametrize("sigma", [1 / 64, 1 / 4])
def test_the_suggested_step_shrinks_with_the_pattern(sigma):
    """It is 1/m: steps of a pattern σ wide are σ times as long, but for that."""
    plain = suggested_step(1.0)
    assert suggested_step(sigma) == pytest.approx(sigma * plain, rel=1 / 10)
    assert (1 / suggested_step(sigma)) % 1 == pytest.approx(0.0, abs=1e-9)


def suggested_step(sigma):
    """With A√σ = 1 on a grid of the same cells."""
    model = fp.LayDownModel(fp.QuadraticPotential(sigma, sigma), 1 / sigma**0.5)
    return float(
        fp.suggest_step(model, fp.PhaseSpaceGrid(6.0 * sigma, (40, 40, 16)), 1e-2)
    )


POTENTIALS = [
    fp.QuadraticPotential(),
    fp.LinearPotential(),
    fp.PowerPotential(3.0),
    fp.FreePotential(),
    fp.IsotropicPotential(lambda r: r**2, lambda r: 2 * r),
    fp.CallablePotential(lambda x, y: x**2 + y**2, lambda x, y: (2 * x, 2 * y)),
]


@pytest.mark.parametrize("potential", POTENTIALS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("xi1", ["x", 1j, None, max, [True]], ids=repr)
def test_a_potential_refuses_what_is_no_place(potential, xi1):
    """They ended in numpy's errors, and complex numbers were accepted."""
    for question in (potential.value, potential.gradient):
        with pytest.raises(TypeError, match="`xi1` must hold real numbers"):
            question(xi1, 0.0)
        with pytest.raises(TypeError, match="`xi2` must hold real numbers"):
            question(0.0, xi1)


@pytest.mark.parametrize("potential", POTENTIALS, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("kind", ["f2", "f4", ">f8", "longdouble", "i1"])
def test_potentials_answer_in_double_precision(potential, kind):
    xi1 = np.array([0.0, 1.0, 2.0], dtype=kind)
    plain = xi1.astype(float)
    answers = (potential.value(xi1, xi1), *potential.gradient(xi1, 1.0))
    expected = (potential.value(plain, plain), *potential.gradient(plain, 1.0))
    for got, exact in zip(answers, expected, strict=True):
        assert got.dtype == np.float64
        np.testing.assert_array_equal(got, exact)


@pytest.mark.parametrize("speed", [1e-12, 0.3, 0.999, 1 - 1e-12, np.nextafter(1, 0)])
def test_angles_balance_every_belt(speed):
    """I₁(k)/I₀(k) = v; k was looked for below 1e6 only, as if v < 1 − 5e-7."""
    k = concentration_of(speed)
    # To rounding of both Bessel functions.
    assert i1e(k) / i0e(k) == pytest.approx(speed, rel=1e-12)
    model = fp.LayDownModel(fp.QuadraticPotential(), 1e-9, MovingBelt(speed))
    # |∂₁B| = ξ1 = A²k/2, unless that is beyond the pattern.
    shift = suggested_grid.belt_shift(model)
    assert shift in (pytest.approx(0.5e-18 * k, rel=1e-6, abs=1e-12), 0.0)


def test_averages_that_would_never_end_are_refused():
    """The default step is 1/(2A²): 1e12 of them are hours."""
    told = "`noises` must leave steps that can be taken, got 100000 and with it 2e"
    with pytest.raises(ValueError, match=told):
        studies.ergodic_averages(
            fp.QuadraticPotential(), [1.0, 1e5], s_end=2.0, n_paths=40, seed=1
        )


@pytest.mark.parametrize("path", [slice(None), 3, b"page.html"], ids=repr)
def test_a_report_goes_to_a_file_with_a_name(path):
    with pytest.raises(TypeError, match="`path` must be the name of a file, got"):
        fp.report("result.nc", path)


def test_a_report_about_a_folder_has_no_name():
    """It ended in pathlib's "PosixPath('.') has an empty name"."""
    done = CliRunner().invoke(app, ["report", "."])
    assert done.exit_code == 2
    assert "`path` must be the name of a file, got '.'." in done.stderr


def test_a_name_among_few_is_compared_as_one():
    """An array compared with every name has no truth value."""
    with pytest.raises(ValueError, match=r"`which` must be one of .*, got array"):
        diagnostics.marginal(np.ones(GRID.shape), GRID, np.array([1.0, 2.0]))


def test_a_gaussian_far_away_is_zero_without_a_word():
    """Squares overflowed, or left inf − inf."""
    model = fp.LayDownModel(fp.QuadraticPotential(), 2.0)
    limit = fp.OrnsteinUhlenbeckLimit(model, (0.2, 0.1), ((1.0, 0.4), (0.4, 0.5)))
    assert limit.density(1e300, -1e300, 0.1) == 0.0
    with pytest.raises(TypeError, match="`xi1` must hold real numbers"):
        limit.density("x", 0.0)
    places = np.linspace(-2.0, 2.0, 5)
    law = multivariate_normal(limit.mean(0.1), limit.covariance(0.1))
    exact = law.pdf(np.stack([places, places**2], axis=-1))
    # Rounding of a few operations.
    np.testing.assert_allclose(limit.density(places, places**2, 0.1), exact, rtol=1e-12)


@pytest.mark.parametrize(("scale", "is_told"), [(1.5, True), (2.4, False)])
def test_an_entropy_beyond_the_logarithm_is_told(scale, is_told):
    """H counts −ln p_S up to 690 only, in whatever unit: what is missing is told."""
    model = fp.LayDownModel(fp.PowerPotential(12.0, scale), 0.5)
    grid = fp.PhaseSpaceGrid((4.2, 5.3), (18, 24, 12))
    p0 = initial.gaussian(grid, (0.3, 0.1), 0.8, 0.2, 1.0)
    value = model.potential.value(*grid.plane())[:, :, None]
    exact = value + np.log(2 * np.pi * model.potential.partition_function)
    true = float((p0 * (np.log(p0) + exact)).sum()) * grid.cell_volume
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        entropy = Recorder(model, grid).record(p0, 0.0)["relative_entropy"]
    assert bool(told) == is_told
    if is_told:
        missing = re.search(r"too small by ([0-9.e+-]+)\.", str(told[0].message))[1]
        # Two digits are said; ln of the mass of p_S on the grid moves the limit of 690.
        assert float(missing) == pytest.approx(true - entropy, rel=0.02)
    else:
        assert entropy == pytest.approx(true, rel=2e-3)


@cache
def gap_times_length(length):
    model = fp.LayDownModel(fp.PowerPotential(4.0, length), 1 / length**0.5)
    return float(fp.spectral_gap(model, tolerance=1e-3)) * length


@pytest.mark.parametrize("scale", [1e-40, 1e-10, 1e12, 1e40])
def test_a_gap_has_no_unit_of_length(scale):
    """Orbits were looked for between 1e-9 and 1e9: off by 2 % below, singular above."""
    # Both are far better than the tolerance asks.
    assert gap_times_length(scale) == pytest.approx(gap_times_length(1.0), rel=1e-6)


@pytest.mark.parametrize("form", ["h", "p"])
@pytest.mark.parametrize("order", [4, 6])
def test_limited_characteristics_commute_with_a_reflection(form, order):
    """Feet on a face of the cells were limited by the cell on one side, as it fell.

    On the odd grid the columns of ξ = 0 go straight along the faces; the density was
    off by 1e-6 to 6e-5 of its largest value.
    """
    grid = fp.PhaseSpaceGrid(5.685, (21, 9, 6))
    model = fp.LayDownModel(fp.PowerPotential(1.609, 1.491), 0.873)
    scheme = fp.semi_lagrangian(
        model, grid, form=form, splitting="lie", interpolation_order=order, limited=True
    )

    def final(p0):
        p0 = np.ascontiguousarray(p0)
        return fp.solve(scheme, p0, (0.0, 0.25), 1 / 16, boundary_tolerance=1.0).final

    p0 = initial.gaussian(grid, (0.5, 0.2), 0.8, 0.4, 1.0)
    plain, mirrored = final(p0), final(p0[:, ::-1, ::-1])
    # Rounding of a few steps.
    allowed = 1e-13 * plain.max()
    np.testing.assert_allclose(mirrored[:, ::-1, ::-1], plain, rtol=0, atol=allowed)


@pytest.mark.parametrize("sigma", [0.25, 4.0])
def test_a_corrected_density_is_the_same_in_other_units(sigma):
    """η b ds² has a unit, but only the ratio of what it moves counts."""

    def run(length, adjusted):
        own = fp.PhaseSpaceGrid(6.0 * length, (12, 12, 12))
        potential = fp.QuadraticPotential(length, length)
        model = fp.LayDownModel(potential, 1.5 / length**0.5, fp.MovingBelt(0.3))
        scheme = fp.semi_lagrangian(model, own, adjusted=adjusted)
        p0 = initial.gaussian(own, (0.5 * length, 0.0), length**2)
        span = (0.0, length)
        return fp.solve(
            scheme, p0, span, length / 4, mass_tolerance=1.0, boundary_tolerance=1.0
        )

    plain, other = run(1.0, False), run(sigma, False)
    # Powers of four: only exponents differ, and the last bit of a root.
    np.testing.assert_allclose(sigma**2 * other.final, plain.final, 1e-12, 1e-16)
    plain, other = run(1.0, True), run(sigma, True)
    assert np.abs(plain.mass_correction).max() > 1e-6
    # The correction divides by the mass of what it moves: a few eps more.
    np.testing.assert_allclose(sigma**2 * other.final, plain.final, 1e-12, 1e-15)


@pytest.mark.parametrize("s", ["x", [], [0.5, -1.0], [np.nan], -1.0, np.inf], ids=repr)
def test_an_ornstein_uhlenbeck_law_is_that_of_an_arclength(s):
    """Lists were not looked at: a negative s gave a covariance below zero."""
    model = fp.LayDownModel(fp.QuadraticPotential(), 2.0, fp.MovingBelt(0.1))
    law = fp.OrnsteinUhlenbeckLimit(model)
    with pytest.raises((TypeError, ValueError), match="`s` must"):
        law.density(0.0, 0.0, s)
    if s != []:
        for question in (law.mean, law.covariance, law.relative_entropy):
            with pytest.raises((TypeError, ValueError), match="`s` must"):
                question(s)


def test_folders_and_floors_of_studies_are_folders_and_numbers():
    with pytest.raises(TypeError, match="`directory` must be the name of a file, got"):
        studies.sweep(lambda x: {"y": x}, [{"x": 1}], directory=fp.QuadraticPotential)
    for floor, error in (({}, TypeError), ([1.0, 2.0], ValueError)):
        with pytest.raises(error, match=r"`error_floor` must (hold|be one)"):
            studies.fitted_order([1.0, 0.5, 0.25], [1.0, 0.5, 0.25], floor)
