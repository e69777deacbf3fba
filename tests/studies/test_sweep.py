"""A sweep computes the same wherever it runs, and loses nothing that is finished."""

import os
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from sweep_functions import (
    counted,
    dies_at_two,
    fails_at_two,
    interrupts_at_two,
    returns_objects,
    square,
    warns,
)

from fpsolve.errors import RunInterrupted
from fpsolve.model.potentials import (
    IsotropicPotential,
    LinearPotential,
    QuadraticPotential,
)
from fpsolve.studies.rates.cases import rate_case
from fpsolve.studies.sweeps.store import CaseStore
from fpsolve.studies.sweeps.sweep import sweep

CASES = [{"x": x} for x in (1, 2, 3)]
GAPS = [
    {
        "part": "gap",
        "potential": QuadraticPotential(),
        "noise": noise,
        "tolerance": 1e-6,
    }
    for noise in (0.7, 1.0, 2.0)
]


def same(first, second, without=("process",)):
    """Every number of two sweeps is the same, bit for bit."""
    assert [case.status for case in first] == [case.status for case in second]
    for one, other in zip(first, second, strict=True):
        assert one.arguments == other.arguments
        assert one.values.keys() == other.values.keys()
        for name in one.values.keys() - set(without):
            assert one.values[name].dtype == other.values[name].dtype
            np.testing.assert_array_equal(one.values[name], other.values[name])


def calls(folder):
    return sorted(path.name.rsplit("-", 1)[1] for path in folder.glob("call-*"))


def test_results_come_in_the_order_of_the_cases_as_arrays():
    found = sweep(square, CASES, workers=0)
    assert [case.values["square"].item() for case in found] == [1, 4, 9]
    assert all(case.status == "finished" and case.seconds >= 0 for case in found)
    assert found[1].values["powers"].tolist() == [2, 8]
    assert found[1].values["name"].item() == "x = 2"
    assert found[0].values["process"] == os.getpid()


def test_spawned_processes_give_the_same_numbers_as_this_one():
    serial = sweep(square, CASES, workers=0)
    spawned = sweep(square, CASES, workers=2)
    same(serial, spawned)
    used = {int(case.values["process"]) for case in spawned}
    assert os.getpid() not in used
    assert 1 <= len(used) <= 2


# Libraries of dask warn about their own future and leave sockets to be collected.
@pytest.mark.nightly
@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_of_two_workers_gives_the_same_numbers():
    import distributed

    serial = sweep(rate_case, GAPS, workers=0)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        same(serial, sweep(rate_case, GAPS, client=client))
        same(
            sweep(fails_at_two, CASES, workers=0),
            sweep(fails_at_two, CASES, client=cluster.scheduler_address),
        )


def test_an_executor_is_a_client_too():
    with ThreadPoolExecutor(2) as executor:
        same(sweep(square, CASES, workers=0), sweep(square, CASES, client=executor))


def test_a_failed_case_leaves_its_message_and_stops_no_other():
    found = sweep(fails_at_two, CASES, workers=0)
    assert [case.status for case in found] == ["finished", "failed", "finished"]
    assert found[1].message == "ValueError: `x` must not be 2."
    assert found[1].values == {}
    assert found[2].values["x"] == 3


@pytest.mark.processes
def test_a_process_that_dies_takes_only_its_own_case_with_it():
    found = sweep(dies_at_two, CASES, workers=2)
    assert [case.status for case in found] == ["finished", "failed", "finished"]
    assert "terminated abruptly" in found[1].message


def test_what_is_neither_number_nor_text_is_a_failed_case():
    (found,) = sweep(returns_objects, [{"x": 1}], workers=0)
    assert found.message.startswith("TypeError: `function` must return numbers")


def test_warnings_of_a_case_are_its_message():
    (found,) = sweep(warns, [{"x": 1}], workers=0)
    assert (found.status, found.message) == ("finished", "the box is small")


