"""Rates of the operators of our schemes against the limits of this machine.

    python validation/performance/operators.py            # 64³, half a minute

Writes results/benchmark-operators.json.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import Any

from results import add_options, run_record, set_threads, write_part

set_threads(1)

from kernels import KernelRate, measure_kernels  # noqa: E402
from machine import Machine, measure_machine  # noqa: E402
from timing import keep_memory  # noqa: E402


def percent(share: float | None) -> str:
    """A share as a percentage, or a dash."""
    return "-" if share is None else f"{100 * share:.0f} %"


def print_kernels(rates: list[KernelRate], machine: Machine) -> None:
    """Print the rates of our operators and the shares of the machine's limits."""
    print(
        f"{'operator':44} {'Mcells/s':>9} {'copy 64³':>9} {'copy RAM':>9} {'DGEMM':>7}"
    )
    for kernel in rates:
        shares = [percent(share) for share in kernel.shares(machine).values()]
        print(
            f"{kernel.name:44} {kernel.cells_per_second / 1e6:9.0f} "
            f"{shares[0]:>9} {shares[1]:>9} {shares[2]:>7}"
        )


def kernel_records(rates: list[KernelRate], machine: Machine) -> list[dict[str, Any]]:
    """Rates and shares as plain values."""
    return [asdict(kernel) | {"shares": kernel.shares(machine)} for kernel in rates]


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_options(parser)
    arguments = parser.parse_args()
    keep_memory()
    machine = measure_machine(quick=arguments.quick)
    rates = measure_kernels(quick=arguments.quick)
    print(machine)
    print_kernels(rates, machine)
    content = {"machine": machine.to_dict(), "kernels": kernel_records(rates, machine)}
    write_part("operators", run_record() | content, arguments)


if __name__ == "__main__":
    main()
