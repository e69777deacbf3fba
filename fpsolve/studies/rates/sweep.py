"""One function over many cases: in processes, on a cluster, resumable."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._blas import one_blas_thread
from fpsolve._checks import check_call, shown
from fpsolve.errors import RunInterrupted
from fpsolve.studies.rates.executors import executor_for, finished_tasks
from fpsolve.studies.rates.store import CaseStore

__all__ = ["Case", "SweepProgress", "sweep"]

Function = Callable[..., Mapping[str, Any]]
# Called with cases done, cases in all, and the case that has just ended.
SweepProgress = Callable[[int, int, "Case"], None]


@dataclass(frozen=True)
class Case:
    """One case of a sweep and what came out of it.

    Attributes
    ----------
    arguments : mapping
        Keyword arguments of the function.
    values : dict of ndarray
        What the function returned, as arrays; empty unless finished.
    status : str
        "finished", "failed" or "pending" (interrupted before it was done).
    message : str
        Why it failed, or the warnings that it gave.
    seconds : float
        Wall time of the function, NaN if unknown.
    resumed : bool
        Whether it was read from the store instead of computed.
    """

    arguments: Mapping[str, Any]
    values: dict[str, NDArray[Any]]
    status: str = "pending"
    message: str = ""
    seconds: float = float("nan")
    resumed: bool = False


def sweep(
    function: Function,
    cases: Iterable[Mapping[str, Any]],
    *,
    client: Any = None,
    workers: int | None = None,
    directory: str | Path | None = None,
    progress: bool | SweepProgress = False,
) -> list[Case]:
    """Call a function with every case as keywords; results in the order of the cases.

    A case that fails does not stop the others. The numbers do not depend on where a
    case runs. New processes are spawned, never forked: compiled kernels start threads,
    which a fork would break. A script that sweeps therefore needs the usual guard
    ``if __name__ == "__main__":``.

    Parameters
    ----------
    function : callable
        Defined at the top of a module, so that other processes find it. Returns a
        mapping of names to numbers, strings or arrays.
    cases : iterable of mapping
        Keyword arguments of the function; of numbers, strings, lists of these, and
        objects with `to_dict`, such as potentials.
    client : dask.distributed.Client, str or concurrent.futures.Executor, optional
        Where to run, or the address of a dask scheduler.
    workers : int, optional
        Processes on this machine, without a client; by default one for each CPU. With
        0 all cases run in this process, one after the other.
    directory : str or Path, optional
        Folder that keeps every finished case in a small file, written at once and
        whole. Cases found there are not computed again; failed ones are.
    progress : bool or callable
        Show a bar, or call with (cases done, cases in all, the `Case`).

    Returns
    -------
    list of Case

    Raises
    ------
    ValueError, TypeError
        If there is no case, a case cannot be stored, or the client is none.
    RunInterrupted
        After Ctrl-C; `solution` is the list of cases, the unfinished ones "pending".
    """
    check_call("function", function, "function(**arguments)")
    listed = [Case(dict(arguments), {}) for arguments in checked_cases(cases)]
    if not listed:
        raise ValueError("`cases` must hold at least one case, got none.")
    store = None if directory is None else CaseStore(Path(directory), function)
    if store is not None:
        listed = [_known(case, store) for case in listed]
    missing = [place for place, case in enumerate(listed) if not case.resumed]
    with _reporting(progress, listed) as report:
        try:
            for place, outcome in _outcomes(function, listed, missing, client, workers):
                listed[place] = case = replace(listed[place], **outcome)
                if store is not None and case.status == "finished":
                    store.write(case.arguments, _record(case))
                report(case)
        except KeyboardInterrupt:
            raise RunInterrupted(listed) from None
    return listed


def checked_cases(cases: Any) -> list[Mapping[str, Any]]:
    """The cases as a list; TypeError unless each is a mapping of arguments."""
    listed = list(cases) if isinstance(cases, Iterable) else [cases]
    for case in listed:
        if not isinstance(case, Mapping):
            raise TypeError(
                "`cases` must be a series of mappings of arguments, got "
                f"{shown(case)} among them."
            )
    return listed


def _known(case: Case, store: CaseStore) -> Case:
    """The case as the store has it, or as it was."""
    found = store.read(case.arguments)
    if found is None:
        return case
    message, seconds = str(found.pop("#message")), float(found.pop("#seconds"))
    return Case(case.arguments, found, "finished", message, seconds, resumed=True)


def _record(case: Case) -> dict[str, Any]:
    return {**case.values, "#message": case.message, "#seconds": case.seconds}


def _outcomes(
    function: Function,
    cases: list[Case],
    places: list[int],
    client: Any,
    workers: int | None,
) -> Iterator[tuple[int, dict[str, Any]]]:
    """Places and outcomes as they come."""
    tasks = {place: (run_case, function, cases[place].arguments) for place in places}
    with executor_for(client, workers, len(tasks)) as executor:
        if executor is None:
            for place, task in tasks.items():
                yield place, task[0](*task[1:])
            return
        for place, outcome, error in finished_tasks(executor, tasks):
            yield place, outcome if error is None else failure(error, float("nan"))


@one_blas_thread()
def run_case(function: Function, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Outcome of one case, whatever happens in it: the fields of a `Case`."""
    began = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        try:
            returned = function(**arguments)
            values = {str(name): np.asarray(one) for name, one in returned.items()}
            _check_kinds(values)
        except Exception as error:
            return failure(error, time.perf_counter() - began)
    # Of a library's own warnings nobody who reads the result can make use.
    told = {str(one.message) for one in caught if one.category is UserWarning}
    return {
        "values": values,
        "status": "finished",
        "message": " ".join(sorted(told)),
        "seconds": time.perf_counter() - began,
    }


def failure(error: BaseException, seconds: float) -> dict[str, Any]:
    """Outcome of a case that raised."""
    message = f"{type(error).__name__}: {error}" if str(error) else repr(error)
    return {"values": {}, "status": "failed", "message": message, "seconds": seconds}


def _check_kinds(values: Mapping[str, NDArray[Any]]) -> None:
    for name, value in values.items():
        if value.dtype.kind not in "biufcU":
            raise TypeError(
                f"`function` must return numbers, strings or arrays of them, got "
                f"{value.dtype} for '{name}'."
            )


@contextmanager
def _reporting(
    progress: bool | SweepProgress, cases: list[Case]
) -> Iterator[Callable[[Case], None]]:
    """What is called with every case that ends."""
    n_total = len(cases)
    n_done = sum(case.resumed for case in cases)
    if progress is True:
        from tqdm.auto import tqdm

        with tqdm(total=n_total, initial=n_done, unit="case") as bar:
            yield lambda case: _advance(bar, case)
        return

    def count(case: Case) -> None:
        nonlocal n_done
        n_done += 1
        if callable(progress):
            progress(n_done, n_total, case)

    yield count


def _advance(bar: Any, case: Case) -> None:
    if case.status == "failed":
        bar.write(f"failed: {dict(case.arguments)}: {case.message}")
    bar.update()
