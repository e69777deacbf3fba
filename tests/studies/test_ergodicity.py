"""Averages along paths converge to those of the equilibrium as theorem 3.3 says."""

import json
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr
from matplotlib.mathtext import MathTextParser

from fpsolve.model.potentials import (
    FreePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.plotting.ergodicity import plot_ergodic_averages
from fpsolve.studies.ergodicity.asymptotic_variance import least_noise, settled_slope
from fpsolve.studies.ergodicity.averages import ergodic_averages, fit_ergodic_error
from fpsolve.studies.ergodicity.dataset import averages_dataset
from fpsolve.studies.observables import (
    Circulation,
    EquilibriumMoments,
    default_observables,
    direction,
    equilibrium_moments,
    square,
)

SEED = 20080611
QUADRATIC = QuadraticPotential()
# Standard errors come from 40 batches, so that deviations follow Student's t with 39
# degrees of freedom: 5 has a two-sided probability of 1.3e-5.
CLOSE = 5.0


def exact_circulation_variance(noise, s):
    """Variance of s⁻¹∫G over that of G, from its autocorrelation e^{−ls}, l = A²/2.

    (2/s²) ∫₀ˢ (s − u) e^{−lu} du.
    """
    rate = noise**2 / 2
    return 2 * (s / rate - (1 - np.exp(-rate * s)) / rate**2) / s**2


def errors_in_units(dataset, name, exact):
    """(squared error − exact) over its standard error, for one variable."""
    found, spread = dataset[name], dataset[f"{name}_standard_error"]
    return ((found - exact) / spread).to_numpy()


@pytest.fixture(scope="module")
def averages():
    """Quadratic B from noise 0.35 to 2.8, short enough for a test."""
    return ergodic_averages(
        QUADRATIC, np.geomspace(0.35, 2.8, 7), s_end=60.0, n_paths=800, seed=SEED
    )


def shaped_dataset(c1, c2, c3, *, noises=(0.3, 0.6, 1.0, 1.7, 3.0), scatter=1e-9):
    """A dataset whose errors have exactly the shape of (12), for one function."""
    noises, s = np.array(noises), np.geomspace(1.0, 100.0, 12)
    error = c1 / s + (c2 / noises + c3 * noises)[:, None] / np.sqrt(s)
    rng = np.random.default_rng(SEED)
    deviations = 1 + scatter * rng.standard_normal((20, noises.size, 1, s.size))
    squared = (2.0 * error[:, None]) ** 2 * deviations
    moments = EquilibriumMoments(np.array([0.5]), np.array([2.0]))
    about = {"n_paths": 20}
    return averages_dataset(squared, noises, s, ["mine"], moments, QUADRATIC, about)


# Expectations


def test_means_and_deviations_of_the_quadratic_potential_are_the_known_ones():
    moments = equilibrium_moments(QUADRATIC, default_observables(QUADRATIC))
    # With R² = ‖ξ‖² exponential of mean 2: E e^{−R²/2} = 1/2, E e^{−R²} = 1/3;
    # E G² = E R² e^{−R²}/2 = 1/9. The quadrature aims at 1e-9.
    np.testing.assert_allclose(moments.mean, [0, 2, 0.5, 0, 0], atol=1e-8)
    expected = [1, 2, np.sqrt(1 / 12), np.sqrt(1 / 2), 1 / 3]
    np.testing.assert_allclose(moments.deviation, expected, rtol=1e-8)


@pytest.mark.parametrize("slope", [0.05, 1.0, 30.0])
def test_means_do_not_depend_on_the_size_of_the_pattern(slope):
    # e^{−Kr}: E r² = 6/K², E r⁴ = 120/K⁴.
    moments = equilibrium_moments(LinearPotential(slope), {"square": square})
    assert moments.mean[0] * slope**2 == pytest.approx(6, rel=1e-8)
    assert moments.deviation[0] * slope**2 == pytest.approx(np.sqrt(84), rel=1e-8)


def test_means_of_odd_functions_vanish_and_of_shifted_ones_do_not():
    # The half plane ξ₁ < 0 counts with its sign.
    functions = {"odd": lambda x, y, a: x**3, "shifted": lambda x, y, a: (x - 1) ** 2}
    moments = equilibrium_moments(QuadraticPotential(1.0, 3.0), functions)
    np.testing.assert_allclose(moments.mean, [0.0, 2.0], atol=1e-8)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda x, y, a: 3.0, r"`functions\['mine'\]` must vary over phase space"),
        (
            lambda x, y, a: np.ones(3),
            r"must work elementwise, got shape \(3,\) for arg",
        ),
        (lambda x, y, a: np.where(x > 0, np.nan, x), r"must be finite on all of phase"),
        (lambda x, y, a: np.exp(np.minimum(0.6 * x * x, 300)), r"to integrate its sq"),
    ],
    ids=["constant", "shape", "NaN", "not square integrable"],
)
def test_functions_without_a_mean_or_a_variance_are_refused(function, message):
    with pytest.raises(ValueError, match=message), np.errstate(all="ignore"):
        equilibrium_moments(QUADRATIC, {"mine": function})


