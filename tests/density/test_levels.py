"""Extrapolation to any order, its errors, and steps chosen for a tolerance."""

import warnings
from functools import cache

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import DecayingCirculation

import fpsolve as fp
from fpsolve.density import passes
from fpsolve.density.unresolved import unresolved
from fpsolve.evolution.richardson import tableau
from fpsolve.grids.diagnostics import l1_distance

# Cells that resolve the start to 1e-10 or so: what they do not resolve changes with the
# step, and is no power of it.
GRID = fp.PhaseSpaceGrid(half_width=7.0, shape=(40, 40, 32))
MODEL = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=1.0)
P0 = fp.initial.gaussian(
    GRID, mean=(0.7, 0.3), variance=0.8, angle=1.0, concentration=1.0
)
# What coarse cells leave at the edge and below zero is not in question here.
LAX = {"boundary_tolerance": 1.0, "negative_tolerance": 9.0,
       "circulation_tolerance": 9.0, "entropy_tolerance": 9.0}  # fmt: skip


def scheme_on(grid=GRID, model=MODEL, **options):
    return fp.drift_kick(model, grid, **{"translation": "fourier", **options})


def step_part(found):
    """The estimated error of the step alone."""
    return found.errors["density_l1"][-1] - unresolved(found.final, found.grid)


@cache
def converged():
    """The density of the same cells with a step of no error: 6 levels of 1/24.

    Its estimate is the check that there is none.
    """
    found = fp.solve(scheme_on(), P0, (0.0, 1.0), 1 / 24, extrapolate=6, **LAX,
                     record_every=6)  # fmt: skip
    assert step_part(found) < 2e-11
    return found


@pytest.mark.parametrize("levels", range(2, MOST := 9))
def test_the_tableau_cancels_every_even_power_it_can(levels):
    best, lower = tableau(levels)
    inverse = 1.0 / np.arange(1, levels + 1.0)
    for weights, n in ((best, levels), (lower, levels - 1)):
        powers = [weights @ inverse ** (2 * m) for m in range(n)]
        # Weights of up to 5e2, rounded.
        np.testing.assert_allclose(powers, [1.0] + [0.0] * (n - 1), atol=1e-12)
        assert abs(weights @ inverse ** (2 * n)) > 1e-12


# Cells for what is not about accuracy.
FEW = fp.PhaseSpaceGrid(half_width=6.0, shape=(14, 14, 8))
FEW_P0 = fp.initial.gaussian(
    FEW, mean=(0.7, 0.3), variance=0.8, angle=1.0, concentration=1.0
)


# Finest number of steps and error there, a few times what was measured.
@pytest.mark.parametrize(
    ("levels", "first", "ceiling"), [(2, 4, 1e-5), (3, 2, 2e-5), (4, 2, 2e-6)]
)
def test_levels_are_of_twice_their_order_at_every_halving(levels, first, ceiling):
    estimates = []

    def error_of(n):
        found = fp.solve(scheme_on(), P0, (0.0, 1.0), 1.0 / n, extrapolate=levels,
                         record_every=n, **LAX)  # fmt: skip
        estimates.append(step_part(found))
        return l1_distance(found.final, converged().final, GRID)

    convergence = measure_order(error_of, first=first)
    # Orders are even: a band below one tells each from the others. The next term makes
    # it 7.2 and 7.4 for four levels at steps as long as these, 5.7 and 5.9 for three.
    assert_order(convergence, 2 * levels, ceiling, band=0.3 if levels < 4 else 0.9)
    assert (convergence.errors < estimates).all()
    # That of the order below, 2n − 2, and no less sharp.
    assert np.log2(np.divide(estimates[:-1], estimates[1:])) == pytest.approx(
        2 * levels - 2, abs=0.9
    )


