"""The same bits with one thread and two, of numba and of BLAS, and in processes."""

import json
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from bitwise_cases import (
    CASES,
    GRID,
    KERNELS,
    MODEL,
    QUADRATIC,
    START,
    THREADED,
    digest_of,
)

import fpsolve as fp
from fpsolve import studies
from fpsolve._support.blas import one_blas_thread

HERE = Path(__file__).parents[1] / "support"


@cache
def in_this_process(name):
    """The digest with one thread of numba and, see conftest, one of BLAS."""
    return digest_of(name)


def in_another_process(numba_threads, blas_threads, *names, **environment):
    """Digests of all cases, or of those named, in a process with that many threads."""
    threads = {
        "NUMBA_NUM_THREADS": str(numba_threads),
        "OPENBLAS_NUM_THREADS": str(blas_threads),
        "OMP_NUM_THREADS": str(blas_threads),
        "MKL_NUM_THREADS": str(blas_threads),
    }
    ended = subprocess.run(
        [sys.executable, str(HERE / "bitwise_cases.py"), *names],
        env={**os.environ, **threads, **environment}, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    return json.loads(ended.stdout)


@pytest.mark.parametrize("name", THREADED)
def test_two_threads_give_the_bits_of_one(name, on_threads):
    assert on_threads(2, lambda: digest_of(name)) == in_this_process(name)


@pytest.mark.processes
@pytest.mark.nightly
def test_threads_of_blas_and_the_limit_of_numba_change_no_bit():
    # Without the limit of one thread the spectrum of the energy process differs.
    assert in_another_process(1, 2) == {name: in_this_process(name) for name in CASES}


@pytest.mark.nightly
def test_what_is_compiled_now_gives_the_bits_of_what_numba_kept(
    tmp_path,
):
    # Each optimises a parallel kernel in a way of its own: where the order of roundings
    # is left open, the two differ. The kernels alone: what is around them would only
    # have to be compiled as well.
    expected = {name: digest_of(name) for name in KERNELS}
    for _ in ("compiled", "kept"):
        found = in_another_process(1, 1, *KERNELS, NUMBA_CACHE_DIR=str(tmp_path))
        assert found == expected


@pytest.mark.nightly
def test_a_helper_compiled_before_its_caller_gives_the_bits_of_one_compiled_for_it(
    tmp_path,
):
    # The elimination is all products and differences, fused or not.
    helper, caller = "kernel of elimination", "kernel of diffusion"
    first, last = (
        in_another_process(1, 1, *names, NUMBA_CACHE_DIR=str(tmp_path / names[0]))
        for names in ((helper, caller), (caller, helper))
    )
    assert first == last


def test_blas_has_one_thread_inside_and_its_own_again_afterwards():
    from threadpoolctl import threadpool_info, threadpool_limits

    def counts():
        return {one["num_threads"] for one in threadpool_info()
                if one["user_api"] == "blas"}  # fmt: skip

    with threadpool_limits(limits=2, user_api="blas"):
        with one_blas_thread():
            assert counts() == {1}
        assert counts() == {2}


def equal(first, second):
    """Whether two results are equal; the report of the comparison if not."""
    comparison = fp.compare(first, second)
    assert comparison.equal, str(comparison)
    return comparison.equal


@pytest.fixture(scope="module")
def another_process():
    """A process that was not forked from this one, shared by the tests here."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        yield pool


# Studies with every part that they have.
STUDIES = {
    "rates": lambda **where: studies.rate_versus_noise(
        QUADRATIC, [2.0], quick=True, s_end=1.0, **where
    ),
    "large noise": lambda **where: studies.large_noise_limit(
        QUADRATIC, [1.4], quick=True, **where
    ),
    "small noise": lambda **where: studies.small_noise_limit(
        QUADRATIC, [0.8], belt_speed_scales=[0.0], slow_length=0.25, n_paths=200,
        quick=True, **where,
    ),
}  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize("name", STUDIES)
def test_a_study_gives_the_same_bits_on_two_threads_and_in_processes(
    name, on_threads, another_process
):
    compute = STUDIES[name]
    here = on_threads(1, lambda: compute(workers=0))
    assert set(here["status"].values.ravel()) == {"finished"}
    assert equal(here, on_threads(2, lambda: compute(workers=0)))
    assert equal(here, compute(client=another_process))


def test_paths_from_a_client_are_those_from_this_process(another_process):
    arguments = {"n_paths": 300, "s_end": 1.0, "ds": 0.125, "seed": 5}
    here = fp.sample_paths(MODEL, **arguments, histogram=GRID)
    there = fp.sample_paths(MODEL, **arguments, histogram=GRID, client=another_process)
    assert equal(here, there)


def test_a_check_and_averages_do_not_depend_on_threads(on_threads):
    def check():
        return studies.cross_check(
            MODEL, START, [0.5], n_paths=1000, seed=1, grid=GRID, ds=0.25,
            paths_ds=0.125, solve_options={"boundary_tolerance": 1.0},
        )  # fmt: skip

    def averages():
        return studies.ergodic_averages(QUADRATIC, [1.0], s_end=2.0, n_paths=40, seed=1)

    for compute in (check, averages):
        assert equal(on_threads(1, compute), on_threads(2, compute))


def test_two_runs_in_a_row_give_the_same_bits():
    run = {"s_span": (0.0, 0.5), "ds": 0.25, "boundary_tolerance": 1.0}
    first, second = (
        fp.solve(fp.drift_kick(MODEL, GRID), START, **run) for _ in range(2)
    )
    assert equal(first, second)
    assert first.final.tobytes() == second.final.tobytes()
    assert np.array_equal(first.relative_entropy, second.relative_entropy)
