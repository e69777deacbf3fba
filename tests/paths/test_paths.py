"""Ensembles of paths: the same path every time, and what is read off them."""

import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy import stats

import fpsolve as fp
from fpsolve.errors import NonFinitePathError, RunInterrupted
from fpsolve.paths import batch, laws
from fpsolve.paths.ensemble import START_BLOCK

CURVES = [
    fp.FixedBelt(),
    fp.MovingBelt(0.2),
    fp.RotatingNozzle(0.1, 0.8, 1.3, 0.2),
    fp.OscillatingNozzle(0.1, 1.1, 0.7),
    fp.EllipticNozzle(0.05, 0.5, 0.9, 2.0),
    fp.TabulatedCurve(np.linspace(0, 6, 13), -0.1 * np.linspace(0, 6, 13), [0.0] * 13),
]
POTENTIALS = [
    fp.QuadraticPotential(1.0, 0.7),
    fp.LinearPotential(1.3),
    fp.PowerPotential(4.0, 1.1),
    fp.PowerPotential(2.5),
    fp.FreePotential(),
]


def slow(potential):
    """The same potential as a user's own functions."""
    return fp.CallablePotential(potential.value, potential.gradient)


def with_a_hole(radius):
    """B = |ξ|²/2 whose gradient is NaN in a thin ring, where no probe point lies."""

    def gradient(xi1, xi2):
        distance = np.hypot(xi1, xi2)
        hole = (distance > radius) & (distance < radius + 0.2)
        return np.where(hole, np.nan, xi1), xi2

    return fp.CallablePotential(fp.QuadraticPotential().value, gradient)


@pytest.fixture
def small_batches(monkeypatch):
    """Batches of two start blocks, so that a test needs few paths for several."""
    monkeypatch.setattr(batch, "BATCH", 2 * START_BLOCK)


@pytest.mark.parametrize("potential", POTENTIALS)
@pytest.mark.parametrize("curve", CURVES)
def test_path_k_is_the_same_among_any_number_of_paths(potential, curve):
    model = fp.LayDownModel(potential, 0.8, curve)
    few, many = (
        fp.sample_paths(model, n, 3.0, 0.1, seed=5, save_at=(0.0, 1.3, 3.0))
        for n in (37, 1000)
    )
    assert np.array_equal(few.states, many.states[:, :, :37])


def test_path_k_is_the_same_in_the_user_s_own_potential_for_any_number():
    for method in ("splitting", "heun", "euler_maruyama"):
        model = fp.LayDownModel(slow(fp.PowerPotential(4.0)), 0.8, CURVES[2])
        few, many = (
            fp.sample_paths(model, n, 2.0, 0.1, seed=5, method=method)
            for n in (37, 1000)
        )
        assert np.array_equal(few.states, many.states[:, :, :37])


@pytest.mark.parametrize("potential", POTENTIALS[:4])
@pytest.mark.parametrize("method", ["splitting", "heun", "euler_maruyama"])
def test_compiled_potentials_and_the_user_s_own_give_the_same_paths(potential, method):
    ends = [
        fp.sample_paths(
            fp.LayDownModel(one, 0.8, CURVES[1]), 200, 2.0, 0.1, seed=5, method=method
        )
        for one in (potential, slow(potential))
    ]
    # The same formulas in another order of operations: rounding grows with the
    # sensitivity of a path, by no more than 1e4 over s = 2 (except through the kink
    # of |ξ|, which no path of this seed comes close to).
    np.testing.assert_allclose(ends[0].xi, ends[1].xi, rtol=0, atol=1e-11)
    np.testing.assert_allclose(ends[0].alpha, ends[1].alpha, rtol=0, atol=1e-11)


def test_paths_are_bitwise_equal_over_threads_batches_and_workers(
    model, on_threads, small_batches
):
    def sample(client=None):
        grid = fp.PhaseSpaceGrid(4.0, (8, 8, 8))
        return fp.sample_paths(
            model, 20_000, 1.0, 0.1, seed=9, save_at=(0.5, 1.0), histogram=grid,
            client=client,
        )  # fmt: skip

    one, two = on_threads(1, sample), on_threads(2, sample)
    with ThreadPoolExecutor(1) as executor:
        elsewhere = sample(executor)
    for other in (two, elsewhere):
        for name in ("states", "sums", "counts", "outside", "start", "end"):
            assert np.array_equal(getattr(one, name), getattr(other, name)), name


