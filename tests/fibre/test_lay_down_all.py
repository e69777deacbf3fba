"""An ensemble of laid fibres is that of single ones, wherever it is computed."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from itertools import pairwise
from multiprocessing import get_context

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import fibre

SPUN = fibre.String(
    0.2, 2e-4, 1000.0, 1e8, n_edges=10, end=fibre.Free(),
    start=fibre.Nozzle((0.0, 0.0, 0.25), (0.1, 0.03, -1.0), 1.0),
)  # fmt: skip
NOISE = fibre.RandomForce(3e-6)
OPTIONS = {"belt": fibre.Belt(0.3), "turbulence": NOISE, "estimate_error": False}
SEEDS = [5, 0, 2]


def all_laid(seeds=SEEDS, **options):
    return fibre.lay_down_all(SPUN, 0.1, 20, seeds=seeds, **OPTIONS | options)


@pytest.fixture(scope="module")
def single():
    return [fibre.lay_down(SPUN, 0.1, 20, seed=seed, **OPTIONS) for seed in SEEDS]


def same(found, wanted):
    assert len(found) == len(wanted)
    for one, other in zip(found, wanted, strict=True):
        comparison = fp.compare(one, other)
        assert comparison.equal, str(comparison)
        assert not comparison.parameters


def test_every_fibre_has_the_bits_of_a_single_call_in_the_order_of_the_seeds(single):
    seen = []
    same(all_laid(progress=lambda *done: seen.append(done)), single)
    assert seen == [(1, 3, 0.1), (2, 3, 0.1), (3, 3, 0.1)]
    # And no two are the same.
    ends = [one.last.r for one in single]
    assert not any(np.array_equal(a, b) for a, b in pairwise(ends))
    same([fp.rerun(all_laid([2])[0])], single[2:])


def test_fibres_of_an_executor_are_those_laid_here(single):
    with ThreadPoolExecutor(2) as executor:
        same(all_laid(client=executor), single)


@pytest.mark.processes
@pytest.mark.nightly
def test_fibres_of_spawned_processes_are_those_laid_here(single):
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        same(all_laid(client=executor), single)


class Late:
    """A client that lays when asked for the result, and counts what is left."""

    def __init__(self):
        self.cancelled = []

    def submit(self, lay, seed):
        return Promise(self, lay, seed)


class Promise:
    def __init__(self, client, lay, seed):
        self.client, self.lay, self.seed = client, lay, seed

    def result(self):
        return self.lay(self.seed)

    def cancel(self):
        self.client.cancelled.append(self.seed)


@pytest.mark.parametrize("client", [None, Late()])
def test_the_fibre_that_fails_says_which_and_the_others_are_not_begun(client):
    # No step of this force is found, however short it is.
    gust = fibre.AirFlow((1e9, 0.0, 0.0))
    with pytest.raises(fp.errors.EdgeLengthError) as caught:
        all_laid(air=gust, client=client)
    assert caught.value.__notes__ == ["in the fibre of seed 5"]
    assert caught.value.solution.call.arguments["seed"] == 5
    if client is not None:
        assert client.cancelled == SEEDS


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"seeds": []}, ValueError, "one or more"),
        ({"seeds": [1, 2, 1]}, ValueError, "no two the same"),
        ({"seeds": 25}, TypeError, r"sequence of integers, got 25; range\(25\)"),
        ({"seeds": [1, 0.5]}, TypeError, "`seeds` must be an integer, got 0.5"),
        ({"seeds": [-1]}, ValueError, "`seeds` must be at least 0"),
        ({"turbulence": None}, TypeError, "without noise all fibres are the same"),
        ({"seed": 3}, TypeError, "`seed` is of one fibre, got 3"),
        ({"checkpoint": "part.nc"}, TypeError, "`checkpoint` is of one fibre"),
        ({"client": 2}, TypeError, r"`client` must have a method submit"),
        ({"bell": 2}, TypeError, "unexpected keyword argument 'bell'"),
    ],
)
def test_what_is_no_ensemble_is_refused(changed, error, message):
    with pytest.raises(error, match=message):
        all_laid(**changed)