# Exact laws of averages


@pytest.mark.parametrize(
    "potential", [QUADRATIC, LinearPotential(), PowerPotential(4.0)], ids=repr
)
def test_averages_of_the_circulation_have_their_exact_variance(potential):
    # G is an eigenfunction of L for every isotropic B, so that the variance of its
    # averages is known at all s.
    noises = np.array([0.7, 1.4])
    found = ergodic_averages(
        potential, noises, s_end=30.0, ds=0.05, n_paths=3000, seed=SEED,
        functions={"circulation": Circulation(potential)},
    )  # fmt: skip
    s = found["s"].to_numpy()
    exact = s * exact_circulation_variance(noises[:, None, None], s)
    variance = float(found["deviation"].item() ** 2)
    # Steps of 0.05: the trapezoidal rule adds (A²ds/4)²/3 < 4e-4 of it, a standard
    # error is 1/40 of it.
    deviations = errors_in_units(found, "scaled_variance", variance * exact)
    assert np.abs(deviations).max() < CLOSE


def test_averages_of_the_direction_are_differences_of_the_position(averages):
    # ∫cos α ds = ξ₁(s) − ξ₁(0), so that s² error² tends to 2 Var ξ₁ = 2, and there is
    # no s^{−1/2} part at any noise. The correlation of ξ₁ over s = 60 is below 0.02
    # for A up to 2; above, it decays as e^{−s/A²}.
    some = averages.sel(function="direction").isel(noise=slice(0, 5))
    last = some.isel(s=-1)
    deviations = errors_in_units(last, "scaled_variance", 2.0 / 60.0)
    assert np.abs(deviations).max() < CLOSE
    assert np.abs(errors_in_units(some, "asymptotic_variance", 0.0)).max() < CLOSE


def test_the_asymptotic_variance_at_large_noise_is_that_of_the_limit():
    # A large: ξ is an Ornstein-Uhlenbeck process of rate A^{−2}, and ξ₁ has the
    # asymptotic variance 2A², with a relative correction of order A^{−4}.
    found = ergodic_averages(
        QUADRATIC, [3.0], s_end=300.0, n_paths=800, seed=SEED,
        functions={"position": default_observables(QUADRATIC)["position"]},
    )  # fmt: skip
    (deviation,) = errors_in_units(found, "asymptotic_variance", 18.0).ravel()
    assert abs(deviation) < CLOSE


def test_errors_start_at_the_deviation_and_decay_as_the_root_of_s(averages):
    one = averages.sel(function="square").isel(noise=3)
    assert one["error"][0] <= one["deviation"] * (1 + CLOSE / 40)
    # Over the last factor of four; the correlation length is about 2.
    late = one.sel(s=slice(15.0, None))
    slope = np.polyfit(np.log(late["s"]), np.log(late["error"]), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.08)


# The noise at which averages converge fastest