def test_given_starts_and_kept_ends_travel_to_workers(model, small_batches):
    n = 10_000
    start = np.zeros((n, 2)), np.linspace(0.0, 50.0, n)
    here = fp.sample_paths(model, n, 1.0, 0.1, seed=9, initial=start)
    with ThreadPoolExecutor(1) as executor:
        there = fp.sample_paths(
            model, n, 1.0, 0.1, seed=9, initial=start, client=executor
        )
    assert np.array_equal(here.states, there.states)


class OtherCode(ThreadPoolExecutor):
    """A process that imported a module before it was edited."""

    def submit(self, function, code, *arguments):
        return super().submit(function, "old" + code, *arguments)


def test_a_worker_with_other_code_is_not_believed(model):
    with (
        OtherCode(1) as executor,
        pytest.raises(RuntimeError, match="is other code"),
    ):
        fp.sample_paths(model, 10, 1.0, 0.1, seed=9, client=executor)


@pytest.mark.parametrize("curve", CURVES)
def test_a_continued_run_equals_an_uninterrupted_one_bitwise(curve):
    model = fp.LayDownModel(fp.PowerPotential(4.0), 0.8, curve)
    # 0.7 and 0.1 are not exact in binary, and 7 steps are no multiple of four.
    first = fp.sample_paths(model, 100, 0.7, 0.1, seed=3)
    second = first.continued(2.0, save_at=(1.1, 2.0))
    whole = fp.sample_paths(model, 100, 2.0, 0.1, seed=3, save_at=(0.7, 1.1, 2.0))
    assert np.array_equal(first.states[0], whole.states[0])
    assert np.array_equal(second.states, whole.states[1:])
    assert np.array_equal(second.s, whole.s[1:])
    assert np.array_equal(second.replay(11).xi[-1], whole.xi[-1, 11])


@pytest.mark.parametrize("s_start", [0.0, -0.3])
def test_paths_that_went_on_report_what_uninterrupted_ones_do(tmp_path, s_start):
    model = fp.LayDownModel(fp.PowerPotential(4.0), 0.8, fp.RotatingNozzle(0.1, 0.8, 1))
    grid = fp.PhaseSpaceGrid(3.0, (8, 6, 4))
    options = {"seed": 3, "s_start": s_start, "histogram": grid}
    saves = (s_start + 1.1, s_start + 2.0)
    first = fp.sample_paths(model, 100, s_start + 0.7, 0.1, **options)
    again = first.continued(s_start + 0.9).continued(saves[-1], save_at=saves)
    whole = fp.sample_paths(model, 100, saves[-1], 0.1, save_at=saves, **options)
    assert again.ensemble == whole.ensemble
    for name in ("s", "states", "sums", "counts", "outside", "start", "end"):
        assert np.array_equal(getattr(again, name), getattr(whole, name)), name
    assert again.provenance["n_steps"] == whole.provenance["n_steps"]
    functions = [lambda xi1, xi2, alpha: xi1, lambda xi1, xi2, alpha: np.cos(alpha)]
    averages = whole.time_averages(functions)
    assert np.array_equal(again.time_averages(functions), averages)
    assert np.array_equal(again.replay(7, every=3).xi, whole.replay(7, every=3).xi)
    assert np.array_equal(again.replay(7, every=3).s, whole.replay(7, every=3).s)
    loaded = fp.load(again.save(tmp_path / "paths.nc"))
    assert np.array_equal(loaded.time_averages(functions), averages)
    assert np.array_equal(loaded.histogram(grid, saves[0]).counts, whole.counts[0])
    assert np.array_equal(fp.rerun(again).counts, whole.counts)