def test_a_sweep_goes_on_where_it_stopped(tmp_path):
    cases = [{"x": x, "folder": str(tmp_path)} for x in (1, 2, 3)]
    store = tmp_path / "store"
    first = sweep(counted, cases, workers=0, directory=store)
    assert [case.status for case in first] == ["finished", "failed", "finished"]
    assert calls(tmp_path) == ["1", "2", "3"]
    (tmp_path / "mended").touch()
    again = sweep(counted, cases, workers=0, directory=store)
    assert [case.resumed for case in again] == [True, False, True]
    assert all(case.status == "finished" for case in again)
    # Only the failed case was computed again, and what was read is what was computed.
    assert (tmp_path / f"call-{os.getpid()}-1").read_text().count("called") == 1
    assert (tmp_path / f"call-{os.getpid()}-2").read_text().count("called") == 2
    same(first[::2], again[::2])
    assert again[0].seconds == first[0].seconds
    assert len(list(store.iterdir())) == 3


def test_a_damaged_file_is_computed_again(tmp_path):
    sweep(square, CASES[:1], workers=0, directory=tmp_path)
    (file,) = tmp_path.iterdir()
    file.write_bytes(file.read_bytes()[:100])
    (found,) = sweep(square, CASES[:1], workers=0, directory=tmp_path)
    assert not found.resumed
    assert found.values["square"] == 1
    assert sweep(square, CASES[:1], workers=0, directory=tmp_path)[0].resumed


def test_ctrl_c_keeps_what_is_finished(tmp_path):
    with pytest.raises(RunInterrupted) as caught:
        sweep(interrupts_at_two, CASES, workers=0, directory=tmp_path)
    statuses = [case.status for case in caught.value.solution]
    assert statuses == ["finished", "pending", "pending"]
    assert len(list(tmp_path.iterdir())) == 1


def test_different_cases_have_different_files(tmp_path):
    store = CaseStore(tmp_path, square)
    cases = [
        {"potential": QuadraticPotential(), "noise": 1.0},
        {"potential": QuadraticPotential(2.0), "noise": 1.0},
        {"potential": LinearPotential(), "noise": 1.0},
        {"potential": LinearPotential(), "noise": 1.5},
        {"potential": LinearPotential(), "noise": 1.5, "f": np.cos},
        {"potential": LinearPotential(), "noise": 1.5, "values": np.arange(3)},
    ]
    names = {store.path(case) for case in cases[:4] + cases[5:]}
    assert len(names) == 5
    assert store.path(dict(reversed(cases[0].items()))) in names
    assert CaseStore(tmp_path, warns).path(cases[0]) not in names
    assert store.path({"f": square}) != store.path({"f": warns})


def test_functions_without_a_name_are_kept_by_what_they_do(tmp_path):
    def times(k):
        return lambda x: {"x": k * x}

    for k in (2, 3):
        for resumed in (False, True):
            found = sweep(times(k), CASES, workers=0, directory=tmp_path)
            assert [case.values["x"].item() for case in found] == [k, 2 * k, 3 * k]
            assert all(case.resumed is resumed for case in found)


def test_what_has_neither_code_nor_data_cannot_be_kept_without_a_key(tmp_path):
    store = tmp_path / "store"
    with (tmp_path / "open").open("w") as file:

        def writes(x):
            return {"x": x + file.write("")}

        with pytest.raises(ValueError, match="`cases` must be told apart by code and"):
            sweep(square, [{"x": file}], workers=0, directory=store)
        with pytest.raises(ValueError, match="`function` must be told from others by "):
            sweep(writes, CASES, workers=0, directory=store)
        first, again, other = (
            sweep(writes, CASES, workers=0, directory=store, key=key)[0].resumed
            for key in ("one", "one", "two")
        )
    assert (first, again, other) == (False, True, False)
    with pytest.raises(TypeError, match="`key` must be a str"):
        sweep(square, CASES, workers=0, directory=store, key=1)


def test_a_case_is_kept_as_what_it_was_before_it_ran(tmp_path):
    def takes(x):
        return {"x": x.pop()}

    for resumed in (False, True):
        found = sweep(takes, [{"x": [1, 2]}], workers=0, directory=tmp_path)
        assert found[0].values["x"] == 2
        assert found[0].resumed is resumed


class OtherCode(ThreadPoolExecutor):
    """A process that imported a module before it was edited."""

    def submit(self, function, *arguments):
        *others, code = arguments
        return super().submit(function, *others, "old" + code)