def test_errors_cover_every_number_at_every_number_of_levels():
    exact = converged()
    for levels in range(2, 7):
        found = fp.solve(scheme_on(), P0, (0.0, 1.0), 0.25, extrapolate=levels, **LAX)
        error = l1_distance(found.final, exact.final, GRID)
        assert error < found.errors["density_l1"][0]
        for name in ("mass", "relative_entropy", "entropy_dissipation", "mean_xi1",
                     "variance_xi2", "covariance", "mean_sin_alpha"):  # fmt: skip
            # Records of every sixth of 24 steps in a quarter of s.
            apart = np.abs(found.series[name] - exact.series[name])
            assert (apart <= found.errors[name] + exact.errors[name]).all(), name
        assert found.provenance["levels"] == levels
        assert found.provenance["n_steps"] == 4 * levels * (levels + 1) // 2
        assert np.abs(found.mass - 1.0).max() < 1e-13


def test_the_error_is_that_of_the_step_of_the_equation_itself():
    """Against a density that is known: E G falls like e^{−A²s/2}, all else rests."""
    exact = DecayingCirculation(
        fp.QuadraticPotential(), 1.0,
        fp.PhaseSpaceGrid(half_width=7.0, shape=(44, 44, 16)),
    )  # fmt: skip
    scheme = scheme_on(exact.grid, exact.model)
    found = fp.solve(scheme, exact.initial(), (0.0, 1.0), 0.25, extrapolate=4,
                     record_every=4)  # fmt: skip
    error = l1_distance(found.final, exact.density(1.0), exact.grid)
    # What the box cuts off, and its edge reflects, is 2e-9.
    assert error < found.errors["density_l1"][0] + 1e-8
    assert found.errors["density_l1"][0] < 1e-6


def test_two_levels_are_what_true_is_up_to_rounding():
    run = {"s_span": (0.0, 1.0), "ds": 0.25, "save_at": (0.5, 1.0), **LAX}
    one = fp.solve(scheme_on(), P0, extrapolate=True, **run)
    other = fp.solve(scheme_on(), P0, extrapolate=2, **run)
    np.testing.assert_allclose(other.densities, one.densities, rtol=0, atol=1e-15)
    for name in one.series:
        np.testing.assert_allclose(
            other.series[name], one.series[name], rtol=1e-13, atol=1e-14
        )
    assert other.errors["density_l1"] == pytest.approx(one.errors["density_l1"])


def test_the_shortest_waves_tell_what_the_cells_leave():
    """Against finer cells, at the same points: a third of them, in every direction."""
    fine = fp.PhaseSpaceGrid(half_width=6.0, shape=(54, 54, 36))
    run = {"s_span": (0.0, 1.0), "ds": 0.25, "extrapolate": 5, "record_every": 4, **LAX}

    def run_on(grid):
        p0 = fp.initial.gaussian(grid, (0.7, 0.3), 0.5, 1.0, 2.0)
        return fp.solve(scheme_on(grid), p0, **run)

    exact = run_on(fine).final[1::3, 1::3, 1::3]
    coarse = fp.PhaseSpaceGrid(half_width=6.0, shape=(18, 18, 12))
    found = run_on(coarse)
    error, told = l1_distance(found.final, exact, coarse), found.errors["density_l1"][0]
    # A few times; ten or so is usual.
    assert 1.5 * error < told < 30 * error
    # Most of it is that of the cells.
    assert unresolved(found.final, coarse) > 0.9 * told


def test_one_wave_is_unresolved_by_its_own_amplitude():
    grid = fp.PhaseSpaceGrid(half_width=3.0, shape=(12, 13, 8))
    volume = 36 * 2 * np.pi
    for axis, n in enumerate(grid.shape):
        shape = np.ones(3, dtype=int)
        shape[axis] = n
        for mode in range(1, n // 2 + 1):
            turn = 2 * np.pi * mode * (np.arange(n) + 0.5) / n
            p = np.zeros(grid.shape) + np.sin(turn).reshape(shape)
            expected = volume if mode > n // 2 - 2 else 0.0
            assert unresolved(p, grid) == pytest.approx(expected, abs=1e-11)


def test_steps_out_of_the_asymptotic_range_are_told_and_covered():
    model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=4.0)
    scheme = scheme_on(model=model)
    exact = fp.solve(scheme, P0, (0.0, 1.0), 1 / 32, extrapolate=5, record_every=32,
                     **LAX).final  # fmt: skip
    with pytest.warns(UserWarning, match=r"A² ds = 8 \(at most 5\)"):
        found = fp.solve(scheme, P0, (0.0, 1.0), 0.5, extrapolate=3, **LAX)
    assert l1_distance(found.final, exact, GRID) < found.errors["density_l1"][0]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-8])