def test_what_an_interrupt_leaves_of_paths_that_went_on_begins_at_the_start(
    model, small_batches
):
    def stop(n_done, n_total, s):
        if n_done > 8192 * 10:
            raise KeyboardInterrupt

    first = fp.sample_paths(model, 10_000, 1.0, 0.1, seed=3)
    with pytest.raises(RunInterrupted) as caught:
        first.continued(2.0, progress=stop)
    whole = fp.sample_paths(model, 8192, 2.0, 0.1, seed=3)
    partial = caught.value.solution
    for name in ("s", "states", "sums", "start", "end"):
        assert np.array_equal(getattr(partial, name), getattr(whole, name)), name
    assert np.array_equal(partial.replay(8000).xi, whole.replay(8000).xi)


def test_where_paths_are_saved_does_not_change_them(model):
    rarely = fp.sample_paths(model, 50, 2.0, 0.1, seed=3)
    often = fp.sample_paths(model, 50, 2.0, 0.1, seed=3, save_at=np.arange(21) / 10)
    assert np.array_equal(rarely.states[-1], often.states[-1])


@pytest.mark.parametrize("curve", CURVES)
def test_a_replayed_path_goes_through_what_was_saved_bitwise(curve):
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)
    paths = fp.sample_paths(model, 300, 2.0, 0.1, seed=3, save_at=np.arange(21) / 10)
    path = paths.replay(211)
    assert np.array_equal(path.s, paths.s)
    assert np.array_equal(path.xi, paths.xi[:, 211])
    assert np.array_equal(path.alpha, paths.alpha[:, 211])
    assert np.array_equal(path.eta, paths.eta[:, 211])
    every = paths.replay(211, every=8)
    assert np.array_equal(every.xi, path.xi[[0, 8, 16, 20]])


def test_a_replay_in_a_potential_that_has_changed_is_noticed():
    stiffness = [1.0]

    def value(xi1, xi2):
        return stiffness[0] * (xi1**2 + xi2**2) / 2

    def gradient(xi1, xi2):
        return stiffness[0] * xi1, stiffness[0] * xi2

    model = fp.LayDownModel(fp.CallablePotential(value, gradient), 1.0)
    paths = fp.sample_paths(model, 3, 1.0, 0.1, seed=3)
    assert np.array_equal(paths.replay(1).xi[-1], paths.xi[-1, 1])
    stiffness[0] = 4.0
    with pytest.warns(UserWarning, match=r"the paths end 0\.\d+ away in xi from where"):
        paths.replay(1)


def test_paths_that_were_not_kept_can_be_replayed(model):
    law = laws.GaussianLaw((1.0, 0.0), 0.3, 0.2, 3.0)
    kept, gone = (
        fp.sample_paths(model, 5000, 1.0, 0.1, seed=3, initial=law, keep=keep)
        for keep in (True, False)
    )
    assert np.array_equal(gone.replay(4711).xi[-1], kept.xi[-1, 4711])
    assert gone.states.size == gone.end.size == 0


def test_the_fibre_on_the_belt_is_parameterised_by_its_length():
    # |dη/ds| = 1: every step moves η by at most ds, and by ds up to the turn within.
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, CURVES[2])
    path = fp.sample_paths(model, 1, 20.0, 0.01, seed=8).replay(0)
    lengths = np.linalg.norm(np.diff(path.eta, axis=0), axis=1)
    assert lengths.max() <= 0.01 * (1 + 1e-9)
    # Two half steps at an angle δ to each other reach cos(δ/2) ds; E δ² = A² ds.
    assert lengths.mean() > 0.01 * (1 - 0.01)


def test_seeds_and_generators_choose_the_paths(model):
    def end(**chosen):
        return fp.sample_paths(model, 10, 1.0, 0.1, **chosen)

    assert np.array_equal(end(seed=1).states, end(seed=1).states)
    assert not np.array_equal(end(seed=1).states, end(seed=2).states)
    drawn = end(rng=np.random.default_rng(1))
    assert np.array_equal(drawn.states, end(rng=np.random.default_rng(1)).states)
    # The recorded seed repeats what a generator began.
    assert np.array_equal(drawn.states, end(seed=drawn.seed).states)
    sequence = np.random.SeedSequence(5)
    assert np.array_equal(end(seed=sequence).states, end(seed=sequence).states)