def test_a_worker_with_other_code_is_not_believed():
    with OtherCode(1) as client:
        found = sweep(square, CASES, client=client)
    assert {case.status for case in found} == {"failed"}
    assert "other code in the process where it was to run" in found[0].message


def spring(k):
    """k r²/2, of functions that have the same names for every k."""
    return IsotropicPotential(lambda r: k * r**2 / 2, lambda r: k * r)


class Spring:
    """The same as bound methods."""

    def __init__(self, k):
        self.k = k

    def value(self, r):
        return self.k * r**2 / 2

    def derivative(self, r):
        return self.k * r


def test_a_stiffer_spring_is_not_given_the_gap_of_a_softer_one(tmp_path):
    def gap(potential):
        case = {**GAPS[1], "potential": potential}
        (found,) = sweep(rate_case, [case], workers=0, directory=tmp_path)
        return found.values["gap"]

    for k in (1.0, 4.0):
        # k r²/2 = r²/2σ² with σ = 1/√k.
        exact = gap(QuadraticPotential(k**-0.5, k**-0.5))
        for potential in (
            spring(k), IsotropicPotential(Spring(k).value, Spring(k).derivative),
        ):  # fmt: skip
            # To the tolerance that was asked for, on either side.
            np.testing.assert_allclose(gap(potential), exact, rtol=2e-6)


def test_a_basis_is_not_kept_for_functions_that_return_something_else():
    # The functions, and so the potentials, are equal; what they read is not.
    stiffness = [1.0]

    def value(r):
        return stiffness[0] * r**2 / 2

    def derivative(r):
        return stiffness[0] * r

    def gap(noise):
        case = {**GAPS[0], "potential": IsotropicPotential(value, derivative)}
        return rate_case(**{**case, "noise": noise})["gap"]

    soft = gap(1.0)
    stiffness[0] = 4.0
    np.testing.assert_allclose(gap(np.sqrt(2)), 2 * soft, rtol=2e-6)


def test_bad_arguments_are_refused():
    with pytest.raises(ValueError, match="`cases` must hold at least one case, got no"):
        sweep(square, [])
    with pytest.raises(ValueError, match="`workers` must be at least 0, got -1"):
        sweep(square, CASES, workers=-1)
    with pytest.raises(TypeError, match=r"`client` must be a dask\.distributed Client"):
        sweep(square, CASES, client=3)


def test_progress_counts_the_cases(tmp_path, capsys):
    told = []
    sweep(
        fails_at_two, CASES, workers=0, directory=tmp_path,
        progress=lambda *what: told.append(what),
    )  # fmt: skip
    assert [(done, total, case.status) for done, total, case in told] == [
        (1, 3, "finished"), (2, 3, "failed"), (3, 3, "finished"),
    ]  # fmt: skip
    told.clear()
    sweep(
        fails_at_two, CASES, workers=0, directory=tmp_path,
        progress=lambda *what: told.append(what),
    )  # fmt: skip
    assert [done for done, _, _ in told] == [3]
    sweep(fails_at_two, CASES, workers=0, progress=True)
    assert "3/3" in capsys.readouterr().err


@pytest.mark.processes
@pytest.mark.nightly
def test_a_script_without_a_guard_is_not_run_again(tmp_path):
    found = run_script(tmp_path, """
        print("here", flush=True)
        from sweep_functions import square
        from fpsolve.studies.sweeps.sweep import sweep
        cases = sweep(square, [{"x": 1}, {"x": 2}], workers=1)
        print([case.status for case in cases], flush=True)
        def twice(x):
            return {"value": 2.0 * x}
        sweep(twice, [{"x": 1}, {"x": 2}], workers=1)
        """)  # fmt: skip
    assert found.stdout.startswith("here\n['finished', 'finished']\n"), found.stderr
    # Unless its own function is needed, of which it is told.
    assert found.returncode == 1
    assert 'needs the guard `if __name__ == "__main__":`' in found.stderr


def run_script(folder, text):
    script = folder / "script.py"
    script.write_text(textwrap.dedent(text))
    tests = Path(__file__).parents[1]
    path = os.pathsep.join([str(tests / "support"), str(tests.parent)])
    return subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": path},
    )  # fmt: skip
