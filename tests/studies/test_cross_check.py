"""Density and paths agree where they should, and every mistake is caught."""

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.paths import (
    DensityLaw,
    EquilibriumLaw,
    GaussianLaw,
    PointLaw,
    sample_paths,
)
from fpsolve.plotting.comparison import plot_cross_check
from fpsolve.studies import CrossCheck, compare, cross_check
from fpsolve.studies.agreement import cross_check as comparison_module
from fpsolve.studies.agreement.coarser import (
    coarsened,
    coarser_runs,
    on_grid,
    start_noncentrality,
)
from fpsolve.studies.agreement.steps import common_step, paths_step

GRID = fp.PhaseSpaceGrid(5.5, (48, 48, 32))
START = GaussianLaw((1.0, 0.5), 0.3, angle=math.pi / 2, concentration=2.0)
MODEL = fp.LayDownModel(fp.QuadraticPotential(), noise=1.0)
BELT = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.2))


def initial_density(law, grid):
    return fp.initial.gaussian(
        grid, law.mean, law.variance, law.angle, law.concentration
    )


@cache
def density(model, *, law=START, grid=GRID, ds=1 / 16, extrapolate=True, at=(1.0,)):
    """The density of a model at some s, without asking whether it is right."""
    return fp.solve(
        fp.drift_kick(model, grid), initial_density(law, grid), (0.0, at[-1]), ds,
        save_at=at, extrapolate=extrapolate, boundary_tolerance=0.01,
    )  # fmt: skip