def test_paths_of_one_ensemble_are_independent(model):
    paths = fp.sample_paths(model, 40_000, 2.0, 0.1, seed=3)
    xi = paths.xi[-1, :, 0]
    for lag in (1, 64, START_BLOCK):
        correlation = np.corrcoef(xi[:-lag], xi[lag:])[0, 1]
        # Four standard errors 1/√n.
        assert abs(correlation) < 4 / np.sqrt(xi.size - lag)


def test_moments_are_those_of_the_positions(model):
    paths = fp.sample_paths(model, 30_000, 1.0, 0.1, seed=3, save_at=(0.5, 1.0))
    moments = paths.moments()
    xi1, xi2 = paths.xi[..., 0], paths.xi[..., 1]
    expected = {
        "mean_xi1": xi1.mean(axis=1),
        "mean_xi2": xi2.mean(axis=1),
        "variance_xi1": xi1.var(axis=1, ddof=1),
        "variance_xi2": xi2.var(axis=1, ddof=1),
        "covariance": [np.cov(a, b)[0, 1] for a, b in zip(xi1, xi2, strict=True)],
        "mean_cos_alpha": np.cos(paths.alpha).mean(axis=1),
        "mean_sin_alpha": np.sin(paths.alpha).mean(axis=1),
        "mean_square": (xi1**2 + xi2**2).mean(axis=1),
    }
    assert moments.names == tuple(expected)
    for name, value in expected.items():
        # Sums of 3e4 terms in another order.
        np.testing.assert_allclose(moments.values[name], value, rtol=0, atol=1e-12)
    value, error = paths.expectation(lambda xi1, xi2, alpha: xi1**2 + xi2**2)
    np.testing.assert_allclose(value, moments["mean_square"][0], rtol=1e-12)
    np.testing.assert_allclose(error, moments["mean_square"][1], rtol=1e-9)


def test_standard_errors_are_the_spread_over_ensembles(model):
    runs = [
        fp.sample_paths(model, 500, 1.0, 0.1, seed=seed, keep=False).moments()
        for seed in range(400)
    ]
    for name in runs[0]:
        values = np.array([run.values[name][0] for run in runs])
        stated = np.mean([run.standard_errors[name][0] for run in runs])
        # The spread of 400 values is known to 1/√800 = 3.5 %; four times that.
        assert abs(values.std(ddof=1) / stated - 1) < 0.15, name


def test_histograms_count_every_path(model):
    grid = fp.PhaseSpaceGrid((1.0, 1.5), (6, 8, 5))
    collected = fp.sample_paths(model, 5000, 3.0, 0.1, seed=3, histogram=grid)
    streamed = fp.sample_paths(
        model, 5000, 3.0, 0.1, seed=3, histogram=grid, keep=False
    )
    plain = fp.sample_paths(model, 5000, 3.0, 0.1, seed=3)
    one, two, three = (
        collected.histogram(), streamed.histogram(grid), plain.histogram(grid, 3.0),
    )  # fmt: skip
    assert np.array_equal(one.counts, two.counts)
    assert np.array_equal(one.counts, three.counts)
    assert one.outside > 0
    assert one.counts.sum() + one.outside == 5000
    edges = [np.linspace(-1, 1, 7), np.linspace(-1.5, 1.5, 9), np.linspace(0, 7, 6)]
    edges[2] = np.linspace(0, 2 * np.pi, 6)
    points = np.column_stack([plain.xi[0], plain.wrapped_alpha[0]])
    assert np.array_equal(one.counts, np.histogramdd(points, edges)[0])
    assert one.density.sum() * grid.cell_volume == pytest.approx(
        1 - one.outside / 5000, rel=1e-12
    )
    np.testing.assert_allclose(
        plain.marginal("alpha", grid=grid), one.density.sum((0, 1)) * grid.cell_area
    )
    assert one.standard_error.max() == pytest.approx(
        np.sqrt(one.counts.max() * (1 - one.counts.max() / 5000)) / 5000
        / grid.cell_volume, rel=1e-12,
    )  # fmt: skip