def test_the_best_noise_depends_on_the_function(averages):
    fit = fit_ergodic_error(averages)
    assert fit["square"].measured.trend == "interior"
    assert fit["core"].measured.trend == "interior"
    # G: 4/A² of its variance, at any noise; ξ₁ is mixed by the precession of the
    # orbits without any noise.
    assert fit["circulation"].measured.trend == "falling"
    assert fit["position"].measured.trend == "rising"
    assert fit["direction"].measured.trend == "vanishing"


def test_the_best_noise_for_the_width_is_found_with_its_uncertainty(averages):
    # The zero of the derivative of −2⟨f, L⁻¹f⟩ for f = ‖ξ‖² in a Hermite basis, see
    # validation/ergodic_averages.py.
    found = fit_ergodic_error(averages)["square"].measured
    assert abs(found.noise - 0.6768) < 4 * found.standard_error
    assert found.standard_error < 0.15


def test_the_shape_of_the_theorem_describes_the_width(averages):
    fit = fit_ergodic_error(averages)
    shape = fit["square"]
    # 800 paths leave 2.5 % of scatter.
    assert shape.misfit < 0.1
    assert shape.best_noise == pytest.approx(0.66, abs=0.1)
    # It is a bound once lifted.
    relative = averages["error"] / averages["deviation"]
    bound = shape.bound_factor * shape.error(
        averages["noise"].to_numpy()[:, None], averages["s"].to_numpy()
    )
    assert np.all(relative.sel(function="square").to_numpy() <= bound * (1 + 1e-12))
    # The theorem has one set of constants for all functions.
    assert np.all(relative.max("function") >= relative)
    assert fit.worst.measured.trend == "interior"


def test_a_parabola_in_logarithms_is_found_exactly():
    noises = np.geomspace(0.2, 5.0, 9)
    curve = np.exp(0.3 + 0.8 * np.log(noises / 0.77) ** 2)
    scatter = 1 + 1e-6 * np.random.default_rng(SEED).standard_normal((20, 9))
    found = least_noise(noises, curve * scatter)
    assert found.trend == "interior"
    # The scatter of 1e-6.
    assert found.noise == pytest.approx(0.77, rel=1e-5)
    assert found.standard_error < 1e-5


def test_the_uncertainty_of_the_best_noise_covers_scatter_and_shape():
    noises = np.geomspace(0.25, 4.0, 9)
    curve = (0.4 / noises + 0.9 * noises) ** 2
    rng = np.random.default_rng(SEED)
    found = [
        least_noise(noises, curve * (1 + 0.1 * rng.standard_normal((20, 9))))
        for _ in range(200)
    ]
    units = [(one.noise - 2 / 3) / one.standard_error for one in found]
    # 95 % of a normal law within 1.96; the share of 200 is known to 1.5 %.
    assert np.mean(np.abs(units) < 1.96) > 0.9


@pytest.mark.parametrize(
    ("power", "trend"), [(-2, "falling"), (2, "rising")], ids=["falling", "rising"]
)
def test_a_monotone_variance_has_no_best_noise(power, trend):
    noises = np.geomspace(0.3, 3.0, 6)
    found = least_noise(noises, noises**power * np.linspace(0.99, 1.01, 20)[:, None])
    assert found.trend == trend
    assert np.isnan(found.noise)
    assert np.isnan(found.standard_error)


# Fit


def test_errors_of_the_shape_itself_give_its_constants():
    fit = fit_ergodic_error(shaped_dataset(0.7, 0.4, 0.9))
    shape = fit["mine"]
    # Least squares of exact data with a scatter of 1e-9.
    assert shape.coefficients == pytest.approx((0.7, 0.4, 0.9), rel=1e-6)
    assert shape.best_noise == pytest.approx(2 / 3, rel=1e-6)
    assert shape.largest_misfit < 1e-6
    assert shape.bound_factor == pytest.approx(1.0, abs=1e-6)
    assert shape.variance(2.0) == pytest.approx((0.4 / 2 + 0.9 * 2) ** 2, rel=1e-6)
    # With a single function it is also the worst.
    assert fit.worst.coefficients == pytest.approx(shape.coefficients, rel=1e-9)