@cache
def paths(model, n_paths=100_000, *, ds=1 / 32, seed=5, law=START, at=(1.0,)):
    return sample_paths(
        model, n_paths, at[-1], ds,
        seed=seed, initial=law, save_at=at, histogram=GRID, keep=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def right():
    """A density and paths of the same law."""
    return compare(density(BELT, at=(0.5, 1.0)), paths(BELT, at=(0.5, 1.0)))


@pytest.fixture(scope="module")
def wrong():
    """The density of another noise, 5 % larger."""
    other = replace(BELT, noise=1.05)
    return compare(density(other, at=(0.5, 1.0)), paths(BELT, at=(0.5, 1.0)))


# Agreement

MODELS = {
    "quadratic": MODEL,
    "anisotropic": fp.LayDownModel(fp.QuadraticPotential(1.0, 0.7), 0.7),
    "linear": fp.LayDownModel(fp.LinearPotential(), 1.0),
    "quartic": fp.LayDownModel(fp.PowerPotential(4.0), 1.5),
    "moving belt": BELT,
    "rotating nozzle": fp.LayDownModel(
        fp.QuadraticPotential(), 1.0, fp.RotatingNozzle(0.1, 0.5, 2.0)
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_density_and_paths_of_one_model_agree(name):
    check = cross_check(
        MODELS[name], START, (0.5, 1.5), grid=GRID, n_paths=100_000, seed=20080611
    )
    # A false alarm has probability 1e-3; with this seed there is none.
    assert check.agrees, str(check)
    assert len(check.tests) == 28
    assert not any(test.blurred for test in check.tests)


def test_a_density_on_the_grid_is_a_start_too():
    p0 = initial_density(START, GRID)
    check = cross_check(MODEL, p0, (0.0, 0.5), grid=GRID, n_paths=40_000, seed=1)
    assert check.agrees, str(check)
    np.testing.assert_array_equal(check.s, [0.0, 0.5])
    law = DensityLaw(GRID, p0)
    again = cross_check(MODEL, law, (0.0, 0.5), n_paths=40_000, seed=1)
    assert again.tests == check.tests


def test_the_equilibrium_stays_the_equilibrium_of_the_paths():
    law = EquilibriumLaw(MODEL.potential)
    check = cross_check(MODEL, law, 2.0, grid=GRID, n_paths=50_000, seed=1)
    assert check.agrees, str(check)


def test_long_paths_have_the_stationary_density_of_a_belt():
    coarse = fp.PhaseSpaceGrid(5.5, (32, 32, 16))
    # Steps, cells and box leave 1e-3, the paths see 1e-2.
    steady = fp.steady_state(BELT, coarse, tolerance=1e-7, error_tolerance=1e-2)
    sampled = sample_paths(
        BELT, 100_000, 25.0, 1 / 16, seed=5, initial=START, histogram=coarse, keep=False
    )
    check = compare(steady, sampled)
    # From the start, e^{-0.4·25} = 5e-5 is left: a hundredth of the standard errors.
    assert check.agrees, str(check)
    # E cos α = -v and E sin α = 0, whatever the potential.
    cosine, sine = (check.test(f"mean_{name}_alpha", 25.0) for name in ("cos", "sin"))
    assert abs(cosine.paths + 0.2) < 5 * cosine.standard_error
    assert abs(sine.paths) < 5 * sine.standard_error


def test_the_sampler_has_the_law_of_drift_kick_at_the_same_step():
    # Both are T½ R½ D R½ T½. At ds = 1/2 the step error is many times what would be
    # detected, and yet they agree: this is why the density's Richardson estimate is
    # also that of the bias of the paths.
    coarse = density(BELT, ds=0.5, extrapolate=False, at=(2.0,))
    sampled = paths(BELT, ds=0.5, at=(2.0,))
    assert compare(coarse, sampled).agrees, str(compare(coarse, sampled))
    exact = density(BELT, at=(2.0,))
    assert not compare(exact, sampled).agrees


def test_the_same_seed_gives_the_same_result():
    first, second = (
        cross_check(MODEL, START, 0.5, grid=GRID, n_paths=2000, seed=3)
        for _ in range(2)
    )
    assert first.tests == second.tests


# What is wrong is caught


def test_noise_that_is_five_percent_off_is_caught(wrong):
    assert not wrong
    assert wrong.failed[0].p_value < 1e-10
    assert {"marginal alpha", "mean_cos_alpha"} <= {test.name for test in wrong.failed}
    # Step errors are no excuse.
    assert not any(test.may_be_step_error for test in wrong.failed)


def test_a_belt_that_runs_the_other_way_is_caught():
    other = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(-0.2))
    check = compare(density(other), paths(BELT))
    assert check.failed[0].p_value < 1e-100
    # Of many findings the worst six are shown.
    assert f"\n  and {len(check.failed) - 6} more\n" in str(check)
    shift = check.test("mean_xi1", 1.0)
    # In the mean the belt moves ξ1 by about v s on either side.
    assert shift.difference > 0.2


def test_a_small_belt_speed_that_was_forgotten_is_caught():
    # v = 0.02 moves the mean by 0.015, five times its standard error.
    slow = replace(MODEL, curve=fp.MovingBelt(0.03))
    assert not compare(density(MODEL), paths(slow))


def test_a_wrong_start_is_caught():
    elsewhere = GaussianLaw((1.0, 0.45), 0.3, angle=math.pi / 2, concentration=2.0)
    assert not compare(density(MODEL, law=elsewhere), paths(MODEL))
    wider = GaussianLaw((1.0, 0.5), 0.33, angle=math.pi / 2, concentration=2.0)
    assert not compare(density(MODEL, law=wider), paths(MODEL))


def test_a_solver_with_too_few_angles_is_caught():
    coarse = fp.PhaseSpaceGrid(5.5, (48, 48, 8))
    still = replace(MODEL, noise=0.3)
    found = density(still, grid=coarse)
    sampled = sample_paths(
        still, 100_000, 1.0, 1 / 32, seed=5, initial=START, histogram=coarse
    )
    check = compare(found, sampled)
    assert not check
    assert "The error of the grid is not estimated, and may be what dis" in str(check)


COARSE = fp.PhaseSpaceGrid(4.5, (40, 40, 24))


def rim(grid, width):
    """Constant on a disc, with a rim; upwards rather than down."""
    distance = np.hypot(*grid.plane())[:, :, None]
    p = (1 - np.tanh((distance - 1.5) / width)) * np.exp(np.sin(grid.alpha))
    return p / (p.sum() * grid.cell_volume)


@pytest.fixture(scope="module")
def hardly_resolved():
    """Runs from a steep density on three grids, and the law of its start."""
    law = DensityLaw(COARSE, rim(COARSE, 0.3))
    scheme = fp.drift_kick(MODEL, COARSE)
    options = {"save_at": (0.0, 1.0), "extrapolate": True, "boundary_tolerance": 0.01}
    solution = fp.solve(scheme, law.p, (0.0, 1.0), 1 / 16, **options)
    return solution, coarser_runs(solution, scheme, law), law


@pytest.mark.parametrize("noise", [1.0, 1.2])
def test_the_error_of_the_grid_is_allowed_for_and_hides_no_other_noise(
    hardly_resolved, noise
):
    solution, coarser, law = hardly_resolved
    other = replace(MODEL, noise=noise)
    verdicts = []
    for seed in range(6):
        sampled = sample_paths(
            other, 50_000, 1.0, 1 / 32, seed=seed, initial=law, save_at=(0.0, 1.0),
            histogram=COARSE, keep=False,
        )  # fmt: skip
        check = compare(solution, sampled, coarser=coarser)
        verdicts.append(check.agrees)
    # Six checks at a level of 1e-3 fail once in 160 times; with these seeds none does.
    assert verdicts == [noise == 1.0] * 6
    assert "The tests allow for the grid error of the density, at most" in str(check)
    assert all(test.grid_error >= 0 for test in check.tests)


def test_a_start_that_paths_see_to_be_interpolated_is_refused():
    grid = fp.PhaseSpaceGrid(4.5, (32, 32, 16))
    message = "differs in L1 from the law that paths begin with, which 6.5e"
    with pytest.raises(ToleranceError, match=message):
        cross_check(MODEL, rim(grid, 0.2), 0.5, grid=grid, n_paths=100_000, seed=1)
    # Where the grid resolves it, a hundred million paths would not see it.
    worst, _ = start_noncentrality(DensityLaw(COARSE, rim(COARSE, 0.3)))
    assert worst < 1e-8


def test_a_grid_on_which_nothing_could_be_told_is_refused():
    few, still = fp.PhaseSpaceGrid(5.5, (48, 48, 8)), replace(MODEL, noise=0.3)
    with pytest.raises(ToleranceError, match="is the L1 error of 48 x 48 x 8 cells at"):
        cross_check(still, START, 1.0, grid=few, n_paths=1000, seed=1, ds=1 / 16)


def test_a_trigonometric_interpolant_is_exact_on_the_finer_grid():
    grid = fp.PhaseSpaceGrid((3.0, 2.0), (24, 18, 10))
    coarse = coarsened(grid)
    assert coarse.shape == (18, 14, 8)

    def wave(grid):
        xi1, xi2, alpha = grid.mesh()
        across = np.cos(2 * np.pi * xi2 / 2 + 0.3)
        return np.sin(8 * np.pi * xi1 / 6) * across * np.cos(3 * alpha + 1)

    found = on_grid(wave(coarse), coarse, grid)
    np.testing.assert_allclose(found, wave(grid), rtol=0, atol=1e-13)


def test_a_step_that_is_too_long_is_caught_and_said_to_be_one():
    check = compare(density(MODEL, ds=0.5, extrapolate=False), paths(MODEL))
    assert not check
    assert "Step errors are not estimated" in str(check)
    # The same for the paths: the estimate of an extrapolated run tells their bias.
    check = compare(density(MODEL, ds=1 / 8), paths(MODEL, ds=0.5))
    assert not check
    assert all(test.may_be_step_error for test in check.failed)
    assert "may be step error; reduce `ds` and `paths_ds`" in str(check)


def test_the_bias_of_euler_maruyama_is_caught_and_not_called_known():
    sampled = sample_paths(
        MODEL, 100_000, 1.0, 1 / 8, seed=5, initial=START, histogram=GRID,
        keep=False, method="euler_maruyama",
    )  # fmt: skip
    check = compare(density(MODEL), sampled)
    assert not check
    assert "The step error of euler_maruyama is not estimated" in str(check)


def test_steps_that_blur_the_view_are_said_to_do_so():
    # The paths have the step of the finer run, and with it twice the error of which
    # the extrapolated density has nothing left.
    check = compare(density(MODEL, ds=0.25), paths(MODEL, ds=1 / 8))
    assert any(test.blurred for test in check.tests)
    assert "reduce `ds` and `paths_ds`" in str(check)


def test_paths_outside_of_the_box_are_counted():
    # Two thousandths of them: invisible to every moment of the density in the box.
    sampled = paths(MODEL, 50_000)
    histogram = sampled.histogram(GRID, 1.0)
    assert histogram.outside == 0

    class Escaped(fp.Paths):
        def histogram(self, grid, s):
            counts = histogram.counts.copy()
            most = np.unravel_index(np.argmax(counts), counts.shape)
            counts[most] -= 100
            return replace(histogram, counts=counts, outside=100)

    check = compare(density(MODEL), Escaped(**vars(sampled)))
    assert check.test("largest cell", 1.0).p_value < check.tests[0].threshold


# False alarms


@pytest.fixture(scope="module")
def many():
    """Checks of the same density with paths of many seeds."""
    # The step is the same on both sides, and so is the law, whatever the step.
    exact = density(MODEL, ds=1 / 8, extrapolate=False)
    checks = []
    for seed in range(200):
        sampled = paths(MODEL, 4000, ds=1 / 8, seed=1000 + seed)
        checks.append(compare(exact, sampled, false_alarm=0.2, cells=64))
    return checks


@pytest.mark.parametrize(
    "name",
    ["coarse cells", "cells", "marginal xi1", "marginal alpha", "mean_xi1",
     "variance_xi2", "mean_cos_alpha"],
)  # fmt: skip
def test_p_values_are_uniform_when_there_is_nothing_to_find(many, name):
    p_values = [check.test(name, 1.0).p_value for check in many]
    # Kolmogorov-Smirnov at 1e-3: seven tests with fixed seeds.
    assert stats.kstest(p_values, "uniform").pvalue > 1e-3


def test_false_alarms_are_as_rare_as_they_are_said_to_be(many):
    rate = np.mean([not check.agrees for check in many])
    # At most 0.2, less since the tests depend on each other; four standard errors of
    # the measured rate are 0.11.
    assert 0.02 < rate < 0.31


# Steps


def test_the_step_divides_every_arclength():
    ds = common_step(np.array([0.5, 0.75, 2.0]), 0.1)
    assert ds == pytest.approx(0.25 / 3)
    with pytest.raises(ValueError, match=r"multiples of one step near 0\.1"):
        common_step(np.array([1.0, math.pi]), 0.1)


def test_the_step_of_the_paths_is_halved_until_its_bias_is_negligible():
    moments = dict.fromkeys(("mean_xi1", "mean_xi2", "covariance"), 0.0)
    moments |= {"variance_xi1": 1.0, "variance_xi2": 1.0}
    moments |= {"mean_cos_alpha": 0.0, "mean_sin_alpha": 0.0}
    errors = dict.fromkeys(moments, 0.0)
    # Standard errors are 1e-2 for 10⁴ paths, a tenth of them 1e-3.
    assert paths_step(0.2, moments, errors | {"mean_xi1": 9e-4}, 10**4) == 0.1
    assert paths_step(0.2, moments, errors | {"mean_xi1": 3e-3}, 10**4) == 0.05
    assert paths_step(0.2, moments, errors | {"mean_xi1": 5e-3}, 10**4) == 0.025
    unknown = dict.fromkeys(errors, math.nan)
    assert paths_step(0.2, moments, unknown, 10**4) == 0.1


def test_memory_does_not_depend_on_the_number_of_paths(monkeypatch):
    asked = {}

    def recorded(*arguments, **options):
        asked.update(options)
        return sample_paths(*arguments, **options)

    monkeypatch.setattr("fpsolve.paths.sampling.sample_paths", recorded)
    cross_check(MODEL, START, 0.5, grid=GRID, n_paths=2000, seed=1)
    assert asked["keep"] is False
    assert asked["histogram"] == GRID


def test_a_start_that_is_wider_than_the_equilibrium_is_solved_for_itself():
    # p0/p_S would span 1e8 and more; drift_kick evolves p then.
    wide = GaussianLaw((0.0, 0.0), 2.5)
    check = cross_check(MODEL, wide, 0.25, grid=fp.PhaseSpaceGrid(9.0, (64, 64, 16)),
                        n_paths=20_000, seed=1)  # fmt: skip
    assert check.solver["options"]["balanced"] is False
    assert check.agrees, str(check)


# What is said


def test_the_verdict_reads_well_when_both_agree(right):
    said = str(right)
    assert said.startswith(
        "Density and paths agree at s = 0.5 and 1: all 28 tests passed."
    )
    assert "drift_kick, ds = 0.0625 and ds/2, extrapolated, 48 x 48 x 32 cells" in said
    assert "Paths: 100000 by splitting, ds = 0.03125, seed 5." in said
    assert "fail with probability at most 0.001: each of the 28 tests" in said
    assert "p < 3.6e-05 (Bonferroni)" in said
    assert "Seen with probability 0.99: a density whose probabilities of" in said
    assert "a shift of E ξ₁ by 0.0" in said
    assert "times what is seen" in said
    assert bool(right) is True
    assert "agree: 0 of 28 tests failed" in repr(right)


def test_the_verdict_reads_well_when_they_do_not(wrong):
    said = str(wrong)
    assert said.startswith("Density and paths DISAGREE at s = 0.5 and 1: ")
    assert "by the density, " in said
    assert "does not explain the disagreement" in said
    assert "disagree: " in repr(wrong)


def test_the_detectable_shift_is_the_sum_of_threshold_and_power(right):
    test = right.test("mean_xi1", 1.0)
    size = 1e-3 / 28
    margin = stats.norm.isf(size / 2) + stats.norm.ppf(0.99)
    assert test.threshold == pytest.approx(size)
    assert test.detectable == pytest.approx(margin * test.standard_error)
    assert right.detectable["mean_xi1"][1] == test.detectable
    assert set(right.detectable) == {test.name for test in right.tests}


def test_numbers_reach_json_and_netcdf(right, wrong, tmp_path):
    text = json.dumps(right.to_dict(), allow_nan=False)
    read = json.loads(text)
    assert read["agrees"] is True
    assert read["verdict"] == str(right)
    assert read["tests"][0]["name"] == "coarse cells"
    assert read["tests"][0]["density"] is None
    import xarray as xr

    dataset = wrong.to_xarray()
    dataset.to_netcdf(tmp_path / "check.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "check.nc", engine="h5netcdf") as stored:
        assert stored.attrs["agrees"] == 0
        one = stored.sel(s=1.0, test="mean_xi1")
        assert float(one.p_value) == wrong.test("mean_xi1", 1.0).p_value
        np.testing.assert_array_equal(stored.count_alpha, wrong.counts["alpha"])


def test_the_figure_shows_density_paths_and_deviations(right, wrong):
    figure = plot_cross_check(right)
    assert len(figure.axes) == 12
    top, strip = figure.axes[0], figure.axes[3]
    assert top.get_ylabel() == "$s = 0.5$\ndensity"
    share = right.probabilities["xi1"][0]
    np.testing.assert_allclose(
        top.lines[0].get_ydata(), share / share.sum() / GRID.spacing[0]
    )
    heights = np.array([bar.get_height() for bar in strip.patches[1:]])
    # Standard normal numbers, but for cells with too few paths.
    assert 0.5 < np.nanstd(heights) < 1.6
    assert "all 28 tests passed" in figure.get_suptitle()
    assert "v = 0.2" in figure.get_suptitle()
    one = plot_cross_check(wrong, at=[1.0])
    assert len(one.axes) == 6
    assert "tests failed" in one.get_suptitle()
    assert "$p$ < 1e-4" in [text.get_text() for axes in one.axes for text in axes.texts]
    with pytest.raises(ValueError, match=r"compared arclengths 0\.5, 1, got 0\.7"):
        plot_cross_check(right, at=[0.7])


# Mistakes


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        ({"n_paths": 999}, ValueError, "`n_paths` must be at least 1000, got 999"),
        ({"false_alarm": 0.0}, ValueError, "`false_alarm` must lie between 0 and 1"),
        ({"false_alarm": math.nan}, ValueError, "`false_alarm` must lie between"),
        ({"cells": 4}, ValueError, "`cells` must be at least 8, got 4"),
        ({"grid": None}, TypeError, "`grid` must be given unless `scheme` or `p0`"),
        ({"s": 0.0}, ValueError, "`s` must hold a positive arclength, got 0"),
        ({"s": [1.0, -1.0]}, ValueError, "`s` must be one or more non-negative"),
        ({"s": []}, ValueError, "`s` must be one or more non-negative"),
        ({"s": math.nan}, ValueError, "`s` must be one or more non-negative"),
        ({"s": [1.0, math.pi]}, ValueError, "`s` must be multiples of one step"),
        ({"p0": PointLaw()}, ValueError, "`p0` must have a density, got a PointLaw"),
        ({"p0": np.ones(GRID.shape)}, ValueError, "`p0` must have mass 1, got 760"),
        ({"p0": np.ones((4, 4, 4))}, ValueError, "`p0` must have the shape"),
        (
            {"scheme": fp.drift_kick(BELT, GRID)},
            ValueError,
            "`scheme` must solve the model that is checked",
        ),
        (
            {"scheme": fp.drift_kick(MODEL, fp.PhaseSpaceGrid(5.0, (8, 8, 8)))},
            ValueError,
            "`grid` must be that of the scheme",
        ),
        ({"ds": 0.3}, ValueError, "`ds` must divide the span 1 into whole steps"),
    ],
)
def test_mistakes_are_named(change, kind, message):
    arguments = {"p0": START, "s": 1.0, "grid": GRID, "n_paths": 2000, **change}
    p0, s = arguments.pop("p0"), arguments.pop("s")
    with pytest.raises(kind, match=message):
        cross_check(MODEL, p0, s, seed=1, **arguments)


def test_a_law_without_a_known_density_is_refused():
    class Mine:
        def sample(self, rng, n):
            raise AssertionError("not to be sampled")

    with pytest.raises(TypeError, match="got Mine, whose density is not known"):
        cross_check(MODEL, Mine(), 1.0, grid=GRID, n_paths=2000, seed=1)


def test_results_must_have_an_arclength_in_common(right):
    found, sampled = density(MODEL, at=(0.5,)), paths(MODEL, 2000, at=(1.0,))
    with pytest.raises(ValueError, match="got none in common and paths at 1;"):
        compare(found, sampled)
    with pytest.raises(ValueError, match=r"got 0\.5 and paths at 1;"):
        compare(found, sampled, s=0.5)
    with pytest.raises(ValueError, match="`n_paths` must be at least 1000, got 500"):
        compare(found, paths(MODEL, 500, at=(0.5,)))
    with pytest.raises(
        ValueError, match=r"`name` must be one of 'coarse cells', .* got 'x'"
    ):
        right.test("x", 1.0)


def test_the_package_lists_its_names_and_knows_no_others():
    from fpsolve import studies

    assert {"cross_check", "CrossCheck", "ergodic_averages"} <= set(dir(studies))
    assert studies.cross_check is comparison_module.cross_check
    assert studies.CrossCheck is CrossCheck
    with pytest.raises(AttributeError, match="has no attribute 'crosscheck'"):
        studies.crosscheck  # noqa: B018
