"""Cases in a process of their own, which a hang or a crash may cost."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import resource
import tempfile
import time
from dataclasses import asdict
from typing import Any

import numpy as np
import psutil

from .families import FAMILIES
from .verdicts import Record, judged

__all__ = ["Worker", "load_families", "one_case"]

MODULES = (
    "symmetries",
    "laws",
    "extremes",
    "pieces",
    "answers",
    "reduced",
    "results",
    "studying",
    "mutations",
    "command_lines",
    "issues",
)
# Seconds of CPU time that a case may take, and of waiting without any.
LIMIT, STANDSTILL = 120.0, 240.0
# Bytes of address space beyond what the process has when it begins.
MEMORY = 8 * 2**30


def load_families() -> dict[str, Any]:
    """Import everything that registers families."""
    for name in MODULES:
        importlib.import_module(f"{__package__}.{name}")
    return FAMILIES


def one_case(seed: int, family: str, number: int) -> Record:
    """Run a case here, in a temporary folder; the same whatever ran before."""
    case = load_families()[family][0]
    key = [seed, sum(ord(c) * 31**k for k, c in enumerate(family[:12])), number]
    rng = np.random.default_rng(key)
    home, began = os.getcwd(), time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            record = judged(family, number, case, rng)
        finally:
            os.chdir(home)
    record.seconds = time.process_time() - began
    return record


def _serve(pipe: Any, seed: int) -> None:
    load_families()
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    now = psutil.Process().memory_info().vms
    resource.setrlimit(resource.RLIMIT_AS, (now + MEMORY, hard))
    while True:
        job = pipe.recv()
        if job is None:
            return
        pipe.send(asdict(one_case(seed, *job)))


class Worker:
    """A process that runs one case after the other, begun anew when it is lost."""

    def __init__(self, seed: int) -> None:
        self.seed, self.process = seed, None
        self.context = multiprocessing.get_context("spawn")
        self.seconds = 0.0

    def run(self, family: str, number: int) -> Record:
        """The record of a case, whatever became of the process."""
        if self.process is None:
            self._begin()
        self.pipe.send((family, number))
        trouble = self._wait()
        if trouble is None:
            try:
                record = Record(**self.pipe.recv())
                self.seconds += record.seconds
                return record
            except EOFError:
                trouble = "crash", f"the process ended with {self._exit_code()}"
        self.close()
        verdict, message = trouble
        return Record(family, number, verdict, "", message, 0, LIMIT)

    def close(self) -> None:
        """End the process and whatever it began."""
        if self.process is None:
            return
        try:
            known = psutil.Process(self.process.pid)
            for child in [*known.children(recursive=True), known]:
                child.kill()
        except psutil.NoSuchProcess:
            pass
        self.process.join()
        self.process = None

    def _begin(self) -> None:
        self.pipe, theirs = self.context.Pipe()
        self.process = self.context.Process(target=_serve, args=(theirs, self.seed))
        self.process.start()
        theirs.close()

    def _wait(self) -> tuple[str, str] | None:
        """None when an answer is there; else what went wrong."""
        watched = psutil.Process(self.process.pid)
        first = last = _cpu_seconds(watched)
        still = time.monotonic()
        while not self.pipe.poll(0.5):
            used = _cpu_seconds(watched)
            if used > last + 0.01:
                last, still = used, time.monotonic()
            if used - first > LIMIT:
                return "hang", f"not done after {LIMIT:g} s of CPU time"
            if time.monotonic() - still > STANDSTILL:
                return "hang", f"no CPU time was used for {STANDSTILL:g} s"
        return None

    def _exit_code(self) -> int | None:
        self.process.join(10)
        return self.process.exitcode


def _cpu_seconds(process: psutil.Process) -> float:
    """Of the process and its children."""
    try:
        family = [process, *process.children(recursive=True)]
        times = [one.cpu_times() for one in family]
        return sum(one.user + one.system for one in times)
    except psutil.NoSuchProcess:
        return 0.0