def test_a_missing_limit_leaves_the_shape_without_a_best_noise():
    shape = fit_ergodic_error(shaped_dataset(0.2, 1.5, 0.0))["mine"]
    assert shape.coefficients[2] == pytest.approx(0.0, abs=1e-6)
    assert shape.best_noise > 1e2
    none = fit_ergodic_error(shaped_dataset(0.2, 0.0, 1.5))["mine"]
    assert none.best_noise < 1e-2


def test_uncertainties_of_the_constants_cover_the_scatter():
    # Scatter of 5 % in each batch, 1.1 % in the mean.
    shape = fit_ergodic_error(shaped_dataset(0.7, 0.4, 0.9, scatter=0.05))["mine"]
    for found, error, true in zip(
        shape.coefficients, shape.standard_errors, (0.7, 0.4, 0.9), strict=True
    ):
        assert abs(found - true) < CLOSE * error
        assert error < 0.1 * true


def test_a_fit_prints_its_constants_its_misfit_and_the_best_noise(averages):
    lines = str(fit_ergodic_error(averages)).splitlines()
    assert lines[0] == "error / ‖f − E f‖ from s = 15 on:"
    assert [line.partition(":")[0] for line in lines[1:]] == [
        *default_observables(QUADRATIC), "worst",
    ]  # fmt: skip
    assert "% rms" in lines[2]
    assert "as measured" in lines[2]
    assert lines[1].endswith("fastest at the smallest noise")
    assert lines[4].endswith("told from zero at every noise")


def test_the_order_of_the_noises_does_not_matter(averages):
    shuffled = averages.isel(noise=[3, 0, 6, 1, 5, 2, 4])
    assert str(fit_ergodic_error(shuffled)) == str(fit_ergodic_error(averages))


def test_a_fit_needs_two_noises_and_two_arclengths(averages):
    with pytest.raises(
        ValueError, match=r"at least two noises, and two s from .* 1 an"
    ):
        fit_ergodic_error(averages.isel(noise=[0]))
    with pytest.raises(ValueError, match=r"from `s_from` = 60 on, got 7 and 1"):
        fit_ergodic_error(averages, s_from=60.0)


def test_the_slope_forgets_what_a_start_from_equilibrium_leaves():
    s = np.geomspace(1.0, 100.0, 20)
    # error² = v/s − w/s².
    squared = 3.0 / s - 2.0 / s**2
    assert settled_slope(s, squared) == pytest.approx(3.0, rel=1e-12)


# Runs


def test_a_run_records_what_it_needs_to_be_repeated(averages):
    assert averages["error"].dims == ("noise", "function", "s")
    assert averages.attrs["n_paths"] == 800
    assert json.loads(averages.attrs["seed"]) == [SEED]
    assert json.loads(averages.attrs["potential"])["kind"] == "quadratic"
    s = averages["s"].to_numpy()
    assert s[-1] == 60.0
    # A quarter is among them, and all are multiples of every noise's step.
    assert 15.0 in s
    steps = s[None] / averages["ds"].to_numpy()[:, None]
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)


