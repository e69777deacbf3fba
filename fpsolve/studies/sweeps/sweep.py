"""One function over many cases: in processes, on a cluster, resumable."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_call, check_kind, check_path, shown
from fpsolve.errors import RunInterrupted
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.studies.sweeps.executors import executor_for, finished_tasks
from fpsolve.studies.sweeps.recorded_warnings import recorded_warnings
from fpsolve.studies.sweeps.store import CaseStore

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
    key: str | None = None,
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
        Keyword arguments of the function.
    client : dask.distributed.Client, str or concurrent.futures.Executor, optional
        Where to run, or the address of a dask scheduler.
    workers : int, optional
        Processes on this machine, without a client; by default one for each CPU. With
        0 all cases run in this process, one after the other.
    directory : str or Path, optional
        Folder that keeps every finished case in a small file, written at once and
        whole. Cases found there are not computed again; failed ones are, and so are
        all if the function was edited, or one that it calls, or what it refers to.
        What is not seen is data that code reads from elsewhere, such as files.
    key : str, optional
        Name of what the function computes, in place of its code, if that cannot be
        identified or does not say everything. Choose another one whenever it computes
        something else.
    progress : bool or callable
        Show a bar, or call with (cases done, cases in all, the `Case`).

    Returns
    -------
    list of Case

    Raises
    ------
    ValueError, TypeError
        If there is no case, or a function or case cannot be told from others for it to
        be kept, or the client is none.
    RunInterrupted
        After Ctrl-C; `solution` is the list of cases, the unfinished ones "pending".
    """
    check_call("function", function, "function(**arguments)")
    listed = [Case(dict(arguments), {}) for arguments in checked_cases(cases)]
    if not listed:
        raise ValueError("`cases` must hold at least one case, got none.")
    if key is not None:
        check_kind("key", key, str)
    store, paths = None, []
    if directory is not None:
        store = CaseStore(check_path("directory", directory), function, key)
        # Before anything runs that could change what the arguments refer to.
        paths = [store.path(case.arguments) for case in listed]
        known = zip(listed, paths, strict=True)
        listed = [_known(case, store.read(path)) for case, path in known]
    missing = [place for place, case in enumerate(listed) if not case.resumed]
    with _reporting(progress, listed) as report:
        try:
            tasks = {place: (function, listed[place].arguments) for place in missing}
            for place, outcome in _outcomes(tasks, client, workers, key):
                listed[place] = case = replace(listed[place], **outcome)
                if store is not None and case.status == "finished":
                    store.write(paths[place], _record(case))
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


def _known(case: Case, found: dict[str, NDArray[Any]] | None) -> Case:
    """The case as the store has it, or as it was."""
    if found is None:
        return case
    message, seconds = str(found.pop("#message")), float(found.pop("#seconds"))
    return Case(case.arguments, found, "finished", message, seconds, resumed=True)


def _record(case: Case) -> dict[str, Any]:
    return {**case.values, "#message": case.message, "#seconds": case.seconds}


def _outcomes(
    tasks: Mapping[int, tuple[Function, Mapping[str, Any]]],
    client: Any,
    workers: int | None,
    key: str | None,
) -> Iterator[tuple[int, dict[str, Any]]]:
    """Places and outcomes as they come."""
    with executor_for(client, workers, len(tasks)) as executor:
        if executor is None:
            for place, task in tasks.items():
                yield place, run_case(*task)
            return
        sent = {
            place: (run_elsewhere, *task, key, _code_of(*task, key))
            for place, task in tasks.items()
        }
        for place, outcome, error in finished_tasks(executor, sent):
            yield place, outcome if error is None else failure(error, float("nan"))


def run_elsewhere(
    function: Function, arguments: Mapping[str, Any], key: str | None, code: str | None
) -> dict[str, Any]:
    """As `run_case`, in another process: there a name may stand for other code."""
    if code is not None and _code_of(function, arguments, key) != code:
        error = RuntimeError(
            "`function`, or something in the case, is other code in the process where "
            "it was to run than here, or of another version; restart this process and "
            "those of `client` so that all import the same."
        )
        return failure(error, float("nan"))
    return run_case(function, arguments)


def _code_of(
    function: Function, arguments: Mapping[str, Any], key: str | None
) -> str | None:
    """What computes a case, as a digest without the rounding of a machine."""
    return digest_or_none((function if key is None else key, arguments), sampled=False)


@one_blas_thread()
def run_case(function: Function, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Outcome of one case, whatever happens in it: the fields of a `Case`."""
    began = time.perf_counter()
    with recorded_warnings() as caught:
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
