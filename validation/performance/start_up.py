"""How long imports take, and the packaged example from a cold and a warm start.

    python validation/performance/start_up.py            # 3 minutes

Every sample is a process of its own, on one thread. Cold: numba's cache is an empty
folder. Warm: the folder that the cold run left. Writes results/benchmark-start.json.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import re
import resource
import statistics
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from results import add_options, run_record, set_threads, write_part

REPEATS = 5
IMPORTS = {
    "fpsolve": "import fpsolve",
    "fpsolve, solve and a scheme": "import fpsolve as f; f.solve; f.drift_kick",
    "numba and numpy alone": "import numba, numpy",
    "pde": "import pde",
    "fipy": "import fipy",
    "dedalus": "import dedalus.public",
    "fplanck": "import numpy; numpy.product = numpy.prod; import fplanck",
}
PROFILED = "fpsolve, solve and a scheme"
LARGEST = 8  # packages listed
TINY = """
[potential]
kind = "quadratic"
[model]
noise = 1.0
[grid]
half_width = 5.0
shape = [24, 24, 16]
[initial]
kind = "gaussian"
variance = 0.5
[scheme]
kind = "drift_kick"
[run]
s_end = 0.5
ds = 0.25
"""


def timed(arguments: list[str], **environment: str) -> dict[str, float]:
    """Elapsed and CPU seconds of a Python process."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments],
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=os.environ | environment,
    )
    elapsed, after = (
        time.perf_counter() - start,
        resource.getrusage(resource.RUSAGE_CHILDREN),
    )
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"elapsed": elapsed, "cpu": cpu}


def median(samples: list[dict[str, float]]) -> dict[str, float]:
    """Medians of elapsed and CPU seconds."""
    return {key: statistics.median(one[key] for one in samples) for key in samples[0]}


def import_times(names: tuple[str, ...], repeats: int) -> dict[str, dict[str, float]]:
    """Seconds of a process that imports and ends, for what is installed."""
    os.environ["FIPY_SOLVERS"] = "scipy"
    found = {"nothing": median([timed(["-c", "pass"]) for _ in range(repeats)])}
    for name in names:
        package = name.split(",")[0].split(" ")[0]
        if importlib.util.find_spec(package) is None:
            continue
        samples = [timed(["-c", IMPORTS[name]]) for _ in range(repeats + 1)]
        found[name] = median(samples[1:])  # the first reads from the disk
        print(f"{name}: {found[name]['elapsed']:.2f} s", flush=True)
    return found


def contributors(code: str) -> dict[str, float]:
    """Seconds of the modules' own code at import, added up over packages."""
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-c", code],
        check=True,
        capture_output=True,
        text=True,
    )
    lines = re.findall(r"^import time:\s+(\d+) \|\s+\d+ \|\s+(\S+)", done.stderr, re.M)
    own: Counter[str] = Counter()
    for microseconds, module in lines:
        own[module.split(".")[0]] += int(microseconds)
    return {"all": own.total() / 1e6} | {
        package: microseconds / 1e6
        for package, microseconds in own.most_common(LARGEST)
    }


def example_times(repeats: int, *, quick: bool) -> dict[str, dict[str, float]]:
    """`fpsolve run` of the packaged example; `quick`: of a tiny one, warm alone."""
    with TemporaryDirectory() as folder:
        command = ["-m", "fpsolve", "run", "--out", f"{folder}/out"]
        if quick:
            config = Path(folder) / "tiny.toml"
            config.write_text(TINY)
            return {"warm": timed([*command[:3], str(config), *command[3:]])}
        cache = {"NUMBA_CACHE_DIR": f"{folder}/cache"}
        cold = timed(command, **cache)
        warm = [timed(command, **cache) for _ in range(repeats)]
    found = {"cold": cold, "warm": median(warm)}
    print({name: round(one["elapsed"], 1) for name, one in found.items()})
    return found


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    set_threads(1)
    for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"):
        os.environ[name] = "1"
    repeats = 1 if arguments.quick else REPEATS
    names = ("fpsolve",) if arguments.quick else tuple(IMPORTS)
    content = {
        "imports": import_times(names, repeats),
        "contributors": contributors(IMPORTS[PROFILED]),
        "example": example_times(repeats, quick=arguments.quick),
    }
    write_part("start", run_record() | content, arguments)


if __name__ == "__main__":
    main()