def test_a_dataset_survives_a_file(averages, tmp_path):
    averages.to_netcdf(tmp_path / "averages.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "averages.nc", engine="h5netcdf") as found:
        assert str(fit_ergodic_error(found)) == str(fit_ergodic_error(averages))


def small(seed=SEED, **options):
    return ergodic_averages(
        QUADRATIC, [0.5, 1.0], s_end=4.0, ds=0.25, n_paths=40, seed=seed,
        functions={"cosine": direction}, n_saved=8, **options,
    )  # fmt: skip


def test_the_same_seed_gives_the_same_averages_on_any_client():
    first = small()
    again = small(np.random.SeedSequence(SEED))
    with ThreadPoolExecutor(2) as client:
        elsewhere = small(client=client)
    for other in (again, elsewhere):
        xr.testing.assert_identical(first["error"], other["error"])
    assert not np.array_equal(first["error"], small(SEED + 1)["error"])


def test_the_functions_can_be_sent_to_another_process():
    functions = default_observables(LinearPotential(2.0))
    assert pickle.loads(pickle.dumps(functions)) == functions


def test_noises_have_streams_of_their_own():
    twice = ergodic_averages(
        QUADRATIC, [1.0, 1.0], s_end=4.0, ds=0.25, n_paths=40, seed=SEED
    )
    first, second = twice["error"].to_numpy()
    assert not np.any(first == second)


def test_progress_counts_path_steps():
    seen = []
    small(progress=lambda *report: seen.append(report))
    assert seen == [(640, 1280, 4.0), (1280, 1280, 4.0)]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"noises": [1.0, 0.0]}, r"`noises` must be positive and finite, got 0\."),
        ({"noises": []}, r"`noises` must hold at least one noise, got none\."),
        ({"potential": FreePotential()}, r"`potential` must have a normalisable exp"),
        ({"n_paths": 39}, r"`n_paths` must be at least 40, got 39\."),
        ({"n_saved": 7}, r"`n_saved` must be at least 8, got 7\."),
        ({"functions": {}}, r"`functions` must hold at least one function, got none"),
        ({"ds": 0.3}, r"`ds` must divide `s_end` = 4 into at least 4 steps, got 0\.3;"),
        ({"ds": 2.0}, r"at least 4 steps, got 2; try 1\."),
        ({"ds": np.nan}, r"`ds` must be positive and finite, got nan\."),
        ({"s_end": -1.0}, r"`s_end` must be positive and finite, got -1\."),
        ({"seed": -1}, r"`seed` must be at least 0, got -1\."),
    ],
    ids=str,
)
def test_bad_arguments_are_refused(options, message):
    arguments = {
        "potential": QUADRATIC, "noises": [1.0], "s_end": 4.0, "n_paths": 40,
        "seed": SEED, **options,
    }  # fmt: skip
    potential, noises = arguments.pop("potential"), arguments.pop("noises")
    with pytest.raises(ValueError, match=message):
        ergodic_averages(potential, noises, **arguments)


# Figure


def test_a_figure_shows_the_measured_errors(averages):
    left, right = plot_ergodic_averages(averages, noises=[0.35, 1.4]).axes
    one = averages.sel(function="square").isel(noise=0)
    x, y = left.lines[0].get_data()
    np.testing.assert_array_equal(x, averages["s"])
    np.testing.assert_array_equal(y, one["error"] / one["deviation"])
    assert [text.get_text() for text in left.get_legend().get_texts()] == [
        "$A = 0.35$", "$A = 1.4$",
    ]  # fmt: skip
    # What vanishes (cos α) has no place on a logarithmic axis.
    assert len(right.get_legend().get_texts()) == 4
    assert right.get_xlabel() == r"noise $A$"


def test_the_slope_that_is_drawn_is_a_half(averages):
    left, _ = plot_ergodic_averages(averages).axes
    x, y = left.lines[-1].get_data()
    assert np.diff(np.log(y)) / np.diff(np.log(x)) == pytest.approx(-0.5)


def test_nothing_of_the_figure_is_cut_off(averages):
    figure = plot_ergodic_averages(averages)
    figure.canvas.draw()
    box = figure.get_tightbbox()
    assert min(box.x0, box.y0) >= 0
    assert box.x1 <= figure.get_figwidth()
    assert box.y1 <= figure.get_figheight()


def test_a_user_s_function_and_potential_are_drawn():
    potential = IsotropicPotential(lambda r: r**2, lambda r: 2 * r)
    found = ergodic_averages(
        potential, [0.5, 1.0], s_end=8.0, n_paths=40, seed=SEED,
        functions={"my_mean": square},
    )  # fmt: skip
    figure = plot_ergodic_averages(found, function="my_mean")
    assert "my_mean" in figure.axes[0].get_title()
    assert MathTextParser("path").parse(figure.get_suptitle()).width > 0


def test_a_figure_needs_a_function_and_noises_of_the_dataset(averages):
    with pytest.raises(ValueError, match=r"`function` must be one of position, .* 'x'"):
        plot_ergodic_averages(averages, function="x")
    with pytest.raises(
        ValueError, match=r"`noises` must be among 0\.35, .* got 0\.9\."
    ):
        plot_ergodic_averages(averages, noises=[0.9])
