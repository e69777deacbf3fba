"""Where the cases of a sweep run: spawned processes, or what a client offers."""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.context import SpawnContext, SpawnProcess
from types import ModuleType
from typing import Any

from fpsolve._support.checks import check_integer

__all__ = ["executor_for", "finished_tasks"]

Task = tuple[Any, ...]
Found = tuple[int, Any, Exception | None]
_MAIN = "__main__"
_GUARD = (
    "a new process ended before it was ready; a script needs the guard "
    '`if __name__ == "__main__":` around what it runs, or pass `workers=0` to stay in '
    "this process."
)


class SpawnedProcesses:
    """Makes pools of spawned processes, and can end them.

    Parameters
    ----------
    workers : int
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers

    @contextmanager
    def pool(
        self, workers: int | None = None, *, runs_script: bool = True
    ) -> Iterator[ProcessPoolExecutor]:
        """A pool; its processes are ended when it is left by an exception.

        Unless `runs_script`, they do not run the user's script again.
        """
        context = _RecordingContext(runs_script)
        workers = self.workers if workers is None else workers
        threads = max(1, _cpus() // workers)
        pool = ProcessPoolExecutor(
            workers, mp_context=context, initializer=prepare, initargs=(threads,)
        )
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            context.terminate()
            raise
        pool.shutdown()


class _RecordingContext(SpawnContext):
    """The spawn method, remembering what it started.

    Parameters
    ----------
    runs_script : bool
        Whether a new process runs the user's script, as the method does by itself.
    """

    def __init__(self, runs_script: bool) -> None:
        super().__init__()
        self.started: list[Any] = []
        self.runs_script = runs_script

    def Process(self, *args: Any, **kwargs: Any) -> Any:  # type: ignore[override]
        """Make a process."""
        kind = super().Process if self.runs_script else _ScriptlessProcess
        process: Any = kind(*args, **kwargs)
        self.started.append(process)
        return process

    def terminate(self) -> None:
        """End what still runs."""
        for process in self.started:
            if process.is_alive():
                process.terminate()


class _ScriptlessProcess(SpawnProcess):
    """A process that does not run the user's script."""

    def start(self) -> None:
        """Start it."""
        with _hidden_main():
            super().start()


def _runs_script(tasks: Iterable[Any]) -> bool:
    """Whether a process needs the user's script for one of the tasks.

    It does for functions and classes that are defined there; a pickle names their
    module.
    """
    try:
        return any(_MAIN.encode() in pickle.dumps(task) for task in tasks)
    # What cannot be pickled fails where it is sent, with an error of its own.
    except Exception:
        return True


@contextmanager
def _hidden_main() -> Iterator[None]:
    """Start processes from here as if there were no script.

    A spawned process runs the module `__main__` again, for what it may define; in a
    script without the guard ``if __name__ == "__main__":`` that is everything.
    """
    script = sys.modules[_MAIN]
    sys.modules[_MAIN] = ModuleType(_MAIN)
    try:
        yield
    finally:
        sys.modules[_MAIN] = script


def prepare(threads: int) -> None:
    """First thing in a new process: Ctrl-C is for the parent, threads are shared."""
    import signal

    import numba

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    numba.set_num_threads(min(threads, numba.get_num_threads()))


@contextmanager
def executor_for(
    client: Any, workers: int | None, n_tasks: int
) -> Iterator[Executor | SpawnedProcesses | None]:
    """What runs the tasks; None for this process.

    A connection that is made here, to an address, ends with the context.

    Raises
    ------
    TypeError
        If the client is neither a dask client, an address, nor an executor.
    ImportError
        If an address is given and dask is not installed.
    """
    if isinstance(client, str):
        with _connect(client) as connected:
            yield _executor_of(connected)
    elif client is None:
        workers = _cpus() if workers is None else workers
        workers = min(check_integer("workers", workers, at_least=0), n_tasks)
        yield SpawnedProcesses(workers) if workers else None
    else:
        yield _executor_of(client)


def _executor_of(client: Any) -> Executor:
    """The client as an executor of the standard library."""
    if isinstance(client, Executor):
        return client
    make: Callable[..., Executor] | None = getattr(client, "get_executor", None)
    if make is None:
        raise TypeError(
            "`client` must be a dask.distributed Client, the address of a scheduler, "
            f"or an executor of concurrent.futures, got {client!r}."
        )
    # Not pure: a case that failed may be tried again, and dask would remember it.
    return make(pure=False)


def finished_tasks(
    executor: Executor | SpawnedProcesses, tasks: Mapping[int, Task]
) -> Iterator[Found]:
    """Key, result and error of every task, as they end."""
    if isinstance(executor, SpawnedProcesses):
        yield from _in_processes(executor, tasks)
    else:
        yield from _completed(executor, tasks)


def _completed(executor: Executor, tasks: Mapping[int, Task]) -> Iterator[Found]:
    futures: dict[Future[Any], int] = {}
    try:
        for key, task in tasks.items():
            futures[executor.submit(*task)] = key
        for future in as_completed(futures):
            error = future.exception()
            if error is not None and not isinstance(error, Exception):
                raise error
            yield futures[future], None if error else future.result(), error
    except BaseException:
        for future in futures:
            future.cancel()
        raise


def _in_processes(made: SpawnedProcesses, tasks: Mapping[int, Task]) -> Iterator[Found]:
    """As `_completed`; a process that dies fails its own task only."""
    left = dict(tasks)
    runs_script = _runs_script(left.values())
    try:
        with made.pool(runs_script=runs_script) as pool:
            _check_ready(pool)
            for key, result, error in _completed(pool, left.copy()):
                if isinstance(error, BrokenProcessPool):
                    raise error
                del left[key]
                yield key, result, error
    except BrokenProcessPool:
        # Nobody knows which task killed its process: each gets one of its own.
        for key, task in left.items():
            with made.pool(1, runs_script=runs_script) as pool:
                yield from _completed(pool, {key: task})


def _check_ready(pool: ProcessPoolExecutor) -> None:
    try:
        pool.submit(_cpus).result()
    except BrokenProcessPool:
        raise RuntimeError(_GUARD) from None


def _connect(address: str) -> Any:
    """A client, which is a context."""
    try:
        from distributed import Client
    except ImportError:
        raise ImportError(
            "a scheduler needs the package distributed; install it with "
            "`pip install 'fpsolve[dask]'`."
        ) from None
    return Client(address)  # type: ignore[no-untyped-call]


def _cpus() -> int:
    return (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else (os.cpu_count() or 1)
    )