def test_a_tolerance_chooses_step_and_levels_and_is_met(tolerance):
    found = fp.solve(scheme_on(), P0, (0.0, 1.0), tolerance=tolerance, **LAX)
    error = l1_distance(found.final, converged().final, GRID)
    assert error < found.errors["density_l1"][0] <= 1.01 * tolerance
    assert 2 <= found.provenance["levels"] <= 8
    # What it did can be asked for by hand, and is the same.
    again = fp.solve(scheme_on(), P0, (0.0, 1.0), found.ds,
                     extrapolate=found.provenance["levels"], **LAX)  # fmt: skip
    np.testing.assert_array_equal(again.final, found.final)


def test_the_step_for_a_tolerance_divides_every_stop():
    stops = (0.3, 0.75, 1.2)
    found = fp.solve(scheme_on(), P0, (0.0, 1.2), tolerance=1e-4, save_at=stops, **LAX)
    assert found.saved_s == pytest.approx(stops)
    assert (found.errors["density_l1"] <= 1e-4).all()


def test_where_no_step_reaches_a_tolerance_the_best_is_kept(monkeypatch):
    monkeypatch.setattr(passes.levels, "MOST_LEVELS", 2)
    monkeypatch.setattr(passes, "MOST_HALVINGS", 1)
    told = r"tolerance 1e-07 not reached: the error is estimated at .*refine the grid"
    with pytest.raises(fp.errors.ToleranceError, match=told) as caught:
        fp.solve(scheme_on(), P0, (0.0, 1.0), tolerance=1e-7, **LAX)
    kept = caught.value.solution
    # Of ds = 1/4 and 1/8 the shorter.
    assert (kept.ds, kept.provenance["levels"]) == (0.125, 2)
    assert kept.errors["density_l1"][0] == pytest.approx(caught.value.reached, rel=0.01)


def test_a_tolerance_is_refused_where_the_cells_do_not_tell_what_they_leave():
    """Piecewise interpolation of a narrow start would seem right to 1e-6."""
    scheme = scheme_on(translation="lagrange")
    with pytest.raises(ValueError, match=r"got drift_kick with piecewise .*fourier"):
        fp.solve(scheme, P0, (0.0, 1.0), tolerance=1e-6)


@pytest.mark.parametrize("options", [{"extrapolate": 3, "ds": 0.25},
                                     {"tolerance": 0.3}])  # fmt: skip
