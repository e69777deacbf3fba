"""What differs between two results is found, placed, and put beside its errors."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from command_line import assert_mistake, files
from solutions import PROVENANCE, relaxing_solution

import fpsolve as fp
from fpsolve.plotting.differences import plot_comparison
from fpsolve.results.compare.alignment import aligned
from fpsolve.results.compare.densities import to_angles
from fpsolve.results.compare.differences import difference_of, distance

SHAPE = (12, 14, 8)


@pytest.fixture(scope="module")
def solution():
    return relaxing_solution(shape=SHAPE)


def moved(solution, by, **changes):
    """The solution with one cell of the last density moved."""
    densities = solution.densities.copy()
    densities[-1, 3, 4, 5] += by
    return replace(solution, densities=densities, **changes)


def test_a_result_equals_itself_bit_by_bit(solution):
    comparison = fp.compare(solution, solution)
    assert comparison.equal
    assert comparison.within(0.0)
    assert not comparison.differing
    assert not comparison.parameters
    assert "equal: the same bits in all" in str(comparison)


def test_dates_and_times_are_no_results(solution):
    later = {**PROVENANCE, "date": "2030-01-01T00:00:00+00:00", "wall_seconds": 9.0}
    comparison = fp.compare(solution, replace(solution, provenance=later))
    assert comparison.equal
    assert not comparison.parameters


def test_one_moved_cell_is_found_with_its_place_and_size(solution):
    comparison = fp.compare(solution, moved(solution, 1e-3))
    assert not comparison.equal
    found = comparison["density"]
    # Exact up to the rounding of a sum of numbers below one.
    assert found.largest == pytest.approx(1e-3, rel=1e-12)
    assert found.relative == pytest.approx(1e-3 / solution.densities.max(), rel=1e-12)
    assert found.place == {
        "s": 5.0,
        "xi1": solution.grid.xi1[3],
        "xi2": solution.grid.xi2[4],
        "alpha": solution.grid.alpha[5],
    }


def test_the_l1_distance_is_the_integral_of_the_difference(solution):
    found = fp.compare(solution, moved(solution, 1e-3))["density_l1"]
    assert found.largest == pytest.approx(1e-3 * solution.grid.cell_volume, rel=1e-9)
    assert found.place == {"s": 5.0}
    # Each solution estimates 1e-4.
    assert found.in_errors == pytest.approx(found.largest / 2e-4, rel=1e-12)


@pytest.mark.parametrize(("by", "inside"), [(1e-6, True), (10.0, False)])
def test_differences_are_held_against_the_estimated_errors(solution, by, inside):
    comparison = fp.compare(solution, moved(solution, by))
    assert comparison.within_errors is inside
    word = "within" if inside else "beyond"
    assert f"{word} the estimated errors of A and B" in str(comparison)


def test_without_estimates_nothing_is_said_about_errors():
    plain = relaxing_solution(errors=False)
    comparison = fp.compare(plain, moved(plain, 1e-3))
    assert comparison.within_errors is None
    assert "estimated errors" not in str(comparison)


def test_a_tolerance_is_relative_to_the_largest_value(solution):
    comparison = fp.compare(solution, moved(solution, 1e-3))
    relative = max(one.relative for one in comparison.differences)
    assert comparison.within(1.01 * relative)
    assert not comparison.within(0.99 * relative)


def test_rounding_is_told_from_a_difference(solution):
    most = solution.densities.max()
    assert fp.compare(solution, moved(solution, 5e-11 * most)).is_rounding
    assert not fp.compare(solution, moved(solution, 5e-10 * most)).is_rounding


def test_a_nan_on_one_side_is_an_infinite_difference(solution):
    comparison = fp.compare(solution, moved(solution, np.nan))
    assert comparison["density"].largest == np.inf
    assert not comparison.within(1e9)


def test_the_same_nan_on_both_sides_is_no_difference(solution):
    broken = moved(solution, np.nan)
    assert fp.compare(broken, moved(solution, np.nan)).equal


def test_parameters_that_differ_are_named_with_both_values(solution):
    other = fp.LayDownModel(fp.QuadraticPotential(1.0, 2.0), 0.5)
    comparison = fp.compare(solution, replace(solution, model=other, ds=0.25))
    assert set(comparison.parameters) == {
        "model.potential.sigma2: 1.0 in A, 2.0 in B",
        "model.noise: 1.0 in A, 0.5 in B",
        "ds: 0.125 in A, 0.25 in B",
    }


def test_two_potentials_of_one_name_are_parameters_that_differ(solution):
    def closure(k):
        return fp.IsotropicPotential(lambda r: k * r**2 / 2, lambda r: k * r)

    first, again, other = (
        replace(solution, model=fp.LayDownModel(closure(k), 1.0)) for k in (1, 1, 4)
    )
    assert not fp.compare(first, again).parameters
    (named,) = fp.compare(first, other).parameters
    assert named.startswith("model.potential.sampled: ")


def test_versions_that_differ_are_named_with_both_values(solution):
    versions = {**PROVENANCE["versions"], "numpy": "9.9"}
    other = replace(solution, provenance={**PROVENANCE, "versions": versions})
    comparison = fp.compare(solution, other)
    assert comparison.environment == ("numpy: 2.1.0 in A, 9.9 in B",)
    # The environment is no result.
    assert comparison.equal


def test_arclengths_of_one_side_only_are_left_out_and_named(solution):
    fewer = relaxing_solution(shape=SHAPE, saved=(0.0, 2.0))
    comparison = fp.compare(solution, fewer)
    assert not comparison.equal
    assert not comparison.differing
    text = "s: 2 of 4 places of A and of 2 of B are in common"
    assert comparison.left_out == (text,)
    assert not comparison.within(1.0)


def test_places_are_the_same_up_to_rounding():
    s = np.arange(5) * 0.1
    a = xr.Dataset({"x": ("s", s)}, {"s": s})
    b = a.assign_coords(s=s + 1e-16)
    one, two, left_out = aligned(a, b)
    assert one.sizes == two.sizes == {"s": 5}
    assert not left_out


def test_densities_on_a_finer_grid_are_compared_on_the_coarser_one():
    fine = relaxing_solution(shape=(48, 48, 24), half_width=6.0)
    distances = []
    for n in (12, 24):
        coarse = relaxing_solution(shape=(n, n, 24), half_width=6.0)
        comparison = fp.compare(coarse, fine)
        distances.append(comparison["density_l1"].largest)
        assert "density_l1 is that on the coarser grid" in comparison.left_out
        assert any(one.startswith("density") for one in comparison.left_out)
    # The mean of a cell differs from the value at its centre by order h²; h is halved
    # and the start is resolved by few cells, so that the rate is between 3 and 5.
    assert 3 < distances[0] / distances[1] < 5


def test_densities_in_other_boxes_are_not_compared():
    comparison = fp.compare(
        relaxing_solution(half_width=5.0), relaxing_solution(half_width=6.0)
    )
    assert "density_l1" not in {one.name for one in comparison.differences}
    assert any("other places along xi1" in one for one in comparison.left_out)


@pytest.mark.parametrize("n", [6, 8, 11])
def test_angles_are_interpolated_exactly_for_trigonometric_polynomials(n):
    # Two harmonics are resolved by every number of cells here.
    def values(n):
        alpha = (np.arange(n) + 0.5) * 2 * np.pi / n
        return xr.DataArray(
            [1 + np.cos(alpha) - 0.3 * np.sin(2 * alpha)],
            {"s": [0.0], "alpha": alpha}, ("s", "alpha"),
        )  # fmt: skip

    found = to_angles(values(12), n)
    # Sums of a dozen numbers of order one.
    np.testing.assert_allclose(found, values(n), atol=1e-14)
    np.testing.assert_allclose(found["alpha"], values(n)["alpha"], atol=1e-14)


def test_means_of_paths_are_compared_in_standard_errors(model):
    first, second = (
        fp.sample_paths(model, 400, 1.0, 0.25, seed=seed) for seed in (1, 2)
    )
    found = fp.compare(first, second)["mean_xi1"]
    assert found.statistical
    assert found.within_errors is None
    # A normal deviate; 1e-6 is the chance to be beyond 4.9.
    assert 0 < found.in_errors < 4.9


def test_fewer_paths_with_the_same_seed_are_the_first_ones(model):
    few, many = (
        fp.sample_paths(model, n, 1.0, 0.25, seed=1, save_at=[0.5, 1.0])
        for n in (50, 80)
    )
    comparison = fp.compare(few, many)
    assert comparison["xi"].equal
    assert comparison["alpha"].equal
    assert not comparison["mean_xi1"].equal
    assert "path: 50 of 50 places of A and of 80 of B are in common" in (
        comparison.left_out
    )


def test_differences_come_as_a_dataset_on_common_coordinates(solution, tmp_path):
    found = fp.compare(solution, moved(solution, 1e-3)).to_xarray()
    assert found["density"].dims == ("s", "xi1", "xi2", "alpha")
    assert float(found["density"].sum()) == pytest.approx(1e-3, rel=1e-9)
    np.testing.assert_array_equal(
        found["relative_entropy_error"],
        2 * solution.errors["relative_entropy"],
    )
    assert found.attrs["equal"] == 0
    found.to_netcdf(tmp_path / "difference.nc", engine="h5netcdf")


def test_signs_of_zero_are_bits():
    zero = xr.DataArray([0.0])
    assert not difference_of("x", zero, -zero, None, False).equal
    assert difference_of("x", zero, -zero, None, False).relative == 0.0


def test_infinities_of_the_same_sign_are_equal():
    found = distance(np.array([np.inf, np.inf]), np.array([np.inf, -np.inf]))
    np.testing.assert_array_equal(found, [0.0, np.inf])


def test_texts_are_compared_too():
    texts = xr.DataArray(np.array(["finished", "failed"], dtype=object))
    assert difference_of("status", texts, texts, None, False).equal
    other = xr.DataArray(np.array(["finished", "pending"], dtype=object))
    assert difference_of("status", texts, other, None, False).largest == np.inf


def test_an_unknown_variable_is_named(solution):
    with pytest.raises(KeyError, match="`name` must be one of density_l1, density"):
        fp.compare(solution, solution)["velocity"]


def test_results_of_different_kinds_are_refused(solution, model):
    paths = fp.sample_paths(model, 10, 1.0, 0.5, seed=1)
    message = "`a` and `b` must be of the same kind, got solutions and paths; "
    with pytest.raises(ValueError, match=message):
        fp.compare(solution, paths)


def test_what_is_no_result_is_refused(solution):
    message = "`b` must be a result of fpsolve, got another dataset: it is not a result"
    with pytest.raises(ValueError, match=message):
        fp.compare(solution, xr.Dataset({"x": ("t", [1.0])}))
    with pytest.raises(TypeError, match="`result` must be a result of fpsolve"):
        fp.compare(solution, [1.0])


def test_a_layout_of_the_future_is_refused(solution):
    message = r"`a` must be a result .* it has layout 99, .* up to \d+; update fpsolve"
    with pytest.raises(ValueError, match=message):
        fp.compare(solution.to_xarray().assign_attrs(fpsolve_format=99), solution)


def test_the_figure_has_map_profiles_and_lines(solution):
    figure = plot_comparison(fp.compare(solution, moved(solution, 1e-3)))
    axes = [one for one in figure.axes if one.get_xlabel()]
    assert [one.get_xlabel() for one in axes] == [r"$\xi_1$", r"$\alpha$", "$s$"]
    assert "A = A, B = B" in figure.get_suptitle()


def test_series_are_drawn_with_the_errors_of_both(solution):
    series = {**solution.series, "mean_xi1": solution.series["mean_xi1"] + 1e-3}
    figure = plot_comparison(fp.compare(solution, replace(solution, series=series)))
    (lines,) = [one for one in figure.axes if "dashed: errors" in one.get_title()]
    assert lines.get_yscale() == "log"
    apart, error = (line.get_ydata() for line in lines.get_lines())
    np.testing.assert_allclose(apart, 1e-3, rtol=1e-9)
    expected = 2 * solution.errors["mean_xi1"]
    np.testing.assert_array_equal(error[expected > 0], expected[expected > 0])


def test_a_study_is_drawn_against_the_noise():
    noise = np.array([0.5, 1.0, 2.0])
    about = {"fpsolve_kind": "rate", "fpsolve_format": 1}
    gap, error = np.array([0.1, 0.4, 0.2]), np.full(3, 1e-3)
    first, second = (
        xr.Dataset(
            {"gap": ("noise", values), "gap_error": ("noise", error)},
            {"noise": noise}, about,
        )
        for values in (gap, gap + 1e-4)
    )  # fmt: skip
    comparison = fp.compare(first, second)
    assert comparison.within_errors
    (axes,) = plot_comparison(comparison).axes
    assert [text.get_text() for text in axes.get_xticklabels()] == ["0.5", "1", "2"]
    apart, together = (line.get_ydata() for line in axes.get_lines())
    np.testing.assert_allclose(apart, 1e-4, rtol=1e-9)
    np.testing.assert_array_equal(together, 2 * error)


def test_the_figure_of_equal_results_says_so(solution):
    figure = plot_comparison(fp.compare(solution, solution))
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert "no number differs" in texts


@pytest.fixture
def two_files(solution, tmp_path):
    """A solution of few series, and the same with one cell moved by 1e-3."""
    few = {name: solution.series[name] for name in ("s", "mass")}
    short = replace(solution, series=few, errors=None)
    short.save(tmp_path / "a.nc")
    moved(short, 1e-3).save(tmp_path / "b.nc")


def test_the_command_says_that_equal_files_are_equal(two_files, fpsolve):
    result = fpsolve("compare", "a.nc", "a.nc")
    assert result.exit_code == 0, result.output
    assert "equal: the same bits" in result.stdout


def test_the_command_prints_and_draws_what_differs(two_files, fpsolve, tmp_path):
    result = fpsolve("compare", "a.nc", "b.nc", "--out", "figures")
    assert result.exit_code == 1
    assert "different in 2 of" in result.stdout
    assert "s = 5" in result.stdout
    assert files(tmp_path / "figures") == ["a-b-difference.png"]


@pytest.mark.parametrize(("tolerance", "code"), [("0.5", 0), ("1e-6", 1)])
def test_a_tolerance_decides_the_exit_code(two_files, fpsolve, tolerance, code):
    result = fpsolve("compare", "a.nc", "b.nc", "--tolerance", tolerance,
                     "--no-figures")  # fmt: skip
    assert result.exit_code == code
    word = "within" if code == 0 else "beyond"
    assert f"{word} {float(tolerance):g} of the largest value" in result.stdout


def test_mistakes_of_the_command_are_one_line(two_files, fpsolve, tmp_path, solution):
    result = fpsolve("compare", "a.nc", "missing.nc")
    assert_mistake(result, "`path` must exist to be read, got `missing.nc`.")
    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(tmp_path / "x.nc", engine="h5netcdf")
    result = fpsolve("compare", "a.nc", "x.nc")
    assert_mistake(result, "cannot read `x.nc`: it is not a result of fpsolve")
    result = fpsolve("compare", "a.nc", "b.nc", "--tolerance", "-1")
    assert_mistake(result, "`--tolerance` must be positive")


def test_the_environment_names_no_host_no_user_and_no_path():
    import getpass
    import platform

    from fpsolve._support.environment import environment

    text = json.dumps(environment())
    for name in (platform.node(), getpass.getuser()):
        assert f'"{name}"' not in text
    assert "/" not in text
    assert {"python", "packages", "system", "architecture", "blas"} <= set(
        environment()
    )


def test_every_result_says_on_what_it_was_computed(model, uneven_grid):
    run = fp.solve(
        fp.drift_kick(model, uneven_grid),
        fp.initial.equilibrium(uneven_grid, model.potential),
        (0.0, 0.5), 0.25, boundary_tolerance=1.0, mass_tolerance=1.0,
    )  # fmt: skip
    known = run.provenance["environment"]
    assert known["packages"]["numpy"] == np.__version__
    assert {one["threads"] for one in known["blas"]} == {1}
    assert known["numba"]["threads"] >= 1
