"""`drift_kick` as an array program: the numbers of the kernels, whatever the library.

`array_api_strict` has nothing but the standard and refuses arrays of others; numpy runs
the same programs. jax, on every night, runs them compiled.
"""

import subprocess
import sys
import tracemalloc

import array_api_strict as strict
import jax_runs
import numpy as np
import pytest
from array_runs import (
    DS,
    OPTIONS,
    PROBLEMS,
    SPAN,
    TILTED,
    assert_same_run,
    run,
    scheme_of,
    start_of,
)
from orders import assert_order, measure_order
from problems import DecayingCirculation

import fpsolve as fp
from fpsolve.density.arrays.array_drift_kick import ArrayDriftKick
from fpsolve.density.arrays.blocks import best_size, in_blocks
from fpsolve.density.arrays.library import Library, library_of
from fpsolve.density.arrays.record import ArrayRecorder
from fpsolve.density.recorder import Recorder
from fpsolve.grids.diagnostics import l1_distance

NUMPY = Library(np)


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("options", OPTIONS)
def test_products_of_matrices_give_what_the_kernels_give(problem, options):
    scheme = scheme_of(problem, options)
    p0 = start_of(scheme)
    found = run(ArrayDriftKick(scheme, NUMPY), p0)
    assert_same_run(found, run(scheme, p0))


@pytest.mark.parametrize("options", OPTIONS)
def test_the_library_of_p0_is_where_it_is_evolved(options):
    scheme = scheme_of("linear on a belt", options)
    p0 = start_of(scheme)
    found, expected = run(scheme, strict.asarray(p0)), run(scheme, p0)
    assert_same_run(found, expected)
    # A solution like any other: on the host, of the same scheme and the same call.
    assert type(found.densities) is np.ndarray
    assert found.scheme == expected.scheme
    assert found.call.arguments == expected.call.arguments
    np.testing.assert_array_equal(found.initial_density, p0)
    assert "arrays" not in expected.provenance
    assert found.provenance["arrays"].startswith("array_api_strict ")
    # What is found of a file is repeated where p0 of the file lies: on the host.
    again = fp.rerun(found)
    np.testing.assert_array_equal(again.densities, expected.densities)


def test_passes_are_combined_and_numbers_of_the_user_observed():
    scheme = scheme_of("quadratic", "fourier")
    p0 = start_of(scheme)
    asked = {
        "extrapolate": 3,
        "observe": {"largest": lambda p, grid: p.max()},
        "record_every": 4,
    }
    reference = np.full(scheme.grid.shape, 1 / 400)
    there = strict.asarray(reference)
    found = run(scheme, strict.asarray(p0), reference=there, **asked)
    expected = run(scheme, p0, reference=reference, **asked)
    # Weights of three levels add up to five.
    assert_same_run(found, expected)
    assert found.largest[-1] == pytest.approx(found.final.max(), rel=0.5)
    # Differences of runs that differ by 1e-15.
    for name, values in expected.errors.items():
        np.testing.assert_allclose(found.errors[name], values, rtol=0, atol=1e-12)


def test_matrices_between_nodes_are_combined_as_by_the_kernels():
    grid = fp.PhaseSpaceGrid(half_width=4.0, shape=(20, 22, 32))
    model = fp.LayDownModel(potential=TILTED, noise=0.8)
    scheme = fp.drift_kick(model, grid)
    p0 = start_of(scheme)
    matrices = scheme.kick.table(DS).matrices
    # Every cell has a |∇B| of its own: there are more than the table may hold.
    assert matrices.shape[0] == 8
    there = ArrayDriftKick(scheme, NUMPY)
    state, expected = there.start(p0), scheme.start(p0)
    there.advance(state, 0.0, DS, 4)
    scheme.advance(expected, 0.0, DS, 4)
    np.testing.assert_allclose(
        np.asarray(there.density(state)), scheme.density(expected),
        rtol=0, atol=1e-13 * p0.max(),
    )  # fmt: skip


STEEP = fp.PowerPotential(4.0)


@pytest.mark.parametrize(
    ("potential", "shape"), [(TILTED, (20, 22, 32)), (STEEP, (20, 22, 64))]
)
def test_a_run_takes_the_memory_that_is_asked_for(potential, shape):
    grid = fp.PhaseSpaceGrid(half_width=4.0, shape=shape)
    scheme = fp.drift_kick(fp.LayDownModel(potential=potential, noise=0.8), grid)
    p0 = start_of(scheme)
    scheme.kick.table(DS)
    tracemalloc.start()
    try:
        there = ArrayDriftKick(scheme, NUMPY)
        there.advance(there.start(p0), 0.0, DS, 2)
        peak = tracemalloc.get_traced_memory()[1] / grid.nbytes
    finally:
        tracemalloc.stop()
    # What is asked for is for matrices of every |∇B| that there can be.
    assert there.n_arrays / 2 < peak < there.n_arrays


@pytest.mark.parametrize("size", [None, 1, 4, 64])
def test_every_row_stands_in_a_block_of_its_matrix_once(size):
    kick = scheme_of("quadratic", "plain").kick
    blocks = in_blocks(kick.table(DS), size)
    n_rows = kick.strength.size
    np.testing.assert_array_equal(blocks.rows[blocks.place_of], np.arange(n_rows))
    # The matrices of two rows are equal where |∇B| is, and there only.
    each = blocks.matrices[
        blocks.place_of // (blocks.rows.size // len(blocks.matrices))
    ]
    strength, order = np.sort(kick.strength), np.argsort(kick.strength)
    apart = np.diff(strength) > 1e-12
    differs = (np.diff(each[order], axis=0) != 0).any(axis=(1, 2))
    np.testing.assert_array_equal(differs, apart)