def test_a_killed_run_goes_on_bitwise_in_every_pass(tmp_path, options):
    run = {"scheme": scheme_on(FEW), "p0": FEW_P0, "s_span": (0.0, 1.0),
           "save_at": (0.5, 1.0), **options, **LAX}  # fmt: skip
    whole = fp.solve(**run)
    n_steps = whole.provenance["n_steps"]
    for stop in (1, n_steps // 2, n_steps - 1):
        folder = tmp_path / str(stop)

        def kill(n_done, n_total, s, stop=stop):
            if n_done >= stop:
                raise KeyboardInterrupt

        checkpoint = fp.Checkpoint(folder, every=1)
        with pytest.raises(fp.errors.RunInterrupted) as caught:
            fp.solve(**run, checkpoint=checkpoint, progress=kill)
        assert caught.value.solution.status == "interrupted"
        again = fp.resume(folder)
        np.testing.assert_array_equal(np.asarray(again.densities), whole.densities)
        for name, values in whole.series.items():
            np.testing.assert_array_equal(again.series[name], values)
            np.testing.assert_array_equal(again.errors[name], whole.errors[name])


def test_levels_are_saved_loaded_and_repeated(tmp_path):
    whole = fp.solve(scheme_on(FEW), FEW_P0, (0.0, 0.5), 0.25, extrapolate=3, **LAX)
    loaded = fp.load(whole.save(tmp_path / "levels.nc"))
    assert loaded.provenance["levels"] == 3
    again = fp.rerun(loaded)
    np.testing.assert_array_equal(again.final, whole.final)


REFUSED = [
    ({"extrapolate": 0}, ValueError, r"`extrapolate` must be at least 2 .* got 0"),
    ({"extrapolate": 1}, ValueError, r"`extrapolate` must be at least 2 .* got 1"),
    ({"extrapolate": -3}, ValueError, r"`extrapolate` must be at least 0, got -3"),
    ({"extrapolate": 9}, ValueError, r"at most 8 levels, got 9"),
    ({"extrapolate": 2.0}, TypeError, r"True or False, or a number .* got 2\.0"),
    ({"extrapolate": "yes"}, TypeError, r"True or False, or a number .* got 'yes'"),
    ({"ds": None}, TypeError, r"`ds` must be given where `tolerance` is not"),
    ({"tolerance": 0.0}, ValueError, r"`tolerance` must lie between 0 and 1, got 0"),
    ({"tolerance": np.nan}, ValueError, r"`tolerance` must lie between 0 and 1, got n"),
    ({"tolerance": 1e-3, "extrapolate": 4}, ValueError,
     r"`extrapolate` must be left out with `tolerance`, got 4"),
    ({"tolerance": 1e-3, "ds": None, "save_at": (0.1234567, 1.0)}, ValueError,
     r"`save_at` must hold multiples of a step that can be found"),
]  # fmt: skip


@pytest.mark.parametrize(("options", "kind", "told"), REFUSED)
def test_what_makes_no_sense_is_refused(options, kind, told):
    with pytest.raises(kind, match=told):
        fp.solve(scheme_on(FEW), FEW_P0, (0.0, 1.0), **{"ds": 0.25, **options}, **LAX)


@pytest.mark.parametrize("asked", [{"extrapolate": 3, "ds": 0.25}, {"tolerance": 1e-4}])
def test_schemes_with_other_powers_of_the_step_are_refused_with_the_reason(asked):
    limited = fp.drift_kick(MODEL, FEW, positive=True)
    with pytest.raises(ValueError, match="got drift_kick, which has a limiter"):
        fp.solve(limited, FEW_P0, (0.0, 1.0), **asked)
    other = fp.semi_lagrangian(MODEL, FEW)
    told = "got semi_lagrangian, which has others, too.*extrapolate=True"
    with pytest.raises(ValueError, match=told):
        fp.solve(other, FEW_P0, (0.0, 1.0), **asked)
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 2.0, 1.0)
    grid = fp.SmoothPhaseSpaceGrid(5.0, 2.5, (8, 8, 8, 12))
    p0 = np.ones(grid.shape)
    told = "got smooth_drift_kick, which has others, too"
    with pytest.raises(ValueError, match=told):
        fp.solve(fp.smooth_drift_kick(model, grid), p0, (0.0, 1.0), **asked)


def test_cells_that_leave_more_than_the_tolerance_are_told():
    told = r"tolerance 1e-06 not reached: .*the cells leave .* of it: refine the grid"
    with pytest.raises(fp.errors.ToleranceError, match=told) as caught:
        fp.solve(scheme_on(FEW), FEW_P0, (0.0, 1.0), tolerance=1e-6, **LAX)
    kept = caught.value.solution
    assert kept.errors["density_l1"][0] == pytest.approx(caught.value.reached, rel=0.1)


def test_nothing_is_warned_of_in_a_run_that_is_well():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fp.solve(scheme_on(), P0, (0.0, 0.5), 0.25, extrapolate=3, **LAX)