def test_wrapped_angles_lie_in_one_turn_and_differ_by_whole_turns():
    model = fp.LayDownModel(fp.QuadraticPotential(), 8.0)
    paths = fp.sample_paths(model, 500, 5.0, 0.1, seed=3)
    turns = (paths.alpha - paths.wrapped_alpha) / (2 * np.pi)
    assert paths.wrapped_alpha.min() >= 0
    assert paths.wrapped_alpha.max() < 2 * np.pi
    np.testing.assert_allclose(turns, np.rint(turns), rtol=0, atol=1e-12)
    assert np.abs(turns).max() > 3
    assert np.all(fp.paths.histogram.wrapped(np.array([-1e-300, -0.0])) == 0.0)


def test_unwrapped_angles_are_continuous_along_a_path(model):
    path = fp.sample_paths(model, 1, 50.0, 0.01, seed=6).replay(0)
    # A step turns by noise of deviation 0.1, and by |∇B| ds < 0.05; a turn missed
    # would show as 6.28.
    assert np.abs(np.diff(path.alpha)).max() < 1.0
    assert np.ptp(path.alpha) > 2 * np.pi


def test_unwrapped_angles_of_the_random_walk_have_variance_a_squared_s():
    # B = 0: α is A W, exactly.
    model = fp.LayDownModel(fp.FreePotential(), 3.0)
    start = np.zeros(2), 3.1
    paths = fp.sample_paths(model, 40_000, 10.0, 2.5, seed=6, initial=start)
    away = (paths.alpha[-1] - 3.1) / (3.0 * np.sqrt(10.0))
    assert stats.kstest(away, "norm").pvalue > 1e-3


def test_time_averages_are_the_trapezoidal_rule_over_every_step():
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
    paths = fp.sample_paths(model, 30, 60.0, 0.1, seed=3, save_at=(0.0, 2.0, 60.0))
    functions = [
        lambda xi1, xi2, alpha: xi1**2 + xi2**2,
        lambda xi1, xi2, alpha: np.cos(alpha),
        lambda xi1, xi2, alpha: 3.0,
    ]
    averages = paths.time_averages(functions)
    assert averages.shape == (3, 3, 30)
    assert np.isnan(averages[:, 0]).all()
    path = paths.replay(17)
    for row, f in enumerate(functions):
        values = np.broadcast_to(f(*path.xi.T, path.alpha), path.s.shape)
        for saved, n in ((1, 21), (2, 601)):
            expected = np.trapezoid(values[:n], path.s[:n]) / (path.s[n - 1])
            # Sums of 600 terms in another order.
            assert averages[row, saved, 17] == pytest.approx(expected, rel=1e-11)
    assert np.array_equal(paths.time_averages(functions[0])[1:], averages[0, 1:])


def test_the_average_of_an_indicator_is_the_share_of_the_length(model):
    paths = fp.sample_paths(model, 50, 2.0, 0.25, seed=3)
    share = paths.time_averages(lambda xi1, xi2, alpha: np.hypot(xi1, xi2) < 1.0)
    number = paths.time_averages(
        lambda xi1, xi2, alpha: np.where(np.hypot(xi1, xi2) < 1.0, 1.0, 0.0)
    )
    assert np.array_equal(share, number)
    assert 0.0 < share[-1].mean() < 1.0


def test_time_averages_of_paths_that_were_not_kept_are_the_same(model):
    kept, gone = (
        fp.sample_paths(model, 2500, 1.0, 0.1, seed=3, keep=keep)
        for keep in (True, False)
    )
    f = np.hypot
    assert np.array_equal(
        kept.time_averages(lambda a, b, c: f(a, b)),
        gone.time_averages(lambda a, b, c: f(a, b)),
    )


def test_memory_does_not_grow_with_the_number_of_paths_that_are_not_kept(
    model, small_batches
):
    grid = fp.PhaseSpaceGrid(4.0, (24, 24, 16))

    def peak(n_batches):
        n_paths = n_batches * 2 * START_BLOCK
        tracemalloc.start()
        try:
            fp.sample_paths(
                model, n_paths, 0.5, 0.25, seed=1, histogram=grid, keep=False
            )
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    peak(2)
    # A batch of 8192 states has 330 kB, its histogram 74 kB; 18 more batches add less
    # than one of either.
    assert peak(20) - peak(2) < 70_000


