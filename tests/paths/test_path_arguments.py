"""What `sample_paths` and `Paths` say of arguments that are wrong."""

from dataclasses import replace

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import FpsolveError, GridMismatchError, MemoryLimitError

GOOD = {"n_paths": 10, "s_end": 1.0, "ds": 0.1, "seed": 1}
WRONG_VALUES = {
    "no paths": ({"n_paths": 0}, "`n_paths` must be at least 1, got 0"),
    "negative step": ({"ds": -0.1}, r"`ds` must be positive, got -0\.1\."),
    "no step": ({"ds": 0.0}, r"`ds` must be positive, got 0\."),
    "step that is none": ({"ds": np.nan}, r"`ds` must be positive, got nan\."),
    "step that does not fit": (
        {"ds": 0.3},
        r"`ds` must divide the span 1 into whole steps, got 0\.3; use ds = 0\.25\.",
    ),
    "end before the start": (
        {"s_start": 2.0},
        r"`s_span` must be \(start, end\) with start < end, got \(2, 1\)\.",
    ),
    "save off the steps": (
        {"save_at": (0.25,)},
        r"`save_at` must hold multiples of ds = 0\.1 from 0, got 0\.25; the nearest",
    ),
    "save beyond the end": (
        {"save_at": (1.5,)},
        r"`save_at` must lie in the span \[0, 1\], got 1\.5\.",
    ),
    "save nowhere": (
        {"save_at": (np.nan,)},
        r"`save_at` must hold finite numbers, got nan\.",
    ),
    "unknown method": (
        {"method": "milstein"},
        "`method` must be one of 'splitting', 'euler_maruyama', 'heun', got "
        r"'milstein'\.",
    ),
    "negative seed": ({"seed": -4}, "`seed` must be at least 0, got -4"),
    "start that is not finite": (
        {"initial": (np.full((10, 2), np.nan), 0.0)},
        r"`initial` must be finite, got nan in xi of path 0\.",
    ),
    "angle that is not finite": (
        {"initial": ((0.0, 0.0), np.array([0.0] * 9 + [np.inf]))},
        r"`initial` must be finite, got inf in alpha of path 9\.",
    ),
}
WRONG_KINDS = {
    "paths in parts": ({"n_paths": 2.5}, "`n_paths` must be an integer, got 2.5"),
    "neither seed nor rng": (
        {"seed": None},
        "exactly one of `seed` and `rng` must be given, got neither; pass seed=1",
    ),
    "both seed and rng": (
        {"rng": np.random.default_rng(1)},
        "exactly one of `seed` and `rng` must be given, got both",
    ),
    "seed that is no number": ({"seed": "one"}, "`seed` must be an integer"),
    "start that is no law": (
        {"initial": "origin"},
        r"`initial` must be a law with a method sample\(rng, n\), or a pair",
    ),
    "histogram on nothing": (
        {"histogram": (6.0, (8, 8, 8))},
        "`histogram` must be a PhaseSpaceGrid, got",
    ),
    "client that takes no work": (
        {"client": "tcp://127.0.0.1:8786"},
        r"`client` must have a method submit\(f, \*args\), got 'tcp:",
    ),
}


@pytest.mark.parametrize("name", WRONG_VALUES)
def test_a_wrong_value_is_named(name, model):
    wrong, pattern = WRONG_VALUES[name]
    with pytest.raises(ValueError, match=pattern):
        fp.sample_paths(model, **(GOOD | wrong))


@pytest.mark.parametrize("name", WRONG_KINDS)
def test_a_wrong_kind_is_named(name, model):
    wrong, pattern = WRONG_KINDS[name]
    with pytest.raises(TypeError, match=pattern):
        fp.sample_paths(model, **(GOOD | wrong))


def test_negative_noise_is_refused_by_the_model():
    with pytest.raises(
        ValueError, match="`noise` must be non-negative and finite, got -1"
    ):
        fp.LayDownModel(fp.QuadraticPotential(), -1.0)


@pytest.mark.parametrize(
    ("initial", "shape"),
    [
        ((np.zeros((9, 2)), 0.0), r"initial xi` must have the shape \(10, 2\)"),
        (((0.0, 0.0), np.zeros(11)), r"initial alpha` must have the shape \(10,\)"),
    ],
)
def test_starts_of_a_wrong_number_are_refused(initial, shape, model):
    with pytest.raises(GridMismatchError, match=shape):
        fp.sample_paths(model, **GOOD, initial=initial)


