"""Path-steps per second: our sampler and its peers on one problem, in one run.

    python validation/performance/paths.py            # all peers that are installed
    python validation/performance/paths.py --quick    # small, no timings to rely on

Every sampler runs in a process of its own, on one core and with one thread, except for
the two-thread scaling. Peers are optional (`pip install diffrax sdeint`); one that
cannot be imported is named and left out.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import subprocess
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

HERE = Path(__file__).parent
PEERS = ("numba_euler", "diffrax", "sdeint")
WORKERS = ("ours", *PEERS, "biases", "scaling")
PACKAGES = ("fpsolve", "numpy", "numba", "diffrax", "jax", "sdeint")
THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)


def parse() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="small, for checks only")
    parser.add_argument("--peers", nargs="*", choices=PEERS, help="default: all")
    parser.add_argument("--worker", choices=WORKERS, help=argparse.SUPPRESS)
    parser.add_argument("--answer", type=Path, help=argparse.SUPPRESS)
    parser.add_argument(
        "--out", type=Path, default=HERE / "results", help="folder for results"
    )
    return parser.parse_args()


def work(name: str, *, quick: bool) -> Any:
    """What one process measures, as plain values."""
    from paths_problem import stay_on_one_core

    if name != "scaling":
        stay_on_one_core()
    if name in PEERS:
        try:
            peer = importlib.import_module(f"peer_{name}")
        except ImportError as error:
            return {"missing": str(error)}
        return [rate.to_dict() for rate in peer.rates(quick=quick)]
    import paths_ours

    if name == "scaling":
        return paths_ours.scaling(quick=quick).to_dict()
    measured = paths_ours.rates if name == "ours" else paths_ours.biases
    return [one.to_dict() for one in measured(quick=quick)]


def delegate(name: str, *, quick: bool) -> Any:
    """Run `work` in a process of its own, with the number of threads it may use."""
    environment = os.environ | dict.fromkeys(THREAD_VARIABLES, "1")
    if name == "scaling":
        environment["NUMBA_NUM_THREADS"] = "2"
    with TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        command = [sys.executable, __file__, "--worker", name, "--answer", str(answer)]
        command += ["--quick"] if quick else []
        subprocess.run(command, check=True, env=environment)
        return json.loads(answer.read_text())


def installed_versions() -> dict[str, str | None]:
    """Versions of everything that is compared."""
    found: dict[str, str | None] = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = None
    return found


def check(rates: list[Any], biases: list[Any]) -> None:
    """Assert what does not depend on the machine; no bound on time.

    All samplers of the benchmark problem give E|ξ|² = 2 up to the bias of
    Euler-Maruyama at ds = 0.2, which is about 0.27, and five standard errors.
    """
    from paths_ours import METHODS, NAME

    same = [f"{method}, quadratic B" for method in METHODS]
    for rate in rates:
        if rate.name != NAME or rate.note in same:
            allowed = 0.35 + 5 * rate.standard_error
            found = abs(rate.mean_square - 2.0)
            assert found <= allowed, f"{rate.name}, {rate.note}: E|ξ|² off by {found}"
    at = {(bias.method, bias.ds): bias for bias in biases}
    euler, ours = at["euler_maruyama", 0.2], at["splitting", 0.2]
    error = (euler.standard_error**2 + ours.standard_error**2) ** 0.5
    assert abs(ours.bias) < euler.bias + 2 * error, "the splitting is not better"


def collect(peers: list[str] | tuple[str, ...], *, quick: bool) -> dict[str, Any]:
    """Everything that is measured, as the classes of paths_ours and paths_problem."""
    from paths_ours import Bias, Scaling
    from paths_problem import Rate

    rates = [Rate(**row) for row in delegate("ours", quick=quick)]
    for name in peers:
        answer = delegate(name, quick=quick)
        if isinstance(answer, dict):
            print(f"peer {name} not installed: {answer['missing']}", file=sys.stderr)
            continue
        rates += [Rate(**row) for row in answer]
    threads = delegate("scaling", quick=quick)
    return {
        "rates": rates,
        "scaling": Scaling(threads["one"], threads["two"]),
        "biases": [Bias(**row) for row in delegate("biases", quick=quick)],
    }


def plain(measured: dict[str, Any]) -> dict[str, Any]:
    """The same as plain values, for JSON."""
    return {
        name: [one.to_dict() for one in value]
        if isinstance(value, list)
        else value.to_dict()
        for name, value in measured.items()
    }


def main() -> None:
    """Measure, print, write."""
    arguments = parse()
    quick = arguments.quick
    if arguments.worker:
        arguments.answer.write_text(json.dumps(work(arguments.worker, quick=quick)))
        return
    import paths_report
    from machine import measure_machine
    from results import write_json

    peers = PEERS if arguments.peers is None else arguments.peers
    measured = collect(peers, quick=quick)
    machine = measure_machine(quick=quick)
    verdicts = (
        [] if quick else paths_report.judge(measured["rates"], measured["scaling"])
    )
    equal = paths_report.at_equal_error(measured["rates"], measured["biases"])
    paths_report.print_all(measured, equal, verdicts)
    print(f"\n{machine}")
    content = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": installed_versions(),
        "machine": machine.to_dict(),
        "equal_error": equal,
        "aims": verdicts,
        **plain(measured),
    }
    path = arguments.out / ("paths-quick.json" if quick else "paths.json")
    write_json(path, content)
    print(f"written: {path}")
    check(measured["rates"], measured["biases"])


if __name__ == "__main__":
    main()