def test_progress_counts_path_steps(model, small_batches):
    told = []
    fp.sample_paths(
        model, 20_000, 1.0, 0.1, seed=3, progress=lambda *told_: told.append(told_)
    )
    done, total, s = zip(*told, strict=True)
    assert done == (81_920, 163_840, 200_000)
    assert set(total) == {200_000}
    assert s[-1] == pytest.approx(1.0)


def test_an_interrupt_leaves_the_finished_batches(model, small_batches):
    def stop(n_done, n_total, s):
        if n_done > 100_000:
            raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as caught:
        fp.sample_paths(model, 20_000, 1.0, 0.1, seed=3, progress=stop)
    partial = caught.value.solution
    whole = fp.sample_paths(model, 20_000, 1.0, 0.1, seed=3)
    assert partial.status == "interrupted"
    assert partial.n_paths == 2 * START_BLOCK
    assert np.array_equal(partial.states, whole.states[:, :, : partial.n_paths])


def test_an_interrupt_in_the_first_batch_leaves_what_it_reached(model):
    def stop(n_done, n_total, s):
        if s > 50:
            raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as caught:
        fp.sample_paths(
            model, 50, 200.0, 0.1, seed=3, save_at=(20.0, 200.0), progress=stop
        )
    partial = caught.value.solution
    assert partial.s.tolist() == pytest.approx([20.0])
    assert partial.n_paths == 50
    # It goes on from where it stopped, which is not where anything was saved.
    reached = partial.ensemble.schedule.n_steps
    assert 500 < reached < 2000
    whole = fp.sample_paths(model, 50, 200.0, 0.1, seed=3)
    assert np.array_equal(partial.continued(200.0).states, whole.states)
    assert np.array_equal(partial.replay(3).xi, whole.replay(3).xi[: reached + 1])


def test_a_bad_gradient_names_the_path_and_the_place_and_keeps_finished_batches(
    small_batches,
):
    model = fp.LayDownModel(with_a_hole(2.2), 1.0)
    inside, outside = np.zeros((8192, 2)), np.tile([2.25, 0.0], (10, 1))
    start = np.concatenate([inside, outside]), np.zeros(8202)
    pattern = r"path 8192 .* s = 0: .* xi = \(2\.3, 0\) is \(nan, 0\); define it"
    with pytest.raises(NonFinitePathError, match=pattern) as caught:
        fp.sample_paths(model, 8202, 0.2, 0.1, seed=1, initial=start)
    error = caught.value
    assert (error.path, error.s, error.gradient[1]) == (8192, 0.0, 0.0)
    assert error.solution.n_paths == 8192


def test_a_bad_gradient_is_met_with_every_method():
    model = fp.LayDownModel(with_a_hole(2.2), 1.0)
    for method in ("splitting", "euler_maruyama", "heun"):
        with pytest.raises(NonFinitePathError, match="the gradient of the potential"):
            fp.sample_paths(
                model, 5, 1.0, 0.1, seed=1, method=method, initial=((2.3, 0.0), 0.0)
            )


def test_a_force_that_overflows_is_an_error_and_not_a_nan():
    model = fp.LayDownModel(fp.PowerPotential(4.0), 1.0)
    start = np.zeros((3, 2)), np.zeros(3)
    start[0][1] = 1e200, 0.0
    with pytest.raises(NonFinitePathError, match=r"path 1 .* is \(inf, ") as caught:
        fp.sample_paths(model, 3, 1.0, 0.1, seed=1, initial=start)
    assert caught.value.path == 1


def test_repr_says_what_was_sampled(model):
    paths = fp.sample_paths(model, 10, 2.0, 0.5, seed=1, save_at=np.arange(5) / 2)
    assert repr(paths) == (
        "Paths(10 paths, splitting, ds = 0.5, seed = 1, saved at s = 0, 0.5, 1, 1.5, "
        "…, finished)"
    )
    assert paths.provenance["n_steps"] == 40
    assert paths.model == model
    assert paths.initial == laws.PointLaw()
    assert paths.s_start == 0.0