def test_blocks_are_large_where_rows_share_and_small_where_they_do_not():
    assert best_size(np.array([1000]), 1, 8) == 1024
    assert best_size(np.ones(1000, dtype=int), 1, 8) == 1
    assert best_size(np.full(100, 8), 1, 32) == 8


@pytest.mark.parametrize("options", OPTIONS)
def test_mass_is_kept_to_rounding_over_five_hundred_steps(options):
    scheme = ArrayDriftKick(scheme_of("linear on a belt", options), NUMPY)
    state = scheme.start(start_of(scheme))
    scheme.advance(state, 0.0, 0.05, 500)
    # Less than a unit of the last place, 2.2e-16, a step.
    assert abs(scheme.form.mass(state.values) / state.target_mass - 1) < 1e-13
    if not scheme.balanced:
        assert abs(state.correction) < 1e-13


def test_equilibrium_is_kept_in_the_balanced_form():
    scheme = ArrayDriftKick(scheme_of("quadratic", "balanced"), NUMPY)
    p0 = scheme.form.form.weight[:, :, None] * np.ones(scheme.grid.shape)
    state = scheme.start(p0)
    scheme.advance(state, 0.0, DS, 50)
    # A few hundred products of matrices whose rows sum to one to rounding.
    np.testing.assert_allclose(np.asarray(scheme.density(state)), p0, rtol=2e-13)


def test_order_two_at_every_halving_and_the_errors_of_the_kernels():
    grid = fp.PhaseSpaceGrid(half_width=7.0, shape=(32, 32, 16))
    problem = DecayingCirculation(fp.QuadraticPotential(), 1.0, grid)
    scheme = fp.drift_kick(problem.model, grid, translation="fourier")
    there, p0 = ArrayDriftKick(scheme, NUMPY), problem.initial()

    def error_of(n, one):
        found = fp.solve(one, p0, SPAN, 1 / n, record_every=n)
        return l1_distance(found.final, problem.density(1.0), grid)

    convergence = measure_order(lambda n: error_of(n, there), 4)
    # Measured 3.6e-4 with sixteen steps.
    assert_order(convergence, 2, 5e-4)
    on_host = [error_of(n, scheme) for n in convergence.resolutions]
    np.testing.assert_allclose(convergence.errors, on_host, rtol=0, atol=1e-13)


@pytest.mark.parametrize("potential", [fp.LinearPotential(), fp.FreePotential()])
def test_sums_are_those_of_the_kernels_below_zero_and_without_a_reference(potential):
    grid = fp.PhaseSpaceGrid(half_width=4.0, shape=(8, 9, 10))
    model = fp.LayDownModel(potential=potential, noise=0.7)
    p = np.random.default_rng(7).random(grid.shape) - 0.2
    scheme = ArrayDriftKick(fp.drift_kick(model, grid), NUMPY)
    density = scheme.density(scheme.start(p))
    found = ArrayRecorder(model, grid).record(density, 0.0)
    expected = Recorder(model, grid).record(p, 0.0)
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        # Sums of 720 numbers below one.
        assert found[name] == pytest.approx(value, rel=1e-12, abs=1e-13, nan_ok=True)


def test_a_density_that_is_none_is_told_with_its_index():
    scheme = scheme_of("quadratic", "plain")
    there = ArrayDriftKick(scheme, NUMPY)
    there.kick.frame.cosine[:] = np.nan
    with pytest.raises(fp.errors.NonFiniteDensityError, match=r"index \(0, 0, 0\)"):
        run(there, start_of(scheme))


@pytest.mark.parametrize(
    ("make", "more", "said"),
    [
        (lambda m, g: fp.drift_kick(m, g, positive=True), {},
         r"`positive` must be False .* by array_api_strict, got True: .* of numpy"),
        (lambda m, g: fp.semi_lagrangian(m, g), {},
         r"`scheme` must be a drift_kick .* got semi_lagrangian; .* of numpy"),
        (lambda m, g: fp.drift_kick(m, g), {"checkpoint": "kept"},
         r"`checkpoint` must be left out .* by array_api_strict: .* same bits"),
    ],
)  # fmt: skip
def test_what_is_no_array_program_is_refused_by_name(
    make, more, said, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    scheme = scheme_of("quadratic", "plain")
    p0 = strict.asarray(start_of(scheme))
    with pytest.raises(ValueError, match=said):
        run(make(scheme.model, scheme.grid), p0, **more)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", ["float32", "int64"])
def test_what_is_not_float64_is_refused(kind):
    scheme = scheme_of("quadratic", "plain")
    p0 = strict.astype(strict.asarray(start_of(scheme)), getattr(strict, kind))
    with pytest.raises(TypeError, match=rf"`p0` must hold float64 .*{kind}; convert"):
        run(scheme, p0)


def test_bad_starts_are_told_as_on_the_host():
    scheme = scheme_of("quadratic", "plain")
    p0 = start_of(scheme)
    with pytest.raises(fp.errors.GridMismatchError):
        run(scheme, strict.asarray(p0[:-1]))
    p0[1, 2, 3] = np.nan
    with pytest.raises(ValueError, match=r"finite, got nan at index \(1, 2, 3\)"):
        run(scheme, strict.asarray(p0))


@pytest.mark.parametrize("values", [np.ones(3), np.float64(1.0), [1.0], None])
def test_what_is_of_numpy_or_no_array_has_no_other_library(values):
    assert library_of(values) is None


@pytest.mark.nightly
def test_jax_compiles_the_same_programs_and_has_to_be_asked_for_float64():
    # In a process of its own: its threads do not go together with tests that fork.
    command = [sys.executable, jax_runs.__file__]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{len(PROBLEMS) * len(OPTIONS)} runs are the same\n"