def test_a_table_that_ends_too_early_is_named():
    curve = fp.TabulatedCurve([0.0, 0.5], [0.0, -0.05], [0.0, 0.0])
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)
    with pytest.raises(ValueError, match=r"a table from 0 to 0\.5; extend"):
        fp.sample_paths(model, **GOOD)


def test_too_many_paths_are_refused_before_the_run(model):
    pattern = "the run needs .* but .* are available; pass keep=False to keep no"
    with pytest.raises(MemoryLimitError, match=pattern):
        fp.sample_paths(model, 10**12, 1.0, 0.1, seed=1)
    with pytest.raises(MemoryLimitError, match="the run needs 64"):
        fp.sample_paths(model, **GOOD, memory_limit=10**6)


def test_a_law_that_samples_too_few_or_nan_is_named(model):
    class Short:
        def sample(self, rng, n):
            return np.zeros((3, 2)), np.zeros(3)

    class Broken:
        def sample(self, rng, n):
            xi = np.zeros((n, 2))
            xi[5, 1] = np.nan
            return xi, np.zeros(n)

    pattern = r"must return arrays of shape \(4096, 2\) .* got \(3, 2\) and \(3,\)\."
    with pytest.raises(FpsolveError, match=pattern):
        fp.sample_paths(model, **GOOD, initial=Short())
    with pytest.raises(FpsolveError, match=r"finite points, got xi = \(0, nan\)"):
        fp.sample_paths(model, **GOOD, initial=Broken())


def test_questions_about_what_is_not_there_are_answered_with_what_is(model):
    paths = fp.sample_paths(model, 10, 1.0, 0.5, seed=1, save_at=(0.5, 1.0))
    grid = fp.PhaseSpaceGrid(3.0, (8, 8, 8))
    with pytest.raises(ValueError, match=r"saved values 0\.5, 1, got 0\.7; add it"):
        paths.histogram(grid, 0.7)
    with pytest.raises(ValueError, match="`grid` must be given, got None"):
        paths.histogram()
    with pytest.raises(ValueError, match="`k` must be below the number of paths 10"):
        paths.replay(10)
    with pytest.raises(ValueError, match="`k` must be at least 0, got -1"):
        paths.replay(-1)
    with pytest.raises(TypeError, match="`every` must be an integer"):
        paths.replay(0, every=0.5)
    with pytest.raises(KeyError, match="no moment 'mean'; the moments are mean_xi1"):
        paths.moments()["mean"]


def test_going_on_needs_an_end_beyond_and_the_states(model):
    paths = fp.sample_paths(model, 10, 1.0, 0.5, seed=1)
    pattern = r"`s_end` must be beyond the end 1 of the paths, got 1\."
    with pytest.raises(ValueError, match=pattern):
        paths.continued(1.0)
    with pytest.raises(
        ValueError, match=r"`save_at` must lie beyond the end 1 .* 0\.5"
    ):
        paths.continued(2.0, save_at=(0.5, 2.0))
    with pytest.raises(ValueError, match=r"`ds` must divide the span"):
        paths.continued(1.7)
    gone = fp.sample_paths(model, 10, 1.0, 0.5, seed=1, keep=False)
    with pytest.raises(ValueError, match="the states must have been kept to go on"):
        gone.continued(2.0)
    for question in ("xi", "alpha", "wrapped_alpha", "eta"):
        with pytest.raises(ValueError, match="sampled with keep=False; moments and"):
            getattr(gone, question)
    with pytest.raises(ValueError, match="sampled with keep=False"):
        gone.expectation(lambda xi1, xi2, alpha: xi1)


def test_functions_along_paths_must_be_elementwise_and_finite(model):
    paths = fp.sample_paths(model, 10, 1.0, 0.5, seed=1)
    with pytest.raises(
        ValueError, match=r"`f` must work elementwise, got shape \(3,\)"
    ):
        paths.time_averages(lambda xi1, xi2, alpha: np.zeros(3))
    with pytest.raises(
        ValueError, match=r"`f` must be finite on the paths, got inf at"
    ):
        paths.expectation(lambda xi1, xi2, alpha: np.full(xi1.shape, np.inf))


def test_paths_of_an_unknown_model_cannot_go_on(model):
    paths = fp.sample_paths(model, 10, 1.0, 0.5, seed=1)
    unknown = replace(paths, ensemble=replace(paths.ensemble, model=None))
    assert np.array_equal(unknown.xi, paths.xi)
    for question in (
        lambda: unknown.replay(1),
        lambda: unknown.continued(2.0),
        lambda: unknown.time_averages(lambda xi1, xi2, alpha: xi1),
        lambda: unknown.eta,
    ):
        with pytest.raises(ValueError, match="the model must be known for this, got"):
            question()
